"""The charts, as Altair draws them. Each is built once and used twice: in the page, which feeds it rows by name, and
as static SVG and PNG, which carry their own.

A point's fields: i (row), method, x, lo, hi (ns per query), y (pixel, from layout.py), front, promise (its claim holds
for other queries, too), slot, n, note (why a lane without any is empty), axis (of a point that is none, but says what the
error is), build (ns per element), bytes and own (per
element: with the input that must stay, and without).

Channels are objects throughout, alt.Text("name:N") and not text="name:N": Altair would look each text up among all classes
of Vega-Lite.
"""

from math import log10

import altair as alt
from altair.utils import schemapi

DURATION = (
    "datum.value >= 1e9 ? format(datum.value / 1e9, '~g') + ' s' : "
    "datum.value >= 1e6 ? format(datum.value / 1e6, '~g') + ' ms' : "
    "datum.value >= 1e3 ? format(datum.value / 1e3, '~g') + ' µs' : format(datum.value, '~g') + ' ns'"
)

WHOLE = "format(datum.value, datum.value < 1 ? '~g' : '~s')"  # of what has no thousandths by name, as bytes

# Logarithmic ticks come at every digit and between. Labels stand at round ones, as many as the pixels of a decade have room
# for: at every third power of ten, every second, at all of them, at 1, 2 and 5, and so on; where an axis spans so little
# that none may be round, at few ticks that are all labelled. (Vega's ways to drop labels that overlap or reach over the
# edge count empty ones, too, and drop every other.)
DIGITS = ((110, "['1.00']"), (150, "['1.00', '3.00']"), (300, "['1.00', '2.00', '5.00']"), (480, "['1.00', '2.00', '3.00', '5.00', '7.00']"),
          (None, "['1.00', '1.50', '2.00', '3.00', '4.00', '5.00', '7.00']"))  # fmt: skip
NARROW = {"x": 1000, "y": 3000}  # pixels of a decade


def _decade(axis):
    """How many pixels a decade has, as an expression; a label is a quarter as high as wide."""
    length = "width" if axis == "x" else "(4 * height)"
    return f"({length} * LN10 / log(domain('{axis}')[1] / domain('{axis}')[0]))"


def _round(axis):
    decade = _decade(axis)
    digits = "".join(f"{decade} < {most} ? {which} : " if most else which for most, which in DIGITS)
    every = f"({decade} < 24 ? 3 : {decade} < 46 ? 2 : 1)"
    off = f"({decade} < 46 && round(log(datum.value) / LN10) % {every} != 0)"
    odd = f"{decade} < {NARROW[axis]} && ({off} || indexof({digits}, slice(format(datum.value, '.2e'), 0, 4)) < 0)"
    cut = " || scale('x', datum.value) > width - 10" if axis == "x" else ""  # it would reach over the edge
    return f"({odd}{cut}) ? '' : "


def _log_axis(axis, labels, title):
    few = f"ceil({'width / 60' if axis == 'x' else 'height / 20'})"
    return alt.Axis(labelExpr=_round(axis) + labels, title=title, gridOpacity=0.5, labelBound=False,
                    labelOverlap=alt.expr(f"{_decade(axis)} < {NARROW[axis]} ? false : 'greedy'"), labelSeparation=5,
                    tickCount=alt.expr(f"{_decade(axis)} < {NARROW[axis]} ? 30 : {few}"))  # fmt: skip


IDLE, NEARER = "unshadowed", 3  # does nothing in no time: it stands a third left of all others, not decades
LANE_NAME = 150  # pixels for a method's name beside its lane
DIM = 0.5
UNPROMISED = "exact on this sample alone"
AS_THE_TRUTH = "as right as the truth can tell"
LEAST = 0.1  # bytes per element, and ns of building: zero has no place on a logarithmic axis
ZONES = {"failed": "#D55E00", "exact": "#009E73"}
INK, FAINT, PAPER = "currentColor", "#8884", "var(--card)"


def _scales(looks):
    names = list(looks)
    color = alt.Scale(domain=names, range=[looks[m].color for m in names])
    shape = alt.Scale(domain=names, range=[looks[m].shape for m in names])
    return color, shape


def _fills(looks):
    """Peers are hollow; `transparent`, unlike no fill at all, can be pointed at."""
    return alt.Scale(domain=list(looks), range=[o.color if o.filled else "transparent" for o in looks.values()])


def _pick(shown):
    """Opacity of a mark: `shown`, unless the reader picked another method in the legend."""
    return alt.expr(f"pick == '' || datum.method == pick ? {shown} : 0.06")


def _key(legend):
    """The legend of a chart that stands alone; in the page one for all charts stands above them."""
    if not legend:
        return None
    return alt.Legend(title=None, symbolSize=60, symbolStrokeWidth=1.6, columns=1, labelLimit=220, offset=48,
                      symbolOpacity=1)  # fmt: skip


