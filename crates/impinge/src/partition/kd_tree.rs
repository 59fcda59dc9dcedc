//! The k-d tree: space split by planes across the axes, with each box in every cell that it reaches into.
//!
//! Source: Bentley, *Multidimensional binary search trees used for associative searching*, 1975; Ericson, 7.3.7. Ours departs in
//! leaves of several boxes, and in that boxes on both sides of a plane are counted, so that there are never more than three
//! copies of a box on average.

use std::ops::ControlFlow;

use super::best::{Best, distance_squared, in_range};
use super::{Cells, Holds, Items, Neighbour, Partition, Visitor, Work};
use crate::volume::{BoundingVolume, MinMax};

/// Boxes of a leaf that is not split.
const CAPACITY: usize = 8;

/// Copies beyond one for each box, on average.
const MORE_COPIES: usize = 2;

/// Splits from the root. Halving ends after 32; more is for boxes on both sides.
const DEEPEST: usize = 40;

/// Not a child.
const LEAF: u32 = u32::MAX;

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
pub struct KdTree {
    /// The root first.
    nodes: Vec<Node>,
    copies: Vec<Held>,
    items: Items,
}

#[derive(Clone, Copy, Debug)]
struct Held {
    bounds: MinMax,
    key: u32,
}

/// What is below the plane is in the next node, what is on it or above in the one at `above`.
#[derive(Clone, Copy, Debug)]
struct Node {
    axis: usize,
    plane: f64,
    /// [`LEAF`] for a leaf.
    above: u32,
    /// Copies of a leaf.
    first: u32,
    count: u32,
}

impl KdTree {
    /// The tree of these boxes, whose keys are their places.
    #[must_use]
    pub fn build(boxes: &[MinMax]) -> Self {
        let mut tree = Self::default();
        let mut held = Vec::with_capacity(boxes.len());
        for (key, bounds) in boxes.iter().enumerate() {
            tree.items.insert(key as u32, *bounds);
            held.push(Held { bounds: *bounds, key: key as u32 });
        }
        let mut spare = MORE_COPIES * boxes.len();
        if !held.is_empty() {
            tree.subtree(held, 0, &mut spare);
        }
        tree
    }

    /// The tree of these points, whose keys are their places.
    ///
    /// # Errors
    /// As [`MinMax::new`], for the first point that is not finite or beyond 2^320.
    pub fn of_points(points: &[[f64; 3]]) -> Result<Self, crate::input::InputError> {
        let boxes: Result<Vec<MinMax>, _> = points.iter().map(|&point| MinMax::new(point, point)).collect();
        Ok(Self::build(&boxes?))
    }

    fn subtree(&mut self, mut held: Vec<Held>, depth: usize, spare: &mut usize) {
        let at = self.nodes.len();
        let split = if held.len() > CAPACITY && depth < DEEPEST { plane_for(&mut held) } else { None };
        let sides = split.and_then(|(axis, plane)| {
            let is_below = |held: &&Held| held.bounds.min()[axis] < plane;
            let is_above = |held: &&Held| held.bounds.max()[axis] >= plane;
            let (below, above) = (held.iter().filter(is_below).count(), held.iter().filter(is_above).count());
            let more = below + above - held.len();
            // Worth it where both sides are smaller, and few boxes are in both.
            let pays = below.max(above) < held.len() && 2 * more <= held.len() && more <= *spare;
            pays.then(|| {
                *spare -= more;
                let collect = |side: &dyn Fn(&&Held) -> bool| held.iter().filter(|held| side(held)).copied().collect();
                (axis, plane, collect(&is_below), collect(&is_above))
            })
        });
        let Some((axis, plane, below, above)): Option<(usize, f64, Vec<Held>, Vec<Held>)> = sides else {
            let (first, count) = (self.copies.len() as u32, held.len() as u32);
            self.nodes.push(Node { axis: 0, plane: 0.0, above: LEAF, first, count });
            self.copies.extend(held);
            return;
        };
        drop(held);
        self.nodes.push(Node { axis, plane, above: LEAF, first: 0, count: 0 });
        self.subtree(below, depth + 1, spare);
        self.nodes[at].above = self.nodes.len() as u32;
        self.subtree(above, depth + 1, spare);
    }

    fn held(&self, leaf: &Node) -> &[Held] {
        &self.copies[leaf.first as usize..(leaf.first + leaf.count) as usize]
    }
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
        &self.items
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
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![(0_u32, ALL)] };
        while let Some((at, [low, high])) = stack.pop() {
            let node = &self.nodes[at as usize];
            work.nodes += 1;
            if node.above != LEAF {
                if max[node.axis] >= node.plane {
                    let mut low = low;
                    low[node.axis] = node.plane;
                    stack.push((node.above, [low, high]));
                }
                if min[node.axis] < node.plane {
                    let mut high = high;
                    high[node.axis] = node.plane;
                    stack.push((at + 1, [low, high]));
                }
                continue;
            }
            for held in self.held(node) {
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
        if self.nodes.is_empty() || !in_range(&point) || count == 0 {
            return Vec::new();
        }
        let mut stack = Vec::with_capacity(DEEPEST);
        stack.push((0_u32, [0.0_f64; 3]));
        while let Some((mut at, away)) = stack.pop() {
            if away[0] * away[0] + away[1] * away[1] + away[2] * away[2] > best.limit() {
                continue;
            }
            while self.nodes[at as usize].above != LEAF {
                let Node { axis, plane, above, .. } = self.nodes[at as usize];
                let is_below = point[axis] < plane;
                let (near, far) = if is_below { (at + 1, above) } else { (above, at + 1) };
                let mut beyond = away;
                beyond[axis] = beyond[axis].max(if is_below { plane - point[axis] } else { point[axis] - plane });
                stack.push((far, beyond));
                at = near;
            }
            for held in self.held(&self.nodes[at as usize]) {
                best.offer_once(held.key, distance_squared(&point, &held.bounds));
            }
        }
        best.into_sorted()
    }
}
