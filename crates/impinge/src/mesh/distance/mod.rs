//! The nearest points of two meshes, by branch and bound over both trees.
//!
//! Source: Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*, ICRA 2000, for distance by
//! the descent of two trees; ours opens eight children against eight, nearest first, on bounds that are proved.
//!
//! Whether the meshes intersect is asked first, and decided exactly. Where they do not, every pair of faces has a *value*,
//! the distance of their metric corners by the closed form, which depends on nothing but the pair and the query. The answer
//! is the least (value, face of a, face of b) of all pairs. A pair is left out only where it is proved to be worse. So
//! neither the order of the descent nor the vector unit can be seen in the answer.

mod answer;
mod at_hand;
mod between;
mod bounds;
mod leaf;
mod profile;
mod remote;
mod task;
mod together;
mod towards;

use std::ops::ControlFlow::{self, Continue};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch, f32x8};

use super::metric::Metric;
use super::packet::{Packet, Packets};
use super::{HostChoice, Options, Placed, first_hit};
use crate::exact::Placement;
use crate::hierarchy::{BoxLanes, Child, Node, bits, lanes_in_use};
use crate::primitive::Vector;
use crate::simd::{LANES, by_axis};
use crate::volume::Aabb;
use answer::{Answer, Scene};
use at_hand::AtHand;
use between::Between;
use bounds::Bounds;
use leaf::{Facing, Leaf};
use profile::{Profiles, Reached};
use task::{Slot, Sorted, Task};
use together::Together;

/// The nearest points of two meshes, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) points: [Vector; 2],
    pub(crate) faces: [u32; 2],
}

/// The nearest points, none where a mesh has no faces. The faces of `seed`, if there are such, are tried first.
///
/// Where the meshes intersect the faces are the first that meet in the descent that the meshes' own errors choose.
pub(crate) fn nearest(a: Placed<'_>, b: Placed<'_>, seed: Option<[u32; 2]>, options: &Options) -> Option<Nearest> {
    let any = Options { host: HostChoice::SmallerError, ..*options };
    if let Some(faces) = first_hit(a, b, &any) {
        return Some(answer::meeting(a, b, faces));
    }
    let mut search = Search::new(a, b, options, f64::INFINITY)?;
    if let Some((best, aside)) = remote::nearest(&search.scene) {
        return Some(search.scene.finish(&best, aside));
    }
    search.run(seed, options);
    let error = search.scene.metric.error;
    let doubt = if search.answer.values_left == 0 { 6.0 * error } else { 0.0 };
    search.answer.best.map(|best| search.scene.finish(&best, doubt))
}

/// Faces that are no farther apart than `clearance`, if there are such; those of `seed` are tried first.
pub(crate) fn within(
    a: Placed<'_>,
    b: Placed<'_>,
    clearance: f64,
    seed: Option<[u32; 2]>,
    options: &Options,
) -> Option<[u32; 2]> {
    if clearance.is_nan() || clearance < 0.0 || a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
        return None;
    }
    if clearance == f64::INFINITY {
        return Some([0, 0]);
    }
    let mut search = Search::new(a, b, options, clearance)?;
    search.run(seed, options);
    search.answer.kept
}

/// Children whose boxes differ in size by more than this are not opened together: the larger one alone comes nearer to
/// the other's size.
const OPENED_TOGETHER: f32 = 4.0;

/// Leaves of either mesh that are kept at hand; a power of two. They fill half of a second cache.
const LEAVES_AT_HAND: usize = 128;

/// Nodes of either mesh whose boxes are kept carried over; a power of two.
const CARRIED_AT_HAND: usize = 32;

/// The two sides of a search, by their places.
const HOST: usize = 0;
const GUEST: usize = 1;