def _points(base, looks, legend, size=44, shown="1"):
    color, shape = _scales(looks)
    key = _key(legend)
    return base.mark_point(strokeWidth=1.6, size=size, opacity=_pick(shown)).encode(
        stroke=alt.Stroke("method:N", scale=color, legend=key),
        fill=alt.Fill("method:N", scale=_fills(looks), legend=key),
        shape=alt.Shape("method:N", scale=shape, legend=key),
        tooltip=alt.Tooltip("i:Q"),
    )  # fmt: skip


def _named(base, shown="1", **look):
    """Text on a ground of its own, so that marks and lines behind it do not cross it: two layers."""
    text = dict(align="left", fontSize=10) | look
    return (base.mark_text(**text, stroke=PAPER, strokeWidth=3, strokeJoin="round", fill=PAPER, opacity=_pick("0.8")),
            base.mark_text(**text, fill=INK, opacity=_pick(shown)))  # fmt: skip


def spread(values, at, height, apart=11):
    """Where labels at these values of a logarithmic axis stand, in their order: moved apart to so many pixels, as little as
    that takes (least squares). at: all that the axis shows besides; height: the axis', in pixels."""
    logs = [log10(v) for v in values]
    low, high = (pick(logs + [log10(v) for v in at]) for pick in (min, max))
    order = sorted(range(len(logs)), key=lambda k: logs[k])
    for _ in range(3):  # what is moved beyond the others lengthens the axis
        gap = apart / height * (high - low)
        pools = []  # [sum, number] of labels that touch; less its gaps a run of them has one place
        for n, k in enumerate(order):
            pools.append([logs[k] - n * gap, 1])
            while len(pools) > 1 and pools[-2][0] / pools[-2][1] > pools[-1][0] / pools[-1][1]:
                total, number = pools.pop()
                pools[-1] = [pools[-1][0] + total, pools[-1][1] + number]
        places = [total / number for total, number in pools for _ in range(number)]
        places = [place + n * gap for n, place in enumerate(places)]
        low, high = min(low, *places), max(high, *places)
    out = [0.0] * len(logs)
    for k, place in zip(order, places):
        out[k] = 10**place
    return out


def _pick_param():
    return alt.param(name="pick", value="")


def layered(*layers, **properties):
    """These layers in one chart that knows the reader's pick. It is made at once: whatever is called on a chart copies all
    of its layers."""
    return alt.layer(*layers, params=[_pick_param().param], **properties)


