"""What theory says of cases that were made to break a method, beside what was measured: of every task whose rows say so.

Such a row has `<task>_figure`, the name of one of its fields; `<task>_figure_value`, what that should be; and
`<task>_figure_slack`, what queries, texels and rounding may leave of it, by derivation.
"""

from bench.report import charts
from bench.report.palette import INK, VERMILION
from bench.report.rows import knob_text
from bench.report.series import Card, Figure

alt = charts.alt

CAPTION = """Cases made so that theory says what a method gets wrong, or how wide it makes a penumbra: what its row says against
what it should. On the line they agree; what is farther off it than its bar, which is what so many queries, texels of that size
and float's rounding may leave, is a mistake of ours or of the theory. A mark's tooltip names its case and knobs. {words}"""
NAMES = {
    "shadow_false_dark": ("False shadow", "share of a plane, tilted or a slab's top, that shadows itself under too little bias"),
    "shadow_gap": ("Gap", "length of shadow that a bias takes from a wall's foot, metres"),
    "shadow_max": ("Leak", "most light that passes stacked blockers through two or four moments"),
    "shadow_width": ("Penumbra", "its width, from 10 to 90 % of the light, under a filter of a given size, metres"),
    "shadow_levels": ("Levels", "different answers that a filter of so many taps has"),
    "shadow_wrong": ("Off by one", "share of the picture that counts from inside a shadow get wrong"),
    "error": ("Rounding", "root mean square error of means from a table of sums in float, over the range of the texture's values"),
}
DOTS = {"color": VERMILION, "opacity": 0.85}  # told from the ground of a light page and of a dark one
TOOLTIP = [alt.Tooltip("label:N", title="method"), alt.Tooltip("case:N"), alt.Tooltip("knobs:N"),
           alt.Tooltip("is:Q", title="measured", format=".4~g"), alt.Tooltip("should:Q", title="theory", format=".4~g")]  # fmt: skip
DECADES = 100  # a ratio of values from which on axes are logarithmic, if no value is 0


def cards(task, numbers, width="container"):
    by_field = {}
    for row, field, is_, should, slack in told(task):
        by_field.setdefault(field, []).append({"is": is_, "should": should, "low": max(should - slack, 0), "high": should + slack,
            "label": row.method, "case": ", ".join(t for t in (row.dataset, row.query_set) if t),
            "knobs": "; ".join(t for t in (knob_text(row.build_knobs), knob_text(row.query_knobs)) if t) or "–"})  # fmt: skip
    figures, words = [], []
    for field in [f for f in NAMES if f in by_field] + [f for f in by_field if f not in NAMES]:
        name, what = NAMES.get(field, (field, field))
        words.append(f"{name}: {what}.")
        title = f"{name} ({len(by_field[field])} rows)"
        figures.append(Figure(f"{task.name}-theory-{field}", title, "", _chart(by_field[field], width)))
    card = Card(f"{task.name}-card-theory", "What theory says", CAPTION.format(words=" ".join(words)), figures)
    return [card] if figures else []


def told(task):
    """[(row, field, what it is, what it should be, by how much it may be off)] of the rows that theory says something of."""
    found = []
    for r in task.rows:
        field, value = r.extra.get(f"{task.name}_figure"), r.extra.get(f"{task.name}_figure_value")
        if not field or value is None:
            continue
        is_ = r.extra[field] if field in r.extra else getattr(r, field, None)
        if is_ is not None:
            found.append((r, field, is_, value, r.extra.get(f"{task.name}_figure_slack") or 0))
    return found


def _chart(values, width):
    both = [v[k] for v in values for k in ("is", "should")]
    least, most = min(both), max(*both, *(v["high"] for v in values)) or 1
    if least > 0 and most > DECADES * least:
        scale = alt.Scale(type="log", domain=[0.7 * least, 1.4 * most], nice=False)
        ticks = {"format": ".0e", "tickCount": 5}
        least *= 0.7
    else:
        scale, ticks, least = alt.Scale(domain=[0, most], nice=True), {"tickCount": 5, "labelSeparation": 6}, 0
    base = alt.Chart(alt.Data(values=values))
    x = alt.X("should:Q", scale=scale, axis=alt.Axis(title="what theory says", gridOpacity=0.5, **ticks))
    y = alt.Y("is:Q", scale=scale, axis=alt.Axis(title="measured", gridOpacity=0.5, **ticks))
    same = alt.Chart(alt.Data(values=[{"should": v, "is": v} for v in (least, most)])).mark_line(
        color=INK, strokeDash=[3, 3], opacity=0.6).encode(x=x, y=y)  # fmt: skip
    bars = base.transform_filter("datum.high > datum.low").transform_calculate(low=f"max(datum.low, {least})").mark_rule(
        color=INK, opacity=0.4).encode(x=x, y=alt.Y("low:Q", scale=scale), y2=alt.Y2("high:Q"))  # fmt: skip
    dots = base.mark_point(filled=True, size=40, **DOTS).encode(x=x, y=y, tooltip=TOOLTIP)
    return alt.layer(same, bars, dots, width=width, height=220)
