"""The cards and claims of the task shadow, on rows made by hand."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import claims, model, shadow_claims, shadows, static, theory
from report_made import made, read

MAP = ("shadow_map", "map", "ours", "approximate")
PCF = ("pcf", "map", "ours", "approximate")
PCSS = ("pcss", "map", "ours", "approximate")
VSM = ("vsm", "map", "ours", "approximate")
MSM = ("msm", "map", "ours", "approximate")
NONE = ("unshadowed", "brute", "ours", "approximate")
RAYS = ("area_rays", "bvh", "ours", "stochastic")
PASS = ("shadow_volumes_z_pass", "volume", "ours", "approximate")
FAIL = ("shadow_volumes", "volume", "ours", "bounded")


def row(method, dataset, query_set="image", error=0.1, build=None, query=None, ns=100.0, hard=False, **extra):
    found = made(method, ns, error=error, dataset=dataset, query_set=query_set, build=build or {}, query=query or {})
    found |= {"task": "shadow"} | {f"shadow_{k}": v for k, v in extra.items()}
    return found | ({"block": f"hard/{dataset}"} if hard else {})


def cards_of(*entries):
    (task,) = model.task_models(read(*entries))
    numbers = {id(r): i for i, r in enumerate(task.soft)}
    return {card.title: card for card in (*shadows.cards(task, numbers, 460), *theory.cards(task, numbers, 460))}, task


def verdict(name, *entries):
    return next(v for v in claims.ledger(list(read(*entries))) if v.id == name)


def values_of(chart):
    """All data of a chart's layers."""
    spec = chart.to_dict()
    parts = [spec, *spec.get("layer", [])]
    return [v for p in parts for v in p.get("data", {}).get("values", [])] + [
        v for d in spec.get("datasets", {}).values() for v in d]  # fmt: skip


