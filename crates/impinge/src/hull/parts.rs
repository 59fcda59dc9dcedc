//! A hull as the arrays that it consists of, to be stored and restored.

use super::{Extremes, Hull, HullKind, reach, stored};

/// The arrays of a hull. Positions are not included; they are the positions of the points that are
/// vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct HullParts<'a> {
    pub(crate) kind: HullKind,
    /// Numbers of the vertices, as in [`Hull::vertices`].
    pub(crate) vertices: &'a [u32],
    /// Faces, as in [`Hull::faces`].
    pub(crate) faces: &'a [[u32; 3]],
    /// Start of each vertex's neighbors in `neighbors`, with one more entry for the end.
    pub(crate) first: &'a [u32],
    /// The neighbors of all vertices, one list after the other.
    pub(crate) neighbors: &'a [u32],
}

impl Hull {
    /// Returns the arrays that the hull consists of.
    pub(crate) fn parts(&self) -> HullParts<'_> {
        let Self { kind, vertices, faces, first, neighbors, .. } = self;
        HullParts { kind: *kind, vertices, faces, first, neighbors }
    }

    /// Builds a hull from these arrays without a proof that they are a hull. Checks only what would
    /// make a query panic. Returns `None` if an index is out of range, or if the number of entries
    /// does not fit the kind. `position` is called for each vertex, and returns `None` if there is
    /// no such point.
    ///
    /// # Complexity
    /// Linear in the arrays.
    pub(crate) fn from_parts(parts: &HullParts<'_>, position: impl Fn(u32) -> Option<[f64; 3]>) -> Option<Self> {
        let HullParts { kind, vertices, faces, first, neighbors } = *parts;
        let count = vertices.len();
        let is_counted = match kind {
            HullKind::Point => count == 1 && faces.is_empty(),
            HullKind::Segment => count == 2 && faces.is_empty(),
            HullKind::Polygon => count >= 3 && faces.len() == 2 * (count - 2),
            HullKind::Solid => count >= 4 && faces.len() == 2 * (count - 2),
        };
        let is_within = |&vertex: &u32| (vertex as usize) < count;
        let is_sound = is_counted
            && faces.len() <= (u32::MAX / 3) as usize // places of corners are numbered in the proof
            && vertices.is_sorted_by(|x, y| x < y)
            && faces.as_flattened().iter().all(is_within)
            && neighbors.iter().all(is_within)
            && first.len() == count + 1
            && first[0] == 0
            && first[count] as usize == neighbors.len()
            && first.is_sorted();
        if !is_sound {
            return None;
        }
        let positions = vertices.iter().map(|&vertex| position(vertex).map(stored)).collect::<Option<Vec<_>>>()?;
        Some(Self {
            kind,
            vertices: vertices.to_vec(),
            faces: faces.to_vec(),
            first: first.to_vec(),
            neighbors: neighbors.to_vec(),
            extremes: Extremes::new(&positions),
            reach: reach(&positions),
            positions,
        })
    }

    /// Returns the same hull with other numbers for its points. The order of the numbers must stay
    /// the same.
    pub(crate) fn renumbered(mut self, number: impl Fn(u32) -> u32) -> Self {
        self.vertices.iter_mut().for_each(|vertex| *vertex = number(*vertex));
        self
    }
}
