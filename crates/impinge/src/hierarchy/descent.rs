//! The simultaneous descent of two trees: one in its own frame, the host, and one carried into it, the guest.
//!
//! Source: Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996, for descending two trees at once; ours opens both nodes
//! together, eight boxes against eight, and carries a guest node's boxes once for the host nodes that they meet in turn.

use std::ops::ControlFlow;

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::askew::Askew;
use super::box_map::BoxMap;
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

/// What happens at the leaves, which the hierarchy does not understand.
pub(crate) trait LeafVisitor {
    /// Lets the leaves of a host node that lie in `lanes` wait for a guest leaf, but for those whose boxes are proved apart from all
    /// that it holds. At most [`APPROACHED`] come before [`meet`](Self::meet).
    fn approach<S: Simd>(&mut self, simd: S, guest_leaf: u32, host: &Node, lanes: u32);

    /// Meets those that have waited long enough.
    fn meet<S: Simd>(&mut self, simd: S) -> ControlFlow<()>;

    /// Meets a leaf with all that is below a node of the other tree that is much smaller than what holds the leaf.
    fn meet_below<S: Simd>(&mut self, simd: S, large: Large, node: u32) -> ControlFlow<()>;

    /// Meets all that wait.
    fn finish<S: Simd>(&mut self, simd: S) -> ControlFlow<()>;

    /// Asks for what says where the memory of leaves is: of those about a guest leaf and those about a host leaf, which will be
    /// [asked for](Self::prefetch_guest) soon.
    fn prefetch_places(&self, guest_leaf: u32, host_leaf: u32);

    /// Asks for the memory of a guest leaf that will be taken up soon.
    fn prefetch_guest(&self, leaf: u32);
}

/// The leaf of a pair of leaf and node, of which it is the larger.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Large {
    Guest(u32),
    Host(u32),
}

/// A node that reaches so many times as far as another is opened without it. Trees of even triangles hardly ever come to
/// that; with 4 in place of 16 they do, and take a seventh more time for it.
const MUCH_LARGER: f32 = 16.0;

/// Two nodes left to open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task {
    guest: u32,
    host: u32,
}

impl Task {
    const ROOT: Self = Self { guest: 0, host: 0 };
}

/// A guest leaf, and the leaves of a host node that it may meet.
#[derive(Clone, Copy, Debug)]
struct Approach {
    guest_leaf: u32,
    host: u32,
    host_lanes: u32,
}

/// So many approaches are made in one go: what comes of one cannot be foreseen, and nothing in between asks for it.
pub(crate) const APPROACHED: usize = 4;

/// With so many of the 64 pairs of boxes of two nodes near each other they may be long ones that pass each other askew. To find out
/// takes less than a tenth of what opening so many would.
const CROWDED: u32 = 32;

/// Room for those that wait, all that two nodes of leaves come to, and what four at a time write after the last.
const APPROACHES: usize = (QUEUE + LANES + 4).next_power_of_two();

/// The guest node carried over last: its boxes and its slab in the host's frame.
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

/// What a run keeps beside its tasks.
struct Underway {
    carried: Carried,
    /// Put off until the guest leaves' memory is at hand.
    approaches: Queue<Approach, APPROACHES>,
    patience: usize,
    /// None before the first crowd.
    askew: Option<Askew>,
}

/// In which order tasks are opened, and how long.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Order {
    /// The last task comes first. `ahead` tasks are taken from the stack early, so that their memory is on its way.
    DepthFirst {
        /// 1 finds the first pair soonest, [`QUEUE`] finds all of them soonest. At most `most` tasks are opened.
        ahead: usize,
        most: usize,
    },
    /// The first one first, until there are this many to share out, or none.
    BreadthFirstUntil(usize),
}

/// The nodes of two trees and the maps between them.
pub(crate) struct Descent<'a> {
    pub(crate) host: &'a [Node],
    pub(crate) guest: &'a [Node],
    /// Carries guest boxes to the host.
    pub(crate) boxes: &'a BoxMap,
    /// Carries host slabs to guest boxes.
    pub(crate) host_slabs: &'a SlabMap,
    /// Carries guest slabs to host boxes.
    pub(crate) guest_slabs: &'a SlabMap,
    /// How much longer a guest's extent may be in the host's frame.
    pub(crate) stretch: f32,
    /// Makes what tells long boxes apart that pass each other.
    pub(crate) askew: &'a (dyn Fn() -> Askew + Sync),
}

