"""What only the task ray shows: the figures of its hard cases, the offset that keeps rays off their own surface, and what
refitting is worth where vertices move."""

import re

import altair as alt

from bench.report import charts
from bench.report.pieces import esc, glyph
from bench.report.rows import plain
from bench.report.stability import columns_of
from bench.report.units import duration, figure

OFFSET = re.compile(r"offset_(\S+)$")
FRAME = re.compile(r"frame(\d+)_(refit|rebuilt)$")
SLOW = ("coincident_2e5", "needles_4e4", "nested_coplanar", "vertex_at_1e25")  # hard for their time, not for their answers
MANY_ULP = 100


def share(value):
    """Of a million, short enough for a cell: all, 251k, 8,150, 100."""
    return "all" if value >= 999_500 else f"{value / 1000:.3g}k" if value >= 10_000 else f"{value:,.0f}"


def extra(row, name):
    return row.extra.get(f"{row.task}_{name}")


def per_million(name):
    def value(row):
        part, whole = extra(row, name), extra(row, "judged")
        return 1e6 * part / whole if part is not None and whole else None

    return value


def leaks(row):
    return extra(row, "leaks_per_million")


def missing(row):
    return None if leaks(row) is not None else per_million("missing")(row)


def passed(row):
    """Answers with something that lies behind what is truly hit."""
    missed, without = per_million("false_misses")(row), per_million("missing")(row)
    return None if leaks(row) is not None or None in (missed, without) else max(missed - without, 0)


FIGURES = (("leaks", leaks), ("misses", missing), ("what lies behind", passed),
           ("hits that are none", per_million("surplus")), ("t beyond the triangle", per_million("t_outside")))  # fmt: skip


def hard_lines(task):
    """(columns, lines, clean cases): a line is (case, figure, {column: text}, {column: is it bad})."""
    columns = columns_of(task.rows, task.looks)
    by_case, broken = {}, set()
    for row in task.rows:
        if row.hard and row.query_set == "closest" and row.status in ("ok", "wrong"):
            by_case.setdefault(row.dataset, []).append(row)
        elif row.hard and row.failed:
            broken.add(row.dataset)
    lines, clean = [], []
    for case, rows in by_case.items():
        before = len(lines)

        def add(words, value, show=share, shown=lambda values: any(values.values()), bad=lambda v: v > 0):
            values = {}
            for row in rows:
                v, column = value(row), columns[row.method, row.configuration[1]]
                if v is not None:
                    values[column] = max(v, values.get(column, 0))
            if values and shown(values):
                lines.append((case, words, {c: show(v) for c, v in values.items()}, {c: bad(v) for c, v in values.items()}))

        for words, value in FIGURES:
            add(words, value)
        add("worst t, ulp", lambda r: extra(r, "t_ulp_max"), show=figure, bad=lambda v: v > MANY_ULP,
            shown=lambda values: any(v > MANY_ULP for v in values.values()))  # fmt: skip
        if len(lines) == before and case not in broken:
            clean.append(case)
        if case in SLOW:
            add("time per ray", lambda r: r.query_ns, show=duration, bad=lambda v: False)
    used = dict.fromkeys(c for _, _, values, _ in lines for c in values)
    return [c for c in dict.fromkeys(columns.values()) if c in used], lines, clean


def hard_table(task):
    """Per million rays, how often each method errs on each hard case; or nothing where no row has such figures."""
    columns, lines, clean = hard_lines(task)
    if not lines:
        return ""
    head = "".join(f"<th scope=col><span>{esc(c.label)}</span>{glyph(task.looks[c.method])}</th>" for c in columns)
    body = []
    for case, words, values, bad in lines:
        cells = "".join(f'<td class="{"st-wrong" if bad.get(c) else "st-ok" if c in values else ""}">'
                        f"{esc(values.get(c, ''))}</td>" for c in columns)  # fmt: skip
        body.append(f"<tr><th scope=row>{esc(case)} <small>{esc(words)}</small></th>{cells}</tr>")
    note = f" No method errs on {', '.join(clean)}." if clean else ""
    return ('<p class="note">Of a million rays, against exact arithmetic and without any allowance for rounding; leaks are '
            f"rays from inside a closed mesh that met nothing.{esc(note)}</p>"
            f'<div class="scroll"><table class="matrix figures"><thead><tr><th></th>{head}</tr></thead>'
            f"<tbody>{''.join(body)}</tbody></table></div>")  # fmt: skip


