//! A hull as the arrays that it consists of, to be stored somewhere and put together again.

use super::{Extremes, Hull, HullKind, reach, stored};

/// The arrays of a hull. Its positions are not among them: they are those of the points that the vertices are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct HullParts<'a> {
    pub(crate) kind: HullKind,
    /// As [`Hull::vertices`].
    pub(crate) vertices: &'a [u32],
    /// As [`Hull::faces`].
    pub(crate) faces: &'a [[u32; 3]],
    /// For each vertex, and once more at the end, where its neighbours begin.
    pub(crate) first: &'a [u32],
    /// The neighbours of each vertex, those of one after those of the one before.
    pub(crate) neighbours: &'a [u32],
}

impl Hull {
    /// The arrays that the hull consists of.
    pub(crate) fn parts(&self) -> HullParts<'_> {
        let Self { kind, vertices, faces, first, neighbours, .. } = self;
        HullParts { kind: *kind, vertices, faces, first, neighbours }
    }

    /// The hull of these arrays, believed but for what would make a question panic: nothing where an index is out of range,
    /// or there are not as many of something as its kind has. `position` is asked for each vertex and knows what may be one.
    ///
    /// # Complexity
    /// Linear in the arrays.
    pub(crate) fn from_parts(parts: &HullParts<'_>, position: impl Fn(u32) -> Option<[f64; 3]>) -> Option<Self> {
        let HullParts { kind, vertices, faces, first, neighbours } = *parts;
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
            && neighbours.iter().all(is_within)
            && first.len() == count + 1
            && first[0] == 0
            && first[count] as usize == neighbours.len()
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
            neighbours: neighbours.to_vec(),
            extremes: Extremes::new(&positions),
            reach: reach(&positions),
            positions,
        })
    }

    /// The same hull of points that have other numbers, in the same order.
    pub(crate) fn renumbered(mut self, number: impl Fn(u32) -> u32) -> Self {
        self.vertices.iter_mut().for_each(|vertex| *vertex = number(*vertex));
        self
    }
}
