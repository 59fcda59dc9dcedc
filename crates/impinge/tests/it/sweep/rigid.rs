//! First contact of meshes under rigid motions, against closed forms and against poses in between.

use std::f64::consts::{FRAC_PI_2, PI};

use impinge::sweep::{Impact, Motion, time_of_impact};
use impinge::{InputErrorKind, Mesh, Pose, Positions, query};
use impinge_testkit::generate::{Rng, cos, sin, solids};

fn mesh(plain: &impinge_testkit::Mesh) -> Mesh {
    Mesh::new(Positions::F64(plain.vertices.clone()), plain.faces.clone()).expect("a legal mesh")
}

fn cube(half: f64) -> Mesh {
    mesh(&solids::cuboid([-half; 3], [half; 3]))
}

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("a pose")
}

fn moving(from: [f64; 3], to: [f64; 3]) -> Motion {
    Motion::between(at(from), at(to)).expect("rigid")
}

/// Returns a mesh of one face without area: the segment between two points.
fn segment(from: [f64; 3], to: [f64; 3]) -> Mesh {
    Mesh::new(Positions::F64(vec![from, to]), vec![[0, 1, 1]]).expect("a legal mesh")
}

#[track_caller]
fn assert_time(impact: Impact, truth: f64, width: f64) {
    assert!(impact.t_lower <= truth && truth <= impact.t_upper, "{impact:?} {truth}");
    assert!(impact.t_lower >= truth - width, "{impact:?} {truth}");
}

/// Checks two cubes of side 2 that swap places between z = 4 and z = -4. FCL's conservative
/// advancement misses them as meshes.
#[test]
fn cubes_that_pass_through_each_other_are_found() {
    let (a, b) = (moving([0.0, 0.0, 4.0], [0.0, 0.0, -4.0]), moving([0.0, 0.0, -4.0], [0.0, 0.0, 4.0]));
    assert_time(time_of_impact(&cube(1.0), &cube(1.0), &a, &b).unwrap(), 0.375, 1e-9);
    // A bullet through a thin plate. It travels 50,000 times the thickness of the plate in one
    // motion.
    let plate = mesh(&solids::cuboid([-1.0, -1.0, -0.01], [1.0, 1.0, 0.01]));
    let shot = moving([0.1, 0.2, 500.0], [0.1, 0.2, -500.0]);
    assert_time(time_of_impact(&plate, &cube(0.01), &Motion::default(), &shot).unwrap(), 0.499_98, 1e-9);
}

#[test]
fn contact_at_the_start_or_at_the_end_is_found() {
    let rest = Motion::default();
    for now in [moving([2.0, 0.0, 0.0], [9.0, 0.0, 0.0]), Motion::resting(at([1.5, 0.0, 0.0]))] {
        let impact = time_of_impact(&cube(1.0), &cube(1.0), &rest, &now).unwrap();
        assert_eq!([impact.t_lower, impact.t_upper], [0.0; 2]);
    }
    let end = time_of_impact(&cube(1.0), &cube(1.0), &rest, &moving([5.0, 0.3, 0.0], [2.0, 0.3, 0.0])).unwrap();
    assert_time(end, 1.0, 1e-9);
    // No contact: moving away, stopping short, moving in step, passing beside, at rest.
    let never =
        |a: &Motion, b: &Motion| assert_eq!(time_of_impact(&cube(1.0), &cube(1.0), a, b).unwrap(), Impact::NEVER);
    never(&rest, &moving([2.5, 0.0, 0.0], [5.0, 0.0, 0.0]));
    never(&rest, &moving([5.0, 0.0, 0.0], [2.000_001, 0.0, 0.0]));
    never(&moving([0.0; 3], [0.0, 9.0, 0.0]), &moving([2.1, 0.0, 0.0], [2.1, 9.0, 0.0]));
    never(&rest, &moving([2.01, -5.0, 0.0], [2.01, 5.0, 0.0]));
    never(&rest, &Motion::resting(at([2.0_f64.next_up(), 0.0, 0.0])));
    let empty = Mesh::new(Positions::F64(vec![]), vec![]).expect("legal");
    assert_eq!(time_of_impact(&empty, &cube(1.0), &rest, &rest).unwrap(), Impact::NEVER);
}

/// Checks a rod that turns about one of its ends against a rod across its plane.
#[test]
fn turning_rods_hit_at_the_angle_between_them() {
    let rod = segment([0.0; 3], [2.0, 0.0, 0.0]);
    for (angle, full) in [(0.3, FRAC_PI_2), (1.4, FRAC_PI_2), (2.9, PI), (4.5, 5.5), (6.0, 20.0)] {
        let post = segment([cos(angle), sin(angle), -1.0], [cos(angle), sin(angle), 1.0]);
        let spin = Motion::screw(Pose::IDENTITY, [0.0; 3], [0.0, 0.0, full], None).expect("rigid");
        let impact = time_of_impact(&rod, &post, &spin, &Motion::default()).unwrap();
        // The lines cross only at one time, so possibly no pose in floats makes them intersect.
        assert!(impact.t_lower <= angle / full && impact.t_lower > angle / full - 1e-6, "{angle} {full} {impact:?}");
        let short = Motion::screw(Pose::IDENTITY, [0.0; 3], [0.0, 0.0, angle - 1e-3], None).expect("rigid");
        assert_eq!(time_of_impact(&rod, &post, &short, &Motion::default()).unwrap(), Impact::NEVER);
    }
}

