"""Colour and shape of each method: filled ones are ours, hollow ones peers. Beyond that, no two share both while shapes last.

The colour is that of the family (of our trees) or of the library (of peers), in every task and every report; methods
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
    """Method → look, ours first, each group in order of appearance; no two methods of a group look alike."""
    seen = {}
    for row in rows:
        seen.setdefault(row.method, (row.source, row.family or ""))
    shapes, taken = {}, {}
    for source in ("ours", "peer"):
        mine = taken[source] = set()
        # In the order of their names, not of their rows; the textbook's have the first choice.
        for method in sorted((m for m, (s, _) in seen.items() if s == source), key=lambda m: (m not in PLAIN, m)):
            wanted = _wanted(method, source, seen[method][1])
            # A shape that only the other group has in this colour is better than another colour.
            shapes[method] = min(wanted, key=lambda w: (w in mine, w[0] != wanted[0][0], w in taken["ours"]))
            mine.add(shapes[method])
    ours_first = sorted(seen, key=lambda m: seen[m][0] != "ours")
    return {m: Look(m, *seen[m], *shapes[m]) for m in ours_first}
