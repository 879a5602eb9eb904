"""What only the task brdf_integral shows: how errors fall with samples, what a second buys, what rough metals lose, how far
off the mirror's direction light goes, and how fast kernels are."""

from math import log

from bench.report import charts
from bench.report.light_claims import TASK, white
from bench.report.palette import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION
from bench.report.series import Card, Figure
from bench.report.shadows import soft

alt = charts.alt

FALL = """Root mean square error against samples, both logarithmic, by the points that are sampled with; own: the samplers of our
BRDFs. Numbers at the lines' ends are their slopes, by least squares: independent points give −½, all others should do better where
what is integrated is smooth. The small light has an edge, and there they are worth less. Where each sample has the integral's own
value, as under an even sky on a surface whose sampler is its very BRDF, there is no error but rounding's, and no line."""
EFFICIENCY = """What a second of one thread buys: one over the mean square error times the seconds of an integral, with 1024 samples.
Ten times farther right is ten times cheaper at the same noise. Filled marks: scrambled Sobol points; hollow: independent ones. It
compares ways of sampling that are without bias; the less light they throw away, and the nearer their density is to what they
sample, the farther right they are. What has no error but rounding's has no place here."""
FURNACE = """How much light a rough metal reflects of all that comes from all around. White: facets reflect all, so nothing may be lost:
what a line lacks to 1 is lost, or made. Colours: facets that reflect a half at normal incidence; the truth is light that walks
between the facets until it leaves."""
HALO = """Of the light that is reflected from normal incidence, the share that leaves farther off the mirror's direction than an angle:
Beckmann's facets stop, GGX's do not."""
SPEED = """Million evaluations of the BRDF, and million samples of a direction with its weight, a second of one
thread's processor time, by surface."""

KINDS = ("random", "stratified", "halton", "r2", "sobol_owen")
COLORS = dict(zip(KINDS, (VERMILION, ORANGE, SKY, BLUE, GREEN)))
TERMS = {"truth": INK, "none": VERMILION, "kulla_conty": GREEN, "textbook": ORANGE, "directional": PURPLE, "turquin": BLUE}


def cards(task, numbers, width="container"):
    if task.name != TASK:
        return []
    made = (_fall(task, width), _efficiency(task, numbers, width), _furnace(task, width), _halo(task, width), _speed(task, numbers, width))
    return [card for card in made if card.figures]


def _log(title, **axis):
    return dict(scale=alt.Scale(type="log", nice=False, padding=14), axis=alt.Axis(title=title, gridOpacity=0.5, **axis))


def _legend(values, field, colors):
    known = [name for name in colors if any(v[field] == name for v in values)]
    return alt.Color(f"{field}:N", scale=alt.Scale(domain=known, range=[colors[name] for name in known]),
                     legend=alt.Legend(title=None, orient="bottom", columns=3, symbolType="circle"))  # fmt: skip


# ---- errors by samples -------------------------------------------------------------------------------------------


ROUNDING = 1e-12  # of an error: what sums in double leave where every sample has the integral's own value


def sampled(row):
    """Has an error that is due to chance."""
    return bool(row.error) and row.error > max(ROUNDING, row.error_floor or 0)


def samples(row):
    return (row.query_knobs or {}).get("samples")


def slope(points):
    """Of log y over log x, by least squares."""
    xs, ys = [log(x) for x, _ in points], [log(y) for _, y in points]
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    spread = sum((a - x) ** 2 for a in xs)
    return sum((a - x) * (b - y) for a, b in zip(xs, ys)) / spread if spread else None


def falls(rows, method):
    """{points: [(samples, error)]} of one dataset and query set."""
    found = {}
    for r in rows:
        if r.method == method and samples(r) and sampled(r):
            found.setdefault(r.query_knobs["points"], []).append((samples(r), r.error))
    return {kind: sorted(found[kind]) for kind in KINDS if kind in found}


def _fall(task, width):
    figures = []
    for dataset in task.datasets:
        for query_set in ("albedo", "small_light"):
            rows = [r for r in soft(task) if r.dataset == dataset and r.query_set == query_set]
            lines = {kind: points for kind, points in falls(rows, "own").items() if len(points) > 1}
            values = [{"points": kind, "n": n, "error": error} for kind, points in lines.items() for n, error in points]
            ends = [{"points": kind, "n": points[-1][0], "error": points[-1][1], "slope": f"{slope(points):.2f}".replace("-", "−")}
                    for kind, points in lines.items()]  # fmt: skip
            if values:
                title = f"{query_set.replace('_', ' ')}: {dataset}"
                figures.append(Figure(f"{task.name}-fall-{dataset}-{query_set}", title, dataset, _fall_chart(values, ends, width)))
    return Card(f"{task.name}-card-fall", "Errors fall", FALL, figures)


