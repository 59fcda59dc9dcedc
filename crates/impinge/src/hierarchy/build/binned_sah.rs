//! Top-down by surface area, at the cheapest of a few planes: centres are dealt into bins along each axis, and only the
//! planes between bins are priced.
//!
//! Source: Wald, *On fast construction of SAH-based bounding volume hierarchies*, RT 2007. Ours prices a side by the
//! leaves that its boxes fill and not by the boxes, since the boxes of a leaf are met all at once: leaves come out full.

use rayon::prelude::*;

use super::super::area::half_area;
use super::super::binary::BinaryTree;
use super::median::{Item, bounds, centre_bounds, halves, items, order};
use super::top_down::{self, Choice, Range};
use crate::volume::Aabb;

/// Bins on each axis: with 32, trees are a few thousandths cheaper and take half as long again to build.
const BINS: usize = 16;

/// Ranges longer than this are dealt out by several threads.
const DEAL_TOGETHER: usize = 1 << 15;

/// The tree of these boxes, of which there is at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let mut items = items(boxes);
    let nodes = top_down::nodes(Binned { items: &mut items, capacity }, capacity);
    BinaryTree { nodes, order: order(&items).into() }
}

struct Binned<'a> {
    items: &'a mut [Item],
    capacity: usize,
}

impl Range for Binned<'_> {
    fn len(&self) -> usize {
        self.items.len()
    }

    fn bounds(&self) -> Aabb {
        bounds(self.items)
    }

    fn split(self, choice: Choice) -> (Self, Self) {
        let centres = together(self.items, centre_bounds, Aabb::union);
        let chosen = match choice {
            Choice::Builder => Grid::over(&centres).divide(self.items, self.capacity),
            Choice::Halves => None,
        };
        let middle = chosen.unwrap_or_else(|| halves(self.items, &centres, self.capacity));
        let (low, high) = self.items.split_at_mut(middle);
        (Self { items: low, ..self }, Self { items: high, capacity: self.capacity })
    }
}

/// Folds chunks on all cores where it pays. `join` must not depend on the order, as unions and counts do not.
fn together<T: Send>(items: &[Item], fold: impl Fn(&[Item]) -> T + Sync, join: impl Fn(T, T) -> T + Sync) -> T {
    if items.len() <= DEAL_TOGETHER {
        return fold(items);
    }
    let (low, high) = items.split_at(items.len() / 2);
    let (low, high) = rayon::join(|| together_again(low, &fold, &join), || together_again(high, &fold, &join));
    join(low, high)
}

fn together_again<T: Send>(
    items: &[Item],
    fold: &(impl Fn(&[Item]) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    let parts = items.par_chunks(DEAL_TOGETHER).map(fold);
    parts.reduce_with(join).unwrap_or_else(|| fold(items))
}

/// What one bin holds.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

type Bins = [[Bin; BINS]; 3];

/// The bins' places.
struct Grid {
    origin: [f32; 3],
    scale: [f32; 3],
}

impl Grid {
    fn over(centres: &Aabb) -> Self {
        let scale = std::array::from_fn(|axis| {
            let half = 0.5 * centres.max[axis] - 0.5 * centres.min[axis];
            if half > 0.0 { (0.5 * BINS as f32) / half } else { 0.0 }
        });
        Self { origin: centres.min, scale }
    }

    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        // A float cast saturates, and takes NaN to zero: any bin is a legal one.
        (((item.centre(axis) - self.origin[axis]) * self.scale[axis]) as usize).min(BINS - 1)
    }

    /// Rearranges the items about the cheapest plane; none where no plane has boxes on either side.
    fn divide(&self, items: &mut [Item], capacity: usize) -> Option<usize> {
        let bins = together(items, |items| self.deal(items), merge);
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in 0..3 {
            for (plane, cost) in prices(&bins[axis], items.len(), capacity) {
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, plane));
                }
            }
        }
        let (_, axis, plane) = best?;
        let mut middle = 0;
        for at in 0..items.len() {
            if self.bin(&items[at], axis) < plane {
                items.swap(at, middle);
                middle += 1;
            }
        }
        Some(middle)
    }

    fn deal(&self, items: &[Item]) -> Bins {
        let mut bins = [[Bin { bounds: Aabb::EMPTY, count: 0 }; BINS]; 3];
        for item in items {
            for axis in 0..3 {
                let bin = &mut bins[axis][self.bin(item, axis)];
                bin.bounds = bin.bounds.union(item.bounds);
                bin.count += 1;
            }
        }
        bins
    }
}

fn merge(a: Bins, b: Bins) -> Bins {
    std::array::from_fn(|axis| {
        std::array::from_fn(|bin| {
            let (a, b) = (a[axis][bin], b[axis][bin]);
            Bin { bounds: a.bounds.union(b.bounds), count: a.count + b.count }
        })
    })
}

/// The planes below bins 1, 2, ... with boxes on either side, and what splitting there costs.
fn prices(bins: &[Bin; BINS], count: usize, capacity: usize) -> impl Iterator<Item = (usize, f64)> {
    let mut above = [0.0; BINS];
    let mut bounds = Aabb::EMPTY;
    for plane in (1..BINS).rev() {
        bounds = bounds.union(bins[plane].bounds);
        above[plane] = half_area(&bounds);
    }
    let mut below = Bin { bounds: Aabb::EMPTY, count: 0 };
    (1..BINS).filter_map(move |plane| {
        let bin = &bins[plane - 1];
        below = Bin { bounds: below.bounds.union(bin.bounds), count: below.count + bin.count };
        let rest = count - below.count;
        (below.count > 0 && rest > 0).then(|| {
            let low = half_area(&below.bounds) * top_down::leaves(below.count, capacity);
            (plane, low + above[plane] * top_down::leaves(rest, capacity))
        })
    })
}
