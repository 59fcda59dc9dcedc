//! The frame in which columns are one wide, and what level and column a box belongs to.

use std::ops::Range;

use super::super::march::LIMIT;
use crate::volume::MinMax;

/// Levels of columns, each four times as wide as the one before, and a last one that is one column.
pub(super) const LEVELS: usize = 14;

/// Twice the level: how far columns of the finest level are shifted to be those of a level.
const SHIFT: usize = 2;

/// Boxes that a frame is made from: a few hundred tell quantiles to a few hundredths, in microseconds.
const SAMPLE: usize = 256;

/// Boxes of the finest level that a box is to be compared with: a vector of eight costs as much as one, so that narrower
/// columns would make more copies and no fewer comparisons.
const CANDIDATES: f64 = 8.0;

/// Boxes of a column: what fits the first two caches while it is sorted and swept.
const FULL: f64 = 1024.0;

/// Columns in memory at most; more share them. Each is a place in memory that is written to in turn.
const MOST_COLUMNS: usize = 1 << 12;

/// The part of a column that boxes of its level are wide at most, so that they reach into two on an axis.
const LARGEST: f32 = 0.5;

/// Coordinates in the frame are cut off here to be whole numbers: far more columns than there are.
const FARTHEST: f32 = (1 << 30) as f32;

/// A copy of a box in a column: its image, along the columns first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
    pub(super) key: u32,
    /// Which of the two columns that it reaches into on each axis across: a bit each.
    pub(super) copy: u32,
}

/// The monotone map from boxes to images, and the columns.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// The axis along the columns, and those across.
    axes: [usize; 3],
    origin: [f64; 3],
    scale: f64,
    grids: [Grid; LEVELS],
}

/// The columns of a level in memory.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    first: u32,
    /// How many there are, less one: one less than a power of two.
    mask: u32,
    /// Columns from one row to the next.
    stride: u32,
}

impl Frame {
    /// A frame that suits the boxes, judged by a sample of them. Any frame gives the same pairs.
    pub(super) fn of(boxes: &[MinMax]) -> Option<Self> {
        let sample: Vec<&MinMax> = boxes.iter().step_by(boxes.len().div_ceil(SAMPLE).max(1)).collect();
        let quantile = |sorted: &[f64], share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
        let sorted = |value: &dyn Fn(&MinMax) -> f64| {
            let mut values: Vec<f64> = sample.iter().map(|bounds| value(bounds)).collect();
            values.sort_unstable_by(f64::total_cmp);
            values
        };
        if sample.is_empty() {
            return None;
        }
        let centres = [0, 1, 2].map(|axis| sorted(&|bounds| 0.5 * bounds.min()[axis] + 0.5 * bounds.max()[axis]));
        let extents = [0, 1, 2].map(|axis| sorted(&|bounds| bounds.max()[axis] - bounds.min()[axis]));
        let sizes = sorted(&|bounds| (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max));
        // How far the boxes are spread, less what is far from most, and at least what one box takes.
        let spreads = [0, 1, 2].map(|axis| {
            let half = quantile(&centres[axis], 0.75) - quantile(&centres[axis], 0.25);
            (2.0 * half).max(quantile(&extents[axis], 0.5))
        });
        let along = (0..3).fold(0, |best, axis| if spreads[axis] > spreads[best] { axis } else { best });
        let axes = [along, (along + 1) % 3, (along + 2) % 3];
        let [length, across, up] = axes.map(|axis| spreads[axis]);
        let count = boxes.len() as f64;
        // Boxes that a column of width one holds along one box.
        let density = count / (length * across * up) * quantile(&extents[along], 0.5);
        let full = (FULL * across * up / count).sqrt();
        let width = (CANDIDATES / density).sqrt().min(full).max(quantile(&sizes, 0.9) / f64::from(LARGEST));
        let width = if width.is_nan() { quantile(&sizes, 0.9) / f64::from(LARGEST) } else { width };
        let scale = 1.0 / width.clamp(1.0 / LIMIT, LIMIT);
        let origin = axes.map(|axis| quantile(&centres[axis], 0.0));
        let ranges = [1, 2].map(|at| (quantile(&centres[axes[at]], 1.0) - origin[at]) * scale);
        let most = (boxes.len() / 64).next_power_of_two().min(MOST_COLUMNS);
        let mut first = 0;
        let grids = std::array::from_fn(|level| {
            let [stride, rows] = ranges.map(|range| (range as u32 >> (SHIFT * level).min(31)).saturating_add(3));
            let columns = (u64::from(stride) * u64::from(rows)).min(most as u64).next_power_of_two() as u32;
            let columns = if level == LEVELS - 1 { 1 } else { columns };
            let grid = Grid { first, mask: columns - 1, stride };
            first += columns;
            grid
        });
        Some(Self { axes, origin, scale, grids })
    }

