#!/usr/bin/env python3
"""Winners: per dataset and query set the fastest exact method, and ours beside the best peer of the same run.

A method counts as exact if its claim promises it and its answers kept to it: the same is asked of ours and of peers.
Approximate ones win nothing here, however right they were on the queries at hand; where such a peer had no error on
them and was faster than every peer that promises, ours is set against it, too. Damaged meshes are left out: what is
inside of them nobody promises.
"""

import argparse
import sys
from dataclasses import dataclass
from math import exp, log
from pathlib import Path

if __package__ in (None, ""):  # run as a file
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from bench.report import rows as reader
from bench.report import busy
from bench.report.frontier import fastest, groups, right
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
    lucky: object = None  # a peer without a promise that was right here and faster than `peer`, or None

    @property
    def best(self):
        rows = [r for r in (self.ours, self.peer) if r]
        return min(rows, key=lambda r: r.query_ns)

    @property
    def ratio(self):
        """How many times faster ours is than the best peer, or None."""
        return self.peer.query_ns / self.ours.query_ns if self.ours and self.peer else None

    @property
    def beside_lucky(self):
        """How many times faster ours is than that peer, or None."""
        return self.lucky.query_ns / self.ours.query_ns if self.ours and self.lucky else None

    @property
    def hardest(self):
        """The ratio to the fastest peer that was right on these queries, whatever it claims, or None."""
        return self.beside_lucky or self.ratio

    @property
    def clear(self):
        """The intervals of the two are known and do not overlap."""
        return not (self.ours and self.peer) or apart(self.ours, self.peer) != 0

    @property
    def clear_beside(self):
        """The same of ours and the peer in brackets."""
        return not (self.ours and self.lucky) or apart(self.ours, self.lucky) != 0


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


def damaged(row):
    return "+" in row.dataset


def winners(rows):
    found = []
    judged = (r for r in rows if not (r.hard or r.scaling or damaged(r)))
    for (run, task, _, _, query_set, threads), group in groups(judged).items():
        ours = fastest(r for r in group if r.source == "ours")
        peers = [r for r in group if r.source == "peer"]
        peer, lucky = fastest(peers), fastest(peers, right)
        if ours or peer:
            first = group[0]
            lucky = lucky if lucky is not peer else None
            found.append(Winner(task, first.dataset, first.size, query_set, threads, run, ours, peer, lucky))
    return found


def largest(found):
    """Only the largest size of each dataset."""
    top = {}
    for w in found:
        top[w.task, w.dataset] = max(w.size, top.get((w.task, w.dataset), 0))
    return [w for w in found if w.size == top[w.task, w.dataset]]


def mean_ratio(found, ratio=lambda w: w.ratio):
    """Geometric mean of the ratios, or None."""
    ratios = [r for w in found if (r := ratio(w))]
    return exp(sum(map(log, ratios)) / len(ratios)) if ratios else None


def table(rows, sizes=largest):
    """A short text table for the terminal: datasets at their largest size (or all that `sizes` keeps) against query
    sets."""
    lines, every = [], winners(rows)
    for task in dict.fromkeys(r.task for r in rows):
        found = sizes([w for w in every if w.task == task])
        if not found:
            continue
        sets = list(dict.fromkeys(w.query_set or "-" for w in found))
        body = {}
        for w in found:
            body.setdefault((w.dataset, w.size, w.threads, w.run), {})[w.query_set or "-"] = _cell(w)
        lines += ["", f"{task}: the fastest method that promises exact answers, and ours / best such peer in speed"]
        lines += _aligned([["dataset", "n", *sets]] + [[name, count(size), *(cells.get(s, "-") for s in sets)]
                                                       for (name, size, _, _), cells in body.items()])  # fmt: skip
        lines += [f"  {text}" for text in means(found, "x")]
        if any(r.task == task and damaged(r) for r in rows):
            lines.append(f"  {DAMAGED}")
    if any(not (w.clear and w.clear_beside) for w in sizes(every)):
        lines.append("  ~ no clear winner: the intervals of the repetitions overlap, or there was only one")
    if any(w.beside_lucky for w in sizes(every)):
        lines.append(f"  […] {LUCKY}")
    if lines and (told := busy.warning(rows)):
        lines.append(f"  busy: {told}")
    return "\n".join(lines).lstrip("\n")


DAMAGED = "meshes that were damaged (+ in the name) are left out: of what is inside of them nobody promises anything"
LUCKY = ("beside the fastest peer that had no error on these queries though it promises nothing for others: a faster "
         "one than those that promise")  # fmt: skip


def means(found, times):
    """Sentences: geometric means of the ratios, by what peers promise."""
    out = []
    if (mean := mean_ratio(found)) is not None:
        cells = sum(w.ratio is not None for w in found)
        low, high = (pick(w.ratio for w in found if w.ratio) for pick in (min, max))
        out.append(f"geometric mean of {cells} ({low:.2f} to {high:.2f}): ours runs at {mean:.2f}{times} the speed of the best "
                   "peer that promises exact answers")  # fmt: skip
    if any(w.beside_lucky for w in found):
        mean = mean_ratio(found, lambda w: w.hardest)
        cells = sum(w.hardest is not None for w in found)
        out.append(f"in {cells} cell{'s' if cells > 1 else ''} ours runs at {mean:.2f}{times} the speed of the fastest peer that "
                   "had no error here, whatever it claims (geometric mean)")  # fmt: skip
    return out


def _cell(w):
    ratio = f" {w.ratio:.2f}x{'' if w.clear else '~'}" if w.ratio else " (no peer exact)" if w.ours else " (ours none)"
    beside = f" [{w.lucky.method} {w.beside_lucky:.2f}x{'' if w.clear_beside else '~'}]" if w.beside_lucky else ""
    return w.best.method + ratio + beside


def _aligned(lines):
    widths = [max(map(len, column)) for column in zip(*lines)]
    return ["  " + "  ".join(text.ljust(w) for text, w in zip(line, widths)).rstrip() for line in lines]


def main(argv=None):
    parser = argparse.ArgumentParser(prog="winners.py", description=__doc__.partition("\n")[0])
    parser.add_argument("rows", nargs="+", metavar="ROWS.jsonl")
    parser.add_argument("--all-sizes", action="store_true", help="every size of a dataset, not the largest alone")
    arguments = parser.parse_args(argv)
    try:
        read = reader.read(arguments.rows)
    except (OSError, reader.RowError) as error:
        parser.exit(2, f"winners: {error}\n")
    told = table(list(read), list if arguments.all_sizes else largest)
    print(told or "No row of a method that promises exact answers has a time.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
