"""How methods look, what is told of them beside their names, and labels of axes, on rows made by hand."""

import json
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

import vl_convert
from bench.report import charts, closest, fields, model, page, palette, pictures, pieces, rays, tasks, told
from report_made import made, read


class Looks(unittest.TestCase):
    def test_no_two_methods_of_a_task_look_alike_however_many_tasks_there_are(self):
        """Ten tasks of forty methods have more methods than there are looks; one method is in all of them."""
        entries = [made(("shared", "map", "ours", "exact")) | {"task": f"t{t}"} for t in range(10)]
        entries += [made((f"m{t}_{k}", "map", "ours" if k % 4 else "peer", "exact")) | {"task": f"t{t}"}
                    for t in range(10) for k in range(40)]  # fmt: skip
        models = model.task_models(read(*entries))
        for task in models:
            self.assertEqual(len({(look.color, look.shape, look.source) for look in task.looks.values()}), 41, task.name)
        self.assertEqual(len({task.looks["shared"] for task in models}), 1)

    def test_ours_and_a_peer_of_a_task_differ_by_more_than_fill_while_their_colour_has_shapes(self):
        """Also if both have a colour that other tasks use up."""
        color = {m: palette.color_of(m, "ours", m) for m in (f"family{k}" for k in range(60))}
        family = next(m for m, c in color.items() if c == palette.ORANGE)
        entries = [made(("rebuilt", family, "ours", "exact")) | {"task": "t"}, made(("nanoflann_dynamic", "kd", "peer", "exact")) | {"task": "t"}]
        entries += [made((f"a{k}", family, "ours", "exact")) | {"task": "u"} for k in range(2 * len(palette.SHAPES))]
        task = model.task_models(read(*entries))[0]
        self.assertEqual(len({look.color for look in task.looks.values()}), 1)
        self.assertEqual(len({look.shape for look in task.looks.values()}), 2)

    def test_near_colours_have_other_shapes(self):
        """Vermilion and orange are hard to tell apart: while there are shapes, no two methods of a task share one."""
        (task,) = model.task_models(read(*(made((m, f, s, "exact")) for m, f, s in (
            *((f"bvh_{k}", "bvh", "ours") for k in range(6)), *((f"nanoflann_{k}", "kd", "peer") for k in range(6))))))  # fmt: skip
        self.assertEqual(len({look.shape for look in task.looks.values()}), 12)

    def test_moving_vertices_fill_ours(self):
        moved = [made(("bvh", "bvh", "ours", "bounded"), ns, query_set=f"frame{n}_{kind}", ray_update_s=0.1) | {"task": "ray"}
                 for n in (1, 2) for kind, ns in (("refit", 20.0), ("rebuilt", 10.0))]  # fmt: skip
        (task,) = model.task_models(read(*moved))
        dots = rays.moving_chart(task, 460).to_dict()["layer"][-1]
        self.assertEqual(dots["encoding"]["fill"]["scale"]["range"], [palette.VERMILION])


