"""Claims about the transport of light: how rays multiply (S8), and whether the textbook's path tracer is unbiased (L8).

Kinds as in measures.py.
"""

from bench.report.measures import verdict_of
from bench.report.rows import knob_text
from bench.report.transport import field, samples

TASK = "light_transport"
CHANCE = 4  # standard errors: what is no farther off zero may be by chance
ROUNDING = 1e-9
SLIPS = {"emitters": "as it is printed: lamps that are met count nothing",
         "roulette_first": "with the die cast before the direct light, which is not divided by its probability",
         "half_pi": "with the hemisphere taken for π/2 steradians"}  # fmt: skip


def _mine(rows):
    mine = [r for r in rows if r.task == TASK and r.status in ("ok", "wrong") and not r.scaling]
    first = mine[0].run if mine else 0
    return [r for r in mine if r.run == first]


def rays_multiply(claim, rows):
    """Whitted tracing: at most 2^k rays at bounce k, for each primary ray; all of them at most 2^(k + 1) − 1."""
    lines, by_bounce, totals, shadows = [], {1: [], 3: []}, [], []
    for r in _mine(rows):
        if r.method != "whitted" or field(r, "bounce_1") is None:
            continue
        limit = r.query_knobs["bounces"]
        counts = [field(r, f"bounce_{k}") for k in range(1, limit + 1)]
        for k, found in by_bounce.items():
            if k <= limit and counts[k - 1] is not None:
                found.append(counts[k - 1])
        totals.append(field(r, "all_rays") / (2 ** (limit + 1) - 1))
        shadow = field(r, "shadow_rays")
        shadows.append(shadow)
        lines.append((r.dataset, r.query_set, limit, *[counts[k] if k < limit else None for k in range(3)], field(r, "all_rays"), shadow))
    statements = []
    for k, words in ((1, "at most 2 rays for each primary ray at the first bounce"), (3, "at most 2³ at the third")):
        if by_bounce[k]:
            most = max(by_bounce[k])
            statements.append((words, most, len(by_bounce[k]), most <= 2**k * (1 + ROUNDING)))
    if totals:
        statements.append(("all rays together over 2^(k + 1) − 1, k being the last bounce", max(totals), len(totals),
                           max(totals) <= 1 + ROUNDING))  # fmt: skip
    heads = ("room", "query set", "bounces", "rays at bounce 1", "at 2", "at 3", "all rays", "shadow rays, on top")
    coverage = f"{len(lines)} rows; up to {max(shadows):.3g} shadow rays a primary ray are not counted" if lines else ""
    return verdict_of(claim, statements, (heads, lines), coverage, figure="most rays for a primary ray", unit="rows")


def textbook_unbiased(claim, rows):
    """The pseudo-code as it is printed and put right, each by the worst z over the rooms."""
    found, lines = {}, []
    for r in _mine(rows):
        z = field(r, "z")
        if not r.method.startswith("textbook_") or z is None or r.hard or samples(r) < 16:
            continue
        slip = r.query_knobs.get("slip")
        words = SLIPS.get(slip, slip) if r.method == "textbook_literal" else "put right in all of this"
        found.setdefault(words, []).append(r)
        lines.append((r.dataset, r.query_set, r.method, knob_text(r.query_knobs), r.bias, z))
    statements = []
    for words in (*SLIPS.values(), "put right in all of this"):
        if mine := found.get(words):
            worst = max(mine, key=lambda r: abs(field(r, "z")))
            z = field(worst, "z")
            statements.append((f"{words} ({_off(worst, mine)})", z, len(mine), abs(z) <= CHANCE))
    heads = ("room", "query set", "method", "asked with", "bias of all, relative", "z; of walls, the one farthest off")
    return verdict_of(claim, statements, (heads, lines), f"{len(lines)} rows; unbiased: |z| of at most {CHANCE} in all",
                      figure="z, the mean's distance from the truth in standard errors, where it is largest; of walls, of the one farthest off", unit="rows")  # fmt: skip


def _off(worst, rows):
    """What is farthest off, with the bias that belongs to its z. Of walls there is a z each, and the row's bias is that of
    all together: then the worst image's is told, too."""
    told = lambda r: f"bias {100 * r.bias:+.2f} %"
    if worst.query_set != "walls":
        return told(worst)
    image = max((r for r in rows if r.query_set != "walls"), key=lambda r: abs(field(r, "z")), default=None)
    return "a wall of the box" + (f"; of images {told(image)} at z {field(image, 'z'):.3g}" if image else "")


KINDS = {"rays_multiply": rays_multiply, "textbook_unbiased": textbook_unbiased}
