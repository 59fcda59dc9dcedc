//! Connectivity of a mesh: vertices at one position, the border of the mesh, and its connected
//! components. Positions decide, not indices, because many formats repeat a vertex for each of its
//! faces.

use std::sync::OnceLock;

use rayon::prelude::*;

use crate::mesh::storage::positions::Positions;

/// The connectivity of the faces of a mesh.
#[derive(Debug)]
pub(crate) struct Topology {
    /// For each vertex the first vertex at its position.
    pub(crate) first_at: Vec<u32>,
    /// Edges that the faces run along more often one way than the other. Empty if the mesh is
    /// closed.
    pub(crate) border: Vec<BorderEdge>,
    /// The sets of faces that are connected by shared vertices.
    pub(crate) components: Components,
    /// The faces at each vertex, computed when a query first needs them.
    faces_at: OnceLock<FacesAt>,
    /// The other face at each edge of each face, computed when a query first needs them.
    across: OnceLock<Vec<[Across; 3]>>,
}

/// The surface across an edge of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Across {
    /// No face: the edge is on the border of the surface.
    Nothing,
    /// One face.
    Face(FaceAcross),
    /// Several faces.
    Several,
}

/// The one other face at an edge of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FaceAcross {
    pub(crate) face: u32,
    /// Number of its corner that is not on the edge.
    pub(crate) opposite: u8,
    /// Whether its corners pass along the edge in the same direction as those of the first face.
    pub(crate) runs_along: bool,
}

/// A partition of faces into parts, which are numbered in the order of their first faces.
#[derive(Debug)]
pub(crate) struct Components {
    /// For each face the number of its part, or [`NONE`](Self::NONE) if it is in no part.
    pub(crate) of_face: Vec<u32>,
    /// The first face of each part.
    pub(crate) first_faces: Vec<u32>,
}

/// The faces at each vertex that is the first one at its position.
#[derive(Debug)]
struct FacesAt {
    /// End of each vertex's faces in the list. They start at the end of the previous vertex's
    /// faces.
    ends: Vec<usize>,
    faces: Vec<u32>,
}

/// An edge between two vertices, each the first one at its position. `times` is the number of faces
/// that run from `from` to `to`, less the number of faces that run back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BorderEdge {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) times: i32,
}

impl Topology {
    /// Computes the connectivity of faces between vertices at these positions.
    ///
    /// # Complexity
    /// O(n log n), by sorting.
    pub(crate) fn of(positions: &Positions, faces: &[[u32; 3]]) -> Self {
        let first_at = first_at_position(positions);
        let border = border_of(faces.par_iter().map(|face| face.map(|vertex| first_at[vertex as usize])));
        let mut sets = DisjointSets::new(first_at.len());
        for face in faces {
            let [a, b, c] = face.map(|vertex| first_at[vertex as usize]);
            sets.join(a, b);
            sets.join(a, c);
        }
        let roots = faces.iter().map(|corners| Some(sets.root(first_at[corners[0] as usize])));
        let components = Components::numbered(first_at.len(), roots);
        Self { first_at, border, components, faces_at: OnceLock::new(), across: OnceLock::new() }
    }

    /// Returns the faces at a vertex in ascending order. The vertex must be the first one at its
    /// position. A face that has the vertex twice occurs twice. `faces` must be the faces from
    /// which this connectivity was computed.
    ///
    /// # Complexity
    /// O(n) the first time, then constant.
    pub(in crate::mesh) fn faces_at(&self, faces: &[[u32; 3]], vertex: u32) -> &[u32] {
        let FacesAt { ends, faces } = self.faces_at.get_or_init(|| FacesAt::of(&self.first_at, faces));
        let start = if vertex == 0 { 0 } else { ends[vertex as usize - 1] };
        &faces[start..ends[vertex as usize]]
    }

    /// Returns what lies across the edges of each face. Edge k runs from corner k to the next.
    /// `faces` must be the faces from which this connectivity was computed.
    ///
    /// # Complexity
    /// O(n log n) the first time, by sorting, then constant.
    pub(in crate::mesh) fn across(&self, faces: &[[u32; 3]]) -> &[[Across; 3]] {
        self.across.get_or_init(|| across_of(&self.first_at, faces))
    }

    /// Returns the border of some faces, given by their vertex indices. Its vertices are those of
    /// [`first_at`](Self::first_at).
    pub(crate) fn border_of(&self, faces: impl Iterator<Item = [u32; 3]>) -> Vec<BorderEdge> {
        let named: Vec<[u32; 3]> = faces.map(|face| face.map(|vertex| self.first_at[vertex as usize])).collect();
        border_of(named.into_par_iter())
    }
}

impl Components {
    /// Number that stands for no part.
    pub(crate) const NONE: u32 = u32::MAX;

