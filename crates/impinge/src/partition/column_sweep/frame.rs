//! The frame in which columns are one wide, and what level and column a box belongs to.

use std::ops::Range;

use super::super::best::LIMIT;
use super::record::{LAST, Record, as_second, interval};
use crate::simd::by_axis;
use crate::volume::MinMax;

/// Levels of columns, each four times as wide as the one before, and a last one that is one column: a box of a regular level
/// is smaller than the space in which images differ.
pub(super) const LEVELS: usize = 11;

/// Twice the level: how far columns of the finest level are shifted to be those of a level.
const SHIFT: usize = 2;

/// Boxes that a frame is made from at most: a few hundred tell quantiles to a few hundredths, in microseconds.
const SAMPLE: usize = 256;

/// Boxes for each of the sample.
const SAMPLED: usize = 64;

/// Boxes of the finest level that a box is to be compared with: mostly the sixteen that are compared at a time. Narrower columns
/// make more copies, wider ones more comparisons; with 8 and with 14 a step took 1.03 times as long.
const CANDIDATES: f64 = 10.0;

/// Boxes of a column: what fits the first two caches while it is sorted and swept.
const FULL: f64 = 1024.0;

/// Columns in memory at most; more share them, and then the boxes decide each hit: ten million boxes took four times as long with
/// an eighth of these. Each is a place in memory that is written to in turn.
const MOST_COLUMNS: usize = 1 << 15;

/// The part of a column that boxes of its level are wide at most, so that they reach into two on an axis, and are within a width
/// of the middle of either: a little less than a half, for the rounding of differences.
pub(super) const LARGEST: f32 = 0.5 - 1.0 / 1024.0;

/// Images are cut off here, far behind the last column: so many columns are counted in single precision, see [`nearest`].
const FARTHEST: f32 = (1 << 21) as f32;

/// Steps across in a column of a level, of which a width on either side of its middle is counted.
pub(super) const WIDTH: u32 = 1 << 14;

/// The last step along.
const MOST_STEPS: f32 = LAST as f32;

/// Distances between the quartiles that steps along reach beyond these at most.
const BEYOND: f64 = 2.0;

/// A float of which the lower bits are a whole number: to add it rounds to the nearest, and costs less than a conversion.
const WHOLE: f32 = (3_u32 << 22) as f32;

/// A box in columns of width one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Image {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

/// The whole number nearest to an image; monotone.
#[inline(always)]
pub(super) fn nearest(coordinate: f32) -> i32 {
    (coordinate + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32
}

/// The monotone map from boxes to images, and the columns.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// The axis along the columns, and those across.
    pub(super) along: usize,
    pub(super) across: [usize; 2],
    origin: [f64; 3],
    scale: f64,
    grids: [Grid; LEVELS],
    /// Where steps along begin, and how many there are to one.
    low: f32,
    steps: f32,
}

