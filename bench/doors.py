"""Time of the drop-in modules beside trimesh and python-fcl, call by call, in turn, in one run.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/python bench/doors.py

`impinge.trimesh.CollisionManager` has the meshes of trimesh's own manager: 200 boxes, or 100
icospheres of 1,280 faces. `impinge.fcl` has the objects of python-fcl: two torus knots, and pairs
of solids. The same calls are made of both modules. The table shows the minimum of the calls in
microseconds. Answers are compared: whether there is a collision, the names of the pairs, and
distances to 1e-6. trimesh returns the depth of some pair that overlaps as the minimum distance, and
impinge that of the deepest, so such distances are compared by sign only.

The rows that begin with a move move one mesh before each call, so that no side answers from what it
knew.
"""

import argparse
from collections.abc import Callable
from typing import Any

import fcl
import impinge
import impinge.fcl
import impinge.trimesh
import numpy as np
import trimesh
from about import circumstances
from in_turn import Call, Row, print_rows, same_truth
from torus_knot import torus_knot

def turns(rng: np.random.Generator, count: int) -> np.ndarray:
    """Return random rotations, (n, 3, 3)."""
    quaternions = rng.normal(size=(count, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    return impinge.pose(quat_wxyz=quaternions)[:, :3, :3]


def same_names(ours: Any, theirs: Any) -> bool:
    """Report whether two answers with names agree, and whether they name the same pairs."""
    return ours[0] == theirs[0] and ours[1] == theirs[1]


def same_data(ours: Any, theirs: Any) -> bool:
    """Report whether two answers with contacts name the same pairs, in names and in contacts."""
    pairs = [{frozenset(contact.names) for contact in answer[2]} for answer in (ours, theirs)]
    return same_names(ours, theirs) and pairs[0] == pairs[1]


def read(answer: Any) -> Any:
    """Return an answer with contacts, after all their numbers were read."""
    for contact in answer[2]:
        _ = contact.point, contact.normal, contact.depth
    return answer


def same_distance(ours: float, theirs: float) -> bool:
    """Report whether two distances agree, by sign only if the bodies overlap."""
    return abs(ours - theirs) <= 1e-6 * max(1, abs(theirs)) if theirs > 0 else ours <= 0


def of_managers(name: str, mesh: trimesh.Trimesh, count: int, side: float) -> list[Row]:
    """Return the rows of managers with `count` copies of a mesh at random poses in a cube."""
    rng = np.random.default_rng(1)
    poses = np.tile(np.eye(4), (count + 2, 1, 1))
    poses[:, :3, :3] = turns(rng, count + 2)
    poses[:, :3, 3] = rng.uniform(0, side, (count + 2, 3))
    poses[count, :3, 3] = -3
    managers: list[Any] = [impinge.trimesh.CollisionManager(), trimesh.collision.CollisionManager()]
    others: list[Any] = [impinge.trimesh.CollisionManager(), trimesh.collision.CollisionManager()]
    for manager, other in zip(managers, others, strict=True):
        for number in range(count):
            (other if number % 4 == 0 else manager).add_object(f"n{number}", mesh, poses[number])
        for number in range(0, count, 4):
            manager.add_object(f"n{number}", mesh, poses[number])
    apart, among = poses[count], poses[count + 1]
    places = poses[count - 1], poses[count - 1] + np.eye(4, k=3) / 1024
    moved = [0, 0]

    def moving(side: int, ask: Callable[[Any], Any]) -> Call:
        def call() -> Any:
            moved[side] += 1
            managers[side].set_transform(f"n{count - 1}", places[moved[side] % 2])
            return ask(managers[side])

        return call

    def row(question: str, ask: Callable[..., Any], agree: Callable[[Any, Any], bool]) -> Row:
        calls = [lambda pair=pair: ask(*pair) for pair in zip(managers, others, strict=True)]
        return Row(f"{name}: {question}", "trimesh", *calls, agree)

    def after_move(question: str, ask: Callable[[Any], Any], agree: Callable[[Any, Any], bool]) -> Row:
        return Row(f"{name}: move, then {question}", "trimesh", moving(0, ask), moving(1, ask), agree)

    return [
        row("internal", lambda own, _: own.in_collision_internal(), same_truth),
        row("internal, names", lambda own, _: own.in_collision_internal(return_names=True), same_names),
        row("internal, data", lambda own, _: own.in_collision_internal(True, True), same_data),
        row("internal, data, all read", lambda own, _: read(own.in_collision_internal(True, True)), same_data),
        after_move("internal", lambda own: own.in_collision_internal(), same_truth),
        after_move("names", lambda own: own.in_collision_internal(return_names=True), same_names),
        row("single, among", lambda own, _: own.in_collision_single(mesh, among), same_truth),
        row("single, names", lambda own, _: own.in_collision_single(mesh, among, return_names=True), same_names),
        row("single, apart", lambda own, _: own.in_collision_single(mesh, apart), same_truth),
        row("other, names", lambda own, other: own.in_collision_other(other, return_names=True), same_names),
        row("minimum distance, apart", lambda own, _: own.min_distance_single(mesh, apart), same_distance),
        row("minimum distance, among", lambda own, _: own.min_distance_single(mesh, among), same_distance),
        row("minimum distance, internal", lambda own, _: own.min_distance_internal(), same_distance),
        row("add again", lambda own, _: own.add_object("n0", mesh, poses[0]), lambda *_: True),
    ]


def objects(module: Any, make: Callable[[Any], Any], translation: list[float]) -> list[Any]:
    """Return two objects of a geometry, the second one translated."""
    geometry = make(module)
    moved = module.Transform(np.array(translation, float))
    return [module.CollisionObject(geometry), module.CollisionObject(geometry, moved)]


def model(module: Any, vertices: np.ndarray, faces: np.ndarray) -> Any:
    """Return a surface as a `BVHModel`."""
    made = module.BVHModel()
    made.beginModel(len(faces), len(vertices))
    made.addSubModel(vertices, faces)
    made.endModel()
    return made


def of_calls() -> list[Row]:
    """Return the rows of `collide` and `distance` of two objects."""
    vertices, faces = torus_knot(300, 60)
    vertices = vertices.astype(np.float64)
    extent = float(np.ptp(vertices[:, 0]))
    known: dict[str, tuple[Callable[[Any], Any], list[float]]] = {
        f"knots of {len(faces)} faces, far": (lambda module: model(module, vertices, faces), [3 * extent, 0, 0]),
        f"knots of {len(faces)} faces, near": (lambda module: model(module, vertices, faces), [0.3 * extent, 0, 0]),
        "spheres, far": (lambda module: module.Sphere(1), [9, 0, 0]),
        "spheres": (lambda module: module.Sphere(1), [1.5, 0, 0]),
        "cylinders": (lambda module: module.Cylinder(1, 2), [1.5, 0.2, 0.1]),
        "boxes": (lambda module: module.Box(1, 2, 3), [0.5, 0.2, 0.1]),
    }
    rows = []
    for name, (make, translation) in known.items():
        pairs = [(module, objects(module, make, translation)) for module in (impinge.fcl, fcl)]

        def collide(pair: Any, details: bool) -> Call:
            module, (one, two) = pair
            return lambda: module.collide(
                one, two, module.CollisionRequest(enable_contact=details), module.CollisionResult()
            )

        def distance(pair: Any) -> Call:
            module, (one, two) = pair
            return lambda: module.distance(one, two, module.DistanceRequest(), module.DistanceResult())

        rows.append(Row(f"collide: {name}", "python-fcl", *(collide(pair, False) for pair in pairs), same_truth))
        if "knots" not in name:
            calls = [collide(pair, True) for pair in pairs]
            rows.append(Row(f"collide with contact: {name}", "python-fcl", *calls, same_truth))
        if "near" not in name:
            rows.append(Row(f"distance: {name}", "python-fcl", *map(distance, pairs), same_distance))
    return rows


def of_callbacks(count: int) -> list[Row]:
    """Return the rows of managers of `impinge.fcl` with the default callbacks."""
    rng = np.random.default_rng(2)
    rotations, places = turns(rng, count), rng.uniform(0, 8, (count, 3))
    managers = []
    for module in (impinge.fcl, fcl):
        manager = module.DynamicAABBTreeCollisionManager()
        box = module.Box(1, 1, 1)
        made = [
            module.CollisionObject(box, module.Transform(turn, at)) for turn, at in zip(rotations, places, strict=True)
        ]
        manager.registerObjects(made)
        manager.setup()
        managers.append((module, manager, made))

    def collide(pair: Any, most: int) -> Call:
        module, manager, _ = pair

        def call() -> int:
            data = module.CollisionData(module.CollisionRequest(num_max_contacts=most))
            manager.collide(data, module.defaultCollisionCallback)
            return data.result.is_collision

        return call

    def moved(pair: Any) -> Call:
        module, _, made = pair
        return lambda: made[0].setTransform(module.Transform(rotations[0], places[0]))

    first = [collide(pair, 1) for pair in managers]
    return [
        Row(f"{count} boxes, callbacks: first hit", "python-fcl", *first, same_truth),
        Row("set a transform", "python-fcl", *map(moved, managers), lambda *_: True),
    ]


def main() -> None:
    """Print the table, and exit with an error if two answers differ."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="time for each row")
    budget = parser.parse_args().seconds
    print(circumstances(), end="\n\n")
    rows = of_managers("200 boxes", trimesh.creation.box(), 200, 8)
    rows += of_managers("100 icospheres", trimesh.creation.icosphere(subdivisions=3), 100, 12)
    rows += of_calls() + of_callbacks(200)
    print_rows(rows, budget)


if __name__ == "__main__":
    main()
