//! The frame in which columns are one wide, and what level and column a box belongs to.

use std::ops::Range;

use super::super::march::LIMIT;
use crate::volume::MinMax;

/// Levels of columns, each four times as wide as the one before, and a last one that is one column: a box of a regular level
/// is smaller than the space in which images differ.
pub(super) const LEVELS: usize = 11;

/// Twice the level: how far columns of the finest level are shifted to be those of a level.
const SHIFT: usize = 2;

/// Boxes that a frame is made from at most: a few hundred tell quantiles to a few hundredths, in microseconds.
const SAMPLE: usize = 256;

/// Boxes for each of the sample.
const SAMPLED: usize = 32;

/// Boxes of the finest level that a box is to be compared with: a vector of eight costs as much as one, so that narrower
/// columns would make more copies and few fewer comparisons (half as many took the same time for 100,000 boxes, and 1.1 times
/// as long for 1,000,000).
const CANDIDATES: f64 = 8.0;

/// Boxes of a column: what fits the first two caches while it is sorted and swept.
const FULL: f64 = 1024.0;

/// Columns in memory at most; more share them. Each is a place in memory that is written to in turn.
const MOST_COLUMNS: usize = 1 << 12;

/// The part of a column that boxes of its level are wide at most, so that they reach into two on an axis.
pub(super) const LARGEST: f32 = 0.5;

/// Images are cut off here, far behind the last column: so many columns are counted in single precision, see [`nearest`].
const FARTHEST: f32 = (1 << 21) as f32;

/// A float of which the lower bits are a whole number: to add it rounds to the nearest, and costs less than a conversion.
const WHOLE: f32 = (3_u32 << 22) as f32;

/// A copy of a box in a column: its image.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    pub(super) min: [f32; 3],
    pub(super) key: u32,
    pub(super) max: [f32; 3],
    pub(super) tag: Tag,
}

/// Which of the columns that a box reaches into a copy is in: two bits of the column on each of two axes, and for each
/// whether it is the second one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tag(u32);

impl Tag {
    /// For the copy in a column, the second on an axis where `copy` has its bit.
    #[inline(always)]
    fn new(column: [i32; 2], copy: u32) -> Self {
        Self(column[0] as u32 & 3 | (column[1] as u32 & 3) << 2 | copy << 4)
    }

    /// Whether two copies of one level whose boxes meet are those that report the pair: they are in the same column, and
    /// there is none before it that both reach into. The columns of boxes that meet are two apart at most, so that two
    /// bits tell them from each other.
    #[inline(always)]
    pub(super) fn is_owner(self, other: Self) -> bool {
        (self.0 ^ other.0) & 15 | self.0 & other.0 & 48 == 0
    }

    /// Whether it is the second copy on an axis.
    #[inline(always)]
    fn is_second(self, axis: usize) -> i32 {
        (self.0 >> (4 + axis) & 1) as i32
    }
}

/// The columns that an image reaches into.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    pub(super) level: usize,
    first: [i32; 2],
    /// Where the first is in memory.
    pub(super) bucket: usize,
    /// Whether it reaches into the next one on each axis: a bit each.
    more: u32,
}

