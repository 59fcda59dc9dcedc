"""Collisions and clearances of robots beside Pinocchio with Coal, in turn, against known verdicts.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/pip install pin==4.1.0
    IMPINGE_DATA=... .venv/bin/python bench/robots.py [--rows 2000] [--repeats 5]

The folder `robots` of IMPINGE_DATA has a Panda and a Talos, and for each 10,000 configurations with
a verdict on which FCL, Coal and impinge agree. Pinocchio places the meshes of the links, and Coal
compares the pairs that the SRDF file leaves, until the first collision. It is called in a loop,
which costs about a microsecond of Python for each configuration. impinge gets all configurations in
one call, on one thread. The run fails if a verdict of either is wrong.

The Panda is also placed in front of a human of 26,756 triangles, where the verdicts of both are
compared. Of its clearances, those that are not zero are compared.
"""

import argparse
import os
import re
import statistics
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import coal
import impinge
import numpy as np
import pinocchio as pin
import record
from about import circumstances

ROBOTS = {
    "Panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf", "panda_self"),
    "Talos": ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "talos_self"),
}

QUESTIONS = {"Panda": ("", " and a human", ", clearance", " and a human, clearance"), "Talos": ("",)}

Ask = Callable[[np.ndarray], np.ndarray]


def prepared(urdf: Path, data: Path, folder: Path) -> Path:
    """Write a URDF file with plain paths, and without mimic joints.

    A mimic joint has a column of its own in the known rows.
    """
    text = urdf.read_text().replace("package://example-robot-data", str(data))
    path = folder / urdf.name
    path.write_text(re.sub(r"<mimic[^>]*/>", "", text))
    return path


def human() -> impinge.Mesh:
    """Return the mesh of the human, where it stands in front of the robot."""
    mesh = impinge.load(Path(__file__).parent.parent / "data" / "human_makehuman_cc0.ply")
    return impinge.Mesh(mesh.vertices + np.array([0.9, 0.0, 0.0]), mesh.faces)


def of_impinge(urdf: Path, srdf: Path, joints: list[str]) -> dict[str, Ask]:
    """Return the questions to impinge. `joints` names the columns of its configurations."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", impinge.LoadWarning)
        robot = impinge.Robot.load(urdf, srdf)
    columns = [joints.index(name) for name in robot.joints]
    scene = impinge.Scene({"human": human()})

    def check(q: np.ndarray, scene: impinge.Scene | None = None) -> np.ndarray:
        with impinge.threads(1):
            return np.asarray(robot.check(q[:, columns], scene).collides)

    def clearance(q: np.ndarray, scene: impinge.Scene | None = None) -> np.ndarray:
        with impinge.threads(1):
            return np.asarray(robot.clearance(q[:, columns], scene).upper)

    return {
        "": check,
        " and a human": lambda q: check(q, scene),
        ", clearance": clearance,
        " and a human, clearance": lambda q: clearance(q, scene),
    }


def of_pinocchio(urdf: Path, srdf: Path) -> dict[str, Ask]:
    """Return the questions to Pinocchio with Coal."""
    model = pin.buildModelFromUrdf(str(urdf))

    def geometry(has_human: bool) -> tuple[pin.GeometryModel, pin.GeometryData]:
        parts = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION)
        parts.addAllCollisionPairs()
        pin.removeCollisionPairs(model, parts, str(srdf))
        if has_human:
            links, mesh = len(parts.geometryObjects), human()
            shape = coal.BVHModelOBBRSS()
            shape.beginModel(len(mesh.faces), len(mesh.vertices))
            shape.addVertices(np.asarray(mesh.vertices, dtype=float))
            shape.addTriangles(np.asarray(mesh.faces, dtype=np.int64))
            shape.endModel()
            added = parts.addGeometryObject(pin.GeometryObject("human", 0, pin.SE3.Identity(), shape))
            for link in range(links):
                parts.addCollisionPair(pin.CollisionPair(link, added))
        shapes = parts.createData()
        for request in shapes.collisionRequests:
            request.enable_contact = False
        return parts, shapes

    placed = model.createData()
    alone, in_scene = geometry(has_human=False), geometry(has_human=True)

    def check(q: np.ndarray, parts: tuple[pin.GeometryModel, pin.GeometryData]) -> np.ndarray:
        return np.array([pin.computeCollisions(model, placed, *parts, row, True) for row in q])

    def clearance(q: np.ndarray, parts: tuple[pin.GeometryModel, pin.GeometryData]) -> np.ndarray:
        def least(row: np.ndarray) -> float:
            nearest = pin.computeDistances(model, placed, *parts, row)
            return max(parts[1].distanceResults[nearest].min_distance, 0.0)

        return np.array([least(row) for row in q])

    return {
        "": lambda q: check(q, alone),
        " and a human": lambda q: check(q, in_scene),
        ", clearance": lambda q: clearance(q, alone),
        " and a human, clearance": lambda q: clearance(q, in_scene),
    }


def agree(found: np.ndarray, expected: np.ndarray) -> bool:
    """Report whether verdicts are equal, or clearances where the robot is free."""
    if found.dtype == bool:
        return np.array_equal(found, expected)
    is_free = expected > 0
    return bool(np.allclose(found[is_free], expected[is_free], rtol=1e-6, atol=1e-9) and np.all(found[~is_free] == 0))


def main() -> None:
    """Print a row for each robot and engine."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=2000)
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    print("\n".join(f"{name}: {value}" for name, value in circumstances("impinge", "pin").items()))
    data = Path(os.environ["IMPINGE_DATA"])
    print("| robot | engine | microseconds a configuration |\n|---|---|---|")
    for name, (urdf, srdf, known) in ROBOTS.items():
        truth = np.load(data / "robots" / "golden" / f"{known}.npz")
        q, collides = truth["q"][: arguments.rows], truth["collides"][: arguments.rows]
        with tempfile.TemporaryDirectory() as folder:
            files = prepared(data / "robots" / urdf, data, Path(folder)), data / "robots" / srdf
            joints = list(pin.buildModelFromUrdf(str(files[0])).names)[1:]
            engines = {"impinge": of_impinge(*files, joints), "Pinocchio with Coal": of_pinocchio(*files)}
        for question in QUESTIONS[name]:
            rows = q if "clearance" not in question else q[: len(q) // 10]
            times: dict[str, list[float]] = {engine: [] for engine in engines}
            truth = collides if question == "" else None
            for _ in range(arguments.repeats):
                for engine, asks in engines.items():
                    start = time.perf_counter()
                    found = asks[question](rows)
                    times[engine].append((time.perf_counter() - start) / len(rows))
                    truth = found if truth is None else truth
                    assert agree(found, truth), f"{engine}: wrong about {name}{question}"
            for engine, runs in times.items():
                print(f"| {name}{question} | {engine} | {1e6 * statistics.median(runs):.2f} |", flush=True)
                record.seconds(f"{name}{question}", "configuration", runs, engine)
            record.row(f"{name}{question}", "rows", "1", len(rows))


if __name__ == "__main__":
    main()