/// The columns of a level in memory.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    first: u32,
    /// How many there are, less one: one less than a power of two.
    mask: u32,
    /// Columns from one row to the next, and rows.
    stride: u32,
    rows: u32,
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
            let grid = Grid { first, mask: columns - 1, stride, rows };
            first += columns;
            grid
        });
        // What is far from most lies in the first or the last step.
        let [least, low, high, greatest] = [0, 1, 2, 3].map(|at| centres[along][at] - origin[along]);
        let margin = (high - low).max(extents[along]);
        let low = least.max(low - BEYOND * margin) - extents[along] - 0.03125 * margin;
        let high = greatest.min(high + BEYOND * margin) + extents[along] + 0.03125 * margin;
        let range = ((high - low) * scale) as f32;
        let steps = (MOST_STEPS / range.max(f32::MIN_POSITIVE)).min(f32::MAX);
        Some(Self {
            along,
            across,
            origin,
            scale,
            grids,
            low: ((low * scale) as f32).clamp(-FARTHEST, FARTHEST),
            steps,
        })
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

    /// Whether several columns of a level share places in memory.
    pub(super) fn is_folded(&self, level: usize) -> bool {
        let Grid { mask, stride, rows, .. } = self.grids[level];
        u64::from(mask) + 1 < u64::from(stride) * u64::from(rows)
    }

    /// The column of a place in memory that no others share.
    pub(super) fn column_at(&self, level: usize, place: usize) -> [i32; 2] {
        let Grid { first, stride, .. } = self.grids[level];
        let index = place as u32 - first;
        [(index % stride) as i32, (index / stride) as i32]
    }

    /// The image of a coordinate. Differences, products with a positive number and conversions are all rounded to nearest,
    /// and so monotone, as is to cut off.
    #[inline(always)]
    pub(super) fn coordinate(&self, axis: usize, coordinate: f64) -> f32 {
        let image = ((coordinate - self.origin[axis]) * self.scale) as f32;
        let image = if image < FARTHEST { image } else { FARTHEST };
        if image > -FARTHEST { image } else { -FARTHEST }
    }

    /// The image of a box.
    #[inline(always)]
    pub(super) fn image(&self, bounds: &MinMax) -> Image {
        let (min, max) = (bounds.min(), bounds.max());
        Image {
            min: by_axis!(axis => self.coordinate(axis, min[axis])),
            max: by_axis!(axis => self.coordinate(axis, max[axis])),
        }
    }

    /// The step along the columns that an image is in; monotone.
    #[inline(always)]
    pub(super) fn step(&self, along: f32) -> u32 {
        let step = (along - self.low) * self.steps;
        let step = if step < MOST_STEPS { step } else { MOST_STEPS };
        let step = if step > 0.0 { step } else { 0.0 };
        (step + WHOLE).to_bits() & 0xffff
    }

    /// The step across that an image is in, counted from a width before the middle of a column of a level, and cut off beyond one
    /// behind it. Where it is not cut off, what is counted from one column agrees with what is from the next.
    pub(super) fn step_across(&self, coordinate: f32, level: usize, column: i32) -> u32 {
        let width = f64::from(1_u32 << (SHIFT * level));
        let middle = f64::from(column) * width + 0.5 * (width - 1.0);
        let step = (f64::from(coordinate) - middle) * (f64::from(WIDTH) / width) + f64::from(WIDTH);
        step.clamp(0.0, f64::from(LAST)).round_ties_even() as u32
    }

    /// The interval of an image on an axis across, as its copy in a column has it.
    fn interval(&self, image: &Image, at: usize, level: usize, column: i32) -> u32 {
        let axis = self.across[at];
        let [begin, end] = [image.min[axis], image.max[axis]].map(|x| self.step_across(x, level, column));
        let interval = interval(begin, end);
        if column == Self::column(image.min[axis], level) { interval } else { as_second(interval) }
    }

    /// The copy of a box in a column.
    pub(super) fn record(&self, image: &Image, level: usize, columns: [i32; 2], key: u32) -> Record {
        let [begin, end] = [image.min, image.max].map(|corner| self.step(corner[self.along]));
        Record::new(interval(begin, end), [0, 1].map(|at| self.interval(image, at, level, columns[at])), key)
    }

    /// The level of an image: the first whose columns are twice as wide as it is large.
    pub(super) fn level(image: &Image) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| image.max[axis] - image.min[axis]);
        let (mut level, mut largest) = (0, LARGEST);
        while level < LEVELS - 1 && !((x <= largest) & (y <= largest) & (z <= largest)) {
            (level, largest) = (level + 1, largest * 4.0);
        }
        level
    }

    /// The column of a coordinate across, at a level.
    #[inline(always)]
    pub(super) fn column(coordinate: f32, level: usize) -> i32 {
        if level == LEVELS - 1 { 0 } else { nearest(coordinate) >> (SHIFT * level) }
    }

    /// The first and the last columns across that an image reaches into.
    #[inline(always)]
    pub(super) fn reach(&self, image: &Image, level: usize) -> [[i32; 2]; 2] {
        [image.min, image.max].map(|corner| self.across.map(|axis| Self::column(corner[axis], level)))
    }

    /// Where a column is in memory.
    #[inline(always)]
    pub(super) fn place(&self, level: usize, columns: [i32; 2]) -> u32 {
        let grid = &self.grids[level];
        let index = (columns[0] as u32).wrapping_add((columns[1] as u32).wrapping_mul(grid.stride));
        grid.first + (index & grid.mask)
    }

    /// Whether no column but these shares their places in memory, other than where a level is folded.
    #[inline(always)]
    pub(super) fn is_within(&self, level: usize, [first, last]: [[i32; 2]; 2]) -> bool {
        let Grid { stride, rows, .. } = self.grids[level];
        (first[0] >= 0) & (first[1] >= 0) & (last[0] < stride as i32) & (last[1] < rows as i32)
    }

    /// The column of a coarser level that a column is part of.
    pub(super) fn coarsened(column: i32, level: usize, coarser: usize) -> i32 {
        if coarser == LEVELS - 1 { 0 } else { column >> (SHIFT * (coarser - level)) }
    }
}
