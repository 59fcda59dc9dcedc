"""Characters: volumes against closed forms in NumPy, and against the equivalent shapes."""

import inspect
import pickle
import re
import textwrap
from math import inf
from pathlib import Path

import impinge
import numpy as np
import pytest
from shapes import cube

ROBOT = Path(__file__).resolve().parents[2] / "data" / "robot.glb"
Shape, pose = impinge.Shape, impinge.pose


@pytest.fixture(scope="module")
def robot():
    return impinge.Character(ROBOT)


def shape_of(part):
    """Returns the volume as a shape, or None for a lozenge."""
    if part.kind == "sphere":
        return Shape.sphere(part.radius, part.points[0])
    if part.kind == "capsule":
        return Shape.capsule(*part.points, part.radius)
    return Shape.hull(part.points) if part.radius == 0 else None


def outside(part, frame, points):
    """Returns the distances (n,) of world points from the surface of a sphere or capsule."""
    assert part.kind in ("sphere", "capsule")
    start, end = (frame[:3, :3] @ point + frame[:3, 3] for point in (part.points[0], part.points[-1]))
    along = end - start
    t = ((points - start) @ along / max(along @ along, 1e-300)).clip(0, 1)
    return np.linalg.norm(points - start - t[:, None] * along, axis=1) - part.radius


def test_parts_bones_and_animations_of_a_file_are_read(robot):
    assert len(robot.parts) == 6
    assert {part.name for part in robot.parts} >= {"head", "left arm", "right arm", "left leg", "right leg", "torso"}
    assert "head" in repr(robot.parts[[part.name for part in robot.parts].index("head")])
    assert len(robot.animations) == 14
    assert {bone for part in robot.parts for bone in part.bones} <= set(robot.bones)
    assert robot.faces.shape == (len(robot.part_of), 3)
    assert set(robot.part_of.tolist()) == set(range(6))
    assert not robot.leaks().share.any()
    assert impinge.Character(ROBOT, volumes=1).parts[0].looseness > 0
    assert impinge.Character(ROBOT, mode="snug").leaks().share.max() > 0


def test_conservative_volumes_contain_the_surface(robot):
    for animation in robot.animations[::3]:
        for time in np.linspace(animation.start, animation.end, 7):
            posed = robot.at(animation.name, time, origin=[1, 2, 3])
            vertices, frames = posed.vertices, posed.frames
            assert ((posed.bounds[0] <= vertices) & (vertices <= posed.bounds[1])).all()
            away = [outside(*one, vertices) for one in zip(robot.parts, frames, strict=True)]
            for number in range(len(robot.parts)):
                own = np.unique(robot.faces[robot.part_of == number])
                assert away[number][own].max() <= 1e-9


def test_rays_hit_the_same_parts_as_rays_on_their_shapes(robot):
    rng = np.random.default_rng(4)
    posed = robot.at("Robot_Running", 0.3)
    low, high = posed.bounds
    origins, aims = rng.uniform(low - 4, high + 4, (400, 3)), rng.uniform(low, high, (400, 3))
    found, every = posed.ray_cast(origins, aims - origins), posed.ray_cast_all(origins, aims - origins)
    t = np.full((6, 400), inf)
    for number, (part, frame) in enumerate(zip(robot.parts, posed.frames, strict=True)):
        back = np.linalg.inv(frame)
        local = origins @ back[:3, :3].T + back[:3, 3], (aims - origins) @ back[:3, :3].T
        t[number] = shape_of(part).ray_cast(*local).t
    assert np.allclose(found.t, t.min(axis=0), atol=1e-6)
    assert 0.2 < found.hit.mean() < 1
    assert np.array_equal(found.hit, found.part >= 0)
    struck = np.flatnonzero(found.hit)
    assert np.allclose(t[found.part[struck], struck], found.t[struck], atol=1e-6)
    assert every.counts.tolist() == (t < inf).sum(axis=0).tolist()
    for row in struck[:50]:
        hits = every[row]
        assert (np.diff(hits.t) >= 0).all()
        assert sorted(hits.part.tolist()) == np.flatnonzero(t[:, row] < inf).tolist()
        assert hits.t[0] == found.t[row]
    # Every ray that hits the surface hits a volume.
    assert not (posed.mesh().ray_cast(origins, aims - origins).hit & ~found.hit).any()
    single = posed.ray_cast(origins[struck[0]], aims[struck[0]] - origins[struck[0]])
    assert (single.part, single.t) == (found.part[struck[0]], found.t[struck[0]])
    finer = impinge.Character(ROBOT, pieces=300).at("Robot_Running", 0.3)
    surface = finer.mesh().ray_cast(origins, aims - origins)
    fine = finer.ray_cast(origins, aims - origins)
    assert not (surface.hit & ~fine.hit).any()
    assert (fine.part[surface.hit] == robot.part_of[surface.face[surface.hit]]).mean() >= 0.95
    assert fine.hit.sum() < found.hit.sum()