def offset_points(task):
    """Self-hits by offset, one line a method and build."""
    columns = columns_of(task.rows, task.looks)
    for row in task.rows:
        hits, found = extra(row, "self_hits_per_million"), OFFSET.match(row.query_set or "")
        if row.hard and hits is not None and found and row.query_set:
            label = columns[row.method, row.configuration[1]].label
            yield {"offset": float(found[1]), "hits": hits, "method": row.method, "line": label}


LEAST_OFFSET = 3e-9  # where no offset stands on a logarithmic axis


def offset_curves(task):
    """[(methods, {offset: hits})]: methods whose figures differ by less than a hundredth or so share a curve."""
    curves, methods = {}, {}
    for p in offset_points(task):
        curves.setdefault(p["line"], {})[p["offset"]] = p["hits"]
        methods[p["line"]] = p["method"]
    alike = {}
    for line, curve in curves.items():
        key = tuple((o, f"{hits:.1e}") for o, hits in sorted(curve.items()))
        of, _ = alike.setdefault(key, ({}, curve))
        of[methods[line]] = None
    return [(list(of), curve) for of, curve in alike.values()]


def offset_chart(task, width="container"):
    curves = offset_curves(task)
    if not curves:
        return None
    def name(methods):
        if len(curves) == 1:
            return f"all {len(methods)} methods" if len(methods) > 1 else methods[0]
        return ", ".join(methods[:4]) + (f" and {len(methods) - 4} more" if len(methods) > 4 else "")

    values = [{"offset": max(offset, LEAST_OFFSET), "hits": hits, "line": f"{k + 1}: {name(methods)}" if k else name(methods)}
              for k, (methods, curve) in enumerate(curves) for offset, hits in curve.items()]  # fmt: skip
    looks = [task.looks[methods[0]] for methods, _ in curves]
    lines = list(dict.fromkeys(v["line"] for v in values))
    x = alt.X("offset:Q", scale=alt.Scale(type="log", nice=False, padding=14), axis=alt.Axis(
        title="offset over the largest coordinate, log", values=[LEAST_OFFSET, 1e-8, 1e-7, 1e-6, 1e-5],
        labelExpr=f"datum.value < {1.1 * LEAST_OFFSET} ? 'none' : format(datum.value, '.0e')", gridOpacity=0.5))  # fmt: skip
    y = alt.Y("hits:Q", scale=alt.Scale(type="symlog", constant=100), axis=alt.Axis(
        title="rays that hit the surface they leave, per million", values=[0, 100, 1e3, 1e4, 1e5, 5e5], format=",d",
        gridOpacity=0.5))  # fmt: skip
    key = alt.Legend(title=None, orient="top", columns=1, labelLimit=560)
    color = alt.Scale(domain=lines, range=[look.color for look in looks])
    shape = alt.Scale(domain=lines, range=[look.shape for look in looks])
    base = alt.Chart(alt.Data(values=values)).encode(x=x, y=y, stroke=alt.Stroke("line:N", scale=color, legend=key))
    dots = base.mark_point(strokeWidth=1.6, size=50).encode(
        shape=alt.Shape("line:N", scale=shape, legend=key),
        tooltip=[alt.Tooltip("line:N", title="methods"), alt.Tooltip("hits:Q", format=",.0f", title="per million")])  # fmt: skip
    return alt.layer(base.mark_line(strokeWidth=1.4), dots, width=width, height=260)


