//! The descent of one mesh with itself: every unordered pair of its faces whose boxes overlap,
//! once.
//!
//! The simultaneous descent of two trees would find every pair of neighbors twice and every face
//! with itself. Here a node is compared with itself by comparing its children in pairs, so every
//! unordered pair of leaves is found at most once. Both sides are in one frame, so no box is
//! carried and none grows (docs/notes/proof.md, L18).
//!
//! Guarded by the tests in `solids/self_intersection.rs` and by the benchmark `solids`.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::crowd;
use super::hubs::Hubs;
use crate::budget::Budget;
use crate::exact::{Corners, Placement, intersect_beyond_shared};
use crate::hierarchy::{Child, Node};
use crate::math::Pose;
use crate::mesh::Mesh;

/// Work that is left.
#[derive(Clone, Copy)]
enum Task {
    /// Compare a child with itself.
    Within(Child),
    /// Compare two children with each other.
    Between(Lane, Lane),
}

/// A child of a node, by the node and the lane that holds its box.
#[derive(Clone, Copy)]
struct Lane {
    node: u32,
    lane: u8,
}

/// Number of tasks between two checks of the budget. A task compares at most 8 x 8 faces, so
/// these take less than a millisecond.
const TASKS_PER_BUDGET_CHECK: usize = 1 << 6;

/// Number of tasks per thread into which the upper levels are split before threads share them.
const TASKS_PER_THREAD: usize = 64;

/// Maximum number of exactly decided pairs per face before the descent stops to look for hubs. Most
/// meshes need about ten. If it is smaller, hubs are looked for in more meshes without any; if it
/// is larger, more time is lost in meshes with hubs.
const MAX_DECISIONS_PER_FACE: usize = 32;

/// Maximum number of exactly decided pairs per face, without those that intersect, before the
/// descent gives way to cells of space. If it is smaller, more meshes are divided without need; if
/// it is larger, more time is lost before needles are.
const MAX_MISSES_PER_FACE: usize = 128;

/// Number of pairs of faces between two checks of the budget.
const PAIRS_PER_BUDGET_CHECK: usize = 1 << 9;

/// Faces whose pairs are wanted.
#[derive(Clone, Copy)]
pub(crate) enum WantedFaces<'w> {
    /// All faces.
    All,
    /// Faces that are marked, by face index. At least one of the two faces of a pair must be
    /// marked.
    WithMarked(&'w [bool]),
}

/// Returns the pairs of faces that have more in common than the hull of their shared positions. The
/// smaller index comes first, and pairs are in no particular order. If the budget ends the
/// search, these are the pairs found so far.
pub(crate) fn collect_self_intersecting(mesh: &Mesh, wanted: WantedFaces<'_>, budget: &Budget<'_>) -> Vec<[u32; 2]> {
    if let Some(found) = descend(mesh, wanted, None, budget) {
        return found;
    }
    let hubs = Hubs::of(mesh);
    let mut found =
        descend(mesh, wanted, Some(&hubs), budget).unwrap_or_else(|| compare_in_cells(mesh, wanted, &hubs, budget));
    if budget.is_spent() {
        return found;
    }
    let one_place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
    let at_hubs = hubs.collect(mesh, budget, |[one, other]| {
        intersect_beyond_shared(&one_place, &mesh.corners(one), &mesh.corners(other))
    });
    found.extend(at_hubs.into_iter().filter(|&[one, other]| wanted.includes(one) || wanted.includes(other)));
    found
}

/// Returns the pairs, without those of faces that share a hub. It stops and returns `None` once it
/// has decided many more pairs than most meshes need: all pairs if `hubs` is `None`, else those
/// that do not intersect.
fn descend(mesh: &Mesh, wanted: WantedFaces<'_>, hubs: Option<&Hubs>, budget: &Budget<'_>) -> Option<Vec<[u32; 2]>> {
    let has_wanted = wanted.nodes_with(mesh);
    let counted = AtomicUsize::new(0);
    let max_per_face = if hubs.is_some() { MAX_MISSES_PER_FACE } else { MAX_DECISIONS_PER_FACE };
    let max_counted = max_per_face * mesh.faces().len();
    let worker = || Worker::new(mesh, wanted, &has_wanted, hubs, budget);
    let mut first = worker();
    let mut tasks: Vec<Task> = (!first.nodes.is_empty()).then_some(Task::Within(Child::Inner(0))).into_iter().collect();
    let enough = TASKS_PER_THREAD * rayon::current_num_threads();
    while !tasks.is_empty() && tasks.len() < enough {
        if budget.is_spent() {
            return Some(first.found);
        }
        for task in std::mem::take(&mut tasks) {
            first.expand(task, &mut tasks);
        }
    }
    let shared: Option<Vec<Vec<[u32; 2]>>> = tasks
        .par_iter()
        .map(|&task| {
            let mut worker = worker();
            let mut stack = vec![task];
            let mut expanded = 0_usize;
            while let Some(task) = stack.pop() {
                if expanded.is_multiple_of(TASKS_PER_BUDGET_CHECK) && budget.is_spent() {
                    break;
                }
                let found_before = worker.found.len();
                worker.expand(task, &mut stack);
                expanded += 1;
                let decided = std::mem::take(&mut worker.decided);
                let more = if hubs.is_some() { decided - (worker.found.len() - found_before) } else { decided };
                if counted.fetch_add(more, Ordering::Relaxed) > max_counted {
                    return None;
                }
            }
            Some(worker.found)
        })
        .collect();
    first.found.extend(shared?.iter().flatten());
    Some(first.found)
}

