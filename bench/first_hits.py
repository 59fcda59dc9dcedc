"""Compare the first hits of real meshes: impinge, python-fcl and Coal in one run, on one thread.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    IMPINGE_DATA=... .venv/bin/python bench/first_hits.py

The meshes are read from the folder that IMPINGE_DATA names. One mesh is rotated at random and moved
along a random line. Bisection finds the distance at which the two just touch. Four distances are
timed: deep in each other (half of that distance), just in touch, just apart, and plainly apart. FCL
and Coal get their objects beforehand, and a Python loop calls them once for each pose. impinge gets
all poses in one call. If the meshes are plainly apart, most of the loops' time is Python's. The
answers are compared.
"""

import argparse
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import coal
import fcl
import impinge
import numpy as np
import record
from about import circumstances
from poses import fcl_model
from rivals import seconds

WAYS = ("deep", "just in touch", "just apart", "plainly apart")
NEAR = 1e-3  # distance from touching of the "just" poses, relative to the size of the first mesh
HALVINGS = 16  # steps of the bisection


@dataclass
class Scene:
    """Two meshes; the second one moves."""

    name: str
    meshes: tuple[impinge.Mesh, impinge.Mesh]


def scenes(folder: Path) -> list[Scene]:
    """Load the pairs of meshes from the data folder."""
    load = {
        "env": folder / "nasty" / "fcl_resources" / "env.obj",
        "rob": folder / "nasty" / "fcl_resources" / "rob.obj",
        "human": folder / "meshes" / "human_makehuman_cc0.ply",
        "bunny": folder / "meshes" / "stanford-bunny.obj",
        "igea": folder / "meshes" / "igea.ply",
    }
    meshes = {name: impinge.load(path) for name, path in load.items()}
    # Scale to about a quarter of the human, by a power of two, which is exact.
    human, bunny = meshes["human"].vertices, meshes["bunny"].vertices
    scale = 2.0 ** np.round(np.log2(np.ptp(human, axis=0).max() / 4 / np.ptp(bunny, axis=0).max()))
    small = impinge.Mesh(bunny * scale, meshes["bunny"].faces)
    pairs = [("env", "rob"), ("human", "human"), ("bunny", "bunny"), ("igea", "igea")]
    itself = [Scene(f"{a} and {b}", (meshes[a], meshes[b])) for a, b in pairs]
    return [*itself, Scene("human and bunny", (meshes["human"], small))]


def poses(scene: Scene, count: int) -> dict[str, np.ndarray]:
    """Return (count, 4, 4) poses of the second mesh, world from mesh, for each kind of distance."""
    rng = np.random.default_rng(7)
    turns = rng.normal(size=(count, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    along = rng.normal(size=(count, 3))
    along /= np.linalg.norm(along, axis=1)[:, None]
    sizes = [np.linalg.norm(np.ptp(mesh.vertices, axis=0)) for mesh in scene.meshes]
    centers = [(mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2 for mesh in scene.meshes]
    turned = impinge.pose(np.zeros((count, 3)), quat_wxyz=turns)[:, :3, :3]

    def at(way: np.ndarray) -> np.ndarray:
        pose = np.tile(np.eye(4), (count, 1, 1))
        pose[:, :3, :3] = turned
        pose[:, :3, 3] = centers[0] + along * way[:, None] - turned @ centers[1]
        return pose

    low, high = np.zeros(count), np.full(count, sum(sizes))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        meet = impinge.intersects(*scene.meshes, None, at(middle))
        low, high = np.where(meet, middle, low), np.where(meet, high, middle)
    near = NEAR * sizes[0]
    ways = (high / 2, high - near, high + near, high * 1.25)
    return {name: at(way) for name, way in zip(WAYS, ways, strict=True)}


def fcl_loop(scene: Scene) -> Callable[[np.ndarray], list[bool]]:
    """Return a loop that asks python-fcl at each pose whether the meshes collide."""
    a, b = (fcl.CollisionObject(fcl_model(mesh)) for mesh in scene.meshes)
    request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)

    def loop(world_from_b: np.ndarray) -> list[bool]:
        answers = []
        for pose in world_from_b:
            b.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
            answers.append(fcl.collide(a, b, request, fcl.CollisionResult()) > 0)
        return answers

    return loop


def coal_loop(scene: Scene) -> Callable[[np.ndarray], list[bool]]:
    """Return a loop that asks Coal at each pose whether the meshes collide."""

    def model(mesh: impinge.Mesh) -> coal.BVHModelOBBRSS:
        model = coal.BVHModelOBBRSS()
        model.beginModel(mesh.face_count, mesh.vertex_count)
        model.addVertices(mesh.vertices.astype(float))
        model.addTriangles(mesh.faces.astype(np.int64))
        model.endModel()
        return model

    a, b = (model(mesh) for mesh in scene.meshes)
    here, request = coal.Transform3s(), coal.CollisionRequest(coal.CollisionRequestFlag.NO_REQUEST, 1)
    result = coal.CollisionResult()

    def loop(world_from_b: np.ndarray) -> list[bool]:
        answers = []
        for pose in world_from_b:
            result.clear()
            coal.collide(a, here, b, coal.Transform3s(pose[:3, :3], pose[:3, 3]), request, result)
            answers.append(result.isCollision())
        return answers

    return loop


def impinge_call(scene: Scene) -> Callable[[np.ndarray], list[bool]]:
    """Return a call that asks impinge at all poses whether the meshes intersect."""
    return lambda world_from_b: impinge.intersects(*scene.meshes, None, world_from_b).tolist()


ENGINES = {"impinge": impinge_call, "python-fcl": fcl_loop, "Coal": coal_loop}


def main() -> int:
    """Print the table; return 1 if an answer differs, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=300, help="number of poses of each kind")
    parser.add_argument("--repeats", type=int, default=5, help="runs of each; the minimum time counts")
    options = parser.parse_args()
    folder = os.environ.get("IMPINGE_DATA")
    if folder is None:
        sys.exit("IMPINGE_DATA names no folder of extra data")
    for name, value in circumstances("python-fcl", "coal").items():
        print(f"- {name}: `{value}`")
    print(f"\nµs a pose\n\n| meshes | poses | {' | '.join(ENGINES)} |\n" + "|---" * (2 + len(ENGINES)) + "|")
    problems = 0
    for scene in scenes(Path(folder)):
        engines = {name: engine(scene) for name, engine in ENGINES.items()}
        for way, world_from_b in poses(scene, options.poses).items():
            answers, times = {}, []
            for name, ask in engines.items():
                with impinge.threads(1):
                    answers[name] = ask(world_from_b)
                    least = min(seconds(lambda ask=ask, at=world_from_b: ask(at)) for _ in range(options.repeats))
                times.append(f"{least / options.poses * 1e6:.2f}")
                record.row(f"{scene.name}: {way}", "pose minimum", "s", least / options.poses, name)
            print(f"| {scene.name} | {way} | {' | '.join(times)} |", flush=True)
            for name, found in answers.items():
                differing = sum(a != b for a, b in zip(found, answers["impinge"], strict=True))
                problems += differing
                if differing:
                    print(f"error: {scene.name}, {way}: {name} differs at {differing} poses", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
