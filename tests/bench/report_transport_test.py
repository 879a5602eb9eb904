"""The cards and claims of the task light_transport, on rows made by hand."""

import sys
import unittest
from math import log10
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

import vl_convert
from bench.report import charts, claims, model, transport
from report_made import made, read

MIS = ("mis", "bvh", "ours", "stochastic")
PATH = ("path_cosine", "bvh", "ours", "stochastic")
EMBREE = ("mis_embree", "bvh", "peer", "stochastic")
WHITTED = ("whitted", "bvh", "ours", "approximate")
LITERAL = ("textbook_literal", "bvh", "ours", "approximate")
CORRECTED = ("textbook_corrected", "bvh", "ours", "stochastic")


def row(method, query, rel_mse=0.01, ns=1000.0, dataset="cornell_box", query_set="image", bias=0.0, **extra):
    values = {"query_cpu_ns": ns, "bias": bias}
    found = made(method, ns, error=rel_mse**0.5, dataset=dataset, query_set=query_set, build={}, query=query, **values)
    extra = {"rel_mse": rel_mse, "z": 1.0} | extra
    return found | {"task": "light_transport"} | {f"light_transport_{k}": v for k, v in extra.items()}


def cards_of(*entries):
    (task,) = model.task_models(read(*entries))
    numbers = {id(r): i for i, r in enumerate(task.soft)}
    return {card.title: card for card in transport.cards(task, numbers, 460)}, task


def verdict(name, *entries):
    return next(v for v in claims.ledger(list(read(*entries))) if v.id == name)


def values_of(chart):
    spec = chart.to_dict()
    parts = [spec, *spec.get("layer", [])]
    return [v for p in parts for v in p.get("data", {}).get("values", [])] + [
        v for d in spec.get("datasets", {}).values() for v in d]  # fmt: skip