def _fall_chart(values, ends, width):
    height = 240
    color = _legend(values, "points", COLORS)
    along = alt.Scale(type="log", nice=False, domain=[pick(v["n"] for v in values) for pick in (min, max)],
                      range=[14, alt.expr("width - 38")])  # fmt: skip
    x = alt.X("n:Q", scale=along, axis=alt.Axis(title="samples, log", values=sorted({v["n"] for v in values}), gridOpacity=0.5))
    low, high = min(v["error"] for v in values) / 1.3, 1.3 * max(v["error"] for v in values)
    places = charts.spread([e["error"] for e in ends], [low, high], height)
    ends = [end | {"at": place} for end, place in zip(ends, places)]
    look = {"scale": alt.Scale(type="log", nice=False, domain=[min(low, *places), max(high, *places)]),
            "axis": alt.Axis(title="relative RMS error, log", format=".0e", tickCount=5, gridOpacity=0.5)}  # fmt: skip
    y = alt.Y("error:Q", **look)
    base = alt.Chart(alt.Data(values=values)).encode(x=x, y=y, color=color)
    text = alt.Chart(alt.Data(values=ends)).mark_text(align="left", dx=6, fontSize=10).encode(
        x=x, y=alt.Y("at:Q", scale=look["scale"]), text=alt.Text("slope:N"), color=color)  # fmt: skip
    dots = base.mark_point(filled=True, size=30, opacity=1).encode(
        tooltip=[alt.Tooltip("points:N"), alt.Tooltip("n:Q", title="samples"), alt.Tooltip("error:Q", format=".2e")])  # fmt: skip
    return alt.layer(base.mark_line(strokeWidth=1.5), dots, text, width=width, height=height)


# ---- efficiency --------------------------------------------------------------------------------------------------


def efficiency(row):
    """One over variance times seconds."""
    return 1 / (row.error**2 * row.query_ns * 1e-9) if sampled(row) and row.query_ns else None


def _efficiency(task, numbers, width):
    figures = []
    for dataset in task.datasets:
        for query_set in ("albedo", "small_light"):
            rows = [r for r in soft(task) if r.dataset == dataset and r.query_set == query_set and samples(r) == 1024
                    and r.query_knobs["points"] in ("random", "sobol_owen") and efficiency(r)]  # fmt: skip
            values = [{"i": numbers[id(r)], "method": r.method, "points": r.query_knobs["points"], "x": efficiency(r)} for r in rows]
            if values:
                title = f"{query_set.replace('_', ' ')}: {dataset}"
                figures.append(Figure(f"{task.name}-efficiency-{dataset}-{query_set}", title, dataset, _lanes(values, "1 / (variance × seconds), log", width)))  # fmt: skip
    return Card(f"{task.name}-card-efficiency", "What a second buys", EFFICIENCY, figures)


def _lanes(values, title, width):
    best = {m: max(v["x"] for v in values if v["method"] == m) for m in dict.fromkeys(v["method"] for v in values)}
    methods = sorted(best, key=lambda m: -best[m])
    y = alt.Y("method:N", sort=methods, scale=alt.Scale(domain=methods),
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=charts.LANE_NAME))  # fmt: skip
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, padding=14), axis=charts._log_axis("x", "format(datum.value, '~s')", title))
    kinds = list(dict.fromkeys(v["points"] for v in values))
    fill = alt.Fill("points:N", legend=None, scale=alt.Scale(domain=kinds, range=["transparent" if k == "random" else GREEN for k in kinds]))
    dots = alt.Chart(alt.Data(values=values)).mark_point(stroke=GREEN, size=50, strokeWidth=1.6).encode(
        x=x, y=y, fill=fill, tooltip=alt.Tooltip("i:Q"))  # fmt: skip
    return dots.properties(width=width, height=alt.Step(16))


# ---- the furnace -------------------------------------------------------------------------------------------------


def reflected(row):
    return row.extra.get(f"{TASK}_answer")


