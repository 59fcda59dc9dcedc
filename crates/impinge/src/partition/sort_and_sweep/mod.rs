//! Sort-and-sweep: boxes in the order in which they begin along an axis (Baraff, *Dynamic simulation of non-penetrating
//! rigid bodies*, 1992, as sweep-and-prune; Ericson, 7.5). The order is kept, so that boxes which move little cost little.

mod one_axis;
mod three_axes;

pub use one_axis::SweepOneAxis;
pub use three_axes::SweepThreeAxes;

use crate::volume::MinMax;

/// An axis of space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    #[default]
    X,
    /// The second.
    Y,
    /// The third.
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

/// The greatest extent of boxes along an axis: what begins farther before a box than this has ended. It may be larger than
/// needed after some went, until it is measured anew.
#[derive(Clone, Copy, Debug, Default)]
struct Widest {
    extent: f64,
    /// Boxes that moved or went since.
    stale: usize,
}

/// Changes beyond the number of boxes after which the extent is measured anew.
const STALE: usize = 64;

impl Widest {
    fn include(&mut self, bounds: &MinMax, axis: usize) {
        self.extent = self.extent.max((bounds.max()[axis] - bounds.min()[axis]).next_up());
    }

    /// Counts a box that moved or went; whether it is time to measure, which starts from zero then.
    fn aged(&mut self, len: usize) -> bool {
        self.stale += 1;
        let due = self.stale > len + STALE;
        if due {
            *self = Self::default();
        }
        due
    }

    /// What begins before this ends before `from`.
    fn before(&self, from: f64) -> f64 {
        (from - self.extent).next_down()
    }
}

/// Moves the element at `from` of a sorted slice to where it belongs among the others if it were `to`, and says where:
/// those between move by one.
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
