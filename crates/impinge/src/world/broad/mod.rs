//! The broad phase: the bodies of a world by their boxes, in two sets.
//!
//! Two bodies form a pair only if at least one of them is of the kind [`Moving`](Kind::Moving). So
//! moving bodies are in one set and all others, the guided bodies, are in another. A search for the
//! pairs of a guided body looks only among the moving bodies, so pairs of two guided bodies are
//! never formed, however many of them are in one place.
//!
//! Guarded by `tests/it/worlds/crowds.rs`, measured by the benchmark `worlds`.

mod boxes;
mod columns;
mod every;
mod sizes;
mod sweep;

pub use boxes::BroadPhase;
pub(super) use boxes::KnownPairs;

use super::body::Kind;
use crate::budget::{Budget, Stopped};
use crate::partition::{Move, Ray};
use crate::storage::TryPush;
use crate::volume::MinMax;
use boxes::Boxes;

/// The bodies of a world that are somewhere, in two sets.
#[derive(Clone, Debug, Default)]
pub(super) struct Broad {
    moving: Set,
    guided: Set,
}

/// Bodies that are moving, or bodies that are not.
#[derive(Clone, Debug, Default)]
struct Set {
    /// The bodies that a box bounds.
    boxes: Boxes,
    /// Slots of the bodies that no box bounds.
    unbounded: Vec<u32>,
}

/// Bodies among which a search looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Among {
    /// All bodies.
    All,
    /// Bodies of the kind [`Moving`](Kind::Moving).
    Moving,
    /// Bodies of the other kinds.
    Guided,
}

impl Among {
    /// Returns the bodies that may form pairs with a body of this kind.
    pub(super) fn partners_of(kind: Kind) -> Self {
        if kind == Kind::Moving { Self::All } else { Self::Moving }
    }
}

impl Broad {
    pub(super) fn new(choice: BroadPhase) -> Self {
        // Guided bodies are searched and rarely moved, so their structure is a tree.
        let guided = if choice == BroadPhase::Every { choice } else { BroadPhase::Tree };
        let set = |choice| Set { boxes: Boxes::new(choice), unbounded: Vec::new() };
        Self { moving: set(choice), guided: set(guided) }
    }

    fn set(&mut self, kind: Kind) -> &mut Set {
        if kind == Kind::Moving { &mut self.moving } else { &mut self.guided }
    }

    fn sets(&self, among: Among) -> impl Iterator<Item = &Set> {
        let chosen = [(&self.moving, among != Among::Guided), (&self.guided, among != Among::Moving)];
        chosen.into_iter().filter_map(|(set, is_chosen)| is_chosen.then_some(set))
    }

    /// Inserts the box of a body of a kind, or replaces it.
    pub(super) fn insert(&mut self, kind: Kind, body: u32, bounds: &MinMax) {
        self.set(kind).boxes.insert(body, bounds);
    }

    /// Removes the box of a body of a kind.
    pub(super) fn remove(&mut self, kind: Kind, body: u32) {
        self.set(kind).boxes.remove(body);
    }

    /// Adds a body of a kind that no box bounds.
    pub(super) fn insert_unbounded(&mut self, kind: Kind, body: u32) {
        self.set(kind).unbounded.push(body);
    }

    /// Removes a body of a kind that no box bounds.
    pub(super) fn remove_unbounded(&mut self, kind: Kind, body: u32) {
        self.set(kind).unbounded.retain(|&other| other != body);
    }

    /// Returns `true` if a box bounds each of these bodies.
    pub(super) fn are_bounded(&self, among: Among) -> bool {
        self.sets(among).all(|set| set.unbounded.is_empty())
    }

    /// Adapts the structure of the moving bodies to the number of them that a step moves.
    pub(super) fn adapt(&mut self, moved: usize) {
        self.moving.boxes.adapt(moved);
    }