    /// Returns the sets of faces that have equal roots. All roots must be below `len`. A face
    /// without a root is in no part.
    pub(in crate::mesh) fn numbered(len: usize, roots: impl Iterator<Item = Option<u32>>) -> Self {
        let mut number_of = vec![Self::NONE; len];
        let mut first_faces = Vec::new();
        let of_face = (0_u32..)
            .zip(roots)
            .map(|(face, root)| {
                let Some(root) = root else { return Self::NONE };
                let number = &mut number_of[root as usize];
                if *number == Self::NONE {
                    *number = first_faces.len() as u32;
                    first_faces.push(face);
                }
                *number
            })
            .collect();
        Self { of_face, first_faces }
    }
}

impl FacesAt {
    fn of(first_at: &[u32], faces: &[[u32; 3]]) -> Self {
        let corners = || faces.iter().map(|face| face.map(|vertex| first_at[vertex as usize] as usize));
        let mut ends = vec![0_usize; first_at.len()];
        corners().flatten().for_each(|vertex| ends[vertex] += 1);
        // The start of each list. Filling the list moves it to the end.
        let mut start = 0;
        for end in &mut ends {
            (start, *end) = (start + *end, start);
        }
        let mut listed = vec![0; 3 * faces.len()];
        for (face, corners) in (0..).zip(corners()) {
            for vertex in corners {
                listed[ends[vertex]] = face;
                ends[vertex] += 1;
            }
        }
        Self { ends, faces: listed }
    }
}

/// Returns what lies across the edges of each face.
fn across_of(first_at: &[u32], faces: &[[u32; 3]]) -> Vec<[Across; 3]> {
    // Both ends in one number, the smaller first, then the face and the number of its edge.
    let mut edges: Vec<(u64, u32, u8)> = (0..faces.len() as u32)
        .into_par_iter()
        .flat_map_iter(|face| {
            let corners = faces[face as usize].map(|vertex| u64::from(first_at[vertex as usize]));
            [0_u8, 1, 2].map(|edge| {
                let (from, to) = (corners[usize::from(edge)], corners[(usize::from(edge) + 1) % 3]);
                (from.min(to) << 32 | from.max(to), face, edge)
            })
        })
        .collect();
    edges.par_sort_unstable();
    let mut across = vec![[Across::Nothing; 3]; faces.len()];
    for run in edges.chunk_by(|one, other| one.0 == other.0) {
        for &(_, face, edge) in run {
            across[face as usize][usize::from(edge)] = match run {
                [_] => Across::Nothing,
                [one, other] => {
                    let other = if one.1 == face { other.1 } else { one.1 };
                    Across::Face(FaceAcross::new(first_at, faces, (face, edge), other))
                }
                _ => Across::Several,
            };
        }
    }
    across
}

impl FaceAcross {
    /// Describes the other face at an edge of a face.
    fn new(first_at: &[u32], faces: &[[u32; 3]], (face, edge): (u32, u8), other: u32) -> Self {
        let corners = |face: u32| faces[face as usize].map(|vertex| first_at[vertex as usize]);
        let (own, there, edge) = (corners(face), corners(other), usize::from(edge));
        let (from, to) = (own[edge], own[(edge + 1) % 3]);
        let runs_along = (0..3).any(|at| there[at] == from && there[(at + 1) % 3] == to);
        let opposite = (0..3_u8).find(|&at| ![from, to].contains(&there[usize::from(at)])).unwrap_or(0);
        Self { face: other, opposite, runs_along }
    }
}

/// Returns the edges that the faces run along more often one way than the other, with the
/// difference.
fn border_of(faces: impl ParallelIterator<Item = [u32; 3]>) -> Vec<BorderEdge> {
    // Both ends in one number, the smaller first, and whether the face runs from the smaller to the
    // larger.
    let mut edges: Vec<(u64, bool)> = faces
        .flat_map_iter(|[a, b, c]| [[a, b], [b, c], [c, a]])
        .filter(|[from, to]| from != to)
        .map(|[from, to]| (u64::from(from.min(to)) << 32 | u64::from(from.max(to)), from < to))
        .collect();
    edges.par_sort_unstable();
    let net = |run: &[(u64, bool)]| {
        let times: i32 = run.iter().map(|&(_, forward)| if forward { 1 } else { -1 }).sum();
        let (low, high) = ((run[0].0 >> 32) as u32, run[0].0 as u32);
        (times != 0).then_some(BorderEdge { from: low, to: high, times })
    };
    edges.chunk_by(|x, y| x.0 == y.0).filter_map(net).collect()
}

/// Returns for each vertex the first vertex with equal coordinates. Zeros of either sign are equal.
fn first_at_position(positions: &Positions) -> Vec<u32> {
    match positions {
        // Adding zero turns negative zero into positive zero.
        Positions::F32(vertices) => first_equal(vertices, |v| v.map(|x| (x + 0.0).to_bits())),
        Positions::F64(vertices) => first_equal(vertices, |v| v.map(|x| (x + 0.0).to_bits())),
    }
}

/// Returns for each vertex the first vertex with an equal key.
fn first_equal<V: Sync, K: Ord + Copy + Send>(vertices: &[V], key: impl Fn(&V) -> K + Sync + Send) -> Vec<u32> {
    let mut sorted: Vec<(K, u32)> =
        vertices.par_iter().enumerate().map(|(number, vertex)| (key(vertex), number as u32)).collect();
    sorted.par_sort_unstable();
    let mut first = vec![0; vertices.len()];
    for run in sorted.chunk_by(|x, y| x.0 == y.0) {
        for &(_, vertex) in run {
            first[vertex as usize] = run[0].1;
        }
    }
    first
}

