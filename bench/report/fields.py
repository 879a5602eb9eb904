"""The card of the task distance_field: error of look-ups and of the samples themselves, and time to build, against
resolution. Each line is one method, by its best knobs at each resolution."""

from bench.report import charts
from bench.report.model import extra
from bench.report.units import several

alt = charts.alt

CAPTION = """How far distances near the surface are off, and what the samples cost, against the cells along the mesh's
longest side. Trilinear look-ups lose four times less with twice the resolution where the distance is smooth, tricubic ones
more; at edges, on the medial axis and on a mesh's own facets both only halve it. For rays (the set trace) trilinear look-ups
are the better ones: by tricubic ones they take twice the steps, and a few of them run out of these. Samples: how far the
distances that a field keeps in its band are off, whatever their sign. A hollow mark is a peer; the line of a method is its
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
            values = [{"i": numbers[id(r)], "method": r.method, "n": n, "x": value(r)} for r, n in found if value(r)]
            looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
            if not values:
                continue
            out.append((f"{task.name}-resolution-{what}-{dataset}", f"{what}: {where}", dataset,
                        _chart(values, looks, title, legend, width), looks))  # fmt: skip
    return out


def _chart(values, looks, title, legend, width):
    color, _ = charts._scales(looks)
    log = dict(type="log", nice=False, padding=14)
    x = alt.X("n:Q", scale=alt.Scale(**log), axis=alt.Axis(title="cells along the longest side, log",
              values=sorted({v["n"] for v in values}), gridOpacity=0.5))  # fmt: skip
    y = alt.Y("x:Q", scale=alt.Scale(**log), axis=alt.Axis(title=title, format=".0e", tickCount=5, gridOpacity=0.5))
    base = alt.Chart(alt.Data(values=values))
    line = base.mark_line(strokeWidth=1.4, opacity=charts._pick("0.8")).encode(
        x=x, y=y, stroke=alt.Stroke("method:N", scale=color, legend=charts._key(legend)))  # fmt: skip
    dots = charts._points(base, looks, legend).encode(x=x, y=y)
    return alt.layer(line, dots).add_params(charts._pick_param()).properties(width=width, height=260)
