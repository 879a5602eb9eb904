"""What only the task light_transport shows: how errors fall with samples, what a method is worth in a given time, what
leaving out bounces costs, how rays multiply, how far pseudo-code is biased, and how few samples may hold the light."""

from math import log, sqrt

from bench.report import charts
from bench.report.palette import INK
from bench.report.rows import knob_text
from bench.report.series import Card, Figure
from bench.report.units import figure, several

alt = charts.alt

FEW = 1e-4  # of a bias: what no run here can tell from none
EQUAL = 64  # samples at which methods are held against each other
REACH = 10  # times the truth's own relMSE: nearer, more than a tenth of what is measured is the truth's noise

CONVERGENCE = """relMSE against samples a pixel, both logarithmic, and the slope of each line of three marks or more, fitted by
least squares, with the fit's standard error: −1 is what independent samples give, whatever the method; a net of Sobol points, all of a pixel's samples being one, falls
faster where the light is smooth. Biased methods stop at the square of what they lack. The dashed line has slope −1. Grey below:
the truth is itself that noisy, and no error can be measured there; marks within a factor of {reach:g} of it have no part in a slope. Where few samples hold the light
(Fireflies, below), a line leaps whenever one of them is met: there a slope of few marks tells little, and its standard error, which
knows these marks alone, may be far too small."""

EFFICIENCY = """1 over relMSE × seconds of processor time a pixel, at {samples} samples: how much a method is worth at any
time, as one of twice the efficiency needs half the time for the same noise. Biased methods are left out: more time does
not help them. So is what lies within a factor of {reach:g} of the truth's own noise, which would be taken for the method's.{noisy}"""

DEPTH = """How much darker the image, or the mean radiance of the closed box's floor, gets by ending paths after so many
bounces; 1 is direct light alone. The strong line without marks is what radiosity, without a ray, says of the floor.
Differences below twice their standard error, or below {few:g}, are left out: the samples cannot tell them from none."""

BOUNCES = """Rays of Whitted tracing for each primary ray, by the bounce: mirrors send on one ray, glass two, so that bounce k
has at most 2^k (the dashed line). Shadow rays come on top: every diffuse hit asks each lamp."""

BIAS = """How far the mean over all pixels is from the truth, in shares of it, for each way to write
path tracing down; lines span four standard errors to each side. On 0 stands what is unbiased. emitters: the pseudo-code as it is
usually printed, where lamps that are met count nothing and reflect nothing; roulette_first: the die is cast before the
direct light, which is not divided by its probability; half_pi: the hemisphere taken for π/2."""

SPEED = """Paths a second of processor time, all their rays included, of one integrator over two trees: ours, which gets the
rays of thousands of paths at once, and Embree's, one ray a call. Both have the same mean, pixel by pixel."""

FIREFLIES = """How few samples hold the light: the largest sample's share of the whole image against the kurtosis of a pixel's
samples (3 for a normal distribution), each method at most samples. Those to the upper right show single bright pixels,
and their estimate of their own error is not to be trusted."""


def cards(task, numbers, width="container"):
    if task.name != "light_transport":
        return []
    made = (_convergence(task, numbers, width), _efficiency(task, numbers, width), _speed(task, numbers, width),
            _depth(task, width), _bias(task, width), _bounces(task, width), _fireflies(task, numbers, width))  # fmt: skip
    return [card for card in made if card.figures]


def field(row, name):
    return row.extra.get(f"light_transport_{name}")


def soft(task):
    """Of the first run and thread count, that have an error."""
    run, threads = (task.runs or [0])[0], (task.threads or [None])[0]
    return [r for r in task.soft if r.run == run and r.threads == threads and r.status in ("ok", "wrong") and r.error]


def plain(row):
    """Samples alone, and which points."""
    return set(row.query_knobs or {}) <= {"samples", "points"}


def samples(row):
    return (row.query_knobs or {}).get("samples")


def series_name(row):
    return row.method + (" (sobol)" if (row.query_knobs or {}).get("points") == "sobol" else "")


