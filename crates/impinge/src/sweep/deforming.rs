//! Surfaces whose vertices move along lines, and all pairs of their features that touch on the way.
//!
//! Triangles that do not touch at the start first touch at a vertex and a face, or at two edges.
//! Two features can touch only if their boxes over the whole motion overlap. Each of these boxes
//! lies in the box of any face that the feature belongs to. So a tree of boxes finds pairs of
//! faces, and each vertex and each edge is tested with only one of its faces.
//!
//! Source: Curtis, Tamstorf, Manocha, *Fast Collision Detection for Deformable Models using
//! Representative-Triangles*, I3D 2008.
//!
//! The proof is docs/notes/proof.md, L25. The tests are in `tests/it/sweep/deforming.rs`.

use std::borrow::Cow;

use rayon::prelude::*;

use super::impact::Impact;
use super::linear::first_contact;
use super::polynomials::Split;
use crate::budget::{Budget, Stopped};
use crate::hierarchy::{Builder, Enclosure, GenericTree};
use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::volume::Aabb;

/// Largest magnitude of a coordinate: 2^126. It keeps the boxes finite in single precision.
const LIMIT: f64 = (1_u128 << 126) as f64;

/// Number of pairs of faces in overlapping leaves between two checks of the budget.
const VISITS_PER_STEP: usize = 1 << 14;

/// Number of pairs of faces whose features are tested between two checks of the budget.
const PAIRS_PER_STEP: usize = 32;

/// Triangles whose vertices move along lines at constant speed, from one array of positions to
/// another, all in one frame.
#[derive(Debug)]
pub struct Deforming<'m> {
    faces: Cow<'m, [[u32; 3]]>,
    t0: Cow<'m, [[f64; 3]]>,
    t1: Cow<'m, [[f64; 3]]>,
    /// Vertices (bits 0 to 2) and edges (bits 3 to 5) that each face represents. Each feature is
    /// represented by its first face.
    represents: Vec<u8>,
    /// The faces' boxes over the whole motion.
    boxes: Vec<Aabb>,
    /// Tree over `boxes`.
    tree: GenericTree<Aabb, 8>,
}

/// Two features that touch. A face or a vertex is given by its row in the input. An edge is given
/// by the rows of its ends, the lesser first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Features {
    /// A vertex of the first surface and a face of the second.
    VertexFace {
        /// Row of the vertex in the positions.
        vertex: u32,
        /// Row of the face in the faces.
        face: u32,
    },
    /// A face of the first surface and a vertex of the second.
    FaceVertex {
        /// Row of the face in the faces.
        face: u32,
        /// Row of the vertex in the positions.
        vertex: u32,
    },
    /// An edge of the first surface and an edge of the second.
    EdgeEdge {
        /// Edge of the first surface: the rows of its ends, the lesser first.
        edge_a: [u32; 2],
        /// Edge of the second surface: the rows of its ends, the lesser first.
        edge_b: [u32; 2],
    },
}

/// Two features, and the time at which they first touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweptContact {
    /// The features that touch.
    pub features: Features,
    /// The time of first contact, from 0 at the start to 1 at the end. An undecided contact is
    /// listed too.
    pub impact: Impact,
}

impl<'m> Deforming<'m> {
    /// Returns the surface with these faces, after it validates the arrays and builds a tree of
    /// boxes. `t0` and `t1` hold the positions of the vertices at the start and at the end.
    ///
    /// # Errors
    /// - A coordinate is not finite, or above 2^126 in magnitude. The reported row counts the rows
    ///   of `t0`, then those of `t1`.
    /// - An index has no vertex in `t0` or in `t1`.
    /// - There are more vertices or faces than a `u32` can index.
    ///
    /// # Complexity
    /// O(n log n).
    pub fn new(faces: &'m [[u32; 3]], t0: &'m [[f64; 3]], t1: &'m [[f64; 3]]) -> Result<Self, InputError> {
        Self::of(faces.into(), t0.into(), t1.into())
    }

