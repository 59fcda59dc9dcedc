//! Candidates: pairs of triangles whose boxes overlap, collected side by side until they are
//! classified eight at a time.
//!
//! A pair of leaves has five candidates on average, from three triangles on either side. A vector
//! per pair of leaves would be half full. Each candidate is relative to the local origin of its own
//! host leaf, in the orientation and scale of the host's packed frame, with the error of its own
//! two leaves. So its neighbors in the vector do not matter (docs/notes/proof.md, L4).
//!
//! Guarded by `other_candidates_of_a_batch_change_no_verdict` in the tests of the filter, and by
//! the benchmark `headline`.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, u32x8};

use super::classify::{Triangle, classify};
use crate::mesh::pairs::sides::Sides;
use crate::mesh::storage::triangles::CornerLanes;
use crate::simd::{ALL_LANES, Choice, LANES, Lanes3, by_axis, outlined};

/// Maximum number of pairs of triangles of two leaves.
const MAX_PAIRS_OF_LEAVES: usize = LANES * LANES;

/// Capacity of the rows. It has room for the candidates of a few typical pairs of leaves, for all
/// pairs of two more leaves, and for the lanes that are written after the last candidate.
const CAPACITY: usize = 24 + MAX_PAIRS_OF_LEAVES + LANES;

/// One number for each candidate.
type Row<T> = [T; CAPACITY];

/// One triangle for each candidate.
#[derive(Debug, bytemuck::Zeroable)]
#[repr(C)]
struct Side {
    /// Corners as `[corner][axis]`, in the packed frame of the host relative to the host leaf's
    /// local origin.
    corners: [[Row<f32>; 3]; 3],
    /// Maximum extent of the triangle's box.
    width: Row<f32>,
}

/// Pairs of triangles that are not classified yet, in the order in which they were added.
#[derive(Debug)]
pub(crate) struct Candidates {
    /// `None` before the first candidate, as most searches have none.
    rows: Option<Box<Rows>>,
    count: usize,
}

/// The data of the candidates; entries after the last candidate have no meaning.
#[derive(Debug, bytemuck::Zeroable)]
#[repr(C)]
struct Rows {
    host: Side,
    guest: Side,
    /// Error bound of the corners of both triangles together.
    error: Row<f32>,
    /// Faces of the first mesh and of the second.
    faces: [Row<u32>; 2],
}

/// Verdicts on up to eight candidates. Those that are neither intersecting nor undecided are apart.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Verdicts {
    /// Candidates that are proved to intersect, as bits.
    pub(crate) intersecting: u32,
    /// Candidates that are undecided, as bits.
    pub(crate) undecided: u32,
    faces: [[u32; LANES]; 2],
}

impl Verdicts {
    /// Returns the faces of a candidate, of the first mesh and of the second.
    #[inline(always)]
    pub(crate) fn faces(&self, lane: usize) -> [u32; 2] {
        [self.faces[0][lane % LANES], self.faces[1][lane % LANES]]
    }
}

/// The faces in the lanes of two leaves.
pub(crate) struct LeafFaces<'a> {
    pub(crate) host: &'a [u32; LANES],
    pub(crate) guest: &'a [u32; LANES],
    /// Which mesh is the host.
    pub(crate) sides: Sides,
}

/// The triangles of two leaves as corners and widths, with the vector `offset` that makes guest
/// corners relative to the host's local origin.
pub(super) struct LeafTriangles<'a, S: Simd> {
    pub(super) host: (&'a CornerLanes, &'a [f32; LANES]),
    pub(super) guest: (&'a CornerLanes, &'a [f32; LANES]),
    pub(super) offset: Lanes3<S>,
    pub(super) error: f32x8<S>,
    pub(super) faces: &'a LeafFaces<'a>,
}

impl Candidates {
    /// No candidates.
    pub(crate) const EMPTY: Self = Self { rows: None, count: 0 };

    /// Returns the number of candidates.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Reports whether there is room for all pairs of triangles of two leaves.
    #[inline(always)]
    pub(crate) fn has_room(&self) -> bool {
        self.count + MAX_PAIRS_OF_LEAVES + LANES <= CAPACITY
    }

