"""Cards that no choice changes: thread scaling, batches, and builds that were repeated, on rows made by hand."""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import model, series, winners
from report_made import LOOSE, METHOD, PEER, made, read


class Series(unittest.TestCase):
    @staticmethod
    def threaded(method, ns, threads, *, build_s=1.0, **values):
        return made(method, ns, low=0.9 * ns, high=1.1 * ns, query_set="knn8_threads", build_s=build_s, **values) | {
            "threads": threads}  # fmt: skip

    def test_speedup_is_of_the_configuration_that_is_fastest_alone(self):
        slow, fast = {"leaf": 1}, {"leaf": 2}
        found = list(read(self.threaded(METHOD, 200, 1, build=slow), self.threaded(METHOD, 50, 2, build=slow),
                          self.threaded(METHOD, 100, 1, build=fast), self.threaded(METHOD, 60, 2, build=fast),
                          self.threaded(METHOD, 40, 4, build=fast), self.threaded(PEER, 90, 2)))  # fmt: skip
        told = {(r.method, r.threads): (times, low, high) for r, times, low, high in series.speedups(found, "query_ns")}
        self.assertEqual(set(told), {("kd_tree", 2), ("kd_tree", 4)})  # the peer has no time alone to compare with
        for threads, ns in ((2, 60), (4, 40)):
            for figure, right in zip(told["kd_tree", threads], (100 / ns, 90 / (1.1 * ns), 110 / (0.9 * ns))):
                self.assertAlmostEqual(figure, right)

    def test_wrong_answers_have_no_speedup_and_builds_are_counted_once(self):
        found = list(read(self.threaded(METHOD, 100, 1, build_s=4.0), self.threaded(METHOD, 50, 2, build_s=2.5),
                          self.threaded(PEER, 10, 1, status="wrong", error=1.0), self.threaded(PEER, 5, 2)))  # fmt: skip
        self.assertEqual([(r.method, x) for r, x, _, _ in series.speedups(found, "build_s")], [("kd_tree", 1.6)])
        self.assertEqual([r.method for r, *_ in series.speedups(found, "query_ns")], ["kd_tree"])

    def test_what_is_neither_right_nor_wrong_has_a_speedup(self):
        """Builds have no error, and noise is allowed: the fastest alone counts, unless something is right."""
        build = [self.threaded(METHOD, ns, t, error=None) | {"query_set": "build_threads", "queries": 9} for t, ns in ((1, 100), (2, 60))]
        noisy = [self.threaded(LOOSE, ns, t, error=e, build={"e": e}, build_s=1 / t) | {"queries": n}
                 for t, ns, e, n in ((1, 80, 0.3, 1024), (2, 50, 0.3, 1024), (1, 90, 0.0, 16384), (2, 45, 0.0, 16384))]  # fmt: skip
        self.assertEqual([x for _, x, *_ in series.speedups(read(*build), "query_ns")], [100 / 60])
        self.assertEqual([x for _, x, *_ in series.speedups(read(*noisy[:2]), "query_ns")], [80 / 50])
        self.assertEqual([x for _, x, *_ in series.speedups(read(*noisy), "query_ns")], [2])
        (task,) = model.task_models(read(*build, *noisy))
        (card,) = series.cards(task, model.numbers([task]))
        self.assertEqual([f.title for f in card.figures], ["build: cube, 1k points", "knn8: cube, 1k points"])  # once
        for words in ("times faster the same is on 2 threads", "1,024 to 16,384 of them"):
            self.assertIn(words, " ".join(card.caption.split()))
        more = [r | {"threads": 4} for r in build if r["threads"] == 2]
        (task,) = model.task_models(read(*build, *more, *noisy))
        (card,) = series.cards(task, model.numbers([task]))
        labels = [v["label"] for f in card.figures for layer in f.chart.to_dict()["layer"]
                  for v in layer.get("data", {}).get("values", ()) if "label" in v]  # fmt: skip
        self.assertTrue(labels and all(" on " in label for label in labels), labels)

    def test_thread_rows_stay_out_of_every_other_chart(self):
        found = read(made(), self.threaded(METHOD, 1, 1), self.threaded(METHOD, 0.5, 2))
        (task,) = model.task_models(found)
        self.assertEqual((len(task.soft), len(task.scaling), task.query_sets), (1, 2, ["k8"]))
        self.assertEqual([w.query_set for w in winners.winners(found)], ["k8"])
        (card,) = series.cards(task, model.numbers([task]))
        self.assertEqual([f.title for f in card.figures], ["knn8: cube, 1k points", "build: cube, 1k points"])

    def test_no_line_or_label_leaves_the_frame(self):
        """Superlinear by luck: two threads five times as fast, and six for all that the intervals tell."""
        (task,) = model.task_models(read(self.threaded(METHOD, 100, 1), self.threaded(METHOD, 20, 2)))
        (card,) = series.cards(task, model.numbers([task]))
        chart = card.figures[0].chart.to_dict()
        ends = [layer["encoding"]["x"]["scale"]["domain"][1] for layer in chart["layer"] if "scale" in layer["encoding"]["x"]]
        self.assertTrue(ends and all(end > 1.2 * 110 / 18 for end in ends), ends)

    def test_one_thread_alone_makes_no_chart(self):
        (task,) = model.task_models(read(made(), self.threaded(METHOD, 1, 1)))
        self.assertEqual(series.cards(task, model.numbers([task])), [])

    def test_batches_are_charted_by_the_fastest_right_configuration(self):
        at = lambda batch, ns, query_set="batches16", method=METHOD, **values: made(
            method, ns, query_set=query_set, **values) | {"knn_batch": batch}
        found = read(at(1, 300, "single"), at(64, 90), at(64, 80, build={"leaf": 9}), at(64, 10, build={"leaf": 7}, status="wrong",
                     error=1.0), at(64, 5, "asked16"), at(64, 70, method=PEER), made(query_set="knn8_after"))  # fmt: skip
        (task,) = model.task_models(found)
        told = {(r.method, batch): r.query_ns for r, batch in series.batch_points(task, task.soft)}
        self.assertEqual(told, {("kd_tree", 1): 300, ("kd_tree", 64): 80, ("nanoflann", 64): 70})
        (card,) = series.cards(task, model.numbers([task]))
        self.assertEqual(len(card.figures), 1)

    def test_builds_that_were_repeated_are_charted(self):
        again = made(METHOD, 0.5, error=None, query_set="build", build_s=2e-3)
        found = list(read(made(METHOD, build_s=2e-3), again, made(METHOD, build={"leaf": 2}, build_s=3e-3)))
        (task,) = model.task_models(found)
        self.assertEqual([p["build"] for p in model.points(task, found)], [0.5, 0.5, 3000])
        self.assertIn("made anew", model.build_title(task)[1])
        table = model.table([task])
        self.assertEqual([line[table["columns"].index("built")] for line in table["rows"]], [0.5, 0.5, 3000])
        (older,) = model.task_models(found[:1])
        self.assertEqual(model.build_title(older), "build time per point, log")


if __name__ == "__main__":
    unittest.main()
