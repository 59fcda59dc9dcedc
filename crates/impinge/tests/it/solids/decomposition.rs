//! Convex parts cover the solid, and reach no farther outside it than they say.

use impinge::budget::Stopped;
use impinge::mesh::{Containment, ConvexParts, DecompositionOptions};
use impinge::{Budget, InputErrorKind, Mesh, Pose, Shape, query};
use impinge_testkit::generate::{Rng, knots, poses, solids};
use impinge_testkit::rounds;

use crate::solids::shapes::engine;

type Box3 = [[f64; 3]; 2];

fn parts_of(mesh: &Mesh, concavity: f64, max_parts: usize) -> ConvexParts {
    let options = DecompositionOptions { concavity: Some(concavity), max_parts };
    mesh.convex_parts(options, Budget::unlimited()).expect("a closed mesh")
}

fn union_of(boxes: &[Box3]) -> impinge_testkit::Mesh {
    let each = boxes.iter().map(|&[low, high]| solids::cuboid(low, high));
    each.reduce(|all, next| all.joined(&next)).expect("a box")
}

fn covers(parts: &ConvexParts, point: [f64; 3]) -> bool {
    parts.parts().iter().any(|part| part.hull.contains(point))
}

/// Returns a random point in the hull of some points, rounded.
fn within(rng: &mut Rng, points: &[[f64; 3]]) -> [f64; 3] {
    let chosen: [[f64; 3]; 4] = std::array::from_fn(|_| points[rng.integer(0, points.len() as i64 - 1) as usize]);
    let weights: [f64; 4] = std::array::from_fn(|_| rng.unit() + 1e-3);
    let sum: f64 = weights.iter().sum();
    std::array::from_fn(|k| (0..4).map(|i| chosen[i][k] * weights[i]).sum::<f64>() / sum)
}

/// Checks parts against samples: points of the solid must be in hulls, and points of hulls must not
/// be farther from the solid than the bounds of their part. Returns the largest distance.
fn assert_sound(mesh: &Mesh, parts: &ConvexParts, rng: &mut Rng, samples: usize) -> f64 {
    let corners: Vec<[f64; 3]> = (0..mesh.faces().len() as u32).flat_map(|face| mesh.corners(face)).collect();
    for _ in 0..samples {
        let point = within(rng, &corners);
        let is_in = mesh.contains(&[point]).expect("in range")[0] != Containment::Outside;
        assert!(!is_in || covers(parts, point), "{point:?}");
        let corner = corners[rng.integer(0, corners.len() as i64 - 1) as usize];
        assert!(covers(parts, corner), "{corner:?}");
    }
    let mut worst = 0.0_f64;
    for part in parts.parts() {
        assert!(part.concavity_lower <= part.concavity_upper);
        for _ in 0..samples / parts.parts().len() + 1 {
            let point = within(rng, part.hull.positions());
            if mesh.contains(&[point]).expect("in range")[0] == Containment::Outside {
                let nearest = mesh.closest_point(point).expect("in range").expect("a face");
                assert!(nearest.lower <= part.concavity_upper, "{point:?} {nearest:?} {part:?}");
                worst = worst.max(nearest.lower);
            }
        }
    }
    worst
}

#[test]
fn a_convex_mesh_is_one_part_which_is_its_hull() {
    for mesh in [solids::cuboid([-1.0, 0.0, 2.0], [3.0, 1.0, 4.0]), solids::icosphere(2), solids::tetrahedron()] {
        let parts = parts_of(&engine(&mesh), 0.0, 64);
        assert_eq!((parts.parts().len(), parts.concavity(), parts.is_within()), (1, 0.0, true));
        assert_eq!(parts.parts()[0].hull.positions().len(), mesh.vertices.len());
    }
}