def offset_note(task):
    """The smallest offset with which a method's rays hit nothing; its builds are told apart where they differ in it."""
    smallest, method_of = {}, {}
    for p in offset_points(task):
        method_of[p["line"]] = p["method"]
        if p["hits"] == 0:
            smallest[p["line"]] = min(p["offset"], smallest.get(p["line"], 1))
    agree = {m: {smallest.get(line) for line, of in method_of.items() if of == m} for m in method_of.values()}
    by_offset = {}
    for line, offset in smallest.items():
        method = method_of[line]
        by_offset.setdefault(offset, {})[method if len(agree[method]) == 1 else line] = None
    never = [line for line in method_of if line not in smallest]
    texts = [f"{o:g} for {'all' if len(by_offset) == 1 and not never else ', '.join(names)}"
             for o, names in sorted(by_offset.items())]  # fmt: skip
    texts += [f"none of these for {', '.join(never)}"] if never else []
    found = f"Smallest offset without a self-hit: {'; '.join(texts)}."
    if len(offset_curves(task)) == 1:
        found += " The methods' figures agree to about a hundredth, so one line stands for all."
    by_rule = [extra(r, "self_hits_per_million") for r in task.rows if r.hard and r.query_set == "waechter_binder"]
    if by_rule := [hits for hits in by_rule if hits is not None]:
        found += f" Wächter and Binder's offset in integers (2019) leaves {max(by_rule):,.0f} per million at most."
    return found


MOVING = """Of each method that refits, its build with the fastest rays. Where the solid line leaves the dashed one, refitting
has begun to cost the rays. Lines through the marks are the repetitions' intervals."""


def moving_pairs(task):
    """{(dataset, n): {(method, knobs): {frame: {"refit": row, "rebuilt": row}}}} of the first run."""
    found = {}
    for row in task.soft:
        match = FRAME.match(row.query_set or "")
        if match and row.status in ("ok", "wrong") and row.run == task.runs[0]:
            key = (row.method, ", ".join(f"{k} {plain(v)}" for k, v in (row.build_knobs or {}).items()))
            kinds = found.setdefault((row.dataset, row.n), {}).setdefault(key, {}).setdefault(int(match[1]), {})
            held = kinds.get(match[2])
            if held is None or row.query_ns < held.query_ns:
                kinds[match[2]] = row
    return found


def unmeasured(task):
    """{method: words for a refit that has no figures}: some methods have none, of others it was not asked."""
    rows = [r for r in task.soft if (r.query_set or "").endswith("_refit") and r.status == "unsupported"]
    return {r.method: "not measured" if (r.reason or "").startswith("not measured") else "no refit" for r in rows}


def break_even(refit, rebuilt):
    """Rays a frame from which on building anew is the cheaper: what it takes longer over what it saves a ray."""
    more = extra(rebuilt, "update_s") - extra(refit, "update_s")
    less = (refit.query_ns - rebuilt.query_ns) * 1e-9
    if more <= 0:
        return "always" if less >= 0 else "never"
    return f"from {figure(more / less)} rays" if less > 0 else "never"


def moving_table(task):
    """Refit against rebuild, frame by frame; methods without a refit show what a build of theirs costs."""
    parts, words = [], unmeasured(task)
    for (dataset, n), methods in moving_pairs(task).items():
        lines, seen = [], {method for (method, _), frames in methods.items() if any("refit" in k for k in frames.values())}
        for (method, knobs), frames in methods.items():
            if not any("refit" in kinds for kinds in frames.values()):
                if method in seen:
                    continue
                seen.add(method)
                frames = {max(frames): frames[max(frames)]}  # one build and frame say what a build costs
            for frame, kinds in sorted(frames.items()):
                refit, rebuilt = kinds.get("refit"), kinds.get("rebuilt")
                cells = [duration(1e9 * extra(r, "update_s")) if r else "–" for r in (refit, rebuilt)]
                cells += [duration(r.query_ns) if r else "–" for r in (refit, rebuilt)]
                cells.append(break_even(refit, rebuilt) if refit and rebuilt else words.get(method, "no refit"))
                lines.append("<tr>" + "".join(f"<td>{esc(str(c))}</td>" for c in (method, knobs, frame, *cells)) + "</tr>")
        heads = ("method", "built with", "frame", "refit", "rebuild", "ray after refit", "ray after rebuild", "rebuilding pays")
        head = "".join(f"<th scope=col>{h}</th>" for h in heads)
        parts.append(f"<h4>{esc(dataset)}, {n:,} triangles</h4>"
                     f'<div class="scroll"><table class="plain"><thead><tr>{head}</tr></thead>'
                     f'<tbody>{"".join(lines)}</tbody></table></div>')  # fmt: skip
    if not parts:
        return ""
    return ('<p class="note">The mesh is twisted, 0.1 rad more from bottom to top each frame. A refit keeps the tree that was '
            "built over frame 0 and moves its bounds; times of rays are medians, those of updates the best of three.</p>"
            f'<details><summary>Every build, frame by frame</summary>{"".join(parts)}</details>')  # fmt: skip


