//! The simultaneous descent of two meshes, from their roots to the triangles that intersect. Pairs
//! of triangles are filtered in bulk, and undecided ones are decided exactly.
//!
//! Guarded by the tests in `engine/laws.rs` and `engine/ways.rs`, and by the benchmark `headline`.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::leaf_pairs::{CACHED_GUEST_LEAVES, LeafPairs, Question};
use super::relation::Relations;
use super::share::Share;
use super::sides::Sides;
use super::wanted::{Deciding, Kept, Wanted, keep_smallest};
use super::world_box;
use crate::budget::{Budget, Stopped};
use crate::exact::{Placement, triangles_intersect};
use crate::hierarchy::{Descent, Order, QUEUE, Task};
use crate::mesh::{Options, PlacedMesh};
use crate::simd::{Level, dispatch};

/// Number of node pairs that are opened between two checks of the budget: about 100
/// microseconds.
const TASKS_PER_BUDGET_CHECK: usize = 1 << 10;

/// Number of node pairs that are opened between two rounds of skipping, in a search that keeps only
/// the smallest pairs and has found enough.
const TASKS_PER_SKIP: usize = 1 << 5;

/// Number of tasks per thread into which the upper levels are split before threads share them. More
/// tasks balance the load better, fewer let threads start sooner.
const TASKS_PER_THREAD: usize = 64;

/// Minimum number of tasks for which threads are used. Less work than this is finished sooner on
/// one thread.
const MIN_SHARED_TASKS: usize = 256;

/// Initial capacity of the task stack: 1 KiB, which is enough for most searches for a first pair.
/// Growing it takes as long as opening a node pair.
const STACK_CAPACITY: usize = 128;

/// Returns any two faces that intersect, of the first and of the second mesh, or `None` if the
/// surfaces are disjoint. Which pair it is may differ between vector units. If the budget
/// ends the query, the pair may not intersect.
pub(crate) fn any_hit(a: PlacedMesh<'_>, b: PlacedMesh<'_>, options: &Options<'_>) -> Option<[u32; 2]> {
    search(a, b, Wanted { limit: 1, deciding: Deciding::Last, ..Wanted::ALL }, options).first().copied()
}

/// Reports whether two faces intersect. Returns `false` if either face index is out of range.
pub(crate) fn faces_intersect(a: PlacedMesh<'_>, b: PlacedMesh<'_>, [face_a, face_b]: [u32; 2]) -> bool {
    (face_a as usize) < a.mesh.faces().len()
        && (face_b as usize) < b.mesh.faces().len()
        && triangles_intersect(
            &Placement::new(&a.world_from_mesh, &b.world_from_mesh),
            &a.mesh.corners(face_a),
            &b.mesh.corners(face_b),
        )
}

/// Returns the first two faces that intersect in the order of the descent, or `None` if the
/// surfaces are disjoint. If the budget ends the query, the pair may not intersect.
pub(crate) fn first_hit(a: PlacedMesh<'_>, b: PlacedMesh<'_>, options: &Options<'_>) -> Option<[u32; 2]> {
    search(a, b, Wanted { limit: 1, deciding: Deciding::AtOnce, ..Wanted::ALL }, options).first().copied()
}

/// Returns pairs of faces (of a, of b) that intersect, without duplicates, in no particular order:
/// all of them, or the `kept` smallest if there are more. The memory is bounded by a small multiple
/// of `kept` per thread.
pub(crate) fn collect_intersecting(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    kept: usize,
    options: &Options<'_>,
) -> Vec<[u32; 2]> {
    search(a, b, Wanted { kept, ..Wanted::ALL }, options)
}

/// Returns the pairs of faces (of a, of b) that intersect and are in a share, without duplicates,
/// in no particular order.
pub(crate) fn collect_share(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    share: Share,
    options: &Options<'_>,
) -> Vec<[u32; 2]> {
    search(a, b, Wanted { share, ..Wanted::ALL }, options)
}

