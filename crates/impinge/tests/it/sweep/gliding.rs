//! Bodies that move along each other at a small gap that never closes, against closed forms.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::atomic::{AtomicUsize, Ordering};

use impinge::Budget;
use impinge::sweep::{Impact, Motion, Sweep, time_of_impact};
use impinge::{Mesh, Pose, Positions, Shape, query};
use impinge_testkit::generate::{Rng, cos, poses, sin, solids};
use impinge_testkit::rounds;

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
        assert_never(&capsule, floor(), &glide, &Motion::default());
    }
    assert_never(&capsule, floor(), &moving([0.0, 0.0, 0.01], [20.0, 0.0, 0.03]), &Motion::default());
    // It sinks and reaches the floor at half of the time.
    let sink = moving([0.0, 0.0, 0.01], [20.0, 0.0, -0.01]);
    let impact = time_of_impact(&capsule, floor(), &sink, &Motion::default()).unwrap();
    assert!(impact.t_lower <= 0.5 && impact.t_lower > 0.5 - 1e-8, "{impact:?}");
}

#[test]
fn a_wheel_rolls_over_a_floor() {
    let lay = |height: f64| Pose::from_axis_angle([1.0, 0.0, 0.0], FRAC_PI_2, [0.0, 0.0, height]).unwrap();
    let wheel = Shape::cylinder(0.1, 0.3).unwrap();
    let roll = |height: f64| spinning(lay(0.3 + height), [10.0, 0.0, 0.0], [0.0, 10.0 / 0.3, 0.0]);
    for height in [0.01, 0.001, 1e-4] {
        assert_never(&wheel, floor(), &roll(height), &Motion::default());
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

/// Checks a ball of 6,400 faces that turns in a shell of as many. It stays inside a sphere that is
/// apart from the shell.
#[test]
fn a_ball_turns_in_a_shell() {
    let (ball, shell) = (globe(40, 1.0), globe(40, 1.01));
    let spin = Motion::screw(Pose::IDENTITY, [0.0; 3], [0.3, 0.2, TAU], Some([0.0; 3])).unwrap();
    assert_never(&ball, &shell, &spin, &Motion::default());
}

/// Returns random velocities parallel to the plane z = 0, linear and angular: a slide, or a slide
/// and a spin about a normal of the plane. Also returns an upper bound on the travel of a point
/// within 3 of the body's origin.
fn parallel(rng: &mut Rng) -> ([[f64; 3]; 2], f64) {
    let way = 10.0_f64.powf(rng.uniform(-1.0, 2.0));
    let slide = [rng.uniform(-way, way), rng.uniform(-way, way), 0.0];
    let spin = if rng.integer(0, 1) == 0 { 0.0 } else { rng.uniform(-300.0, 300.0) };
    ([slide, [0.0, 0.0, spin]], 1.5 * way + 3.0 * spin.abs())
}

/// Checks random bodies that slide and spin above a floor. Their height is constant, or they sink
/// through the floor, which they reach at half of the time.
#[test]
fn parallel_motions_hit_only_if_they_sink() {
    let mut rng = Rng::new(707);
    let cube = solids::cuboid([-0.5, -0.75, -1.0], [0.5, 0.75, 1.0]);
    let cube = Mesh::new(Positions::F64(cube.vertices), cube.faces).unwrap();
    let bodies = [
        Shape::sphere([0.5, 0.0, 0.0], 0.5).unwrap(),
        Shape::capsule([0.0, -1.0, 0.0], [0.5, 1.0, 0.25], 0.25).unwrap(),
        Shape::cuboid([1.0, 0.5, 0.25]).unwrap(),
        Shape::cylinder(0.5, 0.75).unwrap(),
        Shape::cone(0.5, 0.75).unwrap(),
        Shape::ellipsoid([1.0, 0.5, 0.25]).unwrap(),
        Shape::mesh(&cube),
        Shape::mesh(&globe(5, 1.0)),
    ];
    let wide = Mesh::new(
        Positions::F64(vec![[-900.0, -900.0, 0.0], [900.0, -900.0, 0.0], [0.0, 900.0, 0.0]]),
        vec![[0, 1, 2]],
    );
    let grounds =
        [floor(), Shape::mesh(&wide.unwrap()), Shape::mesh(&sheet(8)), Shape::cuboid([500.0, 500.0, 1.0]).unwrap()];
    let (mut hits, mut misses) = (0, 0);
    for round in 0..rounds(400) {
        let body = &bodies[round % bodies.len()];
        let ground_number = rng.integer(0, 3) as usize;
        let ground = &grounds[ground_number];
        let level = if ground_number == 3 { 1.0 } else { 0.0 };
        let (linear, x) = (poses::rotation(&mut rng).linear, rng.uniform(-1.0, 1.0));
        let pose = |height: f64| Pose::new(linear, [x, 0.0, height]).unwrap();
        let lowest = 9.0 - query::distance(body.at(pose(9.0)).unwrap(), floor().at(Pose::IDENTITY).unwrap()).lower;
        let ([mut slide, spin], travel) = parallel(&mut rng);
        let gap = travel * 10.0_f64.powf(rng.uniform(-5.9, -2.0));
        // The sheet is finite, so bodies that sink may miss it.
        let sinks = rng.integer(0, 2) == 0 && ground_number != 2;
        slide[2] = if sinks { -2.0 * gap } else { 0.0 };
        let (motion, rest) = (spinning(pose(lowest + gap + level), slide, spin), Motion::default());
        let ask = |a: &Shape, b: &Shape, m: [&Motion; 2]| time_of_impact(a, b, m[0], m[1]).unwrap();
        let impact = ask(body, ground, [&motion, &rest]);
        let swapped = ask(ground, body, [&rest, &motion]);
        assert_eq!([impact.t_lower, impact.t_upper], [swapped.t_lower, swapped.t_upper]);
        if sinks {
            assert!(impact.t_lower <= 0.5 + 1e-6 && impact.t_lower > 0.49, "{round} {gap} {impact:?} {body:?}");
        } else {
            assert_eq!(impact, Impact::NEVER, "{round} {gap} {travel} {motion:?} {body:?}");
        }
        hits += usize::from(sinks);
        misses += usize::from(!sinks);
    }
    assert!(hits * 8 > misses && misses * 2 > hits, "{hits} {misses}");
}

/// Checks cubes on a grid that move by whole numbers, so that many only graze each other, against
/// the times at which their intervals overlap on each axis.
#[test]
fn cubes_on_a_grid_are_never_late() {
    let cube = solids::cuboid([-1.0; 3], [1.0; 3]);
    let cube = Mesh::new(Positions::F64(cube.vertices), cube.faces).unwrap();
    let kinds = [Shape::mesh(&cube), Shape::solid(&cube), Shape::cuboid([1.0; 3]).unwrap()];
    let mut rng = Rng::new(709);
    let (mut hits, mut grazes, mut misses) = (0, 0, 0);
    for round in 0..rounds(300) {
        let mut whole = |most: i64| -> [f64; 3] { std::array::from_fn(|_| rng.integer(-most, most) as f64) };
        let (start, way) = (whole(4), whole(8));
        // Time at which the distance on an axis becomes 2 or less, and at which it exceeds 2 again.
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for k in 0..3 {
            let times = [-2.0, 2.0].map(|side| (side - start[k]) / way[k]);
            if way[k] != 0.0 {
                (first, last) = (first.max(times[0].min(times[1])), last.min(times[0].max(times[1])));
            } else if start[k].abs() > 2.0 {
                last = -1.0;
            }
        }
        let motion = moving(start, [0, 1, 2].map(|k| start[k] + way[k]));
        let (a, b) = (&kinds[round % 3], &kinds[round / 3 % 3]);
        // The surface of a mesh that is at the same place as the other one touches it too.
        let impact = time_of_impact(a, b, &motion, &Motion::default()).unwrap();
        assert_eq!(impact.hit(), first <= last, "{start:?} {way:?} {impact:?}");
        if first <= last {
            assert!(impact.t_lower <= first && impact.t_lower > first - 1e-9, "{first} {impact:?}");
        }
        hits += usize::from(first < last && first > 0.0);
        grazes += usize::from(first == last);
        misses += usize::from(first > last);
    }
    assert!(hits > 20 && grazes > 4 && misses > 60, "{hits} {grazes} {misses}");
}

/// Checks a sweep of a bar of length 2^33, whose ends move by as much.
#[test]
fn work_is_bounded() {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let part = Mesh::new(Positions::F64(corners), vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 2, 3]]).unwrap();
    let bar = Shape::cuboid([0.001, 4_294_967_296.0, 1e-300]).unwrap();
    let turned = |roll: f64| Pose::from_axis_angle([0.0, 0.6, 0.8], roll, [2.5, 0.0, 0.0]).unwrap();
    let motion = Motion::between(turned(0.3), turned(-0.7)).unwrap();
    let ask = |sweep: Sweep<'_>| sweep.time_of_impact(&part, &bar, &Motion::default(), &motion).unwrap();
    // Each smaller limit on the work gives a time that is no later, and the answer is the safe one.
    let mut known = 0.0;
    for limit in [1, 10, 100, 1000, 10_000] {
        let impact = ask(Sweep::new().with_max_pairs(limit));
        assert!(impact.hit() && impact.t_lower >= known, "{limit} {impact:?}");
        known = impact.t_lower;
    }
    let calls = AtomicUsize::new(0);
    let stop = || calls.fetch_add(1, Ordering::Relaxed) >= 20;
    let impact = ask(Sweep::new().with_budget(&Budget::new().with_cancel(&stop)));
    assert!(impact.hit() && !impact.is_decided() && calls.into_inner() < 60, "{impact:?}");
}

