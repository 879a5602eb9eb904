"""Synthetic rows in the format of bench/core/row.hpp: two tasks, many methods, every status, some of everything.

report_fixture.py DIR    writes DIR/knn.jsonl, knn.stress.jsonl, ray.jsonl, ray.stress.jsonl and DIR/pictures
"""

import json
import math
import random
import struct
import sys
import zlib
from pathlib import Path

MACHINE = {"isa": "avx512", "flags": "-O3 -march=native", "compiler": "g++ 12.2.0", "cpu": "Synthetic CPU @ 2 GHz",
           "host": "fixture", "commit": "0123456789ab"}  # fmt: skip
# name, family, source, claim, build knobs, query knobs, time at 1e6 in ns, error, build ns/element, bytes/element
KNN = (
    ("brute_force", "brute", "ours", "exact", [{}], [{}], 4e6, 0, 0.4, 12),
    ("kd_tree", "kd", "ours", "exact", [{"leaf_size": 8}, {"leaf_size": 16}], [{}], 700, 0, 180, 24),
    ("bsp_tree", "bsp", "ours", "exact", [{"leaf_size": 8}], [{}], 1500, 0, 420, 40),
    ("bvh", "bvh", "ours", "exact", [{"leaf_size": 8}, {"leaf_size": 16}], [{}], 520, 0, 240, 34),
    ("nanoflann", "kd", "peer", "exact", [{"leaf": 10}, {"leaf": 20}], [{"eps": 0.0}, {"eps": 0.5}], 980, 0, 330, 15),
    ("flann_single", "kd", "peer", "exact", [{"leaf": 10}], [{}], 1080, 0, 760, 38),
    ("flann_forest", "forest", "peer", "approximate", [{"trees": 4}],
     [{"checks": 32}, {"checks": 128}, {"checks": 512}], 2600, 3e-2, 2600, 265),
    ("pcl_kdtree", "kd", "peer", "exact", [{}], [{}], 1200, 0, 650, 65),
    ("pcl_octree", "octree", "peer", "exact", [{"resolution": 0.01}], [{}], 19000, 0, 900, 130),
    ("cgal_kd", "kd", "peer", "exact", [{"bucket": 10}], [{}], 930, 0, 390, 48),
)  # fmt: skip
RAY = (
    ("brute_force", "brute", "ours", "exact", [{}], [{}], 9e6, 0, 0.1, 0),
    ("kd_tree", "kd", "ours", "exact", [{"leaf": 4}], [{}], 1300, 0, 2600, 120),
    ("bsp_tree", "bsp", "ours", "exact", [{"leaf": 4}], [{}], 2100, 0, 4100, 160),
    ("bvh", "bvh", "ours", "exact", [{"test": "watertight"}, {"test": "moller_trumbore"}], [{}], 800, 0, 700, 64),
    ("embree_single", "bvh", "peer", "approximate", [{"quality": q} for q in ("low", "medium", "high")], [{}],
     300, 3e-8, 700, 66),
    ("embree_packet8", "bvh", "peer", "approximate", [{"quality": "medium"}], [{}], 240, 3e-8, 700, 66),
    ("embree_packet16", "bvh", "peer", "approximate", [{"quality": "medium"}], [{}], 220, 0, 700, 66),
    ("cgal_aabb", "bvh", "peer", "exact", [{}], [{}], 2900, 0, 900, 90),
)  # fmt: skip
TASKS = {
    "knn": (KNN, ("uniform_cube", "uniform_ball", "displaced_sphere", "clusters", "lidar", "filaments", "grid"),
            {"knn1_self": 0.3, "knn8_self": 1, "knn32_self": 3, "knn8_off": 2.2, "radius": 1.6, "box": 1.4}),
    "ray": (RAY, ("icosphere", "terrain", "architecture", "forest", "shells", "torus_knot"),
            {"camera_closest": 1, "bounce_closest": 1.4, "shadow_any": 0.7}),
}  # fmt: skip
ADVISED = {"knn": ("knn8_self", "box")}  # of the task ray, as in older files, the rows do not say
HARD = ("ties_grid", "duplicates_1e5", "all_equal", "collinear", "far_from_origin", "nan_points", "infinite_point",
        "empty", "one", "k_above_n", "needle_triangles", "zero_area", "edge_rays", "vertex_rays")  # fmt: skip


