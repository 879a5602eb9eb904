"""What only the task shadow shows: how its methods stand against rays of a given number, how the error falls with a knob,
and what theory says of scenes that were made to break a method."""

from math import sqrt

from bench.report import charts
from bench.report.palette import INK
from bench.report.rows import knob_text
from bench.report.series import Card, Figure
from bench.report.units import several

alt = charts.alt

RAYS = 16  # samples a pixel that a player of today can afford
SOBOL_AT_16 = 0.30 * RAYS**-0.75  # RMS over a random edge's penumbra; measured, see the task's truth

BESIDE_RAYS = """Error over the pixels in penumbra against time, the best configurations of each method: what lies above the line
loses to {rays} rays a pixel, however fast it is. The solid line is {what}. Scenes whose light is hard have no penumbra and are
left out; the light's share there is all or nothing. A mark's tooltip names its knobs."""
MEASURED = "what our rays with scrambled Sobol points measured here ({rays} a pixel)"
EXPECTED = "what {rays} scrambled Sobol points leave on an edge that lies anywhere, {value:.3f}, as no method with rays is here"

WIDTH = """The width of a penumbra, from 10 to 90 % of the light, over the true one, on a straight edge: how wide each method makes
it. 1 is right; a hard shadow has none and stands at the left edge."""

FIGURES = """Scenes made so that theory says what a method gets wrong, or how wide it makes a penumbra: what its row says against
what it should. On the line they agree; what is off it is a mistake of ours or of the theory. A mark's tooltip names its scene
and knobs. {words}"""
NAMES = {
    "shadow_false_dark": ("False shadow", "share of a tilted plane that shadows itself under too little bias"),
    "shadow_gap": ("Gap", "length of shadow that a bias takes from a wall's foot, metres"),
    "shadow_max": ("Leak", "most light that passes stacked blockers through two or four moments"),
    "shadow_width": ("Penumbra", "its width, from 10 to 90 % of the light, under a filter of a given size, metres"),
    "shadow_levels": ("Levels", "different answers that a filter of so many taps has"),
    "shadow_wrong": ("Off by one", "share of the picture that counts from inside a shadow get wrong"),
}


def cards(task, numbers, width="container"):
    if task.name != "shadow":
        return []
    made = (_beside_rays(task, numbers, width), _widths(task, numbers, width), _figures(task, width))
    return [card for card in made if card.figures]


def soft(task):
    """Of the first run and thread count, that have an error."""
    run, threads = (task.runs or [0])[0], (task.threads or [None])[0]
    return [r for r in task.soft if r.run == run and r.threads == threads and r.status == "ok" and r.error is not None]


def is_rays(row):
    """Our rays, with their best points."""
    return row.method == "area_rays" and row.query_knobs == {"rays": RAYS}


def front(rows, error):
    """Those that no other of the same method beats in both time and error."""
    kept = []
    for row in sorted(rows, key=lambda r: (r.query_ns, error(r))):
        if not kept or error(row) < error(kept[-1]):
            kept.append(row)
    return kept


def penumbra(row):
    return row.extra.get("shadow_penumbra")


def _beside_rays(task, numbers, width):
    figures, methods, measured = [], set(), False
    for dataset in task.datasets:
        rows = [r for r in soft(task) if r.dataset == dataset and r.query_set == "image" and penumbra(r) and r.query_ns]
        if not rows:
            continue
        size = max(r.size for r in rows)
        rows = [r for r in rows if r.size == size]
        values = []
        for method in dict.fromkeys(r.method for r in rows):
            for r in front([r for r in rows if r.method == method], penumbra):
                values.append({"i": numbers[id(r)], "method": method, "x": r.query_ns, "y": penumbra(r)})
        rays = [penumbra(r) for r in rows if is_rays(r)]
        measured = measured or bool(rays)
        line = min(rays) if rays else SOBOL_AT_16
        looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
        methods |= set(looks)
        title = f"{dataset}, {several(size, task.text.element)}"
        figures.append(Figure(f"{task.name}-rays-{dataset}", title, dataset, _rays_chart(values, looks, line, width)))
    what = MEASURED.format(rays=RAYS) if measured else EXPECTED.format(rays=RAYS, value=SOBOL_AT_16)
    caption = BESIDE_RAYS.format(rays=RAYS, what=what)
    return Card(f"{task.name}-card-rays", f"Beside {RAYS} rays a pixel", caption, figures, tuple(methods))