    fn of(faces: Cow<'m, [[u32; 3]]>, t0: Cow<'m, [[f64; 3]]>, t1: Cow<'m, [[f64; 3]]>) -> Result<Self, InputError> {
        validate(&faces, &t0, &t1)?;
        let corners = |face: u32| faces[face as usize].map(|vertex| vertex as usize);
        let swept = |face: u32| corners(face).into_iter().flat_map(|vertex| [t0[vertex], t1[vertex]]);
        let boxes: Vec<Aabb> = (0..faces.len() as u32)
            .into_par_iter()
            .map(|face| {
                let single = |point: [f64; 3]| Aabb::of_points([point.map(|x| x as f32)]);
                swept(face).map(single).fold(Aabb::EMPTY, Aabb::union).next_outward()
            })
            .collect();
        let binary = Builder::Morton.build(&boxes);
        let points_of = |face: u32, points: &mut Vec<[f64; 3]>| points.extend(swept(face));
        let tree = GenericTree::new(&binary, points_of, Enclosure::Layered);
        // Finite points always have a box.
        let tree = tree.ok_or_else(|| InputError::new(InputErrorKind::Empty { what: "points" }))?;
        Ok(Self { represents: represents(&faces), faces, t0, t1, boxes, tree })
    }

    /// Returns every pair of a vertex and a face, or of two edges, of this surface and another one
    /// that touch during the motion. Both surfaces must be in one frame. The pairs are sorted and
    /// unique.
    ///
    /// ```
    /// use impinge::sweep::{Deforming, Features};
    ///
    /// let faces = [[0, 1, 2]];
    /// let ground = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    /// let (above, below) = (
    ///     [[1.0, 1.0, 1.0], [1.0, 9.0, 9.0], [2.0, 9.0, 9.0]],
    ///     [[1.0, 1.0, -1.0], [1.0, 9.0, 9.0], [2.0, 9.0, 9.0]],
    /// );
    /// let ground = Deforming::new(&faces, &ground, &ground)?;
    /// let contacts = Deforming::new(&faces, &above, &below)?.contacts(&ground);
    /// assert!(contacts.iter().any(|contact| contact.features == Features::VertexFace { vertex: 0, face: 0 }));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// The accuracy of [`vertex_face`](super::vertex_face): no contact is missed, and every listed
    /// pair touches unless its impact is undecided.
    ///
    /// # Complexity
    /// Proportional to the number of pairs of faces whose boxes over the whole motion overlap. The
    /// work is done on all cores of the current rayon pool.
    #[must_use]
    pub fn contacts(&self, other: &Deforming<'_>) -> Vec<SweptContact> {
        // Without a limit there is no error.
        self.contacts_within(other, Budget::unlimited()).unwrap_or_default()
    }

    /// Returns the [`contacts`](Self::contacts) with a limit on the work.
    ///
    /// # Errors
    /// Returns the limit of the budget if it was reached, because contacts would be missing.
    pub fn contacts_within(&self, other: &Deforming<'_>, budget: &Budget<'_>) -> Result<Vec<SweptContact>, Stopped> {
        let mut pairs = Pairs::new(budget);
        self.tree.pairs(&other.tree, &Pose::IDENTITY, |a, b| pairs.visit([a, b], [self, other]));
        pairs.contacts(|[a, b], found| {
            for vertex in self.vertices_of(a) {
                let impact = vertex_against(self, vertex, other, b);
                list(found, Features::VertexFace { vertex, face: b }, impact);
            }
            for vertex in other.vertices_of(b) {
                let impact = vertex_against(other, vertex, self, a);
                list(found, Features::FaceVertex { face: a, vertex }, impact);
            }
            for edge_a in self.edges_of(a) {
                for edge_b in other.edges_of(b) {
                    let impact = edges_against(self, edge_a, other, edge_b);
                    list(found, Features::EdgeEdge { edge_a, edge_b }, impact);
                }
            }
        })
    }

