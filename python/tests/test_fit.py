"""Hulls and volumes against closed forms and qhull; all of them contain their points."""

import impinge
import numpy as np
import pytest
from impinge import fit
from shapes import cube, random_poses, torus
from visible_state import state

RNG = np.random.default_rng(17)
CLOUDS = {
    "cloud": RNG.normal(size=(500, 3)) * [1, 2, 5],
    "far away": RNG.normal(size=(200, 3)) * 1e-3 + [1e6, -1e6, 1e6],
    "single precision": RNG.normal(size=(300, 3)).astype(np.float32),
    "grid": np.stack(np.meshgrid(*[np.arange(5.0)] * 3), axis=-1).reshape(-1, 3),
    "torus": torus()[0],
    "line": np.arange(20)[:, None] * [1.0, 2, 3],
    "plane": np.pad(RNG.normal(size=(50, 2)), ((0, 0), (0, 1))),
    "one point": np.ones((1, 3)),
    "duplicates": np.full((7, 3), 0.1),
}
TOLERANCE = 1e-12  # relative to the magnitudes, for rounding in the checks


def slack(points):
    return TOLERANCE * (1 + np.abs(points).max())


def in_sphere(points, sphere):
    return np.linalg.norm(points - sphere.center, axis=1) - sphere.radius


def to_segment(points, start, along):
    t = np.clip((points - start) @ along / max(along @ along, 1e-300), 0, 1)
    return points - start - t[:, None] * along


@pytest.mark.parametrize("name", CLOUDS)
def test_every_volume_contains_its_points(name):
    points = CLOUDS[name]
    double, tiny = points.astype(float), slack(points.astype(float))
    for method in ("minimal", "mean", "box", "ritter", "principal", "refined"):
        sphere = fit.sphere(points, method)
        assert (in_sphere(double, sphere) <= tiny).all()
        assert sphere.lower <= sphere.radius
        assert sphere.radius <= 2.01 * fit.minimal_sphere(points).radius + tiny
        assert sphere.volume == pytest.approx(4 / 3 * np.pi * sphere.radius**3)
        assert sphere.surface_area == pytest.approx(4 * np.pi * sphere.radius**2)
    aabb = fit.aabb(points)
    assert np.array_equal(aabb.low, double.min(axis=0))
    assert np.array_equal(aabb.high, double.max(axis=0))
    for method in ("least", "principal"):
        obb = fit.obb(points, method)
        assert (np.abs((double - obb.center) @ obb.axes.T) <= obb.half_extents + tiny).all()
        assert np.allclose(obb.axes @ obb.axes.T, np.eye(3), atol=1e-12)
        assert obb.volume == pytest.approx(8 * np.prod(obb.half_extents))
        assert obb.volume_lower <= obb.volume
    capsule = fit.capsule(points)
    away = to_segment(double, capsule.start, capsule.end - capsule.start)
    assert (np.linalg.norm(away, axis=1) <= capsule.radius + tiny).all()
    lozenge = fit.lozenge(points)
    u, v = lozenge.edges
    s, t = (np.clip((double - lozenge.corner) @ e / max(e @ e, 1e-300), 0, 1) for e in (u, v))
    away = double - lozenge.corner - s[:, None] * u - t[:, None] * v  # the edges are orthogonal
    assert (np.linalg.norm(away, axis=1) <= lozenge.radius + tiny).all()
    for k in (14, 18, 26):
        kdop = fit.kdop(points, k)
        assert len(kdop.directions) == len(kdop.low) == len(kdop.high) == k // 2
        extents = double @ kdop.directions.T
        assert (extents >= kdop.low - tiny).all()
        assert (extents <= kdop.high + tiny).all()
        assert np.allclose(extents.min(axis=0), kdop.low, rtol=1e-12, atol=tiny)