def frontier_chart(data, layout, looks, element="query", legend=False, width="container"):
    """Error against time, with the band of exact answers below and the rails of failures above. What the error is, a
    point of the data tells: {axis, y}."""
    ticks = layout.ticks()
    labels = "({" + ",".join(f"'{y:g}':'{text}'" for y, text in ticks.items()) + "})['' + datum.value]"
    scale = alt.Scale(domain=[0, layout.height], reverse=True, nice=False, zero=False)
    axis = alt.Axis(values=list(ticks), labelExpr=labels, labelOverlap=False, labelLimit=LANE_NAME, title=None, ticks=False,
                    domain=False, gridOpacity=0.5)  # fmt: skip
    y = alt.Y("y:Q", scale=scale, axis=axis)
    x = alt.X("x:Q", scale=alt.Scale(type="log", nice=False, padding=48),
              axis=_log_axis("x", DURATION, f"time per {element}, log"))  # fmt: skip
    zones = [{"zone": name, "from": top, "to": end} for name, top, end in layout.zones()]
    base = alt.Chart(data)
    timed = base.transform_filter("isValid(datum.x)").transform_calculate(
        ns="datum.x", asked_ns=f"datum.method == '{IDLE}' ? null : datum.x").transform_joinaggregate(
        first="min(asked_ns)").transform_calculate(**{k: f"isValid(datum.first) ? max(datum.{k}, datum.first / {NEARER}) : datum.{k}"
                                                      for k in ("x", "lo", "hi")})  # fmt: skip
    color, _ = _scales(looks)
    layers = []
    for zone in zones:
        ground = alt.Chart(alt.Data(values=[zone | {"y": (zone["from"] + zone["to"]) / 2}]))
        if zone["zone"] == "failed":  # nothing failed where no mark stands on a rail, and then it must not look so
            ground = base.transform_filter(f"isValid(datum.y) && datum.y < {zone['to']}").transform_aggregate(
                n="count()").transform_filter("datum.n > 0").transform_calculate(
                **{"from": f"{zone['from']}", "to": f"{zone['to']}", "y": f"{(zone['from'] + zone['to']) / 2}", "zone": "'failed'"})
        layers.append(ground.mark_rect(opacity=0.10, color=ZONES[zone["zone"]]).encode(
            y=alt.Y("from:Q", scale=scale, axis=axis), y2=alt.Y2("to:Q")))  # fmt: skip
        layers.append(ground.mark_text(align="left", x=alt.expr("width + 5"), fontSize=10, fontStyle="italic",
                                       fill=INK).encode(y=y, text=alt.Text("zone:N")))  # fmt: skip
    layers += [
        timed.transform_filter("datum.front").mark_line(color=INK, strokeWidth=1.2, opacity=0.55,
                                                        interpolate="step-after")
        .encode(x=x, y=y, order=alt.Order("x:Q")),
        timed.mark_rule(strokeWidth=1.6, opacity=_pick(f"datum.front ? 0.9 : {DIM}"))
        .encode(x=alt.X("lo:Q"), x2=alt.X2("hi:Q"), y=y, stroke=alt.Stroke("method:N", scale=color, legend=_key(legend))),
        _points(timed, looks, legend, alt.expr("datum.front ? 80 : 40"), f"datum.front ? 1 : {DIM}").encode(x=x, y=y),
        _points(base.transform_filter("!isValid(datum.x) && isValid(datum.slot)"), looks, legend)
        .encode(x=alt.XValue(alt.expr("width - 7 - 13 * datum.slot")), y=y),
    ]  # fmt: skip
    told = DURATION.replace("datum.value", "datum.ns").replace("'~g'", "'.3~g'")
    front = timed.transform_filter("datum.front").transform_calculate(time=told)
    lane = front.transform_filter(f"datum.y >= {layout.exact_start}")
    layers += [layer.encode(x=x, y=y, text=alt.Text("time:N"))
               for layer in _named(lane.transform_filter("datum.promise"), dx=9, dy=-7, fontWeight="bold")]  # fmt: skip
    by_luck = lane.transform_filter("!datum.promise").transform_calculate(
        note=f"datum.time + ', ' + (datum.coarse ? '{AS_THE_TRUTH}' : '{UNPROMISED}')")
    layers += [layer.encode(x=x, y=y, text=alt.Text("note:N"))
               for layer in _named(by_luck, "0.85", dx=9, dy=-7, fontStyle="italic")]  # fmt: skip
    empty = base.transform_filter("isValid(datum.note)")
    # At the slow end: labels of the frontier stand at the fast one.
    layers.append(empty.mark_text(align="right", x=alt.expr("width - 6"), fontSize=9, fontStyle="italic", fill=INK, opacity=0.55)
                  .encode(y=y, text=alt.Text("note:N")))  # fmt: skip
    if layout.field:
        # A name reaches over that of the next mark, where it is near (in pixels): then it is left to the tooltip.
        inexact = front.transform_filter(f"datum.y < {layout.exact_start}").transform_window(
            sort=[alt.SortField("x")], next_x="lead(x)", next_y="lead(y)")
        inexact = inexact.transform_filter(
            "!isValid(datum.next_x) || datum.next_x > 6 * datum.x || abs(datum.next_y - datum.y) > 16")
        # One method in several places says by which knobs; fields, at which resolution.
        inexact = inexact.transform_joinaggregate(of="count()", groupby=["method"]).transform_calculate(
            name="(datum.ns < datum.x ? '◂ ' : '') + datum.method + (datum.cells ? ' at ' + datum.cells : datum.of > 1 && datum.asked ? ' (' + datum.asked + ')' : '')"
                 " + ', ' + datum.time")  # fmt: skip
        late = "scale('x', datum.x) + 5.3 * length(datum.name) > width + 10"  # it would reach over the edge
        look = dict(align=alt.expr(f"{late} ? 'right' : 'left'"), dx=alt.expr(f"{late} ? -8 : 8"), dy=-8)
        layers += [layer.encode(x=x, y=y, text=alt.Text("name:N")) for layer in _named(inexact, "0.85", **look)]
        title = base.transform_filter("isValid(datum.axis)")
        layers.append(title.mark_text(angle=270, fontSize=11, fill=INK, x=-56).encode(y=y, text=alt.Text("axis:N")))
    scales = alt.ScaleResolveMap(color="independent", stroke="shared", shape="shared")
    return layered(*layers, resolve=alt.Resolve(scale=scales), width=width, height=layout.height)


