"""Compare FCL, Coal and impinge on the same meshes: build, all intersecting pairs, first hit.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt
    .venv/bin/python bench/rivals.py

Each mesh is tested against its moved copy, on one thread. The meshes are a torus knot of two
million triangles (see --nu and --nv); a bumpy sphere of the same size, rotated so little that the
surfaces nearly coincide; a tiny knot of the same size among long slivers; and a rod that consists
of slivers, 1 % of that size. Coal is not run on the last three. FCL and Coal get the mesh as
arrays, impinge as a PLY file of the same doubles. At full size FCL and Coal need 5 GB each, one
after the other. The answers are compared, because times of wrong answers mean nothing. All engines
run in turn in each of several rounds of about a minute, because a shared machine changes its speed
by the minute.
"""

import argparse
import gc
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import record
from about import ROOT, circumstances, print_circumstances
from adversaries import bumpy_sphere, rod, stadium
from torus_knot import torus_knot, write_ply

NO_LIMIT = 10**8  # number of contacts; more than any pose has
OFTENER = 5  # number of runs of impinge for each run of a rival
FIRST_HIT_CALLS = 100  # maximum number of calls that are timed together
FIRST_HIT_SECONDS = 1e-3  # target time of the calls that are timed together
COAL_TOLERANCE = 0.01  # allowed relative error of Coal's number of pairs: it decides triangles by iteration


@dataclass(frozen=True)
class Pose:
    """Pose of the second mesh, world from mesh, with a unit quaternion (w, x, y, z)."""

    name: str
    translation: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]

    def rotation(self) -> np.ndarray:
        """Return the (3, 3) rotation matrix, for column vectors."""
        w, x, y, z = self.quaternion
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )


@dataclass
class Timing:
    """Result of one engine at one pose. Every list contains the seconds of single runs."""

    engine: str
    pose: str
    pairs: int
    build_seconds: list[float]
    all_pairs_seconds: list[float]
    first_hit_seconds: list[float]


Mesh = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Scene:
    """A mesh, and the poses of its copy."""

    name: str
    mesh: Mesh
    poses: list[Pose]
    is_for_coal: bool = True
    """Whether Coal runs on this scene. It takes 11 seconds for a query of nearly coincident
    surfaces, and longer for one among slivers."""


