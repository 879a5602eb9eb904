"""The claims ledger: sentences that courses repeat, each held against the rows. No verdict is ever typed in.

claims.json lists the sentences, each with its kind. Here are those about which structure is faster ("contest"); those about
sizes and answers are in measures.py and textures.py. A contest's claim names the family it favours, and the datasets and query sets it
is about. Two contests decide, for no single one is fair to all:

    binary   our binary trees with leaves of one size: what the structures themselves are worth
    best     the fastest exact method of each family, ours or a peer: what a user can get

A cell is one query set on one dataset; its ratio is the favoured family's time over that of its fastest rival. Cells fall
into groups by contest and by where the queries lie. Every group supports the claim, at every size: it holds; some do, or
at some size: it holds only if; none does: it does not hold.
"""

import json
from collections import defaultdict
from dataclasses import dataclass, field
from math import exp, log
from pathlib import Path

from bench.report.frontier import exact, groups
from bench.report.units import count, figure

LIST = Path(__file__).with_name("claims.json")
HOLDS, ONLY_IF, FAILS, NOT_RUN = "holds", "holds only if", "does not hold", "not run"
FAMILIES = ("kd", "bvh", "bsp")
BINARY = {"kd": "kd_tree", "bvh": "bvh", "bsp": "bsp_tree"}
BINARY_SIGNS = {family: f"{family}_first_hit" for family in BINARY}  # of the task inside: the same trees, by one rule
TEXTBOOK = {"kd": "planes", "bvh": "box", "bsp": "planes"}  # what bounds a cell where a tree offers several
CONTESTS = {"binary": "binary trees with leaves of equal size", "best": "the best of each family"}
PLACES = {"self": "asked at points of the cloud", "off": "asked off the cloud", "far": "asked from far away",
          "radius": "asked for a radius", "coherent": "rays near each other", "scattered": "rays in no order",
          "aimed": "rays along axes, in planes and at edges", "surface": "closest points of queries near the mesh",
          "apart": "closest points of queries away from the mesh", "sign_surface": "inside or outside, near the mesh",
          "sign_apart": "inside or outside, away from the mesh"}  # fmt: skip
RAYS = {"camera": "coherent", "camera_any": "coherent", "shadow": "coherent", "axis": "aimed", "grazing": "aimed",
        "edge": "aimed", "camera_shuffled": "scattered", "diffuse": "scattered", "bounce2": "scattered",
        "random": "scattered"}  # fmt: skip
CLOSEST = {"near": "surface", "near_sorted": "surface", "on_vertex": "surface", "uniform": "apart", "uniform_sorted": "apart",
           "far": "apart", "centre": "apart"}  # fmt: skip
NEAR = 1.1  # times repeat within some 10 %: a smaller difference is none
AGREEING = 0.75  # of a group's cells must not contradict
SIZES = 3  # that an experiment should span


@dataclass
class Cell:
    """One query set on one dataset, in one contest."""

    contest: str
    place: str
    dataset: str
    size: int
    query_set: str
    rows: dict  # family: its fastest row
    ratio: float  # the favoured family's time over its fastest rival's

    def against(self, a, b, figure):
        """The ratio of a figure of two families, or None where one lacks it."""
        values = [figure(self.rows[f]) if f in self.rows else None for f in (a, b)]
        return values[0] / values[1] if all(values) else None


@dataclass
class Verdict:
    id: str
    sentence: str
    experiment: str
    word: str = NOT_RUN
    condition: str = ""  # of "holds only if"
    figures: list = field(default_factory=list)  # (group in words, mean ratio, cells, supports)
    spread: list = field(default_factory=list)  # of each of these: (mean by size, clouds that contradict), as text
    cells: list = field(default_factory=list)
    coverage: str = ""
    figure: str = "time over the fastest rival's"  # what the figures are
    unit: str = "comparisons"  # what they are counted in
    table: tuple = ()  # (heads, lines) behind a verdict that rests on no contest
    tasks: frozenset = frozenset()  # whose rows can decide


def ledger(rows):
    """A verdict for every claim of the list."""
    from bench.report import light_claims, measures, shadow_claims, textures, transport_claims

    kinds = {"contest": judge, **measures.KINDS, **textures.KINDS, **shadow_claims.KINDS, **light_claims.KINDS,
             **transport_claims.KINDS}  # fmt: skip
    verdicts = []
    for claim in json.loads(LIST.read_text()):
        verdicts.append(kinds[claim.get("kind", "contest")](claim, rows))
        verdicts[-1].tasks = frozenset((claim["task"], *claim.get("also", ())))
    return verdicts


def judge(claim, rows):
    verdict = Verdict(claim["id"], claim["sentence"], claim["experiment"])
    verdict.cells = cells_of(claim, rows)
    by_group = defaultdict(list)
    for cell in verdict.cells:
        by_group[cell.contest, cell.place].append(cell)
    supporting = []
    for contest, place in ((c, p) for c in CONTESTS for p in PLACES if (c, p) in by_group):
        group = by_group[contest, place]
        ratios = [cell.ratio for cell in group]
        supports = _supports(ratios)
        verdict.figures.append((f"{CONTESTS[contest]}, {PLACES[place]}", mean(ratios), len(ratios), supports))
        by_size = _ratios(group, lambda cell: cell.size)
        verdict.spread.append(_spread(by_size, _ratios(group, lambda cell: cell.dataset)))
        at = [size for size in sorted(by_size) if _supports(by_size[size])]
        if supports or at:
            whole = supports and len(at) == len(by_size)
            supporting.append((contest, place, [] if whole or not at else at))
    if verdict.figures:
        everywhere = len(supporting) == len(by_group) and not any(sizes for _, _, sizes in supporting)
        verdict.word = HOLDS if everywhere else ONLY_IF if supporting else FAILS
        verdict.coverage = _coverage(claim, verdict.cells)
    if verdict.word == ONLY_IF:
        verdict.condition = _condition(supporting)
    return verdict


