"""The claims ledger and the figures of rays, on rows made by hand."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

import report_fixture as fixture
from bench.report import claims, ledger, model, page, pieces, rays, rows
from report_made import METHOD, made, read, read_text

BVH, BSP = ("bvh", "bvh", "ours", "exact"), ("bsp_tree", "bsp", "ours", "exact")
EVEN, UNEVEN = ("uniform_cube", "uniform_ball", "grid"), ("displaced_sphere", "clusters", "lidar", "filaments")
ASKED = ("knn8_self", "knn8_off", "knn8_far", "radius_self")


class Claims(unittest.TestCase):
    @staticmethod
    def trees(kd, bvh, bsp=900.0, datasets=EVEN, sets=ASKED, sizes=(1000,), leaf=8, **values):
        """Rows of the three binary trees; a time may be a function of the query set."""
        at = lambda t, s: t(s) if callable(t) else t
        return [made(m, at(t, s), dataset=d, n=n, query_set=s, build={"leaf_size": leaf}, **values)
                for m, t in ((METHOD, kd), (BVH, bvh), (BSP, bsp)) for d in datasets for n in sizes for s in sets]  # fmt: skip

    @staticmethod
    def verdict(name, entries):
        return next(v for v in claims.ledger(list(read(*entries))) if v.id == name)

    def test_every_claim_of_the_list_has_a_verdict_and_none_is_written_there(self):
        listed = json.loads(claims.LIST.read_text())
        ids = [f"{letter}{k}" for letter, last in (("S", 8), ("T", 3), ("H", 13), ("L", 8)) for k in range(1, last + 1)]
        self.assertEqual([c["id"] for c in listed], ids)
        for claim in listed:
            self.assertNotIn("verdict", claim)
        self.assertEqual({v.word for v in claims.ledger([])}, {claims.NOT_RUN})

    def test_holds_where_every_group_supports_it(self):
        v = self.verdict("S1", self.trees(100, 200))
        self.assertEqual((v.word, v.condition), (claims.HOLDS, ""))
        self.assertEqual(len(v.figures), 8)  # two contests, four places
        for _, ratio, cells, supports in v.figures:
            self.assertAlmostEqual(ratio, 0.5)
            self.assertEqual((cells, supports), (3, True))
        self.assertEqual(self.verdict("S2", self.trees(200, 100, datasets=UNEVEN)).word, claims.HOLDS)

    def test_does_not_hold_where_none_does_or_times_cannot_be_told_apart(self):
        for kd, bvh in ((200, 100), (100, 100), (100, 105)):
            self.assertEqual(self.verdict("S1", self.trees(kd, bvh)).word, claims.FAILS, (kd, bvh))

    def test_holds_only_if_names_contest_and_place(self):
        v = self.verdict("S2", self.trees(100, lambda s: 20 if s.endswith("_off") else 200, datasets=UNEVEN))
        self.assertEqual(v.word, claims.ONLY_IF)
        for contest in claims.CONTESTS.values():
            self.assertIn(f"{contest}: {claims.PLACES['off']}", v.condition)
        self.assertNotIn(claims.PLACES["self"], v.condition)

    def test_a_size_at_which_it_fails_is_not_averaged_away(self):
        entries = self.trees(50, 200, sizes=(1000,)) + self.trees(105, 100, sizes=(100_000,))
        v = self.verdict("S1", entries)
        self.assertTrue(all(supports for *_, supports in v.figures))  # over both sizes together
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertIn("(at 1k points)", v.condition)
        self.assertEqual(set(v.spread), {("1k 0.25, 100k 1.05", "")})

    def test_clouds_that_contradict_are_named(self):
        v = self.verdict("S1", self.trees(20, 100, datasets=EVEN[:2]) + self.trees(150, 100, datasets=EVEN[2:]))
        self.assertEqual({against for _, against in v.spread}, {"grid 1.5"})

    def test_a_rival_that_was_not_there_is_told(self):
        entries = self.trees(100, 200, sizes=(1000, 2000))
        v = self.verdict("S1", [e for e in entries if e["family"] != "bsp" or e["n"] == 1000])
        self.assertIn("without bsp_tree among the binary trees at 2k points", v.coverage)

    def test_the_best_of_each_family_is_another_contest(self):
        wide = [made(("bvh16", "bvh", "ours", "exact"), 20, dataset=d, query_set=s) for d in EVEN for s in ASKED]
        v = self.verdict("S1", self.trees(100, 200) + wide)
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertIn(claims.CONTESTS["binary"], v.condition)
        self.assertNotIn(claims.CONTESTS["best"], v.condition)

    def test_the_binary_contest_is_between_the_textbook_s_bounds(self):
        # A KD-tree that keeps boxes, too, is a BVH in disguise: it may win only as the best of its family.
        boxed = [made(METHOD, 10, dataset=d, query_set=s, build={"leaf_size": 8, "bounds": "tight_box"})
                 for d in EVEN for s in ASKED]  # fmt: skip
        v = self.verdict("S1", self.trees(300, 200) + boxed)
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertIn(claims.CONTESTS["best"], v.condition)
        self.assertNotIn(claims.CONTESTS["binary"], v.condition)

    def test_one_rival_suffices_to_lose_to(self):
        self.assertEqual(self.verdict("S1", self.trees(100, 200, bsp=50)).word, claims.FAILS)

    def test_a_mean_does_not_hide_that_most_cells_contradict(self):
        entries = self.trees(1, 100, datasets=EVEN[:1]) + self.trees(150, 100, datasets=EVEN[1:])
        v = self.verdict("S1", entries)
        self.assertLess(v.figures[0][1], 1)
        self.assertEqual(v.word, claims.FAILS)

    def test_wrong_answers_and_unequal_leaves_do_not_count(self):
        self.assertEqual(self.verdict("S1", self.trees(100, 200, status="wrong", error=0.5)).word, claims.NOT_RUN)
        unequal = [r for r in self.trees(100, 200) if r["method"] == "kd_tree"]
        unequal += [r for r in self.trees(100, 200, leaf=32) if r["method"] == "bvh"]
        self.assertEqual({c.contest for c in self.verdict("S1", unequal).cells}, {"best"})

    def test_clouds_of_the_other_claim_and_other_queries_do_not_count(self):
        self.assertEqual(self.verdict("S1", self.trees(100, 200, datasets=UNEVEN)).word, claims.NOT_RUN)
        self.assertEqual(self.verdict("S1", self.trees(100, 200, sets=("box_self",))).word, claims.NOT_RUN)

    def test_figures_by_cloud_hold_visits_beside_times(self):
        entries = self.trees(100, 200, bsp=400, sizes=(1000, 10_000), sets=("knn8_self",))
        entries = [e | {"knn_leaves": {"kd": 6.0, "bvh": 2.0, "bsp": 9.0}[e["family"]]} for e in entries]
        v = self.verdict("S1", entries)
        found = claims.by_cloud(v)
        self.assertEqual(len(found), 6)
        for contests in found.values():
            for times, visits, bsp, cells in contests.values():
                for figure, right in ((times, 0.5), (visits, 3.0), (bsp, 2.0), (cells, 1)):
                    self.assertAlmostEqual(figure, right)
        self.assertIn("fewer than 3 sizes", v.coverage)

    def test_the_page_shows_verdict_figures_and_rows(self):
        text = ledger.section(read(*self.trees(100, 200)))
        for words in ("S1", claims.HOLDS, "uniform_ball", "0.5", "rows.jsonl:1", claims.NOT_RUN):
            self.assertIn(words, text)

    def test_only_claims_of_tasks_with_rows_are_listed(self):
        def listed(*entries):
            text = ledger.section(read(*entries))
            return re.findall('id="claim-([^"]+)"', text), text

        every = [c["id"] for c in json.loads(claims.LIST.read_text())]
        ids, text = listed(*self.trees(100, 200))
        self.assertEqual(ids, ["S1", "S2"])
        self.assertIn(f"{len(every) - 2} more are {claims.NOT_RUN}", text)
        self.assertIn("shadow", text.rpartition("more are")[2])
        self.assertEqual(listed(*(r | {"task": "inside"} for r in self.trees(100, 200)))[0], ["S3", "S4", "S5"])  # their other task
        self.assertEqual(listed(*(r | {"task": "elsewhere"} for r in self.trees(100, 200)))[0], [])


def ray(method, ns=100.0, dataset="icosphere", n=1000, query_set="camera", hard=False, build=None, **values):
    """A row of the task ray."""
    block = f"hard/{dataset}" if hard else f"{dataset}:{n}"
    figures = {"query_ns": ns, "error": 0.0, "error_floor": 1e-7, "build_s": 1.0, "bytes": 1000}
    return fixture.row("ray", block, dataset, n, method, query_set, build or {}, {}, **({"status": "ok"} | figures | values))


KD_RAY, BVH_RAY, BSP_RAY = (m for m in (("kd_tree", "kd", "ours", "bounded"), ("bvh", "bvh", "ours", "bounded"),
                                        ("bsp_tree", "bsp", "ours", "bounded")))  # fmt: skip
FAST_RAY = ("brute_fast", "brute", "ours", "approximate")
EMBREE = ("embree_single", "bvh", "peer", "approximate")


class RayClaims(unittest.TestCase):
    verdict = staticmethod(Claims.verdict)

    def test_s3_compares_trees_by_kinds_of_rays(self):
        def trees(bvh):
            return [ray(m, t, query_set=s, build={"leaf_size": 8}) for s in ("camera", "random", "edge")
                    for m, t in ((KD_RAY, 200), (BSP_RAY, 300), (BVH_RAY, bvh(s)))]  # fmt: skip

        v = self.verdict("S3", trees(lambda s: 100))
        self.assertEqual(v.word, claims.HOLDS)
        self.assertEqual(len(v.figures), 6)  # two contests, three kinds
        v = self.verdict("S3", trees(lambda s: 400 if s == "random" else 100))
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertIn(claims.PLACES["coherent"], v.condition)
        self.assertNotIn(claims.PLACES["scattered"], v.condition)

    def test_s3_takes_closest_points_too(self):
        def trees(task, sets, bvh):
            return [ray(m, t, query_set=s, build={"leaf_size": 8}) | {"task": task} for s in sets
                    for m, t in ((KD_RAY, 200), (BSP_RAY, 300), (BVH_RAY, bvh))]  # fmt: skip

        rows = trees("ray", ("camera",), 100) + trees("closest_point", ("near", "far"), 400)
        v = self.verdict("S3", rows)
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertEqual(len(v.figures), 6)  # two contests: rays, queries near the mesh and away from it
        self.assertNotIn(claims.PLACES["surface"], v.condition)

    def test_s3_takes_points_inside_too(self):
        def signs(bvh):
            return [ray(m, t, query_set=s) | {"task": "inside", "method": f"{m[1]}_first_hit"} for s in ("near", "uniform")
                    for m, t in ((KD_RAY, 200), (BSP_RAY, 300), (BVH_RAY, bvh))]  # fmt: skip

        v = self.verdict("S3", signs(100))
        self.assertEqual((v.word, len(v.figures)), (claims.HOLDS, 4))  # two contests, near the mesh and away from it
        self.assertEqual(self.verdict("S3", signs(400)).word, claims.FAILS)

    def test_s4_and_s5_look_at_other_tasks_too(self):
        def rows(task, bsp, bvh, dear):
            return [ray(m, build_s=s, bytes=1000, **{f"{task}_references": 1000, f"{task}_node_bytes": 24}) | {"task": task, "method": name}
                    for m, name, s in ((BVH_RAY, bvh, 1.0), (BSP_RAY, bsp, dear))]  # fmt: skip

        entries = (rows("ray", "bsp_tree", "bvh", 5.0) + rows("closest_point", "bsp_tree", "bvh", 0.5)
                   + rows("inside", "bsp_first_hit", "bvh_first_hit", 3.0))  # fmt: skip
        v = self.verdict("S4", entries)
        found = {words: (round(ratio, 6), yes) for words, ratio, _, yes in v.figures}
        self.assertEqual(len(found), 9)
        self.assertEqual(found["build time"], (5, True))
        self.assertEqual(found["build time, for closest points"], (0.5, False))
        self.assertEqual(found["build time, for points inside"], (3, True))
        v = self.verdict("S5", entries)
        self.assertEqual(len(v.figures), 6)  # two families in three tasks
        self.assertEqual(len(v.table[1]), 6)

    def test_s4_takes_cost_apart(self):
        def costs(seconds, bytes):
            return [ray(BVH_RAY, build_s=1.0, bytes=1000, ray_references=1000),
                    ray(BSP_RAY, build_s=seconds, bytes=bytes, ray_references=3000)]  # fmt: skip

        v = self.verdict("S4", costs(5.0, 2000))
        self.assertEqual([(round(f[1], 6), f[3]) for f in v.figures], [(5, True), (2, True), (3, True)])
        self.assertEqual(v.word, claims.HOLDS)
        v = self.verdict("S4", costs(5.0, 900))
        self.assertEqual((v.word, "memory" in v.condition, "build time" in v.condition), (claims.ONLY_IF, False, True))

    def test_s5_holds_only_for_nodes_that_hold_no_more(self):
        def nodes(kd, bsp, bvh):
            return [ray(m, ray_node_bytes=b) for m, b in ((KD_RAY, kd), (BSP_RAY, bsp), (BVH_RAY, bvh))]

        self.assertEqual(self.verdict("S5", nodes(8, 16, 24)).word, claims.HOLDS)
        v = self.verdict("S5", nodes(12, 24, 64))
        self.assertEqual((v.word, v.condition.startswith("a KD node is smaller")), (claims.ONLY_IF, True))
        self.assertEqual(self.verdict("S5", nodes(64, 24, 12)).word, claims.FAILS)

    def test_s7_counts_every_difference_from_exact_arithmetic(self):
        def asked(case, missing, leaks=None):
            return ray(FAST_RAY, dataset=case, hard=True, query_set="closest", ray_judged=1000, ray_surplus=0,
                       ray_missing=missing, ray_leaks_per_million=leaks)  # fmt: skip

        self.assertEqual(self.verdict("S7", [asked("caps", 0), asked("at_vertices", 0, 0.0)]).word, claims.HOLDS)
        v = self.verdict("S7", [asked("caps", 0), asked("at_vertices", 250, 251_000.0)])
        self.assertEqual((v.word, v.condition), (claims.ONLY_IF, "caps"))
        self.assertEqual(v.figures[0][1], 251_000)
        self.assertEqual(self.verdict("S7", [asked("caps", 1)]).word, claims.FAILS)
        self.assertEqual(self.verdict("S7", [asked("no_such_case", 1)]).word, claims.NOT_RUN)

    def test_the_page_shows_the_lines_behind_a_claim_of_sizes(self):
        text = ledger.section(read(*[ray(m, ray_node_bytes=24) for m in (KD_RAY, BVH_RAY)]))
        self.assertIn("bytes of an inner node", text)


class RayFigures(unittest.TestCase):
    @staticmethod
    def task(*entries):
        return model.task_models(read(*entries))[0]

    def test_a_case_has_a_line_for_each_way_to_err_and_none_where_nobody_does(self):
        case = lambda name, method, **values: ray(method, dataset=name, hard=True, query_set="closest", ray_judged=1000,
                                                  **({"ray_missing": 0, "ray_surplus": 0, "ray_t_outside": 0} | values))  # fmt: skip
        task = self.task(
            case("vertices", BVH_RAY, ray_leaks_per_million=0.0),
            case("vertices", EMBREE, ray_leaks_per_million=16_503.0, ray_missing=16),
            case("edge_on", BVH_RAY),
            case("edge_on", EMBREE, ray_missing=18, ray_surplus=16, ray_t_outside=2, ray_t_ulp_max=1e4),
            case("easy", BVH_RAY), case("easy", EMBREE),
            case("needles_4e4", EMBREE), case("needles_4e4", BVH_RAY, ns=5e5),
        )  # fmt: skip
        columns, lines, clean = rays.hard_lines(task)
        self.assertEqual([c.method for c in columns], ["bvh", "embree_single"])
        shown = {(case, words): [values.get(c) for c in columns] for case, words, values, _ in lines}
        self.assertEqual(shown, {
            ("vertices", "leaks"): ["0", "16.5k"], ("edge_on", "misses"): ["0", "18k"],
            ("edge_on", "hits that are none"): ["0", "16k"], ("edge_on", "t beyond the triangle"): ["0", "2,000"],
            ("edge_on", "worst t, ulp"): [None, "10,000"], ("needles_4e4", "time per ray"): ["500 µs", "100 ns"],
        })  # fmt: skip
        self.assertEqual(clean, ["easy", "needles_4e4"])
        self.assertIn("16.5k", rays.hard_table(task))
        self.assertEqual(rays.hard_table(self.task(ray(BVH_RAY))), "")

    def test_a_ray_that_goes_through_to_what_lies_behind_has_not_missed_yet_it_errs(self):
        case = lambda name, **values: ray(EMBREE, dataset=name, hard=True, query_set="closest", ray_judged=1000,
                                          **({"ray_missing": 0, "ray_false_misses": 0} | values))  # fmt: skip
        crash = ray(EMBREE, None, dataset="nan", hard=True, query_set="closest", status="crashed")
        _, lines, clean = rays.hard_lines(self.task(case("far", ray_false_misses=36), case("easy"), case("nan"), crash))
        self.assertEqual([(c, words, *values.values()) for c, words, values, _ in lines], [("far", "what lies behind", "36k")])
        self.assertEqual(clean, ["easy"], "a crash is no answer without an error")
        self.assertEqual([rays.share(v) for v in (0, 999, 10_000, 999_400, 1e6)], ["0", "999", "10k", "999k", "all"])

    def test_methods_that_agree_share_a_curve(self):
        out = lambda method, offset, hits: ray(method, dataset="ball", hard=True, query_set=f"offset_{offset}",
                                               ray_self_hits_per_million=hits)  # fmt: skip
        alike = [out(BVH_RAY, "0", 521_600.0), out(EMBREE, "0", 522_600.0), out(BVH_RAY, "1e-6", 0.0), out(EMBREE, "1e-6", 0.0)]
        (methods, curve), = rays.offset_curves(self.task(*alike))
        self.assertEqual((methods, curve), (["bvh", "embree_single"], {0.0: 521_600.0, 1e-6: 0.0}))
        self.assertIn("one line stands for all", rays.offset_note(self.task(*alike)))
        self.assertEqual(len(rays.offset_curves(self.task(*alike, out(KD_RAY, "0", 400_000.0)))), 2)

    def test_the_smallest_offset_without_a_self_hit(self):
        out = lambda method, offset, hits: ray(method, dataset="ball", hard=True, query_set=f"offset_{offset}",
                                               ray_self_hits_per_million=hits)  # fmt: skip
        task = self.task(out(BVH_RAY, "0", 5e5), out(BVH_RAY, "1e-7", 0.0), out(BVH_RAY, "1e-6", 0.0),
                         out(EMBREE, "0", 5e5), out(EMBREE, "1e-7", 300.0), out(EMBREE, "1e-6", 0.0))  # fmt: skip
        self.assertIn("1e-07 for bvh; 1e-06 for embree_single", rays.offset_note(task))
        self.assertIsNotNone(rays.offset_chart(task))
        built = lambda builder, offset, hits: ray(BVH_RAY, dataset="ball", hard=True, query_set=f"offset_{offset}",
                                                  build={"builder": builder}, ray_self_hits_per_million=hits)  # fmt: skip
        alike = self.task(built("a", "0", 5e5), built("b", "0", 5e5), built("a", "1e-6", 0.0), built("b", "1e-6", 0.0),
                          out(EMBREE, "1e-6", 0.0))  # fmt: skip
        self.assertIn("1e-06 for all.", rays.offset_note(alike))
        apart = self.task(built("a", "1e-7", 0.0), built("b", "1e-7", 5.0), built("b", "1e-6", 0.0), out(EMBREE, "1e-6", 7.0))
        self.assertIn("1e-07 for bvh, builder a; 1e-06 for bvh, builder b; none of these for embree_single",
                      rays.offset_note(apart))  # fmt: skip
        self.assertIsNone(rays.offset_chart(self.task(ray(BVH_RAY))))

    def test_rebuilding_pays_once_it_saves_more_than_it_costs(self):
        frame = lambda kind, seconds, ns: ray(EMBREE, ns, query_set=f"frame8_{kind}", ray_update_s=seconds,
                                              query_ns_low=ns, query_ns_high=ns)  # fmt: skip
        for refit, rebuilt, words in (((0.001, 300), (0.011, 200), "from 100,000 rays"), ((0.001, 200), (0.011, 300), "never"),
                                      ((0.02, 300), (0.01, 200), "always")):  # fmt: skip
            task = self.task(frame("refit", *refit), frame("rebuilt", *rebuilt))
            self.assertIn(words.replace("100,000", "1e5"), rays.moving_table(task).replace("100,000", "1e5"))
            self.assertIsNotNone(rays.moving_chart(task))

    def test_the_page_keeps_its_title_where_there_are_charts_of_rays(self):
        frame = lambda kind: ray(EMBREE, query_set=f"frame8_{kind}", ray_update_s=0.1)
        text = page.build(read(frame("refit"), frame("rebuilt")), [])
        self.assertIn("<h1>Treeline: speed against accuracy</h1>", text)
        self.assertIn("cells of the task ray.", text)
        self.assertIn('id="ray-moving"', text)

    def test_crashes_that_are_assertions_are_told_apart(self):
        case = lambda reason: ray(EMBREE, None, dataset="nan_rays", hard=True, query_set="closest", status="crashed",
                                  reason=reason)  # fmt: skip
        told = lambda reason: "are assertions" in pieces.matrix_table(self.task(case(reason)))
        self.assertTrue(told("an assertion that its package was built with failed, signal 6 (Aborted)"))
        self.assertFalse(told("signal 11 (Segmentation fault)"))

    def test_a_refit_that_was_not_asked_for_is_not_called_missing(self):
        for reason, words in (("not measured: elsewhere", "not measured"), ("has no refit", "no refit")):
            task = self.task(ray(EMBREE, query_set="frame8_rebuilt", ray_update_s=0.1),
                             ray(EMBREE, None, query_set="frame8_refit", status="unsupported", reason=reason))  # fmt: skip
            told = rays.moving_table(task)
            self.assertEqual([w for w in ("not measured", "no refit") if f"<td>{w}</td>" in told], [words])


if __name__ == "__main__":
    unittest.main()
