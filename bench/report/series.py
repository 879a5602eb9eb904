"""Charts of a task that no choice above it changes: how threads share the work, and what a change costs by the batch.

Both are made from rows like all others: thread scaling from those of `--scaling` (query sets that end in "_threads"),
batches from rows that carry the field <task>_batch.
"""

from dataclasses import dataclass

from bench.report import charts, fields
from bench.report.frontier import right
from bench.report.units import several

alt = charts.alt


@dataclass
class Figure:
    """One chart, with its data in it."""

    name: str
    title: str
    dataset: str
    chart: object


@dataclass
class Card:
    """Charts that stand together under one caption."""

    name: str
    title: str
    caption: str
    figures: list
    methods: tuple = ()  # that need a legend


def cards(task, numbers, width="container", legend=False):
    """All cards of a task that its rows can fill. numbers: {id(row): its number in the page's table}."""
    made = (_threads(task, numbers, width, legend), _batches(task, numbers, width, legend),
            _resolutions(task, numbers, width, legend))
    return [card for card in made if card and card.figures]


# ---- threads -----------------------------------------------------------------------------------------------------

BUILD = "build_threads"  # the set of builds that were repeated
THREADS = """Each method's fastest right configuration on one thread (its fastest, where nothing is right or wrong), and
how many times faster the same is on {threads}: every method's queries are shared out alike, {queries} of them; builds are
shared out by those that offer it. A mark on the dashed line gained nothing. Lines span what the repetitions' intervals allow;
a build that was timed once has none."""


def _threads(task, numbers, width, legend):
    rows = [r for r in task.scaling if r.run == task.scaling[0].run]
    most, many = max((r.threads for r in rows), default=1), len({r.threads for r in rows} - {1}) > 1
    if most < 2:
        return None
    figures = []
    for dataset in dict.fromkeys(r.dataset for r in rows):
        of_dataset = [r for r in rows if r.dataset == dataset]
        size = max(r.size for r in of_dataset)
        here = [r for r in of_dataset if r.size == size]
        where = f"{dataset}, {several(size, task.text.element)}"
        for query_set in dict.fromkeys(r.query_set for r in here):
            values = _speedups([r for r in here if r.query_set == query_set], numbers, "query_ns", many)
            figures.append((f"{query_set.removesuffix('_threads')}: {where}", dataset, query_set, values))
        if not any(r.query_set == BUILD for r in here):  # that set repeats what other rows tell once
            figures.append((f"build: {where}", dataset, "build", _speedups(here, numbers, "build_s", many)))
    asked = sorted({r.queries for r in rows if r.queries and r.query_set != BUILD})
    asked = " to ".join(f"{n:,}" for n in dict.fromkeys((asked[:1] + asked[-1:]))) or "some"
    on = "several, whose number stands beside its mark" if many else f"{most} threads"
    out = []
    for title, dataset, what, values in figures:
        if values:
            methods = [m for m in task.looks if any(v["method"] == m for v in values)]
            looks = {m: task.looks[m] for m in methods}
            reach = max(most, *(v["end"] for v in values))
            chart = charts.speedup_chart(alt.Data(values=values), reach, methods, looks, legend, width)
            out.append(Figure(f"{task.name}-threads-{dataset}-{what}", title, dataset, chart))
    return Card(f"{task.name}-card-threads", "Threads", THREADS.format(queries=asked, threads=on), out)


def speedups(rows, figure):
    """[(row on several threads, times faster than on one, lowest, highest)], one configuration a method."""
    found = []
    for method in dict.fromkeys(r.method for r in rows):
        mine = [r for r in rows if r.method == method and getattr(r, figure) is not None and r.status == "ok"]
        alone = [r for r in mine if r.threads == 1]
        alone = [r for r in alone if right(r)] or alone  # builds have no error, and noise is neither right nor wrong
        if not alone:
            continue
        first = min(alone, key=lambda r: getattr(r, figure))
        seen = set()
        for r in mine:
            if r.threads > 1 and r.threads not in seen and r.configuration == first.configuration:
                seen.add(r.threads)
                low = high = None
                if figure == "query_ns" and None not in (r.query_ns_low, r.query_ns_high, first.query_ns_low,
                                                         first.query_ns_high):  # fmt: skip
                    low, high = first.query_ns_low / r.query_ns_high, first.query_ns_high / r.query_ns_low
                found.append((r, getattr(first, figure) / getattr(r, figure), low, high))
    return found


def _speedups(rows, numbers, figure, many):
    """many: thread counts above one, so that labels must tell which."""
    return [{"i": numbers[id(r)], "method": r.method, "speedup": times, "lo": low, "hi": high,
             "end": high or times, "label": f"{times:.2f}×" + (f" on {r.threads}" if many else "")}
            for r, times, low, high in speedups(rows, figure)]  # fmt: skip


# ---- batches -----------------------------------------------------------------------------------------------------

BATCHES = """What it costs that a point comes or goes, against how many come and go at once: the whole life of a cloud,
divided by its points that came and went; the oldest go, and nothing is asked. Building anew costs as much for one point
as for all, so its line falls; trees whose parts are rebuilt share that out. Where the lines cross, updating stops to
pay. What the queries lose by it is asked in the query sets asked16 (queries between batches) and knn8_after (queries
alone) below. Each mark is the method's fastest right configuration."""


def batch_points(task, rows):
    """[(row, batch)] of sets without queries, the fastest right configuration of each method and batch."""
    best = {}
    for r in rows:
        batch = r.extra.get(f"{task.name}_batch")
        if batch is None or not right(r) or not (r.query_set or "").startswith(("single", "batches")):
            continue
        key = r.method, batch
        if key not in best or r.query_ns < best[key].query_ns:
            best[key] = r
    return [(r, batch) for (_, batch), r in sorted(best.items(), key=lambda item: item[0])]


def _batches(task, numbers, width, legend):
    rows = [r for r in task.soft if r.run == (task.runs or [0])[0] and r.threads == (task.threads or [None])[0]]
    out, methods = [], []
    for dataset in task.datasets:
        size = max((r.size for r in rows if r.dataset == dataset), default=0)
        found = batch_points(task, [r for r in rows if r.dataset == dataset and r.size == size])
        if len({batch for _, batch in found}) < 2:
            continue
        low = lambda r: r.query_ns if r.query_ns_low is None else r.query_ns_low
        high = lambda r: r.query_ns if r.query_ns_high is None else r.query_ns_high
        values = [{"i": numbers[id(r)], "method": r.method, "x": r.query_ns, "lo": low(r), "hi": high(r), "n": batch}
                  for r, batch in found]  # fmt: skip
        looks = {m: look for m, look in task.looks.items() if any(v["method"] == m for v in values)}
        methods += looks
        chart = charts.scaling_chart(alt.Data(values=values), looks, task.text.element, "point that comes or goes",
                                     legend, width, 300, f"{task.text.element}s in a batch")  # fmt: skip
        title = f"{dataset}, {several(size, task.text.element)} there at a time"
        out.append(Figure(f"{task.name}-batches-{dataset}", title, dataset, chart))
    return Card(f"{task.name}-card-changes", "Changes", BATCHES, out, tuple(methods))


# ---- resolutions -------------------------------------------------------------------------------------------------


def _resolutions(task, numbers, width, legend):
    if task.name != "distance_field":
        return None
    found = fields.figures(task, numbers, width, legend)
    drawn = {method for *_, looks in found for method in looks}
    methods = tuple(m for m in task.looks if m in drawn)
    return Card(f"{task.name}-card-resolution", "Resolution", fields.CAPTION, [Figure(*figure) for *figure, _ in found], methods)
