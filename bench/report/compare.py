#!/usr/bin/env python3
"""Compares two result files cell by cell: is B slower or less accurate than A?

    bench/report/compare.py A.jsonl B.jsonl [--all]

A time counts as changed only if the intervals of the repetitions do not overlap. Exit status: 0 nothing is worse,
1 something is, 2 unusable input or no common cell.
"""

import argparse
import sys
from dataclasses import dataclass
from math import exp, log
from pathlib import Path

if __package__ in (None, ""):  # run as a file
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from bench.report import rows as reader
from bench.report.frontier import shown_error
from bench.report.units import duration, figure
from bench.report.winners import apart, interval


@dataclass
class Change:
    kind: str  # slower, faster, status, error, same
    worse: bool
    a: object
    b: object
    text: str

    def __str__(self):
        r = self.b
        knobs = "; ".join(filter(None, (reader.knob_text(r.build_knobs), reader.knob_text(r.query_knobs))))
        name = f"{r.task} {r.block} {r.query_set or '-'} {r.method}" + (f" ({knobs})" if knobs else "")
        return f"{self.kind:<8}{name}: {self.text}"


def cell(row):
    """What two files have in common: everything but the machine and the build."""
    return (row.task, row.block, row.dataset_hash, row.query_set, row.threads, row.seed) + row.configuration


def compare(a, b):
    """Changes of all common cells, in B's order."""
    before = {cell(r): r for r in a}
    return [_change(before[cell(r)], r) for r in b if cell(r) in before]


def _change(a, b):
    if a.status != b.status:
        reason = f" ({b.reason})" if b.reason else ""
        return Change("status", b.status != "ok", a, b, f"{a.status} -> {b.status}{reason}")
    if a.error is not None and b.error is not None:
        ea, eb = shown_error(a), shown_error(b)
        if abs(ea - eb) > 1e-9 * max(ea, eb):
            return Change("error", eb > ea, a, b, f"{figure(ea)} -> {figure(eb)}")
    if a.query_ns is None or b.query_ns is None:
        return Change("same", False, a, b, a.status)
    text = f"{_time(a)} -> {_time(b)}, {b.query_ns / a.query_ns:.2f}x the time"
    verdict = apart(b, a)
    return Change("slower" if verdict > 0 else "faster" if verdict < 0 else "same", verdict > 0, a, b, text)


def _time(row):
    known = interval(row)
    return duration(row.query_ns) + (f" [{duration(known[0])}, {duration(known[1])}]" if known else "")


def summary(changes):
    lines = []
    timed = [c for c in changes if c.a.query_ns and c.b.query_ns]
    for task in dict.fromkeys(c.b.task for c in timed):
        ratios = [log(c.b.query_ns / c.a.query_ns) for c in timed if c.b.task == task]
        lines.append(
            f"{task}: {len(ratios)} common timed cells, geometric mean {exp(sum(ratios) / len(ratios)):.3f}x the time"
        )
    kinds = [c.kind for c in changes]
    lines.append(", ".join(f"{kinds.count(k)} {k}" for k in ("slower", "faster", "error", "status", "same")))
    return "\n".join(lines)


def main(argv=None):
    parser = argparse.ArgumentParser(prog="compare.py", description="Compares two result files with intervals.")
    parser.add_argument("a", metavar="A.jsonl")
    parser.add_argument("b", metavar="B.jsonl")
    parser.add_argument("--all", action="store_true", help="list unchanged cells, too")
    arguments = parser.parse_args(argv)
    try:
        a, b = reader.read([arguments.a]), reader.read([arguments.b])
    except (OSError, reader.RowError) as error:
        print(f"compare: {error}", file=sys.stderr)
        return 2
    for warning in a.warnings + b.warnings:
        print(f"compare: warning: {warning}", file=sys.stderr)
    changes = compare(a, b)
    if not changes:
        print("compare: the two files have no cell in common", file=sys.stderr)
        return 2
    machines = [{(r["cpu"], r["host"], r["isa"]) for r in read.runs} for read in (a, b)]
    if machines[0] != machines[1]:
        print("Note: not the same machine or instruction set; times do not compare.")
    for change in changes:
        if arguments.all or change.kind != "same":
            print(change)
    only_a, only_b = len(a) - len(changes), len(b) - len(changes)
    print(summary(changes) + (f"; only in A: {only_a}, only in B: {only_b}" if only_a or only_b else ""))
    return 1 if any(c.worse for c in changes) else 0


if __name__ == "__main__":
    sys.exit(main())
