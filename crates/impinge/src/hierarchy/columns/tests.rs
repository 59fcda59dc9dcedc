use crate::simd::dispatch_every;
use bytemuck::Zeroable;
use impinge_testkit::generate::Rng;

use super::*;
use crate::simd::{Level, kernel_levels};

fn centers(places: &[[f32; 3]]) -> Vec<Center> {
    let center = |(index, &[x, y, z]): (usize, &[f32; 3])| {
        let mut center = Center::zeroed();
        *bytemuck::cast_mut::<Center, [f32; 4]>(&mut center) = [x, y, z, f32::from_bits(index as u32)];
        center
    };
    places.iter().enumerate().map(center).collect()
}

impl Columns {
    fn numbers(&self, run: Run) -> Vec<i16> {
        self.columns[NUMBER][run.at..][..run.len].to_vec()
    }
}

/// Splits a run and returns the row numbers of either part.
fn parted(level: Level, columns: &mut Columns, run: Run, low: usize) -> [Vec<i16>; 2] {
    let (low, high) = dispatch_every!(level, simd => columns.part(simd, run, low));
    [columns.numbers(low), columns.numbers(high)]
}

/// Returns centers that spread over a few or many places along each axis, so that many rows
/// coincide in some cases.
fn places(rng: &mut Rng, len: usize) -> Vec<[f32; 3]> {
    let spread = [0; 3].map(|_| rng.choose(&[0, 1, 3, 40, 100_000]));
    (0..len).map(|_| spread.map(|spread| rng.integer(-spread, spread) as f32)).collect()
}

#[test]
fn rows_are_split_at_the_median_of_their_widest_axis() {
    let (mut rng, mut tied) = (Rng::new(171), 0);
    for len in (17..200).chain((0..60).map(|_| rng.integer(200, MAX_ROWS as i64) as usize)).collect::<Vec<_>>() {
        let places = places(&mut rng, len);
        let whole = if len > MAX_RANKED { MAX_RANKED } else { LANES };
        let low = len.div_ceil(whole).div_ceil(2) * whole;
        let mut expected = None;
        for (name, level) in kernel_levels() {
            let mut columns = Columns::default();
            dispatch_every!(level, simd => columns.set(simd, &centers(&places)));
            // Rows are consecutive until they are split, and then have room to be split.
            let along: Vec<[i16; 3]> = (0..len).map(|row| [0, 1, 2].map(|axis| columns.columns[axis][row])).collect();
            let extent = |axis: usize| {
                let along = || along.iter().map(|row| row[axis]);
                along().max().expect("rows") - along().min().expect("rows")
            };
            let axis = (0..3).fold(0, |widest, axis| if extent(axis) > extent(widest) { axis } else { widest });
            let parts @ [front, back] = &parted(level, &mut columns, Run::all(len), low);
            assert_eq!(front.len(), low);
            assert!(parts.iter().all(|part| part.is_sorted()), "{name}, {len}: out of order");
            let mut all = [&front[..], back].concat();
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..len as i16), "{name}, {len}: a row is lost");
            // Rows in the wrong part are hardly beyond the median, or one of few.
            let mut sorted: Vec<i16> = along.iter().map(|row| row[axis]).collect();
            sorted.sort_unstable();
            tied += usize::from(back.iter().any(|&number| along[number as usize][axis] == sorted[low - 1]));
            let is_wrong = |number: &&i16| along[**number as usize][axis] > sorted[low - 1];
            let wrong: Vec<i16> = front.iter().filter(is_wrong).map(|number| along[*number as usize][axis]).collect();
            let hardly = if len > MAX_RANKED { 0 } else { extent(axis) >> 8 };
            let far = wrong.iter().filter(|&&along| along > sorted[low - 1] + hardly).count();
            assert!(far <= if len > MAX_RANKED { len / 64 } else { 0 }, "{name}, {len}: {far} of {}", wrong.len());
            assert_eq!(expected.get_or_insert(parts.clone()), parts, "{name}, {len}");
        }
    }
    assert!(tied > 60 * kernel_levels().len(), "{tied}: too few medians were in both parts");
}

#[test]
fn runs_are_split_down_to_sixteen_rows_without_losing_any() {
    let (mut rng, mut planes) = (Rng::new(172), 0);
    for len in [1, 8, 9, 16, 17, 24, 40, 63, 65, 512, 700, 1_000, 2_000, 3_000, MAX_ROWS - 1, MAX_ROWS] {
        let places = places(&mut rng, len);
        let mut expected = None;
        for (name, level) in kernel_levels() {
            let mut columns = Columns::default();
            dispatch_every!(level, simd => columns.set(simd, &centers(&places)));
            let mut left = vec![Run::all(len)];
            while let Some(run) = left.pop() {
                let mut before = columns.numbers(run);
                if run.len <= SIXTEEN {
                    dispatch_every!(level, simd => columns.finish(simd, run));
                    let mut finished = columns.finished()[run.start..][..run.len].to_vec();
                    assert!(finished.chunks(LANES).all(|part| part.is_sorted()), "{name}: {finished:?}");
                    finished.sort_unstable();
                    assert_eq!(finished, before, "{name}, {len}: {run:?}");
                    continue;
                }
                let by_plane = dispatch_every!(level, simd => columns.part_by_plane(simd, run));
                planes += usize::from(by_plane.is_some());
                let (low, high) = by_plane.unwrap_or_else(|| {
                    let low = run.len.div_ceil(LANES).div_ceil(2) * LANES;
                    dispatch_every!(level, simd => columns.part(simd, run, low))
                });
                assert!(low.len > 0 && high.len > 0 && low.start == run.start && high.start == run.start + low.len);
                let parts = [low, high].map(|run| columns.numbers(run));
                assert!(parts.iter().all(|part| part.is_sorted()), "{name}, {len}: out of order");
                let mut after = parts.concat();
                before.sort_unstable();
                after.sort_unstable();
                assert_eq!(after, before, "{name}, {len}: {run:?}");
                left.extend([high, low]);
            }
            let finished = columns.finished()[..len].to_vec();
            assert_eq!(expected.get_or_insert(finished.clone()), &finished, "{name}, {len}");
        }
    }
    assert!(planes > 100, "{planes}");
}

#[test]
fn rows_that_coincide_or_reach_too_far_keep_their_order() {
    let far = [f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN];
    let mut rng = Rng::new(173);
    for len in [5, 20, 100] {
        let all_at = |place: [f32; 3]| vec![place; len];
        let mut anywhere: Vec<[f32; 3]> = (0..len).map(|_| [0; 3].map(|_| rng.choose(&far))).collect();
        anywhere[0] = [f32::INFINITY; 3];
        for places in [all_at([1.0, 2.0, 3.0]), all_at([f32::INFINITY; 3]), all_at([0.0, f32::MAX, -0.0]), anywhere] {
            for (name, level) in kernel_levels() {
                let mut columns = Columns::default();
                dispatch_every!(level, simd => columns.set(simd, &centers(&places)));
                assert!((0..3).all(|axis| columns.columns[axis][..len].iter().all(|&along| along == 0)), "{name}");
                assert!(columns.numbers(Run::all(len)).into_iter().eq(0..len as i16), "{name}");
            }
        }
    }
}
