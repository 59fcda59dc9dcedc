"""Motions of robots with proofs, and clearances: closed forms, samples, and known verdicts."""

import os
import pickle
import re
import warnings
from pathlib import Path

import impinge
import numpy as np
import pytest
from impinge import Joint, Robot, Shape, pose

DATA = Path(__file__).resolve().parents[2] / "data" / "robots"
GANTRY = Robot.load(DATA / "gantry.urdf", DATA / "gantry.srdf")
REAL = os.environ.get("IMPINGE_DATA")
RAIL = Robot.from_parts({"rail": None, "tip": Shape.sphere(0.005)}, [Joint("slide", "rail", "tip", "prismatic")])
PLATE = impinge.Scene({"plate": Shape.box([0.0005, 1, 1])})


def configurations(count, seed):
    lower, upper = np.maximum(GANTRY.lower, -np.pi), np.minimum(GANTRY.upper, np.pi)
    return np.random.default_rng(seed).uniform(lower, upper, (count, GANTRY.dof))


def test_a_thin_plate_is_hit_at_its_time():
    at = {"plate": pose([0.025, 0, 0])}
    motion = RAIL.check_motion([-0.5], [0.5], PLATE, poses=at, certificate=True)
    assert (motion.verdict, motion.pair, motion.certificate.size) == ("collides", ("tip", "plate"), 0)
    assert motion.t_free <= 0.5195 + 1e-15
    assert 0.5195 - 1e-15 <= motion.t_hit < motion.t_free + 1e-9
    assert motion.q_hit.shape == (1,)
    assert RAIL.check(motion.q_hit, PLATE, poses=at).collides
    # It stops 1 mm before the plate.
    near = RAIL.check_motion([-0.5], [0.0185], PLATE, poses=at, certificate=True)
    assert (near.verdict, near.t_free, near.pair) == ("free", 1.0, None)
    assert np.isnan(near.t_hit)
    assert near.verify()
    assert RAIL.check_motion([-0.5], [0.0185], PLATE, poses=at, clearance=0.002).verdict == "collides"
    rows = near.certificate.copy()
    rows["half"][0] /= 2
    assert "contains the time" in near.flaw(rows)
    assert not near.verify(near.certificate[1:])


def test_verdicts_of_motions_agree_with_samples():
    ends = configurations(60, 3)
    starts = np.array([0, 0, 0, 0, 0.01])
    assert not GANTRY.check(starts).collides
    motions = GANTRY.check_motion(starts, ends, certificate=True)
    back = GANTRY.check_motion(ends, starts)
    assert motions.verdict.shape == (60,)
    assert motions.q_hit.shape == (60, 5)
    assert np.array_equal(motions.verdict, back.verdict)
    assert 5 < (motions.verdict == "free").sum() <= 55
    times = np.linspace(0, 1, 200)[:, None]
    for at, end in enumerate(ends):
        hits = GANTRY.check((1 - times) * starts + times * end).collides
        free = motions.verdict[at] == "free"
        assert not hits[times[:, 0] < motions.t_free[at]].any()
        assert len(motions.certificate[at]) > 0 if free else GANTRY.check(motions.q_hit[at]).collides
    with impinge.threads(1):
        assert np.array_equal(GANTRY.check_motion(starts, ends).t_free, motions.t_free)


def test_paths_join_the_verdicts_of_their_legs():
    way = [[0, 0, 0, 0, 0], [0.1, 0.5, 0, 0, 0], [-0.25, 3, 2.6, 0, 0]]
    path = GANTRY.check_path(way)
    assert path.verdict.tolist() == ["free", "collides"]
    verdict, free, hit = path.path()
    assert (verdict, free, hit) == ("collides", 1 + path.t_free[1], 1 + path.t_hit[1])
    assert GANTRY.check_path(way[:2]).path()[:2] == ("free", 1.0)
    assert repr(path) == "RobotMotion(2 motions: 1 free, 1 collides, 0 undecided)"


def test_clearances_equal_the_least_distance():
    q = configurations(80, 5)
    scene = impinge.Scene({"ball": Shape.sphere(0.1)})
    found = GANTRY.clearance(q, scene, poses={"ball": pose([0.2, 0.5, 0.6])}, ignored=[("base", "ball")])
    poses = GANTRY.at(q)
    least = np.full(80, np.inf)
    for a, b in GANTRY.pairs:
        distance = impinge.distance(GANTRY.shapes[a], GANTRY.shapes[b], poses[a], poses[b])
        least = np.minimum(least, distance.upper)
    for link, shape in GANTRY.shapes.items():
        if link != "base":
            to_ball = impinge.distance(shape, Shape.sphere(0.1), poses[link], pose([0.2, 0.5, 0.6]))
            least = np.minimum(least, to_ball.upper)
    assert np.allclose(found.upper, least, rtol=0, atol=1e-12)
    assert (found.lower <= found.upper).all()
    assert any("ball" in pair for pair in found.pair)
    gaps = np.linalg.norm(found.points[:, 0] - found.points[:, 1], axis=1)
    free = found.lower > 0
    assert 10 < free.sum() < 80
    assert np.allclose(gaps[free], found.upper[free], atol=1e-9)
    near = GANTRY.clearance(q[int(np.argmax(found.lower))], limit=1e-4)
    assert (near.lower, near.upper, near.pair) == (1e-4, np.inf, None)


