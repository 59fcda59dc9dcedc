"""FCL, Coal and impinge: distances of the same two meshes in one run, one thread each.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt
    .venv/bin/python bench/rivals_distance.py

Two knots apart by more and by less, and one moved along a path of small steps, where impinge starts from the last
witness and Coal from its cached guess. The distances are compared: they must be equal to 1e-9. At full size FCL and
Coal need 5 GB each, one after the other; --nu and --nv make the meshes smaller.
"""

import argparse
import gc
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from rivals import ROOT, circumstances, seconds
from torus_knot import torus_knot, write_ply

TOLERANCE = 1e-9  # relative difference of distances, as no engine but ours says how far it may be off
STEPS = 20  # poses of the path
Mesh = tuple[np.ndarray, np.ndarray]
Pose = tuple[float, float, float, float, float, float, float]


def turned(translation: tuple[float, float, float], angle: float = 0.7) -> Pose:
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    return (*translation, float(np.cos(angle / 2)), *(float(c) for c in np.sin(angle / 2) * axis))


def poses() -> list[tuple[str, Pose]]:
    named = [("apart", turned((6.0, 0.5, 0.3))), ("near", turned((5.72, 0.5, 0.3))), ("far", turned((9.0, 0.0, 0.0)))]
    path = [(f"step {i}", turned((6.0, 0.5 + 0.002 * i, 0.3), 0.7 + 0.002 * i)) for i in range(STEPS)]
    return named + path


def rotation(pose: Pose) -> np.ndarray:
    w, x, y, z = pose[3:]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def measure_fcl(mesh: Mesh, repeats: int) -> list[dict]:
    import fcl

    vertices, faces = mesh
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(vertices))
    model.addSubModel(vertices, faces.tolist())
    model.endModel()
    answers = []
    for _, pose in poses():
        a = fcl.CollisionObject(model, fcl.Transform())
        b = fcl.CollisionObject(model, fcl.Transform(rotation(pose), np.array(pose[:3])))
        request = fcl.DistanceRequest()
        distance = fcl.distance(a, b, request, fcl.DistanceResult())
        cold = [seconds(lambda: fcl.distance(a, b, request, fcl.DistanceResult())) for _ in range(repeats)]
        answers.append({"distance": distance, "cold": min(cold)})
    return answers


def measure_coal(mesh: Mesh, repeats: int) -> list[dict]:
    import coal

    vertices, faces = mesh
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(faces), len(vertices))
    model.addVertices(vertices)
    model.addTriangles(faces.astype(np.int64))
    model.endModel()
    answers = []
    for _, pose in poses():
        world_from_b = coal.Transform3s(rotation(pose), np.array(pose[:3]))

        def query(world_from_b=world_from_b) -> float:
            result = coal.DistanceResult()
            return coal.distance(model, coal.Transform3s(), model, world_from_b, coal.DistanceRequest(), result)

        distance = query()
        answers.append({"distance": distance, "cold": min(seconds(query) for _ in range(repeats))})
    return answers


def measure_impinge(mesh: Mesh, repeats: int) -> list[dict]:
    folder = ROOT / "target" / "rivals"
    folder.mkdir(parents=True, exist_ok=True)
    path, rows = folder / f"torus_knot_{len(mesh[1])}.ply", folder / "poses.txt"
    write_ply(path, *mesh)
    rows.write_text("".join(",".join(repr(x) for x in pose) + "\n" for _, pose in poses()))
    program = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "distance", "--"]
    arguments = ["--mesh", str(path), "--poses", str(rows), "--repeats", str(repeats), "--json"]
    run = subprocess.run(program + arguments, cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True)
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    return [
        {
            "distance": line["distance"],
            "cold": min(line["cold_seconds"]),
            "same witness": min(line["seeded_seconds"]),
            "last witness": line["following_seconds"],
        }
        for line in lines
    ]


ENGINES = {"impinge": measure_impinge, "FCL": measure_fcl, "Coal": measure_coal}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads round its tube")
    parser.add_argument("--repeats", type=int, default=9, help="runs of each query")
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=list(ENGINES))
    options = parser.parse_args()

    for name, value in circumstances().items():
        print(f"- {name}: `{value}`")
    mesh = torus_knot(options.nu, options.nv)
    answers = {}
    for engine in options.engines:
        answers[engine] = ENGINES[engine](mesh, options.repeats)
        gc.collect()
    print("\n| pose | engine | distance | cold, µs | same witness, µs | last witness, µs |\n" + "|---|---|---|---|---|---|")
    problems = 0
    for i, (name, _) in enumerate(poses()):
        reference = next(iter(answers.values()))[i]["distance"]
        for engine, rows in answers.items():
            row = rows[i]
            times = [f"{row[key] * 1e6:.1f}" if key in row else "" for key in ("cold", "same witness", "last witness")]
            print(f"| {name} | {engine} | {row['distance']:.12g} | " + " | ".join(times) + " |")
            if abs(row["distance"] - reference) > TOLERANCE * abs(reference):
                problems += 1
                print(f"error: {name}: {engine} says {row['distance']}, not {reference}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
