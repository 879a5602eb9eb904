"""What only the task inside shows: how each rule for inside and outside stands damage done to a mesh, and what solids
become as BSP trees (solids.py)."""

from bench.report import charts, solids
from bench.report.palette import INK
from bench.report.rows import knob_text
from bench.report.series import Card, Figure
from bench.report.units import several

alt = charts.alt

ANSWERED = ("ok", "wrong")
LEFT_OUT = "unsupported"  # the status of rows that a method leaves to others

DAMAGE = """Of each method the per cent of wrong answers on one mesh damaged in one way after the other, against what is inside of
it undamaged. The number behind a damage's name is another: the per cent of the faces that it hit. No rule wins every column: rays count on closed surfaces, normals
on faces that look outward, winding numbers on most of them. ✓: none wrong among those asked; –: not asked, as a tree of a
solid does not take such faces, or a sum over all faces so many."""


def cards(task, numbers, width="container"):
    if task.name != "inside":
        return []
    figures = []
    for (base, size, query_set), found in damage_table(task.soft).items():
        chart = _chart(found, numbers, width)
        title = f"{query_set}: {base}, {several(size, task.text.element)}"
        figures.append(Figure(f"{task.name}-damage-{base}-{size}-{query_set}", title, base, chart))
    damage = Card(f"{task.name}-card-damage", "Damaged meshes", DAMAGE, figures) if figures else None
    return [card for card in (damage, solids.card(task, numbers, width)) if card]


def damage_table(rows):
    """{(undamaged dataset, size, query set): {(line, damage): row}}, of the first run and thread count. Those that a method
    leaves to others are among them, if it answers any."""
    answered = [r for r in rows if r.error is not None and r.status in ANSWERED]
    if not answered:
        return {}
    first = answered[0]
    rows = [r for r in rows if (r.run, r.threads) == (first.run, first.threads) and (r.status == LEFT_OUT or r.error is not None and r.status in ANSWERED)]
    methods = {r.method for r in answered if "+" in r.dataset}
    rows = [r for r in rows if r.method in methods]
    builds = {}
    for r in rows:
        builds.setdefault(r.method, []).append(r.build_knobs or {})
    found = {}
    for r in rows:
        base, plus, damage = r.dataset.partition("+")
        if not plus:
            continue
        told = knob_text(_telling(r.build_knobs or {}, builds[r.method]))
        line = f"{r.method}, {told}" if told else r.method
        found.setdefault((base, r.size, r.query_set), {})[line, damage] = r
    return found


def _telling(knobs, builds):
    """Those that are not the same in all builds of the method."""
    return {name: value for name, value in knobs.items() if any(other.get(name) != value for other in builds)}


def _share(row):
    if row.error is None:
        return "–"
    if row.error == 0:
        return "✓"
    percent = 100 * row.error
    return f"{percent:.0f}" if percent >= 9.95 else f"{percent:.2g}"


CELLS = ("#E6F4EE", "#D55E00")  # from none wrong to all
ON_CELL = "#111"  # text on a cell, which is pale or orange in both themes
HEAD = 45  # pixels by which the last column's slanting head reaches over the table


def _chart(found, numbers, width):
    left_out = lambda line: sum(r.error is None for (other, _), r in found.items() if other == line)
    lines = sorted(dict.fromkeys(line for line, _ in found), key=left_out)
    damages = list(dict.fromkeys(damage for _, damage in found))
    values = [{"i": numbers[id(row)], "line": line, "damage": damage.replace("_", " "), "text": _share(row),
               "share": None if row.error is None else max(row.error, 1e-4)}
              for (line, damage), row in found.items()]  # fmt: skip
    x = alt.X("damage:N", sort=[d.replace("_", " ") for d in damages],
              axis=alt.Axis(title=None, orient="top", labelAngle=-30, ticks=False, domain=False))  # fmt: skip
    y = alt.Y("line:N", sort=lines, axis=alt.Axis(title=None, ticks=False, domain=False, labelLimit=320))
    color = alt.Color("share:Q", legend=None, scale=alt.Scale(type="log", domain=[1e-4, 1], range=list(CELLS)))
    base = alt.Chart(alt.Data(values=values)).encode(x=x, y=y, tooltip=alt.Tooltip("i:Q"))
    cells = (base.transform_filter("isValid(datum.share)").mark_rect(stroke=charts.PAPER, strokeWidth=1.5)
             .encode(color=color))  # fmt: skip
    texts = base.mark_text(fontSize=10, fill=alt.expr(f"isValid(datum.share) ? '{ON_CELL}' : '{INK}'")).encode(
        text=alt.Text("text:N"))  # fmt: skip
    return alt.layer(cells, texts, width=width, height=alt.Step(20),
                     padding={"left": 5, "top": 5, "right": HEAD, "bottom": 5})
