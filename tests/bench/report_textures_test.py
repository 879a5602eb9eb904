"""The claims about textures, on rows made by hand."""

import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parent)]

from bench.report import claims
from report_made import made, read


def row(method, query_set, error=0.0, ns=10.0, family="sat", dataset="mask", n=1000, **values):
    claim = "exact" if method in ("sat_int64", "sat_uint32") else "approximate"
    return made((method, family, "ours", claim), ns, error, dataset=dataset, n=n, query_set=query_set, **values) | {"task": "region_average"}


def verdict(name, *entries):
    return next(v for v in claims.ledger(list(read(*entries))) if v.id == name)


class Textures(unittest.TestCase):
    def test_tables_are_exact_only_by_type_and_shape(self):
        v = verdict("T1", row("sat_int64", "square4", 1e-8, error_max=3e-8), row("sat_float", "square4", 1e-3, error_max=4e-3),
                    row("sat_int64", "disc_sorted", 0.01, error_max=0.05))  # fmt: skip
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertIn("boxes along the axes, sums of levels in 64 bits", v.condition)
        self.assertNotIn("float", v.condition)
        self.assertNotIn("discs", v.condition)
        self.assertEqual(len(v.figures), 3)

    def test_one_texture_that_spoils_a_type_is_enough(self):
        v = verdict("T1", row("sat_float", "texel", 1e-8, error_max=3e-8), row("sat_float", "texel", 1e-4, error_max=1e-3, n=4000))
        self.assertEqual(v.word, claims.FAILS)

    def test_mips_are_poor_only_where_probes_do_not_help(self):
        plain, fine = {"bias": 0}, {"probes": 16}
        v = verdict("T2", row("mip_square", "oblong", 0.2, family="mip", query=plain), row("mip_anisotropic", "oblong", 0.004, family="mip", query=fine),
                    row("mip_square", "square24", 0.05, family="mip", query=plain))  # fmt: skip
        self.assertEqual(v.word, claims.ONLY_IF)
        self.assertIn("oblong, mip_square", v.condition)
        self.assertNotIn("mip_anisotropic", v.condition)
        biased = row("mip_square", "square24", 0.004, family="mip", query={"bias": -0.79})
        self.assertEqual(verdict("T2", row("mip_square", "square24", 0.05, family="mip", query=plain), biased).word, claims.FAILS)
        self.assertEqual(verdict("T2", row("mip_square", "square24", 0.05, family="mip", query=plain)).word, claims.HOLDS)

    def test_builds_by_size_threads_and_beside_a_copy(self):
        entries = [row("sat_float", "build", None, 1.0, bytes=4000, threads=1), row("sat_float", "build", None, 1.2, n=4000, bytes=16000),
                   row("nearest", "build", None, 0.5, family="texel", bytes=4000)]  # fmt: skip
        v = verdict("T3", *entries)
        self.assertEqual(v.word, claims.HOLDS)
        self.assertAlmostEqual(v.figures[0][1], 1.2)
        self.assertEqual([line[-1] for line in v.table[1]], [2.0, None])
        threads = [row("sat_float", "build_threads", None, ns, n=4000, threads=t) for t, ns in ((1, 1.0), (2, 1.0))]
        self.assertEqual(verdict("T3", *entries, *threads).word, claims.ONLY_IF)
        threads[1]["query_ns"] = 0.6
        self.assertEqual(verdict("T3", *entries, *threads).word, claims.HOLDS)

    def test_hard_cases_and_failures_do_not_count(self):
        v = verdict("T1", row("sat_float", "texel", 1.0, status="wrong", error_max=1.0))
        self.assertEqual(v.word, claims.NOT_RUN)


if __name__ == "__main__":
    unittest.main()