class Cards(unittest.TestCase):
    def test_split_by_roughness_and_size_of_the_light(self):
        rows = [row(NONE, f"shadow_sphere_over_floor_{radius}", hard=True, penumbra_share=0.2, split=e, **{"split_ggx_0.1": 8 * e})
                for radius, e in (("0.05", 0.0), ("1.5", 4e-3))]  # fmt: skip
        cards, _ = cards_of(*rows)
        (figure,) = cards["Visibility taken out of the integral"].figures
        told = {(v["radius"], v["surface"]): v["y"] for v in values_of(figure.chart) if "radius" in v}
        self.assertEqual(told, {("radius 0.05 m", "diffuse"): 1e-5, ("radius 0.05 m", "α = 0.1"): 1e-5,
                                ("radius 1.5 m", "diffuse"): 4e-3, ("radius 1.5 m", "α = 0.1"): 0.032})  # fmt: skip
        self.assertNotIn("Visibility taken out of the integral", cards_of(row(NONE, "city", penumbra_share=0.1))[0])

    def test_the_line_is_what_our_rays_measured_or_what_theory_expects(self):
        map_row = row(MAP, "slit", build={"resolution": 256}, penumbra=0.2, penumbra_share=0.5)
        cards, _ = cards_of(map_row)
        (figure,) = cards["Beside 16 rays a pixel"].figures
        self.assertTrue(any(v.get("y") == shadows.SOBOL_AT_16 for v in values_of(figure.chart)))
        self.assertAlmostEqual(shadows.SOBOL_AT_16, 0.0375, places=4)
        rays = [row(RAYS, "slit", query=q, penumbra=p, penumbra_share=0.5)
                for q, p in (({"rays": 16}, 0.04), ({"rays": 16, "pattern": "random"}, 0.01), ({"rays": 64}, 0.02))]  # fmt: skip
        cards, _ = cards_of(map_row, *rays)
        card = cards["Beside 16 rays a pixel"]
        self.assertIn("16 rays: 0.04", str(values_of(card.figures[0].chart)))
        self.assertIn("measured here", card.caption)

    def test_no_shadow_is_a_line_and_no_mark(self):
        """In no time it would stretch the axis; and so would errors that nobody sees."""
        cards, _ = cards_of(row(NONE, "slit", ns=0.04, penumbra=0.5, penumbra_share=0.5), row(PCF, "slit", penumbra=2e-6, penumbra_share=0.5))
        found = values_of(cards["Beside 16 rays a pixel"].figures[0].chart)
        self.assertEqual({(v["method"], v["y"]) for v in found if "method" in v}, {("pcf", shadows.LEAST_ERROR)})
        self.assertIn("no shadow: 0.5", {v.get("text") for v in found})

    def test_a_chart_that_stands_alone_names_its_methods(self):
        _, task = cards_of(row(MAP, "slit", penumbra=0.2, penumbra_share=0.5), row(PCF, "slit", penumbra=0.1, penumbra_share=0.5))
        with tempfile.TemporaryDirectory() as folder:
            static.save_all([task], folder)
            (chart,) = Path(folder).glob("*rays-slit.svg")
            texts = re.findall(r"<text[^>]*>([^<]*)</text>", chart.read_text())
        self.assertTrue({"shadow_map", "pcf"} <= set(texts), texts)
        cards, _ = cards_of(row(MAP, "slit", penumbra=0.2, penumbra_share=0.5))  # in the page one stands above all charts
        self.assertNotIn("'symbolSize': 60", str(cards["Beside 16 rays a pixel"].figures[0].chart.to_dict()))

    def test_lights_keep_rows_of_a_scene_apart(self):
        lights = ("slit", "slit --light directional:0,-1,0.1:1")
        rows = [row(MAP, scene, build={"resolution": 256}, penumbra=p, penumbra_share=0.5) for scene, p in zip(lights, (0.2, 0.1))]
        cards, task = cards_of(*rows)
        self.assertEqual(tuple(task.datasets), lights)
        self.assertEqual(len(cards["Beside 16 rays a pixel"].figures), 2)

    def test_hard_lights_have_no_penumbra(self):
        cards, _ = cards_of(row(MAP, "two_stacked", penumbra=None, penumbra_share=0.0))
        self.assertNotIn("Beside 16 rays a pixel", cards)

    def test_theory_stands_beside_what_was_measured(self):
        cards, task = cards_of(row(MAP, "shadow_tilted_plane_60_0", hard=True, figure="shadow_false_dark", figure_value=0.5,
                                   figure_slack=0.02, false_dark=0.49), row(NONE, "slit"))  # fmt: skip
        self.assertEqual([f[1:] for f in theory.told(task)], [("shadow_false_dark", 0.49, 0.5, 0.02)])
        (figure,) = cards["What theory says"].figures
        mark = next(v for v in values_of(figure.chart) if "label" in v)
        self.assertEqual((mark["low"], mark["high"]), (0.48, 0.52))

    def test_a_mark_of_theory_tells_its_case_and_knobs(self):
        """The page shows what a list of fields says; a single field comes as a text, of which it knows no name."""
        cards, _ = cards_of(row(MAP, "tilted", query={"bias": 0}, hard=True, figure="shadow_gap", figure_value=0.5, gap=0.49))
        chart = cards["What theory says"].figures[0].chart
        tooltip = chart.to_dict()["layer"][-1]["encoding"]["tooltip"]
        self.assertTrue({"label", "case", "knobs"} <= {part["field"] for part in tooltip})
        mark = next(v for v in values_of(chart) if "label" in v)
        self.assertEqual((mark["label"], mark["case"], mark["knobs"]), ("shadow_map", "tilted, image", "bias 0"))

    def test_bars_of_theory_stay_within_their_chart(self):
        cards, _ = cards_of(*(row(MAP, f"tilted_{k}", hard=True, figure="shadow_gap", figure_value=v, figure_slack=0.3, gap=0.1)
                              for k, v in enumerate((0.1, 0.2))))  # fmt: skip
        chart = cards["What theory says"].figures[0].chart
        low, high = chart.to_dict()["layer"][1]["encoding"]["y"]["scale"]["domain"]
        bars = [v for v in values_of(chart) if "label" in v]
        self.assertTrue(all(low <= v["low"] and v["high"] <= high for v in bars), (bars, low, high))

    def test_marks_stand_out_from_both_grounds(self):
        def luminance(color):
            parts = [c / 255 for c in color]
            return sum(w * (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4)
                       for w, c in zip((0.2126, 0.7152, 0.0722), parts))  # fmt: skip

        def parts(text):
            return [int(text[k : k + 2], 16) for k in (1, 3, 5)]

        css = (Path(theory.__file__).parent / "page" / "page.css").read_text()
        grounds = [parts(c) for c in dict.fromkeys(re.findall(r"--card: (#[0-9a-f]{6})", css))]
        self.assertEqual(len(grounds), 2)
        share = theory.DOTS["opacity"]
        for ground in grounds:
            mark = [share * c + (1 - share) * g for c, g in zip(parts(theory.DOTS["color"]), ground)]
            low, high = sorted((luminance(mark), luminance(ground)))
            self.assertGreaterEqual((high + 0.05) / (low + 0.05), 3)  # WCAG 2.1, 1.4.11: graphics

    def test_a_field_of_all_rows_stands_over_decades(self):
        tables = []
        for dataset, error, should in (("noise", 5e-2, 5.1e-2), ("mask", 1e-5, 1.1e-5)):
            tables.append(made(MAP, 10.0, dataset=dataset, error=error) | {"task": "region_average", "region_average_figure": "error",
                                                         "region_average_figure_value": should})  # fmt: skip
        (task,) = model.task_models(read(*tables))
        (figure,) = theory.cards(task, {}, 460)[0].figures
        self.assertIn("Rounding (2 rows)", figure.title)
        self.assertEqual(figure.chart.to_dict()["layer"][-1]["encoding"]["x"]["scale"]["type"], "log")

    def test_front_keeps_what_no_other_beats(self):
        rows = [row(PCSS, "slit", error=e, ns=t, query={"taps": k}, penumbra=e)
                for k, (t, e) in enumerate(((10, 0.3), (20, 0.4), (30, 0.1)))]  # fmt: skip
        _, task = cards_of(*rows)
        self.assertEqual([r.error for r in shadows.front(task.soft, lambda r: r.error)], [0.3, 0.1])


