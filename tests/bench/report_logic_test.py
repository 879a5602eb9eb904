"""Reading rows, the frontier, winners, advice and stability, on rows made by hand."""

import itertools
import json
import random
import sys
import tempfile
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

import report_fixture as fixture
from bench.report import (advice, approximate, busy, frontier, layout, model, page, palette, pictures, pieces, rows, tasks,
                          stability, units, winners)  # fmt: skip
from report_made import LOOSE, METHOD, PEER, made, read, read_text


class Reading(unittest.TestCase):
    def broken(self, text, *words):
        with self.assertRaises(rows.RowError) as caught:
            read_text(text)
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_broken_row_names_file_line_and_field(self):
        good = json.dumps(made())
        self.broken(good + "\n{broken\n" + good + "\n", "rows.jsonl:2", "not JSON")
        self.broken(good + "\n[1]\n", "rows.jsonl:2", "JSON object")
        for field, value, words in (
            ("schema", 7, ["schema"]), ("status", "great", ["status", "great"]), ("claim", "sure", ["claim"]),
            ("query_ns", "fast", ["query_ns", "fast"]), ("n", None, ["'n'", "null"]), ("n", 1.5, ["'n'", "1.5"]),
            ("query_ns", float("nan"), ["query_ns"]), ("bytes", True, ["bytes"]),
        ):  # fmt: skip
            self.broken(good + "\n" + json.dumps(made() | {field: value}) + "\n", "rows.jsonl:2", *words)
        absent = made()
        del absent["error_p99"]
        self.broken(json.dumps(absent) + "\n", "rows.jsonl:1", "error_p99", "absent")

    def test_torn_last_line_costs_a_warning(self):
        good = json.dumps(made())
        found = read_text(good + "\n" + good[:40])
        self.assertEqual(len(found), 1)
        self.assertEqual(len(found.warnings), 1)
        self.assertIn("rows.jsonl:2", found.warnings[0])

    def test_cell_measured_twice_counts_once_and_the_later_wins(self):
        found = read(made(ns=100), made(ns=200))
        self.assertEqual([r.query_ns for r in found], [200])
        self.assertEqual(len(found.warnings), 1)

    def test_other_commit_or_machine_is_another_run(self):
        found = read(made(), made() | {"commit": "ffff"}, made() | {"host": "other"})
        self.assertEqual(len(found.runs), 3)
        self.assertEqual(len({r.group for r in found}), 3)


class Frontier(unittest.TestCase):
    def test_neither_beaten_nor_equal(self):
        found = list(read(made(LOOSE, 10, 0.5, build={"a": 1}), made(LOOSE, 20, 0.1, build={"a": 2}),
                          made(LOOSE, 30, 0.2, build={"a": 3}), made(PEER, 40, 0), made(METHOD, 50, 5e-8)))  # fmt: skip
        self.assertEqual([r.query_ns for r in frontier.frontier(found)], [10, 20, 40])

    def test_equals_definition_on_random_rows(self):
        rng = random.Random(3)
        for _ in range(50):
            found = list(read(*(made(LOOSE, rng.randrange(1, 12), rng.randrange(0, 6) / 10, build={"i": i})
                                for i in range(25))))  # fmt: skip
            unbeaten = {id(b) for b in found if not any(frontier.beats(a, b) for a in found)}
            self.assertEqual({id(r) for r in frontier.frontier(found)}, unbeaten)

    def test_no_error_by_luck_does_not_beat_a_promise(self):
        """Both are on the frontier, and the one that promises nothing says so."""
        epsilon = made(("m", "bvh", "ours", "bounded"), 20, 0, query={"epsilon": 0.5})
        found = list(read(made(LOOSE, 10, 0), epsilon, made(METHOD, 50, 0), made(PEER, 60, 0),
                          made(LOOSE, 55, 0, build={"slow": 1})))  # fmt: skip
        self.assertEqual([r.query_ns for r in frontier.frontier(found)], [10, 50])
        self.assertEqual([frontier.promises(r) for r in found], [False, False, True, True, False])
        fields = read(made(("dense", "field", "ours", "bounded"), 20, build={"resolution": 128}), made(("bvh", "bvh", "ours", "bounded"), 30))
        self.assertEqual([frontier.promises(r) for r in fields], [False, True])  # a grid's bound is its own, not rounding's
        self.assertEqual(winners.winners(fields)[0].best.method, "bvh")
        self.assertEqual(advice.advise(advice.rungs(fields, ["k8"]), 0)[0].method, "bvh")
        (task,) = model.task_models(found)
        self.assertEqual([p["promise"] for p in model.points(task, found)], [False, False, True, True, False])

    def test_failed_rows_are_never_on_it(self):
        found = list(
            read(made(METHOD, 50, 0), made(PEER, 1, 0, status="wrong"), made(LOOSE, None, None, status="crashed"))
        )
        self.assertEqual([r.method for r in frontier.frontier(found)], ["kd_tree"])

    def test_exact_means_below_the_floor(self):
        row = list(read(made(error=9e-8)))[0]
        self.assertEqual(frontier.shown_error(row), 0)
        self.assertEqual(frontier.shown_error(list(read(made(error=2e-7)))[0]), 2e-7)

    def test_without_a_floor_it_is_that_of_single_precision(self):
        small, large = read(made(error=8e-11, error_floor=None), made(error=1e-7, error_floor=None, query_set="k9"))
        self.assertEqual([frontier.shown_error(r) for r in (small, large)], [0, 1e-7])
        self.assertEqual(advice.advise(advice.rungs([small], ["k8"]), 0)[0].method, "kd_tree")