def _supports(ratios):
    """The favoured family wins on average, and most cells do not contradict."""
    return mean(ratios) < 1 / NEAR and sum(r <= NEAR for r in ratios) >= AGREEING * len(ratios)


def _ratios(cells, key):
    found = defaultdict(list)
    for cell in cells:
        found[key(cell)].append(cell.ratio)
    return found


def _spread(by_size, by_cloud):
    sizes = ", ".join(f"{count(size)} {figure(mean(by_size[size]))}" for size in sorted(by_size))
    against = ", ".join(f"{d} {figure(mean(r))}" for d, r in by_cloud.items() if mean(r) > NEAR)
    return sizes, against


def mean(ratios):
    """The geometric one, or None of nothing."""
    return exp(sum(map(log, ratios)) / len(ratios)) if ratios else None


def cells_of(claim, rows):
    found = []
    sets = {claim["task"]: claim["query_sets"], **claim.get("also", {})}  # by task
    mine = (r for r in rows if r.task in sets and not (r.hard or r.scaling) and r.dataset in claim["clouds"])
    for group in groups(r for r in mine if (r.query_set or "").startswith(tuple(sets[r.task]))).values():
        place = _place(group[0].task, group[0].query_set)
        if place is None:
            continue
        for contest, entrants in _entrants(group):
            if claim["favoured"] not in entrants or not {"kd", "bvh"} <= set(entrants):
                continue
            rivals = (r.query_ns for f, r in entrants.items() if f != claim["favoured"])
            ratio = entrants[claim["favoured"]].query_ns / min(rivals)
            first = group[0]
            found.append(Cell(contest, place, first.dataset, first.size, first.query_set, entrants, ratio))
    return found


def _place(task, query_set):
    if task == "closest_point":
        return CLOSEST.get(query_set)
    if task == "inside":
        return f"sign_{CLOSEST[query_set]}" if query_set in CLOSEST else None
    if query_set in RAYS:
        return RAYS[query_set]
    if query_set.startswith("radius"):
        return "radius"
    place = query_set.rpartition("_")[2].replace("sorted", "self")
    return place if place in PLACES else None


def _entrants(group):
    """(contest, family: its fastest exact row), a contest of textbook trees for each leaf size that they share."""
    able = [r for r in group if exact(r)]
    by_leaf = defaultdict(dict)
    for row in able:
        knobs = row.build_knobs or {}
        bounds = TEXTBOOK.get(row.family)
        signs = row.task == "inside"  # whose binary trees all have the leaves that are the default
        ours = row.source == "ours" and (BINARY_SIGNS if signs else BINARY).get(row.family) == row.method
        if ours and knobs.get("bounds", bounds) == bounds and ("leaf_size" in knobs or signs):
            _keep_fastest(by_leaf[knobs.get("leaf_size")], row)
    for entrants in by_leaf.values():
        yield "binary", entrants
    best = {}
    for row in able:
        if row.family in FAMILIES:
            _keep_fastest(best, row)
    yield "best", best


def _keep_fastest(entrants, row):
    held = entrants.get(row.family)
    if held is None or row.query_ns < held.query_ns:
        entrants[row.family] = row


def _condition(supporting):
    parts = []
    for contest, words in CONTESTS.items():
        places = [PLACES[p] + (f" (at {' and '.join(map(count, sizes))} points)" if sizes else "")
                  for c, p, sizes in supporting if c == contest]  # fmt: skip
        if places:
            parts.append(f"{words}: " + ", ".join(places))
    return "; ".join(parts)


def _coverage(claim, cells):
    """How much the verdict rests on; each dataset should be there at several sizes."""
    sizes = {d: len({c.size for c in cells if c.dataset == d}) for d in claim["clouds"]}
    absent = [d for d, n in sizes.items() if n == 0]
    thin = [d for d, n in sizes.items() if 0 < n < SIZES]
    text = f"{len(cells)} comparisons on {len(sizes) - len(absent)} of {len(sizes)} datasets"
    text += f"; not measured: {', '.join(absent)}" if absent else ""
    binary = [c for c in cells if c.contest == "binary"]
    for family, name in BINARY.items():
        without = sorted({c.size for c in binary if family not in c.rows})
        if without:
            text += f"; without {name} among the binary trees at {', '.join(map(count, without))} points"
    return text + (f"; at fewer than {SIZES} sizes: {', '.join(thin)}" if thin else "")


def leaves(row):
    return row.extra.get(f"{row.task}_leaves")


def time(row):
    return row.query_ns


def by_cloud(verdict):
    """{(cloud, size, place): {contest: (KD/BVH of times, of leaves, BSP/BVH of times, cells)}}, geometric means."""
    found = defaultdict(lambda: defaultdict(list))
    for cell in verdict.cells:
        found[cell.dataset, cell.size, cell.place][cell.contest].append(cell)

    def summed(cells):
        ratios = lambda a, b, f: mean([r for c in cells if (r := c.against(a, b, f))])
        return ratios("kd", "bvh", time), ratios("kd", "bvh", leaves), ratios("bsp", "bvh", time), len(cells)

    order = list(PLACES)
    keys = sorted(found, key=lambda key: (*key[:2], order.index(key[2])))
    return {key: {name: summed(cells) for name, cells in found[key].items()} for key in keys}
