"""The advice: the cheapest configuration that meets a tolerance on every stated metric, and what the rung below breaks.

page/advice.js does the same in the browser; a test holds the two to the same words.
"""

from dataclasses import dataclass
from math import exp, log


METRICS = ("error", "error_p99", "error_mean", "bias", "error_max")  # in the order in which limits are tried


@dataclass
class Rung:
    method: str
    build_knobs: str
    query_knobs: str
    cost: float  # ns per query; over several query sets the geometric mean
    errors: dict  # metric → largest over the query sets, 0 where below the truth's floor
    broken: str = ""  # a status that is not ok

    def limit(self, tolerance):
        """The first limit that this rung breaks, as (name, figure), or None."""
        if self.broken:
            return self.broken, None
        return next(((m, v) for m, v in self.errors.items() if v > tolerance), None)


def rungs(rows, query_sets):
    """From the cheapest on; rows of one run, block and thread count. Only configurations that ran every query set."""
    by_configuration = {}
    for row in rows:
        if row.query_set in query_sets and row.query_ns is not None:
            by_configuration.setdefault(row.configuration, {})[row.query_set] = row
    found = []
    for (method, build, query), cells in by_configuration.items():
        if len(cells) < len(query_sets):
            continue
        broken = next((c.status for c in cells.values() if c.status != "ok"), "")
        cost = exp(sum(log(c.query_ns) for c in cells.values()) / len(cells))
        errors = {}
        for metric in METRICS:
            figures = [value for c in cells.values() if (value := figure(c, metric)) is not None]
            if figures:
                errors[metric] = max(figures)
        if "error" not in errors and not broken:
            broken = "unjudged"
        found.append(Rung(method, build, query, cost, errors, broken))
    return sorted(found, key=lambda r: r.cost)


def figure(row, metric):
    value = getattr(row, metric)
    if value is None:
        return None
    return 0.0 if abs(value) <= (row.error_floor or 0.0) else abs(value)


def advise(ladder, tolerance):
    """(the cheapest rung that holds, the next cheaper one, its broken limit); None where there is none."""
    below = None
    for rung in ladder:
        limit = rung.limit(tolerance)
        if limit is None:
            return rung, below, below and below.limit(tolerance)
        below = rung
    return None, below, below and below.limit(tolerance)