/// Disjoint sets, by union by index with path halving (Tarjan and van Leeuwen, *Worst-case Analysis
/// of Set Union Algorithms*, JACM 31(2), 1984). The root of a set is its least member, so it does
/// not depend on the order of joins.
pub(crate) struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Creates `len` sets of one member each.
    pub(crate) fn new(len: usize) -> Self {
        Self((0..len as u32).collect())
    }

    /// Returns the root of a member's set.
    pub(crate) fn root(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            let above = self.0[member as usize];
            self.0[member as usize] = self.0[above as usize];
            member = above;
        }
        member
    }

    /// Joins the sets of two members.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    fn topology(vertices: &[[f32; 3]], faces: &[[u32; 3]]) -> Topology {
        Topology::of(&Positions::F32(vertices.to_vec()), faces)
    }

    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn a_soup_is_closed_if_its_positions_close_it() {
        let welded = topology(&CORNERS, &FACES);
        assert!(welded.border.is_empty());
        // Each face has its own vertices, and one of them has a negative zero.
        let mut vertices: Vec<[f32; 3]> = FACES.iter().flatten().map(|&vertex| CORNERS[vertex as usize]).collect();
        vertices[0][1] = -0.0;
        let soup: Vec<[u32; 3]> = (0..4).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        let soup = topology(&vertices, &soup);
        assert!(soup.border.is_empty());
        assert_eq!((soup.components.first_faces.len(), soup.first_at[3]), (1, 0));
    }

    #[test]
    fn the_border_counts_faces_with_their_direction() {
        let open = topology(&CORNERS, &FACES[..3]);
        let edge = |from, to, times| BorderEdge { from, to, times };
        assert_eq!(open.border, [edge(1, 2, -1), edge(1, 3, 1), edge(2, 3, -1)]);
        let twice = topology(&CORNERS, &[FACES[0], FACES[0]]);
        assert_eq!(twice.border, [edge(0, 1, -2), edge(0, 2, 2), edge(1, 2, -2)]);
        let both_ways = topology(&CORNERS, &[[0, 1, 2], [0, 2, 1], [3, 3, 1]]);
        assert_eq!(both_ways.border, []);
    }

    /// Faces over few vertices share many edges, and some have a vertex twice.
    #[test]
    fn the_face_across_an_edge_is_that_of_a_loop_over_all() {
        let mut rng = Rng::new(48);
        let (mut one, mut along, mut several) = (0, 0, 0);
        for _ in 0..200 {
            let faces: Vec<[u32; 3]> = (0..8).map(|_| [0; 3].map(|_| rng.integer(0, 5) as u32)).collect();
            let vertices: Vec<[f32; 3]> = (0..6_u8).map(|at| [f32::from(at), 0.0, 0.0]).collect();
            let topology = topology(&vertices, &faces);
            let edge = |face: u32, edge: usize| [faces[face as usize][edge], faces[face as usize][(edge + 1) % 3]];
            for (face, edges) in (0..).zip(topology.across(&faces)) {
                for (number, across) in edges.iter().enumerate() {
                    let [from, to] = edge(face, number);
                    let all = (0..8).flat_map(|other| [0, 1, 2].map(|other_edge| (other, edge(other, other_edge))));
                    let same: Vec<_> = all.filter(|(_, edge)| *edge == [from, to] || *edge == [to, from]).collect();
                    let Across::Face(FaceAcross { face: other, opposite, runs_along }) = *across else {
                        assert_eq!(*across == Across::Several, same.len() > 2);
                        several += u32::from(same.len() > 2);
                        continue;
                    };
                    let corners = faces[other as usize];
                    // A face with a vertex twice may have the edge twice.
                    let [first, second] = [same[0].0, same[1].0];
                    assert!(same.len() == 2 && other == if first == face { second } else { first });
                    assert_eq!(runs_along, (0..3).any(|at| edge(other, at) == [from, to]));
                    let is_third = ![from, to].contains(&corners[usize::from(opposite)]);
                    assert_eq!(is_third, corners.iter().any(|corner| ![from, to].contains(corner)));
                    one += 1;
                    along += u32::from(runs_along);
                }
            }
        }
        assert!(one > 500 && along > 100 && several > 500, "{one} {along} {several}");
    }

    #[test]
    fn components_are_numbered_by_their_first_faces() {
        let vertices: Vec<[f32; 3]> = CORNERS.iter().flat_map(|&[x, y, z]| [[x, y, z], [x + 5.0, y, z]]).collect();
        let faces: Vec<[u32; 3]> =
            FACES.iter().flat_map(|face| [face.map(|v| 2 * v + 1), face.map(|v| 2 * v)]).collect();
        let two = topology(&vertices, &faces);
        assert_eq!(two.components.first_faces, [0, 1]);
        assert_eq!(two.components.of_face, [0, 1, 0, 1, 0, 1, 0, 1]);
    }
}