def test_invalid_arguments_are_named():
    def fails(match, call, *arguments, **options):
        with pytest.raises(impinge.InputError, match=re.escape(match)):
            call(*arguments, **options)

    zero = np.zeros(5)
    fails("q1: must have 5 columns", GANTRY.check_motion, zero, np.zeros(4))
    fails("q1: the leading axes (3,) do not broadcast", GANTRY.check_motion, np.zeros((2, 5)), np.zeros((3, 5)))
    fails("waypoints: must be at least two rows", GANTRY.check_path, np.zeros((1, 5)))
    fails("clearance", GANTRY.check_motion, zero, zero, clearance=-1)
    fails("max_steps", GANTRY.check_motion, zero, zero, max_steps=-1)
    fails("limit", GANTRY.clearance, zero, limit=-1)
    motion = GANTRY.check_motion(zero, zero)
    fails("there is no certificate", motion.verify)
    fails("only a single motion", GANTRY.check_path(np.zeros((2, 5))).verify)


def test_known_verdicts_of_the_motions_of_a_real_robot(tmp_path):
    if not REAL:
        pytest.skip("IMPINGE_DATA names no folder of real files")
    robots = Path(REAL) / "robots"
    plain = tmp_path / "robot.urdf"
    plain.write_text(re.sub(r"<mimic[^>]*/>", "", (robots / "panda_description/urdf/panda.urdf").read_text()))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", impinge.LoadWarning)
        srdf = robots / "panda_description/srdf/panda.srdf"
        robot = Robot.load(plain, srdf, packages={"example-robot-data": REAL})
    known = np.load(robots / "golden" / "panda_self_edges.npz")
    motions = robot.check_motion(known["q0"], known["q1"])
    assert (motions.verdict == "undecided").sum() == 0
    assert np.array_equal(motions.verdict == "collides", known["collides"])
    assert robot.check(motions.q_hit[known["collides"]]).collides.all()


def test_attached_objects_are_checked_like_links():
    rod = Shape.capsule([0, 0, -0.1], [0, 0, 0.1], 0.01)
    place = pose([0, 0, 0.15])
    fingers = ["left_finger", "right_finger"]
    holding = GANTRY.attached("rod", rod, "palm", place, touch=fingers)
    assert (holding.links[-1], holding.joints, holding.name) == ("rod", GANTRY.joints, "gantry")
    assert holding.groups == GANTRY.groups
    assert set(holding.pairs) - set(GANTRY.pairs) == {
        (link, "rod") for link in ("base", "carriage", "upper_arm", "forearm")
    }
    assert all(holding.ignored[finger, "rod"] == "disabled: touch" for finger in fingers)
    q = configurations(2000, 8)
    with_rod, without = holding.check(q, stop="all"), GANTRY.check(q, stop="all")
    assert with_rod.collides.sum() > without.collides.sum()
    poses = holding.at(q)
    assert np.array_equal(poses["rod"], poses["palm"] @ place)
    for link in ("base", "forearm"):
        hits = impinge.intersects(GANTRY.shapes[link], rod, poses[link], poses["rod"])
        found = [(link, "rod") in with_rod.names(row) for row in range(len(q))]
        assert np.array_equal(hits, found)
    assert (holding.clearance(q[:200]).upper <= GANTRY.clearance(q[:200]).upper + 1e-12).all()
    again = pickle.loads(pickle.dumps(holding))
    assert np.array_equal(again.check(q).collides, with_rod.collides)
    # Motions to configurations in which only the rod collides.
    ends = q[with_rod.collides & ~without.collides][:40]
    verdicts = [robot.check_motion(np.array([0, 0, 0, 0, 0.01]), ends).verdict for robot in (GANTRY, holding)]
    assert (verdicts[1] == "collides").all()
    assert not ((verdicts[0] == "collides") & (verdicts[1] == "free")).any()
    assert ((verdicts[0] == "free") & (verdicts[1] == "collides")).any()
    for arguments in (("palm", rod, "palm"), ("rod", rod, "hand"), ("rod", rod, "palm", None, ["thumb"])):
        with pytest.raises(impinge.InputError):
            GANTRY.attached(*arguments)
    with pytest.raises(impinge.InputError, match=r"impinge\.Shape"):
        GANTRY.attached("rod", 3, "palm")


def test_audits_prove_pairs_and_find_witnesses(tmp_path):
    audit = GANTRY.audit(2000, seed=3)
    assert audit.findings == GANTRY.audit(2000, seed=3).findings
    assert len(audit.findings) == 21
    everything = Robot.load(DATA / "gantry.urdf")
    q = configurations(4000, 4)
    hits = set(everything.check(q, stop="all").counts())
    for pair, finding in audit.findings.items():
        witness = audit.witness(*pair)
        assert (witness is not None) == (finding in ("witness", "always"))
        if witness is not None and pair in everything.pairs:
            assert pair in everything.check(witness, stop="all").names()
            assert np.array_equal(audit.witness(*pair[::-1]), witness)
        if finding in ("proved_never", "open"):
            assert pair not in hits
    kinds = list(audit.findings.values())
    assert kinds.count("proved_never") > 2
    assert kinds.count("witness") > 2
    assert audit.missed == ()
    path = tmp_path / "proved.srdf"
    assert audit.srdf(path) == path.read_text(encoding="utf-8")
    proved = Robot.load(DATA / "gantry.urdf", path)
    checked = {pair for pair, finding in audit.findings.items() if finding in ("witness", "open")}
    assert set(proved.pairs) == checked
    assert np.array_equal(proved.check(q).collides, everything.check(q).collides)
    with pytest.raises(impinge.InputError, match="no pair"):
        audit.witness("base", "nothing")