def test_struck_by_finds_the_parts_that_intersect(robot):
    rng = np.random.default_rng(5)
    posed = robot.at("Robot_Punch", 0.4)
    volumes = [(shape_of(part), frame) for part, frame in zip(robot.parts, posed.frames, strict=True)]
    crate = impinge.Mesh(*cube())
    counts = 0
    for place in pose(rng.uniform(*posed.bounds, (15, 3))):
        for probe in (Shape.sphere(0.5), Shape.box([0.4, 0.5, 0.9]), crate):
            struck = posed.struck_by(probe, place)
            expected = [n for n, (volume, at) in enumerate(volumes) if impinge.intersects(probe, volume, place, at)]
            assert struck.part.tolist() == expected
            assert np.allclose(np.linalg.norm(struck.normal, axis=1), 1)
            counts += len(expected)
    assert 30 < counts < 200
    other = robot.at("Robot_Idle", 1.0, origin=[1.5, 0, 0.5])
    pairs = posed.struck_by_character(other)
    there = other.frames
    expected = [
        (a, b)
        for a in range(6)
        for b in range(6)
        if impinge.intersects(volumes[a][0], volumes[b][0], volumes[a][1], there[b])
    ]
    assert list(zip(pairs.part_a.tolist(), pairs.part_b.tolist(), strict=True)) == expected
    assert 5 < len(expected) < 36
    assert (pairs.depth >= 0).all()


def test_no_hit_of_a_moving_shape_is_missed_or_late(robot):
    """The fist passes through the body in one step; small steps in NumPy find the first contact."""
    before, after = robot.at("Robot_Idle", 0.3), robot.at("Robot_Idle", 0.3, origin=[0.5, 0, 0])
    fist, start, end = Shape.sphere(0.3), np.array([0.2, 2.5, 40]), np.array([0.1, 2.0, -40])
    strikes = before.strikes(after, fist, pose(start), pose(end))
    assert len(strikes.part) > 0
    steps = np.linspace(0, 1, 20001)
    first = np.full(6, inf)
    for number, (part, frame) in enumerate(zip(robot.parts, before.frames, strict=True)):
        # In the frame of the body, which moves along x at constant velocity,
        # the fist moves along a line.
        seen = start + steps[:, None] * (end - start) - steps[:, None] * [0.5, 0, 0]
        touches = outside(part, frame, seen) <= 0.3
        first[number] = steps[touches.argmax()] if touches.any() else inf
    assert set(strikes.part.tolist()) >= set(np.flatnonzero(first < inf).tolist())
    late = strikes.t - first[strikes.part]
    assert late.max() <= 0
    assert late[np.isfinite(late)].min() >= -2 / 20000
    assert (np.diff(strikes.t) >= 0).all()
    assert len(before.strikes(after, fist, pose([30, 0, 40]), pose([30, 0, -40])).part) == 0
    for shape in (Shape.box([0.1, 0.1, 0.1]), Shape.capsule([0, 0, 0], [0, 1, 0], 0.1), Shape.hull(cube()[0])):
        assert before.strikes(after, shape, pose(start), pose(end)).t[0] < 0.6