def lanes_chart(data, field, title, methods, looks, legend=False, width="container"):
    """One figure of a build, a lane for each method."""
    scale = alt.Scale(type="log", nice=False, padding=10)
    unit, rest = (" ns", f"({DURATION})") if field == "build" else ("", WHOLE)
    labels = f"datum.value <= {LEAST} ? '≤ {LEAST}{unit}' : {rest}"
    axis = _log_axis("x", labels, title)
    base = alt.Chart(data).transform_filter(f"isValid(datum.{field})")
    y = alt.Y("method:N", sort=list(methods), scale=alt.Scale(domain=list(methods)),
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=LANE_NAME))  # fmt: skip
    chart = _points(base, looks, legend).encode(x=alt.X(f"{field}:Q", scale=scale, axis=axis), y=y)
    if field == "bytes":  # from what the index allocates to all that it needs
        color, _ = _scales(looks)
        own = base.mark_rule(strokeWidth=1.6, opacity=_pick("0.8")).encode(
            x=alt.X("own:Q", scale=scale, axis=axis), x2=alt.X2("bytes:Q"), y=y,
            stroke=alt.Stroke("method:N", scale=color, legend=_key(legend)))  # fmt: skip
        return layered(own, chart, width=width, height=alt.Step(13))
    return chart.add_params(_pick_param()).properties(width=width, height=alt.Step(13))


def scaling_chart(data, looks, element, query, legend=False, width="container", height=240, along=None):
    """The best right configuration of each method against the size (or what `along` says n is), both logarithmic."""
    color, _ = _scales(looks)
    x = alt.X("n:Q", scale=alt.Scale(type="log", nice=False, padding=14),
              axis=_log_axis("x", "format(datum.value, '~s')", f"{along or element + 's'}, log"))  # fmt: skip
    y = alt.Y("x:Q", scale=alt.Scale(type="log", nice=False, padding=10),
              axis=_log_axis("y", DURATION, f"time per {query}, log"))  # fmt: skip
    base = alt.Chart(data)
    line = base.mark_line(strokeWidth=1.4, opacity=_pick("0.8")).encode(
        x=x, y=y, stroke=alt.Stroke("method:N", scale=color, legend=_key(legend)))  # fmt: skip
    rule = base.mark_rule(strokeWidth=1.4, opacity=_pick("0.8")).encode(
        x=x, y=alt.Y("lo:Q"), y2=alt.Y2("hi:Q"), stroke=alt.Stroke("method:N", scale=color, legend=_key(legend)))  # fmt: skip
    dots = _points(base, looks, legend).encode(x=x, y=y)
    return layered(line, rule, dots, width=width, height=height)


def speedup_chart(data, reach, methods, looks, legend=False, width="container"):
    """How many times faster several threads are than one: a lane a method, a mark a number of threads (at its end).
    reach: the largest figure that is drawn; its label has room beside it."""
    color, _ = _scales(looks)
    scale = alt.Scale(domain=[0, 1.35 * reach], nice=False)
    x = alt.X("speedup:Q", scale=scale,
              axis=alt.Axis(title="times one thread's speed", tickMinStep=1, gridOpacity=0.5))  # fmt: skip
    y = alt.Y("method:N", sort=list(methods), scale=alt.Scale(domain=list(methods)),
              axis=alt.Axis(title=None, ticks=False, domain=False, grid=True, gridOpacity=0.5, labelLimit=LANE_NAME))  # fmt: skip
    base = alt.Chart(data)
    one = alt.Chart(alt.Data(values=[{"at": 1}])).mark_rule(color=INK, strokeDash=[3, 3], opacity=0.6).encode(x=alt.X("at:Q"))
    spread = base.transform_filter("isValid(datum.lo)").mark_rule(strokeWidth=1.4, opacity=_pick("0.8")).encode(
        x=alt.X("lo:Q", scale=scale), x2=alt.X2("hi:Q"), y=y,
        stroke=alt.Stroke("method:N", scale=color, legend=_key(legend)))  # fmt: skip
    named = [layer.encode(x=alt.X("end:Q", scale=scale), y=y, text=alt.Text("label:N")) for layer in _named(base, "0.85", dx=8)]
    dots = _points(base, looks, legend).encode(x=x, y=y)
    return layered(one, spread, dots, *named, width=width, height=alt.Step(15))


def theme(chart, background="transparent", font="system-ui, sans-serif"):
    """Text and grid that read on light and dark alike. The chart itself is changed: each of its copies takes long."""
    chart.config = alt.Config(
        background=background, font=font,
        view=alt.ViewConfig(stroke=FAINT),
        axis=alt.AxisConfig(labelColor=INK, titleColor=INK, gridColor=FAINT, domainColor=FAINT, tickColor=FAINT,
                            labelFontSize=10, titleFontSize=11, titleFontWeight="normal"),
        legend=alt.LegendConfig(labelColor=INK, titleColor=INK),
        title=alt.TitleConfig(color=INK, anchor="start", fontSize=13))  # fmt: skip
    return chart


def spec(chart, *look):
    """The themed chart as Vega-Lite, validated unless Altair's debug mode is off."""
    return theme(chart, *look).to_dict(validate=schemapi.DEBUG_MODE)
