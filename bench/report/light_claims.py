"""Claims about surfaces and light, L1 to L7: statements that rows of the task brdf_integral support or not."""

from math import pi

from bench.report.measures import verdict_of
from bench.report.rows import knob_text

TASK = "brdf_integral"
NEAR = 0.01  # relative, or of all light: less is none
ROUNDED = 1e-3  # what float leaves of a law, near the mirror's direction of a smooth surface
HEADS = ("dataset", "query set", "method", "built with", "asked with", "figure", "value")


class Claim:
    """Statements as they come, and the rows that they rest on."""

    def __init__(self, claim, rows, figure, unit="rows"):
        mine = [r for r in rows if r.task == TASK and r.status == "ok" and not r.hard]
        self.rows = [r for r in mine if r.run == mine[0].run]
        self.claim, self.figure, self.unit = claim, figure, unit
        self.statements, self.lines = [], []

    def find(self, dataset=None, query_set=None, method=None, **build):
        """Those that fit; a name that ends in an underscore is the beginning of others'."""
        fits = lambda name, wanted: wanted is None or (name.startswith(wanted) if wanted.endswith("_") else name == wanted)
        return [r for r in self.rows if fits(r.dataset, dataset) and fits(r.query_set, query_set) and fits(r.method, method)
                and all((r.build_knobs or {}).get(k) == v for k, v in build.items())]  # fmt: skip

    def say(self, words, rows, name, value, supports, worst=lambda r, v: abs(v)):
        """value: of a row. The statement's figure is that of the row that is worst."""
        known = [(r, v) for r in rows if (v := value(r)) is not None]
        if not known:
            return
        self.lines += [(r.dataset, r.query_set, r.method, knob_text(r.build_knobs), knob_text(r.query_knobs), name, v)
                       for r, v in known]  # fmt: skip
        figure = max(known, key=lambda pair: worst(*pair))[1]
        self.statements.append((words, figure, len(known), supports(figure)))

    def verdict(self):
        return verdict_of(self.claim, self.statements, (HEADS, self.lines), f"{len(self.lines)} rows of the task {TASK}",
                          figure=self.figure, unit=self.unit)  # fmt: skip


def own(name):
    return lambda r: r.extra.get(f"{TASK}_{name}")


FACING, FLAT = ("sphere", "disc", "triangle", "rectangle"), ("disc", "triangle", "rectangle")
DISTANCES = (1, 3, 10, 30)


def solid_angle(claim, rows):
    """What spheres and hemispheres are, and how far area / r² is off, by distance and tilt."""
    c = Claim(claim, rows, "steradians; or largest relative error")
    truth = own("truth")
    c.say("all around there are 4π", c.find("solid_angles", "all_around", "solid_angle"), "steradians", truth,
          lambda v: abs(v / (4 * pi) - 1) < 1e-6)  # fmt: skip
    c.say("above a plane there are π/2", c.find("solid_angles", "hemisphere", "solid_angle"), "steradians", truth,
          lambda v: abs(v / (pi / 2) - 1) < 1e-6)  # fmt: skip
    for distance in DISTANCES:
        for words, sets, method in (
            (f"area / r² of what faces the viewer, {distance} radii away, is right within 1 %",
             [f"{s}_{distance}" for s in FACING], "area_over_r2"),
            (f"area / r² of what may be tilted by up to 75°, {distance} radii away, is right within 1 %",
             [f"{s}_tilted_{distance}" for s in FLAT], "area_over_r2"),
            (f"area / r² times the cosine of the tilt, {distance} radii away, is right within 1 %",
             [f"{s}_tilted_{distance}" for s in FLAT], "projected_area_over_r2"),
        ):  # fmt: skip
            found = [r for s in sets for r in c.find("solid_angles", s, method)]
            c.say(words, found, "largest relative error", lambda r: r.error_max, lambda v: v <= NEAR)
    return c.verdict()


GOOD = 0.05  # of the light


def schlick(claim, rows):
    c = Claim(claim, rows, "largest error, share of the light")
    for r in c.find("fresnel", None, "schlick"):
        c.say(f"{r.query_set.replace('_', ' ')}: within {GOOD}", [r], "largest error", lambda r: r.error_max, lambda v: v <= GOOD)
    return c.verdict()


HALO = 40  # degrees off the mirror's direction


def halo(claim, rows):
    """At equal roughness: what Beckmann's and GGX's facets send far off the mirror's direction."""
    c = Claim(claim, rows, "share of the light")
    beyond = own(f"beyond_{HALO}")
    alpha = lambda r: r.dataset.rpartition("_")[2]
    facets = {kind: [r for r in c.find(f"{kind}_", "albedo", "quadrature_facets") if beyond(r) is not None and r.query_knobs == {"nodes": 32}]
              for kind in ("beckmann", "ggx")}  # fmt: skip
    for soft in facets["beckmann"]:
        for hard in (r for r in facets["ggx"] if r.dataset.count("_") == 1 and alpha(r) == alpha(soft)):
            c.say(f"at α = {alpha(soft)}, of Beckmann's light less than 0.1 % leaves more than {HALO}° off the mirror's direction",
                  [soft], f"beyond {HALO}°", beyond, lambda v: v < 1e-3)  # fmt: skip
            c.say(f"at α = {alpha(hard)}, of GGX's more than 1 % does", [hard], f"beyond {HALO}°", beyond, lambda v: v > 0.01)
    return c.verdict()