/// Returns the pairs, without those of faces that share a hub, by comparing the faces in each cell
/// of a crowd.
fn compare_in_cells(mesh: &Mesh, wanted: WantedFaces<'_>, hubs: &Hubs, budget: &Budget<'_>) -> Vec<[u32; 2]> {
    let lists = crowd::cells(mesh, budget);
    let found = lists.into_par_iter().flat_map(|list| {
        let faces: Vec<Face> = list.into_iter().map(|face| Face::new(mesh, face)).collect();
        let rows_at_once = PAIRS_PER_BUDGET_CHECK.div_ceil(faces.len().max(1));
        let groups = (0..faces.len().div_ceil(rows_at_once)).into_par_iter().map(move |group| {
            let mut worker = Worker::new(mesh, wanted, &[], Some(hubs), budget);
            let rows = group * rows_at_once..((group + 1) * rows_at_once).min(faces.len());
            if !budget.is_spent() {
                for row in rows {
                    faces[row + 1..].iter().for_each(|other| worker.test_faces(&faces[row], other));
                }
            }
            worker.found
        });
        groups.flatten()
    });
    let mut found: Vec<[u32; 2]> = found.collect();
    // Faces that intersect may be in several common cells.
    found.par_sort_unstable();
    found.dedup();
    found
}

impl WantedFaces<'_> {
    /// Reports whether the pairs of a face are wanted.
    fn includes(self, face: u32) -> bool {
        match self {
            Self::All => true,
            Self::WithMarked(marks) => marks[face as usize],
        }
    }

    /// Returns for each node whether a wanted face is below. The list is empty if all faces are
    /// wanted.
    fn nodes_with(self, mesh: &Mesh) -> Vec<bool> {
        let nodes = mesh.0.tree.nodes();
        let mut has_wanted = match self {
            Self::All => Vec::new(),
            Self::WithMarked(_) => vec![false; nodes.len()],
        };
        // Children come after their parents.
        for index in (0..has_wanted.len()).rev() {
            has_wanted[index] = (0..nodes[index].count()).any(|lane| match nodes[index].child(lane) {
                Child::Inner(node) => has_wanted[node as usize],
                Child::Leaf(leaf) => mesh.leaf_faces(leaf).any(|face| self.includes(face)),
            });
        }
        has_wanted
    }
}

/// The state of one thread.
struct Worker<'m> {
    mesh: &'m Mesh,
    nodes: &'m [Node],
    wanted: WantedFaces<'m>,
    /// For each node whether a wanted face is below; empty if all faces are wanted.
    has_wanted: &'m [bool],
    /// Hubs, if they are known. Pairs of faces that share a hub are left out.
    hubs: Option<&'m Hubs>,
    one_place: Placement,
    budget: &'m Budget<'m>,
    found: Vec<[u32; 2]>,
    /// Number of pairs of faces that were decided exactly.
    decided: usize,
}

/// A face with its corners and its box.
struct Face {
    number: u32,
    corners: Corners,
    min: [f64; 3],
    max: [f64; 3],
}

impl Face {
    fn new(mesh: &Mesh, number: u32) -> Self {
        let corners = mesh.corners(number);
        let [a, b, c] = &corners;
        let extreme = |pick: fn(f64, f64) -> f64| std::array::from_fn(|k| pick(pick(a[k], b[k]), c[k]));
        Self { number, corners, min: extreme(f64::min), max: extreme(f64::max) }
    }
}

impl<'m> Worker<'m> {
    fn new(
        mesh: &'m Mesh,
        wanted: WantedFaces<'m>,
        has_wanted: &'m [bool],
        hubs: Option<&'m Hubs>,
        budget: &'m Budget<'m>,
    ) -> Self {
        let one_place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let nodes = mesh.0.tree.nodes();
        Self { mesh, nodes, wanted, has_wanted, hubs, one_place, budget, found: Vec::new(), decided: 0 }
    }

