//! The defects of a mesh. None of them changes an answer about its surface.

use rayon::prelude::*;

use crate::exact::Corners;
use crate::math::Sign;
use crate::math::dyadic::{self, Dyadic};
use crate::mesh::{Mesh, Positions};

/// Counts of the defects of a mesh, all exact.
///
/// The counts describe the surface, so vertices with equal coordinates count as one point, whatever
/// their indices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Number of faces without area: segments and points.
    pub degenerate_faces: usize,
    /// Number of faces with the same three points as an earlier face, in any order.
    pub duplicate_faces: usize,
    /// Number of vertices at the same point as an earlier vertex.
    pub duplicate_vertices: usize,
    /// Number of vertices that no face uses.
    pub unused_vertices: usize,
    /// Number of edges that exactly one face has. An edge joins two different points.
    pub open_edges: usize,
    /// Number of edges that more than two faces have.
    pub non_manifold_edges: usize,
    /// Number of edges that two faces have, both in the same direction: one of the faces is inside
    /// out.
    pub misoriented_edges: usize,
    /// Number of connected components. Faces are connected if they have corners at the same point.
    pub components: usize,
    /// Number of vertex coordinates that single precision cannot represent exactly.
    pub double_coordinates: usize,
}

impl Health {
    /// Reports whether each edge has two faces that agree on their orientation. Returns `true` for
    /// a mesh without faces. A mesh may be [closed](Mesh::is_closed) and still not be a manifold,
    /// for example two cubes that share an edge.
    #[must_use]
    pub fn is_manifold(&self) -> bool {
        self.open_edges + self.non_manifold_edges + self.misoriented_edges == 0
    }
}

impl Mesh {
    /// Reports whether a face has no area, exactly.
    pub(crate) fn is_degenerate(&self, face: u32) -> bool {
        is_degenerate(&self.corners(face))
    }

    /// Checks the mesh for every defect in [`Health`].
    ///
    /// ```
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    /// let health = Mesh::new(Positions::F32(corners), vec![[0, 1, 2], [0, 1, 3]])?.health();
    /// assert_eq!((health.degenerate_faces, health.open_edges, health.components), (1, 4, 1));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Complexity
    /// O(n log n), on all cores of the current rayon pool.
    #[must_use]
    pub fn health(&self) -> Health {
        let topology = self.topology();
        let points = &topology.first_at;
        let faces: Vec<[u32; 3]> = self.faces().par_iter().map(|face| face.map(|v| points[v as usize])).collect();
        let mut health = Health {
            degenerate_faces: degenerate_faces(self).len(),
            duplicate_faces: duplicate_faces(self).len(),
            duplicate_vertices: points.iter().zip(0..).filter(|&(&point, vertex)| point != vertex).count(),
            unused_vertices: unused(self.faces(), points.len()),
            components: topology.components.first_faces.len(),
            double_coordinates: match self.positions() {
                Positions::F32(_) => 0,
                Positions::F64(vertices) => {
                    vertices.as_flattened().par_iter().filter(|&&x| f64::from(x as f32) != x).count()
                }
            },
            ..Health::default()
        };
        count_edges(&faces, &mut health);
        health
    }
}

/// Returns the faces without area, in ascending order.
pub(in crate::mesh) fn degenerate_faces(mesh: &Mesh) -> Vec<u32> {
    (0..mesh.faces().len() as u32).into_par_iter().filter(|&face| is_degenerate(&mesh.corners(face))).collect()
}

/// Reports whether the corners lie on one line, exactly.
fn is_degenerate([a, b, c]: &Corners) -> bool {
    /// Bound for the rounding of differences, products and their difference, relative to the sum of
    /// the products' magnitudes. They lose at most (3 + 16 u) u (Shewchuk 1997, 4.2). This is twice
    /// as much.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    /// Upper bound, with much room, of what products lose if they underflow.
    const UNDERFLOW: f64 = 1e-300;
    let apart = (0..3).any(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let (left, right) = ((b[i] - a[i]) * (c[j] - a[j]), (b[j] - a[j]) * (c[i] - a[i]));
        (left - right).abs() > ROUNDING * (left.abs() + right.abs()) + UNDERFLOW
    });
    if apart {
        return false;
    }
    let from_a = |p: &[f64; 3]| [0, 1, 2].map(|k| &Dyadic::from_f64(p[k]) - &Dyadic::from_f64(a[k]));
    dyadic::cross(&from_a(b), &from_a(c)).iter().all(|x| x.sign() == Sign::Zero)
}