/// The whole number nearest to an image; monotone.
#[inline(always)]
fn nearest(coordinate: f32) -> i32 {
    (coordinate + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32
}

/// The monotone map from boxes to images, and the columns.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// The axis along the columns, and those across.
    pub(super) along: usize,
    across: [usize; 2],
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
        let wanted = boxes.len().div_ceil(SAMPLED).clamp(SAMPLE / 4, SAMPLE);
        let sample: Vec<&MinMax> = boxes.iter().step_by(boxes.len().div_ceil(wanted).max(1)).collect();
        if sample.is_empty() {
            return None;
        }
        let mut values = Vec::with_capacity(sample.len());
        let mut quantiles = |shares: &[f64], value: &dyn Fn(&MinMax) -> f64| -> Vec<f64> {
            values.clear();
            values.extend(sample.iter().map(|bounds| value(bounds)));
            let place = |share: f64| ((sample.len() - 1) as f64 * share) as usize;
            shares.iter().map(|&share| *values.select_nth_unstable_by(place(share), f64::total_cmp).1).collect()
        };
        let centres = [0, 1, 2].map(|axis| {
            quantiles(&[0.0, 0.25, 0.75, 1.0], &|bounds| 0.5 * bounds.min()[axis] + 0.5 * bounds.max()[axis])
        });
        let extents = [0, 1, 2].map(|axis| quantiles(&[0.5], &|bounds| bounds.max()[axis] - bounds.min()[axis])[0]);
        let size = |bounds: &MinMax| (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
        let large = quantiles(&[0.9], &size)[0];
        // How far the boxes are spread, less what is far from most, and at least what one box takes.
        let spreads = [0, 1, 2].map(|axis| (2.0 * (centres[axis][2] - centres[axis][1])).max(extents[axis]));
        let along = (0..3).fold(0, |best, axis| if spreads[axis] > spreads[best] { axis } else { best });
        let across = [(along + 1) % 3, (along + 2) % 3];
        let area = spreads[across[0]] * spreads[across[1]];
        let count = boxes.len() as f64;
        // Boxes that a column of width one holds along one box.
        let density = count / (spreads[along] * area) * extents[along];
        let full = (FULL * area / count).sqrt();
        let least = large / f64::from(LARGEST);
        let width = (CANDIDATES / density).sqrt().min(full).max(least);
        let width = if width.is_nan() { least } else { width };
        let scale = 1.0 / width.clamp(1.0 / LIMIT, LIMIT);
        let origin = [0, 1, 2].map(|axis| centres[axis][0]);
        let ranges = across.map(|axis| (centres[axis][3] - origin[axis]) * scale);
        let most = (boxes.len() / 64).next_power_of_two().min(MOST_COLUMNS);
        let mut first = 0;
        let grids = std::array::from_fn(|level| {
            let [stride, rows] = ranges.map(|range| (range as u32 >> (SHIFT * level)).saturating_add(3));
            let columns = (u64::from(stride) * u64::from(rows)).min(most as u64).next_power_of_two() as u32;
            let columns = if level == LEVELS - 1 { 1 } else { columns };
            let grid = Grid { first, mask: columns - 1, stride };
            first += columns;
            grid
        });
        Some(Self { along, across, origin, scale, grids })
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
    /// monotone, as is to cut off.
    #[inline(always)]
    pub(super) fn image(&self, bounds: &MinMax, key: u32) -> Record {
        let ([x, y, z], [end_x, end_y, end_z]) = (bounds.min(), bounds.max());
        let [o, p, q] = self.origin;
        let (corners, origins) = ([x, y, z, end_x, end_y, end_z], [o, p, q, o, p, q]);
        let mut image = [0.0_f32; 6];
        for at in 0..6 {
            let coordinate = ((corners[at] - origins[at]) * self.scale) as f32;
            let coordinate = if coordinate < FARTHEST { coordinate } else { FARTHEST };
            image[at] = if coordinate > -FARTHEST { coordinate } else { -FARTHEST };
        }
        let [x, y, z, end_x, end_y, end_z] = image;
        Record { min: [x, y, z], key, max: [end_x, end_y, end_z], tag: Tag::default() }
    }

    /// The level of an image: the first whose columns are twice as wide as it is large.
    #[inline(always)]
    fn level(record: &Record) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| record.max[axis] - record.min[axis]);
        let (mut level, mut largest) = (0, LARGEST);
        while level < LEVELS - 1 && !((x <= largest) & (y <= largest) & (z <= largest)) {
            (level, largest) = (level + 1, largest * 4.0);
        }
        level
    }

    /// The column of a coordinate across, at a level.
    #[inline(always)]
    fn column(coordinate: f32, level: usize) -> i32 {
        if level == LEVELS - 1 { 0 } else { nearest(coordinate) >> (SHIFT * level) }
    }

    /// Where a column is in memory.
    #[inline(always)]
    fn bucket(&self, level: usize, columns: [i32; 2]) -> usize {
        let grid = &self.grids[level];
        let index = (columns[0] as u32).wrapping_add((columns[1] as u32).wrapping_mul(grid.stride));
        (grid.first + (index & grid.mask)) as usize
    }

    /// The columns that an image reaches into.
    #[inline(always)]
    pub(super) fn spot(&self, record: &Record) -> Spot {
        let level = Self::level(record);
        let first = self.across.map(|axis| Self::column(record.min[axis % 3], level));
        let last = self.across.map(|axis| Self::column(record.max[axis % 3], level));
        let more = u32::from(last[0] != first[0]) | u32::from(last[1] != first[1]) << 1;
        Spot { level, first, bucket: self.bucket(level, first), more }
    }

    /// Calls for each of these columns, with the tag of the copy for it.
    #[inline(always)]
    pub(super) fn each_copy(&self, spot: &Spot, mut put: impl FnMut(usize, Tag)) {
        let &Spot { level, first, bucket, more } = spot;
        put(bucket, Tag::new(first, 0));
        if more == 0 {
            return;
        }
        for copy in 1..4_u32 {
            if copy & !more == 0 {
                let columns = [first[0] + (copy & 1) as i32, first[1] + (copy >> 1) as i32];
                put(self.bucket(level, columns), Tag::new(columns, copy));
            }
        }
    }

    /// The column of a copy.
    #[inline(always)]
    pub(super) fn own_column(&self, record: &Record, level: usize) -> [i32; 2] {
        [0, 1].map(|at| Self::column(record.min[self.across[at] % 3], level) + record.tag.is_second(at))
    }

    /// Where the column of a coarser level is that a column is part of: counted from the first of that level.
    pub(super) fn coarse_bucket(&self, column: [i32; 2], level: usize, coarser: usize) -> usize {
        let column = column.map(|column| Self::coarsened(column, level, coarser));
        self.bucket(coarser, column) - self.grids[coarser].first as usize
    }

    #[inline(always)]
    fn coarsened(column: i32, level: usize, coarser: usize) -> i32 {
        if coarser == LEVELS - 1 { 0 } else { column >> (SHIFT * (coarser - level)) }
    }

    /// Whether the copy of a box in a column, and that of a box of a coarser level in the column about it, are those that
    /// report the pair: the column holds the least corner of what they share.
    pub(super) fn is_owner(&self, one: &Record, level: usize, other: &Record, coarser: usize) -> bool {
        let (own, others) = (self.own_column(one, level), self.own_column(other, coarser));
        (0..2).all(|at| {
            let axis = self.across[at];
            own[at] == Self::column(one.min[axis].max(other.min[axis]), level)
                && others[at] == Self::coarsened(own[at], level, coarser)
        })
    }
}
