"""The table of damage that the report shows for the task inside, on rows made by hand."""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import inside, model
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

    def test_none_wrong_is_said_so(self):
        task, _ = self.table(row("rays", "ball+unwelded", 0.0))
        (card,) = inside.cards(task, model.numbers([task]))
        self.assertEqual([v["text"] for v in card.figures[0].chart.to_dict()["data"]["values"]], ["✓"])


if __name__ == "__main__":
    unittest.main()