class Placing(unittest.TestCase):
    def test_every_tried_row_has_a_place_of_its_kind(self):
        statuses = [made(PEER, None, None, status=s, build={"s": s}) for s in rows.FAILURES]
        found = list(read(made(), made(LOOSE, 10, 0.5), made(LOOSE, 20, 1e-3, build={"x": 1}), *statuses,
                          made(PEER, 5, 0.9, status="wrong")))  # fmt: skip
        place = layout.Layout(found, ["kd_tree", "nanoflann", "forest"])
        exact, coarse, fine, *failed = (place.y(r) for r in found)
        self.assertLess(coarse, fine)
        self.assertLess(fine, exact)
        self.assertTrue(all(y < coarse for y in failed))
        self.assertEqual(len(set(failed)), len(rows.FAILURES))  # a rail each; the wrong one with a time shares its
        self.assertTrue(all(0 <= y <= place.height for y in (exact, coarse, fine, *failed)))
        _, _, slots = layout.marks(found)
        self.assertEqual(len(slots), len(rows.FAILURES))  # those without a time

    def test_decades_are_evenly_apart(self):
        found = list(
            read(made(LOOSE, 10, 1.0), made(LOOSE, 20, 1e-2, build={"x": 1}), made(LOOSE, 30, 1e-4, build={"x": 2}))
        )
        a, b, c = (layout.Layout(found, ["forest"]).y(r) for r in found)
        self.assertAlmostEqual(b - a, c - b, places=1)

    def test_an_empty_lane_says_why(self):
        absent = lambda name, reason: made((name, "kd", "peer", "exact"), None, None, query_set="box", status="unsupported",
                                           reason=reason)  # fmt: skip
        methods = ["kd_tree", "nanoflann", "forest", "short", "long", "failed", "gone"]
        k8 = [made(), *(made((m, "kd", "peer", "exact")) for m in methods[1:])]
        box = [made(query_set="box"), made(PEER, 5, 0.1, query_set="box"), absent("short", "has no box query"),
               absent("long", "x" * 90), made(("failed", "kd", "peer", "exact"), None, None, query_set="box", status="crashed")]
        found = list(read(*k8, *box, made(LOOSE, 5, query_set="box")))
        place = layout.Layout(found, methods)
        notes = {n["method"]: n for n in layout.lane_notes(place, [r for r in found if r.query_set == "box"])}
        self.assertEqual({m: n["note"] for m, n in notes.items()},
                         {"nanoflann": "not without error here", "short": "has no box query",
                          "long": "not offered here (reason below)", "failed": "crashed here", "gone": "not measured here"})
        self.assertEqual(notes["gone"]["y"], place.lanes["gone"])

    def test_row_without_a_verdict_is_shown_as_such(self):
        found = list(read(made(error=None), made(query_set="k9"), made(PEER, status="crashed", error=None)))
        place = layout.Layout(found[:2], ["kd_tree"])
        self.assertEqual(list(place.rails), ["unjudged"])
        self.assertIn("timed", place.ticks().values())
        self.assertEqual([n["note"] for n in layout.lane_notes(place, found[:1])], ["timed alone: nothing to judge here"])
        self.assertEqual([name for name, *_ in place.zones()], ["exact"])  # it is no failure
        place = layout.Layout(found, ["kd_tree", "nanoflann"])
        (_, top, end), _ = place.zones()
        self.assertTrue(top < place.y(found[2]) < end < place.y(found[0]))


