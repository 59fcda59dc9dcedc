//! Keys of channels that share their times, and the interpolation of four linear channels at once,
//! one per lane.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use crate::simd::{best_level, by_axis, dispatch};

use super::skeleton::BoneSet;
use super::transform::{FACTORS, Transform};

/// Times, and the values of all channels that have keys at these times. Values are stored key by
/// key, because a pose needs one key of all channels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Timeline {
    pub(super) times: Vec<f64>,
    /// Number of values per key, over all channels.
    pub(super) width: usize,
    pub(super) values: Vec<f64>,
    /// Groups of four linear channels of bones. Their values come first in a key, before those of
    /// all other channels.
    pub(super) quads: Vec<Quad>,
}

/// Up to four linear channels of the same property. Unused lanes repeat the last channel. Each
/// coordinate of all four is stored together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quad {
    /// Position of its first value among the values of a key.
    pub(super) offset: usize,
    pub(super) property: Property,
    pub(super) bones: [u32; LANES],
}

/// The property of a bone that a channel animates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Property {
    Translation,
    Rotation,
    Scale,
}

impl Property {
    /// Number of values per key.
    fn width(self) -> usize {
        match self {
            Self::Translation | Self::Scale => 3,
            Self::Rotation => 4,
        }
    }
}

/// Number of channels of a quad.
pub(super) const LANES: usize = 4;

/// The side of a jump whose value is used at the time of the jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The value before the jump.
    Before,
    /// The value after the jump. This is the value of the motion at that time.
    After,
}

/// A place between two keys.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) key: usize,
    /// From 0 at this key to 1 at the next.
    pub(super) share: f64,
    pub(super) seconds: f64,
}

impl Place {
    pub(super) const START: Self = Self { key: 0, share: 0.0, seconds: 0.0 };
}

impl Timeline {
    pub(super) fn new(times: Vec<f64>) -> Self {
        Self { times, width: 0, values: Vec::new(), quads: Vec::new() }
    }

    /// Copies the last channel of quads with fewer than four channels into the unused lanes.
    pub(super) fn fill(&mut self) {
        for quad in &self.quads {
            let used = quad.bones.iter().take_while(|&&bone| bone != quad.bones[LANES - 1]).count();
            let end = quad.offset + quad.property.width() * LANES;
            for row in self.values.chunks_mut(self.width) {
                row[quad.offset..end].chunks_mut(LANES).for_each(|lanes| {
                    let last = lanes[used];
                    lanes[used..].fill(last);
                });
            }
        }
    }

    /// Returns the place of a time among the keys.
    pub(super) fn find(&self, time: f64, side: Side) -> Place {
        let times = &self.times;
        let after = match side {
            Side::After => times.partition_point(|&key| key <= time),
            Side::Before => times.partition_point(|&key| key < time),
        };
        if after == 0 {
            return Place::START;
        }
        let key = after - 1;
        let Some(&next) = times.get(after) else { return Place { key, ..Place::START } };
        let seconds = next - times[key];
        Place { key, share: ((time - times[key]) / seconds).clamp(0.0, 1.0), seconds }
    }

    /// Sets the properties that the quads animate: all of them, or only quads with a bone in the
    /// set.
    pub(super) fn sample(&self, place: Place, set: Option<&BoneSet>, locals: &mut [Transform]) {
        if !self.quads.is_empty() {
            dispatch!(best_level(), simd => self.sample_lanes(simd, place, set, locals));
        }
    }

    #[inline(always)]
    fn sample_lanes<S: Simd>(&self, simd: S, place: Place, set: Option<&BoneSet>, locals: &mut [Transform]) {
        let from = &self.values[place.key * self.width..];
        // At a key, both ends are the key's own values.
        let to = if place.share > 0.0 { &from[self.width..] } else { from };
        for quad in &self.quads {
            if set.is_some_and(|set| quad.bones.iter().all(|&bone| !set.is_in[bone as usize])) {
                continue;
            }
            let (a, b) = (&from[quad.offset..], &to[quad.offset..]);
            let bones = quad.bones.map(|bone| bone as usize);
            match quad.property {
                Property::Rotation => {
                    let turned = slerp(simd, a, b, place.share);
                    for (lane, bone) in bones.into_iter().enumerate() {
                        locals[bone].rotation_wxyz = [0, 1, 2, 3].map(|k| turned[k][lane]);
                    }
                }
                Property::Translation => {
                    let moved = lerp(simd, a, b, place.share);
                    for (lane, bone) in bones.into_iter().enumerate() {
                        locals[bone].translation = [0, 1, 2].map(|k| moved[k][lane]);
                    }
                }
                Property::Scale => {
                    let scaled = lerp(simd, a, b, place.share);
                    for (lane, bone) in bones.into_iter().enumerate() {
                        locals[bone].scale = [0, 1, 2].map(|k| scaled[k][lane]);
                    }
                }
            }
        }
    }
}

/// Loads one coordinate of four channels.
#[inline(always)]
fn load<S: Simd>(simd: S, values: &[f64], coordinate: usize) -> f64x4<S> {
    f64x4::from_slice(simd, &values[LANES * coordinate..][..LANES])
}

