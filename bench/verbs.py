"""Time of each verb of the Python package beside other libraries, call by call, in one run.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/pip install -r bench/requirements-verbs.txt
    .venv/bin/python bench/verbs.py

The large mesh is a torus knot of 2,000,000 faces, and the scan is the human that comes with the
project, or the mesh of `--scan`. Each library uses the threads that it uses without being told:
impinge and Open3D use all cores for many points, libigl too, and Embree and FCL one. The table
shows the minimum of the calls in microseconds. Answers are compared. Most of the others compute in
single precision, or approximate, so numbers are compared to 1e-4, and a few of many may differ.
FCL's depths of curved shapes are often longer than the shortest way out, so ours may be less.

Loads compare `impinge.load`, which validates the mesh and builds its hierarchy, with `trimesh.load`
without processing, which does neither.
"""

import argparse
import tempfile
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import coal
import fcl
import igl
import impinge
import numpy as np
import open3d
import trimesh
from about import ROOT, circumstances
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from in_turn import Call, Row, print_rows, same_truth
from torus_knot import torus_knot

HUMAN = ROOT / "data" / "human_makehuman_cc0.ply"
LARGE = (2000, 500)  # quads along the knot and around its tube
POINTS = 100_000
RAYS = 400_000
POSES = 1_000

Agree = Callable[[Any, Any], bool]


def close(share: float = 0.0) -> Agree:
    """Return a test that all numbers but a share agree to 1e-4, and infinities agree."""

    def agree(ours: Any, theirs: Any) -> bool:
        ours, theirs = np.atleast_1d(np.asarray(ours, float)), np.atleast_1d(np.asarray(theirs, float))
        return np.isclose(ours, theirs, rtol=1e-4, atol=1e-4).mean() >= 1 - share

    return agree


def same_count(ours: Any, theirs: Any) -> bool:
    """Report whether both answers have the same number of faces."""
    return len(ours.faces) == len(theirs.faces)


def open3d_scene(mesh: impinge.Mesh) -> Any:
    """Return a mesh as a scene of Open3D, in single precision."""
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
    return scene


def coal_model(mesh: impinge.Mesh) -> Any:
    """Return a mesh as a model of Coal."""
    model = coal.BVHModelOBBRSS()
    model.beginModel(mesh.face_count, mesh.vertex_count)
    model.addVertices(mesh.vertices.astype(float))
    model.addTriangles(mesh.faces.astype(int))
    model.endModel()
    return model


def of_large(mesh: impinge.Mesh) -> Iterator[Row]:
    """Yield the rows of single calls with a large mesh."""
    model, here = coal_model(mesh), coal.Transform3s()
    extent = float(np.ptp(mesh.vertices[:, 0]))
    far = np.array([2 * extent, 0, 0])
    pose, there = impinge.pose(far), coal.Transform3s(np.eye(3), far)

    def collide(other: Any, margin: float = 0.0) -> Call:
        def call() -> bool:
            request = coal.CollisionRequest(coal.CollisionRequestFlag.NO_REQUEST, 1)
            request.security_margin = margin
            return coal.collide(model, here, other, there, request, coal.CollisionResult()) > 0

        return call

    yield Row(
        "large, intersects, far", "Coal", lambda: impinge.intersects(mesh, mesh, None, pose), collide(model), same_truth
    )
    yield Row(
        "large, within, far",
        "Coal",
        lambda: impinge.within(mesh, mesh, 0.1, None, pose),
        collide(model, 0.1),
        same_truth,
    )
    corners = np.random.default_rng(4).normal(size=(32, 3))
    shapes = {
        "box": (impinge.Shape.box([0.5, 0.4, 0.3]), coal.Box(1.0, 0.8, 0.6)),
        "sphere": (impinge.Shape.sphere(0.5), coal.Sphere(0.5)),
        "capsule": (impinge.Shape.capsule([0, 0, -0.5], [0, 0, 0.5], 0.2), coal.Capsule(0.2, 1.0)),
        "hull": (impinge.Shape.hull(corners), coal_hull(corners)),
    }
    for name, (ours, theirs) in shapes.items():
        yield Row(
            f"large, intersects {name}, apart",
            "Coal",
            lambda ours=ours: impinge.intersects(mesh, ours, None, pose),
            collide(theirs),
            same_truth,
        )
    tree = EmbreeScene()
    TriangleMesh(tree, mesh.vertices.astype(np.float32)[mesh.faces])
    origin, direction = np.array([9.0, 0.3, 0.2], np.float32), np.array([-1.0, 0.01, 0.02], np.float32)
    first = lambda: tree.run(origin[None], direction[None], query="DISTANCE")[0]  # noqa: E731
    yield Row("large, ray_cast, one ray", "Embree", lambda: mesh.ray_cast(origin, direction).t, first, close())
    scene = open3d_scene(mesh)
    point = np.array([2.9, 0.3, 0.2], np.float32)
    as_rows = open3d.core.Tensor(point[None])
    yield Row(
        "large, closest_point, one point",
        "Open3D",
        lambda: mesh.closest_point(point).point,
        lambda: scene.compute_closest_points(as_rows)["points"].numpy()[0],
        close(),
    )
    yield Row(
        "large, contains, one point",
        "Open3D",
        lambda: mesh.contains(point),
        lambda: scene.compute_occupancy(as_rows).numpy()[0],
        same_truth,
    )
    yield Row(
        "large, signed_distance, one point",
        "Open3D",
        lambda: mesh.signed_distance(point),
        lambda: scene.compute_signed_distance(as_rows).numpy()[0],
        close(),
    )