class Cards(unittest.TestCase):
    def test_slopes_are_those_of_the_power(self):
        self.assertAlmostEqual(transport.slope([(1, 8.0), (4, 2.0), (16, 0.5)]), -1)
        self.assertAlmostEqual(transport.slope([(n, 3 * n**-1.5) for n in (1, 2, 4, 8)]), -1.5)
        self.assertIsNone(transport.slope([(4, 1.0)]))

    def test_convergence_names_each_line_by_its_slope(self):
        rows = [row(MIS, {"samples": n}, 1 / n) for n in (1, 4, 16, 64)]
        rows += [row(MIS, {"samples": n, "points": "sobol"}, n**-1.5) for n in (1, 4, 16, 64)]
        rows += [row(MIS, {"samples": 64, "bounces": 2}, 0.5), row(MIS, {"samples": 64, "survival": 0.5}, 0.5)]
        cards, _ = cards_of(*rows)
        texts = {v["text"] for v in values_of(cards["Convergence"].figures[0].chart) if "text" in v}
        self.assertEqual(texts, {"mis −1.00 ± 0.00", "mis (sobol) −1.50 ± 0.00"})

    def test_slopes_say_how_sure_they_are(self):
        """log2 of y is 0, −1, −1, −2 at 0, 1, 2, 3: the slope −0.6, and 0.2 the sum of squares off it; of two points nothing."""
        points = [(1, 1.0), (2, 0.5), (4, 0.5), (8, 0.25)]
        self.assertAlmostEqual(transport.slope(points), -0.6)
        self.assertAlmostEqual(transport.slope_error(points), (0.2 / 2 / 5) ** 0.5)
        self.assertEqual(transport.slope_text(points), " −0.6 ± 0.1")
        self.assertEqual(transport.slope_text(points[:2]), "")
        self.assertEqual(transport.slope_text([(x, 1 / y) for x, y in points]), " +0.6 ± 0.1")
        self.assertIsNone(transport.slope_error(points[:2]))

    def test_labels_keep_their_distance_beside_a_floor(self):
        """The axis reaches down to the truth's noise, and so a label's height is worth more of it."""
        methods = [(f"m{k}", "bvh", "ours", "stochastic") for k in range(8)]
        rows = [row(m, {"samples": n}, (1 + k / 100) / n) | {"error_floor": 1e-4} for k, m in enumerate(methods) for n in (1, 4, 16)]
        chart = cards_of(*rows)[0]["Convergence"].figures[0].chart.to_dict()
        low, high = map(log10, chart["layer"][0]["encoding"]["y"]["scale"]["domain"])
        places = sorted(log10(v["at"]) for v in values_of(cards_of(*rows)[0]["Convergence"].figures[0].chart) if "at" in v)
        self.assertEqual(len(places), 8)
        self.assertGreater(min(b - a for a, b in zip(places, places[1:])) / (high - low) * chart["height"], 9.5)

    def test_an_axis_does_not_blow_up_noise(self):
        low, high = transport.at_least([2.4e-5, 2.42e-5])
        self.assertAlmostEqual(high / low, transport.NARROWEST)
        self.assertAlmostEqual(low * high, 2.4e-5 * 2.42e-5)
        self.assertEqual(transport.at_least([1.0, 50.0]), [1.0, 50.0])

    def test_marks_without_a_row_say_what_they_are(self):
        """The page shows lists of fields; of a single one it gets a text alone."""
        rows = [row(LITERAL, {"samples": 64, "slip": "emitters"}, bias=-0.2, bias_error=0.01),
                *(row(MIS, {"samples": 64, "bounces": b}, bias=-1 / b, bias_error=0.01) for b in (1, 2)),
                row(WHITTED, {"samples": 4, "bounces": 2}, bounce_1=1.5, bounce_2=2.0)]  # fmt: skip
        cards, _ = cards_of(*rows)
        for title in ("The textbook's path tracer", "How many bounces", "Rays by the bounce"):
            found = [layer["encoding"].get("tooltip") for layer in cards[title].figures[0].chart.to_dict()["layer"]]
            self.assertTrue(any(isinstance(t, list) and len(t) > 1 for t in found), title)

    def test_what_lies_at_the_truths_own_noise_has_no_slope_and_no_rank(self):
        """0.1 squared is the truth's relMSE: the last two of mis are its noise, and all but one of path_cosine."""
        def noisy(method, n, rel_mse):
            return row(method, {"samples": n}, rel_mse) | {"error_floor": 0.1}

        rows = [noisy(MIS, n, e) for n, e in ((1, 1.6), (4, 0.4), (8, 0.2), (16, 0.02), (64, 0.012))]
        rows += [noisy(PATH, n, e) for n, e in ((1, 0.02), (4, 0.02), (16, 0.02), (64, 0.3))]
        cards, _ = cards_of(*rows)
        values = values_of(cards["Convergence"].figures[0].chart)
        self.assertEqual({v["text"] for v in values if "text" in v}, {"mis −1.00 ± 0.00", "path_cosine"})
        self.assertEqual({v["y"] for v in values if "low" in v}, {0.1**2})
        self.assertEqual([v["series"] for v in values_of(cards["Efficiency"].figures[0].chart)], ["path_cosine"])
        self.assertIn("some of cornell_box", cards["Efficiency"].caption)
        silent, _ = cards_of(*(r | {"error_floor": None} for r in rows))
        self.assertFalse(any("low" in v for v in values_of(silent["Convergence"].figures[0].chart)))
        self.assertNotIn("cornell_box", silent["Efficiency"].caption)

    def test_every_card_can_be_drawn(self):
        rows = [row(m, {"samples": n}, 1 / n, bias_error=0.01, largest_share=0.01 / n, kurtosis=3.0 + n, **more)
                for m, more in ((MIS, {}), (EMBREE, {}), (CORRECTED, {})) for n in (16, 64)]  # fmt: skip
        rows += [row(LITERAL, {"samples": 64, "slip": "emitters"}, bias=-0.2, bias_error=0.01)]
        rows += [row(MIS, {"samples": 64, "bounces": b}, bias=-1 / b, bias_error=0.01) for b in (1, 2)]
        rows += [row(WHITTED, {"samples": 4, "bounces": 2}, bounce_1=1.5, bounce_2=2.0)]
        cards, _ = cards_of(*rows)
        self.assertEqual(len(cards), 7)
        for card in cards.values():
            for figure in card.figures:
                svg = vl_convert.vegalite_to_svg(charts.theme(figure.chart).to_json())
                self.assertIn("mark-symbol", svg, figure.name)

    def test_lines_of_a_bias_span_as_much_as_is_said(self):
        card = cards_of(row(LITERAL, {"samples": 64, "slip": "emitters"}, bias=-0.2, bias_error=0.01))[0]["The textbook's path tracer"]
        self.assertIn("four standard errors to each side", card.caption)
        mark = next(v for v in values_of(card.figures[0].chart) if "lo" in v)
        self.assertAlmostEqual(mark["x"] - mark["lo"], 4 * 0.01)
        self.assertAlmostEqual(mark["hi"] - mark["x"], 4 * 0.01)

    def test_efficiency_is_over_error_and_time(self):
        cards, _ = cards_of(row(MIS, {"samples": 64}, 0.01, 1000.0), row(PATH, {"samples": 64}, 0.04, 500.0))
        labels = {v["series"]: v["label"] for v in values_of(cards["Efficiency"].figures[0].chart)}
        self.assertEqual(labels, {"mis": "1×", "path_cosine": "0.5×"})

    def test_paths_a_second(self):
        cards, task = cards_of(row(MIS, {"samples": 64}, ns=32_000.0), row(EMBREE, {"samples": 64}, ns=64_000.0))
        ours, theirs = transport.speeds(task.soft)["cornell_box"]
        self.assertAlmostEqual(transport.paths_a_second(ours), 2e6)
        self.assertIn("mis 2×", {v.get("label") for v in values_of(cards["Paths a second"].figures[0].chart)})

    def test_depth_stands_beside_radiosity(self):
        rows = [row(MIS, {"samples": 64, "bounces": b}, query_set="walls", dataset="closed_box", floor_bias=-1 / b, floor_exact=-1.01 / b)
                for b in (1, 2, 5)]  # fmt: skip
        cards, task = cards_of(*rows)
        self.assertIn("How many bounces", cards)
        self.assertEqual(transport.depth(task.soft), {"closed_box, floor": [(b, 1 / b, 1.01 / b) for b in (1, 2, 5)]})

    def test_what_samples_cannot_tell_is_left_out(self):
        walls = [row(MIS, {"samples": 64, "bounces": b}, query_set="walls", dataset="closed_box", floor_bias=-d, floor_exact=-0.004,
                     floor_error=0.006) for b, d in ((10, 0.013), (20, 0.0117))]  # fmt: skip
        image = [row(MIS, {"samples": 64, "bounces": b}, bias=-d, bias_error=0.02) for b, d in ((2, 0.041), (3, 0.039))]
        cards, task = cards_of(*walls, *image)
        self.assertEqual(transport.depth(task.soft), {"closed_box, floor": [(10, 0.013, 0.004), (20, None, 0.004)],
                                                      "cornell_box": [(2, 0.041, None), (3, None, None)]})  # fmt: skip
        told = {(v["what"], v["x"]) for v in cards["How many bounces"].figures[0].chart.to_dict()["layer"][0]["data"]["values"]}
        self.assertEqual(told, {("closed_box, floor", 10), ("cornell_box", 2)})

    def test_ratios_stand_where_no_mark_follows(self):
        slow, quick = row(MIS, {"samples": 64}, ns=64_000.0), row(EMBREE, {"samples": 64}, ns=32_000.0)
        values = values_of(cards_of(slow, quick)[0]["Paths a second"].figures[0].chart)
        self.assertEqual({v["method"]: v["label"] for v in values}, {"mis": "", "mis_embree": "mis 0.5×"})

    def test_labels_keep_their_distance_and_their_order(self):
        values = [5.0, 1.0, 1.01, 1e-3]
        places = charts.spread(values, [1e-4, 1e2], 300, 20)
        gap = 20 / 300 * 6
        self.assertAlmostEqual(log10(places[2] / places[1]), gap)
        self.assertAlmostEqual(places[1] * places[2], 1.01)  # each moved as far as the other
        self.assertEqual([round(places[k], 9) for k in (0, 3)], [5.0, 1e-3])
        crowd = charts.spread([1.0] * 9, [0.5, 2], 300, 20)
        logs = sorted(map(log10, crowd))
        span = max(log10(2), logs[-1]) - min(log10(0.5), logs[0])
        self.assertGreater(300 * min(b - a for a, b in zip(logs, logs[1:])) / span, 18)


