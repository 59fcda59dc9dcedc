//! Searches with one box, point or ray.

use std::ops::ControlFlow;

use super::super::best::{Best, distance_squared, in_range};
use super::super::{Cells, Holds, Items, Neighbor, PairVisitor, Partition, Ray, RayVisit, Visitor, Work};
use super::{BoxTree, DynamicNode, MinMax};
use crate::hierarchy::Stack;
use crate::volume::BoundingVolume;

impl BoxTree {
    /// Returns the exact box of a leaf.
    #[inline]
    pub(super) fn exact(&self, leaf: &DynamicNode<MinMax>) -> MinMax {
        if self.is_fat() { *self.items.get(leaf.key()).unwrap_or(&leaf.bounds) } else { leaf.bounds }
    }
}

impl Holds for BoxTree {
    fn items(&self) -> &Items {
        &self.items
    }
}

impl Partition for BoxTree {
    fn cells(&self) -> Cells {
        Cells::Volumes
    }

    fn bounds(&self) -> Option<MinMax> {
        self.bvh.root().map(|root| self.node(root).bounds)
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let Work { nodes, boxes } = work;
        self.bvh.search(
            |around| {
                *nodes += 1;
                around.overlaps(bounds)
            },
            |leaf| {
                *boxes += 1;
                if !self.is_fat() || self.exact(leaf).overlaps(bounds) {
                    visit(leaf.key())?;
                }
                ControlFlow::Continue(())
            },
        )
    }

    /// Visits the nearer child first, so that a reach that shrinks prunes the search.
    fn ray(&self, ray: &Ray, visit: &mut dyn FnMut(RayVisit) -> f64) {
        let mut reach = ray.reach();
        let enters = |node: u32| ray.enters(&self.node(node).bounds).map(|t| (t, node));
        let Some(mut stack) = self.bvh.root().and_then(enters).map(Stack::of) else { return };
        while let Some((t, at)) = stack.pop() {
            if t > reach {
                continue;
            }
            let node = self.node(at);
            if node.is_leaf() {
                let exact = if self.is_fat() { ray.enters(&self.exact(node)) } else { Some(t) };
                if let Some(t) = exact.filter(|&t| t <= reach) {
                    reach = reach.min(visit(RayVisit { key: node.key(), t, reach }));
                }
                if reach < 0.0 {
                    return;
                }
                continue;
            }
            match node.children.map(enters) {
                [Some(one), Some(other)] => {
                    let (near, far) = if one.0 <= other.0 { (one, other) } else { (other, one) };
                    stack.push(far);
                    stack.push(near);
                }
                [Some(one), None] | [None, Some(one)] => stack.push(one),
                [None, None] => {}
            }
        }
    }

    /// Descends depth first, into the nearer child before the other.
    fn nearest(&self, point: [f64; 3], count: usize) -> Vec<Neighbor> {
        let mut best = Best::new(count);
        let Some(root) = self.bvh.root().filter(|_| in_range(&point) && count > 0) else { return Vec::new() };
        let distance = |node: u32| (distance_squared(&point, &self.node(node).bounds), node);
        let mut stack = Stack::of(distance(root));
        while let Some((near, at)) = stack.pop() {
            if near > best.limit() {
                continue;
            }
            let node = self.node(at);
            if node.is_leaf() {
                best.offer(node.key(), distance_squared(&point, &self.exact(node)));
                continue;
            }
            let [one, other] = node.children.map(distance);
            let (near, far) = if one.0 <= other.0 { (one, other) } else { (other, one) };
            stack.push(far);
            stack.push(near);
        }
        best.into_sorted()
    }

    fn for_each_pair(&self, visit: &mut PairVisitor<'_>) -> ControlFlow<()> {
        self.visit_own_pairs(visit)
    }
}
