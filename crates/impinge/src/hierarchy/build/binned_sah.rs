//! A top-down builder by surface area. It groups centers into bins along each axis, and splits at
//! the plane of least cost among those between bins.
//!
//! Source: Wald, *On fast construction of SAH-based bounding volume hierarchies*, RT 2007. Ours
//! multiplies the area of a side by the number of leaves that its boxes fill, not by the number of
//! boxes, because the boxes of a leaf are processed together. So leaves are full.

use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayon::prelude::*;

use super::super::binary::BinaryTree;
use super::bins::{Bins, Grid, Plane};
use super::item::{Item, Reach, bounds, order, point, twice_center_bounds};
use super::median::halves;
use super::top_down::{self, Choice, Range};
use crate::simd::{best_level, dispatch, outlined};
use crate::volume::Aabb;

/// Maximum length of a range that one thread bins. Longer ranges are binned by several threads.
const MAX_SERIAL_BINNING: usize = 1 << 15;

/// Builds the tree of these boxes; there must be at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let mut items = Item::all(boxes);
    let twice_centers = twice_center_bounds(&items);
    let nodes = top_down::nodes(Binned { items: &mut items, twice_centers, capacity }, capacity);
    BinaryTree { nodes, order: order(&items).into() }
}

struct Binned<'a> {
    items: &'a mut [Item],
    /// The box of twice the centers of the items.
    twice_centers: Aabb,
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
        let Self { items, twice_centers, capacity } = self;
        let chosen = match choice {
            Choice::Builder => {
                dispatch!(best_level(), simd => split_at_cheapest(simd, items, &twice_centers, capacity))
            }
            Choice::Halves => None,
        };
        let (middle, [below, above]) = chosen.unwrap_or_else(|| {
            let middle = halves(items, &twice_centers, capacity);
            let (low, high) = items.split_at(middle);
            (middle, [low, high].map(twice_center_bounds))
        });
        let (low, high) = items.split_at_mut(middle);
        let side = |items, twice_centers| Self { items, twice_centers, capacity };
        (side(low, below), side(high, above))
    }
}

/// Rearranges the items around the plane of least cost. Returns the number of items below it, and
/// the boxes of twice the centers on either side. Returns `None` if there is no such plane.
#[inline(always)]
fn split_at_cheapest<S: Simd>(
    simd: S,
    items: &mut [Item],
    twice_centers: &Aabb,
    capacity: usize,
) -> Option<(usize, [Aabb; 2])> {
    let grid = Grid::over(twice_centers);
    let plane = all_bins(simd, items, &grid).cheapest(simd, capacity)?;
    Some(split_at_plane(simd, items, &grid, plane))
}

/// Sorts the items into bins, on all cores if the range is long.
#[inline(always)]
fn all_bins<S: Simd>(simd: S, items: &[Item], grid: &Grid) -> Bins {
    // Each chunk runs in a function of its own, because a task on another thread loses the caller's
    // vector unit.
    let bin_chunk = |items: &[Item]| {
        outlined(
            simd,
            #[inline(always)]
            || Bins::of(simd, items, grid),
        )
    };
    if items.len() <= MAX_SERIAL_BINNING {
        return bin_chunk(items);
    }
    // The order of merging does not matter: unions and counts do not depend on it.
    let binned = items.par_chunks(MAX_SERIAL_BINNING).map(bin_chunk);
    binned.reduce_with(Bins::merged).unwrap_or_else(|| bin_chunk(items))
}

/// Rearranges the items around a plane. There is no branch on the side, because it is
/// unpredictable.
#[inline(always)]
fn split_at_plane<S: Simd>(simd: S, items: &mut [Item], grid: &Grid, plane: Plane) -> (usize, [Aabb; 2]) {
    let nothing = Reach::NOTHING.lanes(simd);
    let (mut below, mut above) = (nothing, nothing);
    let mut middle = 0;
    for at in 0..items.len() {
        let item = &items[at];
        let (reach, is_above) = (point(item.twice_centers(simd)), grid.is_above(simd, item, plane));
        below = below.max(is_above.select(nothing, reach));
        above = above.max(is_above.select(reach, nothing));
        items.swap(at, middle);
        middle += 1 - (is_above.to_bitmask() & 1) as usize;
    }
    (middle, [Reach::of(below).aabb(), Reach::of(above).aabb()])
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::super::bins::tests::some_boxes;
    use super::*;
    use crate::simd::dispatch_every;
    use crate::simd::kernel_levels;

    /// The items before the middle are below the plane and the others above it, no item is lost,
    /// and the boxes are those of the centers.
    #[test]
    fn parts_are_the_two_sides_of_the_plane() {
        let mut rng = Rng::new(403);
        let mut parted = 0;
        for round in 0..200 {
            let boxes = some_boxes(&mut rng, round % 4);
            let items = Item::all(&boxes);
            let grid = Grid::over(&twice_center_bounds(&items));
            for (name, level) in kernel_levels() {
                let mut items = items.clone();
                let Some((plane, (middle, twice_centers))) = dispatch_every!(level, simd => {
                    let plane = Bins::of(simd, &items, &grid).cheapest(simd, 2);
                    plane.map(|plane| (plane, split_at_plane(simd, &mut items, &grid, plane)))
                }) else {
                    continue;
                };
                parted += 1;
                let (below, above) = items.split_at(middle);
                let is_above =
                    |item: &Item| dispatch_every!(level, simd => grid.is_above(simd, item, plane).to_bitmask()) > 0;
                assert!(!below.is_empty() && !below.iter().any(is_above), "{name}: {plane:?}");
                assert!(!above.is_empty() && above.iter().all(is_above), "{name}: {plane:?}");
                assert_eq!(twice_centers, [below, above].map(twice_center_bounds), "{name}: {plane:?}");
                let mut order = order(&items);
                order.sort_unstable();
                assert!(order.into_iter().eq(0..boxes.len() as u32), "{name}: {plane:?}");
            }
        }
        assert!(parted > 100 * kernel_levels().len(), "{parted} were split");
    }

    #[test]
    fn binning_does_not_depend_on_the_number_of_threads() {
        let mut rng = Rng::new(404);
        let boxes: Vec<Aabb> = (0..3 * MAX_SERIAL_BINNING + 5)
            .map(|_| {
                let mut corner = || [0; 3].map(|_| rng.uniform(0.0, 1.0).powi(3) as f32);
                Aabb::of_points([corner(), corner()])
            })
            .collect();
        let items = Item::all(&boxes);
        let grid = Grid::over(&twice_center_bounds(&items));
        let (together, alone) = dispatch_every!(best_level(), simd => {
            (all_bins(simd, &items, &grid).cheapest(simd, 8), Bins::of(simd, &items, &grid).cheapest(simd, 8))
        });
        assert!(together == alone && together.is_some(), "{together:?} and {alone:?}");
        let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        assert!(
            on(1).install(|| build(&boxes, 8)) == on(3).install(|| build(&boxes, 8)),
            "the number of threads changes the result"
        );
    }
}
