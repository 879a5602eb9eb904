"""Claims about shadows, H1 to H13: each is taken apart into statements that rows of the task shadow support or not.

Most rest on scenes that have a closed form, or on hard cases that were made for one failure (see datasets_gen/hard); a
statement needs the rows of all the configurations that it names, else it is left out, and a claim of none is not run.
"""

from collections import defaultdict

from bench.report.measures import verdict_of
from bench.report.rows import knob_text

TASK = "shadow"
SOME = 0.01  # of the light, or of the pixels: less is none
ROOM = 1.1  # figures this near are alike


class Rows:
    """Rows of the task, by what they measured. Hard cases count by the name of their scene."""

    def __init__(self, rows):
        mine = [r for r in rows if r.task == TASK and r.status == "ok" and r.error is not None]
        first = mine[0].run if mine else 0
        self.rows = [r for r in mine if r.run == first]
        self.by_method = defaultdict(list)
        for r in self.rows:
            self.by_method[r.dataset.removeprefix("shadow_"), r.query_set, r.method].append(r)

    def find(self, dataset, query_set, method, build=None, query=None, also=False):
        """All that fit; knobs named must be equal, and no other unless `also`."""
        found = [r for r in self.by_method[dataset, query_set, method]
                 if _fits(r.build_knobs, build, True) and _fits(r.query_knobs, query, also)]  # fmt: skip
        return sorted(found, key=lambda r: r.hard)  # ordinary blocks first

    def one(self, *args, **kwargs):
        found = self.find(*args, **kwargs)
        return found[0] if found else None

    def datasets(self, query_set):
        return list(dict.fromkeys(r.dataset.removeprefix("shadow_") for r in self.rows if r.query_set == query_set))

    def best(self, dataset, query_set, method, query=None, error=lambda r: r.error):
        """The least error over builds and knobs, of the ordinary rows if there are some."""
        found = [r for r in self.find(dataset, query_set, method, query=query, also=True) if error(r) is not None]
        found = [r for r in found if not r.hard] or found
        return min(found, key=error, default=None)


def _fits(knobs, wanted, also):
    if wanted is None:
        return True
    knobs = knobs or {}
    return all(knobs.get(k) == v for k, v in wanted.items()) and (also or len(knobs) == len(wanted))


def field(row, name):
    return row.extra.get(f"{TASK}_{name}")


def line(row, name, value):
    return (row.dataset, row.query_set, row.method, knob_text(row.build_knobs), knob_text(row.query_knobs), name, value)


HEADS = ("scene", "query set", "method", "built with", "asked with", "figure", "value")


class Claim:
    """Statements as they come, and the rows that they rest on."""

    def __init__(self, claim, rows, figure, unit="rows"):
        self.claim, self.rows, self.figure, self.unit = claim, Rows(rows), figure, unit
        self.statements, self.lines = [], []

    def say(self, words, figure, supports, rows, name, value=None):
        """value: of a row; without, its field of that name."""
        get = value or (lambda r: field(r, name))
        self.lines += [line(r, name.replace("_", " "), get(r)) for r in rows]
        self.statements.append((words, figure, len(rows), supports))

    def verdict(self):
        return verdict_of(self.claim, self.statements, (HEADS, self.lines), f"{len(self.lines)} rows of the task shadow; figures within a tenth of each other are alike, shares up to {SOME:g} are none",
                          figure=self.figure, unit=self.unit)  # fmt: skip


STEEP, FLAT = "tilted_plane_85_0", "tilted_plane"


def acne(claim, rows):
    c = Claim(claim, rows, "false shadow, share of the plane")
    build = {"resolution": 1024}
    pair = [c.rows.one(d, "image", "shadow_map", build, {"bias": 0}) for d in (STEEP, FLAT)]
    if all(pair):
        a, b = (field(r, "false_dark") for r in pair)
        c.say("without bias, a plane lit at 85° has more false shadow than one at 60°", a, a > ROOM * b + SOME, pair, "false_dark")
    # Constants are shares of the depth range, which is longer at 85°: of all pairs, those where it has no less bias.
    steep, flat = ([r for r in c.rows.find(d, "image", "shadow_map", build) if set(r.query_knobs) == {"constant"}
                    and field(r, "figure_bias") is not None] for d in (STEEP, FLAT))  # fmt: skip
    pairs = [(a, b) for a in steep for b in flat if field(a, "figure_bias") >= field(b, "figure_bias")]
    pairs = [p for p in pairs if field(p[0], "false_dark") > SOME or field(p[1], "false_dark") > SOME]
    if pairs:
        a, b = min(pairs, key=lambda p: field(p[0], "figure_bias") / field(p[1], "figure_bias"))
        worse = field(a, "false_dark") > ROOM * field(b, "false_dark") + SOME
        c.say("under as much bias in metres, or more, it has more false shadow, too", field(a, "false_dark"), worse, [a, b], "false_dark")
    by_angle = [r for d in (STEEP, FLAT, "tilted_plane_60_45", "tilted_plane_88_0")
                if (r := c.rows.one(d, "image", "shadow_map", build, {"bias": 1}))]  # fmt: skip
    if by_angle:
        worst = max(field(r, "false_dark") for r in by_angle)
        c.say("a bias by the slope's bound leaves none", worst, worst == 0, by_angle, "false_dark")
    return c.verdict()