def grazing(claim, rows):
    c = Claim(claim, rows, "largest share of the light reflected", "rows")
    most = own("answer_max")
    for r in c.find(None, "albedo", "unmasked"):
        c.say(f"{r.dataset}: without masking, grazing viewers see more light than there is", [r], "largest albedo", most,
              lambda v: v > 1 + NEAR)  # fmt: skip
        masked = [x for x in c.find(r.dataset, "albedo", "quadrature_facets") if x.query_knobs == {"nodes": 32}]
        c.say(f"{r.dataset}: with Smith's nobody does", masked, "largest albedo", most, lambda v: v <= 1 + 1e-4)
    return c.verdict()


def white(row):
    """(roughness, share at normal incidence or None) of a set of the furnace."""
    kind, *numbers = row.query_set.split("_")
    return float(numbers[0]), float(numbers[1]) if kind == "colour" else None


def energy(claim, rows):
    """What facets that reflect all lose, by roughness; and what each colour term makes of those that do not."""
    c = Claim(claim, rows, "share of the light missing (below 0: or in excess)")
    furnace = {name: c.find("furnace", None, "compensated", compensation=name) for name in ("none", "kulla_conty", "textbook", "directional")}
    bare = sorted((r for r in furnace["none"] if r.query_set.startswith("white")), key=white)
    for before, r in zip([None, *bare], bare):
        more = before is None or r.bias < before.bias
        c.say(f"facets of roughness {white(r)[0]:g} lose light, and more than smoother ones", [r], "bias", lambda r: r.bias,
              lambda v: v < 0 and more)  # fmt: skip
    c.say("compensated, a white furnace stays white within 1 %, at every roughness",
          [r for r in furnace["kulla_conty"] if r.query_set.startswith("white")], "bias", lambda r: r.bias,
          lambda v: abs(v) <= NEAR)  # fmt: skip
    relative = lambda r: r.bias / own("truth")(r) if own("truth")(r) else None
    for name, words in (("textbook", "F̄Ē/(1−F̄(1−Ē))"), ("directional", "F̄E/(1−F̄(1−E)) by the viewer"), ("kulla_conty", "F̄²Ē/(1−F̄(1−Ē))")):
        for alpha in sorted({white(r)[0] for r in furnace[name]}):
            mine = [r for r in furnace[name] if r.query_set.startswith("colour") and white(r)[0] == alpha]
            c.say(f"the colour {words} is what bounces leave, within 2 %, at α = {alpha:g}", mine, "relative bias", relative,
                  lambda v: abs(v) <= 0.02)  # fmt: skip
    return c.verdict()


MODELS = {"lambert": "Lambert", "ggx": "GGX", "separable_ggx": "GGX, separable", "beckmann": "Beckmann",
          "separable_beckmann": "Beckmann, separable", "dielectric": "dielectric facets", "gold": "metal facets",
          "compensated_ggx": "Kulla–Conty", "textbook_ggx": "Kulla–Conty with the textbook's colour",
          "directional_ggx": "Kulla–Conty with the viewer's colour", "turquin_ggx": "Turquin's scaling"}  # fmt: skip


def model_of(row):
    """The recipe's name: the dataset's without its numbers."""
    return "_".join(part for part in row.dataset.split("_") if not part.replace(".", "").isdigit())


def laws(claim, rows):
    c = Claim(claim, rows, "largest violation")
    values = c.find(None, "evaluate", "scalar")
    c.say("no model is negative anywhere", values, "negative", own("negative"), lambda v: v == 0)
    c.say("light of two skies adds up", c.find(None, "albedo", None), "linearity", own("linearity"), lambda v: v < 1e-5)
    for model, words in MODELS.items():
        mine = [r for r in values if model_of(r) == model]
        c.say(f"{words}: reciprocal", mine, "reciprocity", own("reciprocity"), lambda v: v < ROUNDED)
    c.say("no viewer of a single bounce sees more light than there is", c.find(None, "albedo", "quadrature_facets"), "largest albedo",
          own("truth_max"), lambda v: v <= 1 + 1e-6)  # fmt: skip
    for name, words in (("kulla_conty", "Kulla–Conty"), ("textbook", "the textbook's colour"), ("directional", "the viewer's colour"),
                        ("turquin", "Turquin's scaling")):  # fmt: skip
        c.say(f"{words}: no more light leaves than with all bounces followed", c.find("furnace", None, "compensated", compensation=name),
              "bias", lambda r: r.bias, lambda v: v <= NEAR, worst=lambda r, v: v)  # fmt: skip
    return c.verdict()


def rotation(claim, rows):
    c = Claim(claim, rows, "largest relative change when both directions turn")
    for r in c.find(None, "evaluate", "scalar"):
        model = model_of(r)
        across = r.dataset.startswith(("ggx", "beckmann", "separable")) and r.dataset.removeprefix(model).count("_") > 1
        if across:
            c.say(f"{r.dataset}: turning the surface matters", [r], "rotation", own("rotation"), lambda v: v > 0.1)
        else:
            c.say(f"{r.dataset}: turning the surface changes nothing", [r], "rotation", own("rotation"), lambda v: v < ROUNDED)
    return c.verdict()


KINDS = {f"light_{f.__name__}": f for f in (solid_angle, schlick, halo, grazing, energy, laws, rotation)}
