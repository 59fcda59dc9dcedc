//! The broad phase of a configuration: pairs of parts whose boxes are near each other.

use std::borrow::Cow;

use super::parts::{PartId, Scene};
use crate::partition::ColumnSweep;
use crate::shape::PlacedShape;
use crate::volume::MinMax;

/// Maximum number of bounded parts whose boxes are compared pair by pair. Of more the column sweep finds those that overlap.
const FEW: usize = 24;

/// A part where it stands in a configuration.
#[derive(Clone, Debug)]
pub(super) enum Standing {
    /// Its pose is faulty, so it may be anywhere.
    Anywhere,
    /// Placed, with a box that holds it; none if it is unbounded.
    Placed(Box<PlacedShape>, Option<MinMax>),
    /// An empty mesh, which is nowhere.
    Nowhere,
}

impl Standing {
    pub(super) fn new(placed: PlacedShape, clearance: f64) -> Self {
        if placed.is_unbounded() {
            return Self::Placed(Box::new(placed), None);
        }
        let Some([min, max]) = placed.bounds() else { return Self::Nowhere };
        // Each of two parts grows by half of the clearance, and by what rounding may take.
        let grow = |x: f64| if clearance > 0.0 { (x + (0.5 * clearance).next_up()).next_up() } else { x };
        let grown = MinMax::new(min.map(|x| -grow(-x)), max.map(grow));
        Self::Placed(Box::new(placed), grown.ok())
    }

    /// Returns the box; none if the part may be anywhere.
    fn bounds(&self) -> Option<&MinMax> {
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

    fn is_nowhere(&self) -> bool {
        matches!(self, Self::Nowhere)
    }
}

/// Returns the pairs of parts that the scene admits and whose boxes are not apart, sorted, the lesser first; of those that are wanted.
pub(super) fn pairs_near(
    scene: &Scene,
    standing: &[Cow<'_, Standing>],
    is_wanted: impl Fn(PartId, PartId) -> bool,
) -> Vec<[PartId; 2]> {
    let parts: Vec<PartId> = scene.parts().collect();
    let mut found = Vec::new();
    let mut offer = |a: PartId, b: PartId| {
        if is_wanted(a, b) && scene.admits(a, b) {
            found.push([a.min(b), a.max(b)]);
        }
    };
    let bounded: Vec<(PartId, MinMax)> =
        parts.iter().filter_map(|&part| Some((part, *standing[part.index()].bounds()?))).collect();
    if bounded.len() <= FEW {
        for (i, (a, bounds_a)) in bounded.iter().enumerate() {
            for (b, bounds_b) in &bounded[i + 1..] {
                if overlap(bounds_a, bounds_b) {
                    offer(*a, *b);
                }
            }
        }
    } else {
        let boxes: Vec<MinMax> = bounded.iter().map(|(_, bounds)| *bounds).collect();
        let mut pairs = Vec::new();
        ColumnSweep::new().find(&boxes, &mut pairs);
        for [a, b] in pairs {
            offer(bounded[a as usize].0, bounded[b as usize].0);
        }
    }
    // What has no box is near everything.
    let is_unbounded = |part: PartId| {
        let standing = &standing[part.index()];
        !standing.is_nowhere() && standing.bounds().is_none()
    };
    for &a in parts.iter().filter(|&&part| is_unbounded(part)) {
        for &b in &parts {
            let is_second = is_unbounded(b) && b < a;
            if !is_second && !standing[b.index()].is_nowhere() {
                offer(a, b);
            }
        }
    }
    found.sort_unstable();
    found
}

fn overlap(a: &MinMax, b: &MinMax) -> bool {
    (0..3).all(|k| a.min()[k] <= b.max()[k] && b.min()[k] <= a.max()[k])
}
