//! The parts of a triangle.

/// A part of a triangle. Where a triangle has no area, the names of its parts are not unique: a point that is on two
/// overlapping edges is said to be on one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// The corner of this number.
    Vertex(u8),
    /// The edge from the corner of this number to the next, without its ends.
    Edge(u8),
    /// The triangle without its edges.
    Face,
}
