"""Ten thousand poses of two meshes: one call of impinge, and a Python loop over python-fcl.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    IMPINGE_DATA=... .venv/bin/python bench/poses.py

The meshes, env.obj and rob.obj of FCL's own tests, have 2,180 and 216 triangles. They are read from
the folder that IMPINGE_DATA names. Poses are random and rigid, and many of them collide. FCL's
objects are built beforehand and only get a new transform for each pose, the minimum that a loop can
do. The answers are compared. Every pair of faces that only one engine reports is listed, with the
exact answer by rational arithmetic; so is every distance that differs.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fcl
import impinge
import numpy as np
import record
from about import circumstances

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python" / "tests"))
from oracles import oracle_pairs
from shapes import random_poses

NO_LIMIT = 10**6  # number of contacts; more than any pose has
DISTANCE_TOLERANCE = 1e-6  # allowed error of FCL's distances, relative to the largest extent


def fcl_model(mesh: impinge.Mesh) -> fcl.BVHModel:
    """Return a mesh as a model of python-fcl, in double precision."""
    model = fcl.BVHModel()
    model.beginModel(mesh.face_count, mesh.vertex_count)
    model.addSubModel(mesh.vertices.astype(float), mesh.faces.tolist())
    model.endModel()
    return model


def fcl_loop(a: fcl.BVHModel, b: fcl.BVHModel, world_from_b: np.ndarray, limit: int) -> list[list[tuple[int, int]]]:
    """Return the pairs of faces that FCL reports for each pose, at most `limit`, in its order."""
    one, two = fcl.CollisionObject(a), fcl.CollisionObject(b)
    request = fcl.CollisionRequest(num_max_contacts=limit, enable_contact=False)
    answers = []
    for pose in world_from_b:
        two.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        result = fcl.CollisionResult()
        fcl.collide(one, two, request, result)
        answers.append([(contact.b1, contact.b2) for contact in result.contacts])
    return answers


def fcl_distances(a: fcl.BVHModel, b: fcl.BVHModel, world_from_b: np.ndarray) -> np.ndarray:
    """Return the (n,) distances that FCL reports; at most zero if it finds a collision."""
    one, two = fcl.CollisionObject(a), fcl.CollisionObject(b)
    request = fcl.DistanceRequest()
    answers = []
    for pose in world_from_b:
        two.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
        answers.append(fcl.distance(one, two, request, fcl.DistanceResult()))
    return np.array(answers)


def timed(run: Callable[[], object], repeats: int) -> tuple[float, float, object]:
    """Return the minimum wall and processor seconds of some runs, and the last answer."""
    clock, work, answer = float("inf"), float("inf"), None
    for _ in range(repeats):
        starts = time.perf_counter(), time.process_time()
        answer = run()
        clock, work = min(clock, time.perf_counter() - starts[0]), min(work, time.process_time() - starts[1])
    return clock, work, answer


def overhead(mesh: impinge.Mesh) -> tuple[float, float]:
    """Return the minimum seconds of a call without poses, and of one with two.

    The first is against an empty mesh, the second at poses far apart, so that neither does work.
    """
    far = impinge.pose([1e6, 0, 0])
    here = np.eye(4)
    calls = 2000

    def without() -> None:
        for _ in range(calls):
            impinge.intersects(mesh, EMPTY)

    def with_poses() -> None:
        for _ in range(calls):
            impinge.intersects(mesh, mesh, here, far)

    return timed(without, 20)[0] / calls, timed(with_poses, 20)[0] / calls


def motion(low: np.ndarray, high: np.ndarray, count: int) -> np.ndarray:
    """Return (count, 4, 4) poses of a slow motion across the top of a box, with one full turn."""
    step = np.linspace(0, 1, count)[:, None]
    above = np.array([0, 0, high[2] - low[2]])
    return impinge.pose(low + above + step * (high - low) * [1, 1, 0], rpy=step * [0, 0, 2 * np.pi])


EMPTY = impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))


def disagreements(
    a: impinge.Mesh, b: impinge.Mesh, world_from_b: np.ndarray, ours: impinge.Pairs, theirs: list[list[tuple[int, int]]]
) -> list[str]:
    """Describe each pair that only one engine reports, with the exact answer."""
    found = []
    for row, fcl_pairs in enumerate(theirs):
        own = set(map(tuple, np.asarray(ours[row]).tolist()))
        for face_a, face_b in sorted(own ^ set(fcl_pairs)):
            alone = (a.vertices, a.faces[face_a : face_a + 1]), (b.vertices, b.faces[face_b : face_b + 1])
            who = "impinge" if (face_a, face_b) in own else "FCL"
            truth = "intersect" if len(oracle_pairs(*alone, pose_b=world_from_b[row])) else "do not intersect"
            found.append(f"pose {row}: faces {face_a} and {face_b}: reported by {who} alone; in truth they {truth}")
    return found


def main() -> int:
    """Print the times and the disagreements, and return 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=10_000)
    parser.add_argument("--repeats", type=int, default=5, help="runs of each; the minimum time counts")
    parser.add_argument("--builder", default="auto", help="how impinge builds its hierarchies")
    options = parser.parse_args()
    folder = os.environ.get("IMPINGE_DATA")
    if folder is None:
        sys.exit("IMPINGE_DATA names no folder of extra data")
    meshes = Path(folder) / "nasty" / "fcl_resources"
    about = circumstances("python-fcl")
    env, rob = impinge.load(meshes / "env.obj"), impinge.load(meshes / "rob.obj")
    for mesh in (env, rob):
        mesh.rebuild(options.builder)
    low, high = env.vertices.min(axis=0), env.vertices.max(axis=0)
    world_from_rob = random_poses(options.poses, (high - low) / 2, seed=1)
    world_from_rob[:, :3, 3] += (low + high) / 2
    fcl_env, fcl_rob = fcl_model(env), fcl_model(rob)

    rows, problems = [], []

    def race(name: str, loop: Callable[[], object], ask: Callable[[], object], repeats: int) -> tuple[Any, Any]:
        """Time both engines, and return the answers of FCL and of impinge."""
        *seconds, theirs = timed(loop, repeats)
        rows.append([name, "python-fcl, a loop", 1, *seconds])
        for n in (1, os.cpu_count() or 1):
            with impinge.threads(n):
                *own, ours = timed(ask, options.repeats)
            rows.append([name, "impinge, one call", n, *own])
        return theirs, ours

    theirs, ours = race(
        "first hit",
        lambda: fcl_loop(fcl_env, fcl_rob, world_from_rob, 1),
        lambda: impinge.intersects(env, rob, None, world_from_rob),
        2,
    )
    differing = np.flatnonzero(np.array([bool(pairs) for pairs in theirs]) != ours)
    problems += [f"first hit, pose {row}: FCL says {bool(theirs[row])}, impinge {ours[row]}" for row in differing]

    theirs, ours = race(
        "all pairs",
        lambda: fcl_loop(fcl_env, fcl_rob, world_from_rob, NO_LIMIT),
        lambda: impinge.intersecting_pairs(env, rob, None, world_from_rob),
        1,
    )
    problems += disagreements(env, rob, world_from_rob, ours, theirs)
    doubles = sum(len(pairs) - len(set(pairs)) for pairs in theirs)
    total = len(ours.rows)

    for name, poses in (("distance", world_from_rob), ("distance along a motion", motion(low, high, options.poses))):
        theirs, far = race(
            name,
            lambda poses=poses: fcl_distances(fcl_env, fcl_rob, poses),
            lambda poses=poses: impinge.distance(env, rob, None, poses),
            1,
        )
        differing = np.flatnonzero(
            np.abs(np.maximum(theirs, 0) - far.distance) > DISTANCE_TOLERANCE * (high - low).max()
        )
        problems += [f"{name}, pose {row}: FCL says {theirs[row]}, impinge {far.distance[row]}" for row in differing]

    for key, value in about.items():
        print(f"- {key}: `{value}`")
    print(f"\n{options.poses} poses, {ours.counts.astype(bool).mean():.0%} collide, {total} pairs\n")
    print("| question | engine | threads | seconds | ratio | of processors | ratio |\n" + "|---" * 7 + "|")
    for name, engine, n, clock, work in rows:
        base = next(row for row in rows if row[0] == name)
        print(f"| {name} | {engine} | {n} | {clock:.3f} | {base[3] / clock:.1f} | {work:.3f} | {base[4] / work:.1f} |")
        case = f"{name}, {options.poses} poses, {n} threads"
        record.row(case, "all poses minimum", "s", clock, engine.split(",")[0])
        record.row(case, "processor time minimum", "s", work, engine.split(",")[0])
    without, with_poses = overhead(env)
    print(
        f"\none call: {without * 1e6:.2f} us against an empty mesh, {with_poses * 1e6:.2f} us with two poses, far apart"
    )
    print(f"\nFCL reports {doubles} pairs twice; pairs on which the two differ: {len(problems)}")
    for problem in problems:
        print(f"- {problem}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
