//! The simultaneous descent of two trees: the host's, and the guest's in the host's frame.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996. Ours opens both nodes together,
//! eight boxes against eight, and transforms a guest node once for consecutive host nodes. Tests:
//! `tests/it/engine`. Benchmark: `headline`.

use std::ops::ControlFlow;

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::box_map::BoxMap;
use super::edge_cross::EdgeCrossAxes;
use super::lanes::{BoxLanes, overlapping, overlapping_each};
use super::queue::{QUEUE, Queue};
use super::slab::Slab;
use super::slab_map::SlabMap;
use super::wide::{Child, Node};
use crate::simd::{
    ALL_LANES, LANES, Lanes3, any_byte, bits, by_axis, each_byte, extend_some, load3, nonzero_bytes, outlined,
    prefetch, spread_to_bytes, take_four,
};
use crate::volume::Aabb;

/// The processing of leaf pairs, which the hierarchy leaves to its caller.
pub(crate) trait LeafVisitor {
    /// Queues the leaves in `lanes` of a host node against a guest leaf, except leaves whose boxes
    /// are apart from it. At most [`APPROACHES_PER_BATCH`] calls precede a [`Self::process`].
    fn approach<S: Simd>(&mut self, simd: S, guest_leaf: u32, host: &Node, lanes: u32);

    /// Processes the leaf pairs that have been queued long enough.
    fn process<S: Simd>(&mut self, simd: S) -> ControlFlow<()>;

    /// Processes a leaf against all that is below a node of the other tree, which is much smaller.
    fn process_below<S: Simd>(&mut self, simd: S, large: Large, node: u32) -> ControlFlow<()>;

    /// Processes all queued leaf pairs.
    fn finish<S: Simd>(&mut self, simd: S) -> ControlFlow<()>;

    /// Prefetches the addresses of the data of leaves near a guest leaf and near a host leaf.
    fn prefetch_addresses(&self, guest_leaf: u32, host_leaf: u32);

    /// Prefetches the data of a guest leaf that will be processed soon.
    fn prefetch_guest(&self, leaf: u32);
}

/// A leaf that is compared with a much smaller node of the other tree.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Large {
    Guest(u32),
    Host(u32),
}

/// Ratio of extents from which the larger of two nodes is opened alone. With 4 in place of 16,
/// trees of even triangles reach it too, and take 14 % longer.
const MUCH_LARGER: f32 = 16.0;

/// Two nodes to open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task {
    pub(crate) guest: u32,
    pub(crate) host: u32,
}

impl Task {
    const ROOT: Self = Self { guest: 0, host: 0 };
}

/// A guest leaf, and the leaves of a host node that overlap it.
#[derive(Clone, Copy, Debug)]
struct Approach {
    guest_leaf: u32,
    host: u32,
    host_lanes: u32,
}

/// Number of approaches per batch. No approach of a batch depends on the outcome of another.
pub(crate) const APPROACHES_PER_BATCH: usize = 4;

/// Minimum number of overlapping pairs, out of 64, for which edge-cross axes are tested. The test
/// takes less than 10 % of the time to open 32 pairs.
const CROSS_TEST_FROM: u32 = 32;

/// Room for the queued approaches, those of two more nodes, and the overhang of a store of four.
const APPROACH_ROOM: usize = (QUEUE + LANES + 4).next_power_of_two();

/// The boxes and the slab of the last transformed guest node, in the host's frame.
struct Carried {
    node: u32,
    boxes: BoxLanes,
    slab: Slab,
}

impl Carried {
    /// Loads the boxes.
    #[inline(always)]
    fn boxes<S: Simd>(&self, simd: S) -> [Lanes3<S>; 2] {
        [load3(simd, &self.boxes.min), load3(simd, &self.boxes.max)]
    }
}

/// The state of a run, except for its tasks.
struct RunState {
    carried: Carried,
    /// Approaches that wait for the memory of their guest leaves.
    approaches: Queue<Approach, APPROACH_ROOM>,
    queue_len: usize,
    /// `None` until it is first needed.
    edge_cross: Option<EdgeCrossAxes>,
}

/// The order in which tasks are opened, and the limit on their number.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Order {
    /// Opens the last task first, and at most `most` tasks.
    DepthFirst {
        /// Number of tasks popped early for prefetching: best 1 for one pair, [`QUEUE`] for all.
        ahead: usize,
        most: usize,
    },
    /// Opens the first task first, at most `most`, until there are `enough` to share.
    BreadthFirst { enough: usize, most: usize },
}

/// The nodes of two trees and the maps between them.
pub(crate) struct Descent<'a> {
    pub(crate) host: &'a [Node],
    pub(crate) guest: &'a [Node],
    /// Transforms guest boxes to the host's frame.
    pub(crate) boxes: &'a BoxMap,
    /// Transforms host slabs to the guest's frame.
    pub(crate) host_slabs: &'a SlabMap,
    /// Transforms guest slabs to the host's frame.
    pub(crate) guest_slabs: &'a SlabMap,
    /// Maximum factor by which a guest's extent grows in the host's frame.
    pub(crate) stretch: f32,
    /// Builds the edge-cross frames when they are first needed.
    pub(crate) edge_cross: &'a (dyn Fn() -> EdgeCrossAxes + Sync),
}

