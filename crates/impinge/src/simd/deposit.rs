//! Bits brought to other places.

use fearless_simd::{Level, Simd};

/// The lowest bit of `bits` where `mask` has its lowest, the next where it has the next, and so on; zeros elsewhere.
///
/// One instruction where there is one: a loop over bits ends where no processor can foresee it.
#[inline(always)]
pub(crate) fn deposit<S: Simd>(simd: S, bits: u32, mask: u64) -> u64 {
    match simd.level() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(token) => x86::deposited(token, bits, mask),
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(token) => x86::deposited_512(token, bits, mask),
        _ => one_by_one(bits, mask),
    }
}

#[inline(always)]
fn one_by_one(mut bits: u32, mut mask: u64) -> u64 {
    let mut deposited = 0;
    while mask != 0 {
        let lowest = mask & mask.wrapping_neg();
        deposited |= lowest * u64::from(bits & 1);
        mask ^= lowest;
        bits >>= 1;
    }
    deposited
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::_pdep_u64;

    fearless_simd::kernel!(
        #[inline]
        pub(super) fn deposited(token: Avx2, bits: u32, mask: u64) -> u64 {
            _pdep_u64(u64::from(bits), mask)
        }
    );

    fearless_simd::kernel!(
        #[inline]
        pub(super) fn deposited_512(token: Avx512, bits: u32, mask: u64) -> u64 {
            _pdep_u64(u64::from(bits), mask)
        }
    );
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::simd::levels;

    #[test]
    fn each_bit_comes_to_the_place_of_its_turn() {
        let mut rng = Rng::new(8);
        for _ in 0..1000 {
            let set = |rng: &mut Rng, limit| (0..rng.integer(0, limit)).fold(0, |set, _| set | 1_u64 << rng.integer(0, 63));
            let (bits, mask) = (set(&mut rng, 40) as u32, set(&mut rng, 80));
            let places: Vec<usize> = (0..64).filter(|place| mask >> place & 1 != 0).collect();
            let expected = (places.iter().enumerate())
                .filter(|&(turn, _)| turn < 32 && bits >> turn & 1 != 0)
                .fold(0, |set, (_, place)| set | 1_u64 << place);
            for (name, level) in levels() {
                assert_eq!(dispatch!(level, simd => deposit(simd, bits, mask)), expected, "{name}");
            }
        }
    }
}
