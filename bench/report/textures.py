"""Claims about means of regions of textures: what tables and pyramids are worth, and what a table costs to make.

Kinds as in measures.py. Errors are over the range of the texture's values.
"""

from collections import defaultdict

from bench.report.claims import NEAR, mean
from bench.report.frontier import RIGHT
from bench.report.measures import verdict_of
from bench.report.rows import knob_text

TABLES = {"sat_float": "sums in float", "sat_centred": "sums in float, less the mean", "sat_uint32": "sums of levels in 32 bits that wrap",
          "sat_double": "sums in double", "sat_int64": "sums of levels in 64 bits"}  # fmt: skip
SHAPES = {"rotated": "turned boxes", "disc": "discs", "gaussian": "Gaussians"}  # other sets ask boxes along the axes
POOR = 0.01  # of the range: what eyes begin to see in a picture of 256 levels
FLAT = 1.5  # a time a texel that grows by no more does not grow with the texture
COPY = "nearest"  # its build copies the texture


def _soft(rows, claim):
    """Rows of the task's ordinary blocks that hold an error."""
    return [r for r in rows if r.task == claim["task"] and not (r.hard or r.scaling) and r.error is not None and r.status == "ok"]


def _set(row):
    """Without the order that it is asked in."""
    return (row.query_set or "").removesuffix("_sorted")


def tables_exact(claim, rows):
    """No mean is off by more than float's rounding: by what the sums are kept in, and by shape."""
    found, lines = defaultdict(list), []
    for row in _soft(rows, claim):
        if row.method in TABLES and row.error_max is not None:
            shape = SHAPES.get(_set(row), "boxes along the axes")
            found[shape, row.method].append(row)
            lines.append((row.dataset, row.size, _set(row), row.method, row.error, row.error_max,
                          row.extra.get(f"{row.task}_last_quarter")))  # fmt: skip
    statements = []
    for shape in ("boxes along the axes", *SHAPES.values()):
        for method, words in TABLES.items():
            if mine := found.get((shape, method)):
                worst = max(r.error_max for r in mine)
                statements.append((f"{shape}, {words}", worst, len(mine), worst <= RIGHT))
    heads = ("texture", "texels", "footprints", "method", "root mean square error", "largest error", "the same, lower right quarter")
    return verdict_of(claim, statements, (heads, lines), f"{len(lines)} rows", figure="largest error, over the range of values",
                      unit="rows")  # fmt: skip


def mips_poor(claim, rows):
    """Means are off by more than eyes forgive, for squares and for oblongs: by what is looked up."""
    found = defaultdict(list)
    for row in _soft(rows, claim):
        if row.family == "mip" and row.source == "ours" and _set(row) in claim["query_sets"]:
            found[_set(row), row.method, knob_text(row.query_knobs)].append(row)
    best, lines = {}, []
    for (asked, method, knobs), mine in sorted(found.items(), key=lambda item: claim["query_sets"].index(item[0][0])):
        worst = max(r.error for r in mine)
        if (asked, method) not in best or worst < best[asked, method][1]:
            best[asked, method] = (f"{asked}, {method} ({knobs})", worst, len(mine), worst > POOR)
        lines += [(r.dataset, r.size, asked, method, knobs, r.error, r.error_max, r.bias, r.query_ns) for r in mine]
    statements = list(best.values())  # each method with its best knobs
    heads = ("texture", "texels", "footprints", "method", "knobs", "root mean square error", "largest error", "bias", "ns a query")
    return verdict_of(claim, statements, (heads, lines), f"{len(lines)} rows; poor: an error above {POOR}",
                      figure="largest root mean square error, over the range of values", unit="rows")  # fmt: skip


def table_builds(claim, rows):
    """Time a texel stays, from the smallest texture to the largest; threads share the work."""
    builds = [r for r in rows if r.task == claim["task"] and not r.hard and r.status == "ok" and r.query_ns is not None]
    ordinary = {(r.run, r.dataset, r.size, r.method): r for r in builds if r.query_set == "build"}
    lines, by_texture = [], defaultdict(dict)
    for (run, dataset, size, method), row in ordinary.items():
        if method not in TABLES:
            continue
        by_texture[run, dataset, method][size] = row.query_ns
        copy = ordinary.get((run, dataset, size, COPY))
        over = row.query_ns * copy.bytes / (copy.query_ns * row.bytes) if copy and copy.bytes and row.bytes else None
        lines.append((dataset, size, method, row.threads, row.query_ns, over))
    statements = []
    grown = [times[max(times)] / times[min(times)] for times in by_texture.values() if len(times) > 1]
    if grown:
        worst = mean(grown)
        statements.append(("the time a texel does not grow with the texture", worst, len(grown), worst < FLAT))
    threads = defaultdict(dict)
    for row in builds:
        if row.query_set == "build_threads" and row.method in TABLES:
            threads[row.run, row.dataset, row.size, row.method][row.threads] = row.query_ns
            lines.append((row.dataset, row.size, row.method, row.threads, row.query_ns, None))
    gained = [times[1] / min(times.values()) for times in threads.values() if 1 in times and len(times) > 1]
    if gained:
        statements.append(("rows and columns are shared by threads: one thread's time over that of the best number of them",
                           mean(gained), len(gained), mean(gained) > NEAR))  # fmt: skip
    heads = ("texture", "texels", "method", "threads", "ns a texel", "time a byte, over that of a plain copy of the texture")
    return verdict_of(claim, statements, (heads, lines), f"{len(lines)} builds", figure="ratio of times", unit="tables")


KINDS = {"tables_exact": tables_exact, "mips_poor": mips_poor, "table_builds": table_builds}
