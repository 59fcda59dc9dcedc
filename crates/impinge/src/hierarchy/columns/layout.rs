//! Where rows lie: the room for a cluster's rows, and runs of rows in it.

/// The most rows: a cluster's boxes.
pub(in crate::hierarchy) const MOST: usize = 1 << 13;

/// Maximum number of planes that split a run one below the other. Medians split what is left.
pub(in crate::hierarchy) const PLANES: u32 = 7;

/// Room for all, and for whole vectors behind them. Columns are not a multiple of 4 KiB apart, as a processor takes addresses that are
/// for one and the same at first.
pub(super) const ROOM: usize = 2 * MOST + (MOST_TOGETHER << PLANES) + 560;

/// Three coordinates and the number of a box in its cluster.
pub(super) const WIDTH: usize = 4;
pub(super) const NUMBER: usize = 3;

/// How many coordinates fill a vector.
pub(super) const SIXTEEN: usize = 16;

/// Maximum number of rows that are processed together.
pub(super) const MOST_TOGETHER: usize = 32;

/// Rows that follow each other.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::hierarchy) struct Run {
    /// How many rows come before it.
    pub(in crate::hierarchy) start: usize,
    pub(in crate::hierarchy) len: usize,
    /// Where it lies. There is room for twice as many rows, and for a vector more for each part that planes can make of it.
    pub(super) at: usize,
    /// Maximum number of planes that may still split it.
    pub(super) planes: u32,
}

impl Run {
    /// The run of all `len` rows.
    pub(in crate::hierarchy) fn all(len: usize) -> Self {
        Self { start: 0, len, at: 0, planes: PLANES }
    }

    /// Splits the run into its first `low` rows, a multiple of eight or all of them, and the other rows.
    pub(in crate::hierarchy) fn split(self, low: usize) -> (Self, Self) {
        let low = low.min(self.len);
        (Self { len: low, planes: 0, ..self }, self.high(low, self.at + 2 * low, 0))
    }

    /// What is left of it.
    pub(super) fn high(self, low: usize, at: usize, planes: u32) -> Self {
        Self { start: self.start + low, len: self.len - low, at, planes }
    }
}
