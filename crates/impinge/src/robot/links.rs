//! Links and obstacles at their places in the world, with boxes about them.

use super::frame::Frame;
use super::model::Robot;
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
        let is_moved = match (&mut *self, pose) {
            (Self::At(placed), Some(pose)) => placed.move_to(&pose).is_ok(),
            _ => false,
        };
        if !is_moved {
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

/// The links of a robot. Those that a configuration needs are placed, each once.
#[derive(Clone, Debug)]
pub(super) struct PlacedLinks {
    pub(super) placed: Vec<PlacedLink>,
    is_current: Vec<bool>,
}

impl PlacedLinks {
    pub(super) fn new(count: usize) -> Self {
        Self { placed: vec![PlacedLink::Nowhere; count], is_current: vec![false; count] }
    }

    /// Starts a configuration.
    pub(super) fn start(&mut self) {
        self.is_current.fill(false);
    }

    /// Places a link in the configuration with these frames.
    pub(super) fn place(&mut self, link: usize, robot: &Robot, frames: &[Frame]) {
        self.place_at(link, robot, || frames[link]);
    }

    /// Places a link at a frame, which is computed if the link was not placed.
    pub(super) fn place_at(&mut self, link: usize, robot: &Robot, frame: impl FnOnce() -> Frame) {
        if !std::mem::replace(&mut self.is_current[link], true)
            && let Some(shape) = &robot.links()[link].shape
        {
            self.placed[link].move_to(shape, frame().pose());
        }
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