impl Descent<'_> {
    /// The task that all others come from; none where a tree is empty.
    pub(crate) fn root(&self) -> Option<Task> {
        (!self.host.is_empty() && !self.guest.is_empty()).then_some(Task::ROOT)
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
        let mut queue = Queue::<_, QUEUE>::new(Task::ROOT);
        let mut underway = Underway {
            carried: Carried { node: u32::MAX, boxes: BoxLanes::default(), slab: Slab::ALL },
            approaches: Queue::new(Approach { guest_leaf: 0, host: 0, host_lanes: 0 }),
            patience: match order {
                Order::DepthFirst { ahead, .. } => ahead.min(QUEUE),
                Order::BreadthFirstUntil(_) => QUEUE,
            },
            askew: None,
        };
        let mut done = 0;
        loop {
            let task = match order {
                Order::BreadthFirstUntil(enough) => {
                    let left = tasks.len() - done; // the tasks before these are done
                    if left == 0 || left >= enough {
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
                    while queue.len() < underway.patience
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
            self.open(simd, task, visitor, &mut underway, tasks)?;
        }
        while underway.approaches.len() > 0 {
            self.approach(simd, 1, &mut underway, visitor)?;
        }
        visitor.finish(simd)
    }

    /// Opens two nodes: both at once, or the much larger one alone. If one of them holds leaves and the other nodes of like size, that
    /// one stays as it is, so that leaves come to meet leaves. The tasks of one guest child are left side by side, so that it is
    /// carried over once for all of them.
    #[inline(always)]
    fn open<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        task: Task,
        visitor: &mut V,
        underway: &mut Underway,
        below: &mut Vec<Task>,
    ) -> ControlFlow<()> {
        let (guest, host) = (&self.guest[task.guest as usize], &self.host[task.host as usize]);
        self.carry(simd, task.guest, &mut underway.carried);
        let carried = &underway.carried;
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
                |leaf| visitor.meet_below(simd, Large::Guest(leaf), task.host),
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
                |leaf| visitor.meet_below(simd, Large::Host(leaf), task.guest),
                |host| {
                    below.push(Task { host, ..task });
                },
            );
        }
        // A byte of host lanes for each guest lane.
        let mut near =
            overlapping_each(simd, host_boxes, &carried.boxes) & each_byte(host_lanes) & spread_to_bytes(guest_lanes);
        if near.count_ones() >= CROWDED {
            near = self.part(simd, underway, host, guest, near);
        }
        if guest.holds_leaves() && host.holds_leaves() {
            visitor.prefetch_places(guest.index(0), host.index(0));
            queue_approaches(near, guest, task.host, &mut underway.approaches);
            while underway.approaches.len() >= underway.patience {
                self.approach(simd, underway.patience.min(APPROACHED), underway, visitor)?;
            }
        } else {
            push_children(near, task, [guest, host], below);
        }
        ControlFlow::Continue(())
    }

    /// Carries the boxes and the slab of a guest node into the host's frame, unless it is the node that was carried last.
    #[inline(always)]
    fn carry<S: Simd>(&self, simd: S, node: u32, carried: &mut Carried) {
        if carried.node != node {
            let guest = &self.guest[node as usize];
            carried.node = node;
            carried.boxes = self.boxes.apply(simd, guest);
            carried.slab = self.guest_slabs.carry(simd, &guest.slab);
        }
    }

    /// Returns the lanes of the guest and of the host whose boxes are not proved outside the slab of the other node, nor outside
    /// the slabs that both have in common.
    #[inline(always)]
    fn lanes_in_slabs<S: Simd>(&self, simd: S, [guest, host]: [&Node; 2], carried: &Carried) -> [u32; 2] {
        let host_slab = self.host_slabs.carry(simd, &host.slab);
        let mut guest_lanes = lanes_in_use(guest) & !host_slab.outside(simd, guest);
        let mut host_lanes = lanes_in_use(host) & !carried.slab.outside(simd, host);
        if let Some(slab) = self.guest_slabs.beside(&carried.slab, &host.slab) {
            host_lanes &= !slab.outside(simd, host);
            if let Some(slab) = self.host_slabs.beside(&host_slab, &guest.slab) {
                guest_lanes &= !slab.outside(simd, guest);
            }
        }
        [guest_lanes, host_lanes]
    }

    /// Of a crowd of near boxes those that do not pass each other askew.
    #[cold]
    #[inline(never)]
    fn part<S: Simd>(&self, simd: S, underway: &mut Underway, host: &Node, guest: &Node, near: u64) -> u64 {
        let askew = underway.askew.get_or_insert_with(self.askew);
        outlined(
            simd,
            #[inline(always)]
            || askew.near(simd, host, guest, near),
        )
    }

    /// So many guest leaves against leaves of the host.
    #[inline(always)]
    fn approach<S: Simd, V: LeafVisitor>(
        &self,
        simd: S,
        count: usize,
        underway: &mut Underway,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        for _ in 0..count {
            let Approach { guest_leaf, host, host_lanes } = underway.approaches.pop();
            visitor.approach(simd, guest_leaf, &self.host[host as usize], host_lanes);
        }
        for ahead in 0..count {
            if let Some(Approach { guest_leaf, .. }) = underway.approaches.ahead(ahead) {
                visitor.prefetch_guest(guest_leaf);
            }
        }
        visitor.meet(simd)
    }
}

/// Makes tasks of the pairs of children that are near each other, of two nodes of which at least one has nodes as its children. A
/// node of leaves stays as it is. `near` has a byte of host lanes for each guest lane.
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

/// Queues the guest leaves that are near leaves of a host node. `near` has a byte of host lanes for each guest lane.
#[inline(always)]
fn queue_approaches(near: u64, guest: &Node, host: u32, approaches: &mut Queue<Approach, APPROACHES>) {
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

/// Opens the larger of two nodes alone: the children whose bits say that they are `near` the other one become tasks, or
/// meet all below it.
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

/// The box about eight.
#[inline(always)]
fn union<S: Simd>((min, max): (&Lanes3<S>, &Lanes3<S>)) -> Aabb {
    Aabb { min: by_axis!(axis => min[axis].reduce_min()), max: by_axis!(axis => max[axis].reduce_max()) }
}

#[inline(always)]
pub(crate) fn lanes_in_use(node: &Node) -> u32 {
    (1 << node.count()) - 1
}
