//! The structures that find overlapping boxes, one of them at work.

mod every;

use std::ops::ControlFlow;

use crate::partition::{BoxTree, Changes, Dynamic, Move, Partition, Ray};
use crate::volume::MinMax;
use every::Every;

/// More boxes than this are found sooner through a tree, and fewer than half of it are looked at one by one again: in between
/// both take as long, and going back and forth would take longer than either (`docs/worlds.md`).
const MOST_FOR_EVERY: usize = 64;

/// No place.
const NONE: u32 = u32::MAX;

/// How pairs of boxes are found. No answer depends on it; `docs/worlds.md` says which is the quickest when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BroadPhase {
    /// What suits the number of bodies, how many of them move and how their sizes spread.
    #[default]
    Auto,
    /// Every box is compared with every box that moved.
    Every,
    /// The dynamic bounding-volume tree, [`BoxTree`].
    Tree,
}

/// The boxes of the bodies.
#[derive(Clone, Debug)]
pub(super) struct Broad {
    choice: BroadPhase,
    structure: Structure,
}

/// What is at work.
#[derive(Clone, Debug)]
enum Structure {
    Every(Every),
    Tree(Box<BoxTree>),
}

impl Default for Broad {
    fn default() -> Self {
        Self::new(BroadPhase::Auto)
    }
}

impl Broad {
    pub(super) fn new(choice: BroadPhase) -> Self {
        let structure = match choice {
            BroadPhase::Auto | BroadPhase::Every => Structure::Every(Every::default()),
            BroadPhase::Tree => Structure::Tree(Box::default()),
        };
        Self { choice, structure }
    }

    /// Takes up the structure that suits what there is now, where the choice is left to it.
    pub(super) fn adapt(&mut self) {
        if self.choice != BroadPhase::Auto {
            return;
        }
        match &self.structure {
            Structure::Every(every) if every.boxes().len() > MOST_FOR_EVERY => {
                let boxes = every.boxes().iter().map(|&(bounds, body)| (body, bounds));
                self.structure = Structure::Tree(Box::new(boxes.collect()));
            }
            Structure::Tree(tree) if tree.len() < MOST_FOR_EVERY / 2 => {
                let mut every = Every::default();
                tree.each(&mut |body, bounds| every.insert(body, bounds));
                self.structure = Structure::Every(every);
            }
            _ => {}
        }
    }

    /// A new box, or another one for a body that has one.
    pub(super) fn insert(&mut self, body: u32, bounds: &MinMax) {
        match &mut self.structure {
            Structure::Every(every) => every.insert(body, bounds),
            Structure::Tree(tree) => _ = tree.insert(body, *bounds),
        }
    }

    pub(super) fn remove(&mut self, body: u32) {
        match &mut self.structure {
            Structure::Every(every) => every.remove(body),
            Structure::Tree(tree) => _ = tree.remove(body),
        }
    }

    /// Moves boxes; the pairs that began and ended by that, where the structure knows them sooner than they are found by
    /// asking about each box.
    pub(super) fn step(&mut self, moves: &[Move]) -> Option<Changes> {
        for step in moves {
            if let Some(bounds) = &step.to {
                self.insert(step.key, bounds);
            }
        }
        None
    }

    pub(super) fn for_each_overlapping(&self, bounds: &MinMax, visit: &mut dyn FnMut(u32)) {
        match &self.structure {
            Structure::Every(every) => every.for_each_overlapping(bounds, visit),
            Structure::Tree(tree) => {
                let _ = tree.overlapping(bounds, &mut |body| {
                    visit(body);
                    ControlFlow::Continue(())
                });
            }
        }
    }

    /// Visits the bodies whose boxes a ray meets before what `visit` last returned.
    pub(super) fn along(&self, ray: &Ray, visit: &mut dyn FnMut(u32) -> f64) {
        match &self.structure {
            Structure::Every(every) => every.along(ray, visit),
            Structure::Tree(tree) => tree.ray(ray, &mut |met| visit(met.key)),
        }
    }
}