#[test]
fn a_clearance_is_kept() {
    let (sphere, rest) = (Shape::sphere([0.0; 3], 0.5).unwrap(), Motion::default());
    let sweep = Sweep::new().with_clearance(0.25);
    let impact = sweep.time_of_impact(&sphere, floor(), &moving([0.0, 0.0, 2.75], [0.0, 0.0, 0.0]), &rest).unwrap();
    assert!(impact.t_lower <= 2.0 / 2.75 && impact.t_lower > 2.0 / 2.75 - 1e-9 && impact.t_upper < 0.728, "{impact:?}");
    let glide = |height: f64| moving([0.0, 0.0, height], [9.0, 0.0, height]);
    let near = sweep.time_of_impact(&sphere, floor(), &glide(0.74), &rest).unwrap();
    assert_eq!([near.t_lower, near.t_upper], [0.0; 2]);
    assert_eq!(sweep.time_of_impact(&sphere, floor(), &glide(0.751), &rest).unwrap(), Impact::NEVER);
    let from = |end: f64| {
        let motion = moving([0.0, 0.0, 0.74], [9.0, 0.0, end]);
        sweep.ignoring_touch().time_of_impact(&sphere, floor(), &motion, &rest).unwrap()
    };
    assert_eq!((from(0.74), from(0.8)), (Impact::NEVER, Impact::NEVER));
    assert!(from(0.7).t_lower < 1e-6);
}

