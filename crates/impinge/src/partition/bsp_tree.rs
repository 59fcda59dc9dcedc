//! The BSP tree over boxes: space split by the planes of their own faces, with boxes across a plane kept at it.
//!
//! Source: Fuchs, Kedem, Naylor, *On visible surface generation by a priori tree structures*, 1980; Ericson, 8.1 and 8.2 (planes of
//! the scene's own, judged by balance and by what they cut), 8.1.3 (node-storing). The faces of boxes lie across the axes, so
//! planes do. Triangles have one of their own, with planes in any direction.

use std::ops::ControlFlow;

use super::{Cells, Holds, Items, Partition, Visitor, Work};
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

/// Not a child.
const LEAF: u32 = u32::MAX;

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
pub struct BspTree {
    /// The root first.
    nodes: Vec<Node>,
    held: Vec<Held>,
    items: Items,
}

#[derive(Clone, Copy, Debug)]
struct Held {
    bounds: MinMax,
    key: u32,
}

/// What is wholly below the plane, and may touch it, is in the next node, what is wholly above in the one at `above`.
#[derive(Clone, Copy, Debug)]
struct Node {
    axis: usize,
    plane: f64,
    /// [`LEAF`] where nothing is split.
    above: u32,
    /// About the boxes that are kept here.
    bounds: Option<MinMax>,
    first: u32,
    count: u32,
}

impl BspTree {
    /// The tree of these boxes, whose keys are their places.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        let mut tree = Self::default();
        let mut held = Vec::with_capacity(boxes.len());
        for (key, bounds) in boxes.iter().enumerate() {
            tree.items.insert(key as u32, *bounds);
            held.push(Held { bounds: *bounds, key: key as u32 });
        }
        if !held.is_empty() {
            tree.subtree(held, 0);
        }
        tree
    }

    fn subtree(&mut self, held: Vec<Held>, depth: usize) {
        let split = if held.len() > CAPACITY && depth < DEEPEST { best_plane(&held) } else { None };
        let Some((axis, plane)) = split else {
            self.node(0, 0.0, &held);
            return;
        };
        let (mut below, mut above, mut across) = (Vec::new(), Vec::new(), Vec::new());
        for held in held {
            match side(&held.bounds, axis, plane) {
                Side::Below => below.push(held),
                Side::Above => above.push(held),
                Side::Across => across.push(held),
            }
        }
        let at = self.nodes.len();
        self.node(axis, plane, &across);
        self.subtree(below, depth + 1);
        self.nodes[at].above = self.nodes.len() as u32;
        self.subtree(above, depth + 1);
    }

    fn node(&mut self, axis: usize, plane: f64, held: &[Held]) {
        let bounds = held.iter().map(|held| held.bounds).reduce(|all, one| all.merged(&one));
        let (first, count) = (self.held.len() as u32, held.len() as u32);
        self.nodes.push(Node { axis, plane, above: LEAF, bounds, first, count });
        self.held.extend_from_slice(held);
    }
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
        &self.items
    }
}

impl Partition for BspTree {
    fn cells(&self) -> Cells {
        Cells::Disjoint
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![0_u32] };
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            work.nodes += 1;
            if node.bounds.is_some_and(|all| all.overlaps(bounds)) {
                for held in &self.held[node.first as usize..(node.first + node.count) as usize] {
                    work.boxes += 1;
                    if held.bounds.overlaps(bounds) {
                        visit(held.key)?;
                    }
                }
            }
            if node.above != LEAF {
                // What touches the plane may meet what is on either side.
                if bounds.max()[node.axis] >= node.plane {
                    stack.push(node.above);
                }
                if bounds.min()[node.axis] <= node.plane {
                    stack.push(at + 1);
                }
            }
        }
        ControlFlow::Continue(())
    }
}
