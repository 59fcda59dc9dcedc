//! Bodies that move along each other at a small gap that never closes, against closed forms.

use std::f64::consts::{FRAC_PI_2, TAU};

use impinge::sweep::{Impact, Motion, Sweep, time_of_impact};
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_testkit::generate::{Rng, cos, poses, sin, solids};

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("a pose")
}

fn moving(from: [f64; 3], to: [f64; 3]) -> Motion {
    Motion::between(at(from), at(to)).expect("rigid")
}

fn spinning(start: Pose, linear: [f64; 3], angular: [f64; 3]) -> Motion {
    Motion::screw(start, linear, angular, None).expect("rigid")
}

fn floor() -> Shape {
    Shape::half_space([0.0, 0.0, 1.0], 0.0).expect("a half-space")
}

/// Returns a flat square sheet of side 10 about the origin with `2 cells²` faces.
fn sheet(cells: u32) -> Mesh {
    let corners = (0..=cells).flat_map(|j| {
        (0..=cells).map(move |i| [i, j].map(|k| 10.0 * f64::from(k) / f64::from(cells) - 5.0)).map(|[x, y]| [x, y, 0.0])
    });
    let row = cells + 1;
    let faces: Vec<[u32; 3]> = (0..cells)
        .flat_map(|j| (0..cells).map(move |i| i + j * row))
        .flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]])
        .collect();
    Mesh::new(Positions::F64(corners.collect()), faces).expect("a legal mesh")
}

/// Returns a sphere about the origin with `4 rings²` faces, its poles on the z axis.
fn globe(rings: u32, radius: f64) -> Mesh {
    let around = 2 * rings;
    let corner = |i: u32, j: u32| {
        let (polar, turn) = (f64::from(j) / f64::from(rings) * TAU / 2.0, f64::from(i) / f64::from(around) * TAU);
        [radius * sin(polar) * cos(turn), radius * sin(polar) * sin(turn), radius * cos(polar)]
    };
    let corners = (0..=rings).flat_map(|j| (0..around).map(move |i| corner(i, j))).collect();
    let faces: Vec<[u32; 3]> = (0..rings)
        .flat_map(|j| (0..around).map(move |i| [j * around + i, j * around + (i + 1) % around]))
        .flat_map(|[a, b]| [[a, b, b + around], [a, b + around, a + around]])
        .collect();
    Mesh::new(Positions::F64(corners), faces).expect("a legal mesh")
}

#[track_caller]
fn assert_never(a: impl Into<Shape>, b: impl Into<Shape>, motion_a: &Motion, motion_b: &Motion) {
    let (a, b) = (a.into(), b.into());
    assert_eq!(time_of_impact(&a, &b, motion_a, motion_b).unwrap(), Impact::NEVER);
    assert_eq!(time_of_impact(&b, &a, motion_b, motion_a).unwrap(), Impact::NEVER);
}

#[test]
fn a_capsule_glides_over_a_floor() {
    let capsule = Shape::capsule([0.0, 0.0, 0.3], [0.0, 0.0, 1.5], 0.3).unwrap();
    for (height, way) in [(0.1, 20.0), (0.01, 20.0), (0.001, 2.0), (0.001, 1.0), (1e-4, 0.2), (1e-6, 1.0)] {
        let glide = moving([0.0, 0.0, height], [way, 0.0, height]);
        assert_never(&capsule, &floor(), &glide, &Motion::default());
    }
    assert_never(&capsule, &floor(), &moving([0.0, 0.0, 0.01], [20.0, 0.0, 0.03]), &Motion::default());
    // It sinks and reaches the floor at half of the time.
    let sink = moving([0.0, 0.0, 0.01], [20.0, 0.0, -0.01]);
    let impact = time_of_impact(&capsule, &floor(), &sink, &Motion::default()).unwrap();
    assert!(impact.t_lower <= 0.5 && impact.t_lower > 0.5 - 1e-8, "{impact:?}");
}

#[test]
fn a_wheel_rolls_over_a_floor() {
    let lay = |height: f64| Pose::from_axis_angle([1.0, 0.0, 0.0], FRAC_PI_2, [0.0, 0.0, height]).unwrap();
    let wheel = Shape::cylinder(0.1, 0.3).unwrap();
    let roll = |height: f64| spinning(lay(0.3 + height), [10.0, 0.0, 0.0], [0.0, 10.0 / 0.3, 0.0]);
    for height in [0.01, 0.001, 1e-4] {
        assert_never(&wheel, &floor(), &roll(height), &Motion::default());
    }
}