class Axes(unittest.TestCase):
    @staticmethod
    def drawn(chart):
        return vl_convert.vegalite_to_svg(charts.theme(chart).to_json())

    def test_labels_of_a_narrow_axis_do_not_run_into_each_other(self):
        (task,) = model.task_models(read(made(("a", "kd", "ours", "exact")), made(("b", "bvh", "ours", "exact"))))
        for ratio in (1.02, 1.05, 1.12, 1.2, 1.35, 1.6):
            values = [{"i": i, "method": m, "build": v} for i, (m, v) in enumerate(zip(task.looks, (350, 350 * ratio)))]
            svg = self.drawn(charts.lanes_chart(charts.alt.Data(values=values), "build", "time", list(task.looks), task.looks, False, 180))
            axis = re.search(r"role-axis-label.*?</g>", svg[svg.index("X-axis titled") :], re.DOTALL).group()
            told = sorted((float(x), text) for x, text in re.findall(r'translate\(([-\d.]+),[^>]*opacity="1"[^>]*>([^<]+)<', axis))
            self.assertTrue(told, ratio)
            for (a, left), (b, right) in zip(told, told[1:]):
                self.assertGreater(b - a, 2.9 * (len(left) + len(right)), (ratio, told))

    def test_what_does_nothing_stands_beside_the_others_not_decades_off(self):
        """And says its own time there."""
        idle, pcf = ("unshadowed", "brute", "ours", "approximate"), ("pcf", "map", "ours", "approximate")
        found = [made(idle, 0.04, 0.5, query_set="image") | {"task": "shadow"}, made(pcf, 40.0, 0.1, query_set="image") | {"task": "shadow"}]
        (task,) = model.task_models(read(*found))
        data = charts.alt.Data(values=list(model.points(task, task.soft)))
        svg = self.drawn(charts.frontier_chart(data, task.layouts["cube"], task.looks, width=460))
        texts = re.findall(r">([^<>]*ns)<", svg)
        self.assertIn("◂ unshadowed, 0.04 ns", texts)
        self.assertIn("◂", page.READING)
        self.assertFalse({"0.1 ns", "0.2 ns", "0.5 ns", "1 ns", "2 ns"} & set(texts), texts)

    def test_labels_of_a_method_that_is_there_twice_say_which(self):
        mis = ("mis", "bvh", "ours", "stochastic")
        found = [made(mis, ns, e, query={"samples": n}) for n, ns, e in ((4, 40.0, 0.5), (64, 640.0, 0.001))]
        (task,) = model.task_models(read(*found))
        data = charts.alt.Data(values=list(model.points(task, task.soft)))
        svg = self.drawn(charts.frontier_chart(data, task.layouts["cube"], task.looks, width=460))
        self.assertTrue("mis (samples 4), 40 ns" in svg and "mis (samples 64), 640 ns" in svg, re.findall(r">([^<>]*ns)<", svg))
        ends = re.findall(r'text-anchor="(\w+)"[^>]*>mis \(samples (\d+)\)', svg)
        self.assertEqual(set(ends), {("start", "4"), ("end", "64")})  # the second would reach over the edge

    def test_what_a_truth_of_samples_cannot_tell_apart_is_not_called_exact(self):
        method = ("rays", "bvh", "ours", "stochastic")
        for floor, said, other in ((1e-3, charts.AS_THE_TRUTH, charts.UNPROMISED), (1e-7, charts.UNPROMISED, charts.AS_THE_TRUTH)):
            (task,) = model.task_models(read(made(method, error=floor / 2) | {"error_floor": floor}))
            data = charts.alt.Data(values=list(model.points(task, task.soft)))
            svg = self.drawn(charts.frontier_chart(data, task.layouts["cube"], task.looks, width=460))
            self.assertIn(said, svg)
            self.assertNotIn(other, svg)

    def test_marks_above_one_have_labels_above_one(self):
        """Times over the whole mesh's, from 0.45 to 1.7 in 240 pixels."""
        ladder = ("bvh_decimated", "bvh", "ours", "approximate")
        found = [made(ladder, ns, 1e-3, error_max=1e-2, build={"keep": k}, query_set="near") | {"task": "closest_point"}
                 for k, ns in ((0.05, 170.0), (0.1, 45.0), (1, 100.0))]  # fmt: skip
        (task,) = model.task_models(read(*found))
        time = closest.cards(task, model.numbers([task]), 280)[0].figures[1].chart
        svg = self.drawn(time)
        axis = re.search(r"role-axis-label.*?</g>", svg[svg.index("Y-axis titled") :], re.DOTALL).group()
        told = [float(text) for text in re.findall(r'opacity="1"[^>]*>([\d.]+)<', axis)]
        self.assertTrue(max(told) > 1 > min(told) and len(told) > 2, told)


