//! Choosing the vector unit of a kernel at run time.
//!
//! A kernel is compiled once for each level that it can run at, and each copy costs build time. So
//! kernels are compiled only for levels that queries choose:
//! - AVX2 and SSE2, or NEON, always.
//! - SSE4.2 if the feature `all-levels` is on, as it is by default.
//! - AVX-512 too, but only for kernels that gain from it. [`best_level`](super::best_level) never
//!   returns it.
//! - Scalar arithmetic only for processors without vectors, or if the feature `scalar` is on. It
//!   takes the compiler longer than all other levels together. Tests of single kernels use
//!   `dispatch_every!`, which compiles it if `all-levels` is on.

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
                #[cfg(feature = "all-levels")]
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
        #[cfg(all(feature = "all-levels", any(target_arch = "x86", target_arch = "x86_64")))]
        let result = if let Some(unit) = level.as_avx512() {
            $crate::simd::dispatch!(@run unit, $simd => $op)
        } else {
            $crate::simd::dispatch!(level, $simd => $op)
        };
        #[cfg(not(all(feature = "all-levels", any(target_arch = "x86", target_arch = "x86_64"))))]
        let result = $crate::simd::dispatch!(level, $simd => $op);
        result
    }};
}

/// Runs a kernel with the vector unit of a level that [`kernel_levels`](super::kernel_levels)
/// returns.
#[cfg(test)]
macro_rules! dispatch_every {
    ($level:expr, $simd:pat => $op:expr) => {{
        #[cfg(feature = "all-levels")]
        let result = fearless_simd::dispatch!($level, $simd => $op);
        #[cfg(not(feature = "all-levels"))]
        let result = $crate::simd::dispatch!($level, $simd => $op);
        result
    }};
}

#[cfg(test)]
pub(crate) use dispatch_every;
pub(crate) use {dispatch, dispatch_widest};
