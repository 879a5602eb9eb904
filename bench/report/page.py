"""Puts the page together: one HTML file that needs nothing beside it."""

import json
from pathlib import Path

import vl_convert
from jinja2 import Environment

from bench.report import busy, charts, closest, inside, ledger, model, pieces, rays, series, shadows, surfaces, theory, told, transport
from bench.report.pieces import esc
from bench.report.units import count

PARTS = Path(__file__).parent / "page"
SCRIPTS = ("data.js", "charts.js", "advice.js", "page.js")
CARD = {"frontier": "Error against time", "build": "Build time", "bytes": "Memory", "scaling": "Time against size"}


def build(rows, pictures, title="Treeline: speed against accuracy"):
    """The whole page as text."""
    models = model.task_models(rows)
    data, sections, nav = {"tasks": {}, "charts": []}, [], []
    numbers = model.numbers(models)
    for task in models:
        cards = [*series.cards(task, numbers), *inside.cards(task, numbers), *closest.cards(task, numbers),
                 *shadows.cards(task, numbers), *surfaces.cards(task, numbers),
                 *transport.cards(task, numbers), *theory.cards(task, numbers)]
        listed = list(model.chart_list(task))
        for name, kind, dataset, chart in listed:
            entry = {"id": name, "kind": kind, "task": task.name, "dataset": dataset, "spec": charts.spec(chart)}
            if kind == "frontier":
                entry["lanes"], entry["middle"] = task.layouts[dataset].lanes, task.layouts[dataset].middle
            data["charts"].append(entry)
        for figure in (f for card in cards for f in card.figures):
            data["charts"].append({"id": figure.name, "kind": "fixed", "task": task.name, "dataset": figure.dataset,
                                   "title": figure.title, "spec": charts.spec(figure.chart)})  # fmt: skip
        fixed = list(rays.chart_list(task))
        for name, heading, _, chart in fixed:
            data["charts"].append({"id": name, "kind": "fixed", "task": task.name, "dataset": "", "title": heading,
                                   "spec": charts.spec(chart)})  # fmt: skip
        data["tasks"][task.name] = {"element": task.text.element, "queryWord": task.text.query,
                                    "error": task.text.error, "errors": dict(task.text.errors),
                                    "runs": task.runs or [0], "threads": task.threads or [None]}  # fmt: skip
        mine = [p for p in pictures if p.task == task.name]
        sections.append(_section(task, rows, listed, fixed, mine, cards))
        nav.append(_nav(task, mine, cards))
    sections.append(ledger.section(rows))
    nav.append('<a class="task" href="#claims">Claims</a>')
    others = [p for p in pictures if p.task not in data["tasks"]]
    if others:
        sections.append(f'<section id="pictures"><h2>Pictures</h2>{pieces.gallery(others)}</section>')
        nav.append('<a class="task" href="#pictures">Pictures</a>')
    data["table"] = model.table(models)
    return Environment(autoescape=False).from_string(_part("page.html")).render(
        title=esc(title), css=_part("page.css"), errors_js=_part("errors.js"), nav="".join(nav),
        head=_head(rows), body="".join(sections), model=_json(data), bundle=_safe(vl_convert.javascript_bundle()),
        js=_safe("\n".join(_part(s) for s in SCRIPTS)))  # fmt: skip


def _part(name):
    return (PARTS / name).read_text()


