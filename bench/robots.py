"""Self-collision of robots beside Pinocchio with Coal, in turn, against known verdicts.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/pip install pin==4.1.0
    IMPINGE_DATA=... .venv/bin/python bench/robots.py [--rows 2000] [--repeats 5]

The folder `robots` of IMPINGE_DATA has a Panda and a Talos, and for each 10,000 configurations with
a verdict on which FCL, Coal and impinge agree. Pinocchio places the meshes of the links, and Coal
compares the pairs that the SRDF file leaves, until the first collision. It is called in a loop,
which costs about a microsecond of Python for each configuration. impinge gets all configurations in
one call, on one thread. The run fails if a verdict of either is wrong.
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

import impinge
import numpy as np
import pinocchio as pin
import record
from about import circumstances

ROBOTS = {
    "Panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf", "panda_self"),
    "Talos": ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "talos_self"),
}


def prepared(urdf: Path, data: Path, folder: Path) -> Path:
    """Write a URDF file with plain paths, and without mimic joints.

    A mimic joint has a column of its own in the known rows.
    """
    text = urdf.read_text().replace("package://example-robot-data", str(data))
    path = folder / urdf.name
    path.write_text(re.sub(r"<mimic[^>]*/>", "", text))
    return path


def of_impinge(urdf: Path, srdf: Path, joints: list[str]) -> Callable[[np.ndarray], np.ndarray]:
    """Return the check of impinge. `joints` names the columns of its configurations."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", impinge.LoadWarning)
        robot = impinge.Robot.load(urdf, srdf)
    columns = [joints.index(name) for name in robot.joints]

    def check(q: np.ndarray) -> np.ndarray:
        with impinge.threads(1):
            return np.asarray(robot.check(q[:, columns]).collides)

    return check


def of_pinocchio(urdf: Path, srdf: Path) -> Callable[[np.ndarray], np.ndarray]:
    """Return the check of Pinocchio with Coal."""
    model = pin.buildModelFromUrdf(str(urdf))
    geometry = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, str(srdf))
    placed, shapes = model.createData(), geometry.createData()
    for request in shapes.collisionRequests:
        request.enable_contact = False

    def check(q: np.ndarray) -> np.ndarray:
        return np.array([pin.computeCollisions(model, placed, geometry, shapes, row, True) for row in q])

    return check


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
            engines = {"Pinocchio with Coal": of_pinocchio(*files), "impinge": of_impinge(*files, joints)}
        times: dict[str, list[float]] = {engine: [] for engine in engines}
        for _ in range(arguments.repeats):
            for engine, check in engines.items():
                start = time.perf_counter()
                found = check(q)
                times[engine].append((time.perf_counter() - start) / len(q))
                assert np.array_equal(found, collides), f"{engine}: a wrong verdict about {name}"
        for engine, runs in times.items():
            print(f"| {name} | {engine} | {1e6 * statistics.median(runs):.2f} |", flush=True)
            record.seconds(name, "configuration", runs, engine)
        record.row(name, "rows", "1", len(q))


if __name__ == "__main__":
    main()
