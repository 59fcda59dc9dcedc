//! Properties of the surface of every hull, checked with integers or rationals.

use std::collections::HashMap;

use impinge::hull::{Hull, HullKind};

/// Checks faces and neighbors of a hull: the surface must be closed, and every point must be inside
/// or on it.
///
/// `side(face corners, point)` must return the exact sign of a volume.
pub(crate) fn check(hull: &Hull, points: impl Iterator<Item = [f64; 3]>, side: impl Fn([[f64; 3]; 4]) -> i32) {
    let positions = hull.positions();
    let at = |vertex: u32| positions[vertex as usize];
    let corners: Vec<[[f64; 3]; 3]> = hull.faces().iter().map(|face| face.map(at)).collect();
    // Every directed edge must occur once, and its opposite too.
    let mut faces_at = HashMap::new();
    for (number, face) in hull.faces().iter().enumerate() {
        for edge in 0..3 {
            let before = faces_at.insert((face[edge], face[(edge + 1) % 3]), number);
            assert!(before.is_none(), "an edge has two faces on one side");
        }
    }
    assert!(
        faces_at.keys().all(|&(from, to)| faces_at.contains_key(&(to, from))),
        "an edge has a face on one side only"
    );
    match hull.kind() {
        HullKind::Point => assert!(positions.len() == 1 && corners.is_empty() && hull.neighbors(0).is_empty()),
        HullKind::Segment => {
            assert!(positions.len() == 2 && corners.is_empty());
            assert!(hull.neighbors(0) == [1] && hull.neighbors(1) == [0]);
        }
        HullKind::Polygon | HullKind::Solid => {
            let edges = faces_at.len() / 2;
            assert_eq!(positions.len() + corners.len(), edges + 2, "not a sphere");
        }
    }
    // An edge of triangles is an edge of the hull unless the two faces at it lie in one plane with
    // their third corners on opposite sides. The two sides of a polygon lie in one plane with their
    // corners on the same side.
    let mut neighbors = vec![Vec::new(); positions.len()];
    for (&(from, to), &face) in &faces_at {
        let opposite = faces_at[&(to, from)];
        let third = |face: usize| hull.faces()[face].into_iter().find(|&corner| corner != from && corner != to);
        let (near, far) = (third(face).expect("three corners"), third(opposite).expect("three corners"));
        let is_edge = match hull.kind() {
            HullKind::Solid => side([at(from), at(to), at(near), at(far)]) != 0,
            _ => {
                let side = |number: usize| number_of_side(hull, number);
                side(face) != side(opposite)
            }
        };
        if is_edge {
            neighbors[from as usize].push(to);
        }
    }
    if hull.kind() >= HullKind::Polygon {
        for (vertex, expected) in neighbors.iter_mut().enumerate() {
            expected.sort_unstable();
            assert_eq!(hull.neighbors(vertex as u32), expected, "neighbors of {vertex}");
        }
    }
    for point in points {
        for &[p, q, r] in &corners {
            assert!(side([p, q, r, point]) <= 0, "{point:?} is outside of {:?}", [p, q, r]);
        }
    }
}

/// Reports whether a triangle of a polygon is on the same side as face 0, by the direction of its
/// normal.
fn number_of_side(hull: &Hull, face: usize) -> bool {
    let normal = |face: usize| {
        let [p, q, r] = hull.faces()[face].map(|corner| hull.positions()[corner as usize]);
        let size = hull.positions().as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let [u, v]: [[f64; 3]; 2] = [q, r].map(|x| std::array::from_fn(|k| (x[k] - p[k]) / size));
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let (first, own) = (normal(0), normal(face));
    (0..3).map(|k| first[k] * own[k]).sum::<f64>() > 0.0
}
