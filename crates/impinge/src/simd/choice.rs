//! Permutations of eight lanes that are known only at run time.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x8, u32x8};

use super::{LANES, load};

/// A permutation of eight lanes: for each lane of the result its source lane, in the low three bits
/// of one byte. The lowest byte belongs to lane 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice(pub(crate) u64);

impl Choice {
    /// Builds a permutation from the source lane of each lane of the result.
    #[inline(always)]
    pub(crate) fn new(lanes: [usize; LANES]) -> Self {
        Self(u64::from_le_bytes(lanes.map(|lane| lane as u8)))
    }

    /// Returns the permuted lanes.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(self, simd: S, lanes: &[f32; LANES]) -> f32x8<S> {
        match simd.level() {
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(token) => x86::chosen(token, self.0, load(simd, lanes).into()).simd_into(simd),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(token) => x86::chosen_512(token, self.0, load(simd, lanes).into()).simd_into(simd),
            _ => load(simd, &self.one_by_one(lanes)),
        }
    }

    /// Returns the permuted lanes of integers.
    #[inline(always)]
    pub(crate) fn of_numbers<S: Simd>(self, simd: S, lanes: &[u32; LANES]) -> u32x8<S> {
        match simd.level() {
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) | Level::Avx512(_) => self.of(simd, bytemuck::cast_ref(lanes)).bitcast(),
            _ => u32x8::from_slice(simd, &self.one_by_one(lanes)),
        }
    }

    #[inline(always)]
    fn one_by_one<T: Copy>(self, lanes: &[T; LANES]) -> [T; LANES] {
        self.0.to_le_bytes().map(|lane| lanes[usize::from(lane) % LANES])
    }
}

/// One instruction that the portable vectors have no name for.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{__m256, _mm_cvtsi64_si128, _mm256_cvtepu8_epi32, _mm256_permutevar8x32_ps};

    fearless_simd::kernel!(
        #[inline]
        pub(super) fn chosen(token: Avx2, places: u64, lanes: __m256) -> __m256 {
            _mm256_permutevar8x32_ps(lanes, _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(places as i64)))
        }
    );

    fearless_simd::kernel!(
        #[inline]
        pub(super) fn chosen_512(token: Avx512, places: u64, lanes: __m256) -> __m256 {
            _mm256_permutevar8x32_ps(lanes, _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(places as i64)))
        }
    );
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch_every;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::simd::kernel_levels;

    #[test]
    fn each_place_gets_the_lane_of_its_byte() {
        let mut rng = Rng::new(7);
        let lanes = std::array::from_fn(|lane| lane as f32);
        for _ in 0..100 {
            let bytes: [u8; LANES] = std::array::from_fn(|_| rng.integer(0, 255) as u8);
            for (name, level) in kernel_levels() {
                let chosen: [f32; LANES] =
                    dispatch_every!(level, simd => Choice(u64::from_le_bytes(bytes)).of(simd, &lanes).into());
                assert_eq!(chosen, bytes.map(|byte| f32::from(byte % 8)), "{name}");
                // As floats these bits are signaling NaNs, which a processor may quiet.
                let numbers = lanes.map(|lane: f32| 0x7f80_0001 + lane as u32);
                let chosen: [u32; LANES] =
                    dispatch_every!(level, simd => Choice(u64::from_le_bytes(bytes)).of_numbers(simd, &numbers).into());
                assert_eq!(chosen, bytes.map(|byte| 0x7f80_0001 + u32::from(byte % 8)), "{name}");
            }
        }
    }
}
