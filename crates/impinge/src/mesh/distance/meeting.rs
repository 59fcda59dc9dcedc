//! Two leaves met: which of their triangles may be nearest, by bounds that cost more and more.

use std::ops::ControlFlow::{self, Continue};

use fearless_simd::Simd;

use super::answer::Answer;
use super::front::Front;
use super::leaf::{Facing, Leaf};
use super::profile::Reached;
use super::search::Search;
use super::together::Together;
use crate::mesh::storage::packet::Packet;
use crate::simd::{LANES, bits};

impl Search<'_> {
    /// Returns what no two of their triangles are nearer than, in metric units.
    #[inline(always)]
    pub(super) fn meet_leaves<S: Simd, const KEEPS: bool>(
        &mut self,
        simd: S,
        [host, guest]: [u32; 2],
        [host_packet, guest_packet]: &[Packet<'_>; 2],
    ) -> ControlFlow<(), f32> {
        let Self { scene, answer, leaves: [at_host, at_guest], profiles, front, .. } = self;
        // Bounds of a front are sought beyond what matters.
        let beyond = if KEEPS { front.as_ref().map_or(1.0, Front::beyond) } else { 1.0 };
        let [on_host, on_guest] = scene.sides();
        let reached = profiles.of_leaves(simd, [host_packet, guest_packet]);
        let mut near = Reached::near(&reached, simd, answer.cut * f64::from(beyond));
        let mut near_guests = 0;
        for lane in bits(guest_packet.lanes_in_use()) {
            near[lane] &= host_packet.lanes_in_use();
            near_guests |= u32::from(near[lane] != 0) << lane;
        }
        let mut limit = answer.limit * beyond;
        if near_guests == 0 {
            return Continue(limit);
        }
        let host = at_host.get(
            host,
            |kept| kept.leaf,
            #[inline(always)]
            |leaf| Leaf::new(simd, leaf, host_packet, scene.meshes[on_host], &scene.metric.maps[on_host]),
        );
        let guest = at_guest.get(
            guest,
            |kept| kept.leaf,
            #[inline(always)]
            |leaf| Leaf::new(simd, leaf, guest_packet, scene.meshes[on_guest], &scene.metric.maps[on_guest]),
        );
        let facing = Facing::new(simd, host, guest, scene.metric.error);
        let pair = |host_lane: usize, guest_lane: usize| {
            let faces = [host_packet.leaf.faces[host_lane], guest_packet.leaf.faces[guest_lane]];
            [faces[on_host], faces[on_guest]]
        };
        let mut least = limit;
        let near_between = facing.near_between(limit);
        let meet = |together: &mut Together, answer: &mut Answer, least: &mut f32| {
            together.raise(simd, &facing, KEEPS);
            if KEEPS {
                *least = together.least(*least);
            }
            while let Some(([host_lane, guest_lane], lower)) = together.take_nearest(answer.limit) {
                if !Reached::are_apart(&reached, [host_lane, guest_lane], answer.cut) {
                    answer.meet_or_put_off(scene, pair(host_lane, guest_lane), lower, facing.slack)?;
                }
            }
            Continue(())
        };
        let mut together = Together::NONE;
        let (of_boxes, mut left, mut order) = (limit, 0, [f32::INFINITY; LANES]);
        for guest_lane in bits(near_guests) {
            near[guest_lane] &= near_between[guest_lane];
            if near[guest_lane] != 0 {
                (near[guest_lane], order[guest_lane]) = facing.near_boxes(guest_lane, near[guest_lane], limit);
                left |= u32::from(near[guest_lane] != 0) << guest_lane;
            }
        }
        while left != 0 {
            let guest_lane = least_of(left, &order);
            left &= !(1 << guest_lane);
            let mut near = near[guest_lane];
            limit = answer.limit * beyond;
            if KEEPS {
                // What is farther than the nearest so far does not make these leaves any nearer.
                limit = limit.min(least.max(answer.limit));
            }
            if limit < of_boxes {
                (near, _) = facing.near_boxes(guest_lane, near, limit);
                if near == 0 {
                    continue;
                }
            }
            let (lower, near) = facing.by_planes(guest_lane, near, limit);
            for host_lane in bits(near) {
                together.push([host_lane, guest_lane], lower[host_lane]);
                if together.is_full() {
                    meet(&mut together, answer, &mut least)?;
                }
            }
        }
        meet(&mut together, answer, &mut least)?;
        self.take_direction();
        Continue(least.min(limit))
    }
}

/// Which of the lanes, one at least, has the least number.
#[inline(always)]
fn least_of(lanes: u32, numbers: &[f32; LANES]) -> usize {
    bits(lanes).fold(
        lanes.trailing_zeros() as usize,
        |least, lane| {
            if numbers[lane] < numbers[least] { lane } else { least }
        },
    )
}
