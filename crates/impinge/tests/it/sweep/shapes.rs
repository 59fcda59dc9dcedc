//! First contact of moving shapes, against closed forms and against meshes of the same form.

use impinge::shape::Shape;
use impinge::sweep::{Impact, Motion, time_of_impact};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::{Rng, poses, solids};

fn moving(from: [f64; 3], to: [f64; 3]) -> Motion {
    let [from, to] = [from, to].map(|at| Pose::from_translation(at).expect("a pose"));
    Motion::between(from, to).expect("rigid")
}

#[test]
fn falling_shapes_land_at_their_exact_times() {
    let floor = Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap();
    let fall = moving([0.0, 0.0, 4.0], [0.0, 0.0, -4.0]);
    for (shape, lowest) in [
        (Shape::sphere([0.0; 3], 1.0).unwrap(), 1.0),
        (Shape::capsule([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 0.5).unwrap(), 1.5),
        (Shape::cuboid([1.0, 2.0, 0.5]).unwrap(), 0.5),
        (Shape::cylinder(2.0, 1.0).unwrap(), 2.0),
        (Shape::ellipsoid([1.0, 2.0, 3.0]).unwrap(), 3.0),
        (Shape::tapered_capsule([0.0; 3], [4.0, 0.0, 1.0], [1.0, 2.5]).unwrap(), 1.5),
        (Shape::cuboid([1.0, 2.0, 0.5]).unwrap().rounded(0.25).unwrap(), 0.75),
        (Shape::cone(1.0, 2.0).unwrap().rounded(0.5).unwrap(), 1.5),
    ] {
        let truth = (4.0 - lowest) / 8.0;
        let impact = time_of_impact(&shape, &floor, &fall, &Motion::default()).unwrap();
        assert!(impact.t_lower <= truth && truth - 1e-9 < impact.t_lower, "{shape:?} {impact:?}");
        assert!(impact.t_upper < truth + 1e-6, "{shape:?} {impact:?}");
        let away = moving([0.0, 0.0, 4.0], [9.0, 0.0, 4.0]);
        assert_eq!(time_of_impact(&shape, &floor, &away, &Motion::default()).unwrap(), Impact::NEVER);
    }
    // A floor that turns is undecided.
    let turning = Motion::screw(Pose::IDENTITY, [0.0; 3], [0.0, 0.1, 0.0], None).unwrap();
    let ball = Shape::sphere([0.0; 3], 1.0).unwrap();
    let undecided = time_of_impact(&ball, &floor, &fall, &turning).unwrap();
    assert_eq!((undecided.t_lower, undecided.is_decided()), (0.0, false));
}

/// Checks that boxes as shapes, as meshes and as solids touch at the same time, and that a solid
/// intersects a shape that starts inside it.
#[test]
fn boxes_touch_when_their_meshes_do() {
    let plain = solids::cuboid([-0.5, -0.75, -1.0], [0.5, 0.75, 1.0]);
    let mesh = Mesh::new(Positions::F64(plain.vertices), plain.faces).unwrap();
    let kinds = [Shape::cuboid([0.5, 0.75, 1.0]).unwrap(), Shape::mesh(&mesh), Shape::solid(&mesh)];
    let mut rng = Rng::new(583);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..25 {
        let mut motion = || {
            let place = |rng: &mut Rng| {
                let mut place = poses::rotation(rng);
                place.translation = std::array::from_fn(|_| rng.uniform(-2.5, 2.5));
                Pose::new(place.linear, place.translation).unwrap()
            };
            Motion::between(place(&mut rng), place(&mut rng)).unwrap()
        };
        let (motion_a, motion_b) = (motion(), motion());
        let truth = time_of_impact(&mesh, &mesh, &motion_a, &motion_b).unwrap();
        for a in &kinds {
            for b in &kinds {
                let found = time_of_impact(a, b, &motion_a, &motion_b).unwrap();
                assert_eq!(found.hit(), truth.hit(), "{found:?} {truth:?}");
                assert!(!found.hit() || (found.t_lower - truth.t_lower).abs() < 1e-8, "{found:?} {truth:?}");
            }
        }
        hits += usize::from(truth.hit());
        misses += usize::from(!truth.hit());
    }
    assert!(hits > 4 && misses > 2, "{hits} {misses}");
    let small = Shape::sphere([0.0; 3], 0.125).unwrap();
    let way = moving([0.0; 3], [0.0, 0.0, 9.0]);
    let now = time_of_impact(&small, &kinds[2], &way, &Motion::default()).unwrap();
    assert_eq!([now.t_lower, now.t_upper], [0.0; 2]);
    let later = time_of_impact(&small, &kinds[1], &way, &Motion::default()).unwrap();
    assert!(later.t_lower <= 0.875 / 9.0 && later.t_lower > 0.875 / 9.0 - 1e-9, "{later:?}");
}