    /// Returns every pair of a vertex and a face, or of two edges, of this surface that touch
    /// during the motion and have no vertex in common. The pairs are sorted and unique. Of two
    /// edges, the lesser comes first.
    ///
    /// Accuracy and complexity are those of [`contacts`](Self::contacts).
    #[must_use]
    pub fn self_contacts(&self) -> Vec<SweptContact> {
        self.self_contacts_within(Budget::unlimited()).unwrap_or_default()
    }

    /// Returns the [`self_contacts`](Self::self_contacts) with a limit on the work.
    ///
    /// # Errors
    /// Returns the limit of the budget if it was reached, because contacts would be missing.
    pub fn self_contacts_within(&self, budget: &Budget<'_>) -> Result<Vec<SweptContact>, Stopped> {
        let mut pairs = Pairs::new(budget);
        self.tree.self_pairs(|a, b| pairs.visit([a, b], [self, self]));
        pairs.contacts(|[a, b], found| {
            for (own, face) in [(a, b), (b, a)] {
                for vertex in self.vertices_of(own).filter(|vertex| !self.faces[face as usize].contains(vertex)) {
                    let impact = vertex_against(self, vertex, self, face);
                    list(found, Features::VertexFace { vertex, face }, impact);
                }
            }
            for one in self.edges_of(a) {
                for other in self.edges_of(b).filter(|other| !other.iter().any(|end| one.contains(end))) {
                    let (edge_a, edge_b) = (one.min(other), one.max(other));
                    list(found, Features::EdgeEdge { edge_a, edge_b }, edges_against(self, edge_a, self, edge_b));
                }
            }
        })
    }

    /// Iterates over the vertices that a face represents.
    fn vertices_of(&self, face: u32) -> impl Iterator<Item = u32> {
        let (bits, vertices) = (self.represents[face as usize], self.faces[face as usize]);
        (0..3).filter(move |k| bits >> k & 1 == 1).map(move |k| vertices[k])
    }

    /// Iterates over the edges that a face represents.
    fn edges_of(&self, face: u32) -> impl Iterator<Item = [u32; 2]> {
        let (bits, vertices) = (self.represents[face as usize], self.faces[face as usize]);
        (0..3).filter(move |k| bits >> (3 + k) & 1 == 1).map(move |k| edge(&vertices, k))
    }

    /// Returns a vertex's positions at both ends of the motion.
    fn ends(&self, vertex: u32) -> [[f64; 3]; 2] {
        [self.t0[vertex as usize], self.t1[vertex as usize]]
    }
}

impl Deforming<'static> {
    /// Returns the surface with these faces, as [`new`](Deforming::new) does, and keeps the arrays.
    ///
    /// # Errors
    /// Those of [`new`](Deforming::new).
    pub fn owned(faces: Vec<[u32; 3]>, t0: Vec<[f64; 3]>, t1: Vec<[f64; 3]>) -> Result<Self, InputError> {
        Self::of(faces.into(), t0.into(), t1.into())
    }
}

/// Pairs of faces whose boxes overlap during the motion.
struct Pairs<'b> {
    budget: &'b Budget<'b>,
    found: Vec<[u32; 2]>,
    visited: usize,
    is_spent: bool,
}

impl<'b> Pairs<'b> {
    fn new(budget: &'b Budget<'_>) -> Self {
        Self { budget, found: Vec::new(), visited: 0, is_spent: false }
    }

