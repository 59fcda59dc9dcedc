//! The one descent of two meshes: from their roots to the triangles that meet, each pair filtered in bulk and, where
//! the filter leaves it open, decided exactly.

use std::ops::ControlFlow;

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::filter::{Guest, Verdict};
use super::packet::Packet;
use super::relation::Relation;
use super::{Mesh, Placed};
use crate::exact::{Placement, triangles_intersect};
use crate::hierarchy::{Descent, LEAF_CAPACITY, LeafVisitor, Order, Task, bits};
use crate::math::RelativeMap;
use crate::simd::{self, LANES, Level, prefetch};
use crate::volume::Aabb;

/// How a query runs. Nothing here changes an answer: the fields are for measuring and for tests that say so.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The vector unit to use.
    pub level: Level,
    /// In whose frame boxes and triangles are compared.
    pub host: HostChoice,
}

impl Default for Options {
    fn default() -> Self {
        Self { level: simd::best_level(), host: HostChoice::SmallerError }
    }
}

/// In whose frame two meshes are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostChoice {
    /// The one in which rounding costs less, relative to the mesh carried into it (notes, 2.2).
    SmallerError,
    /// Always the first mesh's.
    First,
    /// Always the second mesh's.
    Second,
}

/// Tasks for each thread that the upper levels are opened into before threads share them out; more even out their
/// sizes, fewer start sooner.
const TASKS_PER_THREAD: usize = 64;

/// Below this many tasks no threads are woken: less work than this is done sooner than shared.
const LEAST_SHARED_TASKS: usize = 256;

/// Pairs of faces (of a, of b) that intersect, each once, in no particular order: all of them, or any `limit` of them
/// where there are more.
pub(crate) fn collect_intersecting(a: Placed<'_>, b: Placed<'_>, limit: usize, options: &Options) -> Vec<[u32; 2]> {
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let (relation, swapped) = relate(a, b, placement.relative(), options.host);
    let (host, guest) = if swapped { (b.mesh, a.mesh) } else { (a.mesh, b.mesh) };
    let descent = Descent { host: host.0.tree.nodes(), guest: guest.0.tree.nodes(), map: &relation.boxes };
    let (Some(root), true) = (descent.root(), limit > 0) else { return Vec::new() };

    let worker = || Pairs {
        host: host.leaves(),
        guest: guest.leaves(),
        relation: &relation,
        taken_up: Guest::EMPTY,
        guest_leaf: u32::MAX,
        placement: &placement,
        swapped,
        limit,
        found: Vec::new(),
    };
    let mut first = worker();
    let mut tasks = vec![root];
    let threads = rayon::current_num_threads();
    // The first few pairs are found sooner than threads could be woken.
    if threads > 1 && limit == usize::MAX {
        let enough = LEAST_SHARED_TASKS.max(TASKS_PER_THREAD * threads);
        work(options.level, &descent, Order::BreadthFirstUntil(enough), &mut tasks, &mut first);
        if tasks.len() >= enough {
            let chunk = tasks.len().div_ceil(TASKS_PER_THREAD * threads);
            let shared: Vec<Vec<[u32; 2]>> = tasks
                .par_chunks(chunk)
                .map(|tasks| {
                    let mut worker = worker();
                    work(options.level, &descent, Order::DepthFirst, &mut tasks.to_vec(), &mut worker);
                    worker.found
                })
                .collect();
            tasks.clear();
            first.found.extend(shared.iter().flatten());
        }
    }
    work(options.level, &descent, Order::DepthFirst, &mut tasks, &mut first);
    first.found.truncate(limit);
    first.found
}

/// The descent, compiled once for each vector unit.
#[inline(never)]
fn work(level: Level, descent: &Descent<'_>, order: Order, tasks: &mut Vec<Task>, pairs: &mut Pairs<'_>) {
    let stopped = dispatch!(level, simd => descent.run(simd, order, tasks, pairs)).is_break();
    if stopped {
        tasks.clear();
    }
}

