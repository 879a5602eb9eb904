"""Claims about sizes and answers, rather than about who is faster: memory and build time, nodes, tests that leak.

A kind is a function from a claim of claims.json and the rows to a verdict. Each makes statements, which rows support or
not: all do and the claim holds, some and it holds only if, none and it does not hold.
"""

from collections import defaultdict

from bench.report.claims import FAILS, HOLDS, NEAR, ONLY_IF, Verdict, mean

WORD_BYTES = 4  # an integer, or a float
TEXTBOOK_NODE = {"kd": ("one integer and one float", 2), "bsp": ("a plane, four floats", 4), "bvh": ("a box, six floats", 6)}


def verdict_of(claim, statements, table=(), coverage="", **words):
    """statements: (words, figure, count, supports)."""
    verdict = Verdict(claim["id"], claim["sentence"], claim["experiment"], figures=statements, table=table,
                      coverage=coverage, **words)  # fmt: skip
    supporting = [s[0] for s in statements if s[3]]
    if statements:
        verdict.word = HOLDS if len(supporting) == len(statements) else ONLY_IF if supporting else FAILS
    if verdict.word == ONLY_IF:
        verdict.condition = "; ".join(supporting)
    return verdict


def builds(rows, task, method):
    """{(run, dataset, size): the row of this method's first build}, one query set being enough."""
    found = {}
    for row in rows:
        damaged = "+" in row.dataset
        if row.task == task and not (row.hard or damaged) and row.method == method and row.build_s and row.bytes:
            found.setdefault((row.run, row.dataset, row.size), row)
    return found


def figure_of(row, name):
    """A figure of a build, per element where it grows with them."""
    if name == "references":
        value = row.extra.get(f"{row.task}_references")
        return value / row.n if value else None
    return getattr(row, name)


NAMES = {"build_s": "build time", "bytes": "memory", "references": "references to a triangle"}


PURPOSES = {"ray": "", "closest_point": ", for closest points", "inside": ", for points inside"}


def dearer(claim, rows):
    """One method costs more than another, in each of the figures named; in other tasks, their kin ("also")."""
    lines, statements = [], []
    for task, (dear_name, cheap_name) in {claim["task"]: (claim["dearer"], claim["cheaper"]), **claim.get("also", {})}.items():
        dear, cheap = builds(rows, task, dear_name), builds(rows, task, cheap_name)
        ratios = defaultdict(list)
        for key in sorted(dear.keys() & cheap.keys(), key=lambda k: k[1:]):
            line = [task, key[1], key[2]]
            for name in claim["figures"]:
                a, b = figure_of(dear[key], name), figure_of(cheap[key], name)
                if a and b:
                    ratios[name].append(a / b)
                line += [a, b, a / b if a and b else None]
            lines.append(line)
        for name in claim["figures"]:
            if found := ratios[name]:
                all_dearer = mean(found) > NEAR and all(r > 1 / NEAR for r in found)
                statements.append((NAMES[name] + PURPOSES[task], mean(found), len(found), all_dearer))
    heads = ["task", "dataset", "size"]
    for name in claim["figures"]:
        heads += [f"{NAMES[name]}, {claim['dearer']}", f"{claim['cheaper']}", "ratio"]
    meshes = len({tuple(line[1:3]) for line in lines})
    return verdict_of(claim, statements, (heads, lines), f"{meshes} meshes",
                      figure=f"{claim['dearer']}'s over {claim['cheaper']}'s", unit="meshes")  # fmt: skip


def nodes(claim, rows):
    """What an inner node of each family holds, and what a primitive costs in each; in other tasks ("also"), too."""
    lines, statements = [], []
    for task in (claim["task"], *claim.get("also", ())):
        by_method = defaultdict(list)
        for row in rows:
            size = row.extra.get(f"{task}_node_bytes")
            if row.task == task and not row.hard and size and row.source == "ours" and row.bytes:
                by_method[row.method, size].append(row)
        smallest = {}
        for (method, size), mine in by_method.items():
            per_element = mean([r.bytes / r.n for r in mine])
            lines.append((task, method, mine[0].family, size, per_element, len({(r.dataset, r.size) for r in mine})))
            smallest[mine[0].family] = min(size, smallest.get(mine[0].family, size))
        for family, (words, count) in TEXTBOOK_NODE.items():
            if family in smallest:
                exact = smallest[family] == count * WORD_BYTES
                words = f"{family.upper()} inner node holds {words}: {count * WORD_BYTES} bytes and no more{PURPOSES[task]}"
                statements.append((words, smallest[family], 1, exact))
        if set(TEXTBOOK_NODE) <= set(smallest):
            order = smallest["kd"] < smallest["bsp"] < smallest["bvh"]
            words = f"a KD node is smaller than a BSP node, and that than a BVH node{PURPOSES[task]}"
            statements.append((words, smallest["bvh"] / smallest["kd"], 3, order))
    heads = ("task", "method", "family", "bytes of an inner node", "bytes of the tree per triangle", "meshes")
    return verdict_of(claim, statements, (heads, lines), figure="bytes (of the last: BVH's over KD's)", unit="layouts")


def exact_test(claim, rows):
    """A test is exact: none of its answers on these hard cases differs from exact arithmetic, nor does any ray leak.

    Others that may do better are listed beside it.
    """
    lines, statements = [], []
    named = [claim["method"], *claim["beside"]]
    by_case = defaultdict(list)
    for row in rows:
        if row.task == claim["task"]:
            by_case[row.dataset, row.method].append(row)
    for case in claim["cases"]:
        for method in named:
            for row in by_case[case, method]:
                judged = row.extra.get(f"{row.task}_judged")  # none: it gave no answers
                if row.query_set not in claim["query_sets"] or not judged:
                    continue
                wrong = [1e6 * (row.extra.get(f"{row.task}_{k}") or 0) / judged for k in ("surplus", "missing")]
                leaks = row.extra.get(f"{row.task}_leaks_per_million")
                # Leaks are counted over all rays, the rest over those judged: where both tell the same, the former do.
                worst = sum(wrong) if leaks is None else max(wrong[0], leaks)
                knobs = ", ".join(f"{k} {v}" for k, v in (row.build_knobs or {}).items())
                lines.append((case, method, knobs, row.claim, *wrong, leaks, row.extra.get(f"{row.task}_t_ulp_max")))
                if method == claim["method"]:
                    statements.append((case, worst, judged, worst == 0))
    heads = ("hard case", "method", "built with", "claims", "hits too many per million", "hits missed per million",
             "leaks per million", "worst t in ulp")  # fmt: skip
    return verdict_of(claim, statements, (heads, lines), f"{len(statements)} hard cases",
                      figure="wrong answers per million", unit="rays judged")  # fmt: skip


KINDS = {"dearer": dearer, "nodes": nodes, "exact_test": exact_test}
