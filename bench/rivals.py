"""FCL, Coal and impinge on the same meshes in one run, one thread each: build, all intersecting pairs, first hit.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt
    .venv/bin/python bench/rivals.py

A mesh is set against itself moved: a torus knot of two million triangles unless --nu and --nv say otherwise; a bumpy sphere of
as many, turned so little that the surfaces nearly coincide; a tiny knot of as many amid long slivers; and a rod of slivers
alone, a hundredth as many. Of the last three Coal is not asked. FCL
and Coal get it as arrays, impinge as a PLY file of the same doubles. At full size FCL and Coal need 5 GB each, one
after the other. The answers are compared: a rival that finds other pairs is no yardstick. All is asked in rounds, one
engine after another in each, as a shared machine changes its speed by the minute: a round takes a minute.
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

NO_LIMIT = 10**8  # contacts, more than any pose here has
OFTENER = 5  # runs of impinge for each of a rival's
FIRST_HIT_CALLS = 100  # calls timed as one where one takes microseconds
FIRST_HIT_SECONDS = 1e-3  # that those are to take, where they take longer
COAL_TOLERANCE = 0.01  # share of pairs by which Coal may be off: it decides triangles by iteration


@dataclass(frozen=True)
class Pose:
    """Where the second mesh stands: a rotation as a unit quaternion (w, x, y, z), then a translation."""

    name: str
    translation: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]

    def rotation(self) -> np.ndarray:
        """The (3, 3) matrix for column vectors."""
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
    """One engine at one pose; every list holds the seconds of single runs."""

    engine: str
    pose: str
    pairs: int
    build_seconds: list[float]
    all_pairs_seconds: list[float]
    first_hit_seconds: list[float]


Mesh = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Scene:
    """A mesh, and where it stands against itself."""

    name: str
    mesh: Mesh
    poses: list[Pose]
    is_for_coal: bool = True
    """Coal needs eleven seconds for a query of nearly coincident surfaces, and more than that amid slivers."""


def turn(angle: float) -> tuple[float, float, float, float]:
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    return (float(np.cos(angle / 2)), *(float(c) for c in np.sin(angle / 2) * axis))


KNOT_POSES = [
    Pose("deep", (0.3, 0.2, 0.1), turn(0.7)),
    Pose("shallow", (4.5, 0.5, 0.3), turn(0.7)),
    Pose("apart", (6.0, 0.5, 0.3), turn(0.7)),  # by 0.28, so that boxes overlap deep into both trees
    Pose("far", (100.0, 0.0, 0.0), turn(0.7)),  # costs a call and no descent: what every other first hit holds of it
]


def knots(nu: int, nv: int) -> Scene:
    return Scene("torus_knot", torus_knot(nu, nv), KNOT_POSES)


def near(nu: int, nv: int) -> Scene:
    """With about as many triangles as a knot of nu by nv quads has."""
    return Scene(
        "bumpy_sphere", bumpy_sphere(round((nu * nv / 6) ** 0.5)), [Pose("near", (0.0, 0.0, 0.0), turn(0.01))], False
    )


def slivers(nu: int, nv: int) -> Scene:
    return Scene("stadium", stadium(nu, nv, 300), [Pose("slivers", (0.0006, 0.0004, 0.0005), turn(0.0))], False)


def rods(nu: int, nv: int) -> Scene:
    """With a hundredth as many triangles as a knot, each as long as the rod."""
    return Scene("rod", rod(nu * nv // 100), [Pose("rods", (0.3, 0.2, 0.1), turn(0.7))], False)


SCENES = {"knots": knots, "near": near, "slivers": slivers, "rods": rods}


def seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def measure_fcl(scene: Scene, repeats: int) -> list[Timing]:
    """FCL through python-fcl: BVHModel is its OBBRSS tree in double precision.

    Twice: as python-fcl's caller waits for it, and FCL's own share, without what Python objects cost.
    """
    import fcl

    vertices, faces = scene.mesh
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(vertices))
    filling = seconds(lambda: model.addSubModel(vertices, faces))  # one triangle after another, in Python
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
    """FCL is done, and python-fcl begins to make objects of what it found."""


@contextmanager
def fcl_alone() -> Iterator[None]:
    """Within, queries of python-fcl are over when FCL is.

    After a query it makes four arrays of each contact, which takes as long as the query did: the class that it makes
    them of stops the call at the first.
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
    """A call that finds up to so many pairs of a BVHModel and itself moved, and how many there are."""
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
    """Coal through its own Python module, whose contacts stay in C++ until they are asked for."""
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
    """Times `query(limit)`, which has been called once before, so that its data is warm."""
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
    """impinge by its benchmark program, which reads the mesh from a file and times its own calls."""
    path = ROOT / "target" / "rivals" / f"{scene.name}_{len(scene.mesh[1])}.ply"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_ply(path, *scene.mesh)
    timings = []
    for pose in scene.poses:
        numbers = ",".join(repr(x) for x in (*pose.translation, *pose.quaternion))
        program = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "headline", "--"]
        # A query takes a small part of a rival's: asked more often, its median is as steady as theirs.
        runs = ["--repeats", str(OFTENER * repeats)]
        arguments = ["--mesh", str(path), "--pose-b", numbers, "--threads", "1", "--json", *runs]
        run = subprocess.run(program + arguments, cwd=ROOT, stdout=subprocess.PIPE, check=True)
        answer = json.loads(run.stdout)
        measured = {key: answer[key] for key in ("pairs", "build_seconds", "all_pairs_seconds", "first_hit_seconds")}
        timings.append(Timing(engine="impinge", pose=pose.name, **measured))
    return timings


