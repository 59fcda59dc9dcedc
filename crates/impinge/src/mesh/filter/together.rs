//! Pairs of triangles of two packets brought side by side, whichever triangles they are of.

use fearless_simd::Simd;

use super::{Guest, Triangle};
use crate::mesh::triangles::CornerLanes;
use crate::simd::{Choice, LANES, Lanes3, by_axis, cross, deposit, sub};

/// Up to eight pairs of triangles of two packets.
#[derive(Clone, Copy)]
pub(super) struct Together {
    /// The bit of each pair, as [`Verdicts`] has them, in a byte of its own.
    places: u64,
    /// These bits.
    taken: u64,
}

impl Together {
    /// Takes the lowest bits away, eight where there are so many.
    #[inline(always)]
    pub(super) fn take(bits: &mut u64) -> Self {
        let all = *bits;
        let mut places = 0;
        for place in 0..LANES {
            // Without any bits left this is 64, which names the first two triangles.
            places |= u64::from(bits.trailing_zeros()) << (8 * place);
            *bits &= bits.wrapping_sub(1);
        }
        Self { places, taken: all ^ *bits }
    }

    /// The bits of the pairs of which the lanes are set.
    #[inline(always)]
    pub(super) fn bits<S: Simd>(self, simd: S, lanes: u32) -> u64 {
        deposit(simd, lanes, self.taken)
    }

    /// The host's triangle of each pair.
    #[inline(always)]
    pub(super) fn hosts<S: Simd>(self, simd: S, corners: &CornerLanes, width: &[f32; LANES]) -> Triangle<S> {
        let choice = Choice(self.places);
        let corners: [Lanes3<S>; 3] = by_axis!(corner => by_axis!(axis => choice.of(simd, &corners[corner][axis])));
        let normal = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
        Triangle { corners, normal, width: choice.of(simd, width) }
    }

    /// The guest's triangle of each pair, moved.
    #[inline(always)]
    pub(super) fn guests<S: Simd>(self, simd: S, guest: &Guest, offset: &Lanes3<S>) -> Triangle<S> {
        let choice = Choice(self.places >> LANES.trailing_zeros());
        Triangle {
            corners: by_axis!(corner => by_axis!(axis => {
                choice.of(simd, &guest.corners[corner][axis]) + offset[axis]
            })),
            normal: by_axis!(axis => choice.of(simd, &guest.normal[axis])),
            width: choice.of(simd, &guest.width),
        }
    }
}
