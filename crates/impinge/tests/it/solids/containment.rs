//! Containment of one mesh in another.

use impinge::query::{self, Contained, SolidIntersection};
use impinge::{Mesh, Pose};
use impinge_testkit::Affine;
use impinge_testkit::generate::{Rng, poses, solids};

use crate::solids::shapes::{
    A, B, BOTH, NEITHER, engine, flipped, is_on_surface, moved, pose, solid_angles, soup, sphere, surface_or_solid,
    without_faces,
};

fn solid_intersection(a: (&Mesh, &Affine), b: (&Mesh, &Affine), solid: [bool; 2]) -> SolidIntersection {
    let (placed_a, placed_b) = (a.0.at(pose(a.1)), b.0.at(pose(b.1)));
    let answer = query::solid_intersection(surface_or_solid(placed_a, solid[0]), surface_or_solid(placed_b, solid[1]));
    assert_eq!(
        query::intersects(surface_or_solid(placed_a, solid[0]), surface_or_solid(placed_b, solid[1])),
        answer.intersects
    );
    let swapped = query::solid_intersection(surface_or_solid(placed_b, solid[1]), surface_or_solid(placed_a, solid[0]));
    assert_eq!((swapped.intersects, swapped.undecided), (answer.intersects, answer.undecided), "swapping");
    assert_eq!(swapped.contained.map(Contained::sides), answer.contained.map(|c| [c.sides()[1], c.sides()[0]]));
    assert_eq!(swapped.open, [answer.open[1], answer.open[0]]);
    answer
}

const HERE: Affine = Affine::IDENTITY;

#[test]
fn a_mesh_inside_another_intersects_its_solid() {
    let (large, small) = (engine(&sphere().scaled(4.0)), engine(&soup(&sphere())));
    let apart = SolidIntersection { intersects: false, contained: None, undecided: false, open: [false; 2] };
    let inside = SolidIntersection { intersects: true, contained: Some(Contained::A), ..apart };
    assert_eq!(solid_intersection((&small, &HERE), (&large, &HERE), NEITHER), apart);
    assert_eq!(solid_intersection((&small, &HERE), (&large, &HERE), A), apart);
    assert_eq!(solid_intersection((&small, &HERE), (&large, &HERE), B), inside);
    assert_eq!(solid_intersection((&small, &HERE), (&large, &HERE), BOTH), inside);
    let beside = Affine::translation([9.0, 0.0, 0.0]);
    assert_eq!(solid_intersection((&small, &beside), (&large, &HERE), BOTH), apart);
    let across = Affine::translation([4.0, 0.0, 0.0]);
    let answer = solid_intersection((&small, &across), (&large, &HERE), BOTH);
    assert_eq!(answer, SolidIntersection { intersects: true, ..apart });
}

#[test]
fn components_are_tested_one_by_one() {
    // Each mesh has a part inside the other one. A third part that only touches counts for neither.
    let ring = |size: f64, at: [f64; 3]| moved(solids::cuboid([-size; 3], [size; 3]), at);
    let a = ring(4.0, [0.0; 3]).joined(&ring(1.0, [20.0, 0.0, 0.0]));
    let b = ring(4.0, [20.0, 0.0, 0.0]).joined(&ring(1.0, [0.0; 3]));
    let touching = b.clone().joined(&ring(1.0, [-5.0, 0.0, 0.0]));
    let shell = engine(&ring(4.0, [0.0; 3]).joined(&flipped(ring(3.0, [0.0; 3]))));
    let (a, b, touching) = (engine(&a), engine(&b), engine(&touching));
    assert_eq!(solid_intersection((&a, &HERE), (&b, &HERE), BOTH).contained, Some(Contained::Both));
    assert_eq!(solid_intersection((&a, &HERE), (&b, &HERE), A).contained, Some(Contained::B));
    assert_eq!(solid_intersection((&a, &HERE), (&touching, &HERE), BOTH).contained, Some(Contained::Both));
    // A probe in the hollow of a shell is not inside it. A probe in its wall is.
    let probe = engine(&ring(0.25, [0.0; 3]));
    assert_eq!(solid_intersection((&probe, &HERE), (&shell, &HERE), BOTH).contained, None);
    let in_wall = Affine::translation([0.0, 3.5, 0.0]);
    assert_eq!(solid_intersection((&probe, &in_wall), (&shell, &HERE), BOTH).contained, Some(Contained::A));
}

#[test]
fn open_and_flipped_meshes_have_an_inside_and_are_reported_open() {
    let open = engine(&without_faces(sphere().scaled(4.0), &[0, 1, 2]));
    let small = engine(&sphere());
    let answer = solid_intersection((&small, &HERE), (&open, &HERE), BOTH);
    assert_eq!((answer.contained, answer.open, answer.undecided), (Some(Contained::A), [false, true], false));
    let inside_out = engine(&flipped(sphere().scaled(4.0)));
    assert_eq!(solid_intersection((&small, &HERE), (&inside_out, &HERE), B).contained, Some(Contained::A));
    // At a point in the opening of a box without its lid, the box covers exactly half of all
    // directions.
    let lidless = engine(&without_faces(solids::cuboid([0.0; 3], [2.0; 3]), &[2, 3]));
    let point = Mesh::new(impinge::Positions::F64(vec![[0.75, 1.25, 2.0]]), vec![[0, 0, 0]]).expect("a point");
    let answer = solid_intersection((&point, &HERE), (&lidless, &HERE), B);
    assert!(answer.undecided && answer.intersects && answer.contained == Some(Contained::A));
}

