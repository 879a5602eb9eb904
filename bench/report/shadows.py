"""What only the task shadow shows: how its methods stand against rays of a given number, and how wide they make a penumbra."""

from math import sqrt

from bench.report import charts, shadow_claims
from bench.report.palette import BLUE, INK, ORANGE, VERMILION
from bench.report.series import Card, Figure
from bench.report.units import several

alt = charts.alt

RAYS = 16  # samples a pixel that a player of today can afford
SOBOL_AT_16 = 0.30 * RAYS**-0.75  # RMS over a random edge's penumbra; measured, see the task's truth

BESIDE_RAYS = """Error over the pixels in penumbra against time, the best configurations of each method: what lies above the line
loses to {rays} rays a pixel, however fast it is. The solid line is {what}; the dashed one is a picture without any shadow. Errors
below {least:g} stand at it. Scenes whose light is hard have no penumbra and are
left out; the light's share there is all or nothing. A mark's tooltip names its knobs."""
MEASURED = "what our rays with scrambled Sobol points measured here ({rays} a pixel)"
EXPECTED = "what {rays} scrambled Sobol points leave on an edge that lies anywhere, {value:.3f}, as no method with rays is here"

WIDTH = """The width of a penumbra, from 10 to 90 % of the light, over the true one, on a straight edge: how wide each method makes
it. 1 is right; a hard shadow has none and stands at the left edge."""


NO_SHADOW = "unshadowed"  # takes no time, and would stretch an axis of times to where nothing else is
LEAST_ERROR = 1e-4  # a fortieth of a level of 256: what is below it nobody sees


def cards(task, numbers, width="container", legend=False):
    if task.name != "shadow":
        return []
    made = (_beside_rays(task, numbers, width, legend), _widths(task, numbers, width), _split(task, width))
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


def _beside_rays(task, numbers, width, legend):
    figures, methods, measured = [], set(), False
    for dataset in task.datasets:
        rows = [r for r in soft(task) if r.dataset == dataset and r.query_set == "image" and penumbra(r) and r.query_ns]
        if not rows:
            continue
        size = max(r.size for r in rows)
        rows = [r for r in rows if r.size == size]
        values = []
        for method in dict.fromkeys(r.method for r in rows if r.method != NO_SHADOW):
            for r in front([r for r in rows if r.method == method], penumbra):
                values.append({"i": numbers[id(r)], "method": method, "x": r.query_ns, "y": max(penumbra(r), LEAST_ERROR)})
        if not values:
            continue
        rays = [penumbra(r) for r in rows if is_rays(r)]
        measured = measured or bool(rays)
        line = min(rays) if rays else SOBOL_AT_16
        looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
        methods |= set(looks)
        none = next((penumbra(r) for r in rows if r.method == NO_SHADOW), None)
        title = f"{dataset}, {several(size, task.text.element)}"
        chart = _rays_chart(values, looks, line, none, width, legend)
        figures.append(Figure(f"{task.name}-rays-{dataset}", title, dataset, chart))
    what = MEASURED.format(rays=RAYS) if measured else EXPECTED.format(rays=RAYS, value=SOBOL_AT_16)
    caption = BESIDE_RAYS.format(rays=RAYS, what=what, least=LEAST_ERROR)
    return Card(f"{task.name}-card-rays", f"Beside {RAYS} rays a pixel", caption, figures, tuple(methods))


