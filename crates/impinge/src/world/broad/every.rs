//! No structure: every box is compared. The fastest kind for a few bodies, and the baseline for the
//! other kinds. If many boxes moved, all pairs are found together, by a sort and a sweep.

use super::sweep;
use crate::budget::{Budget, Stopped};
use crate::partition::{Move, Ray};
use crate::simd::best_level;
use crate::volume::{BoundingVolume, MinMax};

/// Value that stands for "no box".
const NONE: u32 = u32::MAX;

/// An array of boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Every {
    boxes: Vec<MinMax>,
    /// Body of each box.
    bodies: Vec<u32>,
    /// Index of the box of each body, or [`NONE`] if the body has no box.
    places: Vec<u32>,
}

impl Every {
    pub(super) fn boxes(&self) -> &[MinMax] {
        &self.boxes
    }

    /// Returns the body of each box.
    pub(super) fn bodies(&self) -> &[u32] {
        &self.bodies
    }

    /// Returns all boxes with their bodies.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&MinMax, u32)> {
        self.boxes.iter().zip(self.bodies.iter().copied())
    }

    /// Inserts the box of a body, or replaces it.
    #[inline]
    pub(super) fn insert(&mut self, body: u32, bounds: &MinMax) {
        if self.places.len() <= body as usize {
            self.places.resize(body as usize + 1, NONE);
        }
        let place = &mut self.places[body as usize];
        match self.boxes.get_mut(*place as usize) {
            Some(own) => *own = *bounds,
            None => {
                *place = self.boxes.len() as u32;
                self.boxes.push(*bounds);
                self.bodies.push(body);
            }
        }
    }

    /// Replaces the boxes that moved.
    pub(super) fn update(&mut self, moves: &[Move]) {
        for Move { key, to } in moves {
            if let Some(bounds) = to {
                self.insert(*key, bounds);
            }
        }
    }

    pub(super) fn remove(&mut self, body: u32) {
        let place = std::mem::replace(&mut self.places[body as usize], NONE);
        self.boxes.swap_remove(place as usize);
        self.bodies.swap_remove(place as usize);
        if let Some(moved) = self.bodies.get(place as usize) {
            self.places[*moved as usize] = place;
        }
    }

    pub(super) fn for_each_overlapping(&self, bounds: &MinMax, visit: &mut dyn FnMut(u32)) {
        for (own, body) in self.iter() {
            if own.overlaps(bounds) {
                visit(body);
            }
        }
    }

    /// Returns all pairs of bodies whose boxes overlap.
    ///
    /// # Errors
    /// Returns an error if the budget ended the sweep, or if there is not enough memory.
    pub(super) fn pairs(&self, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        let mut pairs = sweep::pairs(best_level(), &self.boxes, budget)?;
        for pair in &mut pairs {
            *pair = pair.map(|place| self.bodies[place as usize]);
        }
        Ok(pairs)
    }

    pub(super) fn along(&self, ray: &Ray, visit: &mut dyn FnMut(u32) -> f64) {
        let mut reach = ray.reach();
        for (own, body) in self.iter() {
            if ray.enters(own).is_some_and(|enter| enter <= reach) {
                reach = reach.min(visit(body));
            }
        }
    }
}
