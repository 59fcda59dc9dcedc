//! Tightness of fitted volumes, if the optimum is known or bounded.

use impinge::Pose;
use impinge::volume::{BoundingVolume, Capsule, Kdop14, Kdop18, Kdop26, Lozenge, MinMax, Obb, fit};
use impinge_testkit::generate::{Rng, poses, solids};

use crate::volumes::points::{KINDS, cloud};

/// Proved factor between an oriented box and its lower bound: 6√6, plus rounding.
const PROVED: f64 = 14.7;

#[test]
fn the_oriented_box_of_a_turned_box_is_that_box() {
    let mut rng = Rng::new(71);
    for _ in 0..40 {
        let edges: [f64; 3] = std::array::from_fn(|_| rng.uniform(0.1, 3.0));
        let turn = poses::rotation(&mut rng);
        let pose = Pose::new(turn.linear, turn.translation).unwrap();
        let corners: Vec<[f64; 3]> = solids::cuboid([0.0; 3], edges).vertices.iter().map(|&p| pose.apply(p)).collect();
        let fitted = fit::obb(&corners).unwrap();
        let volume: f64 = edges.iter().product();
        assert!((fitted.obb.volume() / volume - 1.0).abs() < 1e-9, "{edges:?}: {fitted:?}");
        assert!(fitted.volume_lower <= volume && fitted.volume_lower * PROVED >= volume);
    }
}

/// Checks for any set that the lower bound holds and the box is within the proved factor of it. For
/// flat sets both are zero.
#[test]
fn the_oriented_box_is_within_its_proved_factor() {
    let mut rng = Rng::new(72);
    let mut solid = 0;
    for round in 0..240 {
        let points = cloud(&mut rng, KINDS[round % 8], 40);
        let fitted = fit::obb(&points).unwrap();
        let bounds = MinMax::of(&points).unwrap();
        let extent = (0..3).map(|k| bounds.max()[k] - bounds.min()[k]).fold(0.0, f64::max);
        // A flat set far from the origin is as thick as the spacing of its coordinates.
        let coarse = bounds.max().iter().fold(0.0_f64, |far, x| far.max(x.abs())) * 1e-15;
        let rounding = (1e-12 * extent + coarse) * extent * extent * 8.0;
        assert!(fitted.volume_lower <= fitted.obb.volume());
        assert!(fitted.obb.volume() <= PROVED * fitted.volume_lower + rounding, "{fitted:?}");
        for other in [bounds.volume(), fit::principal_obb(&points).unwrap().volume()] {
            assert!(fitted.obb.volume() <= other * (1.0 + 1e-12) + rounding, "{fitted:?} {other}");
            assert!(fitted.volume_lower <= other + rounding);
        }
        solid += usize::from(fitted.volume_lower > rounding);
    }
    assert!((100..240).contains(&solid), "{solid} of 240 are solid");
}

#[test]
fn rods_fit_capsules_and_plates_fit_lozenges() {
    let mut rng = Rng::new(73);
    let turn = poses::rotation(&mut rng);
    let pose = Pose::new(turn.linear, [1e3, 0.0, 0.0]).unwrap();
    // Points on the surface of a capsule of radius 1 and length 6: poles, rings and sides about z.
    let mut pill = vec![[0.0, 0.0, 4.0], [0.0, 0.0, -4.0]];
    for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.6, 0.8), (-0.6, -0.8), (-0.8, 0.6), (0.8, -0.6)]
    {
        pill.extend([[x, y, 3.0], [x, y, -3.0], [0.6 * x, 0.6 * y, 3.8], [0.6 * x, 0.6 * y, -3.8]]);
    }
    let pill: Vec<[f64; 3]> = pill.into_iter().map(|p| pose.apply(p)).collect();
    let capsule = Capsule::of_points(&pill).unwrap();
    assert!((capsule.radius() - 1.0).abs() < 1e-9, "{capsule:?}");
    let truth = Capsule::new([0.0, 0.0, -3.0], [0.0, 0.0, 3.0], 1.0).unwrap();
    assert!((capsule.volume() / truth.volume() - 1.0).abs() < 1e-9, "{capsule:?}");

    // A plate with round rims: the middles of the sides, and corners of the faces and of the rim.
    let (a, b, r) = (3.0, 2.0, 0.25);
    let mut plate = vec![[a + r, 0.0, 0.0], [-a - r, 0.0, 0.0], [0.0, b + r, 0.0], [0.0, -b - r, 0.0]];
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        plate.extend([[s * a, t * b, r], [s * a, t * b, -r], [s * (a + 0.6 * r), t * (b + 0.8 * r), 0.0]]);
    }
    let plate: Vec<[f64; 3]> = plate.into_iter().map(|p| pose.apply(p)).collect();
    let lozenge = Lozenge::of_points(&plate).unwrap();
    assert!((lozenge.radius() - r).abs() < 1e-9, "{lozenge:?}");
    assert!(lozenge.volume() < Obb::of_points(&plate).unwrap().volume());
    assert!(lozenge.volume() < 0.2 * Capsule::of_points(&plate).unwrap().volume());
}

#[test]
fn polytopes_have_their_known_volumes_and_areas() {
    let cube = solids::cuboid([1.0; 3], [3.0; 3]).vertices;
    let octahedron: Vec<[f64; 3]> =
        (0..3).flat_map(|k| [1.0, -1.0].map(|s| std::array::from_fn(|axis| if axis == k { s } else { 0.0 }))).collect();
    let near = |x: f64, y: f64| (x / y - 1.0).abs() < 1e-12;
    for volume in
        [Kdop14::of(&cube).unwrap().volume(), Kdop18::of(&cube).unwrap().volume(), Kdop26::of(&cube).unwrap().volume()]
    {
        assert!(near(volume, 8.0), "{volume}");
    }
    assert!(near(Kdop26::of(&cube).unwrap().surface_area(), 24.0));
    let of_14 = Kdop14::of(&octahedron).unwrap();
    assert!(near(of_14.volume(), 4.0 / 3.0) && near(of_14.surface_area(), 4.0 * 3_f64.sqrt()), "{of_14:?}");
    // The rhombic dodecahedron around the octahedron: |x| + |y| ≤ 1 and so on.
    let of_18 = Kdop18::of(&octahedron).unwrap();
    assert!(near(of_18.volume(), 2.0), "{}", of_18.volume());
    assert!(near(Kdop26::of(&octahedron).unwrap().volume(), 4.0 / 3.0));
}

/// Checks that a moved polytope is smaller than the moved box of the same points, because its other
/// faces bound it too.
#[test]
fn moving_a_polytope_uses_all_its_slabs() {
    let mut rng = Rng::new(74);
    let ball = solids::icosphere(2).vertices;
    let mut sums = [0.0; 4];
    for _ in 0..50 {
        let turn = poses::rotation(&mut rng);
        let pose = Pose::new(turn.linear, turn.translation).unwrap();
        let volumes = [
            MinMax::of(&ball).unwrap().moved(&pose).unwrap().volume(),
            Kdop14::of(&ball).unwrap().moved(&pose).unwrap().volume(),
            Kdop18::of(&ball).unwrap().moved(&pose).unwrap().volume(),
            Kdop26::of(&ball).unwrap().moved(&pose).unwrap().volume(),
        ];
        sums = std::array::from_fn(|k| sums[k] + volumes[k] / 50.0);
    }
    assert!(sums[0] > 15.0 && sums[1] < 0.75 * sums[0] && sums[2] < sums[1] && sums[3] < sums[2], "{sums:?}");
}
