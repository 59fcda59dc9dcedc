//! The BSP tree over boxes: space split by the planes of their own faces, with boxes across a plane kept at it.
//!
//! Source: Fuchs, Kedem, Naylor, *On visible surface generation by a priori tree structures*, 1980; Ericson, 8.1 and 8.2 (planes of
//! the scene's own, judged by balance and by what they cut), 8.1.3 (node-storing). The faces of boxes lie across the axes, so
//! planes do. Triangles have one of their own, with planes in any direction.

use std::ops::ControlFlow;

use super::plane_tree::{PlaneTree, Split};
use super::{Cells, Held, Holds, Items, Partition, Visitor, Work};
use crate::volume::{BoundingVolume, MinMax};

/// Boxes of a node that is not split.
const CAPACITY: usize = 8;

/// Faces that are tried on each axis: quantiles, of which one is near enough to the best.
const TRIED: usize = 7;

/// What a box across a plane costs against one that is too many on a side: it is looked at from both (Ericson, 8.3.3, has 8
/// for polygons, which are cut).
const ACROSS: usize = 2;

/// Splits from the root.
const DEEPEST: usize = 48;

/// A BSP tree over boxes that stand still, such as rooms: its planes pass between them where they can.
///
/// # Complexity
/// Built in O(n log n) for boxes that can be parted. A question O(depth + boxes near it + boxes across the planes near it).
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
    /// Boxes on one side of a plane, which may touch it, are below that side's child. Boxes across it are in the node, with
    /// a box around them.
    PlaneTree<Option<MinMax>>,
);

impl BspTree {
    /// The tree of these boxes, whose keys are their places.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        Self(PlaneTree::build(boxes, around, part))
    }
}

/// Splits the boxes by the best plane, if there is one, and keeps those across it.
fn part(held: Vec<Held>, depth: usize) -> (Vec<Held>, Option<Split>) {
    let split = if held.len() > CAPACITY && depth < DEEPEST { best_plane(&held) } else { None };
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

/// Returns the least box around some boxes, or `None` if the slice is empty.
fn around(held: &[Held]) -> Option<MinMax> {
    held.iter().map(|held| held.bounds).reduce(|all, one| all.merged(&one))
}

/// Where a box lies to a plane.
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

/// The plane of a face that parts the boxes best; none that parts off less than an eighth of them.
fn best_plane(held: &[Held]) -> Option<(usize, f64)> {
    let mut best = (usize::MAX, None);
    for axis in 0..3 {
        let mut faces: Vec<f64> =
            held.iter().flat_map(|held| [held.bounds.min()[axis], held.bounds.max()[axis]]).collect();
        faces.sort_unstable_by(f64::total_cmp);
        for tried in 1..=TRIED {
            let plane = faces[tried * faces.len() / (TRIED + 1)];
            let (mut below, mut above) = (0_usize, 0_usize);
            for held in held {
                match side(&held.bounds, axis, plane) {
                    Side::Below => below += 1,
                    Side::Above => above += 1,
                    Side::Across => {}
                }
            }
            let across = held.len() - below - above;
            let cost = below.abs_diff(above) + ACROSS * across;
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
                // What touches the plane may meet what is on either side.
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