def test_surface_rays_equal_rays_on_the_skinned_mesh(robot):
    rng = np.random.default_rng(6)
    for animation, time, origin in [("Robot_Punch", 0.4, [0, 0, 0]), ("Robot_Running", 0.2, [5, -1, 1000])]:
        posed = robot.at(animation, time, origin=origin)
        low, high = posed.bounds
        origins, aims = rng.uniform(low - 4, high + 4, (2, 400, 3)), rng.uniform(low, high, (400, 3))
        found, truth = posed.surface_ray_cast(origins, aims - origins), posed.mesh().ray_cast(origins, aims - origins)
        for name in ("hit", "t", "face", "point"):
            assert np.array_equal(getattr(found, name), getattr(truth, name))
        assert 0.2 < found.hit.mean() < 0.9
        assert np.array_equal(found.part[found.hit], robot.part_of[found.face[found.hit]])
        assert set(found.part[~found.hit]) == set(found.bone[~found.hit]) == {-1}
        assert set(found.bone[found.hit]) <= {robot.bones.index(name) for part in robot.parts for name in part.bones}
        row = tuple(np.argwhere(found.hit)[0])
        single = posed.surface_ray_cast(origins[row], aims[row[1]] - origins[row])
        assert (single.hit, single.part, single.t) == (True, found.part[row], found.t[row])


@pytest.mark.parametrize("options", [{}, {"volumes": 12}, {"mode": "snug"}])
def test_part_bodies_collide_as_their_shapes_do(options):
    robot = impinge.Character(ROBOT, **options)
    world = impinge.World(narrow_phase="intersections")
    places, names = [[0, 0, 0], [2.5, 0, 0.5], [1, 0, 3]], ["Robot_Punch", "Robot_Running", "Robot_Dance"]
    crowd = [
        impinge.PartBodies.insert(world, robot.at(origin=place), owner=owner, tag=100 * owner)
        for owner, place in enumerate(places)
    ]
    count = len(robot.parts)
    assert len(world) == 3 * count
    assert world.tags(crowd[2].bodies).tolist() == list(range(200, 200 + count))
    now, began, ended = set(), 0, 0
    for frame in range(8):
        poses = [robot.at(name, 0.15 * frame, origin=place) for name, place in zip(names, places, strict=True)]
        bodies, moved = zip(*(own.moves(at) for own, at in zip(crowd, poses, strict=True)), strict=True)
        step = world.step(np.concatenate(bodies), np.concatenate(moved))
        now = (now | {tuple(pair) for pair in step.began.tolist()}) - {tuple(pair) for pair in step.ended.tolist()}
        began, ended = began + len(step.began), ended + len(step.ended)
        expected = set()
        for a in range(3):
            for b in range(a):
                pairs = poses[a].struck_by_character(poses[b])
                sides = crowd[a].bodies[pairs.part_a].tolist(), crowd[b].bodies[pairs.part_b].tolist()
                expected |= {frozenset(pair) for pair in zip(*sides, strict=True)}
        assert {frozenset(pair) for pair in now} == expected
    assert began > 5
    assert ended > 0
    assert crowd[1].part(crowd[1].bodies).tolist() == list(range(count))
    assert crowd[1].part(np.stack([crowd[0].bodies, crowd[2].bodies])).tolist() == [[-1] * count] * 2
    assert crowd[1].part(int(crowd[1].bodies[3])) == 3
    crowd[0].remove(world)
    assert len(world) == 2 * count
    assert len(world.step().ended) == len([pair for pair in now if set(pair) & set(crowd[0].bodies.tolist())]) > 0
    with pytest.raises(impinge.InputError, match="any more"):
        crowd[0].remove(world)
    # A pickled world contains the shapes of the parts.
    again = pickle.loads(pickle.dumps((world, crowd[1])))
    assert again[0].pairs().tolist() == world.pairs().tolist()
    assert again[1].part(world.bodies).tolist() == crowd[1].part(world.bodies).tolist()