def _json(value):
    """JSON that may stand inside a script element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def _safe(script):
    return script.replace("</script", "<\\/script")


def _nav(task, pictures, cards):
    name = task.name
    links = [f'<a class="task" href="#{name}">{esc(task.text.title)}</a>']
    if any(pieces.winners_table(task, r) for r in task.runs):
        links.append(f'<a href="#{name}-winners">Winners</a>')
    links += [f'<a href="#{card.name}">{esc(card.title)}</a>' for card in cards]
    if task.datasets:
        links.append(f'<a href="#{name}-charts">Charts</a>')
        links += [f'<a class="sub" href="#{name}-{k}">{esc(d)}</a>' for k, d in enumerate(task.datasets)]
        links.append(f'<a href="#{name}-advice">Advice</a>')
    if any(r.hard for r in task.rows):
        links.append(f'<a href="#{name}-stability">Stability</a>')
    if rays.hard_lines(task)[1]:
        links.append(f'<a href="#{name}-figures">Hard cases in figures</a>')
    if rays.moving_pairs(task):
        links.append(f'<a href="#{name}-frames">Moving vertices</a>')
    if pictures:
        links.append(f'<a href="#{name}-pictures">Pictures</a>')
    return "".join(links)


def _head(rows):
    """What was measured, on what, and with whose versions."""
    tasks = list(dict.fromkeys(r.task for r in rows))
    cells, of = "cell" if len(rows) == 1 else "cells", "task" if len(tasks) == 1 else "tasks"
    parts = [f"<p>{len(rows):,} {cells} of the {of} {esc(', '.join(tasks))}.</p>"]
    lines = []
    for k, run in enumerate(rows.runs):
        mine = [r for r in rows if r.run == k]
        times = sorted(t for r in mine if (t := r.values.get("time")))
        span = f"{times[0]} to {times[-1]}" if times else "time not recorded"
        cells = (
            run["cpu"],
            run["host"],
            run["isa"],
            run["compiler"],
            run["commit"],
            run["seed"],
            span,
            f"{len(mine):,}",
        )
        lines.append("<tr>" + "".join(f"<td>{esc(str(c if c is not None else '–'))}</td>" for c in cells) + "</tr>")
    heads = ("CPU", "machine", "ISA", "compiler", "commit", "seed", "measured", "rows")
    parts.append('<div class="scroll"><table class="plain"><thead><tr>' + "".join(f"<th>{h}</th>" for h in heads)
                 + f'</tr></thead><tbody>{"".join(lines)}</tbody></table></div>')  # fmt: skip
    versions = {(r.method, r.peer_version) for r in rows if r.source == "peer" and r.peer_version}
    if versions:
        parts.append("<p><b>Peers:</b> " + esc(", ".join(f"{m} {v}" for m, v in sorted(versions))) + ".</p>")
    parts.append(_busy(rows))
    if flags := sorted({r.flags for r in rows if r.flags}):
        parts.append("<p><b>Flags of our programs:</b> " + " | ".join(f"<code>{esc(f)}</code>" for f in flags) + "</p>")
    if rows.warnings:
        items = "".join(f"<li>{esc(w)}</li>" for w in rows.warnings[:20])
        more = f"<li>and {len(rows.warnings) - 20} more</li>" if len(rows.warnings) > 20 else ""
        parts.append(f'<details class="warning"><summary>{len(rows.warnings)} warnings about the rows</summary><ul>'
                     f"{items}{more}</ul></details>")  # fmt: skip
    parts.append(READING)
    return "".join(parts)


READING = """<details><summary>How to read a chart</summary><ul>
<li>Left is faster, down is more accurate; both axes are logarithmic. One mark is one configuration of one method;
◂ one that does nothing, and is faster still than where it stands.
The line is the <b>frontier</b>: no other configuration is both faster and more accurate. Marks off the frontier are
dim.</li>
<li>Answers without any error beyond the rounding of single precision (6e-8 for rays, 3e-7 for distances: the
floor in the table of figures) stand in the <b>exact</b> band below, a lane for each method. Where one configuration beats
all others in both, the frontier is a single mark and there is nothing to trade. A method that stands there though its
claim allows for errors had none <i>on this sample</i>; it never beats one that promises none.
Configurations that broke stand on a rail of their own on top; one that never got to a time stands at its right
end. What was timed alone, as builds are, has no error: its rail is below those.</li>
<li>Claims: <b>exact</b> methods err by rounding only; <b>bounded</b> ones within a stated bound,
that of rounding or, where a knob is called epsilon or resolution, one of their own; <b>approximate</b>
ones promise nothing, and their errors are shown without being called wrong.</li>
<li>A mark's horizontal line is the interval of the repetitions, the mark their median. Where two intervals overlap, do
not call a winner.</li>
<li>Point at a mark for its knobs and all its figures; point at a method in the legend to see it alone. Ours are filled,
peers hollow; colour and shape both tell the method.</li>
<li>Times are compared within one run on one machine only.</li></ul></details>"""


def _meaning(name, text):
    """What the query sets ask, what the error is, and what names of methods leave open."""
    if not text.meaning:
        return ""
    sets, methods = text.query_sets + told.QUERY_SETS.get(name, ()), text.methods + told.METHODS.get(name, ())
    parts = [f"<details><summary>What is asked, and what the error means</summary>{_listed(sets)}"
             f"<p>{esc(text.meaning)}{' Charted is the mean over queries.' if text.mean else ''}</p></details>"]  # fmt: skip
    if methods:
        parts.append(f"<details><summary>What the methods do</summary>{_listed(methods)}</details>")
    return "".join(parts)


def _listed(pairs):
    """(name, what it means)"""
    return "<dl>" + "".join(f"<dt><code>{esc(name)}</code></dt><dd>{esc(what)}</dd>" for name, what in pairs) + "</dl>"


def _busy(rows):
    """A warning where the machine had other work while it measured."""
    words = busy.warning(rows)
    return f'<p class="note warning"><b>The machine was busy:</b> {esc(words)}</p>' if words else ""


def _section(task, rows, listed, fixed, pictures, cards):
    name, text = task.name, task.text
    blocks = [
        f'<section id="{name}"><h2>{esc(text.title)}</h2>',
        f"<p>{esc(text.question)}</p>" if text.question else "",
        _meaning(name, text),
    ]
    tables = "".join((f"<h4>{esc(_run_name(rows, r))}</h4>" if len(task.runs) > 1 else "") + pieces.winners_table(task, r)
                     for r in task.runs)  # fmt: skip
    if tables:
        blocks.append(f'<h3 id="{name}-winners">Winners</h3>{tables}')
    blocks += [pieces.figures(task, card) for card in cards]
    if task.datasets:
        blocks.append(_toolbar(task, rows))
        by_dataset = {d: [(n, k) for n, k, of, _ in listed if of == d] for d in task.datasets}
        blocks += [_card(task, k, d, by_dataset[d]) for k, d in enumerate(task.datasets)]
        blocks.append(f'<h3 id="{name}-advice">Advice: the least that meets a tolerance</h3><p class="note">The cheapest '
                      "configuration whose every stated error is within the tolerance, at the size, run and threads "
                      "chosen above; and the rung below it with the first limit that it breaks. The slider moves with "
                      f"the arrow keys, too.</p>{pieces.advice(task)}")  # fmt: skip
    if matrix := pieces.matrix_table(task):
        blocks.append(f'<h3 id="{name}-stability">Stability: the hard cases</h3>{matrix}')
    if figures := rays.hard_table(task):
        blocks.append(f'<h3 id="{name}-figures">Hard cases in figures</h3>{figures}')
    boxes = {chart: f'<div class="fixed-charts"><div class="chart fixed"><h4>{esc(title)}</h4>'
             f'<div id="{chart}" class="plot"></div><p class="note">{esc(note)}</p></div></div>'
             for chart, title, note, _ in fixed}  # fmt: skip
    blocks.append(boxes.get(f"{name}-offset", ""))
    if moving := rays.moving_table(task):
        chart = boxes.get(f"{name}-moving", "")
        blocks.append(f'<h3 id="{name}-frames">Moving vertices: refit or rebuild?</h3>{chart}{moving}')
    if pictures:
        blocks.append(f'<h3 id="{name}-pictures">Pictures</h3>{pieces.gallery(pictures)}')
    return "".join(blocks) + "</section>"


def _run_name(rows, k):
    run = rows.runs[k]
    varying = [f for f, v in run.items() if any(other[f] != v for other in rows.runs)]
    return ", ".join(f"{f} {run[f]}" for f in varying) or f"run {k + 1}"


def _toolbar(task, rows):
    sets = [pieces.option(s, s, s == task.telling_set) for s in task.query_sets]
    sizes = [pieces.option("largest", "largest")] + [pieces.option(s, count(s)) for s in task.sizes]
    runs = [pieces.option(r, _run_name(rows, r)) for r in task.runs]
    threads = [pieces.option(t, t) for t in task.threads]
    name = task.name
    return (f'<h3 id="{name}-charts">Charts</h3><div class="toolbar"><div class="choices" data-task="{name}">'
            + pieces.select(name, "set", "Query set", sets)
            + (pieces.select(name, "size", "Size", sizes) if len(task.sizes) > 1 else "")
            + (pieces.select(name, "run", "Run", runs) if len(runs) > 1 else "")
            + (pieces.select(name, "threads", "Threads", threads) if len(threads) > 1 else "")
            + f"</div>{pieces.legend(task)}</div>")  # fmt: skip


MANY = 12  # lanes, from which on the charts of builds are higher than that beside them


def _card(task, k, dataset, listed):
    boxes = "".join(f'<div class="chart {kind}"><h4>{CARD[kind]}</h4><div id="{name}" class="plot"></div></div>'
                    for name, kind in listed)  # fmt: skip
    what, many = told.dataset(dataset), " many" if len(task.methods(dataset, "build_s")) > MANY else ""
    return (f'<article class="card" id="{task.name}-{k}" data-task="{task.name}" data-dataset="{esc(dataset)}">'
            f'<h3>{esc(dataset)} <small class="size"></small>{f" <small>({esc(what)})</small>" if what else ""}</h3><div class="grid{many}">{boxes}</div>'
            f'{pieces.rungs(task, dataset)}<p class="absent"></p><details class="all"><summary>Table of all figures</summary>'
            '<div class="scroll figures"></div>'
            "</details></article>")  # fmt: skip
