"""The cards of the task closest_point: how much mesh a query needs, and slivers, on rows made by hand."""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import closest, model
from report_made import made, read

LADDER = ("bvh_decimated", "bvh", "ours", "approximate")
TREE = ("bvh", "bvh", "ours", "bounded")
PEER = ("embree_point_query", "bvh", "peer", "approximate")


def row(method, error, *, far_off=None, keep=None, **values):
    extra = {} if far_off is None else {"closest_point_far_off": far_off}
    build = {} if keep is None else {"keep": keep}
    return made(method, error=error, error_max=2 * error, build=build, **values) | {"task": "closest_point"} | extra


def cards_of(*entries):
    found = read(*entries)
    (task,) = model.task_models(found)
    numbers = {id(r): i for i, r in enumerate(task.soft)}
    return {card.title: card for card in closest.cards(task, numbers, 460)}, task


class Cards(unittest.TestCase):
    def test_the_ladder_is_in_order_and_over_the_whole_mesh(self):
        cards, _ = cards_of(*(row(LADDER, e, keep=k, ns=ns, query_set="near")
                              for k, e, ns in ((1, 0.0, 200.0), (0.1, 1e-3, 100.0), (0.5, 1e-5, 150.0))))  # fmt: skip
        error, time = cards["The least mesh"].figures
        spec = error.chart.to_dict()
        values = (spec if "data" in spec else spec["layer"][0])["data"]["values"]
        self.assertEqual([v["keep"] for v in values], [10, 50, 100])
        self.assertEqual([v["time"] for v in values], [0.5, 0.75, 1])
        self.assertEqual(values[2]["error"], 1e-7, "no error stands at the truth's floor")
        self.assertTrue(error.title.startswith("Error") and time.title.startswith("Time"))

    def test_sets_stand_side_by_side(self):
        """So that lines to the worst error do not hide one another."""
        cards, _ = cards_of(*(row(LADDER, 1e-3, keep=k, query_set=s) for k in (0.1, 1) for s in ("near", "uniform", "far")))
        spec = cards["The least mesh"].figures[0].chart.to_dict()
        values = (spec if "data" in spec else spec["layer"][0])["data"]["values"]
        self.assertEqual(len({v["keep"] for v in values}), 6)
        self.assertTrue(all(min(abs(v["keep"] - 10), abs(v["keep"] - 100) / 10) < 1 for v in values))

    def test_one_share_alone_is_no_ladder(self):
        cards, _ = cards_of(row(LADDER, 0.0, keep=1, query_set="near"), row(TREE, 0.0, query_set="near"))
        self.assertNotIn("The least mesh", cards)

    def test_slivers_show_the_worst_build_of_each_method(self):
        entries = [row(PEER, 1e-3, far_off=f, dataset="caps", query_set="near", query={"kernel": k}, n=n)
                   for f, k, n in ((0.02, "textbook", 1000), (0.0, "double", 1000))]  # fmt: skip
        entries.append(row(TREE, 0.0, far_off=0.0, dataset="caps", query_set="near"))
        entries.append(row(TREE, 0.0, far_off=0.5, dataset="icosphere", query_set="near"))
        cards, task = cards_of(*entries)
        (figure,) = cards["Led astray by slivers"].figures
        found = closest.astray(task.soft)
        self.assertEqual({(d, s) for d, _, s in found}, {("caps", "near")})
        ((shares),) = [[share for _, share in of] for of in found.values()]
        self.assertEqual(sorted(shares), [0.0, 0.0, 0.02])
        self.assertIn("caps", figure.title)

    def test_other_tasks_have_no_such_cards(self):
        found = read(made(LADDER, build={"keep": 1}))
        (task,) = model.task_models(found)
        self.assertEqual(closest.cards(task, {}, 460), [])


if __name__ == "__main__":
    unittest.main()
