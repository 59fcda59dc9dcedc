//! Top-down by surface area, at the cheapest of a few planes: centres are dealt into bins along each axis, and only the
//! planes between bins are priced.
//!
//! Source: Wald, *On fast construction of SAH-based bounding volume hierarchies*, RT 2007. Ours prices a side by the
//! leaves that its boxes fill and not by the boxes, since the boxes of a leaf are met all at once: leaves come out full.

use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayon::prelude::*;

use super::super::binary::BinaryTree;
use super::bins::{Bins, Grid, Plane};
use super::item::{Item, Reach, bounds, order, point, twice_centre_bounds};
use super::median::halves;
use super::top_down::{self, Choice, Range};
use crate::simd::{best_level, dispatch, outlined};
use crate::volume::Aabb;

/// Ranges longer than this are dealt out by several threads.
const DEAL_TOGETHER: usize = 1 << 15;

/// The tree of these boxes, of which there is at least one.
pub(super) fn build(boxes: &[Aabb], capacity: usize) -> BinaryTree {
    let mut items = Item::all(boxes);
    let twice_centres = twice_centre_bounds(&items);
    let nodes = top_down::nodes(Binned { items: &mut items, twice_centres, capacity }, capacity);
    BinaryTree { nodes, order: order(&items).into() }
}

struct Binned<'a> {
    items: &'a mut [Item],
    /// The box of twice their centres.
    twice_centres: Aabb,
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
        let Self { items, twice_centres, capacity } = self;
        let chosen = match choice {
            Choice::Builder => dispatch!(best_level(), simd => part(simd, items, &twice_centres, capacity)),
            Choice::Halves => None,
        };
        let (middle, [below, above]) = chosen.unwrap_or_else(|| {
            let middle = halves(items, &twice_centres, capacity);
            let (low, high) = items.split_at(middle);
            (middle, [low, high].map(twice_centre_bounds))
        });
        let (low, high) = items.split_at_mut(middle);
        let side = |items, twice_centres| Self { items, twice_centres, capacity };
        (side(low, below), side(high, above))
    }
}

/// Rearranges the items about the cheapest plane: how many come before it, and the boxes of twice the centres on either side. None
/// where there is no such plane.
#[inline(always)]
fn part<S: Simd>(simd: S, items: &mut [Item], twice_centres: &Aabb, capacity: usize) -> Option<(usize, [Aabb; 2])> {
    let grid = Grid::over(twice_centres);
    let plane = deal(simd, items, &grid).cheapest(simd, capacity)?;
    Some(part_at(simd, items, &grid, plane))
}

/// On all cores where it pays.
#[inline(always)]
fn deal<S: Simd>(simd: S, items: &[Item], grid: &Grid) -> Bins {
    // Of its own, as what another thread calls has none of the vector unit of who sent it there.
    let deal_chunk = |items: &[Item]| {
        outlined(
            simd,
            #[inline(always)]
            || Bins::of(simd, items, grid),
        )
    };
    if items.len() <= DEAL_TOGETHER {
        return deal_chunk(items);
    }
    // Merged in any order, on which neither unions nor counts depend.
    let dealt = items.par_chunks(DEAL_TOGETHER).map(deal_chunk);
    dealt.reduce_with(Bins::merged).unwrap_or_else(|| deal_chunk(items))
}

/// Without a branch that depends on the side, as nobody foresees it.
#[inline(always)]
fn part_at<S: Simd>(simd: S, items: &mut [Item], grid: &Grid, plane: Plane) -> (usize, [Aabb; 2]) {
    let nothing = Reach::NOTHING.lanes(simd);
    let (mut below, mut above) = (nothing, nothing);
    let mut middle = 0;
    for at in 0..items.len() {
        let item = &items[at];
        let (reach, is_above) = (point(item.twice_centres(simd)), grid.is_above(simd, item, plane));
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

    /// What comes before the middle is below the plane, and all else above; nothing is lost; and the boxes are those of the centres.
    #[test]
    fn parts_are_the_sides_of_the_plane() {
        let mut rng = Rng::new(403);
        let mut parted = 0;
        for round in 0..200 {
            let boxes = some_boxes(&mut rng, round % 4);
            let items = Item::all(&boxes);
            let grid = Grid::over(&twice_centre_bounds(&items));
            for (name, level) in kernel_levels() {
                let mut items = items.clone();
                let Some((plane, (middle, twice_centres))) = dispatch_every!(level, simd => {
                    let plane = Bins::of(simd, &items, &grid).cheapest(simd, 2);
                    plane.map(|plane| (plane, part_at(simd, &mut items, &grid, plane)))
                }) else {
                    continue;
                };
                parted += 1;
                let (below, above) = items.split_at(middle);
                let is_above =
                    |item: &Item| dispatch_every!(level, simd => grid.is_above(simd, item, plane).to_bitmask()) > 0;
                assert!(!below.is_empty() && !below.iter().any(is_above), "{name}: {plane:?}");
                assert!(!above.is_empty() && above.iter().all(is_above), "{name}: {plane:?}");
                assert_eq!(twice_centres, [below, above].map(twice_centre_bounds), "{name}: {plane:?}");
                let mut order = order(&items);
                order.sort_unstable();
                assert!(order.into_iter().eq(0..boxes.len() as u32), "{name}: {plane:?}");
            }
        }
        assert!(parted > 100 * kernel_levels().len(), "{parted} were parted");
    }

    #[test]
    fn what_several_threads_deal_is_what_one_deals() {
        let mut rng = Rng::new(404);
        let boxes: Vec<Aabb> = (0..3 * DEAL_TOGETHER + 5)
            .map(|_| {
                let mut corner = || [0; 3].map(|_| rng.uniform(0.0, 1.0).powi(3) as f32);
                Aabb::of_points([corner(), corner()])
            })
            .collect();
        let items = Item::all(&boxes);
        let grid = Grid::over(&twice_centre_bounds(&items));
        let (together, alone) = dispatch_every!(best_level(), simd => {
            (deal(simd, &items, &grid).cheapest(simd, 8), Bins::of(simd, &items, &grid).cheapest(simd, 8))
        });
        assert!(together == alone && together.is_some(), "{together:?} and {alone:?}");
        let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        assert!(on(1).install(|| build(&boxes, 8)) == on(3).install(|| build(&boxes, 8)), "threads show");
    }
}
