"""The cards and claims of the task brdf_integral, on rows made by hand."""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import claims, model, surfaces
from report_made import made, read

OWN = ("own", "samples", "ours", "stochastic")
FACETS = ("quadrature_facets", "quadrature", "ours", "approximate")
BARE = ("unmasked", "quadrature", "ours", "approximate")
TERM = ("compensated", "kernel", "ours", "approximate")
SCHLICK = ("schlick", "kernel", "ours", "approximate")
ANGLE = ("solid_angle", "kernel", "ours", "bounded")
AREA = ("area_over_r2", "kernel", "ours", "approximate")
SCALAR = ("scalar", "kernel", "ours", "bounded")
FINE = {"nodes": 32}


def row(method, dataset, query_set, error=0.1, build=None, query=None, ns=100.0, bias=None, most=None, **extra):
    found = made(method, ns, error=error, dataset=dataset, query_set=query_set, build=build or {}, query=query or {})
    found |= {"task": "brdf_integral", "bias": bias, "error_max": most, "query_cpu_ns": ns}
    return found | {f"brdf_integral_{k}": v for k, v in extra.items()}


def cards_of(*entries):
    (task,) = model.task_models(read(*entries))
    numbers = {id(r): i for i, r in enumerate(task.soft)}
    return {card.title: card for card in surfaces.cards(task, numbers, 460)}


def verdict(name, *entries):
    return next(v for v in claims.ledger(list(read(*entries))) if v.id == name)


def supported(found):
    return {words: supports for words, _, _, supports in found.figures}


def samples(points, n, error):
    return row(OWN, "ggx_0.5", "albedo", error, query={"points": points, "samples": n})


class Cards(unittest.TestCase):
    def test_slopes_are_of_the_logarithms(self):
        self.assertAlmostEqual(surfaces.slope([(16, 0.4), (64, 0.2), (256, 0.1)]), -0.5)
        self.assertAlmostEqual(surfaces.slope([(10, 1), (100, 0.1)]), -1)

    def test_errors_fall_by_points(self):
        cards = cards_of(*(samples(p, n, e) for p, n, e in (("random", 16, 0.4), ("random", 64, 0.2), ("r2", 16, 0.1), ("r2", 64, 0.025))))
        (figure,) = cards["Errors fall"].figures
        text = str(figure.chart.to_dict())
        self.assertIn("−0.50", text)
        self.assertIn("−1.00", text)

    def test_marks_say_what_they_are(self):
        fall = [samples("random", n, e) for n, e in ((16, 0.4), (64, 0.2))]
        furnace = [row(TERM, "furnace", s, build={"compensation": "none"}, answer=a, truth=1) for s, a in (("white_0.5", 0.7), ("white_1", 0.4))]
        halo = [row(OWN, "beckmann_0.1", "albedo", 0.1, query={"points": "random", "samples": 16}, beyond_10=0.5, beyond_20=0.1)]
        cards = cards_of(*fall, *furnace, *halo)
        for title in ("Errors fall", "White furnace", "Halo"):
            told = [layer["encoding"].get("tooltip") for layer in cards[title].figures[0].chart.to_dict()["layer"]]
            self.assertTrue(any(isinstance(t, list) and len(t) > 1 for t in told), title)

    def test_what_is_exact_but_for_rounding_neither_falls_nor_ranks(self):
        exact = [samples("random", n, e) for n, e in ((16, 3e-16), (1024, 4e-16))]
        cards = cards_of(*exact)
        self.assertEqual([title for title in ("Errors fall", "What a second buys") if title in cards], [])
        (figure,) = cards_of(*exact, samples("r2", 16, 0.1), samples("r2", 64, 0.025))["Errors fall"].figures
        self.assertEqual({v.get("points") for v in figure.chart.to_dict()["layer"][2]["data"]["values"]}, {"r2"})

    def test_a_second_buys_one_over_variance_and_time(self):
        cards = cards_of(row(OWN, "ggx_0.5", "albedo", 0.01, query={"points": "random", "samples": 1024}, ns=1e5))
        (figure,) = cards["What a second buys"].figures
        self.assertIn("100000000", str(figure.chart.to_dict()["data"]).replace("99999999.99999999", "100000000"))

    def test_kernels_are_told_in_millions_a_second(self):
        cards = cards_of(row(SCALAR, "ggx_0.5", "evaluate", ns=20), row(SCALAR, "ggx_0.5", "sample", ns=40))
        self.assertEqual([v["x"] for f in cards["Speed of the kernels"].figures for v in f.chart.to_dict()["data"]["values"]], [50, 25])

    def test_furnaces_stand_beside_their_truth(self):
        cards = cards_of(*(row(TERM, "furnace", s, build={"compensation": "none"}, answer=a, truth=t)
                           for s, a, t in (("white_0.5", 0.7, 1), ("white_1", 0.4, 1), ("colour_0.5_0.5", 0.35, 0.43), ("colour_1_0.5", 0.2, 0.3),
                                           ("colour_1_0.8", 0.3, 0.6))))  # fmt: skip
        self.assertEqual([len(f.chart.to_dict()["layer"]) for f in cards["White furnace"].figures], [2, 2])


