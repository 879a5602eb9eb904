"""Comparing two runs, on rows made by hand."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

import report_fixture as fixture
from bench.report import compare
from report_made import made, read


class Comparing(unittest.TestCase):
    def kinds(self, a, b):
        return [c.kind for c in compare.compare(read(a), read(b))]

    def test_only_intervals_apart_are_a_change(self):
        base = made(ns=100, low=95, high=110)
        for ns, low, high, kind in ((120, 112, 130, "slower"), (120, 105, 130, "same"), (80, 70, 90, "faster")):
            self.assertEqual(self.kinds(base, made(ns=ns, low=low, high=high) | {"commit": "new"}), [kind])

    def test_one_repetition_tells_nothing(self):
        self.assertEqual(self.kinds(made(ns=100, low=100, high=100), made(ns=150, low=145, high=160)), ["same"])

    def test_a_new_failure_or_a_larger_error_is_worse(self):
        (change,) = compare.compare(read(made()), read(made(error=0.1, status="wrong")))
        self.assertEqual((change.kind, change.worse), ("status", True))
        (change,) = compare.compare(read(made(error=1e-3)), read(made(error=1e-2)))
        self.assertEqual((change.kind, change.worse), ("error", True))
        (change,) = compare.compare(read(made(error=1e-2)), read(made(error=1e-3)))
        self.assertFalse(change.worse)

    def test_exit_status(self):
        with tempfile.TemporaryDirectory() as folder:
            a, b, other = (Path(folder) / f"{name}.jsonl" for name in "abc")
            fixture.write(a, [made(ns=100, low=95, high=105)])
            fixture.write(b, [made(ns=150, low=145, high=155)])
            fixture.write(other, [made(dataset="ball")])
            quiet = contextlib.redirect_stdout(io.StringIO())
            with quiet, contextlib.redirect_stderr(io.StringIO()):
                found = [compare.main([str(x), str(y)]) for x, y in ((a, b), (b, a), (a, other), (a, folder))]
        self.assertEqual(found, [1, 0, 2, 2])


if __name__ == "__main__":
    unittest.main()
