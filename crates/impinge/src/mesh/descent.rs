//! The one descent of two meshes: from their roots to the triangles that meet, each pair filtered in bulk and, where
//! the filter leaves it open, decided exactly.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{Simd, dispatch};
use rayon::prelude::*;

use super::filter::{Guest, Verdict};
use super::packet::Packet;
use super::relation::Relation;
use super::{Mesh, Placed};
use crate::exact::{Placement, triangles_intersect};
use crate::hierarchy::{Carried, Descent, LEAF_CAPACITY, LeafVisitor, Task, bits};
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

/// Whether a visit goes on.
pub(crate) type Stop = ControlFlow<()>;

/// Tasks for each thread that the upper levels are opened into before threads share them out; more even out their
/// sizes, fewer start sooner.
const TASKS_PER_THREAD: usize = 64;

/// Tasks opened one after another before threads are woken at all: less work than this is done sooner than shared.
const SEQUENTIAL_TASKS: usize = 256;

/// Shows `found` every pair of faces (of a, of b) that intersect, each once, in no particular order, until it breaks
/// off. It is called from several threads, each with a collector of its own, which are returned in an order that
/// depends on the meshes alone.
pub(crate) fn visit_intersecting<C: Default + Send>(
    a: Placed<'_>,
    b: Placed<'_>,
    options: &Options,
    found: impl Fn(&mut C, u32, u32) -> Stop + Sync,
) -> Vec<C> {
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let (relation, swapped) = relate(a, b, placement.relative(), options.host);
    let (host, guest) = if swapped { (b.mesh, a.mesh) } else { (a.mesh, b.mesh) };
    let descent = Descent { host: host.0.tree.nodes(), guest: guest.0.tree.nodes(), map: &relation.boxes };
    let Some(root) = descent.root() else { return Vec::new() };

    let stopped = AtomicBool::new(false);
    let pairs = |collector: C| Pairs {
        host: host.leaves(),
        guest: guest.leaves(),
        relation: &relation,
        taken_up: Guest::EMPTY,
        guest_leaf: u32::MAX,
        placement: &placement,
        swapped,
        stopped: &stopped,
        found: &found,
        collector,
    };
    let level = options.level;

    // The upper levels, breadth first, until there is enough to share out.
    let threads = rayon::current_num_threads();
    let enough = if threads > 1 { SEQUENTIAL_TASKS.max(TASKS_PER_THREAD * threads) } else { usize::MAX };
    let mut first = pairs(C::default());
    let mut tasks = vec![root];
    if threads > 1 {
        dispatch!(level, simd => expand(simd, &descent, &mut tasks, enough, &mut first));
    }
    if tasks.len() < enough {
        let _ = dispatch!(level, simd => descent.run(simd, &mut tasks, &mut first));
        return vec![first.collector];
    }
    let chunk = tasks.len().div_ceil(TASKS_PER_THREAD * threads);
    let mut collectors = vec![first.collector];
    collectors.par_extend(tasks.par_chunks(chunk).map(|tasks| {
        let mut worker = pairs(C::default());
        let mut stack = tasks.to_vec();
        let _ = dispatch!(level, simd => descent.run(simd, &mut stack, &mut worker));
        worker.collector
    }));
    collectors
}

/// Opens tasks breadth first until there are enough of them or none is left.
#[inline(always)]
fn expand<S: Simd, V: LeafVisitor>(
    simd: S,
    descent: &Descent<'_>,
    tasks: &mut Vec<Task>,
    enough: usize,
    visitor: &mut V,
) {
    while !tasks.is_empty() && tasks.len() < enough {
        let mut below = Vec::with_capacity(4 * tasks.len());
        let mut carried = Carried::default();
        for task in tasks.drain(..) {
            if descent.open(simd, task, visitor, &mut carried, &mut below).is_break() {
                below.clear();
                break;
            }
        }
        *tasks = below;
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
struct Pairs<'a, C, F> {
    host: Leaves<'a>,
    guest: Leaves<'a>,
    relation: &'a Relation,
    taken_up: Guest,
    guest_leaf: u32,
    placement: &'a Placement,
    /// Whether the host is the second mesh.
    swapped: bool,
    /// Set by the thread that breaks off, for the others.
    stopped: &'a AtomicBool,
    found: &'a F,
    collector: C,
}

impl<C, F: Fn(&mut C, u32, u32) -> Stop> Pairs<'_, C, F> {
    /// Decides what the filter left open and reports what meets.
    #[inline(always)]
    fn report(&mut self, host_face: u32, guest_face: u32, open: bool) -> Stop {
        let (a, b) = if self.swapped { (guest_face, host_face) } else { (host_face, guest_face) };
        if open && !self.decide(a, b) {
            return Stop::Continue(());
        }
        let stop = (self.found)(&mut self.collector, a, b);
        if stop.is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        stop
    }

    #[cold]
    #[inline(never)]
    fn decide(&self, a: u32, b: u32) -> bool {
        let (mesh_a, mesh_b) = if self.swapped { (self.guest.mesh, self.host.mesh) } else { (self.host.mesh, self.guest.mesh) };
        triangles_intersect(self.placement, &mesh_a.corners(a), &mesh_b.corners(b))
    }
}

impl<C, F: Fn(&mut C, u32, u32) -> Stop> LeafVisitor for Pairs<'_, C, F> {
    #[inline(always)]
    fn take_up<S: Simd>(&mut self, simd: S, guest_leaf: u32) -> Aabb {
        if self.guest_leaf != guest_leaf {
            self.guest_leaf = guest_leaf;
            self.taken_up.take_up(simd, &self.guest.packets[guest_leaf as usize], self.relation);
        }
        self.taken_up.bounds
    }

    #[inline(always)]
    fn pair<S: Simd>(&mut self, simd: S, host_leaf: u32) -> Stop {
        let mut verdicts = [Verdict::default(); LANES];
        let met = self.taken_up.meet(simd, &self.host.packets[host_leaf as usize], &mut verdicts);
        if met == 0 {
            return Stop::Continue(());
        }
        if self.stopped.load(Ordering::Relaxed) {
            return Stop::Break(());
        }
        let host_faces = self.host.packet_faces[host_leaf as usize];
        let guest_faces = self.guest.packet_faces[self.guest_leaf as usize];
        for guest_lane in bits(met) {
            let verdict = verdicts[guest_lane];
            for lane in bits(verdict.meets | verdict.open) {
                self.report(host_faces[lane], guest_faces[guest_lane], verdict.open >> lane & 1 == 1)?;
            }
        }
        Stop::Continue(())
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