class Claims(unittest.TestCase):
    def test_hemispheres_have_two_pi(self):
        sphere = row(ANGLE, "solid_angles", "all_around", 0, truth=12.566370614)
        hemisphere = row(ANGLE, "solid_angles", "hemisphere", 0, truth=6.283185307)
        self.assertEqual([s for *_, s in verdict("L1", sphere, hemisphere).figures], [True, False])
        near, far = (row(AREA, "solid_angles", f"disc_{d}", 0.1, most=m) for d, m in ((1, 0.7), (10, 0.007)))
        found = verdict("L1", sphere, near, far)
        self.assertEqual([s for *_, s in found.figures], [True, False, True])
        self.assertEqual(found.word, claims.ONLY_IF)

    def test_schlick_by_medium(self):
        found = verdict("L2", *(row(SCHLICK, "fresnel", s, 0.01, most=m) for s, m in (("index_1.5", 0.036), ("leaving_1.5", 0.96))))
        self.assertEqual([s for *_, s in found.figures], [True, False])

    def test_halos_are_compared_at_equal_roughness(self):
        rows = [row(FACETS, d, "albedo", 0, query=FINE, beyond_40=b) for d, b in (("ggx_0.1", 0.06), ("beckmann_0.1", 1e-6), ("ggx_0.05_0.4", 0.9))]
        self.assertEqual(verdict("L3", *rows).word, claims.HOLDS)
        self.assertEqual(verdict("L3", *rows[:1]).word, claims.NOT_RUN)

    def test_grazing_light(self):
        found = verdict("L4", row(BARE, "ggx_0.1", "albedo", 0.1, answer_max=3.0), row(FACETS, "ggx_0.1", "albedo", 0, query=FINE, answer_max=0.98))
        self.assertEqual(found.word, claims.HOLDS)
        self.assertEqual(verdict("L4", row(BARE, "ggx_0.1", "albedo", 0.1, answer_max=0.9)).word, claims.FAILS)

    def test_furnaces(self):
        def term(name, query_set, bias, truth=1.0):
            return row(TERM, "furnace", query_set, abs(bias), build={"compensation": name}, bias=bias, truth=truth)

        found = verdict("L5", term("none", "white_0.5", -0.3), term("none", "white_1", -0.6), term("kulla_conty", "white_0.5", -0.001),
                        term("textbook", "colour_0.5_0.5", 0.06, 0.42), term("kulla_conty", "colour_0.5_0.5", -0.004, 0.42))  # fmt: skip
        self.assertEqual([s for *_, s in found.figures], [True, True, True, False, True])
        self.assertEqual(verdict("L5", term("none", "white_0.5", 0.1)).word, claims.FAILS)

    def test_laws_by_model(self):
        found = supported(verdict("L6", *(row(SCALAR, d, "evaluate", 0, negative=0, reciprocity=r, rotation=0)
                                          for d, r in (("ggx_0.25", 1e-5), ("turquin_ggx_0.5_0.5", 0.4)))))  # fmt: skip
        self.assertEqual((found["GGX: reciprocal"], found["Turquin's scaling: reciprocal"]), (True, False))

    def test_turning_matters_where_the_surface_is_a_streak(self):
        rows = [row(SCALAR, d, "evaluate", 0, rotation=r) for d, r in (("ggx_0.25", 1e-5), ("ggx_0.1_0.5", 20.0), ("dielectric_1.5_0.25", 0), ("compensated_ggx_0.5_0.5", 0))]  # fmt: skip
        self.assertEqual(verdict("L7", *rows).word, claims.HOLDS)
        self.assertEqual(verdict("L7", row(SCALAR, "ggx_0.1_0.5", "evaluate", 0, rotation=0)).word, claims.FAILS)


if __name__ == "__main__":
    unittest.main()