    /// Moves the boxes of moving and of guided bodies, and returns the facts about pairs that are
    /// known afterwards.
    ///
    /// # Errors
    /// Returns an error if the budget ended the search for pairs, or if there is not enough
    /// memory for them. The boxes have moved all the same.
    pub(super) fn step(
        &mut self,
        moving: &[Move],
        guided: &[Move],
        budget: &Budget<'_>,
    ) -> Result<KnownPairs, Stopped> {
        for step in guided {
            step.to.iter().for_each(|bounds| self.guided.boxes.insert(step.key, bounds));
        }
        let mut known = self.moving.boxes.step(moving, budget)?;
        if let KnownPairs::All(pairs) = &mut known
            && !self.guided.boxes.is_empty()
        {
            let mut pushed = Ok(());
            self.moving.boxes.for_each(&mut |body, bounds| {
                if pushed.is_ok() {
                    pushed = budget.check();
                }
                if pushed.is_ok() {
                    self.guided.boxes.for_each_overlapping(bounds, &mut |other| {
                        if pushed.is_ok() {
                            pushed = pairs.try_push([body, other]).map_err(Stopped::from);
                        }
                    });
                }
            });
            pushed?;
        }
        Ok(known)
    }

    /// Visits the bodies whose boxes overlap a box.
    pub(super) fn for_each_overlapping(&self, among: Among, bounds: &MinMax, visit: &mut dyn FnMut(u32)) {
        self.sets(among).for_each(|set| set.boxes.for_each_overlapping(bounds, visit));
    }

    /// Visits the bodies that no box bounds.
    pub(super) fn for_each_unbounded(&self, among: Among, visit: &mut dyn FnMut(u32)) {
        self.sets(among).flat_map(|set| &set.unbounded).for_each(|&body| visit(body));
    }

    /// Visits all bodies that are somewhere.
    pub(super) fn for_each(&self, among: Among, visit: &mut dyn FnMut(u32)) {
        self.sets(among).for_each(|set| set.boxes.for_each(&mut |body, _| visit(body)));
        self.for_each_unbounded(among, visit);
    }

    /// Visits the bodies that no box bounds, and the bodies whose boxes a ray enters, up to the ray
    /// parameter that `visit` last returned.
    pub(super) fn along(&self, ray: &Ray, visit: &mut dyn FnMut(u32) -> f64) {
        self.for_each_unbounded(Among::All, &mut |body| _ = visit(body));
        self.sets(Among::All).for_each(|set| set.boxes.along(ray, visit));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 300 static and 3 moving boxes in one place. All static boxes together visit 900 boxes, not
    /// 90,000, and the pairs that a step reports are at most those with a moving box.
    #[test]
    fn pairs_of_two_guided_bodies_are_never_formed() {
        let place = MinMax::from_ordered([0.0; 3], [1.0; 3]);
        for choice in BroadPhase::ALL {
            let mut broad = Broad::new(choice);
            (0..300).for_each(|body| broad.insert(Kind::Static, body, &place));
            (300..303).for_each(|body| broad.insert(Kind::Moving, body, &place));
            let visits = |broad: &Broad, kind| {
                let mut visits = 0;
                broad.for_each_overlapping(Among::partners_of(kind), &place, &mut |_| visits += 1);
                visits
            };
            for moved in [0, 3] {
                broad.adapt(moved);
                assert_eq!(visits(&broad, Kind::Static), 3, "{choice:?}");
                assert_eq!(visits(&broad, Kind::Kinematic), 3, "{choice:?}");
                assert_eq!(visits(&broad, Kind::Moving), 303, "{choice:?}");
            }
            let moves: Vec<Move> = (300..303).map(|key| Move { key, to: Some(place) }).collect();
            let guided: Vec<Move> = (0..300).map(|key| Move { key, to: Some(place) }).collect();
            let reported = match broad.step(&moves, &guided, Budget::unlimited()).unwrap() {
                KnownPairs::All(pairs) => pairs.len(),
                KnownPairs::Changes(changes) => changes.began().len() + changes.ended().len(),
                KnownPairs::Nothing => 0,
            };
            assert!(reported <= 3 + 900, "{choice:?}: {reported}");
        }
    }
}
