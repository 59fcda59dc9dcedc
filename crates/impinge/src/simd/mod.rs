//! The vector units of the processor, found at run time.
//!
//! Kernels are written once over [`fearless_simd`]'s lanes and compiled for several [`Level`]s. The
//! best level that the processor has is chosen when a query starts. No answer depends on the level:
//! lanes only *reject* or *confirm* within proved bounds, and what they leave undecided is decided
//! exactly.

mod bits;
mod choice;
mod dispatch;
mod prefetch;
mod rows;
mod vectors;

/// Expands to `[body, body, body]` with `axis` 0, 1 and 2. This is a macro because a closure that
/// the compiler does not inline loses the vector unit of its caller.
macro_rules! by_axis {
    ($axis:ident => $body:expr) => {
        [
            {
                let $axis = 0;
                $body
            },
            {
                let $axis = 1;
                $body
            },
            {
                let $axis = 2;
                $body
            },
        ]
    };
}

pub(crate) use by_axis;

pub(crate) use bits::{any_byte, bits, each_byte, extend_some, nonzero_bytes, spread_to_bytes, take_four};
pub(crate) use choice::Choice;
#[cfg(test)]
pub(crate) use dispatch::dispatch_every;
pub(crate) use dispatch::{dispatch, dispatch_widest};
pub(crate) use prefetch::{CACHE_LINE, prefetch, prefetch_at};
pub(crate) use rows::Rows;
pub(crate) use vectors::{Lanes3, across, across3, cross, dot, load, load3, store3, sub, transposed};

pub use fearless_simd::Level;

/// Runs a kernel as a function of its own with the vector unit of `simd`. The kernel must be
/// inlined into this function (`#[inline(always)] || …`). Use it for large kernels with several
/// callers, each of which would otherwise contain a copy. One function for all kernels together
/// would be a megabyte at the scalar level and take minutes to compile.
#[inline(never)]
pub(crate) fn outlined<S: fearless_simd::Simd, R>(simd: S, kernel: impl FnOnce() -> R) -> R {
    simd.vectorize(kernel)
}

/// Number of boxes in a node and of triangles in a packet: the lanes of one 256-bit vector of
/// single precision. Narrower levels split such a vector. Wider vectors do not gain: with AVX-512
/// one 512-bit comparison costs as much as two 256-bit ones.
pub const LANES: usize = 8;

/// The set of all lanes.
pub(crate) const ALL_LANES: u32 = (1 << LANES) - 1;

/// Returns the level that queries use by default: the widest of this processor except AVX-512.
/// AVX-512 compares 256-bit vectors into mask registers, which made the same descent 1.1 to 1.3
/// times slower than AVX2 on both processors measured (Zen 4 and Zen 5).
#[must_use]
pub fn best_level() -> Level {
    let widest = Level::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(token) = widest.as_avx2() {
        return Level::Avx2(token);
    }
    widest
}

/// Returns the widest level of this processor, AVX-512 included. It is for kernels that compress
/// lanes, for which AVX-512 has an instruction.
#[must_use]
pub(crate) fn widest_level() -> Level {
    Level::new()
}

/// Returns every level that this processor can run and that queries are compiled for, with its
/// name, the narrowest first. Tests ask each level the same questions. Scalar arithmetic is
/// included if the feature `scalar` is on, and SSE4.2 if `all-levels` is on.
#[must_use]
pub fn levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = Vec::new();
    #[cfg(feature = "scalar")]
    levels.push(("scalar", Level::fallback()));
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(|token| ("sse2", Level::Sse2(token))));
        #[cfg(feature = "all-levels")]
        levels.extend(best.as_sse4_2().map(|token| ("sse4.2", Level::Sse4_2(token))));
        levels.extend(best.as_avx2().map(|token| ("avx2", Level::Avx2(token))));
    }
    #[cfg(target_arch = "aarch64")]
    levels.extend(best.as_neon().map(|token| ("neon", Level::Neon(token))));
    levels
}

/// Returns every level that this processor can run, for tests that call a kernel by
/// `dispatch_every!`: the scalar one first and AVX-512 too.
#[cfg(all(test, feature = "all-levels"))]
pub(crate) fn kernel_levels() -> Vec<(&'static str, Level)> {
    let mut all = levels();
    all.retain(|(name, _)| *name != "scalar");
    all.insert(0, ("scalar", Level::fallback()));
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    all.extend(Level::new().as_avx512().map(|token| ("avx512", Level::Avx512(token))));
    all
}

#[cfg(all(test, not(feature = "all-levels")))]
pub(crate) use levels as kernel_levels;
