"""Whether the machine had other work while it measured: a warning for the page and for the terminal."""

SHARE = 0.9  # of processor time in wall time, on one thread; below, something else had the core
SHARE_OF_MANY = 0.75  # the same of each of several threads, which wait for the last one, too
BUILD = "build_threads"
CELLS = 0.05  # share of the timed cells from which on that is worth a word


def slowed(rows):
    """(cells that were slowed, all timed cells), of rows on one thread that are no hard cases."""
    timed = [r for r in rows if r.threads == 1 and r.query_ns and r.query_cpu_ns and not r.hard]
    return sum(r.query_cpu_ns < SHARE * r.query_ns for r in timed), len(timed)


def shared(rows):
    """The same of rows on several threads, whose processor time is that of one of them. Builds are left out: not every
    method shares its build out."""
    timed = [r for r in rows if (r.threads or 1) > 1 and r.query_ns and r.query_cpu_ns and not r.hard and r.query_set != BUILD]
    return sum(r.query_cpu_ns < SHARE_OF_MANY * r.query_ns for r in timed), len(timed)


def warning(rows):
    """One sentence and what to do, or nothing; bench/core/advice.cpp has the same limits."""
    told = [_told(*slowed(rows), SHARE, "timed {}", "the processor worked for less than {} of the time: something else ran"),
            _told(*shared(rows), SHARE_OF_MANY, "{} of several threads", "each had a core for less than {} of the time: not as "
                  "many were free, and speedups are too low")]  # fmt: skip
    told = "; ".join(filter(None, told))
    return f"{told}. Measure again on a quiet machine before you trust close calls." if told else ""


def _told(few, timed, share, which, words):
    if few == 0 or few < CELLS * timed:
        return ""
    return f"in {few:,} of {timed:,} {which.format('cell' if timed == 1 else 'cells')} {words.format(f'{share:.0%}')}"