    /// Adds a pair of leaves' faces if their boxes overlap.
    fn visit(&mut self, [a, b]: [u32; 2], of: [&Deforming<'_>; 2]) {
        self.visited += 1;
        if self.visited.is_multiple_of(VISITS_PER_STEP) {
            self.is_spent |= self.budget.is_spent();
        }
        if !self.is_spent && overlap(&of[0].boxes[a as usize], &of[1].boxes[b as usize]) {
            self.is_spent = !self.budget.reserve(&mut self.found, 1);
            if !self.is_spent {
                self.found.push([a, b]);
            }
        }
    }

    /// Returns the contacts of all pairs, sorted. `list_contacts` lists those of one pair.
    fn contacts(
        self,
        list_contacts: impl Fn([u32; 2], &mut Vec<SweptContact>) + Sync,
    ) -> Result<Vec<SweptContact>, Stopped> {
        let Self { budget, found: pairs, .. } = self;
        budget.check()?;
        let lists = pairs.par_chunks(PAIRS_PER_STEP).map(|chunk| {
            budget.check()?;
            let mut found = Vec::new();
            chunk.iter().for_each(|&pair| list_contacts(pair, &mut found));
            Ok(found)
        });
        let mut found = lists.collect::<Result<Vec<_>, Stopped>>()?.concat();
        found.par_sort_unstable_by_key(|contact| contact.features);
        Ok(found)
    }
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    (0..3).all(|axis| a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])
}

fn vertex_against(of: &Deforming<'_>, vertex: u32, other: &Deforming<'_>, face: u32) -> Impact {
    let [p, q, r] = other.faces[face as usize].map(|corner| other.ends(corner));
    contact([of.ends(vertex), p, q, r], Split::VertexFace)
}

fn edges_against(of: &Deforming<'_>, a: [u32; 2], other: &Deforming<'_>, b: [u32; 2]) -> Impact {
    contact([of.ends(a[0]), of.ends(a[1]), other.ends(b[0]), other.ends(b[1])], Split::EdgeEdge)
}

fn contact(corners: [[[f64; 3]; 2]; 4], split: Split) -> Impact {
    first_contact(&corners.map(|[start, _]| start), &corners.map(|[_, end]| end), split)
}

fn list(found: &mut Vec<SweptContact>, features: Features, impact: Impact) {
    if impact.hit() {
        found.push(SweptContact { features, impact });
    }
}

/// Returns an edge of a face, the lesser vertex first.
fn edge(vertices: &[u32; 3], k: usize) -> [u32; 2] {
    let (a, b) = (vertices[k], vertices[(k + 1) % 3]);
    [a.min(b), a.max(b)]
}

/// Returns the features that each face represents, as bits (see [`Deforming`]). An edge from a
/// vertex to itself is represented by no face.
fn represents(faces: &[[u32; 3]]) -> Vec<u8> {
    let mut features: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(6 * faces.len());
    for (face, vertices) in (0..).zip(faces) {
        for k in 0..3 {
            // A vertex is written as an edge to itself.
            features.push(([vertices[k]; 2], face, k as u8));
            let edge = edge(vertices, k);
            if edge[0] != edge[1] {
                features.push((edge, face, 3 + k as u8));
            }
        }
    }
    features.par_sort_unstable();
    features.dedup_by_key(|(vertices, ..)| *vertices);
    let mut bits = vec![0; faces.len()];
    for (_, face, bit) in features {
        bits[face as usize] |= 1 << bit;
    }
    bits
}

fn validate(faces: &[[u32; 3]], t0: &[[f64; 3]], t1: &[[f64; 3]]) -> Result<(), InputError> {
    let max = u32::MAX as usize;
    for (what, count, limit) in [("vertices", t0.len(), max), ("faces", faces.len(), max >> 3)] {
        if count > limit {
            return Err(InputError::new(InputErrorKind::TooMany { what, count, limit }));
        }
    }
    for (index, row) in t0.iter().chain(t1).enumerate() {
        if !row.iter().all(|x| x.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "vertex", index }));
        }
        if !row.iter().all(|x| x.abs() <= LIMIT) {
            return Err(InputError::new(InputErrorKind::OutOfRange { what: "vertex", index, limit: "2^126" }));
        }
    }
    let len = t0.len().min(t1.len());
    for (face, vertices) in faces.iter().enumerate() {
        if let Some(&index) = vertices.iter().find(|&&vertex| vertex as usize >= len) {
            return Err(InputError::new(InputErrorKind::IndexOutOfBounds { face, index, len }));
        }
    }
    Ok(())
}
