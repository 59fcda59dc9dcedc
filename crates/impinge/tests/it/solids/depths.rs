//! Penetration depths of solids: spheres and boxes of finer and finer triangles, whose depths are
//! known.

use impinge::query::{self, Cache, Penetration, Query};
use impinge::shape::Shape;
use impinge::{Mesh, Pose};
use impinge_testkit::generate::solids::{cuboid, icosphere};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::{Affine, Mesh as Plain};

use crate::solids::shapes::{A, B, BOTH, NEITHER, engine, pose, surface_or_solid};

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("in range")
}

fn moved(place: &Affine, by: [f64; 3]) -> Pose {
    pose(&Affine { translation: std::array::from_fn(|k| place.translation[k] + by[k]), ..*place })
}

/// Returns the depth of two overlapping solids, after checking it.
///
/// The exact queries check both bounds. Swapping the meshes must flip the normal and change nothing
/// else.
fn depth(a: &Mesh, b: &Mesh, place: &Affine) -> Penetration {
    let depth = query::penetration(a, b.at(pose(place))).expect("they intersect");
    assert!(0.0 <= depth.lower && depth.lower <= depth.upper && depth.upper.is_finite(), "{depth:?}");
    let along = |by: f64| b.at(moved(place, depth.normal.map(|n| n * by)));
    assert!(
        !query::intersects(surface_or_solid(a, true), surface_or_solid(along(depth.upper * (1.0 + 1e-9)), true)),
        "{depth:?}"
    );
    assert!(
        depth.lower == 0.0
            || query::intersects(surface_or_solid(a, true), surface_or_solid(along(depth.lower * (1.0 - 1e-9)), true))
    );
    let back = query::penetration(b.at(pose(place)), a).expect("they intersect");
    assert_eq!((depth.lower, depth.upper, depth.normal), (back.lower, back.upper, back.normal.map(|n| 0.0 - n)));
    depth
}

/// Checks two spheres that overlap by 0.5 in any direction, with finer and finer triangles.
#[test]
fn depths_of_refined_spheres_converge_in_any_direction() {
    let mut rng = Rng::new(581);
    for (subdivisions, wanted) in [(1, 0.2), (2, 0.05), (3, 0.0125), (4, 0.004), (5, 0.001)] {
        let sphere = engine(&icosphere(subdivisions));
        for _ in 0..4 {
            let mut place = poses::rotation(&mut rng);
            // A row of a rotation is a unit direction.
            place.translation = poses::rotation(&mut rng).linear[0].map(|x| 1.5 * x);
            let depth = depth(&sphere, &sphere, &place);
            assert!((depth.upper - 0.5).abs() < wanted, "{subdivisions} {depth:?}");
            assert!((depth.lower - 0.5).abs() < wanted, "{subdivisions} {depth:?}");
        }
    }
}

/// Checks a small sphere inside a large one: the depth is the shortest way out.
#[test]
fn a_solid_inside_another_has_the_depth_of_the_shortest_way_out() {
    let (large, small) = (engine(&icosphere(4)), engine(&icosphere(2)));
    let quarter = [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]];
    let place = Affine { linear: quarter, translation: [0.3, -0.4, 0.0] };
    let depth = depth(&large, &small, &place);
    assert!((depth.upper - 0.75).abs() < 0.01 && (depth.lower - 0.75).abs() < 0.02, "{depth:?}");
    assert!(!query::intersects(&large, small.at(pose(&place))), "no face intersects another");
}

/// Checks boxes as meshes against the closed form of boxes.
#[test]
fn depths_of_boxes_as_meshes_agree_with_the_closed_form() {
    let mesh = engine(&cuboid([-0.5; 3], [0.5; 3]));
    let plain = Shape::cuboid([0.5; 3]).unwrap();
    let mut rng = Rng::new(582);
    for case in 0..40 {
        let mut place = if case % 4 == 0 { Affine::IDENTITY } else { poses::rotation(&mut rng) };
        place.translation = [0.25 + 0.5 * rng.unit(), 0.25 * rng.uniform(-1.0, 1.0), 0.25 * rng.uniform(-1.0, 1.0)];
        let truth = query::penetration(plain.at(Pose::IDENTITY).unwrap(), plain.at(pose(&place)).unwrap());
        let truth = truth.expect("they overlap");
        let depth = depth(&mesh, &mesh, &place);
        assert!(depth.lower <= truth.upper && truth.lower <= depth.upper, "{depth:?} {truth:?}");
        assert!(depth.upper <= truth.upper * (1.0 + 1e-6) + 1e-6, "{depth:?} {truth:?}");
    }
}

/// Checks cubes with walls in line, which touch in corners and edges: both bounds are tight.
#[test]
fn depths_of_cubes_in_line_are_tight() {
    let mesh = engine(&cuboid([0.0; 3], [2.0; 3]));
    // In the same place, number 13, the shortest way out of one cube is not the opposite of the
    // other's.
    for number in (0..27).filter(|&number| number != 13) {
        let by = [0, 1, 2].map(|k| f64::from(number / 3_i32.pow(k) % 3 - 1));
        let expected = by.iter().fold(2.0_f64, |least, x| least.min(2.0 - x.abs()));
        let depth = depth(&mesh, &mesh, &Affine { translation: by, ..Affine::IDENTITY });
        assert!(depth.upper < expected + 1e-6 && depth.lower > expected - 1e-6, "{by:?} {depth:?}");
    }
}

