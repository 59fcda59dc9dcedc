//! The question and the answer of a search for a depth.

use crate::math::vec3::Vector;

/// How much work a search does, and how narrow an interval it wants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Relative width of the interval at which the search for the greatest depth stops.
    pub(crate) relative_width: f64,
    /// Number of cells after which a search ends.
    pub(crate) cells: usize,
    /// Number of faces with which cells are compared until a search ends.
    pub(crate) faces: usize,
    /// Number of edges of borders that winding numbers near holes sum up until a search ends.
    pub(crate) border_edges: usize,
}

impl Effort {
    /// The effort of a question about one pair. It bounds the work to about a tenth of a second, or
    /// a second if faces by the thousand are near each other, and more for hundreds of thousands.
    pub(crate) const FULL: Self =
        Self { relative_width: 1.0 / 1024.0, cells: 1 << 14, faces: 1 << 28, border_edges: 1 << 21 };
}

/// The points whose depth is searched, and how far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// Depth above which the search stops, as soon as a point proves it. Without it the greatest
    /// depth is searched.
    pub(super) threshold: Option<f64>,
    /// Whether the points outside the first solid are searched, in place of those inside.
    pub(super) outside_first: bool,
    /// The solids whose surfaces count: the depth is the greatest distance from one of them.
    pub(super) measured: [bool; 2],
    pub(super) effort: Effort,
}

/// The answer of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Depth that some point has at least, and that no point exceeds.
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// The point with the depth `lower`, in the frame of the search.
    pub(super) point: Option<Vector>,
    /// The search does not tell smaller depths from zero.
    pub(super) resolution: f64,
}

impl Found {
    /// Reports whether no point is deeper than the threshold, or than rounding.
    pub(super) fn is_within(&self, threshold: f64) -> bool {
        self.lower <= threshold && self.upper <= threshold.max(self.resolution)
    }
}
