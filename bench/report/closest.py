"""What only the task closest_point shows: how much mesh a query needs, and how often slivers lead astray."""

from bench.report import charts
from bench.report.palette import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION
from bench.report.rows import knob_text
from bench.report.series import Card, Figure
from bench.report.units import count

alt = charts.alt
COLORS = (VERMILION, BLUE, GREEN, ORANGE, SKY, PURPLE, INK)
DECIMATED = "bvh_decimated"
SLIVERS = ("needles", "caps")

LEAST = """How much mesh does a query need? Left of 100 % the same tree stands over what OpenMesh's decimation by quadrics
leaves of the mesh. Errors are distances over the diagonal: marks are the mean, the ends of the lines the worst; sets stand side
by side at each share, so that none hides another. Times are
over that of the whole mesh in the same query set; below 1 is faster. Where errors fall level, what is left is the rounding
of single precision."""

ASTRAY = """The share of answers off by more than a millionth of the diagonal, on soups of thin triangles of aspect 10 to
100,000.{named} A mark at the left edge had none among the queries judged."""
NAMED = """ Of these, {share:.0%} name a triangle that is itself farther than the nearest by more than that, so that measuring
the answer again does not mend them."""


def cards(task, numbers, width="container"):
    if task.name != "closest_point":
        return []
    made = (_least_mesh(task, numbers, width), _astray(task, numbers, width))
    return [card for card in made if card.figures]


def _rows(task):
    """Of the first run and thread count, that have an error."""
    run, threads = (task.runs or [0])[0], (task.threads or [None])[0]
    return [r for r in task.soft if r.run == run and r.threads == threads and r.status in ("ok", "wrong") and r.error is not None]


# ---- the least mesh --------------------------------------------------------------------------------------------------


def ladder(rows):
    """{(dataset, n): {query set: [rows by the share kept, least first]}}, where at least two shares are there."""
    found = {}
    for row in rows:
        if row.method == DECIMATED and "keep" in (row.build_knobs or {}):
            found.setdefault((row.dataset, row.n), {}).setdefault(row.query_set, []).append(row)
    for sets in found.values():
        for rungs in sets.values():
            rungs.sort(key=lambda r: r.build_knobs["keep"])
    return {key: sets for key, sets in found.items() if any(len(rungs) > 1 for rungs in sets.values())}


ASIDE = 1.045  # how much farther along the logarithmic axis each set stands: some four pixels


def _least_mesh(task, numbers, width):
    figures = []
    for (dataset, n), sets in ladder(_rows(task)).items():
        values = []
        for k, (query_set, rungs) in enumerate(sets.items()):
            beside = ASIDE ** (k - (len(sets) - 1) / 2)
            whole = next((r.query_ns for r in rungs if r.build_knobs["keep"] == 1), None)
            for r in rungs:
                floor = r.error_floor or 1e-12  # a zero has no place on a logarithmic axis
                values.append({"i": numbers[id(r)], "set": query_set, "keep": 100 * r.build_knobs["keep"] * beside,
                               "error": max(r.error, floor), "max": max(r.error_max or 0.0, floor),
                               "time": r.query_ns / whole if whole and r.query_ns else None})  # fmt: skip
        where = f"{dataset}, {count(n)} triangles"
        name = f"{task.name}-least-{dataset}-{n}"
        figures.append(Figure(f"{name}-error", f"Error: {where}", dataset, _ladder_chart(values, "error", width)))
        figures.append(Figure(f"{name}-time", f"Time: {where}", dataset, _ladder_chart(values, "time", width)))
    return Card(f"{task.name}-card-least", "The least mesh", LEAST, figures)