def contact(claim, rows):
    """The gap at a wall's foot grows with each kind of bias."""
    c = Claim(claim, rows, "gap under the most bias, metres")
    for knob, words in (("constant", "a constant bias"), ("bias", "a bias by the slope")):
        found = {}
        for r in c.rows.find("wall_on_floor", "contact", "shadow_map", build={"resolution": 1024}):
            if set(r.query_knobs) == {knob} and not r.hard:
                found[r.query_knobs[knob]] = r
        steps = [found[k] for k in sorted(found)]
        if len(steps) > 2:
            gaps = [field(r, "gap") for r in steps]
            grows = all(a <= b for a, b in zip(gaps, gaps[1:])) and gaps[-1] > gaps[0]
            c.say(f"the more of {words}, the longer the shadow that a contact loses", gaps[-1], grows, steps, "gap")
    return c.verdict()


BETWEEN = ("midpoint", "dual_depth", "second_depth")
CASTERS = ("slab_and_sheet", "open_casters", "wall_on_floor", "sphere_over_floor", "leaves", "city")


def second_depth(claim, rows):
    """Without bias, no more false shadow and no more false light than a plain map has under its bias."""
    c = Claim(claim, rows, "share of the pixels beyond the plain map's, on the worst scene", "scenes")
    for method in BETWEEN:
        pairs = []
        for dataset in CASTERS:
            own = c.rows.one(dataset, "image", method, {"resolution": 1024}, {"radius": 0, "bias": 0})
            plain = c.rows.one(dataset, "image", "shadow_map", {"resolution": 1024}, {"bias": 1})
            if own and plain:
                pairs.append((own, plain))
        for name, words in (("false_dark", "without bias {} has no more false shadow than a plain map with one"),
                            ("false_lit", "nor has {} more false light")) if pairs else ():  # fmt: skip
            worst = max(field(own, name) - field(plain, name) for own, plain in pairs)
            c.say(words.format(method), worst, worst <= SOME, [own for own, _ in pairs], name)
    return c.verdict()


def nobody(claim, rows):
    """There is no reason to use it: a map with bias is as right and as fast."""
    c = Claim(claim, rows, "error of the best of them over that of the plain map")
    for dataset in CASTERS:
        plain = c.rows.best(dataset, "image", "shadow_map")
        others = [r for m in BETWEEN if (r := c.rows.best(dataset, "image", m, {"radius": 0}))]
        if plain and others:
            best = min(others, key=lambda r: r.error)
            ratio = best.error / plain.error if plain.error else 1
            no_reason = plain.error <= ROOM * best.error
            c.say(f"on {dataset} the best plain map is as accurate", ratio, no_reason, [plain, best], "error",
                  lambda r: r.error)  # fmt: skip
    return c.verdict()


def cascades(claim, rows):
    c = Claim(claim, rows, "error")
    asked = {"radius": 0, "smooth": False, "plane": True}
    steps = []
    for n in (1, 2, 3, 4, 6):
        build = {"resolution": 512, "cascades": n, "lambda": 1, "fitted": True}
        if r := c.rows.one("city", "image", "cascades", build, asked):
            steps.append(r)
    if len(steps) < 3:
        return c.verdict()
    errors = [r.error for r in steps]
    c.say("on a street seen to its end, more cascades of the same size are never much worse", errors[-1],
          all(b <= ROOM * a for a, b in zip(errors, errors[1:])), steps, "error", lambda r: r.error)  # fmt: skip
    perfect = c.rows.one("city", "image", "centre_ray")
    if perfect:
        c.say("the most of them leave nothing but what a ray to the middle of the light is wrong by", min(errors),
              min(errors) <= ROOM * perfect.error, [steps[-1], perfect], "error", lambda r: r.error)  # fmt: skip
    return c.verdict()


