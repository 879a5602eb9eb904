"""Small pieces of HTML. Every text that comes from a row passes through esc()."""

from html import escape as esc

from bench.report import approximate, palette, stability
from bench.report.units import count, duration, several
from bench.report.winners import DAMAGED, LUCKY, damaged, largest, means, winners


def glyph(look, size=13):
    """A method's mark, as the charts draw it."""
    fill = look.color if look.filled else "none"
    return (f'<svg class="glyph" viewBox="-1.35 -1.35 2.7 2.7" width="{size}" height="{size}" aria-hidden="true">'
            f'<path d="{palette.SHAPES[look.shape]}" fill="{fill}" stroke="{look.color}" stroke-width="0.34"/></svg>')  # fmt: skip


def option(value, text, chosen=False):
    return f'<option value="{esc(str(value))}"{" selected" if chosen else ""}>{esc(str(text))}</option>'


def select(task, name, label, options):
    return (f'<label>{label} <select id="{task}-{name}" autocomplete="off">{"".join(options)}</select></label>'
            if options else "")  # fmt: skip


def legend(task, methods=None):
    """All charted methods, or those, with their marks; pointing at one shows it alone."""
    if methods is None:
        methods = {r.method for r in (*task.soft, *task.scaling)}  # some face hard cases only
    parts = []
    for source, words in (("ours", "Ours (filled)"), ("peer", "Peers (hollow)")):
        looks = [look for look in task.looks.values() if look.source == source and look.method in methods]
        if looks:
            chips = "".join(
                f'<button type="button" data-method="{esc(look.method)}" aria-pressed="false">'
                f"{glyph(look)} {esc(look.method)}</button>" for look in looks)  # fmt: skip
            parts.append(f'<span class="group"><b>{words}</b>{chips}</span>')
    return f'<div class="legend" data-task="{task.name}">{"".join(parts)}</div>'


def winners_table(task, run):
    """Dataset × query set: the fastest right method, and ours beside the best peer."""
    found = [w for w in largest(winners(task.soft)) if w.run == run]
    if not found or all(look.source == "ours" for look in task.looks.values()):  # nobody to win against
        return ""
    threads = min(w.threads or 1 for w in found)
    cells = {(w.dataset, w.query_set): w for w in found if (w.threads or 1) == threads}
    sets = [s for s in task.query_sets if any((d, s) in cells for d in task.datasets)]
    head = "".join(f"<th scope=col>{_breakable(s)}</th>" for s in sets)
    lines = []
    for k, dataset in enumerate(task.datasets):
        of_dataset = [cells.get((dataset, s)) for s in sets]
        if any(of_dataset):
            size = next(w.size for w in of_dataset if w)
            row = "".join(_winner(task, k, s, w) for s, w in zip(sets, of_dataset))
            name = f'<a href="#{task.name}-{k}">{_breakable(dataset)}</a>'
            lines.append(f"<tr><th scope=row>{name} <small>{count(size)}</small></th>{row}</tr>")
    foot = ". ".join(text[0].upper() + text[1:] for text in means(found, "×"))
    left_out = f" {DAMAGED[0].upper()}{DAMAGED[1:]}." if any(map(damaged, task.soft)) else ""
    lucky = f" In brackets: ours {LUCKY}." if any(w.beside_lucky for w in found) else ""
    return (f'<div class="scroll"><table class="winners"><thead><tr><th scope=col>dataset</th>{head}</tr></thead>'
            f'<tbody>{"".join(lines)}</tbody></table></div><p class="note">{foot + "." if foot else ""} Each cell: the fastest '
            "exact method at the largest size, and how many times faster our best is than the best exact peer in the same "
            "run; ~ where the intervals of the repetitions overlap or there was only one. Exact is, of ours and of peers "
            "alike, who promises it (claim exact, or bounded by rounding alone, not by epsilon or by a grid's resolution) and "
            "kept to it here, up to a mean error of 1e-6, "
            f"which is what single precision leaves. Approximate methods are in the charts, and win nothing here.{left_out}{lucky}</p>")  # fmt: skip