    /// Removes the lowest bits of `pairs`, up to eight, and appends their pairs. There must be
    /// [room](Self::has_room) for all pairs of two leaves.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, simd: S, pairs: &mut u64, leaves: &LeafTriangles<'_, S>) {
        let all = *pairs;
        let mut places = 0;
        for place in 0..LANES {
            // This is 64 if no bit is left, which selects the first triangle of each leaf.
            places |= u64::from(pairs.trailing_zeros()) << (8 * place);
            *pairs &= pairs.wrapping_sub(1);
        }
        let at = self.count;
        let rows = self.rows.get_or_insert_with(bytemuck::zeroed_box);
        let (of_host, of_guest) = (Choice(places), Choice(places >> LANES.trailing_zeros()));
        let ((host, host_width), (guest, guest_width)) = (leaves.host, leaves.guest);
        for corner in 0..3 {
            for axis in 0..3 {
                store(of_host.of(simd, &host[corner][axis]), &mut rows.host.corners[corner][axis], at);
                let moved = of_guest.of(simd, &guest[corner][axis]) + leaves.offset[axis];
                store(moved, &mut rows.guest.corners[corner][axis], at);
            }
        }
        store(of_host.of(simd, host_width), &mut rows.host.width, at);
        store(of_guest.of(simd, guest_width), &mut rows.guest.width, at);
        store(leaves.error, &mut rows.error, at);
        let LeafFaces { host, guest, sides } = leaves.faces;
        let [hosts, guests] = sides.host_guest(rows.faces.each_mut());
        of_host.of_numbers(simd, host).store_slice(&mut hosts[at..at + LANES]);
        of_guest.of_numbers(simd, guest).store_slice(&mut guests[at..at + LANES]);
        self.count = at + (all ^ *pairs).count_ones() as usize;
    }

    /// Classifies the candidates from `at` on, eight at most.
    #[inline(always)]
    pub(crate) fn classify<S: Simd>(&self, simd: S, at: usize) -> Verdicts {
        let Some(rows) = &self.rows else { return Verdicts::default() };
        outlined(
            simd,
            #[inline(always)]
            || {
                let error = row(simd, &rows.error, at);
                let [intersecting, undecided] =
                    classify(&rows.host.triangles(simd, at), &rows.guest.triangles(simd, at), error);
                let there = ALL_LANES >> LANES.saturating_sub(self.count.saturating_sub(at));
                let faces = rows.faces.each_ref().map(
                    #[inline(always)]
                    |row| u32x8::from_slice(simd, &row[at..at + LANES]).into(),
                );
                Verdicts { intersecting: intersecting & there, undecided: undecided & there, faces }
            },
        )
    }

    /// Removes the first `count` candidates, so that fewer than eight are left. `count` may exceed
    /// the number of candidates.
    #[inline(always)]
    pub(crate) fn remove_first(&mut self, count: usize) {
        let Some(rows) = &mut self.rows else { return };
        for side in [&mut rows.host, &mut rows.guest] {
            side.corners.as_flattened_mut().iter_mut().for_each(|row| row.copy_within(count..count + LANES, 0));
            side.width.copy_within(count..count + LANES, 0);
        }
        rows.error.copy_within(count..count + LANES, 0);
        rows.faces.iter_mut().for_each(|row| row.copy_within(count..count + LANES, 0));
        self.count = self.count.saturating_sub(count);
    }
}

impl Side {
    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, at: usize) -> Triangle<S> {
        Triangle {
            corners: by_axis!(corner => by_axis!(axis => row(simd, &self.corners[corner][axis], at))),
            width: row(simd, &self.width, at),
        }
    }
}

/// Writes eight entries of a row.
#[inline(always)]
fn store<S: Simd>(lanes: f32x8<S>, row: &mut Row<f32>, at: usize) {
    lanes.store_slice(&mut row[at..at + LANES]);
}

/// Loads eight entries of a row.
#[inline(always)]
fn row<S: Simd>(simd: S, row: &Row<f32>, at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &row[at..at + LANES])
}