    /// How many columns there are in memory, of all levels.
    pub(super) fn len(&self) -> usize {
        self.columns(LEVELS - 1).end
    }

    /// Those of a level.
    pub(super) fn columns(&self, level: usize) -> Range<usize> {
        let Grid { first, mask, .. } = self.grids[level];
        first as usize..(first + mask + 1) as usize
    }

    /// The image of a box. Differences, products with a positive number and conversions are all rounded to nearest, and so
    /// monotone.
    #[inline(always)]
    pub(super) fn image(&self, bounds: &MinMax, key: u32) -> Record {
        let (low, high) = (bounds.min(), bounds.max());
        let mut record = Record { key, ..Record::default() };
        for at in 0..3 {
            let (axis, origin) = (self.axes[at], self.origin[at]);
            record.min[at] = ((low[axis] - origin) * self.scale) as f32;
            record.max[at] = ((high[axis] - origin) * self.scale) as f32;
        }
        record
    }

    /// The level of an image: the first whose columns are twice as wide as it is large.
    #[inline(always)]
    pub(super) fn level(record: &Record) -> usize {
        let [x, y, z] = [0, 1, 2].map(|at| record.max[at] - record.min[at]);
        let (mut level, mut largest) = (0, LARGEST);
        // Images at infinity have sizes that are not numbers, and go to the top.
        while level < LEVELS - 1 && !(x <= largest && y <= largest && z <= largest) {
            (level, largest) = (level + 1, largest * 4.0);
        }
        level
    }

    /// The column of a coordinate across, at a level.
    #[inline(always)]
    fn column(coordinate: f32, level: usize) -> i32 {
        if level == LEVELS - 1 {
            return 0;
        }
        let cut = coordinate.clamp(-FARTHEST, FARTHEST);
        let whole = cut as i32;
        (whole - i32::from(whole as f32 > cut)) >> (SHIFT * level)
    }

    /// Where a column is in memory.
    #[inline(always)]
    fn bucket(&self, level: usize, columns: [i32; 2]) -> usize {
        let grid = &self.grids[level];
        let index = (columns[0] as u32).wrapping_add((columns[1] as u32).wrapping_mul(grid.stride));
        (grid.first + (index & grid.mask)) as usize
    }

    /// Calls for each column that an image reaches into, with the copy for it.
    #[inline(always)]
    pub(super) fn each_copy(&self, record: Record, mut put: impl FnMut(usize, Record)) {
        let level = Self::level(&record);
        let first = [1, 2].map(|at| Self::column(record.min[at], level));
        let last = [1, 2].map(|at| Self::column(record.max[at], level));
        put(self.bucket(level, first), record);
        if first == last {
            return;
        }
        let more = [0, 1].map(|at| u32::from(last[at] != first[at]));
        for copy in 1..4_u32 {
            if copy & 1 <= more[0] && copy >> 1 <= more[1] {
                let columns = [first[0] + (copy & 1) as i32, first[1] + (copy >> 1) as i32];
                put(self.bucket(level, columns), Record { copy, ..record });
            }
        }
    }

    /// The columns of a copy.
    #[inline(always)]
    fn own_columns(record: &Record, level: usize) -> [i32; 2] {
        [0, 1].map(|at| Self::column(record.min[1 + at], level) + (record.copy >> at & 1) as i32)
    }

    /// Where the column of a coarser level lies that the column of a copy is part of: from the first of that level.
    #[inline]
    pub(super) fn coarse_bucket(&self, record: &Record, level: usize, coarser: usize) -> usize {
        let columns = Self::own_columns(record, level).map(|column| Self::coarsened(column, level, coarser));
        self.bucket(coarser, columns) - self.grids[coarser].first as usize
    }

    #[inline(always)]
    fn coarsened(column: i32, level: usize, coarser: usize) -> i32 {
        if coarser == LEVELS - 1 { 0 } else { column >> (SHIFT * (coarser - level)) }
    }

    /// Whether the copy of a box in a column, and that of a box `above` levels coarser in the column about it, are those that
    /// report the pair.
    #[inline]
    pub(super) fn is_owner(&self, one: &Record, other: &Record, level: usize, above: usize) -> bool {
        let (own, others) = (Self::own_columns(one, level), Self::own_columns(other, level + above));
        (0..2).all(|at| {
            own[at] == Self::column(one.min[1 + at].max(other.min[1 + at]), level)
                && others[at] == Self::coarsened(own[at], level, level + above)
        })
    }
}