impl Descent<'_> {
    /// Returns the task from which all others come, or `None` if a tree is empty.
    pub(crate) fn root(&self) -> Option<Task> {
        (!self.host.is_empty() && !self.guest.is_empty()).then_some(Task::ROOT)
    }

    /// Opens tasks and all their descendants until the visitor breaks, or the order's limit is
    /// reached. Unopened tasks stay in `tasks`.
    ///
    /// Depth first, there are at most 64 tasks for each level of the two trees, and those in the
    /// queue: opening a task removes it and adds at most 64, all deeper than it.
    #[inline(always)]
    pub(crate) fn run<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        order: Order,
        tasks: &mut Vec<Task>,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        let mut queue = Queue::<_, QUEUE>::new(Task::ROOT);
        let mut state = RunState {
            carried: Carried { node: u32::MAX, boxes: BoxLanes::default(), slab: Slab::ALL },
            approaches: Queue::new(Approach { guest_leaf: 0, host: 0, host_lanes: 0 }),
            queue_len: match order {
                Order::DepthFirst { ahead, .. } => ahead.min(QUEUE),
                Order::BreadthFirst { .. } => QUEUE,
            },
            edge_cross: None,
        };
        let mut done = 0;
        loop {
            let task = match order {
                Order::BreadthFirst { enough, most } => {
                    let left = tasks.len() - done; // the tasks before these are done
                    if left == 0 || left >= enough || done == most {
                        tasks.drain(..done);
                        break;
                    }
                    done += 1;
                    tasks[done - 1]
                }
                Order::DepthFirst { most, .. } => {
                    if done == most {
                        tasks.extend(queue.drain());
                        break;
                    }
                    done += 1;
                    while queue.len() < state.queue_len
                        && let Some(task) = tasks.pop()
                    {
                        prefetch(&self.guest[task.guest as usize]);
                        prefetch(&self.host[task.host as usize]);
                        queue.push(task);
                    }
                    if queue.len() == 0 {
                        break;
                    }
                    queue.pop()
                }
            };
            self.open(simd, task, visitor, &mut state, tasks)?;
        }
        while state.approaches.len() > 0 {
            self.approach(simd, 1, &mut state, visitor)?;
        }
        visitor.finish(simd)
    }

    /// Opens two nodes: both at once, or a much larger one alone. If one holds leaves and the other
    /// nodes of similar size, only the other is opened, so leaves are paired with leaves. The tasks
    /// of one guest child are consecutive, so it is transformed once for all of them.
    #[inline(always)]
    fn open<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        task: Task,
        visitor: &mut V,
        state: &mut RunState,
        below: &mut Vec<Task>,
    ) -> ControlFlow<()> {
        let (guest, host) = (&self.guest[task.guest as usize], &self.host[task.host as usize]);
        self.carry(simd, task.guest, &mut state.carried);
        let carried = &state.carried;
        let [guest_lanes, host_lanes] = self.lanes_in_slabs(simd, [guest, host], carried);
        if guest_lanes == 0 || host_lanes == 0 {
            return ControlFlow::Continue(());
        }
        let host_boxes = (&load3(simd, &host.min), &load3(simd, &host.max));
        let guest_extent = self.stretch * guest.extent;
        if guest_extent > MUCH_LARGER * host.extent {
            let [min, max] = carried.boxes(simd);
            let near = guest_lanes & overlapping(simd, (&min, &max), &union(host_boxes));
            return open_larger(
                guest,
                near,
                |leaf| visitor.process_below(simd, Large::Guest(leaf), task.host),
                |guest| {
                    below.push(Task { guest, ..task });
                },
            );
        }
        if host.extent > MUCH_LARGER * guest_extent {
            let [min, max] = carried.boxes(simd);
            let near = host_lanes & overlapping(simd, host_boxes, &union((&min, &max)));
            return open_larger(
                host,
                near,
                |leaf| visitor.process_below(simd, Large::Host(leaf), task.guest),
                |host| {
                    below.push(Task { host, ..task });
                },
            );
        }
        // A byte of host lanes for each guest lane.
        let mut near =
            overlapping_each(simd, host_boxes, &carried.boxes) & each_byte(host_lanes) & spread_to_bytes(guest_lanes);
        if near.count_ones() >= CROSS_TEST_FROM {
            near = self.cull_edge_cross(simd, state, host, guest, near);
        }
        if guest.holds_leaves() && host.holds_leaves() {
            visitor.prefetch_addresses(guest.index(0), host.index(0));
            queue_approaches(near, guest, task.host, &mut state.approaches);
            while state.approaches.len() >= state.queue_len {
                self.approach(simd, state.queue_len.min(APPROACHES_PER_BATCH), state, visitor)?;
            }
        } else {
            push_children(near, task, [guest, host], below);
        }
        ControlFlow::Continue(())
    }

    /// Transforms the boxes and the slab of a guest node, unless it is the last one transformed.
    #[inline(always)]
    fn carry<S: Simd>(&self, simd: S, node: u32, carried: &mut Carried) {
        if carried.node != node {
            let guest = &self.guest[node as usize];
            carried.node = node;
            carried.boxes = self.boxes.apply(simd, guest);
            carried.slab = self.guest_slabs.carry(simd, &guest.slab);
        }
    }

    /// Returns the lanes of the guest and of the host whose boxes are not proved outside the slab
    /// of the other node, nor outside the difference of both slabs.
    #[inline(always)]
    fn lanes_in_slabs<S: Simd>(&self, simd: S, [guest, host]: [&Node; 2], carried: &Carried) -> [u32; 2] {
        let host_slab = self.host_slabs.carry(simd, &host.slab);
        let mut guest_lanes = lanes_in_use(guest) & !host_slab.outside(simd, guest);
        let mut host_lanes = lanes_in_use(host) & !carried.slab.outside(simd, host);
        if let Some(slab) = self.guest_slabs.difference(&carried.slab, &host.slab) {
            host_lanes &= !slab.outside(simd, host);
            if let Some(slab) = self.host_slabs.difference(&host_slab, &guest.slab) {
                guest_lanes &= !slab.outside(simd, guest);
            }
        }
        [guest_lanes, host_lanes]
    }

    /// Returns the pairs of `near` that are not proved apart along an edge-cross axis.
    #[cold]
    #[inline(never)]
    fn cull_edge_cross<S: Simd>(&self, simd: S, state: &mut RunState, host: &Node, guest: &Node, near: u64) -> u64 {
        let edge_cross = state.edge_cross.get_or_insert_with(self.edge_cross);
        outlined(
            simd,
            #[inline(always)]
            || edge_cross.near(simd, host, guest, near),
        )
    }

    /// Processes `count` queued approaches, and prefetches the next guest leaves.
    #[inline(always)]
    fn approach<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        count: usize,
        state: &mut RunState,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        for _ in 0..count {
            let Approach { guest_leaf, host, host_lanes } = state.approaches.pop();
            visitor.approach(simd, guest_leaf, &self.host[host as usize], host_lanes);
        }
        for ahead in 0..count {
            if let Some(Approach { guest_leaf, .. }) = state.approaches.get(ahead) {
                visitor.prefetch_guest(guest_leaf);
            }
        }
        visitor.process(simd)
    }
}

