//! Choosing the vector unit of a kernel at run time.
//!
//! Every level that a kernel is compiled for costs build time, so a kernel is compiled only for levels that can be chosen:
//! - AVX-512 is left out. [`best_level`](super::best_level) never returns it, because it is slower for most kernels. The few kernels
//!   that gain from it use [`fearless_simd::dispatch`] and [`widest_level`](super::widest_level).
//! - The scalar level is compiled only with the feature `scalar`, or on a processor family without vectors.
//! - A build with debug assertions and the feature `scalar` leaves out SSE2 and SSE4.2 too, unless the feature `every-level` is on. It
//!   is the build of a contributor who edits and tests; `cargo xtask test` turns `every-level` on.

/// Runs a kernel with the vector unit of a level: `dispatch!(level, simd => kernel(simd, …))`.
///
/// Levels that are not compiled in run as the next narrower one that is. The kernel must be `#[inline(always)]`.
macro_rules! dispatch {
    ($level:expr, $simd:pat => $op:expr) => {{
        let level = $level;
        'chosen: {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let Some(unit) = level.as_avx2() {
                break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            #[cfg(all(
                any(target_arch = "x86", target_arch = "x86_64"),
                any(not(debug_assertions), not(feature = "scalar"), feature = "every-level")
            ))]
            {
                if let Some(unit) = level.as_sse4_2() {
                    break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
                }
                if let Some(unit) = level.as_sse2() {
                    break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
                }
            }
            #[cfg(target_arch = "aarch64")]
            if let Some(unit) = level.as_neon() {
                break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            #[cfg(feature = "scalar")]
            if let fearless_simd::Level::Fallback(unit) = fearless_simd::Level::fallback() {
                break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
            break 'chosen fearless_simd::dispatch!(level, $simd => $op);
            #[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))]
            unreachable!("{level:?} is compiled in")
        }
    }};
    (@run $unit:expr, $simd:pat => $op:expr) => {{
        let unit = $unit;
        let $simd = unit;
        fearless_simd::Simd::vectorize(
            unit,
            #[inline(always)]
            || $op,
        )
    }};
}

pub(crate) use dispatch;
