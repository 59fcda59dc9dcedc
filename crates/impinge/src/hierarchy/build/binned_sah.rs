//! Top-down by surface area, at the cheapest of a few planes: centres are dealt into bins along each axis, and only the
//! planes between bins are priced.
//!
//! Source: Wald, *On fast construction of SAH-based bounding volume hierarchies*, RT 2007. Ours prices a side by the
//! leaves that its boxes fill and not by the boxes, since the boxes of a leaf are met all at once: leaves come out full.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::super::binary::BinaryTree;
use super::bins::{Bins, Grid, Plane};
use super::item::{Item, Reach, order, point};
use super::median::{bounds, centre_bounds, halves};
use super::top_down::{self, Choice, Range};
use crate::simd::{best_level, outlined};
use crate::volume::Aabb;

/// Ranges longer than this are dealt out by several threads.
const DEAL_TOGETHER: usize = 1 << 15;

/// The tree of these boxes, of which there is at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let mut items = Item::all(boxes);
    let centres = centre_bounds(&items);
    let nodes = top_down::nodes(Binned { items: &mut items, centres, capacity }, capacity);
    BinaryTree { nodes, order: order(&items).into() }
}

struct Binned<'a> {
    items: &'a mut [Item],
    /// The box of their centres.
    centres: Aabb,
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
        let Self { items, centres, capacity } = self;
        let chosen = match choice {
            Choice::Builder => dispatch!(best_level(), simd => part(simd, items, &centres, capacity)),
            Choice::Halves => None,
        };
        let (middle, centres) = chosen.unwrap_or_else(|| {
            let middle = halves(items, &centres, capacity);
            let (low, high) = items.split_at(middle);
            (middle, [centre_bounds(low), centre_bounds(high)])
        });
        let (low, high) = items.split_at_mut(middle);
        (Self { items: low, centres: centres[0], capacity }, Self { items: high, centres: centres[1], capacity })
    }
}

/// Rearranges the items about the cheapest plane: how many come before it, and the boxes of the centres on either side. None where no
/// plane has boxes on either side.
#[inline(always)]
fn part<S: Simd>(simd: S, items: &mut [Item], centres: &Aabb, capacity: usize) -> Option<(usize, [Aabb; 2])> {
    let grid = Grid::over(centres);
    let plane = deal(simd, items, &grid).cheapest(simd, capacity)?;
    Some(part_at(simd, items, &grid, plane))
}

/// On all cores where it pays.
#[inline(always)]
fn deal<S: Simd>(simd: S, items: &[Item], grid: &Grid) -> Bins {
    let deal = |items: &[Item]| {
        outlined(
            simd,
            #[inline(always)]
            || Bins::of(simd, items, grid),
        )
    };
    if items.len() <= DEAL_TOGETHER {
        return deal(items);
    }
    let dealt = items.par_chunks(DEAL_TOGETHER).map(deal);
    dealt.reduce_with(Bins::merged).unwrap_or_else(|| deal(items))
}

/// Without a branch that depends on the side, as nobody foresees it.
#[inline(always)]
fn part_at<S: Simd>(simd: S, items: &mut [Item], grid: &Grid, plane: Plane) -> (usize, [Aabb; 2]) {
    let nothing = Reach::NOTHING.lanes(simd);
    let (mut below, mut above) = (nothing, nothing);
    let mut middle = 0;
    for at in 0..items.len() {
        let item = &items[at];
        let (reach, is_above) = (point(item.centres(simd)), grid.is_above(simd, item, plane));
        below = below.max(is_above.select(nothing, reach));
        above = above.max(is_above.select(reach, nothing));
        items.swap(at, middle);
        middle += 1 - (is_above.to_bitmask() & 1) as usize;
    }
    (middle, [Reach::of(below).aabb(), Reach::of(above).aabb()])
}
