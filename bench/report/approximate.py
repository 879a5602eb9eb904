"""Do our approximate rungs lie on or beyond the frontier of FLANN's approximate indices? A verdict computed from rows.

A rung is one configuration of an approximate or bounded method of ours, at the recall that its row measured. FLANN's
frontier at that recall is the time of its fastest configuration (forest and k-means tree, all checks) that finds at
least as much. Beyond: ours is faster by more than NEAR, or FLANN gets nowhere near that recall; on: within NEAR;
behind: slower.
"""

from dataclasses import dataclass

from bench.report.claims import NEAR, mean
from bench.report.frontier import charted, groups
from bench.report.rows import knob_text

BEYOND, ON, BEHIND = "beyond", "on", "behind"
RIVALS = ("flann_forest", "flann_kmeans")


@dataclass
class Rung:
    row: object
    recall: float
    rival: object  # FLANN's fastest row of at least that recall, or None

    @property
    def ratio(self):
        """How many times faster than FLANN at that recall, or None."""
        return self.rival.query_ns / self.row.query_ns if self.rival else None

    @property
    def verdict(self):
        if self.rival is None or self.ratio > NEAR:
            return BEYOND
        return ON if self.ratio >= 1 / NEAR else BEHIND

    @property
    def name(self):
        knobs = "; ".join(filter(None, (knob_text(self.row.build_knobs), knob_text(self.row.query_knobs))))
        return f"{self.row.method} ({knobs})"


def recall(row):
    return row.extra.get(f"{row.task}_recall")


def inexact(row):
    """Of a method that trades recall for speed, whatever it found this time."""
    return row.claim == "approximate" or (row.claim == "bounded" and "epsilon" in (row.query_knobs or {}))


def rungs(rows):
    """Of rows of one group."""
    told = [r for r in rows if charted(r) and recall(r) is not None]
    rivals = [r for r in told if r.method in RIVALS]
    if not rivals:
        return []
    found = []
    for row in told:
        if row.source == "ours" and inexact(row):
            able = [r for r in rivals if recall(r) >= recall(row)]
            found.append(Rung(row, recall(row), min(able, key=lambda r: r.query_ns, default=None)))
    return sorted(found, key=lambda r: r.row.query_ns)


def by_set(rows):
    """{query set: its rungs}, of one dataset and size; sets without a rung are left out."""
    nearest = [r for r in rows if (r.query_set or "").startswith("knn")]
    found = {group[0].query_set: rungs(group) for group in groups(nearest).values()}
    return {name: of_set for name, of_set in found.items() if of_set}


def summary(found):
    """One sentence over many rungs."""
    counts = {word: sum(r.verdict == word for r in found) for word in (BEYOND, ON, BEHIND)}
    ratios = [r.ratio for r in found if r.ratio]
    text = f"{counts[BEYOND]} of {len(found)} {'lies' if counts[BEYOND] == 1 else 'lie'} beyond FLANN's frontier, {counts[ON]} on it, {counts[BEHIND]} behind"
    if ratios:
        text += (f"; at equal or better recall FLANN takes {mean(ratios):.1f} times as long (geometric mean; "
                 f"{min(ratios):.1f} at least)")  # fmt: skip
    alone = sum(r.rival is None for r in found)
    return text + (f"; {alone} find{'s' if alone == 1 else ''} more than any configuration of FLANN" if alone else "") + "."