ENGINES = {"impinge": measure_impinge, "FCL": measure_fcl, "Coal": measure_coal}


def merged(before: list[Timing], round_of_one: list[Timing]) -> list[Timing]:
    """The runs of all rounds, each engine and pose once.

    Raises ValueError where an engine finds other pairs than it found before.
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
    """The poses' names, each once, in the order of the runs."""
    return list(dict.fromkeys(t.pose for t in timings))


def disagreements(timings: list[Timing]) -> list[str]:
    """Where the numbers of pairs differ by more than they may; impinge is the reference, in its absence FCL."""
    found = []
    for pose in poses(timings):
        pairs = {t.engine: t.pairs for t in timings if t.pose == pose}
        reference = next((pairs[e] for e in ("impinge", "FCL") if e in pairs), None)
        for engine, count in pairs.items():
            allowed = COAL_TOLERANCE * (reference or 0) if engine == "Coal" else 0
            if reference is not None and abs(count - reference) > allowed:
                found.append(f"{pose}: {engine} finds {count} pairs where {reference} are expected")
    return found


def table(timings: list[Timing]) -> str:
    """Medians and, in brackets, minima; a ratio is the median of the engine over that of impinge."""
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
    return f"{statistics.median(runs) * scale:.3g} ({min(runs) * scale:.3g})"


def ratio(runs: list[float], base: list[float] | None) -> str:
    return f"{statistics.median(runs) / statistics.median(base):.3g}" if base else "–"


def write_rows(timings: list[Timing]) -> None:
    """Record the numbers of pairs, and the median and minimum of every time."""
    for t in timings:
        record.row(t.pose, "pairs", "1", t.pairs, t.engine)
        record.seconds(t.pose, "build", t.build_seconds, t.engine)
        record.seconds(t.pose, "all pairs", t.all_pairs_seconds, t.engine)
        record.seconds(t.pose, "first hit", t.first_hit_seconds, t.engine)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads round its tube")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--rounds", type=int, default=5, help="times that every engine builds and is asked, in turn")
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
            gc.collect()  # the trees of one rival leave the memory before those of the next come
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
