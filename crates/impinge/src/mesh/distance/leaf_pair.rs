//! Compares the triangles of two leaves by several bounds. Faster bounds come first, and tighter
//! ones that cost more follow.
//!
//! Guarded by `tests/it/distance/meshes.rs`.

use std::ops::ControlFlow::{self, Continue};

use fearless_simd::Simd;

use super::answer::Answer;
use super::cache::Cache;
use super::direction_bounds::{DirectionBounds, Reached};
use super::leaf::{Facing, Leaf};
use super::pair_batch::PairBatch;
use super::scene::Scene;
use crate::mesh::storage::packet::Packet;
use crate::simd::{LANES, bits};

/// Number of leaves of either mesh that are cached in the metric frame, a power of two. They fill
/// half of a second-level cache.
const CACHED_LEAVES: usize = 128;

/// The leaves of host and guest that were most recently carried into the metric frame.
pub(super) type LeafCaches = [Cache<Leaf, CACHED_LEAVES>; 2];

/// The parts of a search that change when two leaves are compared.
pub(super) struct Progress<'s, 'm> {
    pub(super) answer: &'s mut Answer,
    pub(super) leaves: &'s mut LeafCaches,
    pub(super) direction_bounds: &'s mut DirectionBounds<'m>,
    /// Factor on the answer's limit up to which bounds are computed: above one if a frontier keeps
    /// the bounds, else one.
    pub(super) beyond: f32,
}

/// Two leaves whose triangles are compared.
struct LeafPair<'l, S: Simd> {
    simd: S,
    facing: Facing<'l, S>,
    /// Reaches of the triangles along the newest direction, if there is one.
    reached: Option<Reached>,
    packets: &'l [Packet<'l>; 2],
    /// Indices of host and guest among the two meshes.
    sides: [usize; 2],
}

/// The guest lanes that are still to be compared.
struct GuestLanes {
    /// For each guest lane the host lanes that are not proved too far away, as bits.
    near: [u32; LANES],
    /// Guest lanes that have such host lanes, as bits.
    left: u32,
    /// Order of the guest lanes: the lane with the least number is compared first.
    order: [f32; LANES],
}

/// Compares the triangles of two leaves. Returns a lower bound of the distances of their pairs, in
/// metric units. Breaks if the query is answered.
#[inline(always)]
pub(super) fn process_leaves<S: Simd, const KEEPS: bool>(
    simd: S,
    scene: &Scene<'_>,
    [host, guest]: [u32; 2],
    packets: &[Packet<'_>; 2],
    Progress { answer, leaves: [host_leaves, guest_leaves], direction_bounds, beyond }: Progress<'_, '_>,
) -> ControlFlow<(), f32> {
    let [host_packet, guest_packet] = packets;
    let sides = scene.sides();
    let reached = direction_bounds.of_leaves(simd, [host_packet, guest_packet]);
    let near = Reached::near(&reached, simd, answer.cut * f64::from(beyond));
    let used = if answer.skips_copies {
        first_lanes(scene, packets)
    } else {
        packets.each_ref().map(|packet| packet.lanes_in_use())
    };
    let (near, near_guests) = lanes_in_use(near, used);
    let limit = answer.limit * beyond;
    if near_guests == 0 {
        return Continue(limit);
    }
    let [on_host, on_guest] = sides;
    let host = host_leaves.get(
        host,
        |kept| kept.leaf,
        #[inline(always)]
        |leaf| Leaf::new(simd, leaf, host_packet, scene.meshes[on_host], &scene.metric.maps[on_host]),
    );
    let guest = guest_leaves.get(
        guest,
        |kept| kept.leaf,
        #[inline(always)]
        |leaf| Leaf::new(simd, leaf, guest_packet, scene.meshes[on_guest], &scene.metric.maps[on_guest]),
    );
    let facing = Facing::new(simd, host, guest, scene.metric.error);
    let pair = LeafPair { simd, facing, reached, packets, sides };
    let lanes = pair.near_by_boxes(near, near_guests, limit);
    let least = pair.process_lanes::<KEEPS>(scene, answer, lanes, beyond)?;
    direction_bounds.update(scene, answer.best.as_ref());
    Continue(least)
}

/// Returns the lanes of host and guest that hold a triangle without an earlier copy, as bits.
#[cold]
fn first_lanes(scene: &Scene<'_>, packets: &[Packet<'_>; 2]) -> [u32; 2] {
    let sides = scene.sides();
    [0, 1].map(|k| {
        let copies = scene.meshes[sides[k]].copies();
        packets[k].lanes_in_use() & copies.first_lanes(&packets[k].leaf.faces)
    })
}