class Claims(unittest.TestCase):
    def test_acne(self):
        def planes(flat, steep):
            """Of each the false shadow and the bias in metres under a constant."""
            out = []
            for name, (dark, bias) in (("tilted_plane", flat), ("tilted_plane_85_0", steep)):
                for query, false, metres in (({"bias": 0}, 0.5, 0.0), ({"constant": 0.005}, dark, bias), ({"bias": 1}, 0.0, 0.1)):
                    out.append(row(MAP, name, query=query, build={"resolution": 1024}, false_dark=false, figure_bias=metres))
            return out

        v = verdict("H1", *planes((0.1, 0.01), (0.45, 0.02)))
        self.assertEqual(v.word, claims.ONLY_IF)  # without bias the angle makes no difference
        self.assertIn("under as much bias in metres", v.condition)
        self.assertIn("leaves none", v.condition)
        for flat, steep in (((0.1, 0.01), (0.1, 0.01)), ((0.1, 0.02), (0.45, 0.01))):  # as dark; under less bias
            self.assertEqual(verdict("H1", *planes(flat, steep)).condition, "a bias by the slope's bound leaves none")

    def test_contact(self):
        def walls(gaps):
            return [row(MAP, "wall_on_floor", "contact", build={"resolution": 1024}, query={"constant": c}, gap=g)
                    for c, g in zip((0.0005, 0.005, 0.05), gaps)]  # fmt: skip

        self.assertEqual(verdict("H2", *walls((0, 0.02, 0.3))).word, claims.HOLDS)
        self.assertEqual(verdict("H2", *walls((0, 0, 0))).word, claims.FAILS)

    def test_wider_filters(self):
        steps = [row(PCF, "half_plane_edge", "edge", build={"resolution": 1024}, error=e, width=w,
                     query={"radius": r, "smooth": True, "plane": True})
                 for r, w, e in ((1, 0.01, 0.1), (4, 0.05, 0.02), (16, 0.2, 0.3))]  # fmt: skip
        v = verdict("H6", *steps)
        self.assertEqual((v.word, v.condition), (claims.ONLY_IF, "the wider the filter, the wider the penumbra"))

    def test_leaks(self):
        rows = [row(m, "shadow_two_stacked_0.5", "leak", build={"resolution": 1024, "radius": 2}, query=q, hard=True, max=leak)
                for m, q, leak in ((VSM, {"cut": 0}, 0.25), (MSM, {"alpha": 3e-7}, 0.02))]  # fmt: skip
        self.assertEqual(verdict("H10", *rows).word, claims.HOLDS)
        rows[1]["shadow_max"] = 0.4
        self.assertEqual(verdict("H10", *rows).word, claims.ONLY_IF)

    def test_volumes(self):
        rows = [row(m, "shadow_eye_inside_volume_0", hard=True, false_lit=lit, false_dark=0.0)
                for m, lit in ((PASS, 0.9), (FAIL, 0.0))]  # fmt: skip
        self.assertEqual(verdict("H11", *rows).word, claims.HOLDS)

    def test_as_wrong_as_another_is_not_right(self):
        field = ("distance_field", "field", "ours", "approximate")
        rows = [row(field, "slit", query={"form": form}, penumbra=0.2, penumbra_share=0.5) for form in ("one_sided", "disc")]
        v = verdict("H12", *rows)
        self.assertEqual((v.word, [s[1] for s in v.figures]), (claims.FAILS, [0.2, 1]))
        self.assertIn("or how many times another's", v.figure)

    def test_split(self):
        def told(diffuse, *ggx):
            return {"split": diffuse, **dict(zip(("split_ggx_0.5", "split_ggx_0.2", "split_ggx_0.1", "split_ggx_0.05"), ggx))}

        small, middle, large = told(1e-5, 2e-5, 3e-5, 4e-5, 5e-5), told(5e-4, 1e-3, 4e-3, 9e-3, 2e-2), told(5e-3, 0.01, 0.03, 0.05, 0.07)
        rows = [row(NONE, f"shadow_sphere_over_floor_{s}", hard=True, penumbra_share=0.2, **f)
                for s, f in (("0.05", small), ("0.5", middle), ("1.5", large))]  # fmt: skip
        v = verdict("H13", *rows)
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertEqual([round(s[1], 6) for s in v.figures], [1e-5, 5e-4, 5e-3, 2, 6, 10, 14])
        self.assertEqual([s[3] for s in v.figures], [True, True, False, True, True, True, True])
        alike = row(NONE, "shadow_sphere_over_floor_0.5", hard=True, penumbra_share=0.2, **told(5e-3, 5e-3, 5e-3, 5e-3, 5e-3))
        self.assertEqual([s[3] for s in verdict("H13", alike).figures], [False] * 5)  # not large alone

    def test_split_is_told_of_the_surfaces_that_are_measured(self):
        source = (Path(__file__).parents[2] / "bench/shadow/split.hpp").read_text()
        listed = re.search(r"split_roughness\{(.*?)\}", source, re.DOTALL).group(1).split(",")[1:]
        self.assertEqual(tuple(map(float, listed)), shadow_claims.SPLIT_ALPHAS)

    def test_without_rows_nothing_is_run(self):
        words = {v.id: v.word for v in claims.ledger(list(read(row(NONE, "half_plane_edge", penumbra_share=0.1))))}
        self.assertEqual({words[f"H{k}"] for k in range(1, 14)}, {claims.NOT_RUN})


if __name__ == "__main__":
    unittest.main()
