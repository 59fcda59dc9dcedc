//! Solids that are their convex hull, and solids that are not, by one coordinate.

use impinge::hull::Hull;
use impinge::{Mesh, Positions};
use impinge_testkit::generate::Rng;

/// Returns a box of quads, each divided along a random diagonal, with its corners.
fn cuboid(rng: &mut Rng) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let low = [0; 3].map(|_: i32| rng.integer(-4, 4) as f64);
    let extent = [0; 3].map(|_: i32| rng.integer(1, 4) as f64 / 4.0);
    let corner = |i: u32| std::array::from_fn(|k| low[k] + if i >> (2 - k) & 1 == 1 { extent[k] } else { 0.0 });
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let mut divided = |[a, b, c, d]: [u32; 4]| {
        if rng.one_in(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    let faces = quads.into_iter().flat_map(&mut divided).collect();
    ((0..8).map(corner).collect(), faces)
}

/// Returns whether a mesh is the hull of the corners of its faces.
fn is_convex(corners: &[[f64; 3]], faces: &[[u32; 3]]) -> bool {
    let mesh = Mesh::new(Positions::F64(corners.to_vec()), faces.to_vec()).unwrap();
    let all: Vec<[f64; 3]> = (0..faces.len() as u32).flat_map(|face| mesh.corners(face)).collect();
    mesh.is_hull(&Hull::new(&all).unwrap())
}

#[test]
fn boxes_are_convex_until_a_corner_moves_inwards() {
    let mut rng = Rng::new(3);
    for _ in 0..100 {
        let (corners, faces) = cuboid(&mut rng);
        assert!(is_convex(&corners, &faces));
        let mut reversed = faces.clone();
        reversed.iter_mut().for_each(|face| face.reverse());
        assert!(is_convex(&corners, &reversed), "an inside-out mesh has the same inside");
        assert!(!is_convex(&corners, &faces[1..]), "an open mesh has no inside of its own");
        let mut doubled = faces.clone();
        doubled.extend(&reversed);
        assert!(!is_convex(&corners, &doubled), "two opposite surfaces enclose nothing");
    }
}

#[test]
fn one_bit_makes_a_mesh_concave() {
    // A box whose top has a middle vertex: flat, raised or lowered by one bit.
    let mut corners: Vec<[f64; 3]> = (0..8).map(|i| [i >> 2 & 1, i >> 1 & 1, i & 1].map(f64::from)).collect();
    let mut faces = vec![[0, 3, 1], [0, 2, 3], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 7, 3], [2, 6, 7]];
    faces.extend([[0, 4, 6], [0, 6, 2]]);
    faces.extend([[1, 3, 8], [3, 7, 8], [7, 5, 8], [5, 1, 8]]);
    for (height, expected) in [(1.0, true), (1.0_f64.next_up(), true), (1.0_f64.next_down(), false)] {
        corners.truncate(8);
        corners.push([0.5, 0.5, height]);
        assert_eq!(is_convex(&corners, &faces), expected, "{height}");
    }
}

#[test]
fn hulls_of_random_points_are_convex() {
    let mut rng = Rng::new(9);
    let mut concave = 0;
    for round in 0..60 {
        // Points on a grid have facets with many corners.
        let mut coordinate = || if round % 2 == 0 { rng.integer(-3, 3) as f64 } else { rng.uniform(-1.0, 1.0) };
        let points: Vec<[f64; 3]> = (0..30).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
        let hull = Hull::new(&points).unwrap();
        assert!(is_convex(hull.positions(), hull.faces()));
        let mut dented = hull.positions().to_vec();
        dented[0] = dented[0].map(|x| x / 1024.0);
        concave += usize::from(!is_convex(&dented, hull.faces()));
    }
    assert!(concave > 40, "{concave}");
}