class Winners(unittest.TestCase):
    def test_a_wrong_or_inexact_peer_does_not_win(self):
        found = list(read(made(METHOD, 100), made(PEER, 150), made(PEER, 10, 0.2, status="wrong", build={"b": 1}),
                          made(LOOSE, 20, 0.1)))  # fmt: skip
        (won,) = winners.winners(found)
        self.assertEqual((won.best.method, won.ratio), ("kd_tree", 1.5))

    def test_who_promises_nothing_wins_nothing_of_ours_as_of_peers(self):
        for claim, query, counts in (("exact", None, True), ("bounded", None, True), ("bounded", {"epsilon": 0.5}, False),
                                     ("approximate", None, False), ("stochastic", None, False)):  # fmt: skip
            for source, other in (("ours", PEER), ("peer", METHOD)):
                quick = made(("quick", "kd", source, claim), 10, query=query)
                (won,) = winners.winners(list(read(quick, made(other, 100))))
                self.assertEqual(won.best.method, "quick" if counts else other[0], (claim, query, source))
                self.assertEqual(won.ratio is not None, counts)

    def test_a_faster_peer_that_was_right_without_a_promise_is_set_beside(self):
        rows_here = list(read(made(METHOD, 100), made(PEER, 300), made(LOOSE, 50, 5e-7), made(LOOSE, 5, 1e-3, build={"b": 1})))
        (won,) = winners.winners(rows_here)
        self.assertEqual((won.best.method, won.ratio, won.beside_lucky, won.hardest), ("kd_tree", 3, 0.5, 0.5))
        told = winners.table(rows_here)
        for text in ("kd_tree 3.00x~ [forest 0.50x~]", "runs at 3.00x", "in 1 cell ours runs at 0.50x the speed of the fastest peer that had no error here, whatever it claims", "[…]"):
            self.assertIn(text, told)
        slow, near = made(METHOD, 100, low=90, high=110), made(PEER, 300, low=290, high=310)
        for high, sure in ((80, True), (95, False)):  # ours lies above the peer in brackets, or overlaps with it
            rows_here = list(read(slow, near, made(LOOSE, 70, low=60, high=high)))
            self.assertIn("kd_tree 3.00x [forest 0.70x" + ("]" if sure else "~]"), winners.table(rows_here))
            self.assertEqual("~ no clear" in winners.table(rows_here), not sure)
        rows_here = list(read(slow, near, made(LOOSE, 105, low=95, high=115)))  # no faster than ours, and no slower for certain
        self.assertIn('<td class="even">', pieces.winners_table(model.TaskModel("knn", rows_here), 0))
        slower = list(read(made(METHOD, 100), made(PEER, 300), made(LOOSE, 400)))
        self.assertIsNone(winners.winners(slower)[0].lucky)
        self.assertNotIn("[", winners.table(slower))

    def test_nobody_wins_on_damaged_meshes(self):
        whole, damaged = ([made(METHOD, 100, dataset=d), made(PEER, 200, dataset=d)] for d in ("ball", "ball+hole_2"))
        self.assertEqual([w.dataset for w in winners.winners(list(read(*whole, *damaged)))], ["ball"])
        self.assertIn(winners.DAMAGED, winners.table(list(read(*whole, *damaged))))
        self.assertNotIn(winners.DAMAGED, winners.table(list(read(*whole))))

    def test_the_largest_size_or_all(self):
        here = list(read(made(METHOD, 100), made(PEER, 200), made(METHOD, 100, n=10), made(PEER, 800, n=10)))
        self.assertIn("geometric mean of 1 (2.00 to 2.00): ours runs at 2.00x", winners.table(here))
        self.assertIn("geometric mean of 2 (2.00 to 8.00): ours runs at 4.00x", winners.table(here, list))

    def test_says_where_the_machine_was_busy(self):
        quiet = [made(METHOD, 100, query_set=f"k{i}", query_cpu_ns=99.0) for i in range(19)]
        slowed = made(METHOD, 100, query_set="k99", query_cpu_ns=80.0)
        self.assertNotIn("busy", winners.table(list(read(*quiet))))
        self.assertIn("busy: in 1 of 20 timed cells", winners.table(list(read(*quiet, slowed))))
        pair = [slowed | {"threads": 2, "query_set": s} for s in ("k99_threads", "build_threads")]  # waits for the other
        self.assertNotIn("busy", winners.table(list(read(*quiet, *[made(PEER, 90, query_cpu_ns=89.0)], *pair))))
        alone = [r | {"query_cpu_ns": 50.0} for r in pair]  # one core for both, or a build that is not shared out
        self.assertEqual(busy.shared(read(*alone)), (1, 1))
        told = busy.warning(read(*quiet, *alone))
        self.assertTrue(told.startswith("in 1 of 1 cell of several threads each had a core for less than 75% of the time"), told)
        self.assertEqual(busy.warning([]), "")

    def test_runs_are_not_mixed(self):
        found = winners.winners(list(read(made(METHOD, 100), made(PEER, 150) | {"host": "other"})))
        self.assertEqual([w.ratio for w in found], [None, None])

    def test_overlapping_intervals_are_no_clear_win(self):
        (won,) = winners.winners(list(read(made(METHOD, 100, low=90, high=120), made(PEER, 130, low=110, high=140))))
        self.assertFalse(won.clear)
        self.assertIn(
            "1.30x~", winners.table(list(read(made(METHOD, 100, low=90, high=120), made(PEER, 130, low=110, high=140))))
        )


