"""Colour and shape of each method: both carry it, and either alone is enough to tell ours from peers.

Colours are Okabe and Ito's, which the colour-blind can tell apart (yellow left out: too pale on white). Our methods
are filled, peers are hollow. `currentColor` is black on a light page and white on a dark one.
"""

from dataclasses import dataclass
from itertools import cycle, islice

INK = "currentColor"
VERMILION, BLUE, GREEN, ORANGE, SKY, PURPLE = "#D55E00", "#0072B2", "#009E73", "#E69F00", "#56B4E9", "#CC79A7"
OURS = (INK, BLUE, GREEN, VERMILION, PURPLE, SKY, ORANGE)
PEERS = (ORANGE, SKY, PURPLE, GREEN, BLUE, VERMILION, INK)
# Our trees look the same in every task.
FAMILIES = {
    "brute": (INK, "circle"),
    "kd": (BLUE, "square"),
    "bsp": (GREEN, "triangle-up"),
    "bvh": (VERMILION, "diamond"),
}
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


def looks(rows):
    """Method → look, ours first, each group in order of appearance; no two methods of a group look alike."""
    seen = {}
    for row in rows:
        seen.setdefault(row.method, (row.source, row.family or ""))
    found = {}
    for source, colors in (("ours", OURS), ("peer", PEERS)):
        taken = set()
        for k, method in enumerate(m for m, (s, _) in seen.items() if s == source):
            family = seen[method][1]
            wanted = [FAMILIES[family]] if source == "ours" and family in FAMILIES else []
            wanted += list(islice(zip(cycle(colors), cycle(SHAPES)), k, k + len(colors) * len(SHAPES)))
            color, shape = next((w for w in wanted if w not in taken), wanted[0])
            taken.add((color, shape))
            found[method] = Look(method, source, family, color, shape)
    return found
