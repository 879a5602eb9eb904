"""The frontier: the rows that no other row of their group beats in both time and error."""

from collections import defaultdict


ROUNDING = 2.0**-24  # half a unit in the last place of single precision, in which answers are told


def floor_of(row):
    """The error below which answers cannot be told from right ones: the truth's own where the row states it."""
    return ROUNDING if row.error_floor is None else row.error_floor


# A truth that is itself off by more is no rounding: what agrees with it is not exact for that.
COARSE = 1e-5


def shown_error(row):
    """The error as charted: 0 means exact, as far as the truth can tell. None where none was measured."""
    if row.error is None:
        return None
    return 0.0 if abs(row.error) <= floor_of(row) else abs(row.error)


def charted(row):
    """Has a place in the chart's field, rather than on the rail of failures."""
    return row.status == "ok" and row.query_ns is not None and row.error is not None


def promises(row):
    """Its claim holds for queries that were not measured, but for rounding. A bound by epsilon, or by the resolution of a
    grid of samples, allows for errors of its own, whether or not this sample has any."""
    return row.claim == "exact" or (row.claim == "bounded" and not _own_bound(row))


def _own_bound(row):
    return bool((row.query_knobs or {}).get("epsilon") or (row.build_knobs or {}).get("resolution"))


def inaccuracy(row):
    """The error as charted; of two without any, the one that promises none is the better."""
    error = shown_error(row)
    return error, error == 0 and not promises(row)


def beats(a, b):
    """a is no worse than b in time and accuracy, and better in one."""
    ta, tb, ea, eb = a.query_ns, b.query_ns, inaccuracy(a), inaccuracy(b)
    return ta <= tb and ea <= eb and (ta < tb or ea < eb)


def frontier(rows):
    """Of rows of one group: those on the frontier, from the fastest to the most accurate."""
    best, line = (float("inf"), True), []
    for row in sorted(filter(charted, rows), key=lambda r: (r.query_ns, inaccuracy(r))):
        if inaccuracy(row) < best or (line and not beats(line[-1], row)):  # the second: an exact tie
            best = inaccuracy(row)
            line.append(row)
    return line


def groups(rows):
    """Rows by group, in order of appearance."""
    by_group = defaultdict(list)
    for row in rows:
        by_group[row.group].append(row)
    return by_group


RIGHT = 1e-6  # what single precision leaves of an error on average


def right(row):
    """Answers these queries right, but for rounding, whatever it claims: on a damaged mesh nobody's claim is judged."""
    return charted(row) and shown_error(row) <= RIGHT


def exact(row):
    """Right, and not by luck on these queries: its claim promises as much. The same is asked of ours and of peers."""
    return right(row) and promises(row)


def fastest(rows, counts=exact):
    """Of rows of one group: the fastest that counts, or None."""
    return min(filter(counts, rows), key=lambda r: r.query_ns, default=None)
