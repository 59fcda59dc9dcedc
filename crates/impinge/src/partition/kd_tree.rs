//! The k-d tree: space split by planes across the axes, with each box in every cell that it reaches into.
//!
//! Source: Bentley, *Multidimensional binary search trees used for associative searching*, 1975; Ericson, 7.3.7. Ours departs in
//! leaves of several boxes, and in that boxes on both sides of a plane are counted, so that there are never more than three
//! copies of a box on average.

use std::ops::ControlFlow;

use super::best::{Best, distance_squared, in_range};
use super::plane_tree::{PlaneNode, PlaneTree, Split};
use super::{Cells, Held, Holds, Items, Neighbour, Partition, Visitor, Work};
use crate::math::vec3::dot;
use crate::volume::{BoundingVolume, MinMax};

/// Boxes of a leaf that is not split.
const CAPACITY: usize = 8;

/// Copies beyond one for each box, on average.
const MORE_COPIES: usize = 2;

/// Splits from the root. Halving ends after 32; more is for boxes on both sides.
const DEEPEST: usize = 40;

/// A k-d tree over boxes that stand still, and points, which are boxes without an extent: the kind for many questions of
/// what is near to points.
///
/// # Complexity
/// Built in O(n log n). A question O(log n + cells and boxes near it) for points and boxes that are small against their
/// distances; boxes that all overlap are in few, large leaves.
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
    /// Boxes are copied to each leaf that they reach into. A box on a plane reaches above it only.
    PlaneTree<()>,
);

impl KdTree {
    /// The tree of these boxes, whose keys are their places.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        let mut spare = MORE_COPIES * boxes.len();
        Self(PlaneTree::build(boxes, |_| (), |held, depth| part(held, depth, &mut spare)))
    }

    /// The tree of these points, whose keys are their places.
    ///
    /// # Errors
    /// As [`MinMax::new`], for the first point that is not finite or beyond 2^320.
    pub fn of_points(points: &[[f64; 3]]) -> Result<Self, crate::input::InputError> {
        let boxes: Result<Vec<MinMax>, _> = points.iter().map(|&point| MinMax::new(point, point)).collect();
        Ok(Self::build(&boxes?))
    }
}

/// Splits the boxes if both sides are smaller and few boxes are on both. `spare` is the number of copies that the whole tree
/// may still make.
fn part(mut held: Vec<Held>, depth: usize, spare: &mut usize) -> (Vec<Held>, Option<Split>) {
    let split = if held.len() > CAPACITY && depth < DEEPEST { plane_for(&mut held) } else { None };
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

/// A plane through the middle of the boxes across the axis along which their centres are spread most; none where these
/// are in one place.
fn plane_for(held: &mut [Held]) -> Option<(usize, f64)> {
    let centre = |held: &Held, axis: usize| 0.5 * held.bounds.min()[axis] + 0.5 * held.bounds.max()[axis];
    let extents = [0, 1, 2].map(|axis| {
        let centres = held.iter().map(|held| centre(held, axis));
        centres.clone().fold(f64::MIN, f64::max) - centres.fold(f64::MAX, f64::min)
    });
    let axis = (0..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
    let middle = held.len() / 2;
    held.select_nth_unstable_by(middle, |one, other| {
        centre(one, axis).total_cmp(&centre(other, axis)).then(one.key.cmp(&other.key))
    });
    (extents[axis] > 0.0).then(|| (axis, centre(&held[middle], axis)))
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

    /// A box is visited in the cell of the least corner of what it shares with the one that is asked about.
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

    /// The near side of each plane first, the other where it is not too far. Cells are as far as the sum of the squares of
    /// how far the planes about them are along each axis (Arya, Mount, *Algorithms for fast vector quantization*, 1993).
    fn nearest(&self, point: [f64; 3], count: usize) -> Vec<Neighbour> {
        let mut best = Best::new(count);
        let Some(root) = self.0.root().filter(|_| in_range(&point) && count > 0) else { return Vec::new() };
        let mut stack = Vec::with_capacity(DEEPEST);
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