#[test]
fn bodies_that_touch_may_slide_or_part() {
    let cube = solids::cuboid([-0.5; 3], [0.5; 3]);
    let cube = Mesh::new(Positions::F64(cube.vertices), cube.faces).unwrap();
    let ground = solids::cuboid([-50.0, -50.0, -1.0], [50.0, 50.0, 0.0]);
    let ground = Mesh::new(Positions::F64(ground.vertices), ground.faces).unwrap();
    let (rest, sweep) = (Motion::default(), Sweep::new().ignoring_touch());
    let slab = Shape::cuboid([50.0, 50.0, 1.0]).unwrap();
    let slab_at = Motion::resting(at([0.0, 0.0, -1.0]));
    let bodies = [Shape::mesh(&cube), Shape::cuboid([0.5; 3]).unwrap(), Shape::sphere([0.0; 3], 0.5).unwrap()];
    for body in &bodies {
        for (under, under_at) in [(&floor(), &rest), (&Shape::mesh(&ground), &rest), (&slab, &slab_at)] {
            let ask = |to: [f64; 3]| sweep.time_of_impact(body, under, &moving([0.0, 0.0, 0.5], to), under_at).unwrap();
            assert_eq!(ask([7.0, 3.0, 0.5]), Impact::NEVER);
            assert_eq!(ask([7.0, 3.0, 4.5]), Impact::NEVER);
            let sinks = ask([7.0, 3.0, 0.0]);
            assert!(sinks.hit() && sinks.t_lower < 1e-6, "{sinks:?}");
            let spin = spinning(at([0.0, 0.0, 0.5]), [1.0, 0.0, 1.0], [0.0, 0.0, 30.0]);
            assert_eq!(sweep.time_of_impact(body, under, &spin, under_at).unwrap(), Impact::NEVER);
            let plain = time_of_impact(body, under, &spin, under_at).unwrap();
            assert_eq!([plain.t_lower, plain.t_upper], [0.0; 2]);
        }
    }
    // A sheet in the plane of another one may leave it on either side.
    let sheet = sheet(4);
    for end in [[1.0, 2.0, 0.0], [1.0, 2.0, 3.0], [0.0, 0.0, -3.0]] {
        let turned = |place: [f64; 3]| Pose::from_axis_angle([0.0, 0.0, 1.0], 0.5, place).unwrap();
        let motion = Motion::between(turned([0.0; 3]), turned(end)).unwrap();
        assert_eq!(sweep.time_of_impact(&sheet, &sheet, &motion, &rest).unwrap(), Impact::NEVER);
    }
    // A solid slides along the ground until it reaches a wall that stands on it.
    let (solid, ground) = (Shape::solid(&cube), Shape::solid(&ground));
    let slide = moving([0.0, 0.0, 0.5], [8.0, 0.0, 0.5]);
    assert_eq!(sweep.time_of_impact(&solid, &ground, &slide, &rest).unwrap(), Impact::NEVER);
    let wall = Shape::cuboid([0.5, 9.0, 2.0]).unwrap();
    let both = Shape::compound(&[(floor(), Pose::IDENTITY), (wall, at([5.0, 0.0, 2.0]))]).unwrap();
    let impact = sweep.time_of_impact(&bodies[1], &both, &slide, &rest).unwrap();
    assert!(impact.t_lower <= 0.5 + 1e-9 && impact.t_lower > 0.5 - 1e-9 && impact.t_upper < 0.501, "{impact:?}");
    let touch = impact.touch.unwrap();
    assert_eq!((touch.parts, touch.faces, touch.normal), ([0, 1], [None, None], [1.0, 0.0, 0.0]));
    assert!((touch.point[0] - 4.5).abs() < 1e-6, "{touch:?}");
    // A solid that starts inside another one is in contact.
    let inside = sweep.time_of_impact(&solid, &ground, &moving([0.0, 0.0, -0.5], [0.0, 0.0, 9.0]), &rest).unwrap();
    assert_eq!([inside.t_lower, inside.t_upper], [0.0; 2]);
}

