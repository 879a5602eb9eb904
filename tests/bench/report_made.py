"""Rows made by hand, for the tests of the report."""

import tempfile
from pathlib import Path

import report_fixture as fixture
from bench.report import rows

METHOD = ("kd_tree", "kd", "ours", "exact")
PEER = ("nanoflann", "kd", "peer", "exact")
LOOSE = ("forest", "forest", "peer", "approximate")


def made(method=METHOD, ns=100.0, error=0.0, *, low=None, high=None, dataset="cube", n=1000, query_set="k8", build=None,
         query=None, status="ok", **values):  # fmt: skip
    figures = {"query_ns": ns, "query_ns_low": low, "query_ns_high": high, "error": error, "error_floor": 1e-7}
    return fixture.row("knn", f"{dataset}:{n}", dataset, n, method, query_set, build or {}, query or {},
                       status=status, **(figures | values))  # fmt: skip


def read(*entries):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rows.jsonl"
        fixture.write(path, entries)
        return rows.read([path])


def read_text(text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rows.jsonl"
        path.write_text(text)
        return rows.read([path])