def slope(points):
    """Of log y against log x, by least squares; None of fewer than two x."""
    logs = [(log(x), log(y)) for x, y in points if x > 0 and y > 0]
    if len({x for x, _ in logs}) < 2:
        return None
    mx, my = (sum(v[k] for v in logs) / len(logs) for k in (0, 1))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)


def slope_error(points):
    """Standard error of that slope, by what the points are off their line; None of fewer than three."""
    logs, fitted = [(log(x), log(y)) for x, y in points if x > 0 and y > 0], slope(points)
    if fitted is None or len(logs) < 3:
        return None
    mx, my = (sum(v[k] for v in logs) / len(logs) for k in (0, 1))
    off = sum((y - my - fitted * (x - mx)) ** 2 for x, y in logs)
    return sqrt(off / (len(logs) - 2) / sum((x - mx) ** 2 for x, _ in logs))


def slope_text(points):
    """"−1.02 ± 0.04", to the digits that its error leaves; nothing where there is no error."""
    error = slope_error(points)
    if error is None:
        return ""
    digits = 2 if error < 0.095 else 1
    return f" {slope(points):+.{digits}f} ± {error:.{digits}f}".replace("-", "−")


def noise(rows):
    """The truth's own relMSE, or None where it has none, as formulas."""
    return max((r.error_floor or 0 for r in rows), default=0) ** 2 or None


def told_apart(row):
    """Its error is told from the truth's."""
    return field(row, "rel_mse") > REACH * (row.error_floor or 0) ** 2


def series(rows):
    """{series: [(samples, relMSE, row)]}, ascending; the build with most rows."""
    found = {}
    for row in rows:
        if samples(row) and field(row, "rel_mse"):
            found.setdefault((series_name(row), str(row.build_knobs)), []).append((samples(row), field(row, "rel_mse"), row))
    out = {}
    for (name, _), points in found.items():
        out.setdefault(name, sorted(points, key=lambda p: p[0]))
    return {name: points for name, points in out.items() if len(points) > 1}


def _rooms(task, rows):
    """(dataset, its rows of the set image at its largest size)"""
    for dataset in task.datasets:
        mine = [r for r in rows if r.dataset == dataset and r.query_set == "image"]
        if mine:
            size = max(r.size for r in mine)
            yield f"{dataset}, {several(size, task.text.element)}", dataset, [r for r in mine if r.size == size]


def _looks(task, methods):
    return {m: look for m, look in task.looks.items() if m in methods}


# ---- convergence -----------------------------------------------------------------------------------------------------


def _convergence(task, numbers, width):
    figures, methods = [], set()
    for title, dataset, rows in _rooms(task, soft(task)):
        found = series([r for r in rows if plain(r) or r.method == "textbook_literal" and r.query_knobs.get("slip") == "emitters"])
        if not found:
            continue
        values, ends = [], []
        for name, points in found.items():
            for n, error, row in points:
                values.append({"i": numbers[id(row)], "method": row.method, "series": name, "x": n, "y": error})
            text = name + slope_text([p[:2] for p in points if told_apart(p[2])])
            ends.append({"method": points[0][2].method, "x": points[-1][0], "y": points[-1][1], "text": text})
        looks = _looks(task, {v["method"] for v in values})
        methods |= set(looks)
        chart = _convergence_chart(values, ends, looks, noise(rows), width)
        figures.append(Figure(f"{task.name}-convergence-{dataset}", title, dataset, chart))
    return Card(f"{task.name}-card-convergence", "Convergence", CONVERGENCE.format(reach=REACH), figures, tuple(methods))


LABELS = 170  # pixels beside the lines, for their names and slopes