def coal_hull(points: np.ndarray) -> Any:
    """Return the convex hull of points as a shape of Coal."""
    hull = trimesh.convex.convex_hull(points)
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for corner in hull.vertices:
        corners.append(np.asarray(corner))
    for face in hull.faces:
        triangles.append(coal.Triangle(*map(int, face)))
    return coal.Convex(corners, triangles)


def of_scan(mesh: impinge.Mesh) -> Iterator[Row]:
    """Yield the rows of many points and rays at a scanned mesh."""
    rng = np.random.default_rng(6)
    low, high = mesh.vertices.min(0), mesh.vertices.max(0)
    size = float((high - low).max())
    corners = mesh.vertices[mesh.faces[rng.integers(mesh.face_count, size=POINTS)]]
    on = (corners * rng.dirichlet([1, 1, 1], POINTS)[:, :, None]).sum(1)
    sets = {
        "in the box": rng.uniform(low, high, (POINTS, 3)),
        "near": on + rng.normal(scale=0.002 * size, size=(POINTS, 3)),
        "far": rng.uniform(low, high, (POINTS, 3)) + [3 * size, 0, 0],
    }
    scene = open3d_scene(mesh)
    vertices, faces = mesh.vertices.astype(float), mesh.faces.astype(np.int64)
    windings = igl.FastWindingNumberBVH()
    windings.init(vertices, faces, 2)
    for name, points in sets.items():
        points = points.astype(np.float32)
        tensor, wide = open3d.core.Tensor(points), points.astype(float)
        named = f"scan, 1e5 points {name}: "
        yield Row(
            named + "closest_point",
            "Open3D",
            lambda p=points: mesh.closest_point(p).distance,
            lambda p=tensor: scene.compute_distance(p).numpy(),
            close(0.001),
        )
        yield Row(
            named + "signed_distance",
            "Open3D",
            lambda p=points: mesh.signed_distance(p),
            lambda p=tensor: scene.compute_signed_distance(p).numpy(),
            close(0.01),
        )
        yield Row(
            named + "contains",
            "Open3D",
            lambda p=points: mesh.contains(p),
            lambda p=tensor: scene.compute_occupancy(p).numpy(),
            close(0.01),
        )
        yield Row(
            named + "winding_number",
            "libigl",
            lambda p=points: mesh.winding_number(p),
            lambda p=wide: windings.winding_number(p, 2.0),
            lambda a, b: bool((np.abs(a - b) < 0.2).mean() > 0.99),
        )
    aims = rng.uniform(low, high, (RAYS, 3))
    origins = rng.normal(size=(RAYS, 3))
    origins = (low + high) / 2 + 2 * size * origins / np.linalg.norm(origins, axis=1)[:, None]
    rays = np.hstack([origins, aims - origins]).astype(np.float32)
    split = rays[:, :3].copy(), rays[:, 3:].copy()
    tensor = open3d.core.Tensor(rays)
    yield Row(
        "scan, 4e5 rays: ray_cast",
        "Open3D",
        lambda: mesh.ray_cast(*split).t,
        lambda: scene.cast_rays(tensor)["t_hit"].numpy(),
        close(0.001),
    )
    counted = lambda: np.diff(mesh.ray_cast_all(*split).offsets)  # noqa: E731
    yield Row(
        "scan, 4e5 rays: ray_cast_all",
        "Open3D",
        counted,
        lambda: scene.count_intersections(tensor).numpy(),
        close(0.001),
    )