def test_limits_are_respected_and_pickled(robot, tmp_path):
    size, triangles = ROBOT.stat().st_size, len(robot.faces)
    limited = impinge.Character(ROBOT, max_bytes=size, max_triangles=triangles)
    assert len(pickle.loads(pickle.dumps(limited)).parts) == len(robot.parts)
    saved = tmp_path / "parts.toml"
    robot.save(saved)
    text = saved.stat().st_size
    assert impinge.Character.load(ROBOT, saved, max_bytes=size).parts
    for make in (impinge.Character, lambda path, **limits: impinge.Character.load(path, saved, **limits)):
        with pytest.raises(impinge.InputError, match="larger max_bytes") as caught:
            make(ROBOT, max_bytes=size - 1)
        assert (caught.value.kind, caught.value.what) == ("too-many", str(ROBOT))
        with pytest.raises(impinge.InputError, match="larger max_triangles"):
            make(ROBOT, max_triangles=triangles - 1)
        with pytest.raises(impinge.InputError, match="max_triangles"):
            make(ROBOT, max_triangles=-1)
    # The plan counts as a file of its own.
    assert text < size
    saved.write_text(saved.read_text() + "#" * (size - text + 1))
    with pytest.raises(impinge.InputError, match="larger max_bytes") as caught:
        impinge.Character(ROBOT, plan=saved, max_bytes=size)
    assert caught.value.what == str(saved)


@pytest.mark.parametrize("kind", ["sphere", "capsule", "box", "lozenge", "hull"])
def test_part_bodies_have_the_poses_of_the_volumes(kind, robot, tmp_path):
    robot.save(tmp_path / "parts.toml")
    text = (tmp_path / "parts.toml").read_text()
    (tmp_path / "parts.toml").write_text(re.sub(r'kind = "\w+"', f'kind = "{kind}"', text))
    fitted = impinge.Character(ROBOT, plan=tmp_path / "parts.toml")
    assert {part.kind for part in fitted.parts} == {kind}
    world = impinge.World()
    posed = fitted.at("Robot_Jump", 0.3, origin=[0, 7, 0])
    bodies = impinge.PartBodies.insert(world, posed, owner=1).bodies
    rng = np.random.default_rng(7)
    probe, places = Shape.sphere(0.5), pose(rng.uniform(*posed.bounds, (80, 3)))
    found = world.overlapping(probe, places)
    struck = [posed.struck_by(probe, place).part for place in places]
    assert [row.tolist() for row in found] == [bodies[parts].tolist() for parts in struck]
    assert 15 < found.counts.sum() < 300


def test_parts_collide_with_each_other_only_without_an_owner(robot):
    for owner, meets in [(None, True), (3, False)]:
        world = impinge.World()
        bodies = impinge.PartBodies.insert(world, robot.at(), owner=owner)
        assert (len(world.step().began) > 0) == meets
        assert repr(bodies).startswith("PartBodies(6 bodies of Character(")


def test_errors_name_the_invalid_argument_of_part_bodies(robot):
    world, other = impinge.World(), impinge.Character(ROBOT, volumes=1)
    bodies = impinge.PartBodies.insert(world, robot.at())
    for what, ask in [
        ("world", lambda: impinge.PartBodies.insert(robot, robot.at())),
        ("pose", lambda: impinge.PartBodies.insert(world, robot)),
        ("pose", lambda: bodies.moves(other.at())),
        ("pose", lambda: bodies.moves(np.eye(4))),
        ("kind", lambda: impinge.PartBodies.insert(world, robot.at(), kind="flying")),
        ("tag", lambda: impinge.PartBodies.insert(world, robot.at(), tag=2**64 - 3)),
    ]:
        with pytest.raises(impinge.InputError) as caught:
            ask()
        assert caught.value.what == what
        assert len(world) == 6


@pytest.mark.parametrize("documented", [impinge.PartBodies, impinge.CharacterPose.surface_ray_cast])
def test_docstring_examples_that_need_a_file_run(documented, robot):
    """Runs the literal blocks of a docstring in order, with the names that they assume."""
    blocks = re.findall(r"::\n\n((?:[ ]{4,}.*\n|\n)+)", inspect.getdoc(documented) + "\n")
    assert blocks
    known = {"impinge": impinge, "np": np, "robot": robot, "crowd": [], "crowd_poses": []}
    for block in blocks:
        exec(textwrap.dedent(block), known)
        known.update(crowd=[known.get("boxer")], crowd_poses=[robot.at()])
    if "struck" in known:
        assert known["struck"]