def _convergence_chart(values, ends, looks, floor, width):
    height = 300
    first, most = (pick(v["x"] for v in values) for pick in (min, max))
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, domain=[first, most], range=[4, alt.expr(f"width - {LABELS}")]),
              axis=alt.Axis(title="samples a pixel, log", values=sorted({v["x"] for v in values}), gridOpacity=0.5))  # fmt: skip
    shown = [v["y"] for v in values] + ([floor] if floor else [])
    low, high = min(shown) / 1.5, 1.5 * max(shown)
    places = charts.spread([e["y"] for e in ends], [low, high], height)
    ends = [end | {"at": place} for end, place in zip(ends, places)]
    low, high = min(low, *places), max(high, *places)
    scale = alt.Scale(type="log", nice=False, domain=[low, high])
    y = alt.Y("y:Q", scale=scale, axis=alt.Axis(title="relMSE, log", format=".0e", tickCount=6, gridOpacity=0.5))
    color, _ = charts._scales(looks)
    base = alt.Chart(alt.Data(values=values))
    start = sorted(v["y"] for v in values if v["x"] == first)
    start = start[len(start) // 2]
    ideal = alt.Chart(alt.Data(values=[{"x": first, "y": start}, {"x": most, "y": max(start * first / most, low)}]))
    ideal = ideal.mark_line(color=INK, strokeDash=[3, 3], opacity=0.6).encode(x=x, y=y)
    lines = base.mark_line(strokeWidth=1.4, opacity=charts._pick("0.8")).encode(
        x=x, y=y, detail=alt.Detail("series:N"), stroke=alt.Stroke("method:N", scale=color, legend=None))  # fmt: skip
    dots = charts._points(base, looks, False, 30).encode(x=x, y=y)
    label = alt.Chart(alt.Data(values=ends)).mark_text(align="left", dx=6, fontSize=9, fill=INK, opacity=charts._pick("0.9")).encode(
        x=x, y=alt.Y("at:Q", scale=scale), text=alt.Text("text:N"))  # fmt: skip
    ground = []
    if floor:  # what no error can be measured in
        at = alt.Chart(alt.Data(values=[{"y": floor, "low": low}]))
        ground = [at.mark_rect(color="#888", opacity=0.25).encode(y=y, y2=alt.Y2("low:Q")),
                  at.mark_text(align="left", baseline="top", x=5, dy=3, fontSize=9, fontStyle="italic", fill=INK, opacity=0.7).encode(
                      y=y, text=alt.value("the truth's own noise"))]  # fmt: skip
    return charts.layered(*ground, ideal, lines, dots, label, width=width, height=height)


# ---- efficiency and speed ----------------------------------------------------------------------------------------------


def efficiency(row):
    return 1e9 / (field(row, "rel_mse") * row.query_cpu_ns) if field(row, "rel_mse") and row.query_cpu_ns else None


def _lanes(values, looks, title, width):
    """A lane a series, log; each mark with its label."""
    names = list(dict.fromkeys(v["series"] for v in values))
    scale = alt.Scale(type="log", nice=False, padding=40)
    x = alt.X("x:Q", scale=scale, axis=charts._log_axis("x", "format(datum.value, '~s')", title))
    y = alt.Y("series:N", sort=names, scale=alt.Scale(domain=names),
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=150))  # fmt: skip
    base = alt.Chart(alt.Data(values=values))
    dots = charts._points(base, looks, False).encode(x=x, y=y)
    labels = [layer.encode(x=x, y=y, text=alt.Text("label:N")) for layer in charts._named(base, "0.85", dx=8)]
    return charts.layered(dots, *labels, width=width, height=alt.Step(15))


def _efficiency(task, numbers, width):
    figures, drowned = [], []
    for title, dataset, rows in _rooms(task, soft(task)):
        values, seen, noisy = [], set(), False
        for r in rows:
            name = series_name(r)
            if r.claim == "stochastic" and plain(r) and samples(r) == EQUAL and efficiency(r) and name not in seen:
                seen.add(name)
                if not told_apart(r):
                    noisy = True
                    continue
                values.append({"i": numbers[id(r)], "method": r.method, "series": name, "x": efficiency(r)})
        if noisy:
            drowned.append(dataset)
        if not values:
            continue
        mis = next((v["x"] for v in values if v["series"] == "mis"), None)
        for v in values:
            v["label"] = f"{figure(v['x'] / mis)}×" if mis else ""
        chart = _lanes(values, _looks(task, {v["method"] for v in values}), "1 / (relMSE · s), log; × that of mis", width)
        figures.append(Figure(f"{task.name}-efficiency-{dataset}", title, dataset, chart))
    noisy = f" Here that leaves out some of {', '.join(drowned)}: a finer profile has a quieter truth." if drowned else ""
    caption = EFFICIENCY.format(samples=EQUAL, reach=REACH, noisy=noisy)
    return Card(f"{task.name}-card-efficiency", "Efficiency", caption, figures)


