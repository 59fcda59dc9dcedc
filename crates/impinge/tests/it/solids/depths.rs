//! How deep solids are in each other: spheres and boxes, whose depths are known, as ever smaller triangles.

use impinge::query::{self, Cache, Penetration, Query};
use impinge::shape::Shape;
use impinge::{Mesh, Pose};
use impinge_testkit::generate::solids::{cuboid, icosphere};
use impinge_testkit::generate::{Rng, poses};
use impinge_testkit::{Affine, Mesh as Plain};

use crate::solids::shapes::{A, B, BOTH, NEITHER, engine, pose, taken};

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_translation(translation).expect("in range")
}

fn moved(place: &Affine, by: [f64; 3]) -> Pose {
    pose(&Affine { translation: std::array::from_fn(|k| place.translation[k] + by[k]), ..*place })
}

/// What holds of any depth: both ends are asked of the exact query, and swapping the meshes turns the normal and nothing else.
fn ask(a: &Mesh, b: &Mesh, place: &Affine) -> Penetration {
    let depth = query::penetration(a, b.at(pose(place))).expect("they meet");
    assert!(0.0 <= depth.lower && depth.lower <= depth.upper && depth.upper.is_finite(), "{depth:?}");
    let along = |by: f64| b.at(moved(place, depth.normal.map(|n| n * by)));
    assert!(!query::intersects(taken(a, true), taken(along(depth.upper * (1.0 + 1e-9)), true)), "{depth:?}");
    assert!(depth.lower == 0.0 || query::intersects(taken(a, true), taken(along(depth.lower * (1.0 - 1e-9)), true)));
    let back = query::penetration(b.at(pose(place)), a).expect("they meet");
    assert_eq!((depth.lower, depth.upper, depth.normal), (back.lower, back.upper, back.normal.map(|n| 0.0 - n)));
    depth
}

/// Two spheres that overlap by one half in any direction, of ever smaller triangles.
#[test]
fn depths_of_spheres_close_in_on_the_spheres() {
    let mut rng = Rng::new(581);
    for (subdivisions, wanted) in [(1, 0.2), (2, 0.05), (3, 0.0125), (4, 0.004), (5, 0.001)] {
        let sphere = engine(&icosphere(subdivisions));
        for _ in 0..4 {
            let mut place = poses::rotation(&mut rng);
            // A row of a rotation is a direction of length 1.
            place.translation = poses::rotation(&mut rng).linear[0].map(|x| 1.5 * x);
            let depth = ask(&sphere, &sphere, &place);
            assert!((depth.upper - 0.5).abs() < wanted, "{subdivisions} {depth:?}");
            assert!((depth.lower - 0.5).abs() < wanted, "{subdivisions} {depth:?}");
        }
    }
}

/// A small sphere in a large one: out by the nearest way, and not farther.
#[test]
fn the_way_out_of_a_solid_is_found_from_inside() {
    let (large, small) = (engine(&icosphere(4)), engine(&icosphere(2)));
    let quarter = [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]];
    let place = Affine { linear: quarter, translation: [0.3, -0.4, 0.0] };
    let depth = ask(&large, &small, &place);
    assert!((depth.upper - 0.75).abs() < 0.01 && (depth.lower - 0.75).abs() < 0.02, "{depth:?}");
    assert!(!query::intersects(&large, small.at(pose(&place))), "no face meets another");
}

/// Boxes as meshes are as deep as boxes, which have a closed form.
#[test]
fn boxes_are_as_deep_as_in_closed_form() {
    let mesh = engine(&cuboid([-0.5; 3], [0.5; 3]));
    let plain = Shape::cuboid([0.5; 3]).unwrap();
    let mut rng = Rng::new(582);
    for case in 0..40 {
        let mut place = if case % 4 == 0 { Affine::IDENTITY } else { poses::rotation(&mut rng) };
        place.translation = [0.25 + 0.5 * rng.unit(), 0.25 * rng.uniform(-1.0, 1.0), 0.25 * rng.uniform(-1.0, 1.0)];
        let truth = query::penetration(plain.at(Pose::IDENTITY).unwrap(), plain.at(pose(&place)).unwrap());
        let truth = truth.expect("they overlap");
        let depth = ask(&mesh, &mesh, &place);
        assert!(depth.lower <= truth.upper && truth.lower <= depth.upper, "{depth:?} {truth:?}");
        assert!(depth.upper <= truth.upper * (1.0 + 1e-6) + 1e-6, "{depth:?} {truth:?}");
    }
}

/// Cubes whose walls are in line, which touch in corners and edges: as deep from below as from above.
#[test]
fn depths_of_cubes_in_line_are_known_to_the_last_digits() {
    let mesh = engine(&cuboid([0.0; 3], [2.0; 3]));
    // In one place, the middle of the numbers, nothing says which way out is the other's.
    for number in (0..27).filter(|&number| number != 13) {
        let by = [0, 1, 2].map(|k| f64::from(number / 3_i32.pow(k) % 3 - 1));
        let expected = by.iter().fold(2.0_f64, |least, x| least.min(2.0 - x.abs()));
        let depth = ask(&mesh, &mesh, &Affine { translation: by, ..Affine::IDENTITY });
        assert!(depth.upper < expected + 1e-6 && depth.lower > expected - 1e-6, "{by:?} {depth:?}");
    }
}

