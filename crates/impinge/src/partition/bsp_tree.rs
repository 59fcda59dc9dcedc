//! The BSP tree over boxes: space split by planes through faces of the boxes, with boxes that cross
//! a plane stored at it.
//!
//! Source: Fuchs, Kedem, Naylor, *On visible surface generation by a priori tree structures*, 1980;
//! Ericson, 8.1 and 8.2 (planes taken from the scene, rated by balance and by the number of objects
//! they cut), 8.1.3 (node-storing). The faces of boxes are perpendicular to the axes, and so are
//! the planes. Triangles have their own BSP tree, with planes in any direction.

use std::ops::ControlFlow;

use super::plane_tree::{PlaneTree, Split};
use super::{Cells, Held, Holds, Items, Partition, Visitor, Work};
use crate::volume::{BoundingVolume, MinMax};

/// Maximum number of boxes in a node that is not split.
const CAPACITY: usize = 8;

/// Number of candidate faces per axis: evenly spaced quantiles. With seven, one is close enough to
/// the best plane.
const CANDIDATES_PER_AXIS: usize = 7;

/// Cost of a box across a plane, relative to one box of imbalance. It is 2 because queries on both
/// sides compare such a box (Ericson, 8.3.3, uses 8 for polygons, which are cut).
const ACROSS_COST: usize = 2;

/// Maximum depth of a node, in splits from the root.
const MAX_DEPTH: usize = 48;

/// A BSP tree over boxes that do not move, such as rooms. Its planes are axis-aligned, and pass
/// between the boxes if possible.
///
/// # Complexity
/// Building takes O(n log n) for boxes that planes can separate. A query takes O(depth + boxes near
/// it + boxes across the planes near it).
///
/// ```
/// use impinge::partition::{BspTree, Partition};
/// use impinge::volume::MinMax;
///
/// let rooms = [0.0, 4.0, 8.0].map(|x| MinMax::new([x, 0.0, 0.0], [x + 4.0, 5.0, 3.0]).unwrap());
/// let tree = BspTree::build(&rooms);
/// assert_eq!(tree.pairs(), [[0, 1], [1, 2]], "they share walls");
/// ```
#[derive(Clone, Debug, Default)]
pub struct BspTree(
    /// Boxes on one side of a plane, which may touch it, are in that side's subtree. Boxes across
    /// the plane are in the node, with a box around them.
    PlaneTree<Option<MinMax>>,
);

impl BspTree {
    /// Returns the tree of these boxes. The key of a box is its index in `boxes`.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        Self(PlaneTree::build(boxes, around, split_node))
    }
}

/// Splits the boxes of a node by the best plane, if there is one, and keeps the boxes across it in
/// the node.
fn split_node(held: Vec<Held>, depth: usize) -> (Vec<Held>, Option<Split>) {
    let split = if held.len() > CAPACITY && depth < MAX_DEPTH { best_plane(&held) } else { None };
    let Some((axis, plane)) = split else { return (held, None) };
    let (mut below, mut above, mut across) = (Vec::new(), Vec::new(), Vec::new());
    for held in held {
        match side(&held.bounds, axis, plane) {
            Side::Below => below.push(held),
            Side::Above => above.push(held),
            Side::Across => across.push(held),
        }
    }
    (across, Some((axis, plane, [below, above])))
}

/// Returns the smallest box around the boxes, or `None` if the slice is empty.
fn around(held: &[Held]) -> Option<MinMax> {
    held.iter().map(|held| held.bounds).reduce(|all, one| all.merged(&one))
}

/// Position of a box relative to a plane. A box that touches the plane from one side is on that
/// side.
enum Side {
    Below,
    Above,
    Across,
}

fn side(bounds: &MinMax, axis: usize, plane: f64) -> Side {
    if bounds.max()[axis] <= plane {
        Side::Below
    } else if bounds.min()[axis] >= plane {
        Side::Above
    } else {
        Side::Across
    }
}

/// Returns the plane through a face with the lowest cost, or `None` if every candidate separates
/// off less than 1/8 of the boxes.
fn best_plane(held: &[Held]) -> Option<(usize, f64)> {
    let mut best = (usize::MAX, None);
    for axis in 0..3 {
        let mut faces: Vec<f64> =
            held.iter().flat_map(|held| [held.bounds.min()[axis], held.bounds.max()[axis]]).collect();
        faces.sort_unstable_by(f64::total_cmp);
        for candidate in 1..=CANDIDATES_PER_AXIS {
            let plane = faces[candidate * faces.len() / (CANDIDATES_PER_AXIS + 1)];
            let (mut below, mut above) = (0_usize, 0_usize);
            for held in held {
                match side(&held.bounds, axis, plane) {
                    Side::Below => below += 1,
                    Side::Above => above += 1,
                    Side::Across => {}
                }
            }
            let across = held.len() - below - above;
            let cost = below.abs_diff(above) + ACROSS_COST * across;
            if below.max(above) + across <= held.len() - held.len() / 8 && cost < best.0 {
                best = (cost, Some((axis, plane)));
            }
        }
    }
    best.1
}

impl Holds for BspTree {
    fn items(&self) -> &Items {
        self.0.items()
    }
}

impl Partition for BspTree {
    fn cells(&self) -> Cells {
        Cells::Disjoint
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let mut stack: Vec<u32> = self.0.root().into_iter().collect();
        while let Some(at) = stack.pop() {
            let node = self.0.node(at);
            work.nodes += 1;
            if node.own.is_some_and(|all| all.overlaps(bounds)) {
                for held in self.0.held(at) {
                    work.boxes += 1;
                    if held.bounds.overlaps(bounds) {
                        visit(held.key)?;
                    }
                }
            }
            if let Some([below, above]) = self.0.children(at) {
                // A query box that touches the plane may overlap boxes on either side.
                if bounds.max()[node.axis] >= node.plane {
                    stack.push(above);
                }
                if bounds.min()[node.axis] <= node.plane {
                    stack.push(below);
                }
            }
        }
        ControlFlow::Continue(())
    }
}