class Advice(unittest.TestCase):
    ladder = staticmethod(lambda *entries, sets=("k8",): advice.rungs(list(read(*entries)), sets))

    def test_cheapest_that_holds_and_what_the_rung_below_breaks(self):
        ladder = self.ladder(made(LOOSE, 10, 0.3), made(LOOSE, 20, 1e-3, error_max=0.5, query={"checks": 9}),
                             made(METHOD, 90), made(PEER, 100))  # fmt: skip
        for tolerance, method, ns, limit in ((0, "kd_tree", 90, ("k8", "error", 1e-3)), (1e-2, "kd_tree", 90, ("k8", "error_max", 0.5)),
                                             (0.5, "forest", 10, None)):  # fmt: skip
            best, _, broken = advice.advise(ladder, tolerance)
            self.assertEqual((best.method, broken), (method, limit))
            self.assertAlmostEqual(best.cost, ns)

    def test_every_query_set_counts(self):
        entries = (made(LOOSE, 10, 1e-5), made(LOOSE, 10, 0.2, query_set="box"), made(METHOD, 40),
                   made(METHOD, 90, query_set="box"), made(PEER, 1))  # fmt: skip
        best, below, limit = advice.advise(self.ladder(*entries, sets=("k8", "box")), 1e-3)
        self.assertEqual((best.method, below.method, limit), ("kd_tree", "forest", ("box", "error", 0.2)))
        self.assertAlmostEqual(best.cost, 130)

    def test_signed_bias_and_failures_are_limits(self):
        ladder = self.ladder(made(LOOSE, 10, 0, bias=-0.3), made(PEER, 5, 0, status="wrong"), made(METHOD, 50))
        best, below, limit = advice.advise(ladder, 0.1)
        self.assertEqual((best.method, below.method, limit), ("kd_tree", "forest", ("k8", "bias", 0.3)))
        self.assertEqual(ladder[0].limit(1.0), ("k8", "wrong", None))

    def test_no_error_seen_is_no_promise(self):
        """At or below the floor of 1e-7 a claim is asked for; above it, what was measured is enough."""
        for claim in rows.CLAIMS:
            ladder = self.ladder(made(("m", "kd", "peer", claim), 10), made(METHOD, 90))
            weak = claim in ("approximate", "stochastic")
            for tolerance in (0, 1e-9, 1e-7):
                best, _, limit = advice.advise(ladder, tolerance)
                told = ("kd_tree", ("k8", f"its claim is {claim}", None)) if weak else ("m", None)
                self.assertEqual((best.method, limit), told)
            self.assertEqual(advice.advise(ladder, 2e-7)[0].method, "m")
        epsilon = made(("m", "bvh", "ours", "bounded"), 10, query={"epsilon": 0.5})
        for tolerance, method in ((0, "kd_tree"), (2e-7, "m")):  # a bound of one half is no promise of no error
            self.assertEqual(advice.advise(self.ladder(epsilon, made(METHOD, 90)), tolerance)[0].method, method)
        best, below, limit = advice.advise(
            self.ladder(made(LOOSE, 10), made(LOOSE, 10, 0.2, query_set="box"), sets=("k8", "box")), 0)  # fmt: skip
        self.assertEqual((best, limit), (None, ("box", "error", 0.2)))  # an error says more than the claim

    def test_asks_what_the_command_line_asks(self):
        """Rebuilding answers batches and no single changes, yet is not advised where single changes are asked, too."""
        rebuilt = ("rebuilt", "bvh", "ours", "exact")
        rows_here = list(read(made(rebuilt, 5, query_set="asked16", advised=True),
                              made(rebuilt, None, None, query_set="single", advised=True, status="unsupported"),
                              made(rebuilt, 5, query_set="batches"), made(METHOD, 90, query_set="asked16", advised=True),
                              made(METHOD, 90, query_set="single", advised=True), made(METHOD, 90, query_set="batches")))  # fmt: skip
        self.assertEqual(advice.asked_sets(rows_here), ["asked16", "single"])
        best, below, _ = advice.advise(advice.rungs(rows_here, advice.asked_sets(rows_here)), 0)
        self.assertEqual((best.method, below), ("kd_tree", None))
        old = [r for r in rows_here if r.values.pop("advised", False) is not None]
        self.assertEqual(advice.asked_sets(old), ["asked16", "batches"])  # rows that do not say: what all answer

    def test_nothing_holds(self):
        best, below, limit = advice.advise(self.ladder(made(LOOSE, 10, 0.3)), 0)
        self.assertEqual((best, below.method, limit), (None, "forest", ("k8", "error", 0.3)))

    def test_is_the_minimum_by_brute_force(self):
        rng = random.Random(5)
        ladder = self.ladder(*(made(METHOD, rng.uniform(1, 99), rng.choice((0, 1e-4, 1e-2, 0.3)), build={"i": i},
                                    error_max=rng.choice((0, 1e-3, 0.5))) for i in range(40)))  # fmt: skip
        for tolerance in (0, 1e-4, 1e-3, 0.1, 1):
            holding = [r.cost for r in ladder if max(r.rows[0].error, r.rows[0].error_max) <= tolerance]
            best, _, _ = advice.advise(ladder, tolerance)
            self.assertEqual(best.cost if best else None, min(holding, default=None))


