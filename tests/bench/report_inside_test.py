"""The table of damage and the card of solids that the report shows for the task inside, on rows made by hand."""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import inside, model, solids
from report_made import made, read


def row(method, dataset, error, **values):
    which = (method, "bvh", "ours", "approximate")
    return made(which, error=error, dataset=dataset, query_set="near", **values) | {"task": "inside"}


class Damage(unittest.TestCase):
    def table(self, *entries):
        (task,) = model.task_models(read(*entries))
        return task, inside.damage_table(task.soft)

    def test_whole_meshes_have_no_place_in_it(self):
        task, found = self.table(row("winding", "ball", 0.0))
        self.assertEqual(found, {})
        self.assertEqual(inside.cards(task, model.numbers([task])), [])

    def test_one_line_a_build_and_one_column_a_damage(self):
        task, found = self.table(
            row("winding", "ball+hole_2", 0.001, build={"reach": 2}), row("winding", "ball+hole_2", 0.002, build={"reach": 4}),
            row("rays", "ball+hole_2", 0.03), row("rays", "ball+inside_out", 1.0), row("rays", "ball", 0.0))  # fmt: skip
        ((key, cells),) = found.items()
        self.assertEqual((key[0], key[2]), ("ball", "near"))
        self.assertEqual(len({line for line, _ in cells}), 3)
        self.assertEqual({damage for _, damage in cells}, {"hole_2", "inside_out"})
        self.assertEqual(cells["rays", "inside_out"].error, 1.0)
        (card,) = inside.cards(task, model.numbers([task]))
        self.assertEqual(len(card.figures), 1)
        values = card.figures[0].chart.to_dict()["data"]["values"]
        self.assertEqual({v["text"] for v in values}, {"0.1", "0.2", "3", "100"})

    def test_lines_name_the_knobs_that_tell_them_apart(self):
        _, found = self.table(*(row("facing", "ball+nested", 0.1, build={"quality": "medium", "robust": r}) for r in (True, False)),
                              row("rays", "ball+nested", 0.2, build={"seed": 1}))  # fmt: skip
        (cells,) = found.values()
        self.assertEqual({line for line, _ in cells}, {"facing, robust yes", "facing, robust no", "rays"})

    def test_what_a_method_leaves_to_others_is_told_where_it_answers_any(self):
        entries = [row("solid", "ball+hole_2", None, ns=None, status="unsupported"), row("solid", "ball+nested", 0.1),
                   row("sum", "ball+hole_2", None, ns=None, status="unsupported"), row("rays", "ball+hole_2", 0.5)]  # fmt: skip
        task, found = self.table(*entries)
        (cells,) = found.values()
        self.assertEqual([key for key in cells], [("solid", "hole_2"), ("solid", "nested"), ("rays", "hole_2")])
        (card,) = inside.cards(task, model.numbers([task]))
        values = card.figures[0].chart.to_dict()["data"]["values"]
        self.assertEqual([(v["text"], v["share"]) for v in values], [("–", None), ("10", 0.1), ("50", 0.5)])

    def test_none_wrong_is_said_so(self):
        task, _ = self.table(row("rays", "ball+unwelded", 0.0))
        (card,) = inside.cards(task, model.numbers([task]))
        self.assertEqual([v["text"] for v in card.figures[0].chart.to_dict()["data"]["values"]], ["✓"])


    def test_figures_stand_out_from_their_cells(self):
        """In both themes: cells are the same in either, and so is the text on them; a tooltip opens over text, too."""
        def luminance(color):
            parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
            return sum(w * (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4)
                       for w, c in zip((0.2126, 0.7152, 0.0722), parts))  # fmt: skip

        text = inside.ON_CELL.replace("#111", "#111111")
        for cell in inside.CELLS:
            self.assertGreaterEqual((luminance(cell) + 0.05) / (luminance(text) + 0.05), 4.5, cell)  # WCAG 2.1, 1.4.3
        task, _ = self.table(row("rays", "ball+unwelded", 0.0), row("solid", "ball+hole_2", None, ns=None, status="unsupported"))
        (card,) = inside.cards(task, model.numbers([task]))
        cells, texts = card.figures[0].chart.to_dict()["layer"]
        self.assertIn(inside.ON_CELL, texts["mark"]["fill"]["expr"])
        self.assertEqual(cells["encoding"]["tooltip"], texts["encoding"]["tooltip"])
        self.assertIn("per cent of wrong answers", card.caption)


def tree(dataset, n, fragments, depth, method=solids.EXACT, query_set="near", **knobs):
    which = (method, "bsp", "ours", "bounded")
    return made(which, dataset=dataset, n=n, build=knobs, query_set=query_set, inside_fragments=fragments, inside_depth=depth) | {"task": "inside"}  # fmt: skip


class Solids(unittest.TestCase):
    def card(self, *entries):
        (task,) = model.task_models(read(*entries))
        return solids.card(task, model.numbers([task]))

    def test_a_line_a_strategy_and_a_mark_a_size(self):
        first, best = {"axis_levels": 0, "candidates": 1}, {"axis_levels": 0, "candidates": 16}
        card = self.card(
            tree("ball", 9000, 4.0, 110, **first), tree("ball", 1000, 3.5, 60, **first),
            tree("ball", 1000, 1.9, 30, **best), tree("ball", 9000, 2.0, 40, **best),
            tree("ball", 9000, 2.0, 40, **best, query_set="far"), tree("ball", 1000, 2.3, 20, axis_levels=24, candidates=8),
            tree("ball", 1000, 2.9, 21, solids.ROUNDED, epsilon=1e-6),
            tree("ball+flipped_1", 9000, 9.0, 999, **best), tree("cup", 1000, 9.0, 999, **best))  # fmt: skip
        self.assertEqual(card.title, "Solids")
        self.assertIn("of whole ones in the charts below", card.caption)  # where the page has them
        self.assertEqual([f.title for f in card.figures], ["fragments: ball", "depth: ball"])
        fragments, depth = (f.chart.to_dict() for f in card.figures)
        lines = {}
        for v in fragments["data"]["values"]:
            lines.setdefault(v["how"], []).append((v["n"], v["y"]))
        self.assertEqual(lines, {
            "first face": [(1000, 3.5), (9000, 4.0)], "best of 16 faces": [(1000, 1.9), (9000, 2.0)],
            "axis medians, then best of 8 faces": [(1000, 2.3)], "rounded, epsilon 1e-06": [(1000, 2.9)]})  # fmt: skip
        self.assertEqual(max(v["y"] for v in depth["data"]["values"]), 110)
        legend = fragments["layer"][0]["encoding"]["stroke"]
        self.assertEqual(legend["scale"]["domain"], list(lines))
        self.assertIsNotNone(legend["legend"])

    def test_none_without_several_sizes(self):
        self.assertIsNone(self.card(tree("ball", 1000, 2.0, 30, candidates=16)))
        self.assertIsNone(self.card(row("rays", "ball", 0.0, n=1000), row("rays", "ball", 0.0, n=9000)))


if __name__ == "__main__":
    unittest.main()
