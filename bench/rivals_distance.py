"""Compare the distances of FCL, Coal and impinge for the same two meshes, on one thread each.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt
    IMPINGE_DATA=... .venv/bin/python bench/rivals_distance.py

The scenes are two knots at several gaps, and along a path of small steps; a thin knot of 20,000
triangles inside a thick one, with nearly the same gap everywhere; and, if IMPINGE_DATA names the
folder of extra data, the bunny at a thousand places around a human, at random and along a path.
Along paths impinge also starts from the nearest faces of the last pose, which the others cannot do.
The distances are compared, and must agree within a relative 1e-9. At full size FCL and Coal need
5 GB each for the knots, one after the other; --nu and --nv make them smaller.
"""

import argparse
import gc
import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import record
from about import ROOT, circumstances
from rivals import seconds
from torus_knot import torus_knot, write_ply

KEYS = ("without cache", "cache of same pose", "cache of last pose")
TOLERANCE = 1e-9  # allowed relative difference of distances; the rivals return no error bounds
STEPS = 20  # number of poses on the path of the knots
NESTED_STEPS = 10  # number of steps on the path of the thin knot
POSES = 1000  # number of poses of the bunny: at random, and along its path
Mesh = tuple[np.ndarray, np.ndarray]
Pose = tuple[float, float, float, float, float, float, float]  # translation, then quaternion (w, x, y, z)


