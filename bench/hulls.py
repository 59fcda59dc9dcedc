"""Compare qhull (scipy.spatial.ConvexHull) and impinge on the same points, on one thread each.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt
    IMPINGE_DATA=... .venv/bin/python bench/hulls.py

The points are random clouds, the vertices of the human mesh of the repository and, if IMPINGE_DATA
names the data folder, those of its CAD parts and scans. Both engines get the same doubles, qhull as
an array and impinge as a file. Only the call itself is timed. The numbers of vertices are compared:
qhull merges facets that are flat within its tolerance, so it may leave out vertices that are
extreme by less.
"""

import argparse
import gzip
import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import record
from about import ROOT, circumstances, print_circumstances
from rivals import spread
from scipy.spatial import ConvexHull
from torus_knot import torus_knot

TOLERANCE = 0.01  # share of vertices by which qhull may differ, because it merges nearly flat facets
# Little-endian NumPy types of the properties of a PLY file.
PLY_TYPES = {"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8", "uchar": "u1", "uint8": "u1"}


@dataclass
class Timing:
    """Result for one set of points. Both lists contain the seconds of single runs."""

    name: str
    points: int
    vertices: int
    qhull_vertices: int
    impinge_seconds: list[float]
    qhull_seconds: list[float]


def ply_points(path: Path) -> np.ndarray:
    """Return the vertices of a binary PLY file, optionally compressed as .gz, as (n, 3) doubles."""
    data = gzip.open(path).read() if path.suffix == ".gz" else path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    element, count, fields = "", 0, []
    for words in (line.split() for line in data[:end].decode("ascii").splitlines()):
        if words[:1] == ["element"]:
            element = words[1]
            count = int(words[2]) if element == "vertex" else count
        elif words[:1] == ["property"] and element == "vertex":
            fields.append((words[2], PLY_TYPES[words[1]]))
    vertices = np.frombuffer(data, np.dtype(fields), count, end)
    return np.stack([vertices[axis].astype(np.float64) for axis in "xyz"], axis=1)


def sets() -> dict[str, np.ndarray]:
    """Return the sets of points, (n, 3), by name."""
    rng = np.random.default_rng(1)
    sphere = rng.normal(size=(200_000, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    found = {
        "human": ply_points(ROOT / "data" / "human_makehuman_cc0.ply"),
        "knot": torus_knot(2000, 500)[0],
        "cube, uniform": rng.uniform(-1, 1, size=(1_000_000, 3)),
        "sphere, all on it": sphere,
    }
    data = os.environ.get("IMPINGE_DATA")
    if data is not None:
        found["igea"] = ply_points(Path(data) / "meshes" / "igea.ply")
        found["ventilator"] = ply_points(Path(data) / "big" / "cad_ventilator.ply.gz")
        found["11752"] = ply_points(Path(data) / "big" / "cad_11752.ply.gz")
    return found


def measure(name: str, points: np.ndarray, repeats: int) -> Timing:
    """Time both engines on a set of points."""
    folder = ROOT / "target" / "hulls"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "points.f64"
    points.astype("<f8").tofile(path)
    program = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "hulls", "--", str(path)]
    arguments = ["--repeats", str(repeats), "--threads", "1"]
    run = subprocess.run(program + arguments, cwd=ROOT, stdout=subprocess.PIPE, check=True)
    ours = json.loads(run.stdout)
    qhull_seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        hull = ConvexHull(points)
        qhull_seconds.append(time.perf_counter() - start)
    return Timing(name, len(points), len(ours["vertices"]), len(hull.vertices), ours["seconds"], qhull_seconds)


def table(timings: list[Timing]) -> str:
    """Return a Markdown table of medians and, in brackets, minima; the ratio is that of medians."""
    rows = ["| points of | points | vertices | qhull's | impinge, ms | qhull, ms | ratio |", "|" + "---|" * 7]
    for t in timings:
        ratio = np.median(t.qhull_seconds) / np.median(t.impinge_seconds)
        cells = [t.name, t.points, t.vertices, t.qhull_vertices]
        cells += [spread(t.impinge_seconds, 1e3), spread(t.qhull_seconds, 1e3), f"{ratio:.3g}"]
        rows.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    return "\n".join(rows)


def main() -> int:
    """Print the table; return 1 if the numbers of vertices differ, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5, help="runs of each hull")
    parser.add_argument("--sets", nargs="+", help="only these sets of points")
    options = parser.parse_args()

    about = circumstances("scipy")
    chosen = {name: points for name, points in sets().items() if not options.sets or name in options.sets}
    timings = [measure(name, points, options.repeats) for name, points in chosen.items()]
    problems = [
        f"{t.name}: qhull has {t.qhull_vertices} vertices; {t.vertices} are expected"
        for t in timings
        if abs(t.qhull_vertices - t.vertices) > TOLERANCE * t.vertices
    ]
    print_circumstances(about, "One thread; median (minimum) of the runs; the ratio is qhull's median over impinge's.")
    print(table(timings))
    for t in timings:
        record.row(t.name, "points", "1", t.points)
        for engine, vertices, runs in (
            ("impinge", t.vertices, t.impinge_seconds),
            ("qhull", t.qhull_vertices, t.qhull_seconds),
        ):
            record.row(t.name, "vertices", "1", vertices, engine)
            record.seconds(t.name, "hull", runs, engine)
    for problem in problems:
        print(f"error: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
