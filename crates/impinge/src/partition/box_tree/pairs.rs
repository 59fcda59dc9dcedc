//! Finds all pairs by a simultaneous descent: the tree against itself, or against another tree.
//!
//! Source: Ericson, 6.3.2. A node against itself becomes each child against itself and one child
//! against the other.

use std::ops::ControlFlow;

use super::super::PairVisitor;
use super::super::pair_list::PairList;
use super::{BoxTree, MinMax};
use crate::budget::{Budget, Stopped};
use crate::volume::BoundingVolume;

impl BoxTree {
    pub(super) fn visit_own_pairs(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        let mut selves: Vec<u32> = self.bvh.root().into_iter().collect();
        let mut waiting = Vec::new();
        while let Some(at) = selves.pop() {
            let node = self.node(at);
            if !node.is_leaf() {
                let [one, other] = node.children;
                selves.extend([one, other]);
                waiting.push([one, other]);
                self.descend(self, &mut waiting, |[one, other]| visit([one.min(other), one.max(other)]))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns all pairs of a box of this tree and a box of `other` that overlap, as keys, by
    /// descending both trees at once. The result is sorted and equals that of
    /// [`Partition::pairs_with`](super::super::Partition::pairs_with).
    #[must_use]
    pub fn pairs_with_tree(&self, other: &Self) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        let _ = self.for_each_pair_with_tree(other, &mut |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        });
        pairs.sort_unstable();
        pairs
    }

    /// Returns the pairs of [`pairs_with_tree`](Self::pairs_with_tree). Ends early, without pairs,
    /// if the budget is spent.
    ///
    /// # Errors
    /// As for [`Partition::try_pairs`](super::super::Partition::try_pairs).
    pub fn try_pairs_with_tree(&self, other: &Self, budget: &Budget<'_>) -> Result<Vec<[u32; 2]>, Stopped> {
        let mut pairs = PairList::new(budget);
        let _ = self.for_each_pair_with_tree(other, &mut |pair| pairs.push(pair));
        pairs.into_sorted()
    }

    /// Visits all pairs of a box of this tree and a box of `other` that overlap, each once, in no
    /// particular order, by descending both trees at once. The key of the box of this tree comes
    /// first. Exact. Returns `Break` if the visitor ended the search.
    pub fn for_each_pair_with_tree(&self, other: &Self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        let (Some(root), Some(other_root)) = (self.bvh.root(), other.bvh.root()) else {
            return ControlFlow::Continue(());
        };
        self.descend(other, &mut vec![[root, other_root]], visit)
    }

    /// Descends pairs of nodes that overlap, expanding the higher node of each, and calls `found`
    /// with the keys of overlapping boxes. Returns `Break` if `found` ended the search.
    fn descend(
        &self,
        other: &Self,
        waiting: &mut Vec<[u32; 2]>,
        mut found: impl FnMut([u32; 2]) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        while let Some([one, two]) = waiting.pop() {
            let (a, b) = (self.node(one), other.node(two));
            if !a.bounds.overlaps(&b.bounds) {
                continue;
            }
            match (a.is_leaf(), b.is_leaf()) {
                (true, true) => {
                    let thin = !self.is_fat() && !other.is_fat();
                    let exact: [MinMax; 2] = [self.exact(a), other.exact(b)];
                    if thin || exact[0].overlaps(&exact[1]) {
                        found([a.key(), b.key()])?;
                    }
                }
                (false, is_leaf) if is_leaf || a.height >= b.height => {
                    waiting.extend(a.children.map(|child| [child, two]));
                }
                _ => waiting.extend(b.children.map(|child| [one, child])),
            }
        }
        ControlFlow::Continue(())
    }
}
