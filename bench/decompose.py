"""Convex parts beside those of CoACD: their number, their concavity and the time, in one run.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/pip install coacd==1.0.14
    .venv/bin/python bench/decompose.py MESH ... [--share 0.025]

Both get the same closed mesh, scaled so that its largest extent is 2, as CoACD does by itself, and
the same threshold: `share` of the largest extent. The two measure concavity in different ways, so
the table has one measure for both, from samples: the largest distance of a point of a hull from the
solid, and the share of the points of the solid that no hull contains. It fails if a sample is
outside of the hulls of impinge, or farther from the solid than its bound.
"""

import argparse
import time
from pathlib import Path

import coacd
import impinge
import numpy as np
import record

SAMPLES = 4000
Hulls = list[tuple[np.ndarray, np.ndarray]]


def closed(path: str) -> impinge.Mesh:
    """Return the mesh of a file, without cracks, about the origin and with the largest extent 2."""
    mesh = impinge.load(path)
    mesh, _ = mesh.repaired(weld=mesh.closing_tolerance() or 0.0, orient=True)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    scaled = (mesh.vertices - (low + high) / 2) * (2 / (high - low).max())
    return impinge.Mesh(scaled.astype(float), mesh.faces)


def samples(hulls: Hulls, rng: np.random.Generator) -> np.ndarray:
    """Return points inside the hulls, as many in each: each between four of its vertices."""
    count = SAMPLES // len(hulls) + 1
    inside = []
    for vertices, _ in hulls:
        weights = rng.dirichlet(np.full(4, 0.5), count)
        inside.append(np.einsum("nk,nkx->nx", weights, vertices[rng.integers(0, len(vertices), (count, 4))]))
    return np.vstack(inside)


def measure(mesh: impinge.Mesh, hulls: Hulls) -> tuple[float, float]:
    """Return the largest sampled distance from the solid, and the share of samples not covered."""
    rng = np.random.default_rng(1)
    outside = np.maximum(mesh.signed_distance(samples(hulls, rng)), 0).max()
    points = rng.uniform(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0), (4 * SAMPLES, 3))
    points = np.vstack([points[mesh.contains(points)], mesh.vertices[:: len(mesh.vertices) // SAMPLES + 1]])
    shapes = impinge.Shape.compound((impinge.Shape.hull(vertices), None) for vertices, _ in hulls)
    is_covered = impinge.intersects(shapes, impinge.Shape.sphere(0), pose_b=impinge.pose(points))
    return float(outside), float(1 - is_covered.mean())


def main() -> None:
    """Print a row for each mesh and engine."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--share", type=float, default=0.025)
    parser.add_argument("--max-parts", type=int, default=256)
    arguments = parser.parse_args()
    coacd.set_log_level("error")
    threshold = 2 * arguments.share
    print("| mesh | faces | engine | parts | vertices | proved | sampled | uncovered | seconds |")
    print("|---|---|---|---|---|---|---|---|---|")
    for path in arguments.meshes:
        mesh = closed(path)
        start = time.perf_counter()
        parts = mesh.convex_parts(concavity=threshold, max_parts=arguments.max_parts)
        middle = time.perf_counter()
        rival = coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.faces), threshold=threshold)
        end = time.perf_counter()
        ours = [(part.vertices, part.faces) for part in parts.parts]
        name = Path(path).stem
        for engine, hulls, seconds in (("impinge", ours, middle - start), ("coacd", rival, end - middle)):
            outside, uncovered = measure(mesh, hulls)
            if engine == "impinge":
                assert outside <= parts.concavity * (1 + 1e-9), f"{path}: {outside} is above {parts.concavity}"
                assert uncovered == 0, f"{path}: hulls leave {uncovered:.2%} uncovered"
            proved = f"{parts.concavity / 2:.4f}" if engine == "impinge" else ""
            vertices = sum(len(vertices) for vertices, _ in hulls)
            print(
                f"| {name} | {len(mesh.faces):,} | {engine} | {len(hulls)} | {vertices:,} | {proved} "
                f"| {outside / 2:.4f} | {uncovered:.1%} | {seconds:.2f} |"
            )
            record.row(name, "parts", "1", len(hulls), engine)
            record.row(name, "time", "s", seconds, engine)


if __name__ == "__main__":
    main()