KINDS = {"refit": "after refit", "rebuilt": "after rebuild"}


def moving_points(task):
    """Of each method that has both, the build whose rays are fastest after it was made anew, frame by frame."""
    for (dataset, n), methods in moving_pairs(task).items():
        both = {k: f for k, frames in methods.items() if (f := {n: k for n, k in frames.items() if KINDS.keys() <= k.keys()})}
        best = {}
        for (method, knobs), frames in both.items():
            fastest = sum(kinds["rebuilt"].query_ns for kinds in frames.values()) / len(frames)
            if method not in best or fastest < best[method][0]:
                best[method] = fastest, knobs, frames
        for method, (_, knobs, frames) in best.items():
            for frame, kinds in frames.items():
                for kind, words in KINDS.items():
                    row = kinds[kind]
                    yield {"frame": frame, "ns": row.query_ns, "kind": words, "method": method, "knobs": knobs,
                           "lo": row.query_ns_low or row.query_ns, "hi": row.query_ns_high or row.query_ns,
                           "dataset": dataset, "line": f"{dataset}, {method}, {words}"}  # fmt: skip


def moving_chart(task, width="container"):
    """Time per ray against the frames since the build, after refit and after rebuild, for methods that have both."""
    values = list(moving_points(task))
    if not values:
        return None
    looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
    color, shape = charts._scales(looks)
    frames = sorted({v["frame"] for v in values})
    key = alt.Legend(title=None, orient="top", columns=3, labelLimit=300)
    dashed = alt.Legend(title=None, orient="top", symbolType="stroke", symbolSize=300, symbolStrokeColor=charts.INK)
    base = alt.Chart(alt.Data(values=values)).encode(
        x=alt.X("frame:Q", scale=alt.Scale(type="log", base=2, nice=False, padding=14),
                axis=alt.Axis(title="frames after the build, log", values=frames, format="d", gridOpacity=0.5)),
        stroke=alt.Stroke("method:N", scale=color, legend=key), detail=alt.Detail("line:N"))  # fmt: skip
    y = alt.Axis(title="time per ray", labelExpr=charts.DURATION, tickCount=6, gridOpacity=0.5)
    scale = alt.Scale(zero=True)
    line = base.mark_line(strokeWidth=1.6).encode(
        y=alt.Y("ns:Q", axis=y, scale=scale),
        strokeDash=alt.StrokeDash("kind:N", legend=dashed, sort=None,
                                  scale=alt.Scale(domain=list(KINDS.values()), range=[[1, 0], [5, 3]])))  # fmt: skip
    rule = base.mark_rule(strokeWidth=1.2).encode(y=alt.Y("lo:Q", axis=y, scale=scale), y2=alt.Y2("hi:Q"))
    tooltip = [alt.Tooltip("line:N", title="method"), alt.Tooltip("knobs:N", title="built with"),
               alt.Tooltip("frame:Q"), alt.Tooltip("ns:Q", title="ns a ray", format=",.0f")]  # fmt: skip
    dots = base.mark_point(size=44, strokeWidth=1.6, opacity=1).encode(
        y=alt.Y("ns:Q", axis=y, scale=scale), shape=alt.Shape("method:N", scale=shape, legend=key),
        fill=alt.Fill("method:N", scale=charts._fills(looks), legend=key), tooltip=tooltip)
    return alt.layer(line, rule, dots, width=width, height=240)


def chart_list(task):
    """(id, title, note, chart) of those that there are rows for."""
    if chart := offset_chart(task):
        yield f"{task.name}-offset", "Self-intersection: how far off must a ray start?", offset_note(task), chart
    if chart := moving_chart(task):
        yield f"{task.name}-moving", "Moving vertices: rays after refit and after rebuild", MOVING, chart