/// Of the arrays of two the first is the host's and the second the guest's.
struct Search<'a> {
    scene: Scene<'a>,
    answer: Answer,
    nodes: [&'a [Node]; 2],
    packets: [Packets<'a>; 2],
    tasks: Vec<Task>,
    found: Sorted,
    leaves: [AtHand<Leaf, LEAVES_AT_HAND>; 2],
    carried: [AtHand<Carried, CARRIED_AT_HAND>; 2],
    profiles: Profiles<'a>,
    between: Between,
}

#[derive(Clone, Debug)]
struct Carried {
    node: u32,
    boxes: BoxLanes,
}

impl<'a> Search<'a> {
    /// None where a mesh has no faces.
    fn new(a: Placed<'a>, b: Placed<'a>, options: &Options, clearance: f64) -> Option<Self> {
        if a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
            return None;
        }
        let metric = Metric::new(a, b);
        let bounds = Bounds::new(a, b, &metric, options.host);
        let (host, guest) = if bounds.swapped { (b.mesh, a.mesh) } else { (a.mesh, b.mesh) };
        let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
        let scene = Scene { meshes: [a.mesh, b.mesh], metric, placement, bounds, clearance };
        let metric = &scene.metric;
        let farthest = if clearance == f64::INFINITY { metric.diagonal } else { clearance * metric.scale };
        let answer = Answer::new(&scene, farthest + 2.0 * metric.error);
        let between = Between::new([host, guest], metric, scene.sides());
        Some(Self {
            scene,
            answer,
            nodes: [host.0.tree.nodes(), guest.0.tree.nodes()],
            packets: [host.packets(), guest.packets()],
            tasks: Vec::new(),
            found: Sorted::new(),
            leaves: [AtHand::new(), AtHand::new()],
            carried: [AtHand::new(), AtHand::new()],
            profiles: Profiles::new([host, guest]),
            between,
        })
    }

    fn run(&mut self, seed: Option<[u32; 2]>, options: &Options) {
        let scene = &self.scene;
        let exists = |faces: &[u32; 2]| [0, 1].iter().all(|&m| (faces[m] as usize) < scene.meshes[m].faces().len());
        if let Some(faces) = seed.filter(exists)
            && self.answer.meet(scene, faces).is_break()
        {
            return;
        }
        self.take_direction();
        let level = options.level;
        if dispatch!(level, simd => self.descend(simd)).is_continue() {
            let _ = self.answer.meet_put_off(&self.scene);
        }
    }

    /// Bounds what is left along the direction between the best witnesses.
    #[inline(always)]
    fn take_direction(&mut self) {
        let Self { scene, answer, profiles, .. } = self;
        if let Some(best) = &answer.best {
            let (sides, on) = (scene.sides(), [&best.witness.on_a, &best.witness.on_b]);
            profiles.take(sides.map(|side| on[side]), best.value, &scene.metric, sides);
        }
    }

    #[inline(always)]
    fn descend<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        self.open_both(simd, 0, 0);
        while let Some(task) = self.tasks.pop() {
            if task.bound > self.answer.node_limit {
                continue;
            }
            if self.profiles.are_apart(simd, task.reach, task.slots, self.answer.cut) {
                continue;
            }
            let [host, guest] = task.slots;
            let (host_node, guest_node) =
                (&self.nodes[HOST][host.node as usize], &self.nodes[GUEST][guest.node as usize]);
            let (host_lane, guest_lane) = (usize::from(host.lane), usize::from(guest.lane));
            let (host_box, guest_box) = (host_node.lane_bounds(host_lane), guest_node.lane_bounds(guest_lane));
            let line = self.between.line(&host_box, &guest_box);
            if line.is_longer(self.answer.cut) {
                continue;
            }
            match (host_node.child(host_lane), guest_node.child(guest_lane)) {
                (Child::Leaf(host), Child::Leaf(guest)) => {
                    let packets = [self.packets[HOST].get(simd, host), self.packets[GUEST].get(simd, guest)];
                    if !line.is_longer_for_leaves(&packets, self.answer.cut) {
                        self.meet_leaves(simd, [host, guest], &packets)?;
                    }
                }
                (Child::Inner(node), Child::Leaf(_)) => self.open_one(simd, HOST, node, guest),
                (Child::Leaf(_), Child::Inner(node)) => self.open_one(simd, GUEST, node, host),
                (Child::Inner(host_node), Child::Inner(guest_node)) => {
                    let host_size = size(&self.box_of(simd, HOST, host));
                    let guest_size = size(&self.box_of(simd, GUEST, guest));
                    if host_size > OPENED_TOGETHER * guest_size {
                        self.open_one(simd, HOST, host_node, guest);
                    } else if guest_size > OPENED_TOGETHER * host_size {
                        self.open_one(simd, GUEST, guest_node, host);
                    } else {
                        self.open_both(simd, host_node, guest_node);
                    }
                }
            }
        }
        Continue(())
    }

    #[inline(always)]
    fn open_both<S: Simd>(&mut self, simd: S, host: u32, guest: u32) {
        let Self { scene, answer, tasks, found, nodes, carried: [carried_host, carried_guest], profiles, .. } = self;
        let (host_node, guest_node) = (&nodes[HOST][host as usize], &nodes[GUEST][guest as usize]);
        let reached = profiles.of_nodes(simd, [host, guest]);
        let near = Reached::near(&reached, simd, answer.cut);
        let host_boxes = carried_boxes(carried_host, host, || scene.bounds.carry(simd, HOST, host_node));
        let guest_boxes = carried_boxes(carried_guest, guest, || scene.bounds.carry(simd, GUEST, guest_node));
        for guest_lane in 0..guest_node.count() {
            let near = near[guest_lane] & lanes_in_use(host_node);
            if near == 0 {
                continue;
            }
            let guest_box = guest_boxes.lane(guest_lane);
            let bounds = scene.bounds.of(simd, host_boxes, &guest_box, false, answer.node_limit);
            for host_lane in bits(near & bounds.near) {
                let reach = Reached::both(&reached, [host_lane, guest_lane]);
                found.add(&bounds, host_lane, reach, [host_lane, guest_lane]);
            }
        }
        found.push(tasks, profiles.along(), |[host_lane, guest_lane]| {
            [Slot { node: host, lane: host_lane }, Slot { node: guest, lane: guest_lane }]
        });
    }

    /// The children of a node of one side against one child of the other.
    #[inline(always)]
    fn open_one<S: Simd>(&mut self, simd: S, side: usize, node: u32, other: Slot) {
        let one = self.box_of(simd, 1 - side, other);
        let Self { scene, answer, tasks, found, nodes, carried, profiles, .. } = self;
        let opened = &nodes[side][node as usize];
        let mut reaches = [f32::INFINITY; LANES];
        let mut near = lanes_in_use(opened);
        if let Some((both, enough)) = profiles.of_one(simd, side, node, other) {
            near &= !(both.simd_lt(f32x8::splat(simd, enough.at(answer.cut))).to_bitmask() as u32);
            both.store_slice(&mut reaches);
        }
        if near == 0 {
            return;
        }
        let many = carried_boxes(&mut carried[side], node, || scene.bounds.carry(simd, side, opened));
        let bounds = scene.bounds.of(simd, many, &one, side == GUEST, answer.node_limit);
        for lane in bits(bounds.near & near) {
            found.add(&bounds, lane, reaches[lane], if side == HOST { [lane, 0] } else { [0, lane] });
        }
        found.push(tasks, profiles.along(), |lanes| {
            let opened = Slot { node, lane: lanes[side] };
            if side == HOST { [opened, other] } else { [other, opened] }
        });
    }

    /// The box of a child of a node of one side, carried over.
    #[inline(always)]
    fn box_of<S: Simd>(&mut self, simd: S, side: usize, slot: Slot) -> Aabb {
        let Self { scene, nodes, carried, .. } = self;
        let node = &nodes[side][slot.node as usize];
        let boxes = carried_boxes(&mut carried[side], slot.node, || scene.bounds.carry(simd, side, node));
        boxes.lane(usize::from(slot.lane))
    }

    #[inline(always)]
    fn meet_leaves<S: Simd>(
        &mut self,
        simd: S,
        [host, guest]: [u32; 2],
        [host_packet, guest_packet]: &[Packet<'_>; 2],
    ) -> ControlFlow<()> {
        let Self { scene, answer, leaves: [at_host, at_guest], profiles, .. } = self;
        let [on_host, on_guest] = scene.sides();
        let reached = profiles.of_leaves(simd, [host_packet, guest_packet]);
        let mut near = Reached::near(&reached, simd, answer.cut);
        let mut near_guests = 0;
        for lane in bits(guest_packet.lanes_in_use()) {
            near[lane] &= host_packet.lanes_in_use();
            near_guests |= u32::from(near[lane] != 0) << lane;
        }
        if near_guests == 0 {
            return Continue(());
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
        let limit = answer.limit;
        let near_between = facing.near_between(limit);
        let meet = |together: &mut Together, answer: &mut Answer| {
            together.raise(simd, &facing);
            while let Some(([host_lane, guest_lane], lower)) = together.take_nearest(answer.limit) {
                if !Reached::are_apart(&reached, [host_lane, guest_lane], answer.cut) {
                    answer.meet_or_put_off(scene, pair(host_lane, guest_lane), lower, facing.slack)?;
                }
            }
            Continue(())
        };
        let mut together = Together::NONE;
        let (mut left, mut order) = (0, [f32::INFINITY; LANES]);
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
            if answer.limit < limit {
                (near, _) = facing.near_boxes(guest_lane, near, answer.limit);
                if near == 0 {
                    continue;
                }
            }
            let (lower, near) = facing.by_planes(guest_lane, near, answer.limit);
            for host_lane in bits(near) {
                together.push([host_lane, guest_lane], lower[host_lane]);
                if together.is_full() {
                    meet(&mut together, answer)?;
                }
            }
        }
        meet(&mut together, answer)?;
        self.take_direction();
        Continue(())
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

/// The greatest extent of a box.
#[inline(always)]
fn size(bounds: &Aabb) -> f32 {
    let [x, y, z] = by_axis!(axis => bounds.max[axis] - bounds.min[axis]);
    x.max(y).max(z)
}

#[inline(always)]
fn carried_boxes(
    at_hand: &mut AtHand<Carried, CARRIED_AT_HAND>,
    node: u32,
    carry: impl FnOnce() -> BoxLanes,
) -> &BoxLanes {
    &at_hand.get(node, |kept| kept.node, |node| Carried { node, boxes: carry() }).boxes
}
