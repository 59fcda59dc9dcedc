"""Convex parts beside those of CoACD: their number, their concavity and the time, in one run.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/pip install coacd==1.0.14
    .venv/bin/python bench/decompose.py MESH ... [--share 0.025] [--picture FILE]

Both get the same closed mesh, scaled so that its largest extent is 2, as CoACD does by itself, and
the same threshold: `share` of the largest extent. The two measure concavity in different ways, so
the table has one measure for both, from samples: the largest distance of a point of a hull from the
solid, and the share of the points of the solid that no hull contains. It fails if a sample is
outside of the hulls of impinge, or farther from the solid than its bound. `--picture` draws the
parts of the last mesh.
"""

import argparse
import math
import time
from pathlib import Path

import coacd
import impinge
import numpy as np
import record
from PIL import Image, ImageDraw

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
    """Return points inside the hulls, as many in each."""
    weights = [rng.dirichlet(np.full(len(vertices), 0.3), SAMPLES // len(hulls) + 1) for vertices, _ in hulls]
    return np.vstack([weight @ vertices for weight, (vertices, _) in zip(weights, hulls, strict=True)])


def measure(mesh: impinge.Mesh, hulls: Hulls) -> tuple[float, float]:
    """Return the largest sampled distance from the solid, and the share of samples not covered."""
    rng = np.random.default_rng(1)
    outside = np.maximum(mesh.signed_distance(samples(hulls, rng)), 0).max()
    points = rng.uniform(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0), (4 * SAMPLES, 3))
    points = np.vstack([points[mesh.contains(points)], mesh.vertices[:: len(mesh.vertices) // SAMPLES + 1]])
    shapes = impinge.Shape.compound((impinge.Shape.hull(vertices), None) for vertices, _ in hulls)
    is_covered = impinge.intersects(shapes, impinge.Shape.sphere(0), pose_b=impinge.pose(points))
    return float(outside), float(1 - is_covered.mean())


def draw(hulls: Hulls, path: Path) -> None:
    """Draw the hulls from the front and above, each in a color of its own."""
    size, margin = 900, 0.47
    turn = impinge.pose(quat_wxyz=[0.83, -0.42, 0.33, 0.15] / np.linalg.norm([0.83, -0.42, 0.33, 0.15]))[:3, :3]
    faces = []
    for number, (vertices, triangles) in enumerate(hulls):
        hue = number * 0.618034 % 1
        color = np.array([0.5 + 0.35 * math.cos(math.tau * (hue + third)) for third in (0, 1 / 3, 2 / 3)])
        corners = (vertices @ turn.T)[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        shades = 0.35 + 0.65 * np.maximum(normals @ [0.3, 0.4, 0.87], 0)
        faces += [(corner, color * shade) for corner, shade, normal in zip(corners, shades, normals, strict=True) if normal[2] > 0]
    reach = max(np.abs(corner[:, :2]).max() for corner, _ in faces)
    image = Image.new("RGB", (size, size), "white")
    canvas = ImageDraw.Draw(image)
    for corner, color in sorted(faces, key=lambda face: face[0][:, 2].mean()):
        at = (0.5 + margin * corner[:, :2] / reach * [1, -1]) * size
        canvas.polygon([tuple(point) for point in at], fill=tuple(int(255 * x) for x in color))
    image.save(path)


def main() -> None:
    """Print a row for each mesh and engine."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--share", type=float, default=0.025)
    parser.add_argument("--max-parts", type=int, default=256)
    parser.add_argument("--picture", type=Path)
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
        if arguments.picture:
            draw(ours, arguments.picture)


if __name__ == "__main__":
    main()
