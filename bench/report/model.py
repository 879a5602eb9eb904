"""The data that the page carries: every row once, compact, and the specification of every chart."""

from collections import Counter, defaultdict
from functools import cached_property

from bench.report import charts, tasks
from bench.report.advice import asked_sets
from bench.report.frontier import COARSE, charted, floor_of, promises, shown_error
from bench.report.layout import NOTE_MOST, Layout, marks
from bench.report.palette import looks
from bench.report.rows import knob_text
from bench.report.units import figure

TEXT = ("task", "dataset", "set", "method", "build", "query", "status", "reason", "claim", "source", "version", "extra")
COLUMNS = TEXT + (
    "size", "n", "run", "threads", "ns", "lo", "hi", "cpu", "reps", "build_s", "bytes", "kept", "error", "error_max",
    "error_p99", "error_mean", "bias", "floor", "nodes", "leaves", "primitives", "recall", "front", "promise", "best",
    "y", "slot", "advised", "built",
)  # fmt: skip


class TaskModel:
    """One task's rows with what its charts share."""

    def __init__(self, name, rows, all_looks=None):
        self.name, self.text = name, tasks.text(name)
        self.rows = rows
        self.soft = [r for r in rows if not (r.hard or r.scaling)]
        self.scaling = [r for r in rows if r.scaling]
        mine = {r.method for r in rows}
        self.looks = {m: look for m, look in (all_looks or looks(rows)).items() if m in mine}
        self.by_dataset = defaultdict(list)
        for row in self.soft:
            self.by_dataset[row.dataset].append(row)
        self.datasets = list(self.by_dataset)
        self.query_sets = list(dict.fromkeys(r.query_set for r in self.soft if r.query_set))
        self.sizes = sorted({r.size for r in self.soft})
        self.runs = sorted({r.run for r in self.soft})
        self.threads = sorted({r.threads for r in self.soft if r.threads is not None})
        self.layouts = {d: Layout(self.of(d), self.looks) for d in self.datasets}

    @cached_property
    def telling_set(self):
        """The query set to show first: of those that advice asks about, the one in which most rows trade accuracy for
        speed."""
        inexact = Counter(r.query_set for r in self.soft if charted(r) and shown_error(r))
        return max(asked_sets(self.soft), key=lambda s: inexact[s], default=next(iter(self.query_sets), None))

    def of(self, dataset):
        return self.by_dataset.get(dataset, [])

    def methods(self, dataset, figure):
        known = {r.method for r in self.of(dataset) if getattr(r, figure) is not None}
        return [m for m in self.looks if m in known]


def task_models(rows):
    """A method looks the same in every task."""
    shared = looks(rows)
    return [TaskModel(t, [r for r in rows if r.task == t], shared) for t in dict.fromkeys(r.task for r in rows)]


def bytes_title(task):
    """What the axis counts: where it is known what an index needs beside itself, all that a query needs."""
    title = f"bytes per {task.text.element}, log"
    if not any(kept(r) is not None for r in task.soft):
        return title
    own = f"mark: with the user's {task.text.element}s, if needed"
    return [title, own, "line: from the index alone"]


def chart_list(task):
    """(id, kind, dataset, chart fed by name) for every chart of a task that has data."""
    data, text = charts.alt.NamedData("points"), task.text
    for k, dataset in enumerate(task.datasets):
        rows = task.of(dataset)
        layout = task.layouts[dataset]
        if any(layout.y(r) is not None for r in rows):
            chart = charts.frontier_chart(data, layout, task.looks, text.query)
            yield f"{task.name}-{k}-frontier", "frontier", dataset, chart
        if methods := task.methods(dataset, "build_s"):
            chart = charts.lanes_chart(data, "build", build_title(task), methods, task.looks)
            yield f"{task.name}-{k}-build", "build", dataset, chart
        if methods := task.methods(dataset, "bytes"):
            chart = charts.lanes_chart(data, "bytes", bytes_title(task), methods, task.looks)
            yield f"{task.name}-{k}-bytes", "bytes", dataset, chart
        if len({r.size for r in rows if r.query_ns is not None}) > 1:
            chart = charts.scaling_chart(data, task.looks, text.element, text.query)
            yield f"{task.name}-{k}-scaling", "scaling", dataset, chart


def work(row):
    """(nodes, primitives) per query; rows write them as an object, a list or two fields."""
    value = row.values.get("work")
    if isinstance(value, dict):
        return value.get("nodes"), value.get("primitives")
    if isinstance(value, list) and len(value) == 2:
        return tuple(value)
    return row.values.get("work_nodes"), row.values.get("work_primitives")


