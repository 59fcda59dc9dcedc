//! Shares of a descent, for several machines. A share compares some subtrees of one mesh with the
//! whole other mesh.
//!
//! Subtrees are chosen by the tree alone, never by boxes, so shares fit together although the
//! machines have different vector units. Guarded by `tests/it/engine/shares.rs`.

use super::sides::Sides;
use crate::hierarchy::{Descent, Node, Task};

/// Minimum number of subtrees in a share, if the tree has as many nodes. They lie far apart from
/// each other, so more make the cost of all shares about equal. Each costs a descent from the root
/// of the other tree.
const SUBTREES_PER_SHARE: usize = 8;

/// One of several shares of the search for intersecting pairs of faces. Each pair is in exactly one
/// of the shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    index: u32,
    of: u32,
}

impl Share {
    /// The whole search as one share.
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    /// Returns the share `index` of `of` shares, or `None` if there is no such share.
    #[must_use]
    pub fn new(index: u32, of: u32) -> Option<Self> {
        (index < of).then_some(Self { index, of })
    }

    /// Appends the tasks from which the descent of this share starts. It takes subtrees of the mesh
    /// with more faces, given the numbers of `faces` of the first and of the second mesh.
    pub(super) fn begin(self, descent: &Descent<'_>, sides: Sides, faces: [usize; 2], tasks: &mut Vec<Task>) {
        let Some(root) = descent.root() else { return };
        if self == Self::WHOLE {
            tasks.push(root);
            return;
        }
        // If both have as many faces, the first mesh is divided.
        let is_first_larger = faces[0] >= faces[1];
        let [divides_host, _] = sides.host_guest([is_first_larger, !is_first_larger]);
        let nodes = if divides_host { descent.host } else { descent.guest };
        let own = subtrees(nodes, SUBTREES_PER_SHARE.saturating_mul(self.of as usize));
        let own = own.into_iter().skip(self.index as usize).step_by(self.of as usize);
        tasks.extend(
            own.map(|node| if divides_host { Task { host: node, ..root } } else { Task { guest: node, ..root } }),
        );
    }
}

/// Returns nodes that have all leaves of a tree below them, each leaf below one: at least `wanted`
/// if the tree has as many.
fn subtrees(nodes: &[Node], wanted: usize) -> Vec<u32> {
    let mut level = vec![0];
    while level.len() < wanted {
        let below: Vec<u32> = level.iter().flat_map(|&node| opened(nodes, node)).collect();
        if below == level {
            break;
        }
        level = below;
    }
    level
}

/// Returns the children of a node, or the node itself if they are leaves.
fn opened(nodes: &[Node], node: u32) -> impl Iterator<Item = u32> + '_ {
    let opened = &nodes[node as usize];
    let count = if opened.holds_leaves() { 1 } else { opened.count() };
    (0..count).map(move |lane| if opened.holds_leaves() { node } else { opened.index(lane) })
}