/// Removes the lanes that are not in use. Returns the host lanes of each guest lane, and the guest
/// lanes that have any, as bits.
#[inline(always)]
fn lanes_in_use(mut near: [u32; LANES], [host, guest]: [u32; 2]) -> ([u32; LANES], u32) {
    let mut near_guests = 0;
    for lane in bits(guest) {
        near[lane] &= host;
        near_guests |= u32::from(near[lane] != 0) << lane;
    }
    (near, near_guests)
}

impl<S: Simd> LeafPair<'_, S> {
    /// Removes the lanes that are farther away than `limit` along the line between the leaves, or
    /// by their boxes.
    #[inline(always)]
    fn near_by_boxes(&self, mut near: [u32; LANES], near_guests: u32, limit: f32) -> GuestLanes {
        let near_between = self.facing.near_between(limit);
        let (mut left, mut order) = (0, [f32::INFINITY; LANES]);
        for guest_lane in bits(near_guests) {
            near[guest_lane] &= near_between[guest_lane];
            if near[guest_lane] != 0 {
                (near[guest_lane], order[guest_lane]) = self.facing.near_boxes(guest_lane, near[guest_lane], limit);
                left |= u32::from(near[guest_lane] != 0) << guest_lane;
            }
        }
        GuestLanes { near, left, order }
    }

    /// Compares the triangles of the lanes, the nearest guest lane first. Returns a lower bound of
    /// the distances of all pairs of the leaves, in metric units.
    #[inline(always)]
    fn process_lanes<const KEEPS: bool>(
        &self,
        scene: &Scene<'_>,
        answer: &mut Answer,
        GuestLanes { near, mut left, order }: GuestLanes,
        beyond: f32,
    ) -> ControlFlow<(), f32> {
        let mut limit = answer.limit * beyond;
        let (of_boxes, mut least) = (limit, limit);
        let mut batch = PairBatch::NONE;
        while left != 0 {
            let guest_lane = least_of(left, &order);
            left &= !(1 << guest_lane);
            let mut near = near[guest_lane];
            limit = answer.limit * beyond;
            if KEEPS {
                // A pair that is farther than the nearest pair so far does not lower the bound of
                // the leaves.
                limit = limit.min(least.max(answer.limit));
            }
            if limit < of_boxes {
                (near, _) = self.facing.near_boxes(guest_lane, near, limit);
                if near == 0 {
                    continue;
                }
            }
            let (lower, near) = self.facing.by_planes(guest_lane, near, limit);
            for host_lane in bits(near) {
                batch.push([host_lane, guest_lane], lower[host_lane]);
                if batch.is_full() {
                    self.process_batch::<KEEPS>(scene, answer, &mut batch, &mut least)?;
                }
            }
        }
        self.process_batch::<KEEPS>(scene, answer, &mut batch, &mut least)?;
        Continue(least.min(limit))
    }

    /// Raises the bounds of a batch and computes the values of its nearest pairs. Lowers `least` to
    /// the bounds.
    #[inline]
    fn process_batch<const KEEPS: bool>(
        &self,
        scene: &Scene<'_>,
        answer: &mut Answer,
        batch: &mut PairBatch,
        least: &mut f32,
    ) -> ControlFlow<()> {
        batch.raise(self.simd, &self.facing, KEEPS);
        if KEEPS {
            *least = batch.least(*least);
        }
        while let Some((lanes, lower)) = batch.take_nearest(answer.limit) {
            if !Reached::are_apart(&self.reached, lanes, answer.cut) {
                answer.process_or_defer(scene, self.faces(lanes), lower, self.facing.slack)?;
            }
        }
        Continue(())
    }

    /// Returns the faces of two lanes, of the first and the second mesh.
    #[inline(always)]
    fn faces(&self, [host_lane, guest_lane]: [usize; 2]) -> [u32; 2] {
        let [host, guest] = self.packets;
        let faces = [host.leaf.faces[host_lane], guest.leaf.faces[guest_lane]];
        self.sides.map(|side| faces[side])
    }
}

/// Returns the lane with the least number. At least one bit of `lanes` must be set.
#[inline(always)]
fn least_of(lanes: u32, numbers: &[f32; LANES]) -> usize {
    bits(lanes).fold(
        lanes.trailing_zeros() as usize,
        |least, lane| {
            if numbers[lane] < numbers[least] { lane } else { least }
        },
    )
}
