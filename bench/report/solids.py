"""What BSP trees of solids make of a mesh, for the task inside: polygons and depth against size, by how their planes are
chosen."""

from bench.report import charts
from bench.report.palette import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from bench.report.series import Card, Figure

alt = charts.alt
EXACT, ROUNDED = "bsp_solid", "bsp_solid_rounded"
COLORS = (VERMILION, BLUE, GREEN, ORANGE, SKY, PURPLE)
WHAT = {"fragments": "polygons in the tree per face", "depth": "depth of the tree, log"}

CAPTION = """What a BSP tree of a solid makes of the faces it is given, against their number: every plane cuts all that it
meets, and what is cut is stored in pieces. First faces cut rough surfaces most, and of convex ones, which they do not cut,
make a list as deep as it is long; the best of several, by cuts and balance, cuts least but in that case; medians along axes
first keep the tree shallow, for some more pieces. Hollow marks: medians again, in single precision with an epsilon relative
to the extent; its wrong answers of damaged meshes stand in the card above, of whole ones in the charts below."""


def strategy(row):
    """How a row's tree chose its planes, in words."""
    knobs = row.build_knobs or {}
    if row.method == ROUNDED:
        return f"rounded, epsilon {knobs['epsilon']:.0e}" if "epsilon" in knobs else "rounded"
    tries = knobs.get("candidates", 1)
    faces = f"best of {tries} faces" if tries > 1 else "first face"
    return f"axis medians, then {faces}" if knobs.get("axis_levels") else faces


def trees(task):
    """{dataset: {strategy: [rows by size]}} of the first run and thread count, where a dataset has several sizes."""
    run, threads = (task.runs or [0])[0], (task.threads or [None])[0]
    found = {}
    for r in task.soft:
        if r.method not in (EXACT, ROUNDED) or (r.run, r.threads) != (run, threads) or "+" in r.dataset:
            continue
        if r.extra.get("inside_fragments") is not None and r.extra.get("inside_depth") is not None:
            # One tree answers all query sets.
            found.setdefault(r.dataset, {}).setdefault(strategy(r), {}).setdefault(r.n, r)
    found = {dataset: {how: [rows[n] for n in sorted(rows)] for how, rows in lines.items()} for dataset, lines in found.items()}
    return {dataset: lines for dataset, lines in found.items() if any(len(rows) > 1 for rows in lines.values())}


def card(task, numbers, width="container"):
    """None where no dataset has trees of several sizes."""
    found = trees(task)
    every = list(dict.fromkeys(how for lines in found.values() for how in lines))
    figures = [Figure(f"{task.name}-solids-{what}-{dataset}", f"{what}: {dataset}", dataset,
                      _chart(lines, every, numbers, what, width))
               for dataset, lines in found.items() for what in WHAT]  # fmt: skip
    return Card(f"{task.name}-card-solids", "Solids", CAPTION, figures) if figures else None


def _chart(lines, every, numbers, what, width):
    values = [{"i": numbers[id(r)], "how": how, "n": r.n, "y": r.extra[f"inside_{what}"]}
              for how, rows in lines.items() for r in rows]  # fmt: skip
    drawn = [how for how in every if how in lines]
    color = alt.Scale(domain=drawn, range=[COLORS[every.index(how) % len(COLORS)] for how in drawn])
    fill = alt.Scale(domain=drawn, range=["transparent" if how.startswith("rounded") else c
                                          for how, c in zip(drawn, color.range)])  # fmt: skip
    legend = alt.Legend(title=None, orient="bottom", columns=1, labelLimit=240, symbolType="circle", symbolStrokeWidth=1.6)
    log = dict(type="log", nice=False, padding=14)
    x = alt.X("n:Q", scale=alt.Scale(**log), axis=alt.Axis(title="faces, log", gridOpacity=0.5, format="~s",
              values=sorted({v["n"] for v in values})))  # fmt: skip
    ticks = {"tickCount": 6}
    scale = alt.Scale(zero=False, nice=True, padding=10)
    if what == "depth":
        low, high = min(v["y"] for v in values) / 2, 2 * max(v["y"] for v in values)
        ticks = {"values": [t for k in range(7) for t in (10**k, 2 * 10**k, 5 * 10**k) if low <= t <= high]}
        scale = alt.Scale(**log)
    y = alt.Y("y:Q", scale=scale, axis=alt.Axis(title=WHAT[what], gridOpacity=0.5, **ticks))
    base = alt.Chart(alt.Data(values=values)).encode(x=x, y=y)
    stroke = alt.Stroke("how:N", scale=color, legend=legend)
    line = base.mark_line(strokeWidth=1.4, opacity=0.8).encode(stroke=stroke)
    dots = base.mark_point(strokeWidth=1.6, size=44, opacity=1).encode(
        stroke=stroke, fill=alt.Fill("how:N", scale=fill, legend=legend), tooltip=alt.Tooltip("i:Q"))  # fmt: skip
    return alt.layer(line, dots, width=width, height=240)
