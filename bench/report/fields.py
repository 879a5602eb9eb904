"""The card of the task distance_field: error of look-ups and of the samples themselves, and time to build, against
resolution. Each line is one method, by its best knobs at each resolution."""

from bench.report import charts
from bench.report.model import extra
from bench.report.units import several

alt = charts.alt

CAPTION = """How far distances near the surface are off, and what the samples cost, against the cells along the mesh's
longest side. Trilinear look-ups lose four times less with twice the resolution where the surface is smooth over a cell, tricubic
ones more; icosphere is a rough ball, and cells as large as these gain less on its bumps; at edges, on the medial axis and on a
mesh's own facets both only halve it. For rays (the set trace) trilinear look-ups
are the better ones: by tricubic ones they take twice the steps, and a few of them run out of these. Samples: how far the
distances that a field keeps in its band are off, whatever their sign. Bricks keep the samples that dense fields keep near the
surface, and answer as they do: where methods agree to a hundredth at every resolution their lines are one, and all marks but the
last are drawn open and larger, around it. Any other hollow mark is a peer; the line of a method is its
best knobs at each resolution. Builds begin with the mesh: trees are part of them."""


def sample_error(row):
    return extra(row, "sample_error_mean")


def points(rows, value=lambda r: r.error):
    """[(row, resolution)]: of each method the least value at each resolution, on the set near."""
    best = {}
    for r in rows:
        resolution = (r.build_knobs or {}).get("resolution")
        if not resolution or r.query_set != "near" or value(r) is None or r.status != "ok":
            continue
        key = r.method, resolution
        if key not in best or (value(r), r.build_s or 0) < (value(best[key]), best[key].build_s or 0):
            best[key] = r
    return [(r, resolution) for (_, resolution), r in sorted(best.items(), key=lambda item: item[0])]


def figures(task, numbers, width, legend):
    """[(name, title, dataset, chart, its methods' looks)]"""
    rows = [r for r in task.soft if r.run == (task.runs or [0])[0] and r.threads == (task.threads or [None])[0]]
    out = []
    for dataset in task.datasets:
        size = max((r.size for r in rows if r.dataset == dataset), default=0)
        here = [r for r in rows if r.dataset == dataset and r.size == size]
        found = points(here)
        if len({resolution for _, resolution in found}) < 2:
            continue
        where = f"{dataset}, {several(size, task.text.element)}"
        samples = points(here, sample_error)
        for what, found, title, value in (("error", found, "mean error in longest sides, log", lambda r: r.error),
                                          ("samples", samples, "mean error of samples, log", sample_error),
                                          ("build", found, "seconds to build, log", lambda r: r.build_s)):  # fmt: skip
            values = nested([{"i": numbers[id(r)], "method": r.method, "n": n, "x": value(r)} for r, n in found if value(r)])
            looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
            if not values:
                continue
            out.append((f"{task.name}-resolution-{what}-{dataset}", f"{what}: {where}", dataset,
                        _chart(values, looks, title, legend, width), looks))  # fmt: skip
    return out


AGREE = 1.01  # figures of two methods that differ by less are one in a chart


def nested(values):
    """The same with over, how many later methods hide a mark, and the size at which it reaches out from under them."""
    lines = {}
    for v in values:
        lines.setdefault(v["method"], {})[v["n"]] = v["x"]

    def one(a, b):
        return a.keys() <= b.keys() and all(1 / AGREE < b[n] / x < AGREE for n, x in a.items())

    names = sorted(lines, key=lambda m: -len(lines[m]))  # a method of fewer resolutions lies upon one of more
    over = {m: sum(one(lines[other], lines[m]) for other in names[k + 1 :]) for k, m in enumerate(names)}
    return [v | {"over": over[v["method"]], "size": 44 + 90 * over[v["method"]]} for v in values]


def _chart(values, looks, title, legend, width):
    color, _ = charts._scales(looks)
    log = dict(type="log", nice=False, padding=14)
    x = alt.X("n:Q", scale=alt.Scale(**log), axis=alt.Axis(title="cells along the longest side, log",
              values=sorted({v["n"] for v in values}), gridOpacity=0.5))  # fmt: skip
    y = alt.Y("x:Q", scale=alt.Scale(**log), axis=alt.Axis(title=title, format=".0e", tickCount=5, gridOpacity=0.5))
    base = alt.Chart(alt.Data(values=values))
    line = base.mark_line(strokeWidth=1.4, opacity=charts._pick("0.8")).encode(
        x=x, y=y, stroke=alt.Stroke("method:N", scale=color, legend=charts._key(legend)))  # fmt: skip
    _, shape = charts._scales(looks)
    around = base.transform_filter("datum.over > 0").mark_point(strokeWidth=1.6, fill="transparent", opacity=charts._pick("1")).encode(
        x=x, y=y, stroke=alt.Stroke("method:N", scale=color, legend=charts._key(legend)), tooltip=alt.Tooltip("i:Q"),
        shape=alt.Shape("method:N", scale=shape, legend=charts._key(legend)), size=alt.Size("size:Q", scale=None, legend=None))  # fmt: skip
    dots = charts._points(base.transform_filter("datum.over == 0"), looks, legend).encode(x=x, y=y)
    return charts.layered(line, around, dots, width=width, height=260)