class Claims(unittest.TestCase):
    def test_rays_multiply(self):
        def tree(first, third):
            return row(WHITTED, {"samples": 4, "bounces": 3, "shadow_rays": 4}, bounce_1=first, bounce_2=2.0, bounce_3=third,
                       all_rays=1 + first + 2 + third, shadow_rays=3.0)  # fmt: skip

        self.assertEqual(verdict("S8", tree(1.9, 6.0)).word, claims.HOLDS)
        self.assertEqual(verdict("S8", tree(2.5, 6.0)).word, claims.ONLY_IF)
        self.assertEqual(verdict("S8", row(MIS, {"samples": 4})).word, claims.NOT_RUN)

    def test_the_pseudo_code_is_unbiased_only_put_right(self):
        wrong = row(LITERAL, {"samples": 64, "slip": "emitters"}, bias=-0.2, z=-300.0)
        right = row(CORRECTED, {"samples": 64}, z=0.7)
        v = verdict("L8", wrong, right)
        self.assertEqual((v.word, v.condition), (claims.ONLY_IF, "put right in all of this (bias +0.00 %)"))
        self.assertEqual(verdict("L8", wrong).word, claims.FAILS)
        walls = verdict("L8", row(CORRECTED, {"samples": 64}, query_set="walls", bias=0.0005, z=-2.79))
        self.assertNotIn("bias", walls.figures[0][0])  # that of all walls together is not the z's
        both = verdict("L8", right, row(CORRECTED, {"samples": 64}, query_set="walls", bias=0.0005, z=-2.79))
        self.assertIn("(a wall of the box; of images bias +0.00 % at z 0.7)", both.figures[0][0])
        few = row(CORRECTED, {"samples": 4}, z=9.0)  # too few for z to be normal
        self.assertEqual(verdict("L8", few).word, claims.NOT_RUN)


if __name__ == "__main__":
    unittest.main()