#[test]
fn contact_of_a_spin_in_place_is_found() {
    // A square plate of half-side 1 turns about its center beside a wall. Its corner reaches x =
    // 1.2 if the angle between its diagonal and the x axis has the cosine 1.2 / √2.
    let plate = mesh(&solids::cuboid([-1.0, -1.0, -0.1], [1.0, 1.0, 0.1]));
    let wall = mesh(&solids::cuboid([1.2, -3.0, -1.0], [2.0, 3.0, 1.0]));
    let spin = Motion::screw(Pose::IDENTITY, [0.0; 3], [0.0, 0.0, 1.5], None).expect("rigid");
    let truth = (PI / 4.0 - (1.2 / 2.0_f64.sqrt()).acos()) / 1.5;
    assert_time(time_of_impact(&plate, &wall, &spin, &Motion::default()).unwrap(), truth, 1e-8);
    assert_time(time_of_impact(&wall, &plate, &Motion::default(), &spin).unwrap(), truth, 1e-8);
}

#[test]
fn motions_end_at_their_poses() {
    let mut rng = Rng::new(5);
    let mut turned = 0;
    for _ in 0..300 {
        let mut pose = || {
            let q: [f64; 4] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            let translation = std::array::from_fn(|_| rng.uniform(-5.0, 5.0));
            Pose::from_quaternion_wxyz(translation, q.map(|x| x / length)).expect("rigid")
        };
        let (start, end) = (pose(), pose());
        let motion = Motion::between(start, end).expect("rigid");
        assert_eq!(motion.at(0.0), start);
        let reached = motion.at(1.0);
        for point in [[1.0, 2.0, 3.0], [-3.0, 0.5, 0.0]] {
            let off = [0, 1, 2].map(|k| (reached.apply(point)[k] - end.apply(point)[k]).abs());
            assert!(off.iter().all(|x| *x < 1e-13), "{off:?}");
        }
        // The middle pose is the same from either end.
        let (half, back) = (motion.at(0.5), Motion::between(end, start).expect("rigid").at(0.5));
        let off = [0, 1, 2].map(|k| (half.apply([1.0; 3])[k] - back.apply([1.0; 3])[k]).abs());
        let trace = (0..3).map(|k| (0..3).map(|j| start.linear()[k][j] * end.linear()[k][j]).sum::<f64>()).sum::<f64>();
        if trace > -0.99 {
            assert!(off.iter().all(|x| *x < 1e-10), "{off:?}");
            turned += 1;
        }
    }
    assert!(turned > 250, "{turned}");
}

#[test]
fn motions_that_are_not_rigid_or_not_finite_are_rejected() {
    let stretched = Pose::new([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).expect("a pose");
    let mirrored = Pose::new([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).expect("a pose");
    let kind = |result: Result<Motion, impinge::InputError>| result.expect_err("not rigid").kind().clone();
    for other in [stretched, mirrored] {
        assert!(matches!(kind(Motion::between(Pose::IDENTITY, other)), InputErrorKind::NotRigid { .. }));
        assert!(Motion::between(other, other).is_ok());
    }
    let spin = [f64::NAN, 0.0, 0.0];
    let error = kind(Motion::screw(Pose::IDENTITY, [0.0; 3], spin, None));
    assert_eq!(error, InputErrorKind::NonFinite { what: "angular velocity", index: 0 });
    assert!(matches!(kind(Motion::screw(stretched, [0.0; 3], [1.0; 3], None)), InputErrorKind::NotRigid { .. }));
    assert!(Motion::screw(stretched, [1.0; 3], [0.0; 3], None).is_ok());
}

/// Checks random motions of two bodies: they intersect at no sampled time before `t_lower`, at
/// `t_upper` they do, and at no time if contact is disproved.
#[test]
fn random_motions_are_clear_until_they_hit() {
    let mut rng = Rng::new(6);
    let (a, b) = (mesh(&solids::icosphere(1)), cube(0.6));
    let (mut hits, mut undecided) = (0, 0);
    for _ in 0..120 {
        let mut vector = |size: f64| -> [f64; 3] { std::array::from_fn(|_| rng.uniform(-size, size)) };
        let away = |v: [f64; 3]| v.map(|x| x + 1.8 * x.signum());
        let place = away(vector(1.0));
        let (noise, spin, pivot) = (vector(1.0), vector(1.5), vector(1.0));
        let (start, velocity) = (at(place), [0, 1, 2].map(|k| noise[k] - 1.2 * place[k]));
        let motion_a = Motion::screw(start, velocity, spin, Some(pivot)).expect("rigid");
        let motion_b = Motion::screw(Pose::IDENTITY, vector(1.0), vector(3.0), None).expect("rigid");
        let impact = time_of_impact(&a, &b, &motion_a, &motion_b).unwrap();
        let intersect = |t: f64| query::intersects(a.at(motion_a.at(t)), b.at(motion_b.at(t)));
        let clear_until = if impact.hit() { impact.t_lower } else { 1.0 };
        assert!((0..200).all(|k| !intersect(f64::from(k) / 200.0 * clear_until)) || clear_until == 0.0, "{impact:?}");
        if impact.is_decided() && impact.hit() {
            assert!(intersect(impact.t_upper) && impact.t_upper - impact.t_lower < 1e-2, "{impact:?}");
        }
        hits += usize::from(impact.hit());
        undecided += usize::from(!impact.is_decided());
    }
    assert!((20..110).contains(&hits) && undecided < 5, "{hits} {undecided}");
}
