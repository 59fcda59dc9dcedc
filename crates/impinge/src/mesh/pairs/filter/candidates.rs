//! Candidates: pairs of triangles whose boxes overlap, side by side until they are judged eight at a time.
//!
//! A pair of leaves has five of them on average, of three triangles on either side. A vector of its own would be filled by half.
//! Each stands about the anchor of its own host leaf, turned and scaled as the host's packed frame, with the error of its own two
//! leaves, so that it does not matter what it stands beside (docs/proof.md, L4).

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, u32x8};

use super::classify::{Triangle, classify};
use crate::mesh::pairs::sides::Sides;
use crate::mesh::storage::triangles::CornerLanes;
use crate::simd::{ALL_LANES, Choice, LANES, Lanes3, by_axis, outlined};

/// All pairs of triangles of two leaves.
const MAX_PAIRS_OF_LEAVES: usize = LANES * LANES;

/// Room for some pairs of leaves as they mostly are, for another of which all triangles are near each other, and for what is written
/// after the last candidate.
const CAPACITY: usize = 24 + MAX_PAIRS_OF_LEAVES + LANES;

/// A number of each candidate.
type Row<T> = [T; CAPACITY];

/// A triangle of each candidate.
#[derive(Debug, bytemuck::Zeroable)]
#[repr(C)]
struct Side {
    /// `[corner][axis]`, in the host's packed frame about the host leaf's anchor.
    corners: [[Row<f32>; 3]; 3],
    /// The greatest extent of its box.
    width: Row<f32>,
}

/// Pairs of triangles, in the order in which they came.
#[derive(Debug)]
pub(crate) struct Candidates {
    /// None before the first candidate: most searches come to none.
    rows: Option<Box<Rows>>,
    count: usize,
}

/// What is known of candidates, and anything after the last.
#[derive(Debug, bytemuck::Zeroable)]
#[repr(C)]
struct Rows {
    host: Side,
    guest: Side,
    /// What the corners of both may be off by together.
    error: Row<f32>,
    /// Which faces they are, of the first mesh and of the second.
    faces: [Row<u32>; 2],
}

/// Of up to eight candidates the lanes of those that are proved to meet, and of those that are left open.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Verdicts {
    pub(crate) intersecting: u32,
    pub(crate) undecided: u32,
    faces: [[u32; LANES]; 2],
}

impl Verdicts {
    /// The faces of a candidate, of the first mesh and of the second.
    #[inline(always)]
    pub(crate) fn faces(&self, lane: usize) -> [u32; 2] {
        [self.faces[0][lane % LANES], self.faces[1][lane % LANES]]
    }
}

/// Which faces the lanes of two leaves hold.
pub(crate) struct LeafFaces<'a> {
    pub(crate) host: &'a [u32; LANES],
    pub(crate) guest: &'a [u32; LANES],
    /// Which mesh is the host.
    pub(crate) sides: Sides,
}

/// The triangles of two leaves, corners and widths, and what moves the guest's to the host's anchor.
pub(super) struct LeafTriangles<'a, S: Simd> {
    pub(super) host: (&'a CornerLanes, &'a [f32; LANES]),
    pub(super) guest: (&'a CornerLanes, &'a [f32; LANES]),
    pub(super) offset: Lanes3<S>,
    pub(super) error: f32x8<S>,
    pub(super) faces: &'a LeafFaces<'a>,
}

impl Candidates {
    /// None yet.
    pub(crate) const EMPTY: Self = Self { rows: None, count: 0 };

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Whether there is room for whatever two leaves come to.
    #[inline(always)]
    pub(crate) fn has_room(&self) -> bool {
        self.count + MAX_PAIRS_OF_LEAVES + LANES <= CAPACITY
    }

    /// Takes the lowest bits away, eight where there are so many, and takes these pairs on. There must be [room](Self::has_room) for
    /// all of two leaves.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, simd: S, pairs: &mut u64, leaves: &LeafTriangles<'_, S>) {
        let all = *pairs;
        let mut places = 0;
        for place in 0..LANES {
            // Without any bits left this is 64, which names the first two triangles.
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

    /// Judges eight candidates from one on, or those that there are.
    #[inline(always)]
    pub(crate) fn classify<S: Simd>(&self, simd: S, at: usize) -> Verdicts {
        let Some(rows) = &self.rows else { return Verdicts::default() };
        outlined(
            simd,
            #[inline(always)]
            || {
                let error = row(simd, &rows.error, at);
                let [intersecting, undecided] = classify(&rows.host.triangles(simd, at), &rows.guest.triangles(simd, at), error);
                let there = ALL_LANES >> LANES.saturating_sub(self.count.saturating_sub(at));
                let faces = rows.faces.each_ref().map(
                    #[inline(always)]
                    |row| u32x8::from_slice(simd, &row[at..at + LANES]).into(),
                );
                Verdicts { intersecting: intersecting & there, undecided: undecided & there, faces }
            },
        )
    }

    /// Forgets the first so many, or all, so that less than eight are left.
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

#[inline(always)]
fn store<S: Simd>(lanes: f32x8<S>, row: &mut Row<f32>, at: usize) {
    lanes.store_slice(&mut row[at..at + LANES]);
}

#[inline(always)]
fn row<S: Simd>(simd: S, row: &Row<f32>, at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &row[at..at + LANES])
}
