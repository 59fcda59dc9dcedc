//! Searches down from the root.

use std::ops::ControlFlow;

use super::{DynamicBvh, DynamicNode, Enclosable, MAX_LEAF_DEPTH};

/// The nodes that a search has still to visit: one for each step from the root, and two at the last
/// step.
#[derive(Debug)]
pub(crate) struct Stack<T> {
    waiting: [T; MAX_LEAF_DEPTH as usize + 2],
    len: usize,
}

impl<T: Copy> Stack<T> {
    #[inline]
    pub(crate) fn of(first: T) -> Self {
        Self { waiting: [first; MAX_LEAF_DEPTH as usize + 2], len: 1 }
    }

    #[inline]
    pub(crate) fn push(&mut self, node: T) {
        self.waiting[self.len] = node;
        self.len += 1;
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        Some(self.waiting[self.len])
    }
}

impl<B: Enclosable, const THOROUGH: bool> DynamicBvh<B, THOROUGH> {
    /// Visits each leaf whose bounds, and those of all nodes above it, are wanted.
    #[inline]
    pub(crate) fn search(
        &self,
        mut is_wanted: impl FnMut(&B) -> bool,
        mut visit: impl FnMut(&DynamicNode<B>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some(root) = self.root else { return ControlFlow::Continue(()) };
        let mut stack = Stack::of(root);
        while let Some(at) = stack.pop() {
            let node = self.node(at);
            if !is_wanted(&node.bounds) {
                continue;
            }
            if node.is_leaf() {
                visit(node)?;
            } else {
                stack.push(node.children[1]);
                stack.push(node.children[0]);
            }
        }
        ControlFlow::Continue(())
    }
}