def turn(angle: float) -> tuple[float, float, float, float]:
    """Return the quaternion of a rotation about (1, 2, 3) by an angle in radians."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    return (float(np.cos(angle / 2)), *(float(c) for c in np.sin(angle / 2) * axis))


KNOT_POSES = [
    Pose("deep", (0.3, 0.2, 0.1), turn(0.7)),
    Pose("shallow", (4.5, 0.5, 0.3), turn(0.7)),
    Pose("apart", (6.0, 0.5, 0.3), turn(0.7)),  # 0.28 apart: boxes overlap deep into both trees
    Pose("far", (100.0, 0.0, 0.0), turn(0.7)),  # the cost of a call without a descent
]


def knots(nu: int, nv: int) -> Scene:
    """Return the torus knot of nu by nv quads."""
    return Scene("torus_knot", torus_knot(nu, nv), KNOT_POSES)


def near(nu: int, nv: int) -> Scene:
    """Return the bumpy sphere, with about as many triangles as a knot of nu by nv quads."""
    return Scene(
        "bumpy_sphere", bumpy_sphere(round((nu * nv / 6) ** 0.5)), [Pose("near", (0.0, 0.0, 0.0), turn(0.01))], False
    )


def slivers(nu: int, nv: int) -> Scene:
    """Return the tiny knot of nu by nv quads among slivers."""
    return Scene("stadium", stadium(nu, nv, 300), [Pose("slivers", (0.0006, 0.0004, 0.0005), turn(0.0))], False)


def rods(nu: int, nv: int) -> Scene:
    """Return the rod: 1 % of the triangles of a knot of nu by nv quads, each as long as the rod."""
    return Scene("rod", rod(nu * nv // 100), [Pose("rods", (0.3, 0.2, 0.1), turn(0.7))], False)


SCENES = {"knots": knots, "near": near, "slivers": slivers, "rods": rods}


def seconds(run: Callable[[], object]) -> float:
    """Return the time of a call, in seconds."""
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def measure_fcl(scene: Scene, repeats: int) -> list[Timing]:
    """Time FCL through python-fcl, whose BVHModel is FCL's OBBRSS tree in double precision.

    Each pose has two results: the whole call of python-fcl, and FCL's own share of it, without the
    creation of Python objects.
    """
    import fcl

    vertices, faces = scene.mesh
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(vertices))
    filling = seconds(lambda: model.addSubModel(vertices, faces))  # a Python loop over the triangles
    build = [seconds(model.endModel)]
    whole_build = [filling + build[0]]

    timings = []
    for pose in scene.poses:
        query, pairs = fcl_query(model, pose)
        timings.append(time_queries("python-fcl", pose, pairs, whole_build, query, repeats))
        with fcl_alone():
            timings.append(time_queries("FCL", pose, pairs, build, query, repeats))
    return timings


class FirstContact(Exception):
    """Raised when FCL is done, and python-fcl begins to convert its contacts to objects."""


@contextmanager
def fcl_alone() -> Iterator[None]:
    """End queries of python-fcl within a ``with`` block when FCL itself is done.

    After a query, python-fcl makes four arrays for each contact, which takes as long as the query.
    The class of contacts is replaced, so that the first contact raises `FirstContact`.
    """
    import fcl

    def stop() -> None:
        raise FirstContact

    contact, fcl.fcl.Contact = fcl.fcl.Contact, stop
    try:
        yield
    finally:
        fcl.fcl.Contact = contact


def fcl_query(model: Any, pose: Pose) -> tuple[Callable[[int], None], int]:
    """Return a query for up to `limit` pairs of a model and its moved copy, and their number."""
    import fcl

    a = fcl.CollisionObject(model, fcl.Transform())
    b = fcl.CollisionObject(model, fcl.Transform(pose.rotation(), np.array(pose.translation)))

    def query(limit: int) -> None:
        try:
            fcl.collide(a, b, fcl.CollisionRequest(num_max_contacts=limit, enable_contact=False))
        except FirstContact:
            pass

    result = fcl.CollisionResult()
    fcl.collide(a, b, fcl.CollisionRequest(num_max_contacts=NO_LIMIT, enable_contact=False), result)
    return query, len({(c.b1, c.b2) for c in result.contacts})


def measure_coal(scene: Scene, repeats: int) -> list[Timing]:
    """Time Coal through its own Python module, which converts contacts only on request."""
    import coal

    vertices, faces = scene.mesh
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(faces), len(vertices))
    model.addVertices(vertices)
    model.addTriangles(faces.astype(np.int64))
    build = [seconds(model.endModel)]

    timings = []
    for pose in scene.poses:
        world_from_b = coal.Transform3s(pose.rotation(), np.array(pose.translation))
        result = coal.CollisionResult()

        def query(limit: int, world_from_b=world_from_b, result=result) -> None:
            result.clear()
            request = coal.CollisionRequest(coal.CollisionRequestFlag.NO_REQUEST, limit)
            coal.collide(model, coal.Transform3s(), model, world_from_b, request, result)

        query(NO_LIMIT)
        timings.append(time_queries("Coal", pose, result.numContacts(), build, query, repeats))
    return timings


def time_queries(
    engine: str, pose: Pose, pairs: int, build: list[float], query: Callable[[int], None], repeats: int
) -> Timing:
    """Time `query(limit)`, which was called once before, so that its data is in the cache."""
    once = seconds(lambda: query(1))
    calls = int(min(FIRST_HIT_CALLS, max(1, FIRST_HIT_SECONDS / once)))
    return Timing(
        engine=engine,
        pose=pose.name,
        pairs=pairs,
        build_seconds=build,
        all_pairs_seconds=[seconds(lambda: query(NO_LIMIT)) for _ in range(repeats)],
        first_hit_seconds=[seconds(lambda: [query(1) for _ in range(calls)]) / calls for _ in range(repeats)],
    )


def measure_impinge(scene: Scene, repeats: int) -> list[Timing]:
    """Time impinge by its benchmark program, which reads the mesh from a file."""
    path = ROOT / "target" / "rivals" / f"{scene.name}_{len(scene.mesh[1])}.ply"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_ply(path, *scene.mesh)
    timings = []
    for pose in scene.poses:
        numbers = ",".join(repr(x) for x in (*pose.translation, *pose.quaternion))
        program = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "headline", "--"]
        # A query takes a small part of a rival's time. With more runs its median is as stable.
        runs = ["--repeats", str(OFTENER * repeats)]
        arguments = ["--mesh", str(path), "--pose-b", numbers, "--threads", "1", "--json", *runs]
        run = subprocess.run(program + arguments, cwd=ROOT, stdout=subprocess.PIPE, check=True)
        answer = json.loads(run.stdout)
        measured = {key: answer[key] for key in ("pairs", "build_seconds", "all_pairs_seconds", "first_hit_seconds")}
        timings.append(Timing(engine="impinge", pose=pose.name, **measured))
    return timings


ENGINES = {"impinge": measure_impinge, "FCL": measure_fcl, "Coal": measure_coal}


def merged(before: list[Timing], round_of_one: list[Timing]) -> list[Timing]:
    """Return the results of all rounds, with the runs of each engine and pose in one result.

    Raise a `ValueError` if an engine finds another number of pairs than before.
    """
    by_name = {(t.engine, t.pose): t for t in before}
    for new in round_of_one:
        name = (new.engine, new.pose)
        old = by_name.get(name)
        if old is None:
            by_name[name] = new
        elif old.pairs != new.pairs:
            raise ValueError(f"{new.engine} at {new.pose} finds {old.pairs} pairs, then {new.pairs}")
        else:
            by_name[name] = replace(
                old,
                build_seconds=old.build_seconds + new.build_seconds,
                all_pairs_seconds=old.all_pairs_seconds + new.all_pairs_seconds,
                first_hit_seconds=old.first_hit_seconds + new.first_hit_seconds,
            )
    return list(by_name.values())


def poses(timings: list[Timing]) -> list[str]:
    """Return the names of the poses, each once, in the order of the runs."""
    return list(dict.fromkeys(t.pose for t in timings))


def disagreements(timings: list[Timing]) -> list[str]:
    """Describe each number of pairs that differs from the reference by more than the tolerance.

    The reference is impinge, or FCL if impinge did not run.
    """
    found = []
    for pose in poses(timings):
        pairs = {t.engine: t.pairs for t in timings if t.pose == pose}
        reference = next((pairs[e] for e in ("impinge", "FCL") if e in pairs), None)
        for engine, count in pairs.items():
            allowed = COAL_TOLERANCE * (reference or 0) if engine == "Coal" else 0
            if reference is not None and abs(count - reference) > allowed:
                found.append(f"{pose}: {engine} finds {count} pairs; {reference} are expected")
    return found


def table(timings: list[Timing]) -> str:
    """Return a Markdown table of medians (minima); ratios are to the median of impinge."""
    ours = {t.pose: t for t in timings if t.engine == "impinge"}
    rows = ["| pose | engine | pairs | build, s | all pairs, ms | ratio | first hit, µs | ratio |", "|" + "---|" * 8]
    for pose in poses(timings):
        for t in (t for t in timings if t.pose == pose):
            base = ours.get(t.pose)
            cells = [
                t.pose,
                t.engine,
                str(t.pairs),
                spread(t.build_seconds, 1.0),
                spread(t.all_pairs_seconds, 1e3),
                ratio(t.all_pairs_seconds, base and base.all_pairs_seconds),
                spread(t.first_hit_seconds, 1e6),
                ratio(t.first_hit_seconds, base and base.first_hit_seconds),
            ]
            rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def spread(runs: list[float], scale: float) -> str:
    """Return the median and, in brackets, the minimum of some runs, times `scale`."""
    return f"{statistics.median(runs) * scale:.3g} ({min(runs) * scale:.3g})"


def ratio(runs: list[float], base: list[float] | None) -> str:
    """Return the median of some runs divided by that of `base`; a dash if there is no base."""
    return f"{statistics.median(runs) / statistics.median(base):.3g}" if base else "–"


def write_rows(timings: list[Timing]) -> None:
    """Record the numbers of pairs, and the median and the minimum of each time."""
    for t in timings:
        record.row(t.pose, "pairs", "1", t.pairs, t.engine)
        record.seconds(t.pose, "build", t.build_seconds, t.engine)
        record.seconds(t.pose, "all pairs", t.all_pairs_seconds, t.engine)
        record.seconds(t.pose, "first hit", t.first_hit_seconds, t.engine)


def main() -> int:
    """Print the table; return 1 if the engines disagree, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads around its tube")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--rounds", type=int, default=5, help="number of rounds; in each, all engines run in turn")
    parser.add_argument(
        "--repeats",
        type=int,
        default=3,
        help="runs of each query of FCL and Coal in a round; impinge has five times as many",
    )
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=list(ENGINES))
    options = parser.parse_args()

    about = circumstances("python-fcl", "coal")
    scenes = [SCENES[name](options.nu, options.nv) for name in options.scenes]
    timings = []
    for _ in range(options.rounds):
        for scene, engine in product(scenes, options.engines):
            if engine == "Coal" and not scene.is_for_coal:
                continue
            timings = merged(timings, ENGINES[engine](scene, options.repeats))
            gc.collect()  # free the trees of one rival before the next one runs
    problems = disagreements(timings)
    print_circumstances(
        about, "One thread; median (minimum) of the runs; a ratio is the engine's median over impinge's."
    )
    print(table(timings))
    write_rows(timings)
    for problem in problems:
        print(f"error: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