class Stability(unittest.TestCase):
    def test_the_worst_status_shows_and_absent_queries_do_not_hide_it(self):
        def hard(query_set, status, **values):
            return made(METHOD, None, values.pop("error", None), query_set=query_set, status=status, **values) | {
                "block": "hard/ties", "dataset": "ties"}  # fmt: skip

        found = list(read(hard("a", "ok", error=0.0), hard("b", "wrong", error=0.25, reason="query 3"),
                          hard("c", "unsupported")))  # fmt: skip
        cases, columns, cells = stability.matrix(found, ["kd_tree"])
        cell = cells["ties", columns[0]]
        self.assertEqual(
            (cases, columns[0].label, cell.letter, cell.error, cell.bad, cell.count), (["ties"], "kd_tree", "W", "0.25", 1, 2)
        )
        self.assertIn("query 3", cell.detail)

    def test_who_faced_no_hard_case_is_named_below_with_the_reason(self):
        hard = made(METHOD, None, 0.0) | {"block": "hard/ties", "dataset": "ties"}
        doubles = made(("tree_double", "kd", "ours", "exact"))
        absent = made(("gone", "kd", "peer", "exact"), None, None, status="not_built")
        html = pieces.matrix_table(model.TaskModel("knn", list(read(hard, doubles, absent, made(METHOD)))))
        self.assertIn("Not in this matrix: tree_double. The hard cases are clouds of floats.", html)
        self.assertNotIn("Not in", pieces.matrix_table(model.TaskModel("knn", list(read(hard, absent, made(METHOD))))))

    def test_every_status_has_its_own_letter_and_word(self):
        for table in (stability.LETTERS, stability.WORDS):
            self.assertEqual(set(table), {*rows.STATUSES, "inexact"})
            self.assertEqual(len(set(table.values())), len(rows.STATUSES) + 1)

    def test_a_refusal_shows_though_the_method_errs_elsewhere(self):
        hard = lambda query_set, status, error: made(LOOSE, None, error, query_set=query_set, status=status) | {
            "block": "hard/negative", "dataset": "negative"}
        found = list(read(hard("knn8", "ok", 0.3), hard("radius", "refused", None)))
        _, columns, cells = stability.matrix(found, ["forest"])
        self.assertEqual(cells["negative", columns[0]].letter, "R")

    def test_builds_have_columns_of_their_own_and_allowed_errors_show(self):
        def hard(robust, error):
            return made(LOOSE, None, error, build={"quality": "low", "robust": robust}) | {
                "block": "hard/ties", "dataset": "ties"}  # fmt: skip

        found = list(read(hard(False, 0.19), hard(True, 0.0)))
        _, columns, cells = stability.matrix(found, ["forest"])
        self.assertEqual([c.label for c in columns], ["forest, robust no", "forest, robust yes"])
        shown = [(cells["ties", c].status, cells["ties", c].error) for c in columns]
        self.assertEqual(shown, [("inexact", "0.19"), ("ok", "")])


