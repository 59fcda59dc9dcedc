//! The boxes nearest to a point, and their distances.

use super::neighbor::Neighbor;
use crate::volume::MinMax;

/// Largest magnitude of a coordinate of a valid box: 2^320.
pub(super) const LIMIT: f64 = f64::from_bits((1023 + 320) << 52);

/// Returns the squared distance from a point to a box, zero inside. Every operation is monotone, so
/// the result for a box is never larger than the result for a box inside it.
#[inline]
pub(super) fn distance_squared(point: &[f64; 3], bounds: &MinMax) -> f64 {
    let (min, max) = (bounds.min(), bounds.max());
    let [x, y, z] = [0, 1, 2].map(|axis| (min[axis] - point[axis]).max(point[axis] - max[axis]).max(0.0));
    x * x + y * y + z * z
}

/// Reports whether all coordinates of the point are finite and at most [`LIMIT`] in magnitude.
pub(super) fn in_range(point: &[f64; 3]) -> bool {
    point.iter().all(|x| x.abs() <= LIMIT)
}

/// The `count` nearest boxes offered so far.
#[derive(Debug)]
pub(super) struct Best {
    count: usize,
    /// Heap with the farthest box on top.
    heap: std::collections::BinaryHeap<Ordered>,
}

#[derive(Debug)]
struct Ordered(Neighbor);

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

    /// Returns the squared distance beyond which boxes are rejected. A box at exactly this distance
    /// may still enter, depending on its key.
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
        self.heap.push(Ordered(Neighbor { key, distance_squared }));
        if self.heap.len() > self.count {
            self.heap.pop();
        }
    }

    /// Like [`offer`](Self::offer), for a box that may have been offered before.
    #[inline]
    pub(super) fn offer_once(&mut self, key: u32, distance_squared: f64) {
        if distance_squared <= self.limit() && self.heap.iter().all(|found| found.0.key != key) {
            self.offer(key, distance_squared);
        }
    }

    pub(super) fn into_sorted(self) -> Vec<Neighbor> {
        self.heap.into_sorted_vec().into_iter().map(|found| found.0).collect()
    }
}
