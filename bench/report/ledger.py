"""The claims ledger as HTML: each sentence with its verdict, the figures it rests on and the rows behind them."""

from pathlib import Path

from bench.report import claims
from bench.report.pieces import esc
from bench.report.rows import knob_text
from bench.report.units import count, duration, figure

CLASSES = {claims.HOLDS: "ours", claims.ONLY_IF: "even", claims.FAILS: "peer", claims.NOT_RUN: ""}
NOTE = f"""Sentences that courses and handbooks repeat, each held against the rows of this report. Where they say which
structure is faster, two contests decide: {"; and ".join(claims.CONTESTS.values())}. A figure is the favoured structure's time
over its fastest rival's, the geometric mean of a group: below 1 it wins. A group supports the sentence if that mean is below
{1 / claims.NEAR:.2f} and at least {claims.AGREEING:.0%} of its comparisons do not contradict it. Sentences about sizes and
answers are taken apart into statements that rows support or not. All support it, at every size: it holds; some do, or at
some size: it holds only if; none does: it does not hold."""


def section(rows):
    """The whole ledger."""
    verdicts = claims.ledger(list(rows))
    present = {r.task for r in rows}
    shown = [v for v in verdicts if v.tasks & present]
    body, others = "".join(map(_claim, shown)), len(verdicts) - len(shown)
    if others:
        tasks = sorted(set().union(*(v.tasks for v in verdicts if v not in shown)))
        are = "1 more is" if others == 1 else f"{others} more are"
        body += f'<p class="note">{are} {claims.NOT_RUN}: there are no rows of {esc(", ".join(tasks))} here.</p>'
    return f'<section id="claims"><h2>Claims ledger</h2><p class="note">{esc(NOTE)}</p>{body}</section>'


def _claim(v):
    condition = f": {esc(v.condition)}" if v.condition else ""
    head = (f'<article class="claim" id="claim-{v.id}"><h3>{v.id} {esc(v.sentence)}</h3>'
            f'<p class="verdict {CLASSES[v.word]}"><b>{esc(v.word)}</b>{condition}</p>'
            f'<p class="note">Tried by {esc(v.experiment)}. {esc(v.coverage)}</p>')  # fmt: skip
    behind = _clouds(v) + _cells(v) if v.cells else _behind(v)
    return head + (_groups(v) + behind if v.figures else "") + "</article>"


def _behind(v):
    """The table that a claim brings itself."""
    if not v.table:
        return ""
    heads, lines = v.table
    shown = [[figure(c) if isinstance(c, (int, float)) or c is None else c for c in line] for line in lines]
    return f"<details><summary>The {len(lines)} lines behind it</summary>{_table(heads, shown)}</details>"


def _table(heads, lines):
    head = "".join(f"<th scope=col>{h}</th>" for h in heads)
    body = "".join("<tr>" + "".join(f"<td>{esc(str(c))}</td>" for c in line) + "</tr>" for line in lines)
    rows = f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return f'<div class="scroll"><table class="plain">{rows}</table></div>'


def _groups(v):
    if not v.spread:
        lines = [(words, figure(ratio), cells, "yes" if yes else "no") for words, ratio, cells, yes in v.figures]
        return _table(("statement", v.figure, v.unit, "supports the sentence"), lines)
    lines = [(words, figure(ratio), sizes, against or "none", cells, "yes" if yes else "no")
             for (words, ratio, cells, yes), (sizes, against) in zip(v.figures, v.spread)]  # fmt: skip
    heads = ("group", "time over the fastest rival's", "by points", f"datasets against it (above {claims.NEAR})", "comparisons",
             "supports the sentence")  # fmt: skip
    return _table(heads, lines)


def _clouds(v):
    """Times and leaf visits by cloud, size and place: visits tell what a structure saves, times what that is worth."""
    lines = []
    for (dataset, size, place), contests in claims.by_cloud(v).items():
        times, leaves, bsp, _ = contests.get("binary", (None,) * 4)
        best, _, _, _ = contests.get("best", (None,) * 4)
        figures = map(figure, (times, leaves, bsp, best))
        lines.append((dataset, count(size), claims.PLACES[place], *figures))
    heads = ("dataset", "size", "queries", "KD/BVH, time, binary", "KD/BVH, leaves visited, binary", "BSP/BVH, time, binary",
             "KD/BVH, time, best of each")  # fmt: skip
    return _table(heads, lines)


def _cells(v):
    lines = []
    for c in v.cells:
        for family in claims.FAMILIES:
            if row := c.rows.get(family):
                where = f"{Path(row.file).name}:{row.line}"
                lines.append((c.dataset, count(c.size), c.query_set, c.contest, family, row.method,
                              knob_text(row.build_knobs), duration(row.query_ns), figure(claims.leaves(row)), where))  # fmt: skip
    heads = ("dataset", "size", "query set", "contest", "family", "method", "built with", "time", "leaves", "row")
    return f"<details><summary>The {len(lines)} rows behind it</summary>{_table(heads, lines)}</details>"
