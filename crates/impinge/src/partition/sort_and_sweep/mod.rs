//! Sort-and-sweep: boxes sorted by their beginnings along an axis (Baraff, *Dynamic simulation of
//! non-penetrating rigid bodies*, 1992, as sweep-and-prune; Ericson, 7.5). The order is kept
//! between steps, so boxes that move little cost little.

mod one_axis;
mod three_axes;

pub use one_axis::SweepOneAxis;
pub use three_axes::SweepThreeAxes;

use crate::volume::MinMax;

/// An axis of space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// The first axis.
    #[default]
    X,
    /// The second axis.
    Y,
    /// The third axis.
    Z,
}

impl Axis {
    fn number(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// Maximum extent of all boxes along an axis. A box that begins farther than this before another
/// has ended before it. The value may be larger than necessary after boxes were moved or removed,
/// until it is measured again.
#[derive(Clone, Copy, Debug, Default)]
struct Widest {
    extent: f64,
    /// Number of moves and removals since the extent was measured.
    stale: usize,
}

/// Number of changes, beyond the number of boxes, after which the extent is measured again.
const EXTRA_STALE: usize = 64;

impl Widest {
    fn include(&mut self, bounds: &MinMax, axis: usize) {
        self.extent = self.extent.max((bounds.max()[axis] - bounds.min()[axis]).next_up());
    }

    /// Counts a move or removal. Returns `true`, and resets the extent to zero, if the caller must
    /// measure it again.
    fn aged(&mut self, len: usize) -> bool {
        self.stale += 1;
        let due = self.stale > len + EXTRA_STALE;
        if due {
            *self = Self::default();
        }
        due
    }

    /// Returns a place such that boxes that begin before it end before `from`.
    fn before(&self, from: f64) -> f64 {
        (from - self.extent).next_down()
    }
}

/// Replaces the element at `from` of a sorted slice by `to`, moves it to its sorted position, and
/// returns that position. The elements between the old and the new position move by one.
fn reorder<T: Copy>(sorted: &mut [T], from: usize, to: T, precedes: impl Fn(&T, &T) -> bool) -> usize {
    let after = sorted.partition_point(|element| precedes(element, &to));
    let place = if after > from {
        sorted[from..after].rotate_left(1);
        after - 1
    } else {
        sorted[after..=from].rotate_right(1);
        after
    };
    sorted[place] = to;
    place
}