#[test]
fn bars_of_an_angle_a_channel_and_a_cross_are_parts_of_their_own() {
    let bar = |low: [f64; 3], high: [f64; 3]| [low, high];
    let flat = bar([0.0, 0.0, 0.0], [4.0, 1.0, 1.0]);
    let left = bar([0.0, 0.0, 0.0], [1.0, 4.0, 1.0]);
    let right = bar([3.0, 0.0, 0.0], [4.0, 4.0, 1.0]);
    let up = bar([0.0, 0.0, 0.0], [1.0, 1.0, 4.0]);
    let mut rng = Rng::new(3);
    for (boxes, count) in [(vec![flat, left], 2), (vec![flat, left, right], 3), (vec![flat, left, up], 3)] {
        let mesh = union_of(&boxes);
        for turned in [false, true] {
            let map = poses::rotation(&mut rng);
            let mut mesh = mesh.clone();
            if turned {
                mesh.vertices.iter_mut().for_each(|vertex| *vertex = map.apply_rounded(*vertex));
            }
            let mesh = engine(&mesh);
            let parts = parts_of(&mesh, 0.125, 16);
            assert_eq!(parts.parts().len(), count, "{boxes:?} {turned}");
            assert!(parts.is_within());
            assert_sound(&mesh, &parts, &mut rng, 400);
            let volume = parts.parts().iter().map(|part| Shape::hull(part.hull.clone()));
            assert_eq!(volume.count(), count);
        }
    }
}

#[test]
fn a_torus_and_a_knot_are_covered_by_parts_within_the_bound() {
    let torus = knots::torus_knot(24, 10, knots::Knot { p: 1.0, q: 0.0, radius: 0.5, bump: 0.0 });
    let knot = knots::torus_knot(60, 8, knots::TREFOIL);
    let mut rng = Rng::new(4);
    for (mesh, least) in [(torus, 4), (knot, 10)] {
        let mesh = engine(&mesh);
        let parts = parts_of(&mesh, 0.3, 128);
        assert!(parts.parts().len() >= least && parts.is_within(), "{}", parts.parts().len());
        let worst = assert_sound(&mesh, &parts, &mut rng, 2000);
        // The samples come near the bound, so a bound that is too small would be noticed.
        assert!(worst > 0.03, "{worst}");
    }
}

/// Boxes on a lattice share many planes, edges and corners. Their union is known without the
/// engine.
#[test]
fn lattice_bricks_are_covered_exactly_and_the_bounds_hold() {
    let mut rng = Rng::new(5);
    let (mut divided, mut far) = (0, 0);
    for case in 0..rounds(24) {
        let boxes: Vec<Box3> = (0..rng.integer(1, 5))
            .map(|_| {
                let low: [i64; 3] = std::array::from_fn(|_| rng.integer(0, 4));
                let high: [i64; 3] = std::array::from_fn(|k| low[k] + rng.integer(1, 3));
                [low.map(|x| x as f64), high.map(|x| x as f64)]
            })
            .collect();
        let gap = |point: [f64; 3], [low, high]: &Box3| {
            let per_axis = (0..3).map(|k| (low[k] - point[k]).max(point[k] - high[k]).max(0.0).powi(2));
            per_axis.sum::<f64>().sqrt()
        };
        let mesh = engine(&union_of(&boxes));
        let parts = parts_of(&mesh, if case % 2 == 0 { 0.25 } else { 1.0 }, 32);
        for brick in &boxes {
            for _ in 0..200 {
                // A point of the lattice of eighths, often on faces and edges.
                let point = std::array::from_fn(|k| {
                    brick[0][k] + rng.integer(0, 8 * (brick[1][k] - brick[0][k]) as i64) as f64 / 8.0
                });
                assert!(covers(&parts, point), "case {case}: {point:?} {boxes:?}");
            }
        }
        for part in parts.parts() {
            for _ in 0..200 {
                let point = within(&mut rng, part.hull.positions());
                let distance = boxes.iter().map(|brick| gap(point, brick)).fold(f64::INFINITY, f64::min);
                assert!(distance <= part.concavity_upper + 1e-12, "case {case}: {point:?} {boxes:?}");
                far += usize::from(distance > 0.5 * part.concavity_upper);
            }
        }
        divided += usize::from(parts.parts().len() > 1);
    }
    assert!(divided > rounds(24) / 2 && far > 20, "{divided} {far}");
}

#[test]
fn too_few_parts_are_reported_with_a_bound_that_holds() {
    let mesh = engine(&knots::torus_knot(60, 8, knots::TREFOIL));
    let mut rng = Rng::new(6);
    for max_parts in [1, 5] {
        let parts = parts_of(&mesh, 0.05, max_parts);
        assert!((1..=max_parts).contains(&parts.parts().len()));
        assert!(!parts.is_within() && parts.concavity() > 0.05 && parts.stopped().is_none());
        assert!(parts.concavity() < 1.5 * assert_sound(&mesh, &parts, &mut rng, 4000));
    }
}

