//! The k-d tree: space split by axis-aligned planes, with each box stored in every cell that it
//! reaches into.
//!
//! Source: Bentley, *Multidimensional binary search trees used for associative searching*, 1975;
//! Ericson, 7.3.7. Ours departs in two ways: leaves hold several boxes, and the number of boxes on
//! both sides of planes is limited, so that a box has at most three copies on average.

use std::ops::ControlFlow;

use super::best::{Best, distance_squared, in_range};
use super::plane_tree::{PlaneNode, PlaneTree, Split};
use super::{Cells, Held, Holds, Items, Neighbor, Partition, Visitor, Work};
use crate::math::vec3::dot;
use crate::volume::{BoundingVolume, MinMax};

/// Maximum number of boxes in a leaf that is not split.
const CAPACITY: usize = 8;

/// Maximum number of copies of a box beyond the first, on average over the whole tree.
const EXTRA_COPIES: usize = 2;

/// Maximum depth of a node, in splits from the root. Halving ends after 32 splits; the rest allows
/// for boxes on both sides of a plane.
const MAX_DEPTH: usize = 40;

/// A k-d tree over boxes that do not move, or over points, which are boxes of zero size. It is made
/// for many searches for the nearest boxes or points.
///
/// # Complexity
/// Building takes O(n log n). A query takes O(log n + cells and boxes near it) for points, and for
/// boxes that are small compared with their distances. Boxes that all overlap are stored in a few
/// large leaves.
///
/// ```
/// use impinge::partition::{KdTree, Partition};
///
/// let tree = KdTree::of_points(&[[0.0; 3], [1.0, 0.0, 0.0], [5.0; 3]])?;
/// let near = tree.nearest([0.75, 0.0, 0.0], 2);
/// assert_eq!((near[0].key, near[1].key), (1, 0));
/// assert_eq!(near[0].distance_squared, 0.0625);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct KdTree(
    /// A box is copied to each leaf that it reaches into. A box that lies in a plane is stored
    /// above it only.
    PlaneTree<()>,
);

impl KdTree {
    /// Returns the tree of these boxes. The key of a box is its index in `boxes`.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        let mut spare = EXTRA_COPIES * boxes.len();
        Self(PlaneTree::build(boxes, |_| (), |held, depth| split_node(held, depth, &mut spare)))
    }

    /// Returns the tree of these points. The key of a point is its index in `points`.
    ///
    /// # Errors
    /// Returns the error of [`MinMax::new`] for the first point that is not finite or has a
    /// coordinate beyond 2^320.
    pub fn of_points(points: &[[f64; 3]]) -> Result<Self, crate::input::InputError> {
        let boxes: Result<Vec<MinMax>, _> = points.iter().map(|&point| MinMax::new(point, point)).collect();
        Ok(Self::build(&boxes?))
    }
}

/// Splits the boxes of a node if both sides get fewer boxes and few boxes are on both sides.
/// `spare` is the number of copies that the whole tree may still make.
fn split_node(mut held: Vec<Held>, depth: usize, spare: &mut usize) -> (Vec<Held>, Option<Split>) {
    let split = if held.len() > CAPACITY && depth < MAX_DEPTH { plane_for(&mut held) } else { None };
    let Some((axis, plane)) = split else { return (held, None) };
    let is_below = |held: &&Held| held.bounds.min()[axis] < plane;
    let is_above = |held: &&Held| held.bounds.max()[axis] >= plane;
    let (below, above) = (held.iter().filter(is_below).count(), held.iter().filter(is_above).count());
    let more = below + above - held.len();
    if below.max(above) == held.len() || 2 * more > held.len() || more > *spare {
        return (held, None);
    }
    *spare -= more;
    let sides = [held.iter().filter(is_below).copied().collect(), held.iter().filter(is_above).copied().collect()];
    (Vec::new(), Some((axis, plane, sides)))
}

/// Returns the plane through the median center of the boxes, perpendicular to the axis along which
/// the centers are spread most. Returns `None` if all centers coincide.
fn plane_for(held: &mut [Held]) -> Option<(usize, f64)> {
    let center = |held: &Held, axis: usize| 0.5 * held.bounds.min()[axis] + 0.5 * held.bounds.max()[axis];
    let extents = [0, 1, 2].map(|axis| {
        let centers = held.iter().map(|held| center(held, axis));
        centers.clone().fold(f64::MIN, f64::max) - centers.fold(f64::MAX, f64::min)
    });
    let axis = (0..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
    let middle = held.len() / 2;
    held.select_nth_unstable_by(middle, |one, other| {
        center(one, axis).total_cmp(&center(other, axis)).then(one.key.cmp(&other.key))
    });
    (extents[axis] > 0.0).then(|| (axis, center(&held[middle], axis)))
}

impl Holds for KdTree {
    fn items(&self) -> &Items {
        self.0.items()
    }
}

impl Partition for KdTree {
    fn cells(&self) -> Cells {
        Cells::Disjoint
    }

    /// Visits a box that is in several cells only once: in the cell that contains the minimum
    /// corner of its intersection with the query box.
    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        const ALL: [[f64; 3]; 2] = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
        let (min, max) = (bounds.min(), bounds.max());
        let mut stack: Vec<_> = self.0.root().map(|root| (root, ALL)).into_iter().collect();
        while let Some((at, [low, high])) = stack.pop() {
            let node = self.0.node(at);
            work.nodes += 1;
            if let Some([below, above]) = self.0.children(at) {
                if max[node.axis] >= node.plane {
                    let mut low = low;
                    low[node.axis] = node.plane;
                    stack.push((above, [low, high]));
                }
                if min[node.axis] < node.plane {
                    let mut high = high;
                    high[node.axis] = node.plane;
                    stack.push((below, [low, high]));
                }
                continue;
            }
            for held in self.0.held(at) {
                work.boxes += 1;
                if held.bounds.overlaps(bounds) {
                    let own = held.bounds.min();
                    let shared = |axis: usize| own[axis].max(min[axis]);
                    if (0..3).all(|axis| low[axis] <= shared(axis) && shared(axis) < high[axis]) {
                        visit(held.key)?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Descends to the near side of each plane first, and to the far side only if it is not too
    /// far. The squared distance to a cell is the sum of squares of the distances to its planes
    /// along each axis (Arya, Mount, *Algorithms for fast vector quantization*, 1993).
    fn nearest(&self, point: [f64; 3], count: usize) -> Vec<Neighbor> {
        let mut best = Best::new(count);
        let Some(root) = self.0.root().filter(|_| in_range(&point) && count > 0) else { return Vec::new() };
        let mut stack = Vec::with_capacity(MAX_DEPTH);
        stack.push((root, [0.0_f64; 3]));
        while let Some((mut at, away)) = stack.pop() {
            if dot(&away, &away) > best.limit() {
                continue;
            }
            while let Some([below, above]) = self.0.children(at) {
                let &PlaneNode { axis, plane, .. } = self.0.node(at);
                let is_below = point[axis] < plane;
                let (near, far) = if is_below { (below, above) } else { (above, below) };
                let mut beyond = away;
                beyond[axis] = beyond[axis].max(if is_below { plane - point[axis] } else { point[axis] - plane });
                stack.push((far, beyond));
                at = near;
            }
            for held in self.0.held(at) {
                best.offer_once(held.key, distance_squared(&point, &held.bounds));
            }
        }
        best.into_sorted()
    }
}
