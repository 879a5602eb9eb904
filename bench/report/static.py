"""Each main chart as SVG and PNG, on white and with its own legend, for papers and the README."""

import json
import re
from pathlib import Path

import altair as alt
import vl_convert

from bench.report import charts, closest, inside, rays, series, shadows, stability, surfaces, theory, transport
from bench.report.layout import lane_notes
from bench.report.model import build_title, bytes_title, points
from bench.report.units import count, several

COLORS = {
    "crashed": "#8c8c8c", "timeout": "#E69F00", "out_of_memory": "#CC79A7", "wrong": "#D55E00", "refused": "#56B4E9",
    "inexact": "#F0E442", "ok": "#9fd8c5", "unsupported": "#e8e8e8", "not_built": "#f4f4f4",
}  # fmt: skip


def save_all(models, folder):
    """Writes them; returns their number."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    saved = 0
    for task in models:
        for name, chart in _charts(task):
            _save(chart, folder / name)
            saved += 1
    return saved


def _charts(task):
    run, threads = task.runs[0] if task.runs else 0, task.threads[0] if task.threads else None
    for dataset in task.datasets:
        rows = [r for r in task.of(dataset) if r.run == run and r.threads == threads]
        size = max((r.size for r in rows), default=0)
        for query_set in task.query_sets:
            here = [r for r in rows if r.query_set == query_set]
            shown = [r for r in here if r.size == size and task.layouts[dataset].y(r) is not None]
            title = f"{dataset}, {several(size, task.text.element)}, {query_set}"
            name = _file_name(task.name, dataset, query_set)
            if shown:
                notes = [{"axis": task.text.error_of(query_set), "y": task.layouts[dataset].middle},
                         *lane_notes(task.layouts[dataset], [r for r in here if r.size == size])]  # fmt: skip
                chart = charts.frontier_chart(_data(task, shown, notes), task.layouts[dataset], _used(task, shown),
                                              task.text.query, True, 460)  # fmt: skip
                yield f"{name}-frontier", chart.properties(title=title)
            best = [(r, p) for r, p in zip(here, points(task, here)) if p["best"]]
            if len({r.size for r, _ in best}) > 1:
                looks = _used(task, [r for r, _ in best])
                chart = charts.scaling_chart(alt.Data(values=[p for _, p in best]), looks, task.text.element,
                                             task.text.query, True, 460, 300)  # fmt: skip
                yield f"{name}-scaling", chart.properties(title=f"{dataset}, {query_set}")
        at_size = [r for r in rows if r.size == size]
        for field, figure, label in (("build", "build_s", build_title(task)),
                                     ("bytes", "bytes", bytes_title(task))):
            if methods := [
                m for m in task.looks if any(r.method == m and getattr(r, figure) is not None for r in at_size)
            ]:
                chart = charts.lanes_chart(_data(task, at_size), field, label, methods, task.looks, False, 460)
                yield f"{_file_name(task.name, dataset, field)}", chart.properties(title=f"{dataset}, {count(size)}")
    numbers = {id(r): i for i, r in enumerate((*task.soft, *task.scaling))}
    for card in (*series.cards(task, numbers, 460, True), *inside.cards(task, numbers, 460), *closest.cards(task, numbers, 460),
                 *shadows.cards(task, numbers, 460, True), *surfaces.cards(task, numbers, 460),
                 *transport.cards(task, numbers, 460), *theory.cards(task, numbers, 460)):
        for figure in card.figures:
            yield _file_name(figure.name), figure.chart.properties(title=figure.title)
    cases, columns, cells = stability.matrix(task.rows, task.looks)
    if cases:
        yield f"{task.name}-stability", _matrix(task, cases, columns, cells)
    for name, title, _, chart in rays.chart_list(task):
        yield name, chart.properties(title=title, width=460)


def _data(task, rows, more=()):
    return alt.Data(values=[*points(task, rows), *more])


def _used(task, rows):
    names = {r.method for r in rows}
    return {m: look for m, look in task.looks.items() if m in names}


def _matrix(task, cases, columns, cells):
    values = [{"case": c, "method": column.label, "status": cell.status, "letter": cell.letter}
              for (c, column), cell in cells.items()]
    base = alt.Chart(alt.Data(values=values)).encode(
        x=alt.X("method:N", sort=[c.label for c in columns],
                axis=alt.Axis(title=None, orient="top", labelAngle=-45, labelLimit=300)),
        y=alt.Y("case:N", sort=cases, axis=alt.Axis(title=None, labelLimit=260)))  # fmt: skip
    color = alt.Color("status:N", scale=alt.Scale(domain=list(COLORS), range=list(COLORS.values())))
    chart = alt.layer(base.mark_rect(stroke="white").encode(color=color),
                      base.mark_text(fontSize=11, color="#111").encode(text=alt.Text("letter:N")))  # fmt: skip
    return chart.properties(width=alt.Step(26), height=alt.Step(17), title=f"{task.name}: hard cases")


def _file_name(*parts):
    return re.sub(r"[^A-Za-z0-9._-]+", "_", "-".join(parts))


def _save(chart, path):
    spec = json.dumps(charts.spec(chart, "white", "sans-serif"), sort_keys=True)
    svg = vl_convert.vegalite_to_svg(spec.replace(charts.INK, "#222").replace(charts.PAPER, "white"))
    path.with_name(path.name + ".svg").write_text(svg)
    path.with_name(path.name + ".png").write_bytes(vl_convert.svg_to_png(svg, scale=2))
