//! A top-down builder by surface area. It splits at the plane of least cost among all planes
//! between two neighboring centers, on any axis.
//!
//! Source: MacDonald, Booth, *Heuristics for ray tracing using space subdivision*, 1990. The boxes
//! are sorted once for each axis, and divided stably after that (Wald, Havran, *On building fast
//! kd-trees for ray tracing, and on doing that in O(N log N)*, RT 2006). The cost of a side is its
//! area times the number of leaves that it fills, as in `binned_sah.rs`.

use rayon::prelude::*;

use super::super::area::half_area;
use super::super::binary::BinaryTree;
use super::item::key;
use super::top_down::{self, Choice, Range};
use crate::volume::Aabb;

/// Builds the tree of these boxes; there must be at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let count = boxes.len();
    let mut orders: [Vec<u32>; 3] = std::array::from_fn(|axis| {
        let mut keys: Vec<u64> =
            boxes.par_iter().enumerate().map(|(at, bounds)| key(twice_center(bounds, axis), at as u32)).collect();
        keys.par_sort_unstable();
        keys.into_iter().map(|key| key as u32).collect()
    });
    let (mut aside, mut above) = (vec![0; count], vec![0.0; count]);
    let [x, y, z] = &mut orders;
    let sorted = Sorted { boxes, capacity, orders: [x, y, z], aside: &mut aside, above: &mut above };
    let nodes = top_down::nodes(sorted, capacity);
    let [order, ..] = orders;
    BinaryTree { nodes, order: order.into() }
}

/// Returns twice the center of a box on an axis.
#[inline(always)]
fn twice_center(bounds: &Aabb, axis: usize) -> f32 {
    bounds.min[axis] + bounds.max[axis]
}

/// The same boxes in the order of their centers on each axis, and scratch memory.
struct Sorted<'a> {
    boxes: &'a [Aabb],
    capacity: usize,
    orders: [&'a mut [u32]; 3],
    aside: &'a mut [u32],
    above: &'a mut [f64],
}

impl Range for Sorted<'_> {
    fn len(&self) -> usize {
        self.aside.len()
    }

    fn bounds(&self) -> Aabb {
        self.orders[0].iter().fold(Aabb::EMPTY, |bounds, &index| bounds.union(self.boxes[index as usize]))
    }

    fn split(mut self, choice: Choice) -> (Self, Self) {
        let chosen = match choice {
            Choice::Builder => self.cheapest(),
            Choice::Halves => None,
        };
        let (axis, middle) = chosen.unwrap_or_else(|| (self.widest(), top_down::middle(self.len(), self.capacity)));
        self.divide(axis, middle);

        let [(x0, x1), (y0, y1), (z0, z1)] = self.orders.map(|order| order.split_at_mut(middle));
        let (aside0, aside1) = self.aside.split_at_mut(middle);
        let (above0, above1) = self.above.split_at_mut(middle);
        let (boxes, capacity) = (self.boxes, self.capacity);
        (
            Self { boxes, capacity, orders: [x0, y0, z0], aside: aside0, above: above0 },
            Self { boxes, capacity, orders: [x1, y1, z1], aside: aside1, above: above1 },
        )
    }
}

impl Sorted<'_> {
    /// Returns the axis and the number of boxes below the plane of least cost, or `None` if all
    /// costs are infinite or NaN.
    fn cheapest(&mut self) -> Option<(usize, usize)> {
        let count = self.len();
        let mut best = None;
        // Among planes of equal cost, as all are if the boxes are equal, choose the one nearest to
        // the middle.
        let mut least = (f64::INFINITY, usize::MAX);
        for axis in 0..3 {
            let order = &*self.orders[axis];
            let mut bounds = Aabb::EMPTY;
            for at in (1..count).rev() {
                bounds = bounds.union(self.boxes[order[at] as usize]);
                self.above[at] = half_area(&bounds);
            }
            let mut bounds = Aabb::EMPTY;
            for at in 1..count {
                bounds = bounds.union(self.boxes[order[at - 1] as usize]);
                let cost = half_area(&bounds) * top_down::leaves(at, self.capacity)
                    + self.above[at] * top_down::leaves(count - at, self.capacity);
                let off_middle = (2 * at).abs_diff(count);
                if cost < least.0 || cost == least.0 && off_middle < least.1 {
                    least = (cost, off_middle);
                    best = Some((axis, at));
                }
            }
        }
        best
    }

    fn widest(&self) -> usize {
        let extent = |axis: usize| {
            let order = &*self.orders[axis];
            let at = |index: u32| f64::from(twice_center(&self.boxes[index as usize], axis));
            at(order[order.len() - 1]) - at(order[0])
        };
        (1..3).fold(0, |widest, axis| if extent(axis) > extent(widest) { axis } else { widest })
    }

    /// Divides the orders of the two other axes like the order of `axis`: its first `middle` boxes
    /// come first. The parts stay sorted.
    fn divide(&mut self, axis: usize, middle: usize) {
        let rank = |index: u32| key(twice_center(&self.boxes[index as usize], axis), index);
        let pivot = rank(self.orders[axis][middle]);
        for other in (0..3).filter(|&other| other != axis) {
            let order = &mut *self.orders[other];
            let (mut low, mut high) = (0, 0);
            for at in 0..order.len() {
                let index = order[at];
                if rank(index) < pivot {
                    order[low] = index;
                    low += 1;
                } else {
                    self.aside[high] = index;
                    high += 1;
                }
            }
            order[low..].copy_from_slice(&self.aside[..high]);
        }
    }
}