def _rays_chart(values, looks, line, none, width, legend):
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, padding=14),
              axis=charts._log_axis("x", charts.DURATION, "time per pixel, log"))  # fmt: skip
    scale = alt.Scale(type="log", nice=False, padding=10)
    y = alt.Y("y:Q", scale=scale, axis=alt.Axis(title="RMS error in penumbra, log", format=".0e", tickCount=6, gridOpacity=0.5))
    color, _ = charts._scales(looks)
    base = alt.Chart(alt.Data(values=values))
    lines = base.mark_line(strokeWidth=1.2, opacity=charts._pick("0.7")).encode(
        x=x, y=y, stroke=alt.Stroke("method:N", scale=color, legend=charts._key(legend)))  # fmt: skip
    dots = charts._points(base, looks, legend).encode(x=x, y=y)
    rules, labels = [], []
    for at, words, dash in ((line, f"{RAYS} rays", [1, 0]), (none, "no shadow", [4, 3])):
        if at:
            base = alt.Chart(alt.Data(values=[{"y": at, "text": f"{words}: {at:.2g}"}])).encode(y=alt.Y("y:Q", scale=scale))
            rules.append(base.mark_rule(color=INK, strokeWidth=1.4, strokeDash=dash))
            labels.append(base.mark_text(align="right", dy=-6, fontSize=10, fill=INK, x=alt.expr("width - 4")).encode(text=alt.Text("text:N")))
    return charts.layered(*rules, lines, dots, *labels, width=width, height=260)


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
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=charts.LANE_NAME))  # fmt: skip
    one = alt.Chart(alt.Data(values=[{"x": 1}])).mark_rule(color=INK, strokeDash=[3, 3], opacity=0.6).encode(
        x=alt.X("x:Q", scale=scale))  # fmt: skip
    dots = charts._points(alt.Chart(alt.Data(values=values)), looks, False).encode(x=x, y=y)
    return charts.layered(one, dots, width=width, height=alt.Step(15))


# ---- visibility taken out of the integral ------------------------------------------------------------------------------

SPLIT = """A shadow as a share of the light, times what the whole light would bring, is not what it does bring. By the surface's
roughness α (GGX, in its highlight, where the eye sees the middle of the light mirrored) and the radius of a disc light 5 m above a
ball's shadow: how far the share of the light's area is from the share of what reaches the eye, over the image. The dashed line is a quarter of one
of 256 levels of grey; what is above it can show. Errors below {least:g} stand there."""


def _split(task, width):
    values = []
    for radius, row in shadow_claims.split_rows(shadow_claims.Rows(task.rows)):
        for alpha in (None, *shadow_claims.SPLIT_ALPHAS):
            error = shadow_claims.field(row, shadow_claims.split_field(alpha))
            if error is not None:
                values.append({"surface": f"α = {alpha:g}" if alpha else "diffuse", "radius": f"radius {radius} m",
                               "y": max(error, LEAST_SPLIT), "told": f"{error:.2g}"})  # fmt: skip
    figures = [Figure(f"{task.name}-split", "sphere_over_floor", "sphere_over_floor", _split_chart(values, width))] if values else []
    return Card(f"{task.name}-card-split", "Visibility taken out of the integral", SPLIT.format(least=LEAST_SPLIT), figures)


LEAST_SPLIT = 1e-5


def _split_chart(values, width):
    radii = list(dict.fromkeys(v["radius"] for v in values))
    surfaces = list(dict.fromkeys(v["surface"] for v in values))
    color = alt.Color("radius:N", scale=alt.Scale(domain=radii, range=[BLUE, ORANGE, VERMILION][: len(radii)]), legend=None)
    x = alt.X("surface:O", sort=surfaces, axis=alt.Axis(title="surface, from rough to smooth", labelAngle=0, grid=False))
    scale = alt.Scale(type="log", nice=False, padding=10)
    y = alt.Y("y:Q", scale=scale, axis=alt.Axis(title="RMS error, share of the light, log", format=".0e", tickCount=6, gridOpacity=0.5))
    base = alt.Chart(alt.Data(values=values)).encode(x=x, y=y, color=color)
    names = base.transform_filter(alt.datum.surface == surfaces[-1]).mark_text(align="right", dx=6, dy=-10, fontSize=10).encode(text="radius:N")
    seen = alt.Chart(alt.Data(values=[{"y": shadow_claims.UNSEEN}])).mark_rule(color=INK, strokeDash=[4, 3], opacity=0.6)
    dots = base.mark_point(filled=True, size=50).encode(
        tooltip=[alt.Tooltip("radius:N", title="disc"), alt.Tooltip("surface:N"), alt.Tooltip("told:N", title="error")])  # fmt: skip
    return charts.layered(seen.encode(y=alt.Y("y:Q", scale=scale)), base.mark_line(strokeWidth=1.4), dots, names, width=width, height=240)


def rms(values):
    return sqrt(sum(v * v for v in values) / len(values)) if values else None