class Approximate(unittest.TestCase):
    FOREST, MEANS = ("flann_forest", "forest", "peer", "approximate"), ("flann_kmeans", "kmeans", "peer", "approximate")
    LEAVES, BOUNDED = ("bvh_leaves", "bvh", "ours", "approximate"), ("bvh_epsilon", "bvh", "ours", "bounded")

    def at(self, method, ns, recall, **query):
        return made(method, ns, 1 - recall, query_set="knn8_self", query=query) | {"knn_recall": recall}

    def test_each_rung_is_held_against_the_fastest_rival_of_its_recall(self):
        found = approximate.rungs(list(read(
            self.at(self.FOREST, 100, 0.5, checks=1), self.at(self.FOREST, 400, 0.9, checks=2), self.at(self.MEANS, 300, 0.95, checks=1),
            self.at(self.LEAVES, 50, 0.4, leaves=1), self.at(self.LEAVES, 310, 0.9, leaves=2),
            self.at(self.LEAVES, 600, 0.95, leaves=3), self.at(self.BOUNDED, 999, 0.99, epsilon=1),
            self.at(METHOD, 10, 1.0), self.at(("x", "kd", "peer", "approximate"), 1, 1.0))))  # fmt: skip
        self.assertEqual([(r.recall, r.rival and r.rival.query_ns, r.verdict) for r in found],
                         [(0.4, 100, "beyond"), (0.9, 300, "on"), (0.95, 300, "behind"), (0.99, None, "beyond")])  # fmt: skip
        text = approximate.summary(found)
        for words in ("2 of 4 lie beyond", "1 on it, 1 behind", "0.5 at least", "1 finds more"):
            self.assertIn(words, text)

    def test_without_rivals_there_is_no_verdict(self):
        self.assertEqual(approximate.by_set(list(read(self.at(self.LEAVES, 50, 0.4)))), {})

    def test_answers_outside_the_claim_set_no_frontier(self):
        wrong = self.at(self.FOREST, 1, 1.0) | {"status": "wrong"}
        (rung,) = approximate.rungs(list(read(wrong, self.at(self.FOREST, 90, 0.9, checks=9), self.at(self.LEAVES, 50, 0.4))))
        self.assertEqual((rung.rival.query_ns, rung.verdict), (90, "beyond"))