/// The relation by the frame that the choice names, and whether the second mesh is the host.
fn relate(a: Placed<'_>, b: Placed<'_>, a_from_b: &RelativeMap, choice: HostChoice) -> (Relation, bool) {
    let (frame_a, frame_b) = (&a.mesh.0.frame, &b.mesh.0.frame);
    let hosted_by_a = || Relation::new(a_from_b, frame_a, frame_b);
    let hosted_by_b =
        || Relation::new(&RelativeMap::a_from_b(&b.world_from_mesh, &a.world_from_mesh), frame_b, frame_a);
    match choice {
        HostChoice::First => (hosted_by_a(), false),
        HostChoice::Second => (hosted_by_b(), true),
        HostChoice::SmallerError => {
            let (by_a, by_b) = (hosted_by_a(), hosted_by_b());
            // The error in units of the guest, whose boxes it blurs: a stretch of one unit of the guest is one unit.
            let blur = |relation: &Relation| f64::from(relation.boxes.slack()) / relation.stretch;
            let (blur_a, blur_b) = (blur(&by_a) / frame_b.scale, blur(&by_b) / frame_a.scale);
            if blur_b < blur_a { (by_b, true) } else { (by_a, false) }
        }
    }
}

/// What a mesh keeps for its leaves, as plain slices.
#[derive(Clone, Copy)]
struct Leaves<'a> {
    mesh: &'a Mesh,
    packets: &'a [Packet],
    packet_faces: &'a [[u32; LEAF_CAPACITY]],
}

impl Mesh {
    fn leaves(&self) -> Leaves<'_> {
        Leaves { mesh: self, packets: &self.0.packets, packet_faces: &self.0.packet_faces }
    }
}

/// Leaf pairs of two meshes, filtered and decided.
struct Pairs<'a> {
    host: Leaves<'a>,
    guest: Leaves<'a>,
    relation: &'a Relation,
    taken_up: Guest,
    guest_leaf: u32,
    placement: &'a Placement,
    /// Whether the host is the second mesh.
    swapped: bool,
    limit: usize,
    found: Vec<[u32; 2]>,
}

impl Pairs<'_> {
    /// Decides what the filter left open and keeps what meets.
    #[inline(never)]
    fn report(&mut self, host_leaf: u32, met: u32, verdicts: &[Verdict; LANES]) -> ControlFlow<()> {
        let host_faces = self.host.packet_faces[host_leaf as usize];
        let guest_faces = self.guest.packet_faces[self.guest_leaf as usize];
        for guest_lane in bits(met) {
            let verdict = verdicts[guest_lane];
            for lane in bits(verdict.meets | verdict.open) {
                let (host, guest) = (host_faces[lane], guest_faces[guest_lane]);
                let [a, b] = if self.swapped { [guest, host] } else { [host, guest] };
                if verdict.open >> lane & 1 == 0 || self.decide(a, b) {
                    self.found.push([a, b]);
                }
            }
        }
        if self.found.len() < self.limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    #[cold]
    #[inline(never)]
    fn decide(&self, a: u32, b: u32) -> bool {
        let (mesh_a, mesh_b) = if self.swapped { (self.guest.mesh, self.host.mesh) } else { (self.host.mesh, self.guest.mesh) };
        triangles_intersect(self.placement, &mesh_a.corners(a), &mesh_b.corners(b))
    }
}

impl LeafVisitor for Pairs<'_> {
    #[inline(always)]
    fn take_up<S: Simd>(&mut self, simd: S, guest_leaf: u32) -> Aabb {
        if self.guest_leaf != guest_leaf {
            self.guest_leaf = guest_leaf;
            self.taken_up.take_up(simd, &self.guest.packets[guest_leaf as usize], self.relation);
        }
        self.taken_up.bounds
    }

    #[inline(always)]
    fn pair<S: Simd>(&mut self, simd: S, host_leaf: u32) -> ControlFlow<()> {
        let mut verdicts = [Verdict::default(); LANES];
        let met = self.taken_up.meet(simd, &self.host.packets[host_leaf as usize], &mut verdicts);
        if met == 0 {
            return ControlFlow::Continue(());
        }
        self.report(host_leaf, met, &verdicts)
    }

    #[inline(always)]
    fn prefetch_guest(&self, leaf: u32) {
        prefetch(&self.guest.packets[leaf as usize]);
    }

    #[inline(always)]
    fn prefetch_host(&self, leaf: u32) {
        prefetch(&self.host.packets[leaf as usize]);
    }
}