def paths_a_second(row):
    return 1e9 * samples(row) / (row.query_cpu_ns * (row.threads or 1)) if row.query_cpu_ns and samples(row) else None


def speeds(rows):
    """{dataset: (ours, Embree's)}: the rows of mis and mis_embree at most samples, Embree's best build."""
    found = {}
    for dataset in dict.fromkeys(r.dataset for r in rows):
        best = {}
        for r in rows:
            if r.dataset != dataset or r.query_set != "image" or r.hard or not plain(r) or (r.query_knobs or {}).get("points"):
                continue
            if r.method in ("mis", "mis_embree") and samples(r) == EQUAL and paths_a_second(r):
                if r.method not in best or paths_a_second(r) > paths_a_second(best[r.method]):
                    best[r.method] = r
        if len(best) == 2:
            found[dataset] = (best["mis"], best["mis_embree"])
    return found


def _speed(task, numbers, width):
    values = []
    for dataset, pair in speeds(soft(task)).items():
        ratio = paths_a_second(pair[0]) / paths_a_second(pair[1])
        for r in pair:
            label = f"mis {figure(ratio)}×" if r is max(pair, key=paths_a_second) else ""  # where no mark follows
            values.append({"i": numbers[id(r)], "method": r.method, "series": dataset, "x": paths_a_second(r), "label": label})
    if not values:
        return Card("", "", "", [])
    looks = _looks(task, {v["method"] for v in values})
    chart = _lanes(values, looks, "paths a second of processor time, log; × Embree's", width)
    return Card(f"{task.name}-card-speed", "Paths a second", SPEED, [Figure(f"{task.name}-speed", "mis over two trees", "", chart)],
                tuple(looks))  # fmt: skip


# ---- depth, bias, bounces ------------------------------------------------------------------------------------------------


def depth(rows):
    """{what: [(bounces, how much darker or None where samples cannot tell, what radiosity says or None)]}"""
    found = {}
    for r in rows:
        bounces = (r.query_knobs or {}).get("bounces")
        if r.method != "mis" or bounces is None or r.hard:
            continue
        if r.query_set == "walls":
            told, exact, what = field(r, "floor_bias"), field(r, "floor_exact"), f"{r.dataset}, floor"
        else:
            told, exact, what = r.bias, None, r.dataset
        if told is not None:
            least = max(FEW, 2 * (field(r, "floor_error" if r.query_set == "walls" else "bias_error") or 0))
            point = (bounces, -told if abs(told) >= least else None, None if exact is None else -exact)
            found.setdefault(what, []).append(point)
    return {what: sorted(points, key=lambda p: p[0]) for what, points in found.items()}


def _depth(task, width):
    found = depth(soft(task))
    told = [{"what": what, "x": b, "y": y} for what, points in found.items() for b, y, _ in points if y and y > 0]
    exact = [{"what": what, "x": b, "y": e} for what, points in found.items() for b, _, e in points if e and e > FEW]
    if not told:
        return Card("", "", "", [])
    names = list(dict.fromkeys(v["what"] for v in told))
    color = alt.Color("what:N", scale=alt.Scale(domain=names, scheme="tableau10"),
                      legend=alt.Legend(title=None, orient="bottom", columns=2, labelLimit=220))  # fmt: skip
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, padding=14),
              axis=alt.Axis(title="bounces, log", values=[1, 2, 3, 5, 10, 20], gridOpacity=0.5))  # fmt: skip
    y = alt.Y("y:Q", scale=alt.Scale(type="log", nice=False, padding=10),
              axis=charts._log_axis("y", "format(datum.value, '~%')", "share of the light that is missing, log"))  # fmt: skip
    tooltip = [alt.Tooltip("what:N"), alt.Tooltip("x:Q", title="bounces"), alt.Tooltip("y:Q", title="missing", format=".3~%")]
    base = alt.Chart(alt.Data(values=told))
    layers = [base.mark_line(strokeWidth=1.2, opacity=0.8).encode(x=x, y=y, color=color)]
    layers.append(base.mark_point(filled=True, size=40, opacity=1).encode(x=x, y=y, color=color, tooltip=tooltip))
    if exact:
        layers.insert(1, alt.Chart(alt.Data(values=exact)).mark_line(strokeWidth=2.5).encode(x=x, y=y, color=color))
    chart = alt.layer(*layers, width=width, height=300)
    return Card(f"{task.name}-card-depth", "How many bounces", DEPTH.format(few=FEW),
                [Figure(f"{task.name}-depth", "What further bounces bring", "", chart)])  # fmt: skip


