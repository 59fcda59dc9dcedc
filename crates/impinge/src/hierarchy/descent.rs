//! The simultaneous descent of two trees: one in its own frame, the host, and one carried into it, the guest.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996, for descending two trees at once; ours opens both nodes
//! together, eight boxes against eight, and carries a guest node's boxes once for all the host nodes that they meet.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::lanes::{BoxLanes, BoxMap, load3, overlapping, overlapping_each};
use super::wide::{Child, Node};
use crate::simd::{LANES, by_axis, prefetch};
use crate::volume::Aabb;

/// What happens at the leaves, which the hierarchy does not understand.
pub(crate) trait LeafVisitor {
    /// Takes up a guest leaf, if it is not the one taken up last: the calls of [`pair`](Self::pair) that follow mean
    /// this one. Returns bounds of all that it holds, in the host's frame.
    fn take_up<S: Simd>(&mut self, simd: S, guest_leaf: u32) -> Aabb;

    /// Meets the guest leaf taken up last with a host leaf, now or later.
    fn pair<S: Simd>(&mut self, simd: S, host_leaf: u32) -> ControlFlow<()>;

    /// Meets what was put off.
    fn finish<S: Simd>(&mut self, simd: S) -> ControlFlow<()>;

    /// Asks for the memory of a guest leaf that will be taken up soon.
    fn prefetch_guest(&self, leaf: u32);
}

/// What is left to open: a guest child against some children of a host node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task {
    guest: Child,
    host: u32,
    host_lanes: u8,
}

/// The most tasks between the stack and their turn. Fewer hide less of the memory's latency; more push each other's lines
/// out of the first cache.
pub(crate) const QUEUE: usize = 8;

/// The guest node carried over last, and its boxes in the host's frame.
struct Carried {
    node: u32,
    boxes: BoxLanes,
}

/// In which order tasks are opened, and how long.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Order {
    /// The last one first, to the end; tasks are known this many ahead of their turn (at most [`QUEUE`]), while the
    /// memory that they need is on its way.
    DepthFirst {
        /// One to find the first pair soonest, [`QUEUE`] to find all of them.
        ahead: usize,
    },
    /// The first one first, until there are this many to share out, or none.
    BreadthFirstUntil(usize),
}

/// The nodes of two trees and the map between them.
pub(crate) struct Descent<'a> {
    pub(crate) host: &'a [Node],
    pub(crate) guest: &'a [Node],
    pub(crate) map: &'a BoxMap,
}

