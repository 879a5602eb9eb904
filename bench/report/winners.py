#!/usr/bin/env python3
"""Winners: per dataset and query set the fastest right method, and ours beside the best peer of the same run."""

import argparse
import sys
from dataclasses import dataclass
from math import exp, log
from pathlib import Path

if __package__ in (None, ""):  # run as a file
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from bench.report import rows as reader
from bench.report.frontier import fastest_exact, groups
from bench.report.units import count


@dataclass
class Winner:
    task: str
    dataset: str
    size: int
    query_set: str
    threads: int
    run: int
    ours: object  # Row or None
    peer: object

    @property
    def best(self):
        rows = [r for r in (self.ours, self.peer) if r]
        return min(rows, key=lambda r: r.query_ns)

    @property
    def ratio(self):
        """How many times faster ours is than the best peer, or None."""
        return self.peer.query_ns / self.ours.query_ns if self.ours and self.peer else None

    @property
    def clear(self):
        """The intervals of the two are known and do not overlap."""
        return not (self.ours and self.peer) or apart(self.ours, self.peer) != 0


def interval(row):
    """Of the repetitions; None where there was only one, which says nothing about its spread."""
    low, high = row.query_ns_low, row.query_ns_high
    return None if low is None or high is None or low == high else (low, high)


def apart(a, b):
    """-1: a is surely faster than b, 1: surely slower, 0: cannot be told."""
    ia, ib = interval(a), interval(b)
    if not (ia and ib):
        return 0
    return -1 if ia[1] < ib[0] else 1 if ib[1] < ia[0] else 0


def winners(rows):
    found = []
    for (run, task, _, _, query_set, threads), group in groups(r for r in rows if not (r.hard or r.scaling)).items():
        ours = fastest_exact(r for r in group if r.source == "ours")
        peer = fastest_exact(r for r in group if r.source == "peer")
        if ours or peer:
            first = group[0]
            found.append(Winner(task, first.dataset, first.size, query_set, threads, run, ours, peer))
    return found


def largest(found):
    """Only the largest size of each dataset."""
    top = {}
    for w in found:
        top[w.task, w.dataset] = max(w.size, top.get((w.task, w.dataset), 0))
    return [w for w in found if w.size == top[w.task, w.dataset]]


def mean_ratio(found):
    """Geometric mean of the ratios, or None."""
    ratios = [w.ratio for w in found if w.ratio]
    return exp(sum(map(log, ratios)) / len(ratios)) if ratios else None


def table(rows):
    """A short text table for the terminal: datasets at their largest size against query sets."""
    lines = []
    for task in dict.fromkeys(r.task for r in rows):
        found = largest([w for w in winners(rows) if w.task == task])
        if not found:
            continue
        sets = list(dict.fromkeys(w.query_set or "-" for w in found))
        body = {}
        for w in found:
            body.setdefault((w.dataset, w.size, w.threads, w.run), {})[w.query_set or "-"] = _cell(w)
        lines += ["", f"{task}: the fastest right method, and ours / best peer in speed"]
        lines += _aligned([["dataset", "n", *sets]] + [[name, count(size), *(cells.get(s, "-") for s in sets)]
                                                       for (name, size, _, _), cells in body.items()])  # fmt: skip
        if (mean := mean_ratio(found)) is not None:
            lines.append(f"  geometric mean: ours runs at {mean:.2f}x the speed of the best peer")
    if any(w.ratio and not w.clear for w in winners(rows)):
        lines.append("  ~ no clear winner: the intervals of the repetitions overlap, or there was only one")
    return "\n".join(lines).lstrip("\n")


def _cell(w):
    ratio = f" {w.ratio:.2f}x{'' if w.clear else '~'}" if w.ratio else " (no peer right)" if w.ours else " (ours none)"
    return w.best.method + ratio


def _aligned(lines):
    widths = [max(map(len, column)) for column in zip(*lines)]
    return ["  " + "  ".join(text.ljust(w) for text, w in zip(line, widths)).rstrip() for line in lines]


def main(argv=None):
    parser = argparse.ArgumentParser(prog="winners.py", description=__doc__)
    parser.add_argument("rows", nargs="+", metavar="ROWS.jsonl")
    try:
        read = reader.read(parser.parse_args(argv).rows)
    except (OSError, reader.RowError) as error:
        parser.exit(2, f"winners: {error}\n")
    print(table(list(read)) or "No row has a right answer with a time.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