def softens(claim, rows):
    c = Claim(claim, rows, "width of the widest filter over the narrowest; least error over the widest's")
    found = {}
    for r in c.rows.find("half_plane_edge", "edge", "pcf", {"resolution": 1024}):
        if (r.query_knobs or {}).get("smooth") and r.query_knobs.get("plane") and not r.hard:
            found[r.query_knobs["radius"]] = r
    steps = [found[k] for k in sorted(found)]
    widths = [field(r, "width") for r in steps]
    if len(steps) < 3 or None in widths:
        return c.verdict()
    c.say("the wider the filter, the wider the penumbra", widths[-1] / max(widths[0], 1e-9),
          all(a < b for a, b in zip(widths, widths[1:])), steps, "width")  # fmt: skip
    errors = [r.error for r in steps]
    c.say("the wider the filter, the nearer to a light of some size", min(errors) / errors[-1],
          all(b <= ROOM * a for a, b in zip(errors, errors[1:])), steps, "error", lambda r: r.error)  # fmt: skip
    return c.verdict()


def pcss(claim, rows):
    c = Claim(claim, rows, "width over the true one, less 1; or RMS error in penumbra")
    one = [r for d in ("half_plane_edge", "half_plane_edge_1_0.5", "half_plane_edge_3_0.5")
           if (r := c.rows.best(d, "edge", "pcss", {"plane": True}))]  # fmt: skip
    one = [r for r in one if field(r, "width_error") is not None]
    if one:
        worst = max((field(r, "width_error") for r in one), key=abs)
        c.say("under one straight blocker the width is as the formula has it, within a tenth", worst, abs(worst) <= 0.1, one,
              "width_error")  # fmt: skip
    if two := c.rows.best("edges_far_apart", "edge", "pcss"):
        wrong = field(two, "penumbra")
        c.say("so it is under two blockers far apart (RMS error below 0.05)", wrong, wrong <= 0.05, [two], "penumbra")
    return c.verdict()


def chebyshev(claim, rows):
    """With the formula taken at its word, and with the guard for t ≤ mean."""
    c = Claim(claim, rows, "RMS error of the share in shadow, or how many times another's")
    formula = {"below_mean": "formula"}
    for dataset in c.rows.datasets("image"):
        if not (r := c.rows.best(dataset, "image", "vssm", {"below_mean": "lit"})) or not (field(r, "penumbra_share") or 0):
            continue
        c.say(f"{dataset}: guarded, the share is right within 0.05", r.error, r.error <= 0.05, [r], "error", lambda r: r.error)
    for dataset in ("half_plane_edge", "sphere_over_floor", "leaves"):
        bare, guarded = (c.rows.best(dataset, "image", "vssm", q) for q in (formula, {"below_mean": "lit"}))
        if bare and guarded:
            c.say(f"{dataset}: where t ≤ mean the formula alone is worse than the guard (times its error)", bare.error / max(guarded.error, 1e-9),
                  bare.error > ROOM * guarded.error, [bare, guarded], "error", lambda r: r.error)  # fmt: skip
    return c.verdict()


def unoccluded(claim, rows):
    """What the assumption is worth: VSSM beside PCSS, which searches for its blockers."""
    c = Claim(claim, rows, "RMS error in penumbra over that of PCSS")
    for dataset in c.rows.datasets("image"):
        pair = [c.rows.best(dataset, "image", m, error=lambda r: field(r, "penumbra")) for m in ("vssm", "pcss")]
        if not all(pair) or (pair[0].extra.get("shadow_penumbra_share") or 0) < SOME:
            continue
        a, b = (field(r, "penumbra") for r in pair)
        c.say(f"{dataset}: VSSM's penumbra is no worse than that of a true search", a / b if b else 1, a <= ROOM * b + 1e-3, pair,
              "penumbra")  # fmt: skip
    return c.verdict()


LEAK = 0.1  # of the light: visible


def leaks(claim, rows):
    c = Claim(claim, rows, "most light in full shadow")
    for dataset in c.rows.datasets("leak"):
        for method, query, words, supports in (
            ("vsm", {"cut": 0}, "two moments leak more than a tenth", lambda v: v > LEAK),
            ("msm", {"alpha": 3e-7}, "four leak less than a tenth", lambda v: v <= LEAK),
        ):
            found = [r for r in c.rows.find(dataset, "leak", method, query=query) if (r.build_knobs or {}).get("radius", 0) >= 1]
            if found:
                worst = max(field(r, "max") for r in found)
                c.say(f"{dataset}: {words}", worst, supports(worst), found, "max")
    return c.verdict()