def _rays_chart(values, looks, line, width):
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, padding=14),
              axis=charts._log_axis("x", charts.DURATION, "time per pixel, log"))  # fmt: skip
    scale = alt.Scale(type="log", nice=False, padding=10)
    y = alt.Y("y:Q", scale=scale, axis=alt.Axis(title="RMS error in penumbra, log", format=".0e", tickCount=6, gridOpacity=0.5))
    color, _ = charts._scales(looks)
    base = alt.Chart(alt.Data(values=values))
    lines = base.mark_line(strokeWidth=1.2, opacity=charts._pick("0.7")).encode(
        x=x, y=y, stroke=alt.Stroke("method:N", scale=color, legend=None))  # fmt: skip
    dots = charts._points(base, looks, False).encode(x=x, y=y)
    at = alt.Chart(alt.Data(values=[{"y": line, "text": f"{RAYS} rays: {line:.2g}"}]))
    rule = at.mark_rule(color=INK, strokeWidth=1.4).encode(y=alt.Y("y:Q", scale=scale))
    label = at.mark_text(align="right", dy=-6, fontSize=10, fill=INK, x=alt.expr("width - 4")).encode(
        y=alt.Y("y:Q", scale=scale), text="text:N")  # fmt: skip
    return alt.layer(rule, lines, dots, label).add_params(charts._pick_param()).properties(width=width, height=260)


# ---- widths ----------------------------------------------------------------------------------------------------------

LEAST_WIDTH = 0.02


def width_ratio(row):
    told, true = row.extra.get("shadow_width"), row.extra.get("shadow_width_true")
    return None if told is None or not true else told / true


def _widths(task, numbers, width):
    figures = []
    for dataset in task.datasets:
        rows = [r for r in soft(task) if r.dataset == dataset and r.query_set == "edge" and width_ratio(r) is not None]
        if not rows:
            continue
        values = [{"i": numbers[id(r)], "method": r.method, "x": max(width_ratio(r), LEAST_WIDTH)} for r in rows]
        looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
        figures.append(Figure(f"{task.name}-width-{dataset}", dataset, dataset, _width_chart(values, looks, width)))
    return Card(f"{task.name}-card-width", "Penumbra width", WIDTH, figures)


def _width_chart(values, looks, width):
    methods = list(looks)
    scale = alt.Scale(type="log", nice=False, padding=12)
    x = alt.X("x:Q", scale=scale, axis=alt.Axis(title="width over the true one, log", values=[0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5],
                                                format="~g", gridOpacity=0.5))  # fmt: skip
    y = alt.Y("method:N", sort=methods, scale=alt.Scale(domain=methods),
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=120))  # fmt: skip
    one = alt.Chart(alt.Data(values=[{"x": 1}])).mark_rule(color=INK, strokeDash=[3, 3], opacity=0.6).encode(
        x=alt.X("x:Q", scale=scale))  # fmt: skip
    dots = charts._points(alt.Chart(alt.Data(values=values)), looks, False).encode(x=x, y=y)
    return alt.layer(one, dots).add_params(charts._pick_param()).properties(width=width, height=alt.Step(15))


# ---- figures of theory -----------------------------------------------------------------------------------------------


def told(rows):
    """[(row, field, what it is, what it should be)] of the rows that theory says something of."""
    found = []
    for r in rows:
        field, value = r.extra.get("shadow_figure"), r.extra.get("shadow_figure_value")
        if field and value is not None and r.extra.get(field) is not None:
            found.append((r, field, r.extra[field], value))
    return found


def _figures(task, width):
    by_field = {}
    for row, field, is_, should in told(task.rows):
        by_field.setdefault(field, []).append({"is": is_, "should": should, "label": ", ".join(
            (row.dataset, row.method, knob_text(row.build_knobs), knob_text(row.query_knobs)))})  # fmt: skip
    figures, words = [], []
    for field in [f for f in NAMES if f in by_field] + [f for f in by_field if f not in NAMES]:
        name, what = NAMES.get(field, (field, field))
        words.append(f"{name}: {what}.")
        title = f"{name} ({len(by_field[field])} rows)"
        figures.append(Figure(f"{task.name}-theory-{field}", title, "", _theory_chart(by_field[field], width)))
    return Card(f"{task.name}-card-theory", "What theory says", FIGURES.format(words=" ".join(words)), figures)


def _theory_chart(values, width):
    most = max(max(v["is"], v["should"]) for v in values) or 1
    scale = alt.Scale(domain=[0, most], nice=True)
    base = alt.Chart(alt.Data(values=values))
    x = alt.X("should:Q", scale=scale, axis=alt.Axis(title="what theory says", gridOpacity=0.5))
    y = alt.Y("is:Q", scale=scale, axis=alt.Axis(title="measured", gridOpacity=0.5))
    same = alt.Chart(alt.Data(values=[{"should": 0, "is": 0}, {"should": most, "is": most}])).mark_line(
        color=INK, strokeDash=[3, 3], opacity=0.6).encode(x=x, y=y)  # fmt: skip
    dots = base.mark_point(filled=True, size=40, opacity=0.7, color="#0072B2").encode(x=x, y=y, tooltip=alt.Tooltip("label:N"))
    return alt.layer(same, dots).properties(width=width, height=220)


def rms(values):
    return sqrt(sum(v * v for v in values) / len(values)) if values else None
