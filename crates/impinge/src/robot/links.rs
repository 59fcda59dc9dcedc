//! Links and obstacles at their places in the world, with boxes about them.

use crate::math::Pose;
use crate::shape::{PlacedShape, Shape};

/// A shape at its place.
#[derive(Clone, Debug)]
pub(super) enum PlacedLink {
    /// The link has no shape, or its shape is empty.
    Nowhere,
    /// The pose is not valid for the shape, so nothing is known about its place.
    Anywhere,
    /// The placed shape.
    At(Box<PlacedShape>),
}

impl PlacedLink {
    pub(super) fn new(shape: &Shape, pose: Option<Pose>) -> Self {
        let placed = pose.and_then(|pose| shape.at(pose).ok());
        placed.map_or(Self::Anywhere, |placed| {
            let is_empty = placed.bounds().is_none() && !placed.is_unbounded();
            if is_empty { Self::Nowhere } else { Self::At(Box::new(placed)) }
        })
    }

    /// Moves the shape to another pose.
    pub(super) fn move_to(&mut self, shape: &Shape, pose: Option<Pose>) {
        if let (Self::At(placed), Some(pose)) = (&mut *self, pose)
            && let Ok(Some(mut stand)) = placed.stand_at(&pose)
        {
            placed.swap_stand(&mut stand);
        } else {
            *self = Self::new(shape, pose);
        }
    }

    /// Returns the box about the shape; `None` if there is no such box.
    pub(super) fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        match self {
            Self::At(placed) => placed.bounds(),
            Self::Nowhere | Self::Anywhere => None,
        }
    }

    pub(super) fn is_nowhere(&self) -> bool {
        matches!(self, Self::Nowhere)
    }
}

/// Reports whether two shapes may be within a clearance of each other, by their boxes. A shape
/// without a box may be near everything, unless it is nowhere.
pub(super) fn may_be_near(a: &PlacedLink, b: &PlacedLink, clearance: f64) -> bool {
    match (a.bounds(), b.bounds()) {
        (Some([min_a, max_a]), Some([min_b, max_b])) => {
            // A sum that is rounded up is no less than the true sum.
            let reach = |x: f64| if clearance > 0.0 { (x + clearance).next_up() } else { x };
            (0..3).all(|k| min_a[k] <= reach(max_b[k]) && min_b[k] <= reach(max_a[k]))
        }
        _ => !a.is_nowhere() && !b.is_nowhere(),
    }
}
