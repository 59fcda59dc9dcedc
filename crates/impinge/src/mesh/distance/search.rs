//! The search: pairs of children are processed in the order of their bounds, the nearest first.
//!
//! Guarded by `tests/it/distance/meshes.rs`, `frontier/tests.rs` and the benchmark `distance`.

use std::ops::ControlFlow::{self, Continue};

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::answer::Answer;
use super::bounds::Bounds;
use super::cache::Cache;
use super::carried_boxes::{CarriedBoxes, carried_boxes};
use super::direction_bounds::{DirectionBounds, Reach, Reached};
use super::frontier::{Frontier, NO_ENTRY};
use super::leaf_pair::{LeafCaches, Progress, process_leaves};
use super::line_bound::{LineBound, Slab};
use super::metric::Metric;
use super::relative_frame::RelativeFrame;
use super::scene::{Nearest, Scene};
use super::slices::Slices;
use super::slot::Slot;
use super::task::{Sorted, Task};
use super::warm_start::WarmStart;
use crate::exact::Placement;
use crate::hierarchy::{Child, Node, lanes_in_use};
use crate::mesh::storage::packet::Packets;
use crate::mesh::{Options, PlacedMesh};
use crate::simd::{LANES, Level, bits, by_axis, dispatch, outlined};
use crate::volume::Aabb;

/// Number of processed leaf pairs above which the searches after this one keep a frontier.
const COSTLY_PAIRS: usize = 1 << 13;

/// Maximum ratio of the sizes of two boxes up to which both nodes are opened, not only the larger.
const MAX_SIZE_RATIO: f32 = 4.0;

/// Indices of the two sides of a search.
const HOST: usize = 0;
const GUEST: usize = 1;