def test_a_saved_character_loads_bitwise_equal(robot, tmp_path):
    robot.save(tmp_path / "robot.toml")
    again = impinge.Character.load(ROBOT, tmp_path / "robot.toml")
    for one, other in zip(robot.parts, again.parts, strict=True):
        assert (one.name, one.bones, one.kind, one.radius) == (other.name, other.bones, other.kind, other.radius)
        assert np.array_equal(one.points, other.points)
    planned = impinge.Character(ROBOT, plan=tmp_path / "robot.toml", mode="snug")
    assert [part.bones for part in planned.parts] == [part.bones for part in robot.parts]
    rays = [[0, 4, 9], [0, 2, 9], [7, 7, 9]], [0, 0, -1]
    assert np.array_equal(robot.at(0, 0.1).ray_cast(*rays).t, again.at(0, 0.1).ray_cast(*rays).t)


@pytest.mark.parametrize(
    ("kind", "what", "ask"),
    [
        ("out-of-range", "volumes", lambda r: impinge.Character(ROBOT, volumes=0)),
        ("out-of-range", "pieces", lambda r: impinge.Character(ROBOT, pieces=0)),
        ("option", "mode", lambda r: impinge.Character(ROBOT, mode="loose")),
        ("name", "animation", lambda r: r.at("Robot_Flying")),
        ("name", "animation", lambda r: r.at(14)),
        ("name", "animation", lambda r: r.at(-1)),
        ("non-finite", "time", lambda r: r.at(0, inf)),
        ("shape", "origin", lambda r: r.at(0, 0, origin=[0, 0])),
        ("zero-direction", "directions", lambda r: r.at().ray_cast([0, 0, 0], [0, 0, 0])),
        ("type", "shape", lambda r: r.at().struck_by("fist")),
        ("shape", "pose", lambda r: r.at().struck_by(Shape.sphere(1), np.stack([np.eye(4)] * 2))),
        ("not-rigid", "pose", lambda r: r.at().struck_by(Shape.sphere(1), np.diag([2.0, 1, 1, 1]))),
        ("type", "other", lambda r: r.at().struck_by_character(r)),
        ("type", "to", lambda r: r.at().strikes(r, Shape.sphere(1), None, None)),
        ("type", "shape", lambda r: r.at().strikes(r.at(), Shape.cone(1, 1), None, None)),
        ("not-rigid", "pose_t1", lambda r: r.at().strikes(r.at(), Shape.sphere(1), None, np.diag([2.0, 1, 1, 1]))),
    ],
)
def test_errors_name_the_invalid_argument(robot, kind, what, ask):
    with pytest.raises(impinge.InputError) as caught:
        ask(robot)
    assert (caught.value.kind, caught.value.what) == (kind, what)


def test_files_without_a_rig_raise_an_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        impinge.Character(tmp_path / "none.glb")
    (tmp_path / "text.glb").write_text("no rig")
    with pytest.raises(impinge.InputError):
        impinge.Character(tmp_path / "text.glb")
    (tmp_path / "fit.toml").write_text("[[part]]\nbones = ['Nowhere']\n")
    with pytest.raises(impinge.InputError):
        impinge.Character.load(ROBOT, tmp_path / "fit.toml")


def test_the_length_of_a_direction_does_not_change_the_hit():
    posed = impinge.Character(ROBOT, volumes=4).at()
    origin = np.asarray(posed.bounds).mean(axis=0) - [0, 0, 50]
    expected = posed.ray_cast(origin, [0.0, 0, 1])
    assert expected.hit
    for exponent in (-1, -500, -520, -540, -1000, -1022, -1040, -1074, 100, 299):
        length = 2.0**exponent
        found, every = (ask(origin, [0.0, 0, length]) for ask in (posed.ray_cast, posed.ray_cast_all))
        assert found.part == expected.part == every.part[0]
        assert np.allclose(found.point, expected.point, rtol=0, atol=1e-9)
        assert np.isclose(found.depth, expected.depth)
        assert exponent < -1000 or np.isclose(found.t * length, expected.t)
        assert np.isfinite(every.t).all()
