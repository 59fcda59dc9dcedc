//! The parts of a triangle: its corners, edges and face.

/// A part of a triangle. If the triangle has no area, the name of a point's part is not unique: a
/// point on two overlapping edges gets the name of one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// The corner with this index (0, 1 or 2).
    Vertex(u8),
    /// The edge from the corner with this index to the next corner, without its ends. The corner
    /// after 2 is 0.
    Edge(u8),
    /// The triangle without its edges.
    Face,
}