def turned(translation: tuple[float, float, float], angle: float = 0.7) -> Pose:
    """Return a pose with a rotation about (1, 2, 3) by an angle in radians."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    return (*translation, float(np.cos(angle / 2)), *(float(c) for c in np.sin(angle / 2) * axis))


def rotation(pose: Pose) -> np.ndarray:
    """Return the (3, 3) rotation matrix of a pose, for column vectors."""
    w, x, y, z = pose[3:]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@dataclass
class Scene:
    """Two meshes, and poses of the second one."""

    name: str
    meshes: list[Mesh]
    poses: list[Pose]
    """Poses of the second mesh, world from mesh."""
    labels: list[str]
    """Names of the first poses, which get a row of their own in the table."""


def knots(nu: int, nv: int) -> Scene:
    """Return two knots of nu by nv quads at three gaps, and along a path."""
    mesh = torus_knot(nu, nv)
    named = [("apart", turned((6.0, 0.5, 0.3))), ("near", turned((5.72, 0.5, 0.3))), ("far", turned((9.0, 0.0, 0.0)))]
    path = [turned((6.0, 0.5 + 0.002 * i, 0.3), 0.7 + 0.002 * i) for i in range(STEPS)]
    return Scene("knots", [mesh, mesh], [pose for _, pose in named] + path, [name for name, _ in named])


def nested_knots() -> Scene:
    """Return a thin knot inside a thick one, along a path."""
    path = [turned((0.002 * i, 0.0, 0.0), 0.001 * i) for i in range(NESTED_STEPS + 1)]
    return Scene("knot in knot", [torus_knot(200, 50), torus_knot(200, 50, 0.2)], path, ["concentric"])


def read_ply(path: Path) -> Mesh:
    """Read a little-endian binary PLY file of triangles with three floats for each vertex."""
    content = path.read_bytes()
    header, body = content.split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
    vertices = np.frombuffer(body, "<f4", 3 * counts[0]).reshape(-1, 3)
    rows = np.frombuffer(body, [("count", "u1"), ("face", "<i4", 3)], counts[1], offset=vertices.nbytes)
    return vertices.astype(float), rows["face"].astype(np.int64)


def read_obj(path: Path) -> Mesh:
    """Read an OBJ file of triangles; vertices are rounded to single precision for all engines."""
    rows = [line.split() for line in path.read_text().splitlines()]
    vertices = np.array([row[1:4] for row in rows if row[:1] == ["v"]], dtype=float)
    faces = [[int(corner.split("/")[0]) - 1 for corner in row[1:]] for row in rows if row[:1] == ["f"]]
    return vertices.astype(np.float32).astype(float), np.array(faces)


def bunny_and_human(folder: Path) -> list[Scene]:
    """Load a human and the bunny, at random poses around the human and along a path."""
    human = read_ply(folder / "meshes" / "human_makehuman_cc0.ply")
    vertices, faces = read_obj(folder / "meshes" / "stanford-bunny.obj")
    height = np.ptp(human[0], axis=0).max()
    # Scale to about a quarter of the human, by a power of two, which is exact.
    bunny = vertices * 2.0 ** np.round(np.log2(height / 4 / np.ptp(vertices, axis=0).max())), faces
    centers = [(vertices.min(axis=0) + vertices.max(axis=0)) / 2 for vertices, _ in (human, bunny)]
    rng = np.random.default_rng(1)

    def standing(at: np.ndarray, quaternion: np.ndarray) -> Pose:
        unit = quaternion / np.linalg.norm(quaternion)
        turned = rotation((0, 0, 0, *unit))
        return (*(float(x) for x in at - turned @ centers[1]), *(float(x) for x in unit))

    around = rng.normal(size=(POSES, 3))
    around *= height * rng.uniform(0.6, 1.5, (POSES, 1)) / np.linalg.norm(around, axis=1)[:, None]
    chance = [standing(centers[0] + at, rng.normal(size=4)) for at in around]
    angles = np.linspace(0, 2 * np.pi, POSES)
    path = [
        standing(
            centers[0] + height * np.array([0.7 * np.cos(angle), 0.7 * np.sin(angle), 0.3 * np.sin(2 * angle)]),
            np.array([np.cos(angle), 0.3, 0.2, np.sin(angle)]),
        )
        for angle in angles
    ]
    return [
        Scene("bunny by chance", [human, bunny], chance, []),
        Scene("bunny along a path", [human, bunny], path, []),
    ]


def measure_fcl(scene: Scene, repeats: int) -> list[dict]:
    """Return the distance and the minimum seconds of a call of FCL for each pose."""
    import fcl

    def model(mesh: Mesh) -> fcl.BVHModel:
        vertices, faces = mesh
        model = fcl.BVHModel()
        model.beginModel(len(faces), len(vertices))
        model.addSubModel(vertices, faces.tolist())
        model.endModel()
        return model

    a, b = models(scene, model)
    answers = []
    for pose in scene.poses:
        one = fcl.CollisionObject(a, fcl.Transform())
        two = fcl.CollisionObject(b, fcl.Transform(rotation(pose), np.array(pose[:3])))
        request = fcl.DistanceRequest()
        distance = fcl.distance(one, two, request, fcl.DistanceResult())
        cold = [seconds(lambda: fcl.distance(one, two, request, fcl.DistanceResult())) for _ in range(repeats)]
        answers.append({"distance": distance, "without cache": min(cold)})
    return answers


def measure_coal(scene: Scene, repeats: int) -> list[dict]:
    """Return the distance and the minimum seconds of a call of Coal for each pose."""
    import coal

    def model(mesh: Mesh) -> coal.BVHModelOBBRSS:
        vertices, faces = mesh
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(faces), len(vertices))
        model.addVertices(vertices)
        model.addTriangles(faces.astype(np.int64))
        model.endModel()
        return model

    a, b = models(scene, model)
    answers = []
    for pose in scene.poses:
        world_from_b = coal.Transform3s(rotation(pose), np.array(pose[:3]))

        def query(world_from_b=world_from_b) -> float:
            result = coal.DistanceResult()
            return coal.distance(a, coal.Transform3s(), b, world_from_b, coal.DistanceRequest(), result)

        distance = query()
        answers.append({"distance": distance, "without cache": min(seconds(query) for _ in range(repeats))})
    return answers


def models(scene: Scene, model: Callable[[Mesh], object]) -> list[object]:
    """Return a model of each mesh; a single model if both meshes are the same."""
    first = model(scene.meshes[0])
    return [first, first if scene.meshes[1] is scene.meshes[0] else model(scene.meshes[1])]


def measure_impinge(scene: Scene, repeats: int) -> list[dict]:
    """Return the distance and the minimum seconds, with and without caches, for each pose."""
    folder = ROOT / "target" / "rivals"
    folder.mkdir(parents=True, exist_ok=True)
    rows = folder / "poses.txt"
    paths = [folder / f"distance_{side}.ply" for side in "ab"]
    for path, mesh in zip(paths, scene.meshes, strict=True):
        write_ply(path, *mesh)
    rows.write_text("".join(",".join(repr(x) for x in pose) + "\n" for pose in scene.poses))
    program = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "distance", "--"]
    arguments = ["--mesh", str(paths[0]), "--other", str(paths[1]), "--poses", str(rows), "--repeats", str(repeats)]
    run = subprocess.run([*program, *arguments, "--json"], cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True)
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    return [
        {
            "distance": line["distance"],
            "without cache": min(line["cold_seconds"]),
            "cache of same pose": min(line["seeded_seconds"]),
            "cache of last pose": min(line["following_seconds"]),
        }
        for line in lines
    ]


ENGINES = {"impinge": measure_impinge, "FCL": measure_fcl, "Coal": measure_coal}


def main() -> int:
    """Print the table; return 1 if the distances differ, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads around its tube")
    parser.add_argument("--repeats", type=int, default=9, help="runs of each query")
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=list(ENGINES))
    options = parser.parse_args()

    for name, value in circumstances().items():
        print(f"- {name}: `{value}`")
    folder = os.environ.get("IMPINGE_DATA")
    scenes = [knots(options.nu, options.nv), nested_knots()] + (bunny_and_human(Path(folder)) if folder else [])
    print("\n| poses | engine | distance | " + " | ".join(f"{key}, µs" for key in KEYS) + " |\n" + "|---" * 6 + "|")
    problems = 0
    for scene in scenes:
        answers = {}
        for engine in options.engines:
            answers[engine] = ENGINES[engine](scene, options.repeats)
            gc.collect()
        reference = np.array([row["distance"] for row in next(iter(answers.values()))])
        own = [(label, slice(i, i + 1)) for i, label in enumerate(scene.labels)]
        for label, which in [*own, (f"{len(scene.poses) - len(own)} others", slice(len(own), None))]:
            for engine, rows in answers.items():
                print(f"| {scene.name}: {label} | {engine} | " + " | ".join(cells(rows[which])) + " |")
                write_rows(f"{scene.name}: {label}", engine, rows[which])
        for engine, rows in answers.items():
            distances = np.array([row["distance"] for row in rows])
            for i in np.flatnonzero(np.abs(distances - reference) > TOLERANCE * np.abs(reference)):
                problems += 1
                print(f"error: {scene.name} {i}: {engine} says {distances[i]}, not {reference[i]}", file=sys.stderr)
    return 1 if problems else 0


def cells(rows: list[dict]) -> list[str]:
    """Return the distance of one row or the range of many, and mean times in microseconds."""
    distances = [row["distance"] for row in rows]
    low, high = min(distances), max(distances)
    times = [f"{np.mean([row[key] for row in rows]) * 1e6:.1f}" for key in KEYS if key in rows[0]]
    return [f"{low:.9g}" if low == high else f"{low:.3g} to {high:.3g}", *times, *[""] * (3 - len(times))]


def write_rows(case: str, engine: str, rows: list[dict]) -> None:
    """Record the range of the distances, and the mean of each time over the poses."""
    distances = [row["distance"] for row in rows]
    record.row(case, "distance minimum", "1", min(distances), engine)
    record.row(case, "distance maximum", "1", max(distances), engine)
    for key in KEYS:
        if key in rows[0]:
            record.row(case, f"{key} mean", "s", float(np.mean([row[key] for row in rows])), engine)


if __name__ == "__main__":
    sys.exit(main())