/// A peg in a slot that is open above: out by the top, past walls that are nearer.
#[test]
fn pegs_leave_slots_by_their_open_side() {
    let walls = cuboid([-2.0, -2.0, 0.0], [-0.5, 2.0, 1.0]).joined(&cuboid([0.5, -2.0, 0.0], [2.0, 2.0, 1.0]));
    let slot = engine(&walls.joined(&cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, -0.0625])));
    let peg = engine(&cuboid([-0.375, -1.0, -0.125], [0.375, 1.0, 2.0]));
    let depth = ask(&slot, &peg, &Affine::IDENTITY);
    assert!((depth.upper - 0.0625).abs() < 1e-6 && depth.normal[2] > 1.0 - 1e-9, "{depth:?}");
}

fn turned_inside_out(mut mesh: Plain) -> Plain {
    mesh.faces.iter_mut().for_each(|face| face.reverse());
    mesh
}

#[test]
fn meshes_apart_have_no_depth_and_touching_ones_none_but_zero() {
    let mesh = engine(&cuboid([0.0; 3], [1.0; 3]));
    assert!(query::penetration(&mesh, mesh.at(at([1.0_f64.next_up(), 0.0, 0.0]))).is_none());
    let touching = query::penetration(&mesh, mesh.at(at([1.0, 0.0, 0.0]))).expect("they touch");
    assert!(touching.lower == 0.0 && touching.upper == 0.0 && touching.normal[0] > 0.5, "{touching:?}");
    let hollow = engine(&cuboid([-1.0; 3], [2.0; 3]).joined(&turned_inside_out(cuboid([0.0; 3], [1.0; 3]))));
    let inside = query::penetration(&hollow, &mesh).expect("they touch all around");
    assert_eq!((inside.lower, inside.upper), (0.0, 0.0));
}

/// The distance of solids is zero exactly where they meet as such.
#[test]
fn distances_of_solids_are_zero_inside() {
    let (large, small) = (engine(&icosphere(2)), engine(&cuboid([-0.1; 3], [0.1; 3])));
    let sides = [(NEITHER, false), (A, true), (B, false), (BOTH, true)];
    for (solid, holds) in sides {
        let nested = query::distance(taken(&large, solid[0]), taken(&small, solid[1]));
        assert_eq!(nested.upper == 0.0, holds);
        assert_eq!(query::intersects(taken(&large, solid[0]), taken(&small, solid[1])), holds);
        assert_eq!(nested.witness.is_none(), holds);
        let apart = small.at(at([3.0, 0.0, 0.0]));
        assert_eq!(query::distance(taken(&large, solid[0]), taken(apart, solid[1])), query::distance(&large, apart));
        let through = small.at(at([1.0, 0.0, 0.0]));
        assert!(query::distance(taken(&large, solid[0]), taken(through, solid[1])).witness.is_some());
        // Whatever was nearest last.
        let mut cache = Cache::default();
        for there in [(&small).into(), apart, through, (&small).into()] {
            let found = Query::new().with_cache(&mut cache).distance(taken(&large, solid[0]), taken(there, solid[1]));
            assert_eq!(found, query::distance(taken(&large, solid[0]), taken(there, solid[1])));
            for clearance in [0.0, 0.5, 2.0] {
                let near = Query::new().with_cache(&mut cache).within(
                    taken(&large, solid[0]),
                    taken(there, solid[1]),
                    clearance,
                );
                assert_eq!(near, query::within(taken(&large, solid[0]), taken(there, solid[1]), clearance));
                assert_eq!(near, found.upper <= clearance, "{found:?} {clearance}");
            }
        }
        assert!(!query::within(taken(&large, solid[0]), taken(&small, solid[1]), f64::NAN));
        assert!(!query::within(taken(&large, solid[0]), taken(&small, solid[1]), -0.5));
    }
}

/// Cubes that hardly overlap: the upper end is no farther above the depth than rounding explains.
#[test]
fn shallow_depths_are_told_tightly() {
    let mesh = engine(&cuboid([-0.5; 3], [0.5; 3]));
    for exponent in [-20, -30, -40, -45] {
        let deep = 2.0_f64.powi(exponent);
        for place in [[1.0 - deep, 0.0, 0.0], [0.25, 1.0 - deep, -0.125], [0.0, 0.5, deep - 1.0]] {
            let found = query::penetration(&mesh, mesh.at(at(place))).expect("they meet");
            assert!(found.upper >= deep && found.upper <= deep + 1e-13, "2^{exponent}: {found:?}");
        }
    }
}
