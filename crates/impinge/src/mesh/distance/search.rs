//! The search: pairs of children, the nearest first, and what is found out about them.

use std::ops::ControlFlow::{self, Continue};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::answer::{Answer, Scene};
use super::at_hand::AtHand;
use super::between::Between;
use super::bounds::Bounds;
use super::front::{Front, NO_ENTRY, Standing};
use super::leaf::Leaf;
use super::profile::{Profiles, Reach, Reached};
use super::task::{Slot, Sorted, Task};
use super::{Nearest, Trail};
use crate::exact::Placement;
use crate::hierarchy::{BoxLanes, Child, Node, lanes_in_use};
use crate::mesh::distance::metric::Metric;
use crate::mesh::storage::packet::Packets;
use crate::mesh::{Options, Placed};
use crate::simd::{LANES, Level, bits, by_axis, dispatch, outlined};
use crate::volume::Aabb;

/// A search that meets more pairs of leaves than this, and takes some milliseconds, is dear: where its like follow, a front pays.
const DEAR: usize = 1 << 13;

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
pub(super) struct Search<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) answer: Answer,
    nodes: [&'a [Node]; 2],
    packets: [Packets<'a>; 2],
    tasks: Vec<Task>,
    found: Sorted,
    pub(super) leaves: [AtHand<Leaf, LEAVES_AT_HAND>; 2],
    carried: [AtHand<Carried, CARRIED_AT_HAND>; 2],
    pub(super) profiles: Profiles<'a>,
    between: Between,
    /// Where the search ends, if that is kept.
    pub(super) front: Option<Front>,
    /// Pairs of leaves that were met.
    met: usize,
}

#[derive(Clone, Debug)]
struct Carried {
    node: u32,
    boxes: BoxLanes,
}

impl<'a> Search<'a> {
    /// None where a mesh has no faces.
    pub(super) fn new(a: Placed<'a>, b: Placed<'a>, options: &Options, clearance: f64) -> Option<Self> {
        if a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
            return None;
        }
        let metric = Metric::new(a, b);
        let bounds = Bounds::new(a, b, &metric, options.host);
        let [host, guest] = bounds.sides.host_guest([a.mesh, b.mesh]);
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
            front: None,
            met: 0,
        })
    }

    /// Meets these faces, if there are such, before all others.
    pub(super) fn try_first(&mut self, faces: Option<[u32; 2]>) -> ControlFlow<()> {
        let scene = &self.scene;
        let exists = |faces: &[u32; 2]| [0, 1].iter().all(|&m| (faces[m] as usize) < scene.meshes[m].faces().len());
        if let Some(faces) = faces.filter(exists) {
            self.answer.meet(scene, faces)?;
            self.take_direction();
        }
        Continue(())
    }

    /// Looks at everything, from the roots. Keeps where it ends if `since` says that the meshes stood little else when the last
    /// search was dear.
    pub(super) fn run(&mut self, options: &Options, since: Option<&Standing>) {
        self.front = since.and_then(|since| Front::new(&self.scene, since, self.nodes, options, self.answer.cut));
        let found = if self.front.is_some() {
            self.advance_on(options.level)
        } else {
            dispatch!(options.level, simd => self.descend(simd))
        };
        if found.is_continue() {
            let _ = self.answer.meet_put_off(&self.scene);
        }
        if let Some(front) = &mut self.front {
            front.complete(self.met);
        }
    }

    /// Looks at what the front leaves open; false where it is of no use any more, and then nothing was looked at.
    pub(super) fn go_on(&mut self, front: Front, options: &Options) -> bool {
        let Some(front) = front.moved(&self.scene, self.nodes[GUEST], options, self.answer.cut) else { return false };
        self.front = Some(front);
        if self.advance_on(options.level).is_continue() {
            let _ = self.answer.meet_put_off(&self.scene);
        }
        true
    }

    /// What it leaves for the next search.
    pub(super) fn leave(self, faces: Option<[u32; 2]>) -> Trail {
        let dear = if self.met > DEAR || self.front.is_some() { self.scene.bounds.standing } else { None };
        Trail { faces, front: self.front, dear }
    }

    /// The nearest points that were found.
    pub(super) fn nearest(&self) -> Option<Nearest> {
        let doubt = if self.answer.values_left == 0 { 6.0 * self.scene.metric.error } else { 0.0 };
        self.answer.best.map(|best| self.scene.finish(&best, doubt))
    }

    /// Bounds what is left along the direction between the best witnesses.
    #[inline(always)]
    pub(super) fn take_direction(&mut self) {
        let Self { scene, answer, profiles, .. } = self;
        if let Some(best) = &answer.best {
            let (sides, on) = (scene.sides(), [&best.witness.on_a, &best.witness.on_b]);
            profiles.take(sides.map(|side| on[side]), best.value, &scene.metric, sides);
        }
    }

    /// Runs [`advance`](Self::advance) with a vector unit. Both callers share the one copy that is
    /// compiled for each unit.
    #[inline(never)]
    fn advance_on(&mut self, level: Level) -> ControlFlow<()> {
        dispatch!(level, simd => self.advance(simd))
    }

    #[inline(always)]
    fn descend<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        self.open_both::<S, false>(simd, 0, 0);
        self.work_off::<S, false>(simd)
    }

    /// Goes on at each pair of children of the front that is not proved to be far.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        for entry in 0..self.entries() as u32 {
            let Some(front) = &self.front else { break };
            let ([host, guest], near) = front.near(simd, entry, front.limit(self.answer.cut));
            // Along the direction between the witnesses nothing is known of them.
            let reach = Reach { both: f32::INFINITY, along: self.profiles.along() };
            for (guest_lane, near) in near.into_iter().enumerate() {
                for host_lane in bits(near) {
                    let host = Slot { node: host, lane: host_lane as u8 };
                    let guest = Slot { node: guest, lane: guest_lane as u8 };
                    self.tasks.push(Task { bound: f32::NEG_INFINITY, reach, slots: [host, guest], entry });
                }
            }
            self.work_off::<S, true>(simd)?;
        }
        Continue(())
    }

    /// Finds out about the children that are tasks.
    #[inline(always)]
    fn work_off<S: Simd, const KEEPS: bool>(&mut self, simd: S) -> ControlFlow<()> {
        while let Some(task) = self.tasks.pop() {
            if task.bound > self.answer.node_limit {
                continue;
            }
            let cut = self.answer.cut;
            if self.profiles.are_apart(simd, task.reach, task.slots, cut) {
                self.raise::<KEEPS>(&task, cut);
                continue;
            }
            let [host, guest] = task.slots;
            let (host_node, guest_node) =
                (&self.nodes[HOST][host.node as usize], &self.nodes[GUEST][guest.node as usize]);
            let (host_lane, guest_lane) = (usize::from(host.lane), usize::from(guest.lane));
            let (host_box, guest_box) = (host_node.lane_bounds(host_lane), guest_node.lane_bounds(guest_lane));
            let line = self.between.line(&host_box, &guest_box);
            let left = line.left();
            if left.is_longer(cut) {
                self.raise::<KEEPS>(&task, left.length());
                continue;
            }
            let entries = self.entries();
            // Which node to open, if not both. One call of each function below keeps the compiled code small.
            let one = match (host_node.child(host_lane), guest_node.child(guest_lane)) {
                (Child::Leaf(host), Child::Leaf(guest)) => {
                    let packets = [self.packets[HOST].get(simd, host), self.packets[GUEST].get(simd, guest)];
                    let left = line.left_by_leaves(&packets);
                    if left.is_longer(cut) {
                        self.raise::<KEEPS>(&task, left.length());
                    } else {
                        let least = self.meet_leaves::<S, KEEPS>(simd, [host, guest], &packets)?;
                        self.met += 1;
                        self.raise::<KEEPS>(&task, f64::from(least));
                    }
                    continue;
                }
                (Child::Inner(node), Child::Leaf(_)) => Some((HOST, node, guest)),
                (Child::Leaf(_), Child::Inner(node)) => Some((GUEST, node, host)),
                (Child::Inner(host_node), Child::Inner(guest_node)) => {
                    let host_size = size(&self.box_of(simd, HOST, host));
                    let guest_size = size(&self.box_of(simd, GUEST, guest));
                    if host_size > OPENED_TOGETHER * guest_size {
                        Some((HOST, host_node, guest))
                    } else if guest_size > OPENED_TOGETHER * host_size {
                        Some((GUEST, guest_node, host))
                    } else {
                        self.open_both::<S, KEEPS>(simd, host_node, guest_node);
                        None
                    }
                }
            };
            if let Some((side, node, other)) = one {
                self.open_one::<S, KEEPS>(simd, side, node, other);
            }
            // What has no entry, as there are too many, stays with its bound and is opened again.
            if KEEPS
                && self.entries() > entries
                && let Some(front) = &mut self.front
            {
                front.pass_on(task.entry, task.slots);
            }
        }
        Continue(())
    }

    #[inline(always)]
    fn entries(&self) -> usize {
        self.front.as_ref().map_or(0, Front::len)
    }

    /// What is below the children of a task is no nearer than this, in metric units.
    #[inline(always)]
    fn raise<const KEEPS: bool>(&mut self, task: &Task, lower: f64) {
        if KEEPS && let Some(front) = &mut self.front {
            front.raise(task.entry, task.slots, lower, self.scene.metric.error);
        }
    }

    /// The entry of two nodes in the front, if there is one, with what their boxes say.
    #[inline(always)]
    fn entry_of_both<S: Simd, const KEEPS: bool>(&mut self, simd: S, host: u32, guest: u32) -> u32 {
        let Self { scene, answer, nodes, carried: [carried_host, carried_guest], front, .. } = self;
        let Some(front) = front.as_mut().filter(|_| KEEPS) else { return NO_ENTRY };
        outlined(
            simd,
            #[inline(always)]
            || {
                let (host_node, guest_node) = (&nodes[HOST][host as usize], &nodes[GUEST][guest as usize]);
                let host_boxes = carried_boxes(carried_host, host, || scene.bounds.carry(simd, HOST, host_node));
                let guest_boxes = carried_boxes(carried_guest, guest, || scene.bounds.carry(simd, GUEST, guest_node));
                let Some(entry) = front.open([host, guest]) else { return NO_ENTRY };
                for guest_lane in 0..guest_node.count() {
                    let guest_box = guest_boxes.lane(guest_lane);
                    let bounds = scene.bounds.of(simd, host_boxes, &guest_box, false, answer.node_limit).bounds;
                    front.keep_row(simd, entry, guest_lane, lanes_in_use(host_node), &bounds);
                }
                entry
            },
        )
    }

    /// Likewise of the children of a node of one side and one child of the other.
    #[inline(always)]
    fn entry_of_one<S: Simd, const KEEPS: bool>(&mut self, simd: S, side: usize, node: u32, other: Slot) -> u32 {
        if !KEEPS {
            return NO_ENTRY;
        }
        let one = self.box_of(simd, 1 - side, other);
        let Self { scene, answer, nodes, carried, front, .. } = self;
        let Some(front) = front else { return NO_ENTRY };
        let opened = &nodes[side][node as usize];
        outlined(
            simd,
            #[inline(always)]
            || {
                let many = carried_boxes(&mut carried[side], node, || scene.bounds.carry(simd, side, opened));
                let bounds = scene.bounds.of(simd, many, &one, side == GUEST, answer.node_limit).bounds;
                let pair = |opened: Slot| if side == HOST { [opened, other] } else { [other, opened] };
                let nodes = pair(Slot { node, lane: 0 }).map(|slot| slot.node);
                let Some(entry) = front.open(nodes) else { return NO_ENTRY };
                for lane in 0..opened.count() {
                    front.keep(entry, pair(Slot { node, lane: lane as u8 }), bounds[lane]);
                }
                entry
            },
        )
    }

    #[inline(always)]
    fn open_both<S: Simd, const KEEPS: bool>(&mut self, simd: S, host: u32, guest: u32) {
        let entry = self.entry_of_both::<S, KEEPS>(simd, host, guest);
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
        found.push(tasks, (profiles.along(), entry), |[host_lane, guest_lane]| {
            [Slot { node: host, lane: host_lane }, Slot { node: guest, lane: guest_lane }]
        });
    }

    /// The children of a node of one side against one child of the other.
    #[inline(always)]
    fn open_one<S: Simd, const KEEPS: bool>(&mut self, simd: S, side: usize, node: u32, other: Slot) {
        let one = self.box_of(simd, 1 - side, other);
        let entry = self.entry_of_one::<S, KEEPS>(simd, side, node, other);
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
        found.push(tasks, (profiles.along(), entry), |lanes| {
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
