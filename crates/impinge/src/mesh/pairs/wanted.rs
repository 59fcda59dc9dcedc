//! Which intersecting pairs of two meshes a search wants, and what it can skip if it keeps only the
//! smallest.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use super::share::Share;
use crate::hierarchy::Child;
use crate::mesh::Mesh;

/// When pairs that the filter leaves undecided are decided exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Deciding {
    /// At once. If only some pairs are wanted, they are then the first ones in the order of the
    /// descent, which is the same for every vector unit.
    AtOnce,
    /// When nothing else is left, or too many are undecided. Meanwhile their faces and vertices are
    /// prefetched, and the filter may prove another pair intersecting. Which pair is found first
    /// differs between vector units.
    Last,
}

/// Which of the intersecting pairs are wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Number of found pairs at which the descent ends.
    pub(in crate::mesh) limit: usize,
    /// Maximum number of pairs that are kept: the smallest ones of those found.
    pub(in crate::mesh) kept: usize,
    /// When undecided pairs are decided.
    pub(super) deciding: Deciding,
    /// Share of the search that is run.
    pub(super) share: Share,
}

impl Wanted {
    /// All pairs.
    pub(in crate::mesh) const ALL: Self =
        Self { limit: usize::MAX, kept: usize::MAX, deciding: Deciding::Last, share: Share::WHOLE };
}

/// Removes all but the `kept` smallest pairs, which are left in no particular order.
pub(super) fn keep_smallest(pairs: &mut Vec<[u32; 2]>, kept: usize) {
    if pairs.len() > kept {
        pairs.select_nth_unstable(kept);
        pairs.truncate(kept);
    }
}

/// The faces of the first mesh whose pairs can still be among the smallest, shared by all threads.
pub(super) struct Kept<'m> {
    first: &'m Mesh,
    /// Largest index of a face whose pairs can be kept.
    last_face: AtomicU32,
    /// Smallest face below each node, computed when it is first needed.
    first_faces: OnceLock<Vec<u32>>,
}

impl<'m> Kept<'m> {
    /// Creates the state of a search that has found nothing. `first` is the first mesh.
    pub(super) fn new(first: &'m Mesh) -> Self {
        Self { first, last_face: AtomicU32::new(u32::MAX), first_faces: OnceLock::new() }
    }

    /// Returns the largest index of a face whose pairs can be kept.
    #[inline(always)]
    pub(super) fn last_face(&self) -> u32 {
        self.last_face.load(Ordering::Relaxed)
    }

    /// Trims a list to the `kept` smallest pairs. If there are as many, no pair of a larger face
    /// can be kept from now on, on any thread.
    pub(super) fn trim(&self, pairs: &mut Vec<[u32; 2]>, kept: usize) {
        keep_smallest(pairs, kept);
        if pairs.len() == kept {
            let last = pairs.iter().map(|pair| pair[0]).max().unwrap_or(u32::MAX);
            self.last_face.fetch_min(last, Ordering::Relaxed);
        }
    }

    /// Returns the smallest face below a node of the first mesh.
    pub(super) fn first_face(&self, node: u32) -> u32 {
        self.first_faces.get_or_init(|| first_faces(self.first))[node as usize]
    }
}

fn first_faces(mesh: &Mesh) -> Vec<u32> {
    let nodes = mesh.0.tree.nodes();
    let mut first = vec![u32::MAX; nodes.len()];
    // Children come after their parents.
    for (index, node) in nodes.iter().enumerate().rev() {
        for lane in 0..node.count() {
            let of_child = match node.child(lane) {
                Child::Inner(child) => first[child as usize],
                Child::Leaf(leaf) => mesh.leaf_faces(leaf).min().unwrap_or(u32::MAX),
            };
            first[index] = first[index].min(of_child);
        }
    }
    first
}
