"""Figures with units, short enough for a label."""


def figure(value):
    """Three significant digits, without an exponent where that is short."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 1e5:
        text = f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"
        return text
    return f"{value:.2g}".replace("e-0", "e-").replace("e+0", "e")


def brief(value):
    """Two significant digits, for a cell of a few letters."""
    return f"{value:.0f}" if 100 <= value < 1e5 else f"{value:.2g}".replace("e-0", "e-").replace("e+0", "e")


def duration(ns):
    for unit, scale in (("s", 1e9), ("ms", 1e6), ("µs", 1e3)):
        if ns >= scale:
            return f"{figure(ns / scale)} {unit}"
    return f"{figure(ns)} ns"


def count(n):
    for unit, scale in (("M", 1_000_000), ("k", 1000)):
        if n >= scale:
            return f"{n / scale:.3g}{unit}"
    return str(n)


def several(n, word):
    """So many of what the word names: "1 direction", "20k triangles"."""
    return f"{count(n)} {word}{'' if n == 1 else 's'}"
