"""Colour and shape of each method: filled ones are ours, hollow ones peers. Beyond that, no two methods of a task share both.

A method looks the same in every task that has it. The colour is that of the family (of our trees) or of the library (of peers), in every task and every report; methods
of one colour differ in shape. Colours are Okabe and Ito's, which the colour-blind can tell apart (yellow left out: too
pale on white). `currentColor` is black on a light page and white on a dark one.
"""

import zlib
from dataclasses import dataclass

INK = "currentColor"
VERMILION, BLUE, GREEN, ORANGE, SKY, PURPLE = "#D55E00", "#0072B2", "#009E73", "#E69F00", "#56B4E9", "#CC79A7"
COLORS = (INK, BLUE, GREEN, VERMILION, PURPLE, SKY, ORANGE)
FAMILIES = {"brute": INK, "kd": BLUE, "bsp": GREEN, "bvh": VERMILION, "forest": PURPLE}
LIBRARIES = {"nanoflann": ORANGE, "flann": SKY, "pcl": PURPLE, "cgal": GREEN, "embree": BLUE}
PLAIN = {"brute": "circle", "kd_tree": "square", "bsp_tree": "triangle-up", "bvh": "diamond"}  # the textbook's
HEXAGON = "M0,-1L0.87,-0.5L0.87,0.5L0,1L-0.87,0.5L-0.87,-0.5Z"
STAR = "M0,-1L0.25,-0.3L1,-0.3L0.4,0.1L0.6,0.85L0,0.4L-0.6,0.85L-0.4,0.1L-1,-0.3L-0.25,-0.3Z"
BOWTIE = "M-0.9,-0.8L0.9,0.8L0.9,-0.8L-0.9,0.8Z"
HOURGLASS = "M-0.8,-0.9L0.8,0.9L-0.8,0.9L0.8,-0.9Z"
SALTIRE = "M-0.9,-0.5L-0.5,-0.9L0,-0.4L0.5,-0.9L0.9,-0.5L0.4,0L0.9,0.5L0.5,0.9L0,0.4L-0.5,0.9L-0.9,0.5L-0.4,0Z"
CHEVRON = "M0,-0.9L0.95,0.1V0.9L0,0L-0.95,0.9V0.1Z"
HALF = "M-1,0.5A1,1,0,0,1,1,0.5Z"
BAR = "M-1,-0.4H1V0.4H-1Z"
PILLAR = "M-0.4,-1H0.4V1H-0.4Z"
CORNER = "M-0.85,-0.85H-0.1V0.1H0.85V0.85H-0.85Z"
# A shape's outline in a box of -1..1, as SVG draws it in the legend; Vega knows the first by their names.
SHAPES = {
    "circle": "M1,0A1,1,0,1,1,-1,0A1,1,0,1,1,1,0Z",
    "square": "M-0.85,-0.85H0.85V0.85H-0.85Z",
    "triangle-up": "M0,-0.95L0.95,0.75H-0.95Z",
    "diamond": "M0,-1.1L0.85,0L0,1.1L-0.85,0Z",
    "cross": "M-1,-0.35H-0.35V-1H0.35V-0.35H1V0.35H0.35V1H-0.35V0.35H-1Z",
    "triangle-down": "M0,0.95L0.95,-0.75H-0.95Z",
    HEXAGON: HEXAGON,
    STAR: STAR,
    "triangle-right": "M0.95,0L-0.75,0.95V-0.95Z",
    BOWTIE: BOWTIE,
    "triangle-left": "M-0.95,0L0.75,0.95V-0.95Z",
    HOURGLASS: HOURGLASS,
    SALTIRE: SALTIRE,
    CHEVRON: CHEVRON,
    HALF: HALF,
    BAR: BAR,
    PILLAR: PILLAR,
    CORNER: CORNER,
}


@dataclass(frozen=True)
class Look:
    method: str
    source: str
    family: str
    color: str
    shape: str

    @property
    def filled(self):
        return self.source == "ours"


def _turned(items, name):
    """The items in turn, from one on that depends on the name alone."""
    start = zlib.crc32(name.encode()) % len(items)
    return [*items[start:], *items[:start]]


def color_of(method, source, family):
    """By the family or library; one that is not listed has a colour all the same."""
    if source == "ours":
        return FAMILIES.get(family) or _turned(COLORS, family)[0]
    # The longest name first: flann is a part of nanoflann's.
    library = next((name for name in sorted(LIBRARIES, key=len, reverse=True) if name in method), None)
    return LIBRARIES[library] if library else _turned(COLORS, method.partition("_")[0])[0]


def _wanted(method, source, family):
    """Colours and shapes, the best first. Where all shapes of the colour are taken, another colour has to do."""
    own = color_of(method, source, family)
    shapes = _turned(tuple(SHAPES), method)
    if source == "ours" and method in PLAIN:
        shapes.insert(0, PLAIN[method])
    return [(color, shape) for color in (own, *COLORS) for shape in shapes]


def looks(rows):
    """Method → look, ours first, each group in order of appearance. What no two methods of one task may share, methods
    that never meet in a task may: all tasks together have more methods than there are looks."""
    seen, tasks, met = {}, {}, {}
    for row in rows:
        seen.setdefault(row.method, (row.source, row.family or ""))
        tasks.setdefault(row.method, set()).add(row.task)
        met.setdefault(row.task, set()).add(row.method)
    shapes = {}
    for source in ("ours", "peer"):
        # In the order of their names, not of their rows; the textbook's have the first choice, then those of most tasks.
        for method in sorted((m for m, (s, _) in seen.items() if s == source), key=lambda m: (m not in PLAIN, -len(tasks[m]), m)):
            wanted = _wanted(method, source, seen[method][1])
            beside = set().union(*(met[task] for task in tasks[method])) & shapes.keys()
            mine, theirs = ({shapes[m] for m in beside if (seen[m][0] == source) is same} for same in (True, False))
            drawn, every = {shape for _, shape in mine | theirs}, set(shapes.values())
            # A shape that only the other group has in this colour is better than another colour; best is one of its own,
            # as orange and vermilion are near.
            shapes[method] = min(wanted, key=lambda w: (w in mine, w[0] != wanted[0][0], w in theirs, w[1] in drawn, w in every))
    ours_first = sorted(seen, key=lambda m: seen[m][0] != "ours")
    return {m: Look(m, *seen[m], *shapes[m]) for m in ours_first}
