//! Choosing the vector unit of a kernel at run time.
//!
//! A kernel is compiled once for each level that it can run at, and each copy costs build time. So
//! kernels are compiled only for levels that queries choose:
//! - AVX-512 only for kernels that gain from it. [`best_level`](super::best_level) never returns it.
//! - Scalar arithmetic only for processors without vectors, or if the feature `scalar` is on. It
//!   takes the compiler longer than all other levels together. Tests of single kernels use
//!   [`fearless_simd::dispatch`], which always compiles it.

/// Runs a kernel with the vector unit of a level: `dispatch!(level, simd => kernel(simd, …))`.
///
/// If the kernel is not compiled for the level, it runs with the next narrower unit that it is
/// compiled for, or with the narrowest. The kernel must be `#[inline(always)]`.
macro_rules! dispatch {
    ($level:expr, $simd:pat => $op:expr) => {{
        let level: $crate::simd::Level = $level;
        'chosen: {
            #[cfg(any(feature = "scalar", not(any(target_feature = "sse2", target_feature = "neon"))))]
            if let fearless_simd::Level::Fallback(unit) = level {
                break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            {
                if let Some(unit) = level.as_avx2() {
                    break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
                }
                if let Some(unit) = level.as_sse4_2() {
                    break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
                }
                let Some(unit) = level.as_sse2().or_else(|| $crate::simd::Level::baseline().as_sse2()) else {
                    unreachable!("without SSE2 the level is the scalar one")
                };
                break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            #[cfg(target_arch = "aarch64")]
            {
                let Some(unit) = level.as_neon().or_else(|| $crate::simd::Level::baseline().as_neon()) else {
                    unreachable!("without NEON the level is the scalar one")
                };
                break 'chosen $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
            break 'chosen fearless_simd::dispatch!(level, $simd => $op);
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

/// Runs a kernel as [`dispatch!`] does, and with AVX-512 if the level is AVX-512.
macro_rules! dispatch_widest {
    ($level:expr, $simd:pat => $op:expr) => {{
        let level: $crate::simd::Level = $level;
        'widest: {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let Some(unit) = level.as_avx512() {
                break 'widest $crate::simd::dispatch!(@run unit, $simd => $op);
            }
            $crate::simd::dispatch!(level, $simd => $op)
        }
    }};
}

pub(crate) use {dispatch, dispatch_widest};