#[test]
fn the_first_touch_has_its_place() {
    let (sphere, rest) = (Shape::sphere([0.0; 3], 0.5).unwrap(), Motion::default());
    let fall = moving([1.0, 2.0, 2.5], [1.0, 2.0, 0.0]);
    let touch = time_of_impact(&sphere, floor(), &fall, &rest).unwrap().touch.unwrap();
    assert_eq!((touch.normal, touch.parts, touch.faces), ([0.0, 0.0, -1.0], [0, 0], [None, None]));
    let off = |point: [f64; 3], truth: [f64; 3]| (0..3).map(|k| (point[k] - truth[k]).abs()).fold(0.0, f64::max);
    assert!(off(touch.point, [1.0, 2.0, 0.0]) < 1e-8, "{touch:?}");
    let back = time_of_impact(floor(), &sphere, &rest, &fall).unwrap().touch.unwrap();
    assert_eq!((back.normal, back.point), ([0.0, 0.0, 1.0], touch.point));
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    let touch =
        time_of_impact(&cube, &cube, &rest, &moving([3.0, 0.25, 0.0], [0.0, 0.25, 0.0])).unwrap().touch.unwrap();
    assert!(off(touch.normal, [1.0, 0.0, 0.0]) < 1e-8 && (touch.point[0] - 0.5).abs() < 1e-8, "{touch:?}");
    // A corner of a tetrahedron falls on the second face of a mesh.
    let corners = vec![[0.25, 0.25, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    let tip = Mesh::new(Positions::F64(corners), vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]).unwrap();
    let corners =
        vec![[5.0, 5.0, 0.0], [6.0, 5.0, 0.0], [5.0, 6.0, 0.0], [-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]];
    let ground = Mesh::new(Positions::F64(corners), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let touch =
        time_of_impact(&tip, &ground, &moving([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), &rest).unwrap().touch.unwrap();
    assert_eq!(touch.faces[1], Some(1));
    assert!(touch.faces[0].is_some_and(|face| face < 3), "{touch:?}");
    assert!(off(touch.point, [0.25, 0.25, 0.0]) < 1e-8 && off(touch.normal, [0.0, 0.0, -1.0]) < 1e-8, "{touch:?}");
}