def bias_rows(rows):
    """[(row, what, bias, standard error)] of the textbook's path tracers at most samples."""
    found = {}
    for r in rows:
        if not r.method.startswith("textbook") or r.query_set != "image" or r.hard or r.bias is None or not field(r, "bias_error"):
            continue
        slip = (r.query_knobs or {}).get("slip")
        key = (r.dataset, r.method, slip)
        if key not in found or samples(r) > samples(found[key]):
            found[key] = r
    out = []
    for (_, method, slip), r in found.items():
        out.append((r, slip or method.removeprefix("textbook_"), r.bias, field(r, "bias_error")))
    return out


PERCENT = 66  # pixels beside the rightmost mark, for its label


def _bias(task, width):
    figures = []
    every = bias_rows(soft(task))
    for dataset in dict.fromkeys(r.dataset for r, *_ in every):
        values = [{"name": name, "x": bias, "lo": bias - 4 * error, "hi": bias + 4 * error, "label": f"{100 * bias:+.2f} %".replace("-", "−"),
                   "error": f"{100 * error:.2g} %", "knobs": knob_text(r.query_knobs)}
                  for r, name, bias, error in every if r.dataset == dataset]  # fmt: skip
        names = [v["name"] for v in values]
        base = alt.Chart(alt.Data(values=values))
        scale = alt.Scale(domain=[min(-0.05, *(v["lo"] for v in values)), max(0.05, *(v["hi"] for v in values))], nice=False,
                          range=[8, alt.expr(f"width - {PERCENT}")])  # fmt: skip
        x = alt.X("x:Q", scale=scale, axis=alt.Axis(title="bias, relative", format="+.0%", tickCount=4, labelOverlap="greedy",
                                                     labelSeparation=4, gridOpacity=0.5))  # fmt: skip
        y = alt.Y("name:N", sort=names, axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5))
        zero = alt.Chart(alt.Data(values=[{"x": 0}])).mark_rule(color=INK, strokeDash=[3, 3], opacity=0.6).encode(x=alt.X("x:Q", scale=scale))
        spans = base.mark_rule(strokeWidth=2, color="#0072B2").encode(x=alt.X("lo:Q", scale=scale), x2=alt.X2("hi:Q"), y=y)
        dots = base.mark_point(filled=True, size=50, color="#0072B2", opacity=1).encode(x=x, y=y, tooltip=[
            alt.Tooltip("name:N"), alt.Tooltip("label:N", title="bias"), alt.Tooltip("error:N", title="standard error"),
            alt.Tooltip("knobs:N", title="asked with")])  # fmt: skip
        labels = [layer.encode(x=alt.X("hi:Q", scale=scale), y=y, text=alt.Text("label:N")) for layer in charts._named(base, "0.85", dx=8)]
        chart = charts.layered(zero, spans, dots, *labels, width=width, height=alt.Step(22))
        figures.append(Figure(f"{task.name}-bias-{dataset}", dataset, dataset, chart))
    return Card(f"{task.name}-card-bias", "The textbook's path tracer", BIAS, figures)


def bounces(rows):
    """{dataset: [rays of bounce 1, 2, … for each primary ray]} of Whitted tracing with most bounces."""
    best = {}
    for r in rows:
        if r.method == "whitted" and r.query_set == "image" and field(r, "bounce_1") is not None:
            limit = (r.query_knobs or {}).get("bounces", 0)
            if r.dataset not in best or limit > best[r.dataset].query_knobs.get("bounces", 0):
                best[r.dataset] = r
    out = {}
    for dataset, r in best.items():
        rays = []
        while (n := field(r, f"bounce_{len(rays) + 1}")) is not None:
            rays.append(n)
        out[dataset] = rays
    return out


