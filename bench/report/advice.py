"""The advice: the cheapest configuration that meets a tolerance on every stated metric, and what the rung below breaks.

The same rules as bench/core/advice.hpp and page/advice.js, on the query sets that Task::advise_on names: a cost is the sum
over the query sets, and an error is held against the tolerance or the truth's own floor, whichever is larger. At a
tolerance not above the floor, methods whose claim promises nothing about other queries, or only a bound by epsilon or by a
grid's resolution, are not advised. A test holds this file and the page to one answer.
"""

from dataclasses import dataclass

from bench.report.frontier import floor_of, promises
from bench.report.rows import knob_text

METRICS = ("error", "error_max", "error_p99", "error_mean", "bias")  # in the order in which limits are tried


@dataclass
class Rung:
    method: str
    build_knobs: str
    query_knobs: str
    rows: list  # one a query set
    cost: float  # ns, one query of each set

    def limit(self, tolerance):
        """The first limit that this rung breaks, as (query set, name, figure), or None."""
        for row in self.rows:
            if row.status != "ok":
                return row.query_set, row.status, None
            for metric in METRICS:
                value = getattr(row, metric)
                if value is not None and abs(value) > max(tolerance, floor_of(row)):
                    return row.query_set, metric, abs(value)
            if row.error is None:
                return row.query_set, "nothing tells how far off its answers are", None
        for row in self.rows:
            if not promises(row) and tolerance <= floor_of(row):
                return row.query_set, f"its claim is {row.claim}", None
        return None


def asked_sets(rows):
    """The query sets on which --advise measures, as the rows say (Task::advise_on); of older rows, which do not say,
    those that every method answers: a set that some library lacks must not drop it from the ladder."""
    timed = [r for r in rows if r.query_ns is not None]
    if told := list(dict.fromkeys(r.query_set for r in timed if r.values.get("advised"))):
        return told
    answered = {(r.method, r.query_set) for r in timed}
    sets = list(dict.fromkeys(r.query_set for r in timed))
    return [s for s in sets if all((r.method, s) in answered for r in timed)] or sets


def rungs(rows, query_sets):
    """From the cheapest on; rows of one run, block and thread count. Only configurations that have a time for every
    query set."""
    by_configuration = {}
    for row in rows:
        if row.query_set in query_sets and row.query_ns is not None:
            by_configuration.setdefault((row.method, knob_text(row.build_knobs), knob_text(row.query_knobs)), {})[
                row.query_set] = row  # fmt: skip
    found = [Rung(*names, [cells[s] for s in query_sets], sum(c.query_ns for c in cells.values()))
             for names, cells in by_configuration.items() if len(cells) == len(query_sets)]  # fmt: skip
    return sorted(found, key=lambda r: r.cost)


def advise(ladder, tolerance):
    """(the cheapest rung that holds, the next cheaper one, its broken limit); None where there is none."""
    below = None
    for rung in ladder:
        limit = rung.limit(tolerance)
        if limit is None:
            return rung, below, below and below.limit(tolerance)
        below = rung
    return None, below, below and below.limit(tolerance)