def volumes(claim, rows):
    c = Claim(claim, rows, "share of the pixels that are wrong")
    wrong = lambda r: (field(r, "false_lit") or 0) + (field(r, "false_dark") or 0)
    inside = ("eye_inside_volume_0", "eye_inside_volume_1.45")
    outside = ("open_casters", "non_manifold")
    for method, words, datasets, supports in (
        ("shadow_volumes_z_pass", "z-pass fails with the eye in shadow", inside, lambda v: v > SOME),
        ("shadow_volumes", "z-fail does not", inside, lambda v: v <= SOME),
        ("shadow_volumes", "nor on casters that are open or no manifold", outside, lambda v: v <= SOME),
    ):
        found = [r for d in datasets if (r := c.rows.one(d, "image", method))]
        if found:
            worst = max(map(wrong, found))
            c.say(words, worst, supports(worst), found, "false_share", wrong)
    for cut, words, datasets in (
        ("far", "z-fail works with a far plane at the end of the scene", inside),
        ("caps", "it works without the caps at the far end", inside),
        ("casters", "it works on open casters with the faces alone that look to the light", outside),
    ):
        found = [r for d in datasets if (r := c.rows.one(d, "image", "shadow_volumes_cut", build={"cut": cut}))]
        if found:
            worst = max(map(wrong, found))
            c.say(words, worst, worst <= SOME, found, "false_share", wrong)
    return c.verdict()


PENUMBRA = 0.05  # RMS error of a right one


def distance_fields(claim, rows):
    """One-sided, as the formula is, beside the share of a disc."""
    c = Claim(claim, rows, "RMS error in penumbra, or how many times another's")
    for dataset in ("half_plane_edge", "sphere_over_floor", "slit"):
        formula, disc = (
            min((r for r in c.rows.find(dataset, "image", "distance_field", query={"form": form})
                 if not r.hard and field(r, "penumbra") is not None), key=lambda r: field(r, "penumbra"), default=None)
            for form in ("one_sided", "disc"))  # fmt: skip
        if formula:
            error = field(formula, "penumbra")
            c.say(f"{dataset}: the least of k·sdf/t is a disc light's share, within {PENUMBRA}", error, error <= PENUMBRA, [formula],
                  "penumbra")  # fmt: skip
        if formula and disc:
            a, b = (field(r, "penumbra") for r in (formula, disc))
            c.say(f"{dataset}: no worse than a form that knows the disc, times its error, and right itself ({a:.2g}, within {PENUMBRA})", a / max(b, 1e-9),
                  a <= PENUMBRA and a <= ROOM * b, [formula, disc], "penumbra")  # as wrong as another is not right
    return c.verdict()


SPLIT_LIGHTS = ("0.05", "0.5", "1.5")  # radii of a disc 5 m away
SPLIT_ALPHAS = (0.5, 0.2, 0.1, 0.05)
UNSEEN = 1e-3


def split_field(alpha):
    """Of a diffuse surface without one."""
    return f"split_ggx_{alpha:g}" if alpha else "split"


def split_rows(rows):
    """(radius, row) of the ball under a disc, of each size that was measured."""
    for size in SPLIT_LIGHTS:
        found = rows.find(f"sphere_over_floor_{size}", "image", "unshadowed")
        found = found or (rows.find("sphere_over_floor", "image", "unshadowed") if size == "0.5" else [])
        if found and field(found[0], "split") is not None:
            yield size, found[0]


def split(claim, rows):
    """The error of the product by the size of the light and the roughness of the surface."""
    c = Claim(claim, rows, "RMS error of visibility taken out of the integral, or times that of a diffuse surface", "scenes")
    sizes = list(split_rows(c.rows))
    for size, r in sizes:
        error = field(r, "split")
        c.say(f"the light is a disc of radius {size} m, 5 m away, over a diffuse floor (below {UNSEEN:g})", error, error < UNSEEN, [r],
              "split")  # fmt: skip
    widest = sizes[-1][1] if sizes else None
    for alpha in SPLIT_ALPHAS if widest else ():
        name = split_field(alpha)
        told = [r for _, r in sizes if field(r, name) is not None]
        if field(widest, name) is not None:
            error, diffuse = field(widest, name), field(widest, "split")
            c.say(f"the surface is rougher than {alpha:g}: one as smooth, in its highlight under the widest of these, errs more than a diffuse "
                  "one (times its error)", error / max(diffuse, 1e-9), error > max(UNSEEN, ROOM * diffuse), told, name)  # fmt: skip
    verdict = c.verdict()
    verdict.coverage += "; under a light without extent it is exact by definition"
    return verdict


KINDS = {
    f"shadow_{f.__name__}": f
    for f in (acne, contact, second_depth, nobody, cascades, softens, pcss, chebyshev, unoccluded, leaks, volumes,
              distance_fields, split)
}  # fmt: skip
