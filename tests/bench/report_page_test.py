"""The report in a real browser, opened from its file without a network: no script error, nothing asked from outside,
every chart drawn with its marks, advice equal to the one computed here, selectors and keyboard at work."""

import contextlib
import io
import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

import report_fixture as fixture
import vl_convert
from bench.report import advice, charts, layout, page, report, rows, series, static
from bench.report.model import numbers, task_models
from report_made import LOOSE, METHOD, PEER, made, read

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-component-update",
         "--disable-background-networking", "--disable-sync", "--disable-dev-shm-usage",
         "--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=60000")  # fmt: skip
LOADING = {"src", "href", "data", "action", "poster", "srcset", "background", "xlink:href"}


class Page(HTMLParser):
    """Root attributes, the probe's text, and everything that could load something."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.root, self.loads, self.probe, self.inside = {}, [], "", False
        self.tags = Counter()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.tags[tag] += 1
        if tag == "html":
            self.root = values
        self.inside = values.get("id") == "probe"
        self.loads += [v for k, v in attributes if k in LOADING and v and not v.startswith(("#", "data:image/"))]

    def handle_data(self, data):
        if self.inside:
            self.probe += data

    def handle_endtag(self, tag):
        self.inside = False


def browse(path, *more):
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        raise FileNotFoundError("no Chromium here (packages.txt names it)")
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([program, *FLAGS, *more, f"--user-data-dir={profile}", "--dump-dom", Path(path).as_uri()],
                              capture_output=True, text=True, timeout=240)  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"the browser ended with {done.returncode}: {done.stderr[-2000:]}")
    return Page(done.stdout)


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        folder = Path(cls.folder.name)
        cls.files = fixture.make(folder, sizes=(10_000, 100_000))
        cls.report = folder / "report.html"
        told = io.StringIO()
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(io.StringIO()):
            cls.status = report.main([*map(str, cls.files), "--pictures", str(folder / "pictures/knn"), "--pictures",
                                      str(folder / "pictures/ray"), "--out", str(cls.report), "--winners"])  # fmt: skip
        cls.told = told.getvalue()
        cls.rows = rows.read(cls.files)
        cls.models = task_models(cls.rows)
        probed = folder / "probed.html"
        script = Path(__file__).with_name("report_probe.js").read_text()
        before, end, after = cls.report.read_text().rpartition("</body>")
        probed.write_text(f"{before}<script>{script}</script>{end}{after}")
        cls.page = browse(probed, "--window-size=1400,1000")
        cls.seen = json.loads(cls.page.probe) if cls.page.probe else None

    def test_made_without_complaint(self):
        self.assertEqual(self.status, 0)
        self.assertIn("knn: the fastest method that promises exact answers", self.told)

    def test_no_script_error(self):
        self.assertEqual(self.page.root.get("data-errors", "[]"), "[]")
        self.assertEqual(self.page.root.get("data-ready"), "yes")
        self.assertIsNotNone(self.seen, "the probe did not come to its end")

    def test_loads_nothing_from_outside(self):
        self.assertEqual(self.page.loads, [])
        self.assertEqual(self.page.tags["link"] + self.page.tags["iframe"], 0)
        text = self.report.read_text()
        self.assertIn("default-src 'none'", text)  # what the browser would block, it reports as an error
        self.assertNotIn("@import", text)
        self.assertEqual(text.count("window.vegaEmbed="), 1)  # one bundle for all charts

    def test_every_link_leads_somewhere(self):
        """In the whole report as in one of thread scaling alone, which has no winners, datasets or advice."""
        threads = rows.read([f for f in self.files if "threads" in f.name])
        for text, least in ((self.report.read_text(), 20), (page.build(threads, []), 3)):
            links, places = set(re.findall('href="#([^"]+)"', text)), set(re.findall(' id="([^"]+)"', text))
            self.assertEqual(links - places, set())
            self.assertGreaterEqual(len(links), least)

    def test_no_winners_no_link_to_them(self):
        """Of ours alone there are figures, but nobody to win against."""
        text = page.build(read(*(made(METHOD, ns, query_set=s) for ns, s in ((50, "near"), (90, "far")))), [])
        self.assertNotIn("-winners", text.partition("<header>")[0])
        links, places = set(re.findall('href="#([^"]+)"', text)), set(re.findall(' id="([^"]+)"', text))
        self.assertEqual(links - places, set())

    def test_lines_have_a_legend_and_lanes_name_themselves(self):
        life = [made(m, ns, query_set=s) | {"task": "knn_dynamic", "knn_dynamic_batch": b}
                for m, ns in ((METHOD, 50), (PEER, 90)) for s, b in (("single", 1), ("batches16", 100))]  # fmt: skip
        card = re.search('<article class="series".*?</article>', page.build(read(*life), []), re.DOTALL).group()
        self.assertEqual(re.findall('data-method="([^"]+)"', card), [METHOD[0], PEER[0]])
        threads = page.build(rows.read([f for f in self.files if "threads" in f.name]), [])
        self.assertNotIn("data-method", re.search('<article class="series".*?</article>', threads, re.DOTALL).group())

    def test_axes_have_a_few_labels_however_much_they_span(self):
        """And they are of those values that are evenly spread, two at least, none twice, with room between them."""
        found = rows.read(self.files)
        task = next(t for t in task_models(found) if t.name == "knn")
        for low, high in ((13, 94), (100, 104), (1, 12), (9, 400), (1, 1e9), (5, 5)):
            values = [{"i": i, "method": m, "bytes": v, "own": v} for i, (m, v) in enumerate(zip(task.looks, (low, high)))]
            chart = charts.lanes_chart(charts.alt.Data(values=values), "bytes", "bytes", list(task.looks), task.looks, False, 240)
            told = self.labels(chart)
            self.assertTrue(2 <= len(told) <= 10 or low == high, (low, high, told))
            self.assertEqual(len({text for _, text in told}), len(told), told)
            places = sorted(told)
            for (a, left), (b, right) in zip(places, places[1:]):
                self.assertGreater(b - a, 2.9 * (len(left) + len(right)), (low, high, places))  # half of each at 10 px

    def test_labels_of_durations_do_not_run_into_each_other(self):
        """Six letters, as 500 µs, are up to 40 pixels wide."""
        task = next(t for t in task_models(rows.read(self.files)) if t.name == "knn")
        for decades in (1.4, 1.6, 1.8, 2, 2.2, 2.4):
            ends = (9.5e4, 9.5e4 * 10**decades)
            values = [{"i": i, "method": m, "build": v} for i, (m, v) in enumerate(zip(task.looks, ends))]
            chart = charts.lanes_chart(charts.alt.Data(values=values), "build", "time", list(task.looks), task.looks, False, 240)
            places = sorted(self.labels(chart))
            self.assertGreater(min(b - a for (a, _), (b, _) in zip(places, places[1:])), 40, places)

    def test_bytes_have_no_thousandths(self):
        task = next(t for t in task_models(rows.read(self.files)) if t.name == "knn")
        values = [{"i": i, "method": m, "bytes": v, "own": v} for i, (m, v) in enumerate(zip(task.looks, (0.15, 2500)))]
        chart = charts.lanes_chart(charts.alt.Data(values=values), "bytes", "bytes", list(task.looks), task.looks, False, 900)
        texts = {text for _, text in self.labels(chart)}
        self.assertTrue({"0.5", "1", "1k"} <= texts and not any(text.endswith("m") for text in texts), texts)

    @staticmethod
    def labels(chart):
        """[(pixel, text)] of the axis along x."""
        svg = vl_convert.vegalite_to_svg(charts.theme(chart).to_json())
        axis = re.search(r'role-axis-label.*?</g>', svg[svg.index("X-axis titled"):], re.DOTALL).group()
        return [(float(x), text) for x, text in re.findall(r'translate\(([-\d.]+),[^>]*opacity="1"[^>]*>([^<]+)<', axis)]

    def test_every_chart_is_drawn_with_every_mark(self):
        tasks = len(fixture.TASKS)
        fixed = [f for t in self.models for card in series.cards(t, numbers(self.models)) for f in card.figures]
        self.assertEqual([f.name for f in fixed], ["knn-threads-uniform_cube-knn8_threads", "knn-threads-uniform_cube-build"])
        for figure in fixed:
            methods = {r.method for t in self.models for r in t.scaling}
            self.assertEqual(self.seen["charts"][figure.name]["marks"], len(methods))
        expected = sum(4 * len(datasets) for _, datasets, _ in fixture.TASKS.values()) + len(fixed)
        self.assertEqual((tasks, int(self.page.root["data-drawn"]), len(self.seen["charts"])), (2, expected, expected))
        for task in self.models:
            for k, dataset in enumerate(task.datasets):
                self.check_marks(task, k, dataset)

    def check_marks(self, task, k, dataset):
        here = [r for r in task.of(dataset) if r.size == max(task.sizes)]
        shown = [r for r in here if r.query_set == task.query_sets[0]]
        builds = len({(r.method, str(r.build_knobs)) for r in here if r.build_s is not None})
        _, best, _ = layout.marks(task.soft)
        of_set = [r for r in task.of(dataset) if r.query_set == task.query_sets[0] and id(r) in best]
        sized = {(r.method, str(r.build_knobs)) for r in here if r.bytes is not None}
        for kind, count in (("frontier", sum(r.status not in rows.ABSENT for r in shown)), ("build", builds),
                            ("bytes", len(sized)), ("scaling", len(of_set))):  # fmt: skip
            chart = self.seen["charts"][f"{task.name}-{k}-{kind}"]
            self.assertEqual(chart["marks"], count, f"{task.name} {dataset} {kind}")
            self.assertGreater(chart["height"], 100)
            self.assertLessEqual(chart["width"], chart["room"] + 1)

    def test_selectors_change_the_charts(self):
        for task in self.models:
            size = max(task.sizes)
            for query_set in task.query_sets:
                tried = [
                    r for r in task.soft if r.size == size and r.query_set == query_set and r.status not in rows.ABSENT
                ]
                self.assertEqual(self.seen["changed"][f"{task.name}-set={query_set}"], len(tried))
                notes = [f"{d} {n['method']}: {n['note']}" for d, place in task.layouts.items() for n in layout.lane_notes(
                    place, [r for r in task.of(d) if r.size == size and r.query_set in (query_set, None)])]  # fmt: skip
                self.assertCountEqual(self.seen["notes"][f"{task.name}-set={query_set}"], notes)
        self.assertGreater(self.seen["figures"], 5)

    def test_advice_is_the_one_computed_here(self):
        self.assertGreater(
            len({(a["take"], a["below"]) for a in self.seen["advice"]}), 20
        )  # the slider changes the text
        for told in self.seen["advice"]:
            task = next(t for t in self.models if t.name == told["task"])
            here = [r for r in task.of(told["dataset"]) if r.size == max(task.sizes)]
            sets = advice.asked_sets(here) if told["set"] == "*" else [told["set"]]
            best, below, limit = advice.advise(advice.rungs(here, sets), told["tolerance"])
            if best is None:
                self.assertIn("No configuration", told["take"])
                continue
            self.assertIn(self.name(best), told["take"])
            if below is None:
                self.assertIn("no rung below", told["below"])
            else:
                self.assertIn(self.name(below), told["below"])
                self.assertIn(f"({limit[0]})", told["below"])

    @staticmethod
    def name(rung):
        knobs = "; ".join(filter(None, (rung.build_knobs, rung.query_knobs)))
        return f"{rung.method} ({knobs})" if knobs else rung.method

    def test_matrix_by_keyboard_tooltip_and_theme(self):
        self.assertEqual(self.seen["matrix"], self.seen["expectedDetail"])
        self.assertIn("claims", self.seen["tip"])
        self.assertIn(self.seen["theme"], ("dark", "light"))

    def test_pictures_are_inlined(self):
        count = sum(len(p.read_text().splitlines()) for p in Path(self.folder.name).rglob("pictures.jsonl"))
        self.assertEqual(self.page.tags["img"], count)

    def test_nothing_hangs_over_the_edge(self):
        self.assertLessEqual(self.seen["overflow"], 0)
        narrow = browse(Path(self.folder.name) / "probed.html", "--window-size=800,900")
        seen = json.loads(narrow.probe)
        self.assertLessEqual(seen["overflow"], 0)
        self.assertTrue(all(c["width"] <= c["room"] + 1 for c in seen["charts"].values()))

    def test_static_charts(self):
        task = self.models[1]
        task.datasets, task.query_sets = task.datasets[:1], task.query_sets[:1]
        with tempfile.TemporaryDirectory() as folder:
            saved = static.save_all([task], folder)
            files = sorted(Path(folder).iterdir())
            self.assertEqual(saved, 5)  # frontier, scaling, build, bytes, stability
            self.assertEqual(len(files), 2 * saved)
            for file in files:
                start = file.read_bytes()[:5]
                self.assertTrue(start.startswith(b"<svg" if file.suffix == ".svg" else b"\x89PNG"), file.name)


PROBE = """(async () => {
  const root = document.documentElement, pause = () => new Promise((next) => setTimeout(next, 30));
  while (root.dataset.ready !== "yes") await pause();
  const seen = { start: document.querySelector(".slide input").value, take: document.querySelector(".take").textContent, sets: {} };
  const select = document.getElementById("knn-set");
  for (const set of ["near", "far"]) {
    select.value = set;
    select.dispatchEvent(new Event("change", { bubbles: true }));
    await pause();
    seen.sets[set] = [...document.querySelectorAll(".card")].map((card) => ({
      size: card.querySelector(".size").textContent, grounds: card.querySelectorAll(".frontier .mark-rect path").length,
      marks: card.querySelectorAll(".frontier .mark-symbol path").length }));
  }
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
})();"""


def probed(text, script):
    """What a script saw in a page."""
    before, end, after = text.rpartition("</body>")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "probed.html"
        path.write_text(f"{before}<script>{script}</script>{end}{after}")
        return json.loads(browse(path).probe)


class Odd(unittest.TestCase):
    """A page where datasets are asked different things, one method fails at one of them, and nothing is very accurate."""

    @classmethod
    def setUpClass(cls):
        loose = lambda dataset, query_set, **more: made(LOOSE, error=0.01, dataset=dataset, query_set=query_set, **more)
        broken = made(PEER, error=0.5, dataset="cube", query_set="far", status="wrong")
        text = page.build(read(loose("cube", "near"), loose("cube", "far", ns=200.0), broken, loose("ball", "far")), [])
        cls.seen = probed(text, PROBE)

    def test_a_dataset_shows_a_set_that_it_was_asked(self):
        (_, asked), (_, other) = self.seen["sets"]["far"], self.seen["sets"]["near"]
        self.assertEqual((asked["size"], asked["marks"]), ("1,000 points", 1))
        self.assertEqual((other["size"], other["marks"]), ("1,000 points; far, as near is not asked here", 1))

    def test_the_rail_of_failures_is_red_only_under_marks(self):
        self.assertEqual([self.seen["sets"][s][0]["grounds"] for s in ("near", "far")], [0, 1])
        self.assertEqual([self.seen["sets"][s][0]["marks"] for s in ("near", "far")], [1, 2])

    def test_advice_starts_where_something_holds(self):
        self.assertEqual(self.seen["start"], "101")  # 0.01
        self.assertTrue(self.seen["take"].startswith("Take forest"), self.seen["take"])


ASKED = """(async () => {
  const root = document.documentElement, pause = () => new Promise((next) => setTimeout(next, 30));
  while (root.dataset.ready !== "yes") await pause();
  const seen = { advice: {}, axes: {}, absent: document.querySelector(".absent").textContent };
  const box = document.querySelector(".advice"), get = (name) => box.querySelector(`[name="${name}"]`);
  for (const set of ["near", "uniform"]) for (const position of [0, 81]) {
    [get("set").value, get("tolerance").value] = [set, position];
    get("tolerance").dispatchEvent(new Event("input", { bubbles: true }));
    seen.advice[set + " " + position] = { answer: box.querySelector(".answer").textContent,
      rungs: [...box.querySelectorAll(".rungs tr")].map((r) => [...r.cells].map((c) => c.textContent)) };
  }
  const select = document.querySelector(".choices select");
  for (const set of ["near", "uniform"]) {
    select.value = set;
    select.dispatchEvent(new Event("change", { bubbles: true }));
    await pause();
    seen.axes[set] = [...document.querySelectorAll(".frontier .plot text")].map((e) => e.textContent);
  }
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
})();"""


class Words(unittest.TestCase):
    """A task whose query sets mean different things by their error, of which one has no configuration without any."""

    @classmethod
    def setUpClass(cls):
        rough, quick, gone = ((m, "field", "ours", "approximate") for m in ("rough", "quick", "gone"))
        at = lambda method, ns, error, query_set="near", **more: made(method, ns, error, query_set=query_set, **more) | {"task": "distance_field"}
        entries = [at(rough, 10, 1.0004e-4), at(quick, 884, 9e-5, low=870, high=900), at(METHOD, 886, low=872, high=902, error=0)]
        entries += [at(rough, 10, 0.3, "uniform"), at(quick, 20, 0.2, "uniform"), at(METHOD, 30, 0.1, "uniform", error_max=1.0)]
        for method in (quick, gone):
            entries += [at(method, None, None, "uniform", query={"x": x}, status="unsupported", reason="as the first") for x in (1, 2)]
        cls.seen = probed(page.build(read(*entries), []), ASKED)

    def test_an_error_is_called_what_its_set_means_by_it(self):
        titles = ("mean error in longest sides", "share of wrong sides")
        for query_set, title, other in (("near", *titles), ("uniform", *titles[::-1])):
            texts = self.seen["axes"][query_set]
            self.assertTrue(title in texts and other not in texts, texts)
        self.assertIn("share of wrong sides 0.1, above exact (uniform)", self.seen["advice"]["uniform 0"]["rungs"][0][3])

    def test_a_broken_limit_differs_from_what_is_allowed(self):
        self.assertIn("mean error in longest sides 1.0004e-4, above 1.0000e-4 (near)", self.seen["advice"]["near 81"]["answer"])

    def test_a_lead_within_the_intervals_is_said_to_be_none(self):
        told = self.seen["advice"]["near 81"]
        self.assertTrue(told["answer"].startswith("Take quick: 884 ns"), told)
        self.assertIn("within the intervals of the repetitions: as fast may be kd_tree at 886 ns, exact on every stated metric", told["answer"])
        self.assertIn("may be as fast", told["rungs"][-1][3])

    def test_where_nothing_holds_the_most_accurate_come_first(self):
        told = self.seen["advice"]["uniform 81"]
        self.assertIn("No configuration that was measured here meets", told["answer"])
        self.assertEqual([r[1] for r in told["rungs"]], ["kd_tree", "quick", "rough"])

    def test_what_was_measured_in_part_is_not_called_absent(self):
        self.assertEqual(self.seen["absent"], "Not measured here: 2 configurations of quick (unsupported: as the first); "
                         "gone (unsupported: as the first).")  # fmt: skip


if __name__ == "__main__":
    unittest.main()