/// Runs the descent, and returns the pairs that are wanted.
fn search(a: PlacedMesh<'_>, b: PlacedMesh<'_>, wanted: Wanted, options: &Options<'_>) -> Vec<[u32; 2]> {
    if world_box::are_apart(&a, &b) {
        return Vec::new();
    }
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let Relations { relation, back, sides } = &Relations::new(a, b, placement.relative(), options.host);
    let sides = *sides;
    let [host, guest] = sides.host_guest([a.mesh, b.mesh]);
    let descent = Descent {
        host: host.0.tree.nodes(),
        guest: guest.0.tree.nodes(),
        boxes: &relation.boxes,
        host_slabs: &relation.slabs,
        guest_slabs: &back.slabs,
        stretch: relation.stretch as f32,
        edge_cross: &|| relation.edge_cross(),
    };
    let mut tasks = Vec::with_capacity(STACK_CAPACITY);
    wanted.share.begin(&descent, sides, [a.mesh, b.mesh].map(|mesh| mesh.faces().len()), &mut tasks);
    if tasks.is_empty() || wanted.kept == 0 {
        return Vec::new();
    }

    let kept = Kept::new(a.mesh);
    let budget = options.budget;
    let question = Question { host, guest, relation, back, placement: &placement, sides, wanted, kept: &kept, budget };
    if wanted.limit < usize::MAX {
        // A search for the first pairs wants each pair to be decided before others are looked at,
        // so nothing is queued.
        let mut pairs = question.pairs(1);
        if run_tasks(options, &descent, 1, &mut tasks, &mut pairs).is_break() {
            return vec![[0, 0]];
        }
        return pairs.found;
    }

    let mut first = question.pairs(CACHED_GUEST_LEAVES);
    let threads = rayon::current_num_threads();
    if threads > 1 {
        let enough = MIN_SHARED_TASKS.max(TASKS_PER_THREAD * threads);
        let order = Order::BreadthFirst { enough, most: TASKS_PER_BUDGET_CHECK };
        while !tasks.is_empty() && tasks.len() < enough {
            run_descent(options.level, &descent, order, &mut tasks, &mut first);
            if first.is_stopped || options.budget.is_spent() {
                tasks.clear();
            }
        }
        if tasks.len() >= enough {
            if wanted.kept < usize::MAX {
                // The smallest pairs are found first, so the others are soon skipped.
                tasks.sort_by_cached_key(|task| kept.first_face(first_node(sides, task)));
            }
            let chunk = tasks.len().div_ceil(TASKS_PER_THREAD * threads);
            let shared = tasks.par_chunks(chunk).map(|tasks| {
                let mut pairs = question.pairs(CACHED_GUEST_LEAVES);
                let _ = run_tasks(options, &descent, QUEUE, &mut tasks.to_vec(), &mut pairs);
                pairs.found
            });
            if wanted.kept < usize::MAX {
                let shared = shared.reduce(Vec::new, |mut some, others| {
                    some.extend(others);
                    keep_smallest(&mut some, wanted.kept);
                    some
                });
                first.found.extend(shared);
            } else {
                let shared: Vec<Vec<[u32; 2]>> = shared.collect();
                joined(options.budget, &mut first.found, &shared);
            }
            tasks.clear();
        }
    }
    let _ = run_tasks(options, &descent, QUEUE, &mut tasks, &mut first);
    keep_smallest(&mut first.found, wanted.kept);
    first.found
}

/// Appends lists of pairs to a list, as far as the budget allows. A canceled query has no use for
/// them.
fn joined(budget: &Budget<'_>, all: &mut Vec<[u32; 2]>, lists: &[Vec<[u32; 2]>]) {
    if budget.stopped() != Some(Stopped::Canceled) && budget.reserve(all, lists.iter().map(Vec::len).sum()) {
        lists.iter().for_each(|list| all.extend_from_slice(list));
    }
}

/// Returns the node of the first mesh that a task opens.
fn first_node(sides: Sides, task: &Task) -> u32 {
    let [first, _] = sides.first_second([task.host, task.guest]);
    first
}

/// Processes all tasks depth first. Returns `Break` if the budget is spent.
fn run_tasks(
    options: &Options<'_>,
    descent: &Descent<'_>,
    ahead: usize,
    tasks: &mut Vec<Task>,
    pairs: &mut LeafPairs<'_>,
) -> ControlFlow<()> {
    loop {
        let (kept, sides) = (pairs.question.kept, pairs.question.sides);
        let last_face = kept.last_face();
        let most = if last_face < u32::MAX {
            tasks.retain(|task| kept.first_face(first_node(sides, task)) <= last_face);
            TASKS_PER_SKIP
        } else {
            TASKS_PER_BUDGET_CHECK
        };
        run_descent(options.level, descent, Order::DepthFirst { ahead, most }, tasks, pairs);
        if pairs.is_stopped {
            return ControlFlow::Break(());
        }
        if tasks.is_empty() {
            return ControlFlow::Continue(());
        }
        if options.budget.is_spent() {
            return ControlFlow::Break(());
        }
    }
}

/// Runs the descent at a vector level. It is compiled once per vector unit.
#[inline(never)]
fn run_descent(level: Level, descent: &Descent<'_>, order: Order, tasks: &mut Vec<Task>, pairs: &mut LeafPairs<'_>) {
    let stopped = dispatch!(level, simd => descent.run(simd, order, tasks, pairs)).is_break();
    if stopped {
        tasks.clear();
    }
}