/// Checks a peg in a slot that is open above: the way out is the top, past walls that are nearer.
#[test]
fn pegs_leave_slots_by_their_open_side() {
    let walls = cuboid([-2.0, -2.0, 0.0], [-0.5, 2.0, 1.0]).joined(&cuboid([0.5, -2.0, 0.0], [2.0, 2.0, 1.0]));
    let slot = engine(&walls.joined(&cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, -0.0625])));
    let peg = engine(&cuboid([-0.375, -1.0, -0.125], [0.375, 1.0, 2.0]));
    let depth = depth(&slot, &peg, &Affine::IDENTITY);
    assert!((depth.upper - 0.0625).abs() < 1e-6 && depth.normal[2] > 1.0 - 1e-9, "{depth:?}");
}

fn turned_inside_out(mut mesh: Plain) -> Plain {
    mesh.faces.iter_mut().for_each(|face| face.reverse());
    mesh
}

#[test]
fn meshes_apart_have_no_depth_and_touching_meshes_depth_zero() {
    let mesh = engine(&cuboid([0.0; 3], [1.0; 3]));
    assert!(query::penetration(&mesh, mesh.at(at([1.0_f64.next_up(), 0.0, 0.0]))).is_none());
    let touching = query::penetration(&mesh, mesh.at(at([1.0, 0.0, 0.0]))).expect("they touch");
    assert!(touching.lower == 0.0 && touching.upper == 0.0 && touching.normal[0] > 0.5, "{touching:?}");
    let hollow = engine(&cuboid([-1.0; 3], [2.0; 3]).joined(&turned_inside_out(cuboid([0.0; 3], [1.0; 3]))));
    let inside = query::penetration(&hollow, &mesh).expect("they touch all around");
    assert_eq!((inside.lower, inside.upper), (0.0, 0.0));
}

/// Checks that the distance of solids is zero exactly if they intersect as solids.
#[test]
fn distances_of_solids_are_zero_inside() {
    let (large, small) = (engine(&icosphere(2)), engine(&cuboid([-0.1; 3], [0.1; 3])));
    let sides = [(NEITHER, false), (A, true), (B, false), (BOTH, true)];
    for (solid, holds) in sides {
        let nested = query::distance(surface_or_solid(&large, solid[0]), surface_or_solid(&small, solid[1]));
        assert_eq!(nested.upper == 0.0, holds);
        assert_eq!(query::intersects(surface_or_solid(&large, solid[0]), surface_or_solid(&small, solid[1])), holds);
        assert_eq!(nested.witness.is_none(), holds);
        let apart = small.at(at([3.0, 0.0, 0.0]));
        assert_eq!(
            query::distance(surface_or_solid(&large, solid[0]), surface_or_solid(apart, solid[1])),
            query::distance(&large, apart)
        );
        let through = small.at(at([1.0, 0.0, 0.0]));
        assert!(
            query::distance(surface_or_solid(&large, solid[0]), surface_or_solid(through, solid[1])).witness.is_some()
        );
        // Any state of the cache gives the same answers.
        let mut cache = Cache::default();
        for there in [(&small).into(), apart, through, (&small).into()] {
            let found = Query::new()
                .with_cache(&mut cache)
                .distance(surface_or_solid(&large, solid[0]), surface_or_solid(there, solid[1]));
            assert_eq!(found, query::distance(surface_or_solid(&large, solid[0]), surface_or_solid(there, solid[1])));
            for clearance in [0.0, 0.5, 2.0] {
                let near = Query::new().with_cache(&mut cache).within(
                    surface_or_solid(&large, solid[0]),
                    surface_or_solid(there, solid[1]),
                    clearance,
                );
                assert_eq!(
                    near,
                    query::within(surface_or_solid(&large, solid[0]), surface_or_solid(there, solid[1]), clearance)
                );
                assert_eq!(near, found.upper <= clearance, "{found:?} {clearance}");
            }
        }
        assert!(!query::within(surface_or_solid(&large, solid[0]), surface_or_solid(&small, solid[1]), f64::NAN));
        assert!(!query::within(surface_or_solid(&large, solid[0]), surface_or_solid(&small, solid[1]), -0.5));
    }
}

/// Checks cubes that hardly overlap: the upper bound exceeds the depth only by rounding.
#[test]
fn shallow_depths_are_tight() {
    let mesh = engine(&cuboid([-0.5; 3], [0.5; 3]));
    for exponent in [-20, -30, -40, -45] {
        let deep = 2.0_f64.powi(exponent);
        for place in [[1.0 - deep, 0.0, 0.0], [0.25, 1.0 - deep, -0.125], [0.0, 0.5, deep - 1.0]] {
            let found = query::penetration(&mesh, mesh.at(at(place))).expect("they intersect");
            assert!(found.upper >= deep && found.upper <= deep + 1e-13, "2^{exponent}: {found:?}");
        }
    }
}
