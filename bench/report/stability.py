"""The stability matrix: hard case × method, each cell its worst status with the figure behind it."""

from dataclasses import dataclass

from bench.report.units import figure

# Worst first. Letter and word go with the colour, which alone would not reach everybody.
LETTERS = {
    "crashed": "C", "timeout": "T", "out_of_memory": "M", "wrong": "W", "refused": "R", "ok": "✓",
    "unsupported": "–", "not_built": "·",
}  # fmt: skip
WORDS = {
    "crashed": "crashed", "timeout": "ran past its time limit", "out_of_memory": "ran out of memory",
    "wrong": "wrong answer", "refused": "refused with a clear error", "ok": "right",
    "unsupported": "has no such query", "not_built": "not built",
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
        """The largest error of the worst row, short; empty where it says nothing."""
        value = self.row.error_max if self.row.error_max is not None else self.row.error
        return figure(abs(value)) if value is not None and self.status == "wrong" else ""

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


def matrix(rows, methods):
    """(cases, methods that have a row, {(case, method): Cell}) of one task's rows."""
    order, cells, cases = list(LETTERS), {}, {}
    for row in rows:
        if row.hard:
            cases.setdefault(row.dataset, None)
            cells.setdefault((row.dataset, row.method), []).append(row)
    summed = {}
    for key, group in cells.items():
        ran = [r for r in group if r.status not in ("unsupported", "not_built")] or group
        worst = min(ran, key=lambda r: order.index(r.status))
        summed[key] = Cell(worst.status, worst, len(ran), sum(r.status == worst.status for r in ran))
    return list(cases), [m for m in methods if any((c, m) in summed for c in cases)], summed