@pytest.mark.parametrize("name", CLOUDS)
def test_minimal_spheres_are_minimal(name):
    points = CLOUDS[name]
    sphere = impinge.minimal_sphere(points)
    assert sphere.radius - sphere.lower <= 1e-12 * (1 + np.abs(points).max())
    others = [fit.sphere(points, method).radius for method in ("mean", "box", "ritter", "principal", "refined")]
    assert sphere.lower <= min(others)
    shuffled = impinge.minimal_sphere(RNG.permutation(points))
    assert shuffled.radius == pytest.approx(sphere.radius, rel=1e-12, abs=1e-15)


def test_volumes_of_known_shapes_are_exact():
    turned = cube()[0] @ random_poses(1, 0, 5)[0, :3, :3].T
    assert fit.obb(turned).volume == pytest.approx(1)
    assert impinge.minimal_sphere(turned).radius == pytest.approx(np.sqrt(0.75))
    rod = fit.capsule([[0, 0, 0], [10, 0, 0], [5, 1, 0], [5, -1, 0]])
    assert rod.radius == pytest.approx(1)
    assert fit.aabb(cube()[0]).surface_area == 6


@pytest.mark.parametrize("name", CLOUDS)
def test_hulls_are_closed_and_contain_their_points(name):
    points = CLOUDS[name]
    double, hull = points.astype(float), impinge.convex_hull(points)
    assert (hull.vertices.dtype, hull.faces.dtype) == (np.uint32, np.uint32)
    assert np.array_equal(hull.vertices, np.unique(hull.vertices))
    dimension = {"line": 1, "plane": 2, "one point": 0, "duplicates": 0}.get(name, 3)
    assert hull.dimension == dimension
    assert len(hull.vertices) == {0: 1, 1: 2}.get(dimension, len(hull.vertices))
    if dimension == 3:
        assert set(hull.faces.ravel().tolist()) == set(hull.vertices.tolist())
        assert len(hull.faces) == 2 * len(hull.vertices) - 4  # Euler's formula
        mesh = impinge.Mesh(points, hull.faces)
        assert mesh.is_closed
        assert mesh.contains(points).all()  # exact
        assert mesh.winding_number(double[hull.vertices].mean(axis=0)) == 1  # faces are oriented outward
    elif dimension == 2:
        assert len(hull.faces) == 2 * (len(hull.vertices) - 2)
    else:
        assert hull.faces.shape == (0, 3)


def test_hulls_have_the_vertices_of_qhull():
    spatial = pytest.importorskip("scipy.spatial")
    for name in ("cloud", "single precision", "torus"):
        theirs = np.sort(spatial.ConvexHull(CLOUDS[name].astype(float)).vertices)
        assert np.array_equal(impinge.convex_hull(CLOUDS[name]).vertices, theirs)


FITS = [fit.minimal_sphere, fit.sphere, fit.aabb, fit.obb, fit.capsule, fit.lozenge, fit.kdop, fit.convex_hull]
WRONG = [
    ("empty", (), []),
    ("empty", (), np.zeros((0, 3), np.float32)),
    ("non-finite", (1,), [[0, 0, 0], [0, np.nan, 0]]),
    ("out-of-range", (0,), [[0, 0, 2.0**128]]),
    ("shape", (), [1, 2, 3]),
    ("shape", (), np.zeros((2, 2))),
    ("dtype", (), np.zeros((2, 3), int)),
    ("dtype", (), np.zeros((2, 3), np.float16)),
    ("type", (), None),
]


@pytest.mark.parametrize(("kind", "where", "points"), WRONG)
def test_errors_name_the_invalid_points(kind, where, points):
    for made in FITS:
        with pytest.raises(impinge.InputError) as caught:
            made(points)
        assert (caught.value.kind, caught.value.what, caught.value.where) == (kind, "points", where)