def _winner(task, k, query_set, w):
    if w is None:
        return "<td>–</td>"
    best = w.best
    if w.ratio is None:
        note, kind = "no peer exact" if w.ours else "ours not exact", "ours" if w.ours else "peer"
    else:
        note = f"{w.ratio:.2f}×{'' if w.clear else ' ~'}"
        kind = "even" if not w.clear else "ours" if w.ratio > 1 else "peer"
    beside = ""
    if w.beside_lucky:
        sure = "" if w.clear_beside else " ~"
        beside = f"<br><small class=beside>[{w.beside_lucky:.2f}×{sure} {_breakable(w.lucky.method)}]</small>"
        kind = "even" if kind == "ours" and (w.beside_lucky <= 1 or sure) else kind
    return (f'<td class="{kind}"><a href="#{task.name}-{k}" data-task="{task.name}" data-set="{esc(query_set or "")}">'
            f"{glyph(task.looks[best.method])} {_breakable(best.method)}</a><br><span>{duration(best.query_ns)}</span> "
            f"<small>{note}</small>{beside}</td>")  # fmt: skip


def _breakable(name):
    """A name that may go on in the next line after an underscore."""
    return esc(name).replace("_", "_<wbr>")


def figures(task, card):
    """A card of charts that no choice changes; with a legend where their axes do not name the methods."""
    key = legend(task, card.methods) if card.methods else ""
    boxes = "".join(f'<div class="chart"><h4>{esc(f.title)}</h4><div id="{esc(f.name)}" class="plot"></div></div>'
                    for f in card.figures)  # fmt: skip
    return (f'<article class="series" id="{card.name}"><h3>{esc(card.title)}</h3><p class="note">{esc(card.caption)}</p>'
            f'{key}<div class="row">{boxes}</div></article>')  # fmt: skip


def rungs(task, dataset):
    """Our approximate rungs beside FLANN's frontier, at the dataset's largest size."""
    rows = [r for r in task.of(dataset) if r.run == task.runs[0] and r.threads == task.threads[0]]
    size = max((r.size for r in rows), default=0)
    by_set = approximate.by_set([r for r in rows if r.size == size]) if task.name == "knn" else {}
    if not by_set:
        return ""
    lines = []
    for name, found in by_set.items():
        for r in found:
            told = "none finds as much" if r.rival is None else f"{esc(r.rival.method)}, {duration(r.rival.query_ns)}"
            ratio = "" if r.ratio is None else f"{r.ratio:.1f}×"
            lines.append(f"<tr><td>{esc(name)}</td><td>{esc(r.name)}</td><td>{r.recall:.4f}</td>"
                         f"<td>{duration(r.row.query_ns)}</td><td>{told}</td><td>{ratio}</td><td>{r.verdict}</td></tr>")  # fmt: skip
    heads = ("query set", "our rung", "recall", "time", "FLANN's fastest of that recall", "FLANN / ours", "FLANN's frontier")
    head = "".join(f"<th scope=col>{h}</th>" for h in heads)
    every = [r for found in by_set.values() for r in found]
    where = f"at {several(size, task.text.element)}, all nearest-neighbour sets"
    return (f'<p class="rungs-told"><b>Approximate rungs</b> {where}: {esc(approximate.summary(every))}</p>'
            "<details><summary>Each rung at its recall</summary>"
            f'<div class="scroll"><table class="plain"><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody>'
            "</table></div></details>")  # fmt: skip


def matrix_table(task):
    """Hard case × method."""
    cases, columns, cells = stability.matrix(task.rows, task.looks)
    if not cases:
        return ""
    head = "".join(f"<th scope=col><span>{esc(c.label)}</span>{glyph(task.looks[c.method])}</th>" for c in columns)
    lines = []
    for case in cases:
        line = "".join(_cell(cells.get((case, c))) for c in columns)
        lines.append(f"<tr><th scope=row>{esc(case)}</th>{line}</tr>")
    totals = []
    for column in columns:
        mine = [cells[case, column] for case in cases if (case, column) in cells]
        bad = sum(cell.status in ("crashed", "timeout", "out_of_memory", "wrong") for cell in mine)
        totals.append(f'<td class="{"st-wrong" if bad else "st-ok"}">{bad}</td>')
    key = " ".join(f'<span><i class="st-{s}">{stability.LETTERS[s]}</i> {w}</span>' for s, w in stability.WORDS.items())
    name = f"{task.name}-matrix"
    asked = {c.method for c in columns}
    unasked = [m for m in task.looks if m not in asked and any(r.method == m and r.status != "not_built" for r in task.soft)]
    note = f'<p class="note">Not in this matrix: {esc(", ".join(unasked))}. {esc(task.text.hard)}</p>' if unasked else ""
    asserted = sum((c.row.reason or "").startswith("an assertion") for c in cells.values())
    if asserted:
        note += (f'<p class="note">{asserted} of the crashes are assertions: Debian builds its Embree and PCL with them, and they '
                 "end the program where a build without them would go on to answer, rightly or not.</p>")  # fmt: skip
    return (f'<p class="key">{key}</p><div class="scroll"><table class="matrix" id="{name}"><thead><tr><th></th>{head}'
            f'</tr></thead><tbody>{"".join(lines)}</tbody><tfoot><tr><th scope=row>broken cases</th>{"".join(totals)}'
            f'</tr></tfoot></table></div><p class="line" id="{name}-line" aria-live="polite">Point at a cell, or move '
            f"with the arrow keys, to read what happened there.</p>{note}")  # fmt: skip