def row(task, block, dataset, n, method, query_set, build, query, **values):
    name, family, source, claim = method[:4]
    base = {
        "schema": 1, "task": task, "block": block, "dataset": dataset, "n": n, "seed": 1,
        "dataset_hash": f"{zlib.crc32(block.encode()):016x}", "method": name, "family": family, "source": source,
        "peer_version": "1.2.3" if source == "peer" else None, "claim": claim, "build_knobs": build,
        "query_knobs": query, "query_set": query_set, "queries": 1000, "threads": 1, "status": "ok", "reason": None,
        "build_s": None, "query_ns": None, "query_ns_low": None, "query_ns_high": None, "query_cpu_ns": None,
        "samples": None, "bytes": None, "error": None, "error_max": None, "error_p99": None, "error_mean": None,
        "bias": None, "error_floor": None, "work_nodes": None, "work_primitives": None,
    }  # fmt: skip
    if task in ADVISED and not block.startswith("hard/"):
        base["advised"] = query_set in ADVISED[task]
    return base | values | MACHINE | {"time": "2025-01-01T00:00:00Z"}


def timed(rng, ns, error, floor=3e-7):
    samples = [ns * rng.lognormvariate(0, 0.03) for _ in range(5)]
    samples.sort()
    figures = {"query_ns": samples[2], "query_ns_low": samples[0], "query_ns_high": samples[4], "samples": samples,
               "query_cpu_ns": samples[2] * 0.99, "error_floor": floor}  # fmt: skip
    figures |= {"error": error, "error_max": min(1.0, error * 8), "error_p99": min(1.0, error * 3), "error_mean": error / 2,
                "bias": error / 4}  # fmt: skip
    return figures


def block_rows(rng, task, dataset, n):
    methods, _, sets = TASKS[task]
    hardness = rng.uniform(0.7, 1.8)
    for method in methods:
        name, _, _, claim, builds, queries, base, error, build_ns, bytes_per = method
        tilt = rng.uniform(0.8, 1.3)
        for b, build in enumerate(builds):
            built = {"build_s": build_ns * n * 1e-9 * (1 + 0.2 * b), "bytes": int(bytes_per * n * (1 - 0.1 * b))}
            for query_set, factor in sets.items():
                for q, query in enumerate(queries):
                    here = lambda **v: row(task, f"{dataset}:{n}", dataset, n, method, query_set, build, query, **v)
                    if name == "brute_force" and n > 100_000:
                        yield here(status="unsupported", reason=f"not run above 100000 {task} elements")
                    elif name.startswith("flann") and query_set == "box":
                        yield here(status="unsupported", reason="has no box query")
                    elif name == "pcl_octree" and dataset == "clusters" and query_set == "radius":
                        yield here(status="crashed", reason="signal 11 after 0.3 s", **built)
                    elif name == "pcl_octree" and dataset == "filaments":
                        yield here(status="timeout", reason="no end in 20 s", **built)
                    else:
                        scale = n / 1e6 if name == "brute_force" else (math.log2(n) / 20) ** 2
                        ns = base * scale * factor * hardness * tilt * (1 + 0.15 * b) * 2**q
                        if name == "nanoflann" and query:
                            claim_error, ns = (0, ns) if q == 0 else (4e-2 * rng.uniform(0.5, 2), ns / 3.5)
                        else:
                            claim_error = error * 4.0**-q * rng.uniform(0.5, 2)
                        figures = timed(rng, ns, claim_error, 3e-7 if task == "knn" else 1e-12)
                        if name == "cgal_kd" and dataset == "lidar" and query_set == "radius":
                            figures |= {"error": 6e-3, "error_max": 0.6}
                            yield here(status="wrong", reason="query 17: 3 of 40 missing", **built, **figures)
                        else:
                            counted = {"work_nodes": 40.5, "work_primitives": 31.0, f"{task}_leaves": 5.25}
                            work = counted if method[2] == "ours" else {}
                            yield here(**built, **figures, **work, **{f"{task}_recall": 1 - claim_error})
    missing = ("kiddo", "kd", "peer", "exact")
    yield row(task, f"{dataset}:{n}", dataset, n, missing, None, {}, {}, status="not_built", reason="package absent")