def kept(row):
    """Bytes of the user's own data that must stay beside the index; None where that is not known."""
    return row.values.get("input_bytes")


def _build_of(row):
    return row.run, row.threads, row.block, row.method, knob_text(row.build_knobs)


def built_again(task):
    """{a build: ns per element} of the query set that makes the structure anew, repeated and in memory of its own: a build
    that is timed once pays for the first touch of its memory, too. A query of that set is an element."""
    return {_build_of(r): r.query_ns for r in task.soft if r.query_set == "build" and r.status == "ok" and r.query_ns}


def built(row, again):
    """ns per element of a row's build, or None."""
    if row.build_s is None or not row.n:
        return None
    return again.get(_build_of(row), row.build_s * 1e9 / row.n)


def build_title(task):
    title = f"build time per {task.text.element}, log"
    return [title, "made anew in its own memory, where that was measured"] if built_again(task) else title


APART = ("recall", "leaves")  # figures of tasks that have a place of their own


def extra(row, name):
    """One of the task's own figures, or None."""
    return row.extra.get(f"{row.task}_{name}")


def extra_text(row):
    """The task's own figures but for those: "missing 0.01, checked 100"."""
    named = {k.removeprefix(row.task + "_"): v for k, v in row.extra.items() if v is not None}
    shown = ((k.replace("_", " "), v) for k, v in named.items() if k not in APART)
    return ", ".join(f"{k} {figure(v) if isinstance(v, (int, float)) else v}" for k, v in shown)


def y_of(task, row):
    """Where the charts of its dataset show a row; those of thread scaling have no place there."""
    return None if row.scaling else task.layouts[row.dataset].y(row)


def numbers(models):
    """{id of a row: its number in the table}."""
    listed = (r for task in models for r in (*task.soft, *task.scaling))
    return {id(r): i for i, r in enumerate(listed)}


def table(models):
    """Every row of the charts, as lists in the order of COLUMNS; texts are indices into `strings`."""
    strings, lines = {}, []
    for task in models:
        again = built_again(task)
        front, best, slots = marks(task.soft)
        for r in (*task.soft, *task.scaling):
            nodes, primitives = work(r)
            texts = (r.task, r.dataset, r.query_set or "", r.method, knob_text(r.build_knobs), knob_text(r.query_knobs),
                     r.status, r.reason or "", r.claim, r.source, r.peer_version or "", extra_text(r))  # fmt: skip
            lines.append([strings.setdefault(t, len(strings)) for t in texts] + [
                r.size, r.n, r.run, r.threads, r.query_ns, r.query_ns_low, r.query_ns_high, r.query_cpu_ns,
                len(r.samples or ()), r.build_s, r.bytes, kept(r), r.error, r.error_max, r.error_p99, r.error_mean, r.bias,
                floor_of(r), nodes, extra(r, "leaves"), primitives, extra(r, "recall"), int(id(r) in front),
                int(promises(r)), int(id(r) in best), y_of(task, r), slots.get(id(r)), int(bool(r.values.get("advised"))),
                built(r, again),
            ])  # fmt: skip
    return {
        "columns": COLUMNS,
        "least": charts.LEAST,
        "note_most": NOTE_MOST,
        "text_columns": len(TEXT),
        "strings": list(strings),
        "rows": lines,
    }


def points(task, rows):
    """The points of some rows, as the charts read them; page/data.js does the same."""
    front, best, slots = marks(task.soft)
    again = built_again(task)
    for i, r in enumerate(rows):
        ns = built(r, again)
        yield {
            "i": i, "method": r.method, "x": r.query_ns,
            "lo": r.query_ns if r.query_ns_low is None else r.query_ns_low,
            "hi": r.query_ns if r.query_ns_high is None else r.query_ns_high,
            "y": task.layouts[r.dataset].y(r), "front": id(r) in front, "promise": promises(r), "coarse": floor_of(r) > COARSE, "best": id(r) in best,
            "slot": slots.get(id(r)), "n": r.n, "cells": (r.build_knobs or {}).get("resolution"),
            "asked": knob_text(r.query_knobs),
            "build": None if ns is None else max(ns, charts.LEAST),
            "bytes": max((r.bytes + (kept(r) or 0)) / r.n, charts.LEAST) if r.bytes is not None and r.n else None,
            "own": max(r.bytes / r.n, charts.LEAST) if r.bytes is not None and r.n else None,
        }  # fmt: skip
