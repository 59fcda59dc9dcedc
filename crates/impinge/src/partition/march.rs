//! Rays and nearest boxes for any partition that can say what meets a box.

use std::ops::ControlFlow;

use super::{Neighbour, Partition, Ray, RayVisit};
use crate::volume::MinMax;

/// Coordinates of boxes are at most this: 2^320.
pub(super) const LIMIT: f64 = f64::from_bits((1023 + 320) << 52);

/// What places along a ray may be off by, of the sizes that they are sums of: far more than what they are, 2^-49.
const PLACES: f64 = 1.0 / (1_u64 << 40) as f64;

/// The squared distance from a point to a box. Every step is monotone, so that it is never more for a box that holds another.
#[inline]
pub(super) fn distance_squared(point: &[f64; 3], bounds: &MinMax) -> f64 {
    let (min, max) = (bounds.min(), bounds.max());
    let [x, y, z] = [0, 1, 2].map(|axis| (min[axis] - point[axis]).max(point[axis] - max[axis]).max(0.0));
    x * x + y * y + z * z
}

/// Whether these are coordinates of a point that can be near to something.
pub(super) fn in_range(point: &[f64; 3]) -> bool {
    point.iter().all(|x| x.abs() <= LIMIT)
}

/// The `count` least of these, in order.
#[derive(Debug)]
pub(super) struct Best {
    count: usize,
    /// A heap with the greatest on top.
    heap: std::collections::BinaryHeap<Ordered>,
}

#[derive(Debug)]
struct Ordered(Neighbour);

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.distance_squared.total_cmp(&other.0.distance_squared).then(self.0.key.cmp(&other.0.key))
    }
}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ordered {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ordered {}

impl Best {
    pub(super) fn new(count: usize) -> Self {
        Self { count, heap: std::collections::BinaryHeap::new() }
    }

    /// What is farther than this is of no interest; what is as far may be, by its key.
    #[inline]
    pub(super) fn limit(&self) -> f64 {
        match self.heap.peek() {
            Some(worst) if self.heap.len() == self.count => worst.0.distance_squared,
            _ => f64::INFINITY,
        }
    }

    #[inline]
    pub(super) fn offer(&mut self, key: u32, distance_squared: f64) {
        if self.count == 0 || distance_squared > self.limit() {
            return;
        }
        self.heap.push(Ordered(Neighbour { key, distance_squared }));
        if self.heap.len() > self.count {
            self.heap.pop();
        }
    }

    pub(super) fn into_sorted(self) -> Vec<Neighbour> {
        self.heap.into_sorted_vec().into_iter().map(|found| found.0).collect()
    }
}

/// How far apart boxes are, if they are spread evenly: the longest edge of the bounds over the cube root of their number.
fn spacing(bounds: &MinMax, len: usize) -> f64 {
    let extent = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
    extent / (len as f64).cbrt().max(1.0)
}

/// The nearest boxes, by cubes about the point that double until they hold enough.
pub(super) fn nearest<P: Partition + ?Sized>(partition: &P, point: [f64; 3], count: usize) -> Vec<Neighbour> {
    let Some(bounds) = partition.bounds().filter(|_| in_range(&point) && count > 0) else { return Vec::new() };
    let mut radius = distance_squared(&point, &bounds).sqrt() + spacing(&bounds, partition.len());
    loop {
        let low = point.map(|x| (x - radius).next_down().max(-LIMIT));
        let high = point.map(|x| (x + radius).next_up().min(LIMIT));
        let cube = MinMax::from_ordered(low, high);
        let mut best = Best::new(count);
        let _ = partition.overlapping(&cube, &mut |key| {
            if let Some(bounds) = partition.get(key) {
                best.offer(key, distance_squared(&point, &bounds));
            }
            ControlFlow::Continue(())
        });
        // What is outside is farther than the radius along some axis, also after rounding.
        if best.limit() < radius * radius || cube.encloses(&bounds) {
            return best.into_sorted();
        }
        radius = 2.0 * radius + f64::MIN_POSITIVE;
    }
}

/// Follows the ray in as many steps as there are boxes along an edge, if they are spread evenly, and asks for what meets
/// the box about each step. A box is visited in the step in which the ray enters it.
pub(super) fn ray<P: Partition + ?Sized>(partition: &P, ray: &Ray, visit: &mut dyn FnMut(RayVisit) -> f64) {
    let Some(bounds) = partition.bounds() else { return };
    let Some([enter, leave]) = ray.through(&bounds) else { return };
    let mut reach = ray.reach().min(leave + f64::MIN_POSITIVE);
    let steps = (partition.len() as f64).cbrt().ceil();
    let length = (reach - enter) / steps;
    let mut step = 0.0;
    while step < steps {
        let [start, end] = [step, step + 1.0].map(|steps| enter + length * steps);
        if start > reach {
            return;
        }
        let (first, last) = (step == 0.0, step + 1.0 == steps);
        let _ = partition.overlapping(&about(ray, start, end), &mut |key| {
            let Some(t) = partition.get(key).and_then(|bounds| ray.enters(&bounds)) else {
                return ControlFlow::Continue(());
            };
            if t <= reach && (first || t >= start) && (last || t < end) {
                reach = reach.min(visit(RayVisit { key, t, reach }));
            }
            if reach < 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        step += 1.0;
    }
}

/// A box about the ray from `start` to `end`, and about what a box that it enters there may be off by.
fn about(ray: &Ray, start: f64, end: f64) -> MinMax {
    let (origin, direction) = (ray.origin(), ray.direction());
    let place = |axis: usize, t: f64| origin[axis] + direction[axis] * t;
    let slack = |axis: usize| PLACES * (origin[axis].abs() + direction[axis].abs() * end) + f64::MIN_POSITIVE;
    let low = [0, 1, 2].map(|axis| (place(axis, start).min(place(axis, end)) - slack(axis)).clamp(-LIMIT, LIMIT));
    let high = [0, 1, 2].map(|axis| (place(axis, start).max(place(axis, end)) + slack(axis)).clamp(-LIMIT, LIMIT));
    MinMax::from_ordered(low, high)
}