#[test]
fn a_rod_spins_beside_a_peg() {
    let rod = Shape::cuboid([1.0, 0.02, 0.02]).unwrap();
    let peg = Shape::cylinder(0.5, 0.05).unwrap();
    let rest = Motion::resting(at([1.2, 0.0, 0.0]));
    for turns in [1.0, 50.0, 1000.0] {
        let spin = spinning(Pose::IDENTITY, [0.0; 3], [0.0, 0.0, TAU * turns]);
        assert_never(&rod, &peg, &spin, &rest);
    }
    // A longer rod reaches the peg at the first turn.
    let long = Shape::cuboid([1.2, 0.02, 0.02]).unwrap();
    let spin = Motion::screw(at([0.0; 3]), [0.0; 3], [0.0, 0.0, TAU * 1000.0], None).unwrap();
    let turned =
        Motion::resting(Pose::from_axis_angle([0.0, 0.0, 1.0], 1.0, [1.2 * cos(1.0), 1.2 * sin(1.0), 0.0]).unwrap());
    let impact = time_of_impact(&long, &peg, &spin, &turned).unwrap();
    assert!(
        impact.hit() && impact.t_lower < 1.0 / (TAU * 1000.0) && impact.t_lower > 0.9 / (TAU * 1000.0),
        "{impact:?}"
    );
}

#[test]
fn sheets_slide_over_each_other() {
    let sheet = sheet(40);
    let pose = |x: f64, height: f64| Pose::from_axis_angle([0.0, 0.0, 1.0], 0.1, [x, 0.03, height]).unwrap();
    for height in [0.01, 0.001, 1e-5] {
        let slide = Motion::between(pose(-4.0, height), pose(4.0, height)).unwrap();
        assert_never(&sheet, &sheet, &Motion::default(), &slide);
        let spin = spinning(pose(0.0, height), [1.0, 2.0, 0.0], [0.0, 0.0, 100.0]);
        assert_never(&sheet, &sheet, &Motion::default(), &spin);
    }
}

#[test]
fn a_ball_glides_over_a_face() {
    let corners = vec![[-9e3, -9e3, 0.0], [9e3, -9e3, 0.0], [0.0, 9e3, 0.0]];
    let face = Mesh::new(Positions::F64(corners), vec![[0, 1, 2]]).unwrap();
    let ball = globe(8, 1.0);
    for (half, gap) in [(100.0, 0.1), (10.0, 0.01), (1.0, 0.001), (500.0, 0.5), (100.0, 0.5)] {
        let glide = moving([-half, 0.0, 1.0 + gap], [half, 0.0, 1.0 + gap]);
        assert_never(&face, &ball, &Motion::default(), &glide);
    }
}

#[test]
fn a_ball_turns_in_a_shell() {
    let (ball, shell) = (globe(40, 1.0), globe(40, 1.01));
    let spin = Motion::screw(Pose::IDENTITY, [0.0; 3], [0.3, 0.2, TAU], Some([0.0; 3])).unwrap();
    assert_never(&ball, &shell, &spin, &Motion::default());
}

#[test]
fn work_is_bounded() {
    let comb = Mesh::new(
        Positions::F64(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 2, 3]],
    );
    let comb = comb.unwrap();
    let long = Shape::cuboid([0.001, 4_294_967_296.0, 1e-300]).unwrap();
    let turned = |roll: f64| Pose::from_axis_angle([0.0, 0.6, 0.8], roll, [2.5, 0.0, 0.0]).unwrap();
    let motion = Motion::between(turned(0.3), turned(-0.7)).unwrap();
    let impact = time_of_impact(&comb, &long, &Motion::default(), &motion).unwrap();
    println!("{impact:?}");
    let impact = Sweep::new().with_max_pairs(10).time_of_impact(&comb, &long, &Motion::default(), &motion).unwrap();
    println!("{impact:?}");
    let _ = (Rng::new(1), poses::rotation(&mut Rng::new(1)), solids::icosphere(1));
}