/// Returns the faces with the same three points as an earlier face, in any order. The result is in
/// ascending order.
pub(in crate::mesh) fn duplicate_faces(mesh: &Mesh) -> Vec<u32> {
    let points = &mesh.topology().first_at;
    let named = mesh.faces().par_iter().zip(0_u32..mesh.faces().len() as u32).map(|(face, number)| {
        let mut corners = face.map(|vertex| points[vertex as usize]);
        corners.sort_unstable();
        (corners, number)
    });
    let mut sorted: Vec<([u32; 3], u32)> = named.collect();
    sorted.par_sort_unstable();
    let mut later: Vec<u32> = sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1).collect();
    later.sort_unstable();
    later
}

/// Returns the number of vertices that no face uses.
fn unused(faces: &[[u32; 3]], vertices: usize) -> usize {
    let mut used = vec![false; vertices];
    faces.as_flattened().iter().for_each(|&vertex| used[vertex as usize] = true);
    used.iter().filter(|&&used| !used).count()
}

/// Counts open, misoriented and non-manifold edges.
fn count_edges(faces: &[[u32; 3]], health: &mut Health) {
    // Each edge from its lesser point to its greater, and whether the face runs along it the other
    // way.
    let mut edges: Vec<([u32; 2], bool)> = faces
        .par_iter()
        .flat_map_iter(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .filter(|[from, to]| from != to)
        .map(|[from, to]| ([from.min(to), from.max(to)], from > to))
        .collect();
    edges.par_sort_unstable();
    for faces in edges.chunk_by(|a, b| a.0 == b.0) {
        match faces {
            [_] => health.open_edges += 1,
            [one, other] => health.misoriented_edges += usize::from(one.1 == other.1),
            _ => health.non_manifold_edges += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn health(vertices: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Health {
        Mesh::new(Positions::F64(vertices), faces).expect("a valid mesh").health()
    }

    #[test]
    fn a_sound_solid_is_a_manifold() {
        let cube = impinge_testkit::generate::solids::cuboid([0.0; 3], [1.0, 2.0, 3.0]);
        let found = health(cube.vertices, cube.faces);
        assert_eq!(found, Health { components: 1, ..Health::default() });
        assert!(found.is_manifold());
    }

    #[test]
    fn every_fault_is_counted() {
        let third = 1.0 / 3.0;
        let vertices = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, 0.0], // the same point as vertex 0
            [2.0, 0.0, 0.0],
            [third, 5.0, 5.0], // in no face
            [7.0, 7.0, 7.0],
            [8.0, 7.0, 7.0],
            [7.0, 8.0, 7.0],
        ];
        let faces = vec![
            [0, 1, 2],
            [2, 3, 1], // the same points
            [0, 1, 4], // a segment through 1
            [6, 7, 8],
            [6, 6, 6],
        ];
        let found = health(vertices, faces);
        let expected = Health {
            degenerate_faces: 2,
            duplicate_faces: 1,
            duplicate_vertices: 1,
            unused_vertices: 1,
            open_edges: 5,         // 1-4, 4-0 and the three of 6, 7, 8
            non_manifold_edges: 1, // 0-1
            misoriented_edges: 2,  // 1-2 and 2-0, along which both duplicates run the same way
            components: 2,
            double_coordinates: 1,
        };
        assert_eq!(found, expected);
        assert!(!found.is_manifold());
    }

    #[test]
    fn faces_without_area_differ_from_tiny_faces() {
        let (tiny, one) = (5e-324, 1.0_f64);
        let cases: [(Corners, bool); 6] = [
            ([[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0]], true),
            ([[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0_f64.next_up()]], false),
            ([[0.0; 3], [tiny, 0.0, 0.0], [0.0, tiny, 0.0]], false),
            ([[0.0; 3], [tiny, 0.0, 0.0], [2.0 * tiny, 0.0, 0.0]], true),
            ([[one, one, one], [one.next_up(), one, one], [one.next_up(), one.next_up(), one]], false),
            ([[1e38, 0.0, 0.0], [-1e38, 0.0, tiny], [0.0, 0.0, 0.0]], false),
        ];
        for (corners, expected) in cases {
            assert_eq!(is_degenerate(&corners), expected, "{corners:?}");
        }
    }
}
