"""Time of one call from Python at one pose: impinge and python-fcl, in turn, in one run.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/python bench/latency.py

The meshes are two wavy sheets of the same number of faces. They are one above the other, or
crossing. Apart, the queries are `intersects`, `within` at less than the gap, and `distance`.
Crossing, they are the first hit and all pairs, where FCL may return all its contacts. FCL gets its
objects beforehand. The table shows the median of the calls in microseconds. The answers are
compared; numbers of pairs may differ by 2 percent, because FCL decides by tolerances.
"""

import argparse
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

import fcl
import impinge
import numpy as np
import record
from about import circumstances
from poses import fcl_model

FACES = (2, 12, 2_000, 20_000, 200_000, 2_000_000)
GAP = 0.25  # distance of the sheets that are apart
BUDGET = 1.0  # seconds for each query of each size


@dataclass
class Asked:
    """A query as a call of each engine, and a function that compares the two answers."""

    name: str
    ours: Callable[[], object]
    theirs: Callable[[], object]
    agree: Callable[[object, object], bool]


def sheet(faces: int) -> impinge.Mesh:
    """Return a square of side 2 with waves of height 0.1, with about `faces` faces."""
    n = max(1, round((faces / 2) ** 0.5))
    at = np.linspace(-1, 1, n + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(at, at, indexing="ij"))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    triangles = np.vstack([np.c_[first, first + n + 1, first + n + 2], np.c_[first, first + n + 2, first + 1]])
    return impinge.Mesh(np.c_[x, y, 0.05 * np.sin(5 * x) * np.cos(4 * y)], triangles)


def questions(mesh: impinge.Mesh) -> list[Asked]:
    """Return all queries about a sheet and its moved copy."""
    model = fcl_model(mesh)
    one = fcl.CollisionObject(model)

    def other(height: float, turn: float) -> tuple[np.ndarray, fcl.CollisionObject]:
        pose = np.eye(4)
        pose[:3, :3] = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
        pose[2, 3] = height
        return pose, fcl.CollisionObject(model, fcl.Transform(pose[:3, :3], pose[:3, 3]))

    def hits(most: int, thing: fcl.CollisionObject) -> Callable[[], int]:
        def ask() -> int:
            result = fcl.CollisionResult()
            return fcl.collide(one, thing, fcl.CollisionRequest(most, enable_contact=False), result)

        return ask

    def gap(thing: fcl.CollisionObject) -> Callable[[], float]:
        return lambda: fcl.distance(one, thing, fcl.DistanceRequest(), fcl.DistanceResult())

    above, far = other(GAP, 0.0)
    across, crossing = other(0.01, 0.5)
    room = 20 * int(len(mesh.faces) ** 0.5) + 100
    same = lambda a, b: bool(a) == bool(b)  # noqa: E731
    near = lambda a, b: abs(a.upper - b) < 1e-9  # noqa: E731
    return [
        Asked("intersects, apart", lambda: impinge.intersects(mesh, mesh, pose_b=above), hits(1, far), same),
        Asked("intersects, crossing", lambda: impinge.intersects(mesh, mesh, pose_b=across), hits(1, crossing), same),
        Asked("within, false", lambda: impinge.within(mesh, mesh, 0.1, pose_b=above), lambda: gap(far)() <= 0.1, same),
        Asked("distance", lambda: impinge.distance(mesh, mesh, pose_b=above), gap(far), near),
        Asked(
            "pairs, crossing",
            lambda: impinge.intersecting_pairs(mesh, mesh, pose_b=across),
            hits(room, crossing),
            lambda pairs, count: abs(len(pairs) - count) <= 0.02 * count + 4,
        ),
    ]


def medians(asked: Asked) -> list[float]:
    """Return the median seconds of a call of impinge, and of one of python-fcl."""
    taken: list[list[float]] = [[], []]
    begun = time.perf_counter()
    while len(taken[0]) < 3 or (time.perf_counter() - begun < BUDGET and len(taken[0]) < 500):
        for side, ask in enumerate((asked.ours, asked.theirs)):
            start = time.perf_counter()
            ask()
            taken[side].append(time.perf_counter() - start)
    return [statistics.median(times) for times in taken]


def main() -> None:
    """Print the table, and exit with an error if two answers differ."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--faces", type=int, nargs="*", default=FACES)
    arguments = parser.parse_args()
    print(circumstances(), end="\n\n")
    print("| faces | question | impinge, us | python-fcl, us | ratio |")
    print("|---|---|---|---|---|")
    for faces in arguments.faces:
        mesh = sheet(faces)
        for asked in questions(mesh):
            ours, theirs = asked.ours(), asked.theirs()
            if not asked.agree(ours, theirs):
                raise SystemExit(f"{asked.name} of {faces} faces: {ours} and {theirs} differ")
            one, other = medians(asked)
            print(
                f"| {len(mesh.faces)} | {asked.name} | {one * 1e6:.1f} | {other * 1e6:.1f} | {one / other:.2f} |",
                flush=True,
            )
            for engine, median in (("impinge", one), ("python-fcl", other)):
                record.row(f"{len(mesh.faces)} faces: {asked.name}", "call median", "s", median, engine)


if __name__ == "__main__":
    main()