def _furnace(task, width):
    rows = [r for r in soft(task) if r.dataset == "furnace" and r.method == "compensated" and reflected(r) is not None]
    figures = []
    for what, title, wanted in (("white", "facets that reflect all", None), ("colour", "facets that reflect half", 0.5)):
        mine = [r for r in rows if white(r)[1] == wanted]
        values = [{"term": r.build_knobs["compensation"], "alpha": white(r)[0], "albedo": reflected(r)} for r in mine]
        truths = {white(r)[0]: r.extra[f"{TASK}_truth"] for r in mine}
        values += [{"term": "truth", "alpha": a, "albedo": t} for a, t in truths.items()]
        if len(truths) > 1:
            figures.append(Figure(f"{task.name}-furnace-{what}", title, "furnace", _furnace_chart(values, width)))
    return Card(f"{task.name}-card-furnace", "White furnace", FURNACE, figures)


def _furnace_chart(values, width):
    base = alt.Chart(alt.Data(values=values)).encode(
        x=alt.X("alpha:Q", axis=alt.Axis(title="roughness α", gridOpacity=0.5)),
        y=alt.Y("albedo:Q", scale=alt.Scale(zero=False), axis=alt.Axis(title="share reflected", gridOpacity=0.5)),
        color=_legend(values, "term", TERMS))  # fmt: skip
    dots = base.mark_point(filled=True, size=30, opacity=1).encode(tooltip=[
        alt.Tooltip("term:N", title="compensation"), alt.Tooltip("alpha:Q", title="roughness"),
        alt.Tooltip("albedo:Q", title="reflected", format=".4f")])  # fmt: skip
    return alt.layer(base.mark_line(strokeWidth=1.5), dots, width=width, height=260)


# ---- the halo ----------------------------------------------------------------------------------------------------


def _halo(task, width):
    values = []
    for dataset in task.datasets:
        row = next((r for r in soft(task) if r.dataset == dataset and r.query_set == "albedo" and f"{TASK}_beyond_10" in r.extra), None)
        if row:
            values += [{"surface": dataset, "angle": a, "share": s} for a in range(10, 90, 10)
                       if (s := row.extra.get(f"{TASK}_beyond_{a}"))]  # fmt: skip
    if not values:
        return Card("", "", "", [])
    surfaces = list(dict.fromkeys(v["surface"] for v in values))
    colors = dict(zip(surfaces, (VERMILION, BLUE, GREEN, ORANGE, PURPLE, SKY, INK) * 4))
    base = alt.Chart(alt.Data(values=values)).encode(
        x=alt.X("angle:Q", axis=alt.Axis(title="degrees off the mirror's direction", gridOpacity=0.5)),
        y=alt.Y("share:Q", **_log("share of the light, log", format=".0e", tickCount=6)),
        color=_legend(values, "surface", colors))  # fmt: skip
    dots = base.mark_point(filled=True, size=24, opacity=1).encode(tooltip=[
        alt.Tooltip("surface:N"), alt.Tooltip("angle:Q", title="degrees"), alt.Tooltip("share:Q", format=".2e")])  # fmt: skip
    chart = alt.layer(base.mark_line(strokeWidth=1.5), dots, width=width, height=260)
    return Card(f"{task.name}-card-halo", "Halo", HALO, [Figure(f"{task.name}-halo", "light off the mirror's direction", surfaces[0], chart)])


# ---- speed -------------------------------------------------------------------------------------------------------


def _speed(task, numbers, width):
    figures = []
    for query_set, what in (("evaluate", "evaluations"), ("sample", "samples")):
        values = [{"i": numbers[id(r)], "method": r.method, "points": r.dataset, "dataset": r.dataset, "x": 1e3 / r.query_cpu_ns}
                  for r in soft(task) if r.query_set == query_set and r.query_cpu_ns]  # fmt: skip
        if values:
            figures.append(Figure(f"{task.name}-speed-{query_set}", f"million {what} a second", values[0]["dataset"], _speed_chart(values, width)))
    return Card(f"{task.name}-card-speed", "Speed of the kernels", SPEED, figures)


def _speed_chart(values, width):
    datasets = list(dict.fromkeys(v["dataset"] for v in values))
    methods = list(dict.fromkeys(v["method"] for v in values))
    y = alt.Y("dataset:N", sort=datasets, scale=alt.Scale(domain=datasets),
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=190))  # fmt: skip
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, padding=14), axis=charts._log_axis("x", "format(datum.value, '~g')", "million a second, log"))
    color = _legend(values, "method", dict(zip(methods, (BLUE, VERMILION, GREEN, ORANGE, PURPLE))))
    dots = alt.Chart(alt.Data(values=values)).mark_point(filled=True, size=44).encode(x=x, y=y, color=color, tooltip=alt.Tooltip("i:Q"))
    return dots.properties(width=width, height=alt.Step(16))
