"""The stability matrix: hard case × method, each cell its worst status with the figure behind it."""

from dataclasses import dataclass

from bench.report.frontier import RIGHT, shown_error
from bench.report.rows import plain
from bench.report.units import brief, figure

# Worst first: the statuses of rows, and "inexact" for a row that is ok by its method's claim, yet not right. A refusal
# is news, that an approximate method errs is none: where one query set was refused, the cell says so.
# Letter and word go with the colour, which alone would not reach everybody.
LETTERS = {
    "crashed": "C", "timeout": "T", "out_of_memory": "M", "wrong": "W", "refused": "R", "inexact": "≈", "ok": "✓",
    "unsupported": "–", "not_built": "·",
}  # fmt: skip
WORDS = {
    "crashed": "crashed", "timeout": "ran past its time limit", "out_of_memory": "ran out of memory",
    "wrong": "wrong answer", "refused": "refused with a clear error", "inexact": "errs, as its own claim allows", "ok": "right",
    "unsupported": "has no such query, or was not tried", "not_built": "not built",
}  # fmt: skip


@dataclass
class Cell:
    status: str
    row: object  # the worst row
    count: int  # of rows in the cell
    bad: int  # of those with the worst status

    @property
    def letter(self):
        return LETTERS[self.status]

    @property
    def error(self):
        """The figure behind the status, short: how far off at worst, or on average where errors are allowed."""
        if self.status == "inexact":
            return brief(shown_error(self.row))
        value = self.row.error_max if self.row.error_max is not None else self.row.error
        return brief(abs(value)) if value is not None and self.status == "wrong" else ""

    @property
    def detail(self):
        row = self.row
        parts = [f"{row.method} on {row.dataset}: {WORDS[self.status]}"]
        if self.count > 1:
            parts.append(f"{self.bad} of {self.count} query sets")
        if row.query_set:
            parts.append(row.query_set)
        value = row.error_max if row.error_max is not None else row.error
        if value is not None:
            parts.append(f"largest error {figure(value)}")
        return "; ".join(parts) + (f". {row.reason}" if row.reason else "")


@dataclass(frozen=True)
class Column:
    """A method, and which of its builds where several faced the hard cases."""

    method: str
    build: str = ""

    @property
    def label(self):
        return f"{self.method}, {self.build}" if self.build else self.method


def status_of(row):
    return "inexact" if row.status == "ok" and (shown_error(row) or 0) > RIGHT else row.status


def columns_of(rows, methods):
    """{(method, build knobs as text): Column}, in the order of the methods."""
    builds = {m: {} for m in methods}
    for row in rows:
        if row.hard and row.method in builds and row.status != "not_built":
            builds[row.method].setdefault(row.configuration[1], row.build_knobs or {})
    out = {}
    for method, knobs in builds.items():
        differing = {k for one in knobs.values() for k, v in one.items() if any(o.get(k) != v for o in knobs.values())}
        for text, one in knobs.items():
            out[method, text] = Column(method, ", ".join(f"{k} {plain(v)}" for k, v in one.items() if k in differing))
    return out


def matrix(rows, methods):
    """(cases, columns, {(case, column): Cell}) of one task's rows."""
    order, cells, cases = list(LETTERS), {}, {}
    columns = columns_of(rows, methods)
    for row in rows:
        if not row.hard or row.method not in methods:
            continue
        cases.setdefault(row.dataset, None)
        column = columns.setdefault((row.method, row.configuration[1]), Column(row.method))
        cells.setdefault((row.dataset, column), []).append(row)
    summed = {}
    for key, group in cells.items():
        ran = [r for r in group if r.status not in ("unsupported", "not_built")] or group
        worst = min(ran, key=lambda r: (order.index(status_of(r)), -(shown_error(r) or 0)))
        status = status_of(worst)
        summed[key] = Cell(status, worst, len(ran), sum(status_of(r) == status for r in ran))
    used = dict.fromkeys(c for m in methods for c in columns.values() if c.method == m)
    return list(cases), [c for c in used if any((case, c) in summed for case in cases)], summed