    /// Processes a task: appends the tasks below it, or tests its faces. Depth first, at most 64
    /// tasks per level are waiting, as each task adds at most 8 · 8 tasks, all deeper than it.
    fn expand(&mut self, task: Task, below: &mut Vec<Task>) {
        match task {
            Task::Within(Child::Leaf(leaf)) => {
                let faces = self.faces(leaf);
                for (number, face) in faces.iter().enumerate() {
                    for other in &faces[number + 1..] {
                        self.test_faces(face, other);
                    }
                }
            }
            Task::Within(Child::Inner(node)) => {
                for lane in lanes(&self.nodes[node as usize], node) {
                    let is_of_one_hub = self.hubs.is_some_and(|hubs| {
                        let common = hubs.of_child(lane.node, lane.lane);
                        common.first_common(common).is_some()
                    });
                    if !is_of_one_hub && self.is_wanted(self.child(lane)) {
                        below.push(Task::Within(self.child(lane)));
                    }
                    for other in lanes(&self.nodes[node as usize], node).skip(usize::from(lane.lane) + 1) {
                        self.push_between(lane, other, below);
                    }
                }
            }
            Task::Between(one, other) => match (self.child(one), self.child(other)) {
                (Child::Leaf(leaf), Child::Leaf(other)) => {
                    let others = self.faces(other);
                    for face in self.faces(leaf) {
                        for other in &others {
                            self.test_faces(&face, other);
                        }
                    }
                }
                (Child::Leaf(_), Child::Inner(node)) => self.push_with_each(one, node, below),
                (Child::Inner(node), Child::Leaf(_)) => self.push_with_each(other, node, below),
                (Child::Inner(node), Child::Inner(_)) => {
                    for lane in lanes(&self.nodes[node as usize], node) {
                        if self.overlap(lane, other) {
                            // The other child is opened against this one only, so its lanes are not
                            // tested for children that miss its box.
                            if let Child::Inner(node) = self.child(other) {
                                self.push_with_each(lane, node, below);
                            }
                        }
                    }
                }
            },
        }
    }

    /// Appends tasks for a child and each child of another node that may intersect it.
    fn push_with_each(&self, one: Lane, node: u32, below: &mut Vec<Task>) {
        for lane in lanes(&self.nodes[node as usize], node) {
            self.push_between(one, lane, below);
        }
    }

    /// Appends a task for two children, if their boxes overlap, a wanted face is below one of them,
    /// and not all their faces share a hub.
    fn push_between(&self, one: Lane, other: Lane, below: &mut Vec<Task>) {
        let share_a_hub = self.hubs.is_some_and(|hubs| {
            let [one, other] = [one, other].map(|Lane { node, lane }| hubs.of_child(node, lane));
            one.first_common(other).is_some()
        });
        if !share_a_hub
            && self.overlap(one, other)
            && (self.is_wanted(self.child(one)) || self.is_wanted(self.child(other)))
        {
            below.push(Task::Between(one, other));
        }
    }

    /// Reports whether a wanted face is below a child.
    fn is_wanted(&self, child: Child) -> bool {
        match (child, self.wanted) {
            (_, WantedFaces::All) => true,
            (Child::Inner(node), _) => self.has_wanted[node as usize],
            (Child::Leaf(leaf), wanted) => self.mesh.leaf_faces(leaf).any(|face| wanted.includes(face)),
        }
    }

    fn child(&self, Lane { node, lane }: Lane) -> Child {
        self.nodes[node as usize].child(usize::from(lane))
    }

    /// Reports whether the boxes of two children overlap.
    fn overlap(&self, one: Lane, other: Lane) -> bool {
        let (a, b) = (&self.nodes[one.node as usize], &self.nodes[other.node as usize]);
        let (i, j) = (usize::from(one.lane), usize::from(other.lane));
        (0..3).all(|axis| a.min[axis][i] <= b.max[axis][j] && b.min[axis][j] <= a.max[axis][i])
    }

    /// Returns the faces of a leaf with their boxes.
    fn faces(&self, leaf: u32) -> Vec<Face> {
        self.mesh.leaf_faces(leaf).map(|face| Face::new(self.mesh, face)).collect()
    }

    /// Decides whether two faces intersect beyond their shared positions, unless their boxes are
    /// apart, neither is wanted, or they share a hub.
    fn test_faces(&mut self, one: &Face, other: &Face) {
        let near = (0..3).all(|axis| one.min[axis] <= other.max[axis] && other.min[axis] <= one.max[axis]);
        let wanted = self.wanted.includes(one.number) || self.wanted.includes(other.number);
        let share_a_hub = |hubs: &Hubs| hubs.of_face(one.number).first_common(hubs.of_face(other.number)).is_some();
        if !near || !wanted || self.hubs.is_some_and(share_a_hub) {
            return;
        }
        self.decided += 1;
        if intersect_beyond_shared(&self.one_place, &one.corners, &other.corners) {
            if self.found.len() == self.found.capacity() && !self.budget.reserve(&mut self.found, 1) {
                return;
            }
            self.found.push([one.number.min(other.number), one.number.max(other.number)]);
        }
    }
}

/// Returns the children of a node.
fn lanes(node: &Node, index: u32) -> impl Iterator<Item = Lane> + use<> {
    (0..node.count() as u8).map(move |lane| Lane { node: index, lane })
}