def test_invalid_options_raise_an_error():
    points = cube()[0]
    for wrong in ("least", "", None, 1, "minimal sphere"):
        with pytest.raises(impinge.InputError, match="method"):
            fit.sphere(points, wrong)
    for wrong in (8, 14.0, "14", True, None):
        with pytest.raises(impinge.InputError, match="k:"):
            fit.kdop(points, wrong)
    with pytest.raises(impinge.InputError, match="method"):
        fit.obb(points, "minimal")


def test_point_arrays_of_any_layout_are_accepted():
    points = CLOUDS["cloud"]
    for same in (np.asfortranarray(points), points.astype(">f8"), np.repeat(points, 2, axis=0)[::2], points.tolist()):
        assert np.array_equal(fit.obb(same).center, fit.obb(points).center)
        assert np.array_equal(impinge.convex_hull(same).faces, impinge.convex_hull(points).faces)


def test_proxies_are_equal_computed_and_loaded(tmp_path):
    vertices, faces = torus()
    vertices = np.concatenate([vertices, [[9, 9, 9]]])
    mesh = impinge.Mesh(vertices, faces)
    made = impinge.fit.proxies(mesh)
    used = vertices[:-1]
    assert np.array_equal(made.hull.vertices, impinge.convex_hull(used).vertices)
    assert made.aabb.low.tolist() == used.min(axis=0).tolist()
    assert made.aabb.high.tolist() == used.max(axis=0).tolist()
    assert (np.linalg.norm(used - made.sphere.center, axis=1) <= made.sphere.radius * (1 + 1e-15)).all()
    assert np.isclose(made.sphere.radius, impinge.minimal_sphere(used).radius)
    assert (np.abs((used - made.obb.center) @ made.obb.axes.T) <= made.obb.half_extents * (1 + 1e-12)).all()
    for kdop, k in ((made.kdop14, 14), (made.kdop18, 18), (made.kdop26, 26)):
        extents = used @ kdop.directions.T
        assert kdop.directions.shape == (k // 2, 3)
        assert (kdop.low <= extents.min(axis=0)).all()
        assert (kdop.high >= extents.max(axis=0)).all()
    assert made.capsule.volume > made.obb.volume / 9
    assert made.lozenge.volume > 0
    with_, without = tmp_path / "with.impinge", tmp_path / "without.impinge"
    mesh.bake(with_, proxies=True)
    mesh.bake(without)
    assert with_.stat().st_size > without.stat().st_size
    assert len(mesh.to_baked(proxies=True)) == with_.stat().st_size
    for again in (impinge.load(with_), impinge.load(without), impinge.Mesh.from_baked(mesh.to_baked(proxies=True))):
        assert state(impinge.fit.proxies(again)) == state(made)
        again.rebuild("binned-sah")
        assert state(impinge.fit.proxies(again)) == state(made)
        again.refit(vertices * 2)
        assert impinge.fit.proxies(again).aabb.high.tolist() == (2 * used.max(axis=0)).tolist()
        again.bake(with_, proxies=True)
        assert state(impinge.fit.proxies(impinge.load(with_))) == state(impinge.fit.proxies(again))
        mesh.bake(with_, proxies=True)


def test_proxies_of_another_mesh_raise_an_error():
    vertices, faces = torus()
    baked = bytearray(impinge.Mesh(vertices, faces).to_baked(proxies=True))
    for back in range(40, 4000, 97):
        spoiled = bytearray(baked)
        spoiled[-back] ^= 0x41
        mesh = impinge.Mesh.from_baked(spoiled)
        with pytest.raises(impinge.InputError):
            impinge.fit.proxies(mesh)


def test_an_empty_mesh_has_no_proxies():
    with pytest.raises(impinge.InputError) as raised:
        impinge.fit.proxies(impinge.Mesh(np.zeros((3, 3)), np.zeros((0, 3), int)))
    assert (raised.value.kind, raised.value.what) == ("empty", "mesh")
    assert impinge.Mesh(np.zeros((3, 3)), np.zeros((0, 3), int)).to_baked(proxies=True)
