//! Layout of the columns of a sweep. A [`Frame`] scales and shifts boxes so that columns of the
//! finest level have width one, and says to which level and which columns a box belongs. Columns
//! are parallel to one axis. Those of each level are four times as wide as those of the level
//! before.

use std::ops::Range;

use super::super::best::LIMIT;
use super::record::{LAST, Record, as_second, interval};
use crate::simd::by_axis;
use crate::volume::MinMax;

/// Number of levels of columns. Each level is four times as wide as the level before; the last
/// level is a single column. Boxes of all levels but the last are at most about 2^17 long, well
/// within [`MAX_IMAGE`], where images are clamped.
pub(super) const LEVELS: usize = 11;

/// Binary logarithm of the ratio of the widths of successive levels. Shifting a column number of
/// the finest level right by `SHIFT * level` gives its column in that level.
const SHIFT: usize = 2;

/// Maximum number of boxes that determine a frame. A few hundred give quantiles to within a few
/// hundredths, in microseconds.
const MAX_SAMPLE: usize = 256;

/// Number of boxes per sampled box.
const BOXES_PER_SAMPLE: usize = 64;

/// Target number of boxes that a box of the finest level is compared with. Most of them are then
/// among the sixteen that are compared at a time. Narrower columns make more copies, wider ones
/// more comparisons; with 8 and with 14 a step took 1.03 times as long.
const TARGET_CANDIDATES: f64 = 10.0;

/// Target number of boxes in a column, which fit into the first two cache levels while the column
/// is sorted and swept.
const TARGET_COLUMN_LEN: f64 = 1024.0;

/// Maximum number of columns in memory. If there are more, columns share places, and the boxes
/// themselves decide each hit: with 1/8 of this number, ten million boxes took four times as long.
/// More columns would scatter the writes over more of memory.
const MAX_COLUMNS: usize = 1 << 15;

/// Maximum extent of a box, relative to the width of the columns of its level. A box then reaches
/// into at most two columns on an axis, and lies within one width of the middle of either. It is
/// slightly less than 1/2, to allow for rounded differences.
pub(super) const MAX_EXTENT: f32 = 0.5 - 1.0 / 1024.0;

/// Magnitude at which images are clamped, far beyond the last column. Up to this number, columns
/// can be counted in single precision; see [`nearest`].
const MAX_IMAGE: f32 = (1 << 21) as f32;

/// Number of steps across in the width of a column. Steps are counted up to one width on either
/// side of the column's middle.
pub(super) const WIDTH: u32 = 1 << 14;

/// Last step along a column, as a float.
const LAST_STEP: f32 = LAST as f32;

/// Maximum distance by which the range of steps along the columns extends beyond the quartiles, in
/// multiples of the distance between the quartiles.
const MAX_MARGIN: f64 = 2.0;

/// Float whose low bits represent a whole number. Adding it rounds to the nearest whole number, and
/// is faster than a conversion.
const ROUNDING_OFFSET: f32 = (3_u32 << 22) as f32;

/// A box in the coordinates of a frame, in which columns of the finest level have width one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Image {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

/// Returns the whole number nearest to an image coordinate; monotone.
#[inline(always)]
pub(super) fn nearest(coordinate: f32) -> i32 {
    (coordinate + ROUNDING_OFFSET).to_bits() as i32 - ROUNDING_OFFSET.to_bits() as i32
}

/// The monotone map from boxes to images, and the layout of the columns.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// Axis along the columns.
    pub(super) along: usize,
    /// The two axes across the columns.
    pub(super) across: [usize; 2],
    origin: [f64; 3],
    scale: f64,
    grids: [Grid; LEVELS],
    /// Image coordinate along the columns at which steps begin.
    low: f32,
    /// Number of steps per unit of image coordinates, along the columns.
    steps: f32,
}

/// Layout of the columns of one level in memory.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    /// Place of the level's first column.
    first: u32,
    /// Number of columns in memory minus one. The number is a power of two.
    mask: u32,
    /// Distance in memory between neighboring rows: the number of columns in a row.
    stride: u32,
    /// Number of rows.
    rows: u32,
}

