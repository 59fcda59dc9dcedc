//! The broad phase of a configuration: finds the pairs of parts whose boxes are near each other.

use std::borrow::Cow;

use super::parts::{PartId, Scene};
use crate::budget::{Budget, Stopped};
use crate::partition::ColumnSweep;
use crate::shape::PlacedShape;
use crate::storage::TryPush;
use crate::volume::MinMax;

/// Maximum number of bounded parts whose boxes are compared pair by pair. For more parts the column
/// sweep finds the overlapping boxes.
const MAX_PAIRWISE: usize = 24;

/// A part at its pose in a configuration.
#[derive(Clone, Debug)]
pub(super) enum PlacedPart {
    /// The pose is faulty, so the part may be anywhere.
    Anywhere,
    /// The placed part, with a box that contains it, enlarged by half the clearance. `None` if no
    /// box bounds the part.
    Placed(Box<PlacedShape>, Option<MinMax>),
    /// The part is empty, so it is nowhere.
    Nowhere,
}

impl PlacedPart {
    pub(super) fn new(placed: PlacedShape, clearance: f64) -> Self {
        if placed.is_unbounded() {
            return Self::Placed(Box::new(placed), None);
        }
        let Some([min, max]) = placed.bounds() else { return Self::Nowhere };
        // Each of the two parts grows by half of the clearance, rounded up.
        let grow = |x: f64| if clearance > 0.0 { (x + (0.5 * clearance).next_up()).next_up() } else { x };
        let grown = MinMax::new(min.map(|x| -grow(-x)), max.map(grow));
        Self::Placed(Box::new(placed), grown.ok())
    }

    /// Returns the box, or `None` if there is none.
    pub(super) fn bounds(&self) -> Option<&MinMax> {
        match self {
            Self::Placed(_, bounds) => bounds.as_ref(),
            Self::Anywhere | Self::Nowhere => None,
        }
    }

    pub(super) fn placed(&self) -> Option<&PlacedShape> {
        match self {
            Self::Placed(placed, _) => Some(placed),
            Self::Anywhere | Self::Nowhere => None,
        }
    }

    pub(super) fn is_nowhere(&self) -> bool {
        matches!(self, Self::Nowhere)
    }
}

/// Returns the pairs of parts that the scene admits, for which `is_wanted` returns `true`, and
/// whose boxes are not proved apart. The pairs are sorted, the smaller part first.
///
/// # Errors
/// Returns an error if the budget ended the search, or if there is not enough memory for the
/// pairs.
///
/// # Complexity
/// About linear in the number of parts and of pairs whose boxes are near.
pub(super) fn pairs_near(
    scene: &Scene,
    placed_parts: &[Cow<'_, PlacedPart>],
    budget: &Budget<'_>,
    is_wanted: impl Fn(PartId, PartId) -> bool,
) -> Result<Vec<[PartId; 2]>, Stopped> {
    let parts: Vec<PartId> = scene.parts().collect();
    let mut found = Vec::new();
    let mut offer = |a: PartId, b: PartId| -> Result<(), Stopped> {
        if is_wanted(a, b) && scene.admits(a, b) {
            found.try_push([a.min(b), a.max(b)])?;
        }
        Ok(())
    };
    let bounded: Vec<(PartId, MinMax)> =
        parts.iter().filter_map(|&part| Some((part, *placed_parts[part.index()].bounds()?))).collect();
    if bounded.len() <= MAX_PAIRWISE {
        for (i, (a, bounds_a)) in bounded.iter().enumerate() {
            for (b, bounds_b) in &bounded[i + 1..] {
                if overlap(bounds_a, bounds_b) {
                    offer(*a, *b)?;
                }
            }
        }
    } else {
        let boxes: Vec<MinMax> = bounded.iter().map(|(_, bounds)| *bounds).collect();
        let mut pairs = Vec::new();
        ColumnSweep::new().try_find(&boxes, &mut pairs, budget)?;
        for [a, b] in pairs {
            offer(bounded[a as usize].0, bounded[b as usize].0)?;
        }
    }
    // A part without a box is near every part.
    let is_unbounded = |part: PartId| {
        let placed = &placed_parts[part.index()];
        !placed.is_nowhere() && placed.bounds().is_none()
    };
    for &a in parts.iter().filter(|&&part| is_unbounded(part)) {
        budget.check()?;
        for &b in &parts {
            let is_second = is_unbounded(b) && b < a;
            if !is_second && !placed_parts[b.index()].is_nowhere() {
                offer(a, b)?;
            }
        }
    }
    found.sort_unstable();
    Ok(found)
}

fn overlap(a: &MinMax, b: &MinMax) -> bool {
    (0..3).all(|k| a.min()[k] <= b.max()[k] && b.min()[k] <= a.max()[k])
}