#[test]
fn mirrors_shears_and_rotations_keep_containment() {
    let mut rng = Rng::new(11);
    let (large, small) = (engine(&sphere().scaled(4.0)), engine(&sphere()));
    let mut inside = 0;
    for case in 0..60 {
        let (map_a, map_b) = match case % 3 {
            0 => (poses::rotation(&mut rng), poses::rotation(&mut rng)),
            1 => {
                (HERE, Affine { linear: [[-1.0, 0.5, 0.0], [0.0, 1.0, 0.25], [0.0, 0.0, 1.0]], translation: [0.0; 3] })
            }
            _ => (Affine { linear: poses::cube_symmetry(&mut rng), translation: [0.0; 3] }, HERE),
        };
        let offset: [f64; 3] = std::array::from_fn(|_| rng.uniform(-6.0, 6.0));
        let map_b = Affine { translation: std::array::from_fn(|k| map_a.translation[k] + offset[k]), ..map_b };
        let answer = solid_intersection((&large, &map_a), (&small, &map_b), A);
        if !query::intersects(large.at(pose(&map_a)), small.at(pose(&map_b))) {
            // A sphere of radius 4 stays one under maps that turn it. The distance of the center
            // decides.
            let distance = offset.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert_eq!(answer.contained.is_some(), distance < 4.0, "case {case}");
            inside += usize::from(answer.contained.is_some());
        }
    }
    assert!((3..40).contains(&inside), "{inside}");
}

/// Checks points of another mesh that integer maps place on the grid of the boxes. Many lie on
/// their surface, or in line with edges and corners, so that no float decides.
#[test]
fn posed_points_are_decided_exactly() {
    let mut rng = Rng::new(3);
    let boxes = solids::cuboid([0.0; 3], [4.0; 3])
        .joined(&flipped(solids::cuboid([1.0; 3], [3.0; 3])))
        .joined(&solids::cuboid([4.0, 4.0, 0.0], [5.0, 5.0, 1.0]));
    let outer = engine(&boxes);
    // Integers, orthogonal up to a scale of 13. One of the two maps mirrors.
    let turn = [[3.0, 4.0, 12.0], [-4.0, 12.0, -3.0], [-12.0, -3.0, 4.0]];
    let mut counts = [0; 3];
    for case in 0..400 {
        let linear = if case % 2 == 0 { turn } else { [turn[1], turn[0], turn[2]] };
        let offset: [f64; 3] = std::array::from_fn(|_| rng.integer(-100, 100) as f64);
        let shift: [f64; 3] = std::array::from_fn(|_| rng.integer(-8, 8) as f64 / 2.0);
        let image = |p: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| (0..3).map(|k| linear[i][k] * p[k]).sum::<f64>() + offset[i])
        };
        let world_from_outer = Affine { linear, translation: offset };
        let world_from_point = Affine { linear, translation: image(shift) };
        let seen: [f64; 3] = std::array::from_fn(|_| rng.integer(-1, 9) as f64 / 2.0);
        let local: [f64; 3] = std::array::from_fn(|k| seen[k] - shift[k]);
        let point = Mesh::new(impinge::Positions::F64(vec![local]), vec![[0, 0, 0]]).expect("a point");
        let answer = solid_intersection((&outer, &world_from_outer), (&point, &world_from_point), A);
        let on_surface = is_on_surface(&boxes, seen);
        let inside = !on_surface && solid_angles(&boxes, seen).round() != 0.0;
        assert_eq!(answer.contained, inside.then_some(Contained::B), "case {case}: {seen:?}");
        assert_eq!(answer.intersects, inside || on_surface, "case {case}: {seen:?}");
        assert!(!answer.undecided);
        counts[if on_surface { 0 } else { usize::from(inside) + 1 }] += 1;
    }
    assert!(counts.iter().all(|&count| count > 30), "{counts:?}");
}

#[test]
fn moving_both_or_scaling_both_keeps_containment() {
    let (large, small) = (engine(&sphere().scaled(4.0)), engine(&sphere()));
    let move_both = Pose::from_quaternion_wxyz([1e6, -3.0, 7.0], [0.5, 0.5, -0.5, 0.5]).expect("legal");
    let answer = query::solid_intersection(
        surface_or_solid(large.at(move_both), true),
        surface_or_solid(small.at(move_both), true),
    );
    assert_eq!(answer.contained, Some(Contained::B));
    for exponent in [-100, 60, 100] {
        let factor = 2.0_f64.powi(exponent);
        let (large, small) = (engine(&sphere().scaled(4.0 * factor)), engine(&sphere().scaled(factor)));
        let answer = query::solid_intersection(surface_or_solid(&large, true), surface_or_solid(&small, true));
        assert_eq!(answer.contained, Some(Contained::B), "2^{exponent}");
    }
}

#[test]
fn empty_meshes_contain_nothing() {
    let (empty, cube) = (engine(&impinge_testkit::Mesh::default()), engine(&solids::cuboid([0.0; 3], [1.0; 3])));
    assert!(!solid_intersection((&empty, &HERE), (&cube, &HERE), BOTH).intersects);
    assert!(!solid_intersection((&empty, &HERE), (&empty, &HERE), BOTH).intersects);
}