/// Pushes the overlapping pairs of children of two nodes as tasks. A node of leaves stays itself;
/// at most one of the two may be one. `near` has a byte of host lanes for each guest lane.
#[inline(always)]
fn push_children(mut near: u64, task: Task, [guest, host]: [&Node; 2], below: &mut Vec<Task>) {
    if guest.holds_leaves() {
        for lane in bits(any_byte(near)) {
            below.push(Task { guest: task.guest, host: host.index(lane) });
        }
    } else if host.holds_leaves() {
        let mut any = nonzero_bytes(near);
        while any != 0 {
            let lane = any.trailing_zeros() as usize / LANES;
            any &= any - 1;
            below.push(Task { guest: guest.index(lane), host: task.host });
        }
    } else {
        while near != 0 {
            let left = near.count_ones() as usize;
            let four =
                take_four(&mut near).map(|bit| Task { guest: guest.index(bit / LANES), host: host.index(bit % LANES) });
            extend_some(below, four, left);
        }
    }
}

/// Queues the guest leaves that overlap leaves of a host node; `near` is as in [`push_children`].
#[inline(always)]
fn queue_approaches(near: u64, guest: &Node, host: u32, approaches: &mut Queue<Approach, APPROACH_ROOM>) {
    let mut any = nonzero_bytes(near);
    while any != 0 {
        let left = any.count_ones() as usize;
        let four = take_four(&mut any).map(|first| Approach {
            guest_leaf: guest.index(first / LANES),
            host,
            host_lanes: (near >> first) as u32 & ALL_LANES,
        });
        approaches.push_some(four, left);
    }
}

/// Opens the larger of two nodes alone. The children in `near` become tasks if they are nodes, and
/// are processed against all of the other node if they are leaves.
#[inline(always)]
fn open_larger(
    node: &Node,
    near: u32,
    mut meet: impl FnMut(u32) -> ControlFlow<()>,
    mut push: impl FnMut(u32),
) -> ControlFlow<()> {
    for lane in bits(near) {
        match node.child(lane) {
            Child::Inner(inner) => push(inner),
            Child::Leaf(leaf) => meet(leaf)?,
        }
    }
    ControlFlow::Continue(())
}

/// Returns the box around eight boxes.
#[inline(always)]
fn union<S: Simd>((min, max): (&Lanes3<S>, &Lanes3<S>)) -> Aabb {
    Aabb { min: by_axis!(axis => min[axis].reduce_min()), max: by_axis!(axis => max[axis].reduce_max()) }
}

#[inline(always)]
pub(crate) fn lanes_in_use(node: &Node) -> u32 {
    (1 << node.count()) - 1
}