def _bounces(task, width):
    found = {d: rays for d, rays in bounces(soft(task)).items() if rays and rays[0] > 0}
    if not found:
        return Card("", "", "", [])
    values = [{"what": d, "x": k + 1, "y": n} for d, rays in found.items() for k, n in enumerate(rays) if n > 1e-3]
    most = max(v["x"] for v in values)
    names = list(found)
    x = alt.X("x:Q", scale=alt.Scale(domain=[1, most], nice=False, padding=10),
              axis=alt.Axis(title="bounce", tickMinStep=1, gridOpacity=0.5))  # fmt: skip
    y = alt.Y("y:Q", scale=alt.Scale(type="log", nice=False, padding=10),
              axis=alt.Axis(title="rays for a primary ray, log", tickCount=6, format="~g", gridOpacity=0.5))  # fmt: skip
    color = alt.Color("what:N", scale=alt.Scale(domain=names, scheme="tableau10"),
                      legend=alt.Legend(title=None, orient="bottom", columns=2, labelLimit=220))  # fmt: skip
    limit = alt.Chart(alt.Data(values=[{"x": k, "y": 2**k} for k in range(1, most + 1)])).mark_line(
        color=INK, strokeDash=[3, 3], opacity=0.6).encode(x=x, y=y)  # fmt: skip
    chart = alt.layer(limit, alt.Chart(alt.Data(values=values)).mark_line(point=True).encode(
        x=x, y=y, color=color, tooltip=[alt.Tooltip("what:N", title="dataset"), alt.Tooltip("x:Q", title="bounce"),
                                        alt.Tooltip("y:Q", title="rays", format=".3~g")]))  # fmt: skip
    return Card(f"{task.name}-card-bounces", "Rays by the bounce", BOUNCES,
                [Figure(f"{task.name}-bounces", "Whitted tracing", "", chart.properties(width=width, height=280))])  # fmt: skip


NARROWEST = 4  # the least ratio of an axis' ends: what differs by a hundredth must not look far apart


def at_least(values):
    """The least and the largest, or ends farther apart, in the ratio NARROWEST, around them."""
    low, high = min(values), max(values)
    more = max(1, sqrt(NARROWEST * low / high))
    return [low / more, high * more]


def _fireflies(task, numbers, width):
    figures, methods = [], set()
    for title, dataset, rows in _rooms(task, soft(task)):
        values = {}
        for r in rows:
            share, kurtosis = field(r, "largest_share"), field(r, "kurtosis")
            if r.claim == "stochastic" and plain(r) and share and kurtosis and (samples(r) or 0) >= 16:
                name = series_name(r)
                if name not in values or samples(r) > values[name][0]:
                    values[name] = (samples(r), {"i": numbers[id(r)], "method": r.method, "x": share, "y": kurtosis})
        if len(values) < 3:
            continue
        data = [v for _, v in values.values()]
        looks = _looks(task, {v["method"] for v in data})
        methods |= set(looks)
        x, y = (alt.Scale(type="log", nice=False, padding=pad, domain=at_least([v[k] for v in data]))
                for k, pad in (("x", 14), ("y", 10)))  # fmt: skip
        x = alt.X("x:Q", scale=x, axis=alt.Axis(
            title="largest sample's share of the image, log", format="~g", tickCount=4, labelOverlap="greedy",
            labelSeparation=6, gridOpacity=0.5))  # fmt: skip
        y = alt.Y("y:Q", scale=y, axis=alt.Axis(title="kurtosis, log", format="~s", tickCount=5, gridOpacity=0.5))  # fmt: skip
        chart = charts._points(alt.Chart(alt.Data(values=data)), looks, False).encode(x=x, y=y)
        chart = charts.layered(chart, width=width, height=220)
        figures.append(Figure(f"{task.name}-fireflies-{dataset}", title, dataset, chart))
    return Card(f"{task.name}-card-fireflies", "Fireflies", FIREFLIES, figures, tuple(methods))