def thread_rows(rng, task, dataset, n):
    """Of --scaling, on one and two threads."""
    for threads in (1, 2):
        for method in TASKS[task][0]:
            name, _, _, claim, builds, queries, base, _, build_ns, _ = method
            if claim != "exact" or name == "brute_force":
                continue
            faster = 1 if threads == 1 else rng.uniform(1.7, 2)
            figures = timed(rng, base / faster, 0) | {"build_s": build_ns * n * 1e-9 / (faster if name == "bvh" else 1)}
            yield row(task, f"{dataset}:{n}", dataset, n, method, "knn8_threads", builds[0], queries[0],
                      threads=threads, **figures)  # fmt: skip


def stress_rows(rng, task):
    for case in HARD:
        for method in TASKS[task][0]:
            status, reason, error = "ok", None, 0.0
            if method[2] == "peer" and rng.random() < 0.25:
                status = rng.choice(("wrong", "refused", "crashed", "timeout", "out_of_memory"))
                reason = {"wrong": "query 3: 2 of 8 missing", "crashed": "signal 11"}.get(status, 'a <clear> "text"')
                error = 0.31 if status == "wrong" else None
            for query_set in ("nearest", "radius") if task == "knn" else ("closest", "any"):
                yield row(task, f"hard/{case}", case, 1000, method, query_set, {}, {}, status=status, reason=reason,
                          error=error, error_max=error, error_floor=3e-7)  # fmt: skip


def png(path, rng, side=96):
    """A small picture, written by hand: rings with noise."""
    lines = b""
    for y in range(side):
        line = bytes(v for x in range(side) for v in
                     (int(128 + 120 * math.sin(math.hypot(x - 40, y - 50) / 5)), 90 + y, rng.randrange(200, 255)))  # fmt: skip
        lines += b"\0" + line

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
    )


def pictures(folder, rng, task):
    folder.mkdir(parents=True, exist_ok=True)
    entries = []
    for dataset in TASKS[task][1][:3]:
        for method in ("kd_tree", "bvh"):
            name = f"{dataset}_{method}"
            (folder / f"{name}.svg").write_text(
                '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><rect width="60" height="100" fill="none" '
                'stroke="#0072B2"/><circle cx="40" cy="40" r="20" fill="#D55E00"/></svg>')  # fmt: skip
            entries.append({"file": f"{name}.svg", "title": f"Slice through a {method}", "dataset": dataset,
                            "method": method, "kind": "slice"})  # fmt: skip
        png(folder / f"{dataset}.png", rng)
        entries.append({"file": f"{dataset}.png", "title": "Normals", "dataset": dataset, "method": "bvh",
                        "kind": "rendering", "caption": "Wrong pixels are marked: none."})  # fmt: skip
    write(folder / "pictures.jsonl", entries)


def write(path, entries):
    path.write_text("".join(json.dumps(e) + "\n" for e in entries))


def make(folder, sizes=(10_000, 100_000, 1_000_000), seed=1):
    """Writes everything; returns the row files."""
    rng, folder = random.Random(seed), Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for task, (_, datasets, _) in TASKS.items():
        soft = [r for d in datasets for n in sizes for r in block_rows(rng, task, d, n)]
        stress, threads = list(stress_rows(rng, task)), []
        if task == "knn":
            threads = list(thread_rows(random.Random(seed), task, datasets[0], sizes[-1]))
        for name, entries in ((f"{task}.jsonl", soft), (f"{task}.stress.jsonl", stress), (f"{task}.threads.jsonl", threads)):
            if entries:
                write(folder / name, entries)
                files.append(folder / name)
        pictures(folder / "pictures" / task, rng, task)
    return files


if __name__ == "__main__":
    print(*make(sys.argv[1]), sep="\n")
