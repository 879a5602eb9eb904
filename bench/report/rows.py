"""Reading rows: one flat JSON object a line, as bench/core/row.hpp writes them.

A broken row stops the reading with file and line; only a torn last line, as a killed run leaves it, is passed over
with a warning. Rows are merged by concatenation: a cell measured twice in one run counts once, the later row wins.
"""

import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

SCHEMA = 1
STATUSES = ("ok", "wrong", "refused", "crashed", "timeout", "out_of_memory", "unsupported", "not_built")
FAILURES = STATUSES[1:6]  # tried, and no right answer came out
ABSENT = STATUSES[6:]  # never tried
CLAIMS = ("exact", "bounded", "approximate", "stochastic")
SOURCES = ("ours", "peer")

# name: (types, may be null)
NUMBER = (int, float)
FIELDS = {
    "task": (str, False), "block": (str, False), "dataset": (str, False), "n": (int, False), "seed": (int, True),
    "dataset_hash": (str, True), "method": (str, False), "family": (str, True), "source": (str, False),
    "peer_version": (str, True), "claim": (str, False), "build_knobs": (dict, True), "query_knobs": (dict, True),
    "query_set": (str, True), "queries": (int, True), "threads": (int, True), "status": (str, False),
    "reason": (str, True), "build_s": (NUMBER, True), "query_ns": (NUMBER, True), "query_ns_low": (NUMBER, True),
    "query_ns_high": (NUMBER, True), "query_cpu_ns": (NUMBER, True), "samples": (list, True),
    "bytes": (NUMBER, True), "error": (NUMBER, True), "error_max": (NUMBER, True), "error_p99": (NUMBER, True),
    "error_mean": (NUMBER, True), "bias": (NUMBER, True), "error_floor": (NUMBER, True), "isa": (str, True),
    "flags": (str, True), "compiler": (str, True), "cpu": (str, True), "host": (str, True), "commit": (str, True),
}  # fmt: skip
WORST_IS_ONE = {("inside", None), ("distance_field", "uniform"), ("distance_field", "trace")}  # (task, set or all)
RUN_FIELDS = ("host", "cpu", "isa", "compiler", "commit", "seed")


class RowError(ValueError):
    """A row that cannot be used; its text names file, line and what is wrong."""


@dataclass
class Row:
    values: dict
    file: str = ""
    line: int = 0
    run: int = 0  # index into Rows.runs: rows of one run share machine, build and seed
    extra: dict = field(default_factory=dict)  # the task's own fields

    def __post_init__(self):
        self.__dict__.update({name: self.values[name] for name in FIELDS})  # plain attributes: they are read by the million
        if not WORST_IS_ONE.isdisjoint({(self.task, None), (self.task, self.query_set)}):
            self.error_max = None  # a wrong answer counts 1: the worst, which older rows state, says no more than the share

    def __getattr__(self, name):
        try:
            return self.values[name]
        except KeyError:
            raise AttributeError(name) from None

    @property
    def hard(self):
        return self.block.startswith("hard/")

    @property
    def scaling(self):
        """Of thread scaling, which has a chart of its own (see Task::scaling_blocks)."""
        return (self.query_set or "").endswith("_threads")

    @property
    def failed(self):
        return self.status in FAILURES

    @property
    def size(self):
        """The size that was asked for; n is what the recipe made of it."""
        tail = self.block.rpartition(":")[2]
        return int(tail) if tail.isdigit() and int(tail) else self.n

    @property
    def group(self):
        """Rows of one group answered the same queries on the same machine: only these are compared."""
        return (self.run, self.task, self.block, self.dataset_hash, self.query_set, self.threads)

    @cached_property
    def configuration(self):
        return (self.method, knob_text(self.build_knobs), knob_text(self.query_knobs))

    @property
    def key(self):
        return self.group + self.configuration


@dataclass
class Rows:
    rows: list
    runs: list  # one dict of RUN_FIELDS each
    warnings: list

    def __iter__(self):
        return iter(self.rows)

    def __len__(self):
        return len(self.rows)


def knob_text(knobs):
    return ", ".join(f"{name} {plain(value)}" for name, value in (knobs or {}).items())


def plain(value):
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)


def check(values, where):
    """Raises RowError unless values is a usable row."""
    if not isinstance(values, dict):
        raise RowError(f"{where}: a row must be a JSON object, this is {type(values).__name__}")
    if values.get("schema") != SCHEMA:
        raise RowError(f"{where}: schema is {values.get('schema')!r}, this report reads schema {SCHEMA}")
    for name, (types, nullable) in FIELDS.items():
        if name not in values:
            raise RowError(f"{where}: field '{name}' is absent")
        value = values[name]
        if value is None:
            if not nullable:
                raise RowError(f"{where}: field '{name}' is null")
        elif not isinstance(value, types) or (isinstance(value, bool) and types is not bool):
            raise RowError(f"{where}: field '{name}' is {value!r}")
        elif isinstance(value, float) and not math.isfinite(value):
            raise RowError(f"{where}: field '{name}' is {value}, which is no figure")
    for name, words in (("status", STATUSES), ("source", SOURCES), ("claim", CLAIMS)):
        if values[name] not in words:
            raise RowError(f"{where}: {name} is '{values[name]}', which is none of {', '.join(words)}")
    if values["status"] == "ok" and values["query_ns"] is None and values["query_set"]:
        if not values["block"].startswith("hard/"):
            raise RowError(f"{where}: status is ok, but query_ns is null")


def read(paths):
    """All rows of these files, in order."""
    found, warnings = {}, []
    for path in map(Path, paths):
        text = path.read_bytes().decode("utf-8", errors="replace")
        lines = text.split("\n")
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            where = f"{path}:{number}"
            try:
                values = json.loads(line)
            except json.JSONDecodeError as error:
                if number == len(lines):  # no newline after it: the writer was killed
                    warnings.append(f"{where}: the last line is torn and was left out")
                    continue
                raise RowError(f"{where}: not JSON: {error}") from None
            check(values, where)
            own = values["task"] + "_"
            row = Row(values, str(path), number, extra={k: v for k, v in values.items() if k.startswith(own)})
            run = tuple(values[name] for name in RUN_FIELDS)
            key = (run,) + row.key
            if key in found:
                warnings.append(f"{where}: replaces {found[key].file}:{found[key].line}, the same cell")
                del found[key]
            found[key] = row
    runs = {}
    for key, row in found.items():
        row.run = runs.setdefault(key[0], len(runs))
    return Rows(list(found.values()), [dict(zip(RUN_FIELDS, run)) for run in runs], warnings)