impl Frame {
    /// Returns a frame that suits the boxes, chosen by a sample of them, or `None` if there are no
    /// boxes. Any frame gives the same pairs; a bad one is only slower.
    pub(super) fn of(boxes: &[MinMax]) -> Option<Self> {
        let wanted = boxes.len().div_ceil(BOXES_PER_SAMPLE).clamp(MAX_SAMPLE / 4, MAX_SAMPLE);
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
        let centers = [0, 1, 2].map(|axis| {
            quantiles(&[0.0, 0.25, 0.75, 1.0], &|bounds| 0.5 * bounds.min()[axis] + 0.5 * bounds.max()[axis])
        });
        let extents = [0, 1, 2].map(|axis| quantiles(&[0.5], &|bounds| bounds.max()[axis] - bounds.min()[axis])[0]);
        let size = |bounds: &MinMax| (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
        let large = quantiles(&[0.9], &size)[0];
        // Spread of the boxes without outliers, and at least the extent of one box.
        let spreads = [0, 1, 2].map(|axis| (2.0 * (centers[axis][2] - centers[axis][1])).max(extents[axis]));
        let along = (0..3).fold(0, |best, axis| if spreads[axis] > spreads[best] { axis } else { best });
        let across = [(along + 1) % 3, (along + 2) % 3];
        let area = spreads[across[0]] * spreads[across[1]];
        let count = boxes.len() as f64;
        // Number of boxes in a column of cross-section one, over the length of one box.
        let density = count / (spreads[along] * area) * extents[along];
        let full = (TARGET_COLUMN_LEN * area / count).sqrt();
        let least = large / f64::from(MAX_EXTENT);
        let width = (TARGET_CANDIDATES / density).sqrt().min(full).max(least);
        let width = if width.is_nan() { least } else { width };
        let scale = 1.0 / width.clamp(1.0 / LIMIT, LIMIT);
        let origin = [0, 1, 2].map(|axis| centers[axis][0]);
        let ranges = across.map(|axis| (centers[axis][3] - origin[axis]) * scale);
        let most = (boxes.len() / 64).next_power_of_two().min(MAX_COLUMNS);
        let mut first = 0;
        let grids = std::array::from_fn(|level| {
            let [stride, rows] = ranges.map(|range| (range as u32 >> (SHIFT * level)).saturating_add(3));
            let columns = (u64::from(stride) * u64::from(rows)).min(most as u64).next_power_of_two() as u32;
            let columns = if level == LEVELS - 1 { 1 } else { columns };
            let grid = Grid { first, mask: columns - 1, stride, rows };
            first += columns;
            grid
        });
        // Outliers fall into the first or the last step.
        let [least, low, high, greatest] = [0, 1, 2, 3].map(|at| centers[along][at] - origin[along]);
        let margin = (high - low).max(extents[along]);
        let low = least.max(low - MAX_MARGIN * margin) - extents[along] - 0.03125 * margin;
        let high = greatest.min(high + MAX_MARGIN * margin) + extents[along] + 0.03125 * margin;
        let range = ((high - low) * scale) as f32;
        let steps = (LAST_STEP / range.max(f32::MIN_POSITIVE)).min(f32::MAX);
        Some(Self {
            along,
            across,
            origin,
            scale,
            grids,
            low: ((low * scale) as f32).clamp(-MAX_IMAGE, MAX_IMAGE),
            steps,
        })
    }

    /// Returns the number of columns in memory, of all levels.
    pub(super) fn len(&self) -> usize {
        self.columns(LEVELS - 1).end
    }

    /// Returns the places of the columns of a level.
    pub(super) fn columns(&self, level: usize) -> Range<usize> {
        let Grid { first, mask, .. } = self.grids[level];
        first as usize..(first + mask + 1) as usize
    }

    /// Reports whether several columns of a level share places in memory.
    pub(super) fn is_folded(&self, level: usize) -> bool {
        let Grid { mask, stride, rows, .. } = self.grids[level];
        u64::from(mask) + 1 < u64::from(stride) * u64::from(rows)
    }

    /// Returns the column at a place in memory. The result is meaningless if several columns share
    /// the place.
    pub(super) fn column_at(&self, level: usize, place: usize) -> [i32; 2] {
        let Grid { first, stride, .. } = self.grids[level];
        let index = place as u32 - first;
        [(index % stride) as i32, (index / stride) as i32]
    }

    /// Returns the image of a coordinate. Differences, products with a positive number and
    /// conversions are rounded to nearest, so they are monotone, and so is clamping.
    #[inline(always)]
    pub(super) fn coordinate(&self, axis: usize, coordinate: f64) -> f32 {
        let image = ((coordinate - self.origin[axis]) * self.scale) as f32;
        let image = if image < MAX_IMAGE { image } else { MAX_IMAGE };
        if image > -MAX_IMAGE { image } else { -MAX_IMAGE }
    }

    /// Returns the image of a box.
    #[inline(always)]
    pub(super) fn image(&self, bounds: &MinMax) -> Image {
        let (min, max) = (bounds.min(), bounds.max());
        Image {
            min: by_axis!(axis => self.coordinate(axis, min[axis])),
            max: by_axis!(axis => self.coordinate(axis, max[axis])),
        }
    }

    /// Returns the step of an image coordinate along the columns; monotone.
    #[inline(always)]
    pub(super) fn step(&self, along: f32) -> u32 {
        let step = (along - self.low) * self.steps;
        let step = if step < LAST_STEP { step } else { LAST_STEP };
        let step = if step > 0.0 { step } else { 0.0 };
        (step + ROUNDING_OFFSET).to_bits() & 0xffff
    }

    /// Returns the step of an image coordinate across the columns. Steps are counted from one width
    /// before the middle of the column and clamped one width behind it. If neither is clamped, the
    /// steps counted from neighboring columns agree.
    pub(super) fn step_across(&self, coordinate: f32, level: usize, column: i32) -> u32 {
        let width = f64::from(1_u32 << (SHIFT * level));
        let middle = f64::from(column) * width + 0.5 * (width - 1.0);
        let step = (f64::from(coordinate) - middle) * (f64::from(WIDTH) / width) + f64::from(WIDTH);
        step.clamp(0.0, f64::from(LAST)).round_ties_even() as u32
    }

    /// Returns the interval of an image on an axis across, as the record of its copy in a column
    /// stores it.
    fn interval(&self, image: &Image, at: usize, level: usize, column: i32) -> u32 {
        let axis = self.across[at];
        let [begin, end] = [image.min[axis], image.max[axis]].map(|x| self.step_across(x, level, column));
        let interval = interval(begin, end);
        if column == Self::column(image.min[axis], level) { interval } else { as_second(interval) }
    }

    /// Returns the record of the copy of a box in a column.
    pub(super) fn record(&self, image: &Image, level: usize, columns: [i32; 2], key: u32) -> Record {
        let [begin, end] = [image.min, image.max].map(|corner| self.step(corner[self.along]));
        Record::new(interval(begin, end), [0, 1].map(|at| self.interval(image, at, level, columns[at])), key)
    }

    /// Returns the level of an image: the first level whose columns are at least twice as wide as
    /// the image is large.
    pub(super) fn level(image: &Image) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| image.max[axis] - image.min[axis]);
        let (mut level, mut largest) = (0, MAX_EXTENT);
        while level < LEVELS - 1 && !((x <= largest) & (y <= largest) & (z <= largest)) {
            (level, largest) = (level + 1, largest * 4.0);
        }
        level
    }

    /// Returns the column of an image coordinate across, at a level.
    #[inline(always)]
    pub(super) fn column(coordinate: f32, level: usize) -> i32 {
        if level == LEVELS - 1 { 0 } else { nearest(coordinate) >> (SHIFT * level) }
    }

    /// Returns the first and the last column that an image reaches into, on both axes across.
    #[inline(always)]
    pub(super) fn reach(&self, image: &Image, level: usize) -> [[i32; 2]; 2] {
        [image.min, image.max].map(|corner| self.across.map(|axis| Self::column(corner[axis], level)))
    }

    /// Returns the place of a column in memory.
    #[inline(always)]
    pub(super) fn place(&self, level: usize, columns: [i32; 2]) -> u32 {
        let grid = &self.grids[level];
        let index = (columns[0] as u32).wrapping_add((columns[1] as u32).wrapping_mul(grid.stride));
        grid.first + (index & grid.mask)
    }

    /// Reports whether the columns from `first` to `last` lie within the level's grid. Two columns
    /// within the grid never share a place, unless the level is folded.
    #[inline(always)]
    pub(super) fn is_within(&self, level: usize, [first, last]: [[i32; 2]; 2]) -> bool {
        let Grid { stride, rows, .. } = self.grids[level];
        (first[0] >= 0) & (first[1] >= 0) & (last[0] < stride as i32) & (last[1] < rows as i32)
    }

    /// Returns the column of a coarser level that contains a column.
    pub(super) fn coarsened(column: i32, level: usize, coarser: usize) -> i32 {
        if coarser == LEVELS - 1 { 0 } else { column >> (SHIFT * (coarser - level)) }
    }
}