def of_shapes() -> Iterator[Row]:
    """Yield the rows of pairs of shapes: batches beside FCL, and single calls beside Coal."""
    rng = np.random.default_rng(8)
    corners = rng.normal(size=(32, 3))
    corners /= np.linalg.norm(corners, axis=1)[:, None]
    hull = trimesh.convex.convex_hull(corners)
    flat = np.hstack([np.full((len(hull.faces), 1), 3), hull.faces]).ravel()
    curved = {
        "ellipsoids": ((impinge.Shape.ellipsoid([0.5, 0.7, 1]),) * 2, (fcl.Ellipsoid(0.5, 0.7, 1),) * 2),
        "cylinder and cone": (
            (impinge.Shape.cylinder(0.8, 0.6), impinge.Shape.cone(0.7, 0.7)),
            (fcl.Cylinder(0.6, 1.6), fcl.Cone(0.7, 1.4)),
        ),
        "hulls of 32": ((impinge.Shape.hull(corners),) * 2, (fcl.Convex(hull.vertices, len(hull.faces), flat),) * 2),
    }
    poses = impinge.pose(rng.uniform(-0.7, 0.7, (POSES, 3)))
    quaternions = rng.normal(size=(POSES, 4))
    poses[:, :3, :3] = impinge.pose(quat_wxyz=quaternions / np.linalg.norm(quaternions, axis=1)[:, None])[:, :3, :3]

    def depths(one: Any, two: Any) -> Call:
        objects = fcl.CollisionObject(one), fcl.CollisionObject(two)

        def call() -> np.ndarray:
            found = np.zeros(POSES)
            for row, pose in enumerate(poses):
                objects[1].setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
                result = fcl.CollisionResult()
                fcl.collide(*objects, fcl.CollisionRequest(1, enable_contact=True), result)
                found[row] = max((contact.penetration_depth for contact in result.contacts), default=0)
            return found

        return call

    def no_deeper(ours: np.ndarray, theirs: np.ndarray) -> bool:
        return bool(((ours > 1e-3) == (theirs > 1e-3)).mean() > 0.97 and (ours <= theirs + 1e-3).mean() > 0.99)

    for name, (ours, theirs) in curved.items():
        yield Row(
            f"{name}, 1e3 poses: penetration",
            "python-fcl",
            lambda o=ours: impinge.penetration(*o, None, poses).upper,
            depths(*theirs),
            no_deeper,
        )
    one = poses[0]
    for name, (ours, theirs) in curved.items():
        objects = fcl.CollisionObject(theirs[0]), fcl.CollisionObject(theirs[1], fcl.Transform(one[:3, :3], one[:3, 3]))
        yield Row(
            f"{name}: contacts",
            "python-fcl",
            lambda o=ours: len(impinge.contacts(*o, None, one)),
            lambda o=objects: fcl.collide(*o, fcl.CollisionRequest(4, enable_contact=True), fcl.CollisionResult()),
            same_truth,
        )
    plain = {
        "spheres": (impinge.Shape.sphere(0.5), coal.Sphere(0.5), [0.8, 0.1, 0.2]),
        "capsules": (impinge.Shape.capsule([0, 0, -0.5], [0, 0, 0.5], 0.3), coal.Capsule(0.3, 1.0), [0.4, 0.1, 0.2]),
        "boxes": (impinge.Shape.box([0.5, 0.5, 0.5]), coal.Box(1.0, 1.0, 1.0), [0.8, 0.1, 0.2]),
    }
    here = coal.Transform3s()
    for name, (ours, theirs, at) in plain.items():
        touching, apart = (impinge.pose(np.multiply(at, scale)) for scale in (1, 4))
        there = [coal.Transform3s(pose[:3, :3], pose[:3, 3]) for pose in (touching, apart)]
        yield Row(
            f"{name}: distance",
            "Coal",
            lambda o=ours, pose=apart: impinge.distance(o, o, None, pose).distance,
            lambda t=theirs, place=there[1]: coal.distance(
                t, here, t, place, coal.DistanceRequest(), coal.DistanceResult()
            ),
            close(),
        )
        yield Row(
            f"{name}: contacts",
            "Coal",
            lambda o=ours, pose=touching: len(impinge.contacts(o, o, None, pose)),
            lambda t=theirs, place=there[0]: coal.collide(
                t, here, t, place, coal.CollisionRequest(coal.CollisionRequestFlag.CONTACT, 1), coal.CollisionResult()
            ),
            same_truth,
        )


def of_loads(mesh: impinge.Mesh, folder: Path) -> Iterator[Row]:
    """Yield the rows of loading a mesh from files of four formats, written to a folder."""
    made = trimesh.Trimesh(mesh.vertices.astype(np.float32), mesh.faces, process=False)
    for ending in ("ply", "stl", "obj", "glb"):
        path = folder / f"large.{ending}"
        made.export(path)
        size = path.stat().st_size / 1e6
        yield Row(
            f"load {ending.upper()}, {size:.0f} MB",
            "trimesh",
            lambda path=path: impinge.load(path),
            lambda path=path: trimesh.load(path, process=False, force="mesh"),
            same_count,
        )


def main() -> None:
    """Print the table, and exit with an error if two answers differ."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=1.0, help="time for each row")
    parser.add_argument("--scan", type=Path, default=HUMAN, help="a mesh file for the rows of many points and rays")
    arguments = parser.parse_args()
    print(circumstances("coal", "python-fcl", "libigl", "open3d", "embreex", "trimesh"), end="\n\n")
    large = impinge.Mesh(*torus_knot(*LARGE))
    with tempfile.TemporaryDirectory() as folder:
        rows = chain(of_shapes(), of_scan(impinge.load(arguments.scan)), of_large(large), of_loads(large, Path(folder)))
        print_rows(rows, arguments.seconds)


if __name__ == "__main__":
    main()
