//! Bins: boxes grouped along each axis by their centers, and the costs of planes between two bins.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, f32x8, f64x4, i32x4, mask32x8};

use super::item::{Item, Reach};
use crate::simd::{LANES, by_axis, transposed};
use crate::volume::Aabb;

/// Number of bins on each axis. With 32, trees cost a few tenths of a percent less and take 1.5
/// times as long to build.
const BINS: usize = 16;

/// The placement of the bins, in coordinates of twice the centers.
pub(super) struct Grid {
    origin: [f32; 4],
    scale: [f32; 4],
}

/// A plane below bin `bin` of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plane {
    axis: usize,
    bin: usize,
}

impl Grid {
    /// Builds the grid over the box of twice the centers.
    pub(super) fn over(twice_centers: &Aabb) -> Self {
        let (mut origin, mut scale) = ([0.0; 4], [0.0; 4]);
        for axis in 0..3 {
            let extent = twice_centers.max[axis] - twice_centers.min[axis];
            origin[axis] = twice_centers.min[axis];
            scale[axis] = if extent > 0.0 { BINS as f32 / extent } else { 0.0 };
        }
        Self { origin, scale }
    }

    /// Returns the bin of a box on each axis.
    #[inline(always)]
    fn bins<S: Simd>(&self, simd: S, item: &Item) -> [usize; 3] {
        let along =
            (item.twice_centers(simd) - f32x4::from_slice(simd, &self.origin)) * f32x4::from_slice(simd, &self.scale);
        // NaN goes to the first bin; any bin is valid.
        let zero = f32x4::splat(simd, 0.0);
        let inside = along.simd_gt(zero).select(along, zero).min((BINS - 1) as f32);
        let bins: [i32; 4] = inside.to_int::<i32x4<S>>().into();
        by_axis!(axis => bins[axis] as usize % BINS)
    }

    /// Reports, in all lanes, whether a box is above a plane. The result agrees with
    /// [`bins`](Self::bins).
    #[inline(always)]
    pub(super) fn is_above<S: Simd>(&self, simd: S, item: &Item, Plane { axis, bin }: Plane) -> mask32x8<S> {
        let along = (f32x8::splat(simd, item.twice_center(axis)) - self.origin[axis]) * self.scale[axis];
        along.simd_ge(bin as f32)
    }
}