class Small(unittest.TestCase):
    def test_units(self):
        self.assertEqual(
            [units.duration(v) for v in (3.21, 999, 1500, 2.5e6, 3e9)], ["3.21 ns", "999 ns", "1.5 µs", "2.5 ms", "3 s"]
        )
        self.assertEqual([units.figure(v) for v in (None, 0, 1e-7, 0.25, 123456)], ["-", "0", "1e-7", "0.25", "1.2e5"])
        self.assertEqual([units.brief(v) for v in (0.00606, 1.9e-6, 4.57, 149.2, 3e7)], ["0.0061", "1.9e-6", "4.6", "149", "3e7"])
        self.assertEqual([units.count(v) for v in (7, 1000, 1_000_000)], ["7", "1k", "1M"])

    def test_recall_and_leaves_have_columns_of_their_own(self):
        row = made() | {"knn_recall": 0.99998, "knn_leaves": 3.5, "knn_missing": 0.25}
        table = model.table(model.task_models(list(read(row))))
        shown = dict(zip(table["columns"], table["rows"][0]))
        self.assertEqual((shown["recall"], shown["leaves"]), (0.99998, 3.5))
        self.assertEqual(table["strings"][shown["extra"]], "missing 0.25")

    def test_bytes_are_all_that_a_query_needs(self):
        """An index over the user's points needs them: 8 bytes of its own beside 12 are as much as 20 with a copy."""
        found = list(read(made(PEER, bytes=8000) | {"input_bytes": 12000}, made(METHOD, bytes=20000) | {"input_bytes": 0},
                          made(LOOSE, bytes=5000)))  # fmt: skip
        (task,) = model.task_models(found)
        self.assertEqual([(p["bytes"], p["own"]) for p in model.points(task, found)], [(20, 8), (20, 20), (5, 5)])
        self.assertIn("with the user's points", model.bytes_title(task)[1])
        (older,) = model.task_models(list(read(made(bytes=8000))))  # rows that do not know: no word of it
        self.assertEqual(model.bytes_title(older), "bytes per point, log")

    def test_where_a_wrong_answer_counts_one_the_worst_says_nothing(self):
        wrong = made(error=0.009, error_max=1.0)
        rows_here = read(*(wrong | {"task": t, "query_set": s} for t, s in (("inside", "far"), ("distance_field", "near"), ("distance_field", "trace"))))
        self.assertEqual([r.error_max for r in rows_here], [None, 1.0, None])
        inside = [rows_here.rows[0]]
        self.assertEqual(advice.advise(advice.rungs(inside, ["far"]), 0.02)[0].method, "kd_tree")
        self.assertIn("largest error 0.009", stability.Cell("wrong", inside[0], 1, 1).detail)

    def test_errors_are_called_what_they_are(self):
        field, shadow = tasks.text("distance_field"), tasks.text("shadow")
        self.assertEqual([field.error_of(s) for s in ("near", "uniform")], ["mean error in longest sides", "share of wrong sides"])
        self.assertEqual({t: tasks.text(t).mean for t in ("knn", "ray", "brdf_integral", "region_average", "light_transport", "shadow")},
                         {"knn": True, "ray": True, "brdf_integral": False, "region_average": False, "light_transport": False,
                          "shadow": False})  # fmt: skip
        self.assertNotIn("mean over queries", page._meaning("shadow", shadow))
        self.assertIn("Charted is the mean over queries.", page._meaning("distance_field", field))

    def test_no_two_methods_look_alike(self):
        found = model.task_models(
            list(read(*(made((f"m{i}", "kd", "peer" if i % 2 else "ours", "exact")) for i in range(24))))
        )
        looks = list(found[0].looks.values())
        for a, b in itertools.combinations(looks, 2):
            self.assertNotEqual((a.color, a.shape, a.source), (b.color, b.shape, b.source))

    def test_nor_do_ours_and_a_peer_of_one_colour(self):
        ours, peers = (f"{which}_first_hit" for which in ("kd", "kd2", "kd3")), ("embree_parity", "embree_facing", "mis_embree")
        found = palette.looks(read(*(made((m, "kd", "ours", "exact")) for m in ours),
                                   *(made((m, "bvh", "peer", "exact")) for m in peers)))  # fmt: skip
        self.assertEqual({look.color for look in found.values()}, {palette.BLUE})
        self.assertEqual(len({look.shape for look in found.values()}), 6)

    def test_a_colour_is_that_of_the_family_or_library_in_every_report(self):
        names = {"bvh": ("bvh", "ours"), "bvh_wide": ("bvh", "ours"), "rebuilt_bvh_wide": ("bvh", "ours"), "kd_tree": ("kd", "ours"),
                 "kd_tree_eps": ("kd", "ours"), "nanoflann_dynamic": ("kd", "peer"), "rebuilt_nanoflann": ("kd", "peer"),
                 "flann_forest": ("forest", "peer"), "flann_linear": ("brute", "peer")}  # fmt: skip
        entries = [made((m, family, source, "exact")) for m, (family, source) in names.items()]
        rng = random.Random(2)
        for _ in range(20):
            some = rng.sample(entries, rng.randrange(1, len(entries) + 1))
            looks = palette.looks(read(*some))
            for m, look in looks.items():
                self.assertEqual(look.color, palette.color_of(m, names[m][1], names[m][0]))
        of = {m: look.color for m, look in palette.looks(read(*entries)).items()}
        self.assertEqual(of["bvh"], of["rebuilt_bvh_wide"])
        self.assertEqual(of["nanoflann_dynamic"], of["rebuilt_nanoflann"])
        self.assertEqual(len({of["bvh"], of["kd_tree"]}), 2)
        self.assertEqual(len({of["flann_forest"], of["nanoflann_dynamic"]}), 2)

    def test_a_method_looks_the_same_in_every_task(self):
        names = [f"m{i}" for i in range(9)]
        entries = [made((n, "octree", "peer", "exact")) for n in names]
        entries += [made((n, "octree", "peer", "exact")) | {"task": "ray"} for n in reversed(names)]
        knn, ray = model.task_models(read(*entries))
        self.assertEqual(knn.looks, ray.looks)

    def test_methods_that_are_explained_exist(self):
        """Each name is one that its task registers; an ending stands for all names that have it."""
        for name, text in tasks.TASKS.items():
            sources = "".join(p.read_text() for p in (Path(__file__).parents[2] / "bench" / name).glob("*.cpp"))
            for method in (m for names, _ in text.methods for m in names.split(", ")):
                known = f'{method[1:]}"' if method.startswith("…") else f'"{method}"'
                self.assertIn(known, sources, name)

    def test_a_picture_that_cannot_be_shown_costs_a_warning(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "bad.svg").write_text("<svg><script>alert(1)</script></svg>")
            Path(folder, "good.svg").write_text("<svg/>")
            fixture.write(
                Path(folder, "pictures.jsonl"),
                [{"file": "bad.svg"}, {"file": "absent.png"}, {"title": "x"}, {"file": "good.svg"}],
            )
            shown, warnings = pictures.read([folder])
        self.assertEqual((len(shown), len(warnings)), (1, 3))


if __name__ == "__main__":
    unittest.main()