/// The distance of the hull from the solid is the depth of a groove. The points that are that far
/// are on the border of the hull, and never the center of a box.
#[test]
fn a_groove_is_measured_to_its_floor() {
    let mut rng = Rng::new(9);
    for (depth, turned) in [(0.5, false), (0.5, true), (0.8125, false)] {
        let floor = 20.0 - depth;
        let boxes = [
            [[0.0; 3], [20.0, 20.0, floor]],
            [[0.0, 0.0, 10.0], [9.0, 20.0, 20.0]],
            [[11.0, 0.0, 10.0], [20.0, 20.0, 20.0]],
        ];
        let mut mesh = union_of(&boxes);
        if turned {
            let map = poses::rotation(&mut rng);
            mesh.vertices.iter_mut().for_each(|vertex| *vertex = map.apply_rounded(*vertex));
        }
        let parts = parts_of(&engine(&mesh), 0.25, 1);
        let part = &parts.parts()[0];
        assert!(part.concavity_lower <= depth + 1e-9 && depth - 1e-9 <= part.concavity_lower, "{depth}: {part:?}");
        // The boxes of a search are along the axes, so they fit a turned groove worse.
        let most = if turned { 1.375 } else { 1.125 } * depth;
        assert!(depth - 1e-9 <= part.concavity_upper && part.concavity_upper <= most, "{depth}: {part:?}");
    }
}

#[test]
fn a_spent_budget_leaves_hulls_that_cover_the_solid() {
    let mesh = engine(&knots::torus_knot(60, 8, knots::TREFOIL));
    let mut rng = Rng::new(7);
    let mut counts = Vec::new();
    for steps in [0, 40, 400] {
        let budget = Budget::new().with_steps(steps);
        let options = DecompositionOptions { concavity: Some(0.05), max_parts: 256 };
        let parts = mesh.convex_parts(options, &budget).expect("closed");
        assert_eq!(parts.stopped(), Some(Stopped::Steps));
        assert_sound(&mesh, &parts, &mut rng, 300);
        counts.push(parts.parts().len());
    }
    assert!(counts[0] == 1 && counts[2] > 1, "{counts:?}");
}

#[test]
fn parts_do_not_depend_on_the_number_of_threads() {
    let mesh = engine(&knots::torus_knot(40, 6, knots::TREFOIL));
    let [one, two] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let parts = pool.install(|| parts_of(&mesh, 0.3, 64));
        parts.parts().iter().map(|part| part.hull.positions().to_vec()).collect::<Vec<_>>()
    });
    assert_eq!(one, two);
}

#[test]
fn a_compound_of_the_parts_answers_as_the_solid_where_the_parts_are_exact() {
    let boxes = [[[0.0; 3], [4.0, 1.0, 1.0]], [[0.0; 3], [1.0, 4.0, 1.0]]];
    let mesh = engine(&union_of(&boxes));
    let parts = Shape::from(&parts_of(&mesh, 0.125, 16)).at(Pose::IDENTITY).expect("legal");
    let solid = Shape::solid(&mesh).at(Pose::IDENTITY).expect("legal");
    let mut rng = Rng::new(8);
    for _ in 0..200 {
        let at = std::array::from_fn(|_| rng.integer(-8, 40) as f64 / 8.0);
        let point = Shape::point(at).expect("finite").at(Pose::IDENTITY).expect("legal");
        assert_eq!(query::intersects(&parts, &point), query::intersects(&solid, &point), "{at:?}");
    }
}

#[test]
fn invalid_input_is_refused() {
    let kind = |mesh: &Mesh, concavity, max_parts| {
        let options = DecompositionOptions { concavity, max_parts };
        mesh.convex_parts(options, Budget::unlimited()).expect_err("invalid").kind().clone()
    };
    let closed = engine(&solids::icosphere(1));
    assert_eq!(kind(&closed, Some(-1.0), 1), InputErrorKind::Negative { what: "concavity", index: 0 });
    assert_eq!(kind(&closed, Some(f64::NAN), 1), InputErrorKind::NonFinite { what: "concavity", index: 0 });
    for max_parts in [0, usize::MAX] {
        assert!(matches!(kind(&closed, None, max_parts), InputErrorKind::OutOfRange { what: "max_parts", .. }));
    }
    let open = engine(&solids::plane_grid(2, 2));
    assert_eq!(kind(&open, None, 1), InputErrorKind::Open { edges: 8 });
    let empty = Mesh::new(Vec::<[f64; 3]>::new(), Vec::new()).expect("legal");
    assert_eq!(kind(&empty, None, 1), InputErrorKind::Empty { what: "faces" });
}
