"""Where a row stands in the chart of its dataset, top to bottom:

    failed   one rail for each status that says a method broke; below them one for what was timed and has no error
    error    the field, logarithmic; only if some answer was inexact
    exact    a band with one lane a method, for answers without any error that the truth could tell

Nothing is dropped: a zero has no place on a logarithmic axis, and a crash has no error, but both have a place here.
"""

from collections import Counter
from math import ceil, floor, log10

from bench.report.frontier import charted, frontier, groups, right, shown_error
from bench.report.rows import ABSENT, FAILURES

RAIL, LANE, LANE_MOST, DECADE, GAP = 17, 14, 30, 22, 10  # pixels
FIELD_LEAST, FIELD_MOST, WHOLE = 130, 260, 330


RAILS = {"unjudged": "timed"}  # names of rails whose status does not tell; short, as the axis title stands beside them


class Layout:
    """Of one dataset of one task, for all its sizes and query sets: a chart does not jump when they change."""

    def __init__(self, rows, methods):
        rows = [r for r in rows if not r.hard]
        errors = [shown_error(r) for r in rows if charted(r) and shown_error(r) > 0]
        exact = {r.method for r in rows if charted(r) and shown_error(r) == 0}
        statuses = {rail_of(r) for r in rows} - {None}
        y = 4
        self.rails, self.lanes, self.field, self.failed_end = {}, {}, None, y
        for status in (*FAILURES, "unjudged"):
            if status in statuses:
                self.rails[status] = y + RAIL / 2
                y += RAIL
            if status in FAILURES:
                self.failed_end = y
        if errors:
            y += GAP if self.rails else 0
            low, high = floor(log10(min(errors))), ceil(log10(max(errors)))
            high += high == low
            spare = WHOLE - y - 30 - LANE * len(exact)
            pixels = min(max(DECADE * (high - low), FIELD_LEAST, spare), FIELD_MOST)
            self.field = (y + 6, y + 6 + pixels, low, high)
            y += pixels + 12
        self.exact_start = y = y + (GAP if y > 4 else 0)
        lane = min(max(LANE, (WHOLE - y) / max(len(exact), 1)), LANE_MOST)
        for method in methods:
            if method in exact:
                self.lanes[method] = round(y + lane / 2, 2)
                y += lane
        self.height = y + 4

    def y(self, row):
        """Pixels from the top, or None for a row that was never tried."""
        if rail := rail_of(row):
            return self.rails[rail]
        if not charted(row):
            return None
        error = shown_error(row)
        if error == 0:
            return self.lanes[row.method]
        return self.pixel(log10(error))

    def pixel(self, exponent):
        top, bottom, low, high = self.field
        return round(bottom - (exponent - low) / (high - low) * (bottom - top), 2)

    @property
    def middle(self):
        """Of the field, where the axis title stands; None without one."""
        return (self.field[0] + self.field[1]) / 2 if self.field else None

    def ticks(self):
        """Pixel → label, for the axis."""
        found = {y: RAILS.get(status, status.replace("_", " ")) for status, y in self.rails.items()}
        if self.field:
            _, _, low, high = self.field
            step = max(1, ceil((high - low) / 8))
            for k in range(low, high + 1, step):
                found[self.pixel(k)] = "1" if k == 0 else "10" + str(k).translate(SUPERSCRIPT)
        found.update({y: method for method, y in self.lanes.items()})
        return found

    def zones(self):
        """Name, first and last pixel of each part that needs a background."""
        if self.failed_end > 4:
            yield "failed", 4, self.failed_end
        if self.lanes:
            yield "exact", self.exact_start, self.height - 4


def lane_notes(layout, rows):
    """Why a lane of the exact band is empty under some choice, as points for the chart: {method, y, note}. rows: all of
    that choice. page/data.js does the same."""
    exact = {r.method for r in rows if charted(r) and shown_error(r) == 0}
    for method, y in layout.lanes.items():
        if method not in exact:
            yield {"method": method, "y": y, "note": _why_empty([r for r in rows if r.method == method])}


def _why_empty(rows):
    if any(map(charted, rows)):
        return "not without error here"
    if any(rail_of(r) == "unjudged" for r in rows):
        return "timed alone: nothing to judge here"
    if failed := next((r.status for r in rows if r.failed), None):
        return failed.replace("_", " ") + " here"
    absent = next((r for r in rows if r.status in ABSENT), None)
    if absent is None:
        return "not measured here"
    reason = absent.reason or absent.status.replace("_", " ")
    return reason if len(reason) <= NOTE_MOST else "not offered here (reason below)"


NOTE_MOST = 48  # letters of a reason that fit in a lane
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def rail_of(row):
    """The rail on which this row is shown, if it is on one."""
    if row.failed:
        return row.status
    return "unjudged" if row.status == "ok" and row.query_ns is not None and row.error is None else None


def marks(rows):
    """Per row (by id): on the frontier, the best of its method, and its slot on a rail if it has no time."""
    front, best, slots = set(), set(), {}
    for group in groups(r for r in rows if not r.hard).values():
        front.update(map(id, frontier(group)))
        fastest = {}
        for row in filter(right, group):
            if row.method not in fastest or row.query_ns < fastest[row.method].query_ns:
                fastest[row.method] = row
        best.update(map(id, fastest.values()))
        taken = Counter()
        for row in group:
            if row.failed and row.query_ns is None:
                slots[id(row)] = taken[row.status]
                taken[row.status] += 1
    return front, best, slots
