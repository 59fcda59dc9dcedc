//! No structure: every box is compared. The fastest kind for a few bodies, and the baseline for the
//! other kinds. If many boxes moved, all pairs are found together, by a sort and a sweep.

use crate::budget::{Budget, Stopped};
use crate::partition::{Move, Ray};
use crate::storage::TryPush;
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
    /// The boxes are sorted along the axis on which their centers are spread most. Each is compared
    /// with those that begin before it ends.
    ///
    /// # Errors
    /// Returns an error if the budget ended the sweep, or if there is not enough memory.
    pub(super) fn pairs(&self, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        let axis = self.widest_axis();
        let mut order: Vec<(i64, u32)> = Vec::new();
        order.try_reserve_exact(self.boxes.len())?;
        order.extend((0..).zip(&self.boxes).map(|(place, bounds)| (order_of(bounds.ends(axis)[0]), place)));
        order.sort_unstable_by_key(|&(begin, _)| begin);
        let mut sorted: Vec<(MinMax, u32)> = Vec::new();
        sorted.try_reserve_exact(order.len())?;
        sorted.extend(order.iter().map(|&(_, place)| (self.boxes[place as usize], self.bodies[place as usize])));
        let mut pairs = Vec::new();
        for (at, (bounds, body)) in sorted.iter().enumerate() {
            budget.check()?;
            let end = bounds.ends(axis)[1];
            for (other, other_body) in &sorted[at + 1..] {
                if other.ends(axis)[0] > end {
                    break;
                }
                if other.overlaps(bounds) {
                    pairs.try_push([*body, *other_body])?;
                }
            }
        }
        Ok(pairs)
    }

    /// Returns the axis on which the centers of the boxes vary most.
    fn widest_axis(&self) -> usize {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for bounds in &self.boxes {
            for axis in 0..3 {
                let [begin, end] = bounds.ends(axis);
                let center = begin + end;
                low[axis] = if center < low[axis] { center } else { low[axis] };
                high[axis] = if center > high[axis] { center } else { high[axis] };
            }
        }
        let spreads = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        (1..3).fold(0, |widest, axis| if spreads[axis] > spreads[widest] { axis } else { widest })
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

/// Returns an integer that is ordered as [`f64::total_cmp`] orders numbers. Sorting integers takes
/// fewer instructions.
#[inline]
fn order_of(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    /// Boxes with corners on a small grid share most of their sides.
    #[test]
    fn the_sweep_finds_the_pairs_of_every_comparison() {
        let mut rng = Rng::new(17);
        let (mut found, mut apart) = (0, 0);
        for round in 0..300 {
            let mut every = Every::default();
            let flat = round % 4;
            for body in 0..rng.integer(0, 40) as u32 {
                let low: [f64; 3] = std::array::from_fn(|k| if k == flat { 2.0 } else { rng.integer(-3, 6) as f64 });
                let high = low.map(|x| x + rng.integer(0, 2) as f64);
                every.insert(3 * body, &MinMax::from_ordered(low, high));
            }
            let mut pairs = every.pairs(Budget::unlimited()).expect("no limits");
            pairs.iter_mut().for_each(|pair| pair.sort_unstable());
            pairs.sort_unstable();
            let all: Vec<(&MinMax, u32)> = every.iter().collect();
            let mut expected = Vec::new();
            for (at, (bounds, body)) in all.iter().enumerate() {
                let others = all[at + 1..].iter().filter(|(other, _)| other.overlaps(bounds));
                expected.extend(others.map(|(_, other)| [*body, *other]));
            }
            apart += all.len() * all.len().saturating_sub(1) / 2 - expected.len();
            found += expected.len();
            assert_eq!(pairs, expected);
        }
        assert!(found > 3000 && apart > 10_000, "{found} {apart}");
    }

    #[test]
    fn integers_are_ordered_as_numbers() {
        let mut rng = Rng::new(18);
        let numbers = [0.0, -0.0, 1.0, -1.0, 5e-324, f64::MAX, f64::MIN, f64::NEG_INFINITY];
        let any = (0..200).map(|_| rng.uniform(-2.0, 2.0));
        let all: Vec<f64> = numbers.into_iter().chain(any).collect();
        for (x, y) in all.iter().flat_map(|x| all.iter().map(move |y| (*x, *y))) {
            assert_eq!(order_of(x).cmp(&order_of(y)), x.total_cmp(&y), "{x} {y}");
        }
    }

    #[test]
    fn the_sweep_is_along_the_widest_axis() {
        for axis in 0..3 {
            let mut every = Every::default();
            for body in 0..4 {
                let low = std::array::from_fn(|k| f64::from(body) * if k == axis { 8.0 } else { 1.0 });
                every.insert(body, &MinMax::from_ordered(low, low));
            }
            assert_eq!(every.widest_axis(), axis);
        }
        assert_eq!(Every::default().widest_axis(), 0);
    }
}