class Told(unittest.TestCase):
    def test_methods_that_are_explained_exist(self):
        for name, listed in told.METHODS.items():
            sources = "".join(p.read_text() for p in (Path(__file__).parents[2] / "bench" / name).glob("*.[ch]pp"))
            for method in (m for names, _ in listed for m in names.split(", ")):
                known = f'{method[1:]}"' if method.startswith("…") else f'"{method}"'
                self.assertTrue(known in sources, f"{name}: {method}")

    def test_every_task_says_what_its_methods_do(self):
        for name, text in tasks.TASKS.items():
            self.assertTrue(text.methods or told.METHODS.get(name), name)
        text = page.build(read(made() | {"task": "ray", "dataset": "icosphere"}), [])
        self.assertIn("bvh_wide_compact</code>", text)
        self.assertIn("(a rough ball", text)
        self.assertEqual(told.dataset("icosphere+hole_2"), told.dataset("icosphere"))

    def test_every_query_set_of_shadows_is_explained(self):
        text = page.build(read(made(query_set="top") | {"task": "shadow", "dataset": "slab_and_sheet"}), [])
        self.assertIn("<code>top</code>", text)

    def test_panels_are_named_where_they_stand(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "a.png").write_bytes(b"png")
            index, picture = Path(folder, "pictures.jsonl"), {"file": "a.png", "kind": "work", "title": "\ud800 t"}
            index.write_text(json.dumps(picture | {"columns": 2, "panels": ["one & only", "two", "three"]}))
            text = pieces.gallery(pictures.read([folder])[0])
            self.assertIn("--columns:2;--rows:2", text)
            self.assertEqual(text.count("<li>"), 3)
            self.assertIn("one &amp; only", text)
            text.encode()
            broken = [{"columns": c, "panels": p} for c, p in ((0, ["a"]), (2, ["a"]), (-1, ["a"]), (1, []), (1, "a"), (1, {"a": 1}), (1, [1]),
                                                              (True, ["a"]), (1.5, ["a"]), (float("inf"), ["a"]), ("1", ["a"]))]  # fmt: skip
            broken += [{name: value} for name in ("title", "kind", "caption", "method", "dataset", "task", "file") for value in (5, ["a"], {"a": 1})]
            for fields in broken:
                index.write_text(json.dumps(picture | fields))
                found, warnings = pictures.read([folder])
                self.assertEqual((found, len(warnings)), ([], 1), fields)
            index.write_text("[" * 200_000)
            self.assertEqual(len(pictures.read([folder])[1]), 1)
        self.assertNotIn("<ol", pieces.gallery([pictures.Picture("t", "ray", "d", "m", "normals", "", "data:,")]))

    def test_strips_say_what_their_colours_mean(self):
        def strip(task):
            return pieces.gallery([pictures.Picture(task=task, kind="strip", dataset="d", method="m", title="t", caption="", uri="data:,")])

        self.assertIn("not asked", strip("shadow"))
        self.assertNotIn("not asked", strip("light_transport"))  # of another scale, which their captions tell


class Fields(unittest.TestCase):
    def test_fields_that_lie_on_one_another_are_both_seen(self):
        def field(method, resolution, error):
            return made((method, "field", "ours", "bounded"), error=error, build={"resolution": resolution}, build_s=error,
                        query_set="near", dataset="ball") | {"task": "distance_field"}  # fmt: skip

        rows = [field(m, n, f / n) for m, f in (("dense", 1.0), ("bricks", 1.0), ("bricks_cubic", 0.5)) for n in (32, 64)]
        (task,) = model.task_models(read(*rows))
        name, _, _, chart, _ = fields.figures(task, {id(r): i for i, r in enumerate(task.soft)}, 460, False)[0]
        spec = chart.to_dict()
        values = spec.get("data", spec["layer"][0].get("data", {})).get("values") or [v for d in spec["datasets"].values() for v in d]
        over, sizes = ({v["method"]: v[k] for v in values} for k in ("over", "size"))
        self.assertEqual((over["bricks_cubic"], {over["dense"], over["bricks"]}), (0, {0, 1}))
        self.assertNotEqual(sizes["dense"], sizes["bricks"])
        self.assertIn("drawn open and larger", fields.CAPTION)
        self.assertIn("icosphere is a rough ball", fields.CAPTION)  # on which look-ups do not gain the factor of smooth surfaces


if __name__ == "__main__":
    unittest.main()