/// Interpolates the first three coordinates of four channels between two keys.
#[inline(always)]
fn lerp<S: Simd>(simd: S, a: &[f64], b: &[f64], share: f64) -> [[f64; LANES]; 3] {
    let mut moved = [[0.0; LANES]; 3];
    by_axis!(k => {
        let from = load(simd, a, k);
        (from + (load(simd, b, k) - from) * f64x4::splat(simd, share)).store_slice(&mut moved[k]);
    });
    moved
}

/// Computes [`slerp`](super::transform::slerp) of four channels, with the same bits. Lanes are
/// independent. A lane whose sum no longer changes stays unchanged while others go on, because the
/// terms of its series do not alternate, and they shrink.
#[inline(always)]
fn slerp<S: Simd>(simd: S, from: &[f64], to: &[f64], t: f64) -> [[f64; LANES]; 4] {
    let mut turned = [[0.0; LANES]; 4];
    let a = [load(simd, from, 0), load(simd, from, 1), load(simd, from, 2), load(simd, from, 3)];
    if t == 0.0 {
        a[0].store_slice(&mut turned[0]);
        a[1].store_slice(&mut turned[1]);
        a[2].store_slice(&mut turned[2]);
        a[3].store_slice(&mut turned[3]);
        return turned;
    }
    let b = [load(simd, to, 0), load(simd, to, 1), load(simd, to, 2), load(simd, to, 3)];
    let one = f64x4::splat(simd, 1.0);
    let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    let is_far = cosine.simd_lt(f64x4::splat(simd, 0.0));
    let y = cosine.abs().min(one) - one;
    let (square_a, square_b) = ((1.0 - t) * (1.0 - t), t * t);
    let (mut of_a, mut of_b) = (f64x4::splat(simd, 1.0 - t), f64x4::splat(simd, t));
    let (mut term_a, mut term_b) = (of_a, of_b);
    for [of_square, constant] in FACTORS {
        let before = (of_a, of_b);
        term_a *= y * f64x4::splat(simd, of_square * square_a - constant);
        term_b *= y * f64x4::splat(simd, of_square * square_b - constant);
        of_a += term_a;
        of_b += term_b;
        if (of_a.simd_eq(before.0) & of_b.simd_eq(before.1)).all_true() {
            break;
        }
    }
    let of_b = is_far.select(-of_b, of_b);
    let w = of_a * a[0] + of_b * b[0];
    let x = of_a * a[1] + of_b * b[1];
    let y = of_a * a[2] + of_b * b[2];
    let z = of_a * a[3] + of_b * b[3];
    let by = f64x4::splat(simd, 1.5) - f64x4::splat(simd, 0.5) * (w * w + x * x + y * y + z * z);
    (w * by).store_slice(&mut turned[0]);
    (x * by).store_slice(&mut turned[1]);
    (y * by).store_slice(&mut turned[2]);
    (z * by).store_slice(&mut turned[3]);
    turned
}

#[cfg(test)]
mod tests {
    use super::super::transform::normalized;
    use super::*;
    use crate::simd::dispatch_every;
    use crate::simd::kernel_levels;

    /// Returns numbers from -1 to 1 that include zeros, ones and repeated numbers.
    fn some(count: usize) -> Vec<f64> {
        let next = |state: &mut u64| {
            *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let x = (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            Some(if *state >> 61 == 0 { x.round() } else { x })
        };
        (0..count).scan(7, |state, _| next(state)).collect()
    }

    #[test]
    fn four_slerps_match_single_slerps_bit_for_bit_at_every_level() {
        let numbers = some(8 * LANES * 200);
        let mut far = 0;
        for (case, own) in numbers.chunks_exact(8 * LANES).enumerate() {
            let quaternion = |at: usize| normalized([own[at], own[at + 1], own[at + 2], own[at + 3]]);
            let ends = [0, 1, 2, 3]
                .map(|lane| [8 * lane, 8 * lane + 4].map(|at| quaternion(at).unwrap_or([1.0, 0.0, 0.0, 0.0])));
            // Some do not rotate at all, some by half a turn, and some by the small angles between
            // keys of animations.
            let ends = match case % 3 {
                0 => ends,
                1 => ends.map(|[a, b]| [a, normalized([0, 1, 2, 3].map(|k| a[k] + 0.03 * b[k])).unwrap_or(a)]),
                _ => ends.map(|[a, _]| [a, [-a[1], a[0], -a[3], a[2]]]),
            };
            let coordinates = |end: usize| -> Vec<f64> { (0..4).flat_map(|k| ends.map(|pair| pair[end][k])).collect() };
            let t = [0.0, 1.0, 0.5, 0.125, 0.9][case % 5];
            for (name, level) in kernel_levels() {
                let found = dispatch_every!(level, simd => slerp(simd, &coordinates(0), &coordinates(1), t));
                for (lane, [a, b]) in ends.into_iter().enumerate() {
                    let expected = if t == 0.0 { a } else { super::super::transform::slerp(a, b, t) };
                    assert_eq!(
                        [0, 1, 2, 3].map(|k| found[k][lane].to_bits()),
                        expected.map(f64::to_bits),
                        "{name} {case}"
                    );
                    far += u32::from((0..4).map(|k| a[k] * b[k]).sum::<f64>() < 0.0);
                }
            }
        }
        assert!(far > 100, "{far}");
    }
}