impl Descent<'_> {
    /// The task that all others come from; none where a tree is empty.
    pub(crate) fn root(&self) -> Option<Task> {
        let host = self.host.first()?;
        self.guest.first()?;
        Some(Task { guest: Child::Inner(0), host: 0, host_lanes: lanes_in_use(host) as u8 })
    }

    /// Works off tasks and all that comes from them until the visitor breaks off, or until the order says so; what is
    /// left over stays in `tasks`.
    ///
    /// Depth first, there are at most 64 tasks for each level of the two trees, whose depth is bounded, and those in
    /// the queue: opening a task takes one away and adds at most 64, all deeper than it.
    #[inline(always)]
    pub(crate) fn run<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        order: Order,
        tasks: &mut Vec<Task>,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        let mut queue = [Task { guest: Child::Inner(0), host: 0, host_lanes: 0 }; QUEUE];
        let (mut next, mut waiting) = (0, 0);
        let mut carried = Carried { node: u32::MAX, boxes: BoxLanes::default() };
        // Breadth first, the tasks before this one are done.
        let mut done = 0;
        loop {
            let task = match order {
                Order::BreadthFirstUntil(enough) => {
                    let left = tasks.len() - done;
                    if left == 0 || left >= enough {
                        tasks.drain(..done);
                        return visitor.finish(simd);
                    }
                    done += 1;
                    tasks[done - 1]
                }
                Order::DepthFirst { ahead } => {
                    while waiting < ahead.min(QUEUE)
                        && let Some(task) = tasks.pop()
                    {
                        self.prefetch(&task, visitor);
                        queue[(next + waiting) % QUEUE] = task;
                        waiting += 1;
                    }
                    if waiting == 0 {
                        return visitor.finish(simd);
                    }
                    let task = queue[next];
                    next = (next + 1) % QUEUE;
                    waiting -= 1;
                    task
                }
            };
            self.open(simd, task, visitor, &mut carried, tasks)?;
        }
    }

    /// Opens one task: appends the tasks below it and shows the visitor the pairs of leaves.
    #[inline(always)]
    fn open<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        task: Task,
        visitor: &mut V,
        carried: &mut Carried,
        below: &mut Vec<Task>,
    ) -> ControlFlow<()> {
        match task.guest {
            Child::Inner(guest) => {
                self.open_guest(simd, task, guest, carried, below);
                ControlFlow::Continue(())
            }
            Child::Leaf(leaf) => self.meet_guest(simd, task, leaf, visitor, below),
        }
    }

    /// A guest node against host children: inner ones are opened at once, leaves wait for the guest's children. The
    /// tasks of one guest child are left side by side, so that it is carried over once for all of them.
    #[inline(always)]
    fn open_guest<S: Simd>(&self, simd: S, task: Task, index: u32, carried: &mut Carried, below: &mut Vec<Task>) {
        let guest = &self.guest[index as usize];
        if carried.node != index {
            carried.node = index;
            carried.boxes = self.map.apply(simd, guest);
        }
        let guests = &carried.boxes;
        let parent = &self.host[task.host as usize];
        // For each inner host child, the guest lanes that meet its children, a byte of these each; over all of them, the
        // guest lanes that meet any, a byte of host lanes each, in which the tasks of one guest child stand together.
        let mut met = [0_u64; LANES];
        let mut met_nodes = 0_u64;
        let mut met_leaves = [0_u8; LANES];
        let mut leaves = 0;
        for lane in bits(u32::from(task.host_lanes)) {
            match parent.child(lane) {
                Child::Inner(host) => {
                    let node = &self.host[host as usize];
                    let boxes = (&load3(simd, &node.min), &load3(simd, &node.max));
                    let in_use = EACH_BYTE * u64::from(lanes_in_use(node));
                    let lanes = overlapping_each(simd, boxes, guests) & in_use;
                    met[lane] = lanes;
                    met_nodes |= nonzero_bytes(lanes) << lane;
                }
                Child::Leaf(_) => {
                    let bounds = Aabb {
                        min: by_axis!(axis => parent.min[axis][lane]),
                        max: by_axis!(axis => parent.max[axis][lane]),
                    };
                    let lanes = overlapping(simd, (&load3(simd, &guests.min), &load3(simd, &guests.max)), &bounds);
                    for guest_lane in bits(lanes) {
                        met_leaves[guest_lane] |= 1 << lane;
                    }
                    leaves |= lanes;
                }
            }
        }
        for guest_lane in bits(leaves & lanes_in_use(guest)) {
            let guest = guest.child(guest_lane);
            below.push(Task { guest, host: task.host, host_lanes: met_leaves[guest_lane] });
        }
        met_nodes &= u64::MAX >> (u64::BITS - (LANES * guest.count()) as u32).min(u64::BITS - 1);
        while met_nodes != 0 {
            let bit = met_nodes.trailing_zeros() as usize;
            met_nodes &= met_nodes - 1;
            let (guest_lane, lane) = (bit / LANES, bit % LANES);
            if let Child::Inner(host) = parent.child(lane) {
                let host_lanes = (met[lane] >> (LANES * guest_lane)) as u8;
                below.push(Task { guest: guest.child(guest_lane), host, host_lanes });
            }
        }
    }

    /// A guest leaf against host children: inner ones are opened, leaves are met.
    #[inline(always)]
    fn meet_guest<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        task: Task,
        leaf: u32,
        visitor: &mut V,
        below: &mut Vec<Task>,
    ) -> ControlFlow<()> {
        let bounds = visitor.take_up(simd, leaf);
        let parent = &self.host[task.host as usize];
        let still = overlapping(simd, (&load3(simd, &parent.min), &load3(simd, &parent.max)), &bounds)
            & u32::from(task.host_lanes);
        for lane in bits(still) {
            match parent.child(lane) {
                Child::Inner(host) => {
                    let node = &self.host[host as usize];
                    let lanes = overlapping(simd, (&load3(simd, &node.min), &load3(simd, &node.max)), &bounds)
                        & lanes_in_use(node);
                    if lanes != 0 {
                        below.push(Task { guest: task.guest, host, host_lanes: lanes as u8 });
                    }
                }
                Child::Leaf(host_leaf) => visitor.pair(simd, host_leaf)?,
            }
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn prefetch<V: LeafVisitor>(&self, task: &Task, visitor: &V) {
        match task.guest {
            Child::Inner(guest) => {
                prefetch(&self.guest[guest as usize]);
                let parent = &self.host[task.host as usize];
                for lane in bits(u32::from(task.host_lanes)) {
                    if let Child::Inner(host) = parent.child(lane) {
                        prefetch(&self.host[host as usize]);
                    }
                }
            }
            // Leaves mostly meet leaves, which the visitor asks for once it knows which of them are near.
            Child::Leaf(leaf) => visitor.prefetch_guest(leaf),
        }
    }
}

/// A one in each byte.
const EACH_BYTE: u64 = 0x0101_0101_0101_0101;

/// A one in each byte that has any bit set.
#[inline(always)]
fn nonzero_bytes(bytes: u64) -> u64 {
    const LOW_BITS: u64 = 0x7f * EACH_BYTE;
    ((((bytes & LOW_BITS) + LOW_BITS) | bytes) >> 7) & EACH_BYTE
}

#[inline(always)]
fn lanes_in_use(node: &Node) -> u32 {
    (1 << node.count()) - 1
}

/// The positions of the bits that are set, from the lowest.
#[inline(always)]
pub(crate) fn bits(mut set: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let lowest = set.trailing_zeros() as usize;
            set &= set - 1;
            lowest
        })
    })
}