def _ladder_chart(values, field, width):
    sets = list(dict.fromkeys(v["set"] for v in values))
    color = alt.Color("set:N", scale=alt.Scale(domain=sets, range=[COLORS[k % len(COLORS)] for k in range(len(sets))]),
                      legend=alt.Legend(title=None, orient="bottom", columns=3, symbolType="circle"))  # fmt: skip
    x = alt.X("keep:Q", scale=alt.Scale(type="log", nice=False, padding=14), axis=alt.Axis(
        title="share of the faces, log", values=[5, 10, 25, 50, 100], labelExpr="datum.value + ' %'", gridOpacity=0.5))  # fmt: skip
    if field == "error":
        axis = alt.Axis(title="error over the diagonal, log", format=".0e", gridOpacity=0.5)
        scale = alt.Scale(type="log", nice=False, padding=10)
    else:
        axis = charts._log_axis("y", "format(datum.value, '~g')", "times the whole mesh's time per query, log")
        scale = alt.Scale(type="log", nice=False, padding=10)
    y = alt.Y(f"{field}:Q", scale=scale, axis=axis)
    base = alt.Chart(alt.Data(values=values)).transform_filter(f"isValid(datum.{field})").encode(x=x)
    layers = [base.mark_line(strokeWidth=1.4, opacity=0.8).encode(y=y, color=color)]
    if field == "error":
        layers.append(base.mark_rule(strokeWidth=1.2, opacity=0.5).encode(y=y, y2=alt.Y2("max:Q"), color=color))
    layers.append(base.mark_point(filled=True, size=44, opacity=1).encode(y=y, color=color, tooltip=alt.Tooltip("i:Q")))
    return alt.layer(*layers, width=width, height=240)


# ---- slivers ---------------------------------------------------------------------------------------------------------


def astray(rows):
    """{(dataset, n, query set): [(row, share far off)]}, the worst build of each method and query knobs."""
    found = {}
    for row in rows:
        share = row.extra.get("closest_point_far_off")
        if row.dataset not in SLIVERS or share is None or row.method == DECIMATED:
            continue
        if row.query_set not in ("near", "uniform"):
            continue
        worst = found.setdefault((row.dataset, row.n, row.query_set), {})
        key = row.method, knob_text(row.query_knobs)
        if key not in worst or share > worst[key][1]:
            worst[key] = row, share
    return {key: list(worst.values()) for key, worst in found.items()}


LEAST_SHARE = 1e-4


def _astray(task, numbers, width):
    figures = []
    for (dataset, n, query_set), found in astray(_rows(task)).items():
        several = {}
        for row, _ in found:
            several[row.method] = several.get(row.method, 0) + 1
        values = []
        for row, share in found:
            knobs = knob_text(row.query_knobs)
            line = f"{row.method}, {knobs}" if several[row.method] > 1 and knobs else row.method
            values.append({"i": numbers[id(row)], "method": row.method, "line": line, "share": max(share, LEAST_SHARE),
                           "label": f"{share:.2%}" if share else "none"})  # fmt: skip
        looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
        chart = _astray_chart(values, looks, width)
        title = f"{dataset}, {count(n)} triangles: {query_set}"
        figures.append(Figure(f"{task.name}-astray-{dataset}-{query_set}", title, dataset, chart))
    return Card(f"{task.name}-card-astray", "Led astray by slivers", ASTRAY.format(named=_named(_rows(task))), figures)


def _named(rows):
    """How many of the answers that are far off name a farther triangle."""
    shares = [(row, share) for found in astray(rows).values() for row, share in found]
    off = sum(share for _, share in shares)
    farther = sum(row.extra.get("closest_point_much_farther") or 0 for row, _ in shares)
    return NAMED.format(share=farther / off) if off else ""


def _astray_chart(values, looks, width):
    lines = list(dict.fromkeys(v["line"] for v in values))
    scale = alt.Scale(type="log", domain=[LEAST_SHARE, 1], nice=False, padding=10)
    x = alt.X("share:Q", scale=scale, axis=alt.Axis(title="share off by > 1e-6, log", format="~%",
                                                    values=[1e-3, 1e-2, 0.1, 1], gridOpacity=0.5))  # fmt: skip
    y = alt.Y("line:N", sort=lines, scale=alt.Scale(domain=lines), axis=alt.Axis(
        title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=200))  # fmt: skip
    base = alt.Chart(alt.Data(values=values))
    dots = charts._points(base, looks, False).encode(x=x, y=y)
    named = base.mark_text(align="left", dx=8, fontSize=10, fill=charts.INK, opacity=0.85).encode(
        x=x, y=y, text=alt.Text("label:N"))  # fmt: skip
    return charts.layered(dots, named, width=width, height=alt.Step(15))
