"""Whether the machine had other work while it measured: a warning for the page and for the terminal."""

SHARE = 0.9  # of processor time in wall time, on one thread; below, something else had the core
CELLS = 0.05  # share of the timed cells from which on that is worth a word


def slowed(rows):
    """(cells that were slowed, all timed cells), of rows on one thread that are no hard cases."""
    timed = [r for r in rows if r.threads == 1 and r.query_ns and r.query_cpu_ns and not r.hard]
    return sum(r.query_cpu_ns < SHARE * r.query_ns for r in timed), len(timed)


def warning(rows):
    """One sentence and what to do, or nothing; bench/core/advice.cpp has the same limits."""
    few, timed = slowed(rows)
    if few == 0 or few < CELLS * timed:
        return ""
    cells = "cell" if timed == 1 else "cells"
    return (f"in {few:,} of {timed:,} timed {cells} the processor worked for less than {SHARE:.0%} of the time: something "
            "else ran. Measure again on a quiet machine before you trust close calls.")  # fmt: skip
