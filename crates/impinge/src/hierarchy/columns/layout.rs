//! The memory layout of a cluster's rows, and runs of rows in it.

/// Maximum number of rows: the boxes of a cluster.
pub(in crate::hierarchy) const MAX_ROWS: usize = 1 << 13;

/// Maximum number of nested planes that split a run. Medians split the runs that are left.
pub(in crate::hierarchy) const MAX_PLANES: u32 = 7;

/// Number of slots in a column: room for all rows, and for whole vectors behind them. The number is
/// such that columns are not a multiple of 4 KiB apart, because a processor at first takes such
/// addresses for the same.
pub(super) const ROOM: usize = 2 * MAX_ROWS + (MAX_TOGETHER << MAX_PLANES) + 560;

/// Number of columns: three coordinates, and the index of the box in its cluster.
pub(super) const WIDTH: usize = 4;
pub(super) const NUMBER: usize = 3;

/// Number of coordinates in a vector.
pub(super) const SIXTEEN: usize = 16;

/// Maximum number of rows that are processed together.
pub(super) const MAX_TOGETHER: usize = 32;

/// Consecutive rows.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::hierarchy) struct Run {
    /// Number of rows of the cluster that come before the run.
    pub(in crate::hierarchy) start: usize,
    pub(in crate::hierarchy) len: usize,
    /// The slot of the run's first row. There is room for twice as many rows, and for one more
    /// vector for each part that planes can split off.
    pub(super) at: usize,
    /// Maximum number of planes that may still split the run.
    pub(super) planes: u32,
}

impl Run {
    /// The run of all `len` rows.
    pub(in crate::hierarchy) fn all(len: usize) -> Self {
        Self { start: 0, len, at: 0, planes: MAX_PLANES }
    }

    /// Splits the run into its first `low` rows, a multiple of eight or all of them, and the other
    /// rows.
    pub(in crate::hierarchy) fn split(self, low: usize) -> (Self, Self) {
        let low = low.min(self.len);
        (Self { len: low, planes: 0, ..self }, self.high(low, self.at + 2 * low, 0))
    }

    /// Returns the run of the rows from `low` on, which start at slot `at`.
    pub(super) fn high(self, low: usize, at: usize, planes: u32) -> Self {
        Self { start: self.start + low, len: self.len - low, at, planes }
    }
}
