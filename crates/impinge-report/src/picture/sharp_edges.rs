//! Edges of a mesh at which its surface has a visible crease or ends.

use std::collections::HashMap;

use impinge::Mesh;

use super::vector::{Vector, cross, dot, length, minus};

/// Cosine of the smallest angle between the normals of two faces whose edge is sharp: 30 degrees.
/// A smaller angle makes the facets of tessellated cylinders visible.
const SHARP: f64 = 0.866;

/// Returns the sharp edges of a mesh, in the mesh frame. Edges are equal if their ends are, even if
/// their vertices have different indices. They come in the order of the faces.
pub(super) fn sharp_edges(mesh: &Mesh) -> Vec<[Vector; 2]> {
    /// The sides of an edge: the normal of the first face, and whether the edge is sharp.
    struct Sides {
        first: Vector,
        is_sharp: bool,
        faces: usize,
    }
    let mut places: HashMap<[u64; 6], usize> = HashMap::new();
    let mut found: Vec<([Vector; 2], Sides)> = Vec::new();
    for face in 0..mesh.faces().len() as u32 {
        let corners = mesh.corners(face);
        let normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
        let size = length(normal);
        if size == 0.0 {
            continue;
        }
        let normal = normal.map(|x| x / size);
        for k in 0..3 {
            let mut ends = [corners[k], corners[(k + 1) % 3]];
            // An edge has one key from both sides.
            if key(ends[1]) < key(ends[0]) {
                ends.reverse();
            }
            let [[a, b, c], [d, e, f]] = ends.map(key);
            let place = *places.entry([a, b, c, d, e, f]).or_insert(found.len());
            if place == found.len() {
                found.push((ends, Sides { first: normal, is_sharp: false, faces: 1 }));
            } else {
                let sides = &mut found[place].1;
                sides.faces += 1;
                sides.is_sharp |= dot(sides.first, normal) < SHARP;
            }
        }
    }
    let is_drawn = |sides: &Sides| sides.faces != 2 || sides.is_sharp;
    found.into_iter().filter(|(_, sides)| is_drawn(sides)).map(|(ends, _)| ends).collect()
}

/// Returns the bits of a point. Both zeros have the same.
fn key(point: Vector) -> [u64; 3] {
    point.map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use impinge::{Positions, Shape};

    use super::*;

    #[test]
    fn a_cuboid_has_twelve_sharp_edges_and_no_diagonals() {
        let cuboid = &Shape::cuboid([1.0, 2.0, 3.0]).unwrap().to_meshes(8)[0].0;
        // Each triangle has vertices of its own.
        let triangles: Vec<[Vector; 3]> = (0..12).map(|face| cuboid.corners(face)).collect();
        let faces: Vec<[u32; 3]> = (0..12).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        let mesh = Mesh::new(Positions::F64(triangles.as_flattened().to_vec()), faces).unwrap();
        let edges = sharp_edges(&mesh);
        assert_eq!(edges.len(), 12);
        assert!(edges.iter().all(|[a, b]| (0..3).filter(|&k| a[k] != b[k]).count() == 1));
    }

    #[test]
    fn the_border_of_a_surface_is_sharp() {
        let mesh = Mesh::new(Positions::F64(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), vec![[0, 1, 2]]);
        assert_eq!(sharp_edges(&mesh.unwrap()).len(), 3);
    }
}