/// The content of each bin of each axis.
pub(super) struct Bins {
    reach: [[Reach; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    /// Sorts boxes into bins.
    #[inline(always)]
    pub(super) fn of<S: Simd>(simd: S, items: &[Item], grid: &Grid) -> Self {
        let mut bins = Self { reach: [[Reach::NOTHING; BINS]; 3], counts: [[0; BINS]; 3] };
        // From four places in turn: neighbors are often in one bin, and each update of a bin waits
        // for the last.
        let quarter = items.len() / 4;
        for at in 0..quarter {
            for first in [0, quarter, 2 * quarter, 3 * quarter] {
                bins.put(simd, &items[first + at], grid);
            }
        }
        for item in &items[4 * quarter..] {
            bins.put(simd, item, grid);
        }
        bins
    }

    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, item: &Item, grid: &Grid) {
        let (lanes, at) = (item.lanes(simd), grid.bins(simd, item));
        for axis in 0..3 {
            self.reach[axis][at[axis]].take_in(simd, lanes);
            self.counts[axis][at[axis]] += 1;
        }
    }

    /// Returns the bins of both sets of boxes together.
    pub(super) fn merged(mut self, other: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.reach[axis][bin] = self.reach[axis][bin].union(other.reach[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// Returns the plane of least cost for leaves of at most `capacity` boxes; among equals it is
    /// the first. Returns `None` if every plane has all boxes on one side, or a cost that is
    /// infinite or NaN.
    #[inline(always)]
    pub(super) fn cheapest<S: Simd>(&self, simd: S, capacity: usize) -> Option<Plane> {
        let (mut least, mut cheapest) = (f64::INFINITY, None);
        for axis in 0..3 {
            let costs = self.costs(simd, axis, capacity);
            for bin in 1..BINS {
                if costs[bin] < least {
                    (least, cheapest) = (costs[bin], Some(Plane { axis, bin }));
                }
            }
        }
        cheapest
    }

    /// Returns the cost of the plane below each bin. It is infinite if all boxes are on one side.
    #[inline(always)]
    fn costs<S: Simd>(&self, simd: S, axis: usize, capacity: usize) -> [f64; BINS] {
        let (reach, counts) = (&self.reach[axis], &self.counts[axis]);
        let mut below = Sides::NOTHING;
        for bin in 1..BINS {
            let before = below.reach[bin - 1].lanes(simd).max(reach[bin - 1].lanes(simd));
            below.reach[bin] = Reach::of(before);
            below.counts[bin] = below.counts[bin - 1] + counts[bin - 1];
        }
        let mut above = Sides::NOTHING;
        let mut after = (Reach::NOTHING.lanes(simd), 0);
        for bin in (0..BINS).rev() {
            after = (after.0.max(reach[bin].lanes(simd)), after.1 + counts[bin]);
            above.reach[bin] = Reach::of(after.0);
            above.counts[bin] = after.1;
        }
        let (below, above) = (below.costs(simd, capacity), above.costs(simd, capacity));
        std::array::from_fn(|bin| below[bin] + above[bin])
    }
}

/// The boxes on one side of each plane.
struct Sides {
    reach: [Reach; BINS],
    counts: [u32; BINS],
}

impl Sides {
    const NOTHING: Self = Self { reach: [Reach::NOTHING; BINS], counts: [0; BINS] };

    /// Returns the cost of each side: half its surface area times the number of leaves that it
    /// fills. It is infinite if the side is empty.
    #[inline(always)]
    fn costs<S: Simd>(&self, simd: S, capacity: usize) -> [f64; BINS] {
        let mut costs = [f64::INFINITY; BINS];
        for first in [0, LANES] {
            let areas = half_areas(simd, &self.reach[first..][..LANES]);
            for (first, area) in [first, first + 4].into_iter().zip(areas) {
                let [a, b, c, d] = [0, 1, 2, 3].map(|lane| f64::from(self.counts[first + lane]));
                let counts = f64x4::from_slice(simd, &[a, b, c, d]);
                // Exact: a quotient that is not an integer is farther from every integer than its
                // rounding error.
                let leaves = (counts / f64x4::splat(simd, capacity as f64)).ceil();
                let is_any = counts.simd_gt(f64x4::splat(simd, 0.0));
                let cost = is_any.select(area * leaves, f64x4::splat(simd, f64::INFINITY));
                cost.store_slice(&mut costs[first..][..4]);
            }
        }
        costs
    }
}

/// Returns half the surface areas of eight boxes, as [`half_area`](super::super::area::half_area)
/// computes them.
#[inline(always)]
fn half_areas<S: Simd>(simd: S, reach: &[Reach]) -> [f64x4<S>; 2] {
    let [a, b, c, d, e, f, g, h] = std::array::from_fn(
        #[inline(always)]
        |at| reach[at].lanes(simd).split(),
    );
    let max = transposed([a.0, b.0, c.0, d.0], [e.0, f.0, g.0, h.0]);
    let negated_min = transposed([a.1, b.1, c.1, d.1], [e.1, f.1, g.1, h.1]);
    let [x, y, z]: [[f64x4<S>; 2]; 3] = by_axis!(axis => extents(max[axis], negated_min[axis]));
    [x[0] * y[0] + y[0] * z[0] + z[0] * x[0], x[1] * y[1] + y[1] * z[1] + z[1] * x[1]]
}

#[inline(always)]
fn extents<S: Simd>(max: f32x8<S>, negated_min: f32x8<S>) -> [f64x4<S>; 2] {
    let (max, negated_min) = (max.widen(), negated_min.widen());
    [max.0 + negated_min.0, max.1 + negated_min.1]
}

#[cfg(test)]
pub(super) mod tests {
    use crate::simd::dispatch_every;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::hierarchy::area::half_area;
    use crate::hierarchy::build::item::twice_center_bounds;
    use crate::hierarchy::build::top_down::leaves;
    use crate::simd::kernel_levels;

    /// Returns the bin of a box along an axis, computed one operation at a time.
    fn plain_bin(bounds: &Aabb, twice_centers: &Aabb, axis: usize) -> usize {
        let extent = twice_centers.max[axis] - twice_centers.min[axis];
        let scale = if extent > 0.0 { BINS as f32 / extent } else { 0.0 };
        let twice_center = bounds.min[axis] + bounds.max[axis];
        // A float cast saturates, and takes NaN to zero.
        (((twice_center - twice_centers.min[axis]) * scale) as usize).min(BINS - 1)
    }

    /// Returns the first of the planes of least cost. Each cost is computed from all boxes.
    fn plain_cheapest(boxes: &[Aabb], twice_centers: &Aabb, capacity: usize) -> Option<Plane> {
        let mut cheapest: Option<(f64, Plane)> = None;
        for (axis, bin) in (0..3).flat_map(|axis| (1..BINS).map(move |bin| (axis, bin))) {
            let is_below = |bounds: &&Aabb| plain_bin(bounds, twice_centers, axis) < bin;
            let (below, above): (Vec<&Aabb>, Vec<&Aabb>) = boxes.iter().partition(is_below);
            if below.is_empty() || above.is_empty() {
                continue;
            }
            let cost = |side: &[&Aabb]| {
                let bounds = side.iter().fold(Aabb::EMPTY, |bounds, &&other| bounds.union(other));
                half_area(&bounds) * leaves(side.len(), capacity)
            };
            let cost = cost(&below) + cost(&above);
            if cheapest.is_none_or(|(least, _)| cost < least) {
                cheapest = Some((cost, Plane { axis, bin }));
            }
        }
        cheapest.map(|(_, plane)| plane)
    }

    /// Returns boxes of four kinds: on a small grid, so that most planes have the same cost;
    /// random; so large that twice a center may be infinite; and so small that the scale is
    /// infinite and the first bin is NaN.
    pub(in crate::hierarchy::build) fn some_boxes(rng: &mut Rng, kind: u32) -> Vec<Aabb> {
        let scale = [1.0, 1.0, 1e38, 1e-44][kind as usize];
        let count = rng.integer(1, 70) as usize;
        let mut coordinate = || match kind {
            1 => rng.uniform(-1.0, 1.0) as f32,
            _ => rng.integer(-3, 3) as f32,
        };
        let mut corner = || [coordinate() * scale, coordinate() * scale, coordinate() * scale];
        (0..count).map(|_| Aabb::of_points([corner(), corner()])).collect()
    }

    #[test]
    fn the_cheapest_plane_equals_that_of_brute_force() {
        let mut rng = Rng::new(401);
        let (mut planes, mut none) = ([0; 3], 0);
        for round in 0..400 {
            let boxes = some_boxes(&mut rng, round % 4);
            let items = Item::all(&boxes);
            let twice_centers = twice_center_bounds(&items);
            let (grid, capacity) = (Grid::over(&twice_centers), rng.integer(1, 8) as usize);
            let expected = plain_cheapest(&boxes, &twice_centers, capacity);
            match expected {
                Some(plane) => planes[plane.axis] += 1,
                None => none += 1,
            }
            for (name, level) in kernel_levels() {
                let cheapest = dispatch_every!(level, simd => {
                    let (low, high) = items.split_at(items.len() / 3);
                    Bins::of(simd, low, &grid).merged(Bins::of(simd, high, &grid)).cheapest(simd, capacity)
                });
                assert_eq!(cheapest, expected, "{name}, {} boxes, {capacity} to a leaf", boxes.len());
            }
        }
        assert!(planes.iter().all(|&count| count > 60) && none > 3, "{planes:?} on the axes, {none} without one");
    }

    #[test]
    fn a_box_is_above_the_planes_up_to_its_bin() {
        let mut rng = Rng::new(402);
        let mut seen = [0; BINS];
        for round in 0..80 {
            let boxes = some_boxes(&mut rng, round % 4);
            let items = Item::all(&boxes);
            let twice_centers = twice_center_bounds(&items);
            let grid = Grid::over(&twice_centers);
            for (item, bounds) in items.iter().zip(&boxes) {
                let expected = [0, 1, 2].map(|axis| plain_bin(bounds, &twice_centers, axis));
                expected.iter().for_each(|&bin| seen[bin] += 1);
                for (name, level) in kernel_levels() {
                    let bins = dispatch_every!(level, simd => grid.bins(simd, item));
                    assert_eq!(bins, expected, "{name}: {bounds:?} of {twice_centers:?}");
                    for (axis, bin) in (0..3).flat_map(|axis| (1..BINS).map(move |bin| (axis, bin))) {
                        let plane = Plane { axis, bin };
                        let lanes = dispatch_every!(level, simd => grid.is_above(simd, item, plane).to_bitmask());
                        let above = if bins[axis] >= bin { 0xff } else { 0 };
                        assert_eq!(lanes, above, "{name}: {bounds:?} at {plane:?} of {twice_centers:?}");
                    }
                }
            }
        }
        assert!(seen.iter().all(|&count| count > 100), "{seen:?} boxes in the bins");
    }
}