/// A search. In arrays of two the host comes first and the guest second.
pub(super) struct Search<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) answer: Answer,
    nodes: [&'a [Node]; 2],
    packets: [Packets<'a>; 2],
    /// Stack of the pairs of children that are not yet processed, the nearest last.
    tasks: Vec<Task>,
    found: Sorted,
    leaves: LeafCaches,
    carried: [CarriedBoxes; 2],
    direction_bounds: DirectionBounds<'a>,
    line_bound: LineBound,
    /// Node pairs at which the search ends, if they are kept.
    frontier: Option<Frontier>,
    /// Number of processed leaf pairs.
    leaf_pairs: usize,
    pub(super) slices: Slices<'a>,
}

impl<'a> Search<'a> {
    /// Creates a search with a clearance in world units. Returns `None` if a mesh has no faces.
    pub(super) fn new(a: PlacedMesh<'a>, b: PlacedMesh<'a>, options: &Options<'a>, clearance: f64) -> Option<Self> {
        if a.mesh.faces().is_empty() || b.mesh.faces().is_empty() {
            return None;
        }
        let metric = Metric::new(a, b);
        let bounds = Bounds::new(a, b, &metric, options.host);
        let [host, guest] = bounds.sides.host_guest([a.mesh, b.mesh]);
        let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
        let scene = Scene { meshes: [a.mesh, b.mesh], metric, placement, bounds, clearance };
        let Metric { diagonal, scale, error, .. } = scene.metric;
        let farthest = if clearance == f64::INFINITY { diagonal } else { clearance * scale };
        let answer = Answer::new(&scene, farthest + 2.0 * error);
        let line_bound = LineBound::new([host, guest], &scene.metric, scene.sides());
        Some(Self {
            scene,
            answer,
            nodes: [host.0.tree.nodes(), guest.0.tree.nodes()],
            packets: [host.packets(), guest.packets()],
            tasks: Vec::new(),
            found: Sorted::new(),
            leaves: [Cache::new(), Cache::new()],
            carried: [Cache::new(), Cache::new()],
            direction_bounds: DirectionBounds::new([host, guest]),
            line_bound,
            frontier: None,
            leaf_pairs: 0,
            slices: Slices::new(options.budget),
        })
    }

    /// Processes these faces first, if both exist. Breaks if they answer the query.
    pub(super) fn try_faces(&mut self, faces: Option<[u32; 2]>) -> ControlFlow<()> {
        let scene = &self.scene;
        let exists = |faces: &[u32; 2]| [0, 1].iter().all(|&m| (faces[m] as usize) < scene.meshes[m].faces().len());
        if let Some(faces) = faces.filter(exists) {
            self.answer.process(scene, faces)?;
            self.direction_bounds.update(scene, self.answer.best.as_ref());
        }
        Continue(())
    }

    /// Searches from the roots. Keeps a frontier if the meshes have hardly moved since `since`,
    /// their relative frame at the last costly search.
    pub(super) fn run(&mut self, options: &Options<'_>, since: Option<&RelativeFrame>) {
        self.frontier = since.and_then(|since| Frontier::new(&self.scene, since, self.nodes, options, self.answer.cut));
        let found = if self.frontier.is_some() {
            self.advance_on(options.level)
        } else {
            dispatch!(options.level, simd => self.descend(simd))
        };
        if found.is_continue() {
            let _ = self.answer.process_deferred(&self.scene);
        }
        if let Some(frontier) = &mut self.frontier {
            frontier.complete(self.leaf_pairs);
        }
    }

    /// Resumes at the pairs that `frontier` does not prove far. Returns `false` if the meshes have
    /// changed or if a new search costs less.
    pub(super) fn resume(&mut self, frontier: Frontier, options: &Options<'_>) -> bool {
        let Some(frontier) = frontier.moved(&self.scene, self.nodes[GUEST], options, self.answer.cut) else {
            return false;
        };
        self.frontier = Some(frontier);
        if self.advance_on(options.level).is_continue() {
            let _ = self.answer.process_deferred(&self.scene);
        }
        true
    }

    /// Returns the state for the next search. `faces` are the faces that it tries first.
    pub(super) fn into_warm_start(self, faces: Option<[u32; 2]>) -> WarmStart {
        let costly =
            if self.leaf_pairs > COSTLY_PAIRS || self.frontier.is_some() { self.scene.bounds.relative } else { None };
        WarmStart { faces, frontier: self.frontier, costly }
    }

    /// Returns the nearest points so far, in the world frame, if a pair was processed.
    pub(super) fn nearest(&mut self) -> Option<Nearest> {
        self.answer.nearest(&self.scene, self.slices.is_stopped)
    }

    /// Runs [`advance`](Self::advance) on a vector unit. Both callers share the one copy that is
    /// compiled for each unit.
    #[inline(never)]
    fn advance_on(&mut self, level: Level) -> ControlFlow<()> {
        dispatch!(level, simd => self.advance(simd))
    }

    /// Searches from the roots, without a frontier.
    #[inline(always)]
    fn descend<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        self.open_both::<S, false>(simd, 0, 0);
        self.process_tasks::<S, false>(simd)
    }

    /// Resumes at each pair of children of the frontier that is not proved far.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S) -> ControlFlow<()> {
        for entry in 0..self.entries() as u32 {
            let Some(frontier) = &self.frontier else { break };
            let ([host, guest], near) = frontier.near(simd, entry, frontier.limit(self.answer.cut));
            // There is no bound along the direction between the witnesses yet.
            let reach = Reach { both: f32::INFINITY, along: self.direction_bounds.along() };
            for (guest_lane, near) in near.into_iter().enumerate() {
                for host_lane in bits(near) {
                    let host = Slot { node: host, lane: host_lane as u8 };
                    let guest = Slot { node: guest, lane: guest_lane as u8 };
                    self.tasks.push(Task { bound: f32::NEG_INFINITY, reach, slots: [host, guest], entry });
                }
            }
            self.process_tasks::<S, true>(simd)?;
        }
        Continue(())
    }

    /// Processes all tasks. Breaks if the query is answered or the budget is spent.
    #[inline(always)]
    fn process_tasks<S: Simd, const KEEPS: bool>(&mut self, simd: S) -> ControlFlow<()> {
        while let Some(task) = self.tasks.pop() {
            self.slices.count_task()?;
            let are_copies = || self.answer.skips_copies && self.scene.are_copies(task.slots);
            if task.bound > self.answer.node_limit || are_copies() {
                continue;
            }
            let cut = self.answer.cut;
            if self.direction_bounds.are_apart(simd, task.reach, task.slots, cut) {
                self.raise::<KEEPS>(&task, cut);
                continue;
            }
            let [host, guest] = task.slots;
            let at = |side: usize, slot: Slot| (&self.nodes[side][slot.node as usize], usize::from(slot.lane));
            let ((host_node, host_lane), (guest_node, guest_lane)) = (at(HOST, host), at(GUEST, guest));
            let line = self.line_bound.line(&host_node.lane_bounds(host_lane), &guest_node.lane_bounds(guest_lane));
            if let Some(length) = line.remainder().if_longer(cut) {
                self.raise::<KEEPS>(&task, length);
                continue;
            }
            let children = [host_node.child(host_lane), guest_node.child(guest_lane)];
            let slabs = Slab::of_both(simd, &children, &self.nodes, &self.packets);
            if let Some(length) = self.line_bound.along_normal(&line, &slabs, cut).if_longer(cut) {
                self.raise::<KEEPS>(&task, length);
                continue;
            }
            let entries = self.entries();
            // The node to open, if not both.
            let one = match children {
                [Child::Leaf(host), Child::Leaf(guest)] => {
                    if let Some(length) = line.remainder_in_slabs(&slabs).if_longer(cut) {
                        self.raise::<KEEPS>(&task, length);
                    } else {
                        let least = self.process_leaves::<S, KEEPS>(simd, [host, guest])?;
                        self.leaf_pairs += 1;
                        self.raise::<KEEPS>(&task, f64::from(least));
                    }
                    continue;
                }
                [Child::Inner(node), Child::Leaf(_)] => Some((HOST, node, guest)),
                [Child::Leaf(_), Child::Inner(node)] => Some((GUEST, node, host)),
                [Child::Inner(host_node), Child::Inner(guest_node)] => {
                    let boxes = [self.box_of(simd, HOST, host), self.box_of(simd, GUEST, guest)];
                    let [host_size, guest_size] = boxes.map(size);
                    if host_size > MAX_SIZE_RATIO * guest_size {
                        Some((HOST, host_node, guest))
                    } else if guest_size > MAX_SIZE_RATIO * host_size {
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
            // Children without an entry keep their bound and are opened again in the next search.
            if KEEPS
                && self.entries() > entries
                && let Some(frontier) = &mut self.frontier
            {
                frontier.mark_opened(task.entry, task.slots);
            }
        }
        Continue(())
    }

    /// Compares the triangles of two leaves. Returns a lower bound of their metric distances.
    #[inline(always)]
    fn process_leaves<S: Simd, const KEEPS: bool>(&mut self, simd: S, leaves: [u32; 2]) -> ControlFlow<(), f32> {
        let packets = [self.packets[HOST].get(simd, leaves[HOST]), self.packets[GUEST].get(simd, leaves[GUEST])];
        // Bounds that a frontier keeps are computed beyond the distance that matters.
        let beyond = if KEEPS { self.frontier.as_ref().map_or(1.0, Frontier::beyond) } else { 1.0 };
        let Self { scene, answer, leaves: cached, direction_bounds, .. } = self;
        let progress = Progress { answer, leaves: cached, direction_bounds, beyond };
        process_leaves::<S, KEEPS>(simd, scene, leaves, &packets, progress)
    }

    #[inline(always)]
    fn entries(&self) -> usize {
        self.frontier.as_ref().map_or(0, Frontier::len)
    }

    /// Raises the bound of the children of a task to a distance in metric units.
    #[inline(always)]
    fn raise<const KEEPS: bool>(&mut self, task: &Task, lower: f64) {
        if KEEPS && let Some(frontier) = &mut self.frontier {
            frontier.raise(task.entry, task.slots, lower, self.scene.metric.error);
        }
    }

    /// Adds an entry for two nodes to the frontier, with the bounds of their boxes. Returns its
    /// index, or [`NO_ENTRY`].
    #[inline(always)]
    fn entry_of_both<S: Simd, const KEEPS: bool>(&mut self, simd: S, host: u32, guest: u32) -> u32 {
        let Self { scene, answer, nodes, carried: [carried_host, carried_guest], frontier, .. } = self;
        let Some(frontier) = frontier.as_mut().filter(|_| KEEPS) else { return NO_ENTRY };
        outlined(
            simd,
            #[inline(always)]
            || {
                let (host_node, guest_node) = (&nodes[HOST][host as usize], &nodes[GUEST][guest as usize]);
                let host_boxes = carried_boxes(carried_host, host, || scene.bounds.carry(simd, HOST, host_node));
                let guest_boxes = carried_boxes(carried_guest, guest, || scene.bounds.carry(simd, GUEST, guest_node));
                let Some(entry) = frontier.add_entry([host, guest]) else { return NO_ENTRY };
                for guest_lane in 0..guest_node.count() {
                    let guest_box = guest_boxes.lane(guest_lane);
                    let bounds = scene.bounds.of(simd, host_boxes, &guest_box, false, answer.node_limit).bounds;
                    frontier.keep_row(simd, entry, guest_lane, lanes_in_use(host_node), &bounds);
                }
                entry
            },
        )
    }

    /// Adds an entry for the children of a node of one side and one child of the other.
    #[inline(always)]
    fn entry_of_one<S: Simd, const KEEPS: bool>(&mut self, simd: S, side: usize, node: u32, other: Slot) -> u32 {
        if !KEEPS {
            return NO_ENTRY;
        }
        let one = self.box_of(simd, 1 - side, other);
        let Self { scene, answer, nodes, carried, frontier: Some(frontier), .. } = self else { return NO_ENTRY };
        let opened = &nodes[side][node as usize];
        outlined(
            simd,
            #[inline(always)]
            || {
                let many = carried_boxes(&mut carried[side], node, || scene.bounds.carry(simd, side, opened));
                let bounds = scene.bounds.of(simd, many, &one, side == GUEST, answer.node_limit).bounds;
                let pair = |opened: Slot| if side == HOST { [opened, other] } else { [other, opened] };
                let nodes = pair(Slot { node, lane: 0 }).map(|slot| slot.node);
                let Some(entry) = frontier.add_entry(nodes) else { return NO_ENTRY };
                for lane in 0..opened.count() {
                    frontier.keep(entry, pair(Slot { node, lane: lane as u8 }), bounds[lane]);
                }
                entry
            },
        )
    }

    /// Compares the children of two nodes, and queues the near pairs.
    #[inline(always)]
    fn open_both<S: Simd, const KEEPS: bool>(&mut self, simd: S, host: u32, guest: u32) {
        let entry = self.entry_of_both::<S, KEEPS>(simd, host, guest);
        let Self {
            scene, answer, tasks, found, nodes, carried: [carried_host, carried_guest], direction_bounds, ..
        } = self;
        let (host_node, guest_node) = (&nodes[HOST][host as usize], &nodes[GUEST][guest as usize]);
        let reached = direction_bounds.of_nodes(simd, [host, guest]);
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
        found.push(tasks, (direction_bounds.along(), entry), |[host_lane, guest_lane]| {
            [Slot { node: host, lane: host_lane }, Slot { node: guest, lane: guest_lane }]
        });
    }

    /// Compares the children of a node with one child of the other side, and queues the near pairs.
    #[inline(always)]
    fn open_one<S: Simd, const KEEPS: bool>(&mut self, simd: S, side: usize, node: u32, other: Slot) {
        let one = self.box_of(simd, 1 - side, other);
        let entry = self.entry_of_one::<S, KEEPS>(simd, side, node, other);
        let Self { scene, answer, tasks, found, nodes, carried, direction_bounds, .. } = self;
        let opened = &nodes[side][node as usize];
        let mut reaches = [f32::INFINITY; LANES];
        let mut near = lanes_in_use(opened);
        if let Some((both, threshold)) = direction_bounds.of_one(simd, side, node, other) {
            near &= !(both.simd_lt(f32x8::splat(simd, threshold.at(answer.cut))).to_bitmask() as u32);
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
        found.push(tasks, (direction_bounds.along(), entry), |lanes| {
            let opened = Slot { node, lane: lanes[side] };
            if side == HOST { [opened, other] } else { [other, opened] }
        });
    }

    /// Returns the box of a child of a node of one side, in the frame of comparison.
    #[inline(always)]
    fn box_of<S: Simd>(&mut self, simd: S, side: usize, slot: Slot) -> Aabb {
        let Self { scene, nodes, carried, .. } = self;
        let node = &nodes[side][slot.node as usize];
        let boxes = carried_boxes(&mut carried[side], slot.node, || scene.bounds.carry(simd, side, node));
        boxes.lane(usize::from(slot.lane))
    }
}

/// Returns the greatest extent of a box.
#[inline(always)]
fn size(bounds: Aabb) -> f32 {
    let [x, y, z] = by_axis!(axis => bounds.max[axis] - bounds.min[axis]);
    x.max(y).max(z)
}