def _cell(cell):
    if cell is None:
        return "<td></td>"
    return (f'<td class="st-{cell.status}" data-detail="{esc(cell.detail)}" aria-label="{esc(cell.detail)}">'
            f"{cell.letter}<small>{esc(cell.error)}</small></td>")  # fmt: skip


# What a heading says of a kind of pictures; those made of panels side by side take a row each.
KINDS = {"work": "work: nodes and triangles that queries visit", "slice": "slices through the cells of trees",
         "disagreement": "where answers differ from the truth", "leaks": "leaks at edges and vertices",
         "filtered": "textures averaged at every pixel", "shadow": "every method beside the truth",
         "strip": "one knob from its least to its most", "converged": "rooms, converged",
         "light": "noisy, converged, and the error"}  # fmt: skip
PANELS = ("work", "leaks", "filtered", "shadow", "strip", "light")


SCALE = ('<p class="note">Errors are drawn by their root, so that small ones show: a quarter of the light is half of the '
         "colour. Dark blue, in the images and below them, is not asked about.</p>")  # fmt: skip


def _sheet(picture):
    """The image, with what stands on each of its panels written over its corner."""
    image = f'<img src="{picture.uri}" alt="{esc(picture.title)}" loading="lazy">'
    if not picture.panels:
        return image
    names = "".join(f"<li><span>{esc(name)}</span></li>" for name in picture.panels)
    rows = -(-len(picture.panels) // picture.columns)
    return f'<div class="sheet" style="--columns:{picture.columns};--rows:{rows}">{image}<ol aria-hidden="true">{names}</ol></div>'


def gallery(pictures):
    """Figures by kind."""
    parts = []
    for kind in dict.fromkeys(p.kind for p in pictures):
        figures = "".join(
            f'<figure{" class=panels" if kind in PANELS else ""}>{_sheet(p)}'
            f'<figcaption><b>{esc(p.title)}</b> '
            f'<small>{esc(", ".join(filter(None, (p.dataset, p.method))))}</small>'
            f'{"<br>" + esc(p.caption) if p.caption else ""}</figcaption></figure>'
            for p in pictures if p.kind == kind)  # fmt: skip
        note = SCALE if kind == "strip" and any(p.task == "shadow" for p in pictures) else ""
        parts.append(f"<h4>{esc(KINDS.get(kind, kind.replace('_', ' ')))}</h4>{note}<div class=gallery>{figures}</div>")
    return "".join(parts)


def advice(task):
    datasets = "".join(option(d, d) for d in task.datasets)
    told = list(dict.fromkeys(r.query_set for r in task.soft if r.values.get("advised")))
    sets = option("*", f"those of --advise: {', '.join(told)}" if told else "all that every method answers")
    sets += "".join(option(s, s) for s in task.query_sets)
    return (f'<div class="advice" data-task="{task.name}"><div class="controls"><label>dataset <select name="dataset" '
            f'autocomplete="off">{datasets}</select></label><label>query sets <select name="set" autocomplete="off">'
            f'{sets}</select></label><label class="slide">tolerance <input type="range" name="tolerance" min="0" '
            f'max="121" value="81" autocomplete="off"><output class="value"></output></label></div>'
            '<div class="answer" aria-live="polite"></div>'
            '<div class="scroll"><table class="plain"><thead><tr><th></th><th>rung</th><th>cost</th><th>verdict</th></tr>'
            '</thead><tbody class="rungs"></tbody></table></div></div>')  # fmt: skip
