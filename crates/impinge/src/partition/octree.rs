//! Octrees: nested cubes, each of which is split if it holds many boxes (Ericson, 7.3).

use std::ops::ControlFlow;

use super::{
    Cells, Changes, Dynamic, Held, Holds, Items, Move, PairVisitor, Partition, Visitor, Work, forward_to_inner,
};
use crate::volume::{BoundingVolume, MinMax};

/// Maximum number of boxes in a cell before it is split. Comparing 16 boxes costs about as much as
/// visiting eight cells.
const CAPACITY: usize = 16;

/// Number of boxes at or below a split cell at which its children are joined again. It is well
/// below [`CAPACITY`], so that one box that is inserted and removed repeatedly does not split and
/// join a cell each time.
const JOIN_COUNT: u32 = 8;

/// Maximum depth of a cell, in splits from the root. The deepest cells have 2^-20 of the root's
/// edge; boxes closer to each other than that are compared.
const MAX_DEPTH: usize = 20;

/// Node number that stands for "no node".
const NONE: u32 = u32::MAX;

/// An octree: each box is in the smallest cube that contains it. Cubes of one level share no inner
/// point.
///
/// A box across the middle of a cell stays in that cell, however small it is. Large cells therefore
/// collect small boxes, and every query near a middle compares them; [`LooseOctree`] avoids this.
/// Boxes outside the root are stored in the root.
///
/// # Complexity
/// A change takes O(depth), and the depth is at most 20. A query takes O(cells and boxes near it,
/// and boxes across the middles of these cells).
///
/// ```
/// use impinge::partition::{Dynamic, Octree, Partition};
/// use impinge::volume::MinMax;
///
/// let mut tree = Octree::over(&MinMax::new([0.0; 3], [100.0; 3])?);
/// tree.insert(0, MinMax::new([49.0; 3], [51.0; 3])?);
/// tree.insert(1, MinMax::new([51.0; 3], [52.0; 3])?);
/// assert_eq!(tree.pairs(), [[0, 1]]);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Octree(Tree<false>);

/// An octree whose cells are enlarged to twice their width, so that the depth of a box depends on
/// its size and hardly on its position.
///
/// # Complexity
/// As for [`Octree`], except that a query visits up to eight times as many cells, none of which
/// holds small boxes far away.
///
/// # Source
/// Ulrich, *Loose octrees*, Game Programming Gems, 2000. Ours departs in that cells are split only
/// if they hold many boxes.
///
/// ```
/// use impinge::partition::{Dynamic, LooseOctree, Partition};
/// use impinge::volume::MinMax;
///
/// let mut tree = LooseOctree::over(&MinMax::new([0.0; 3], [100.0; 3])?);
/// tree.insert(0, MinMax::new([49.0; 3], [51.0; 3])?);
/// assert_eq!(tree.nearest([0.0; 3], 1)[0].key, 0);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LooseOctree(Tree<true>);

#[derive(Clone, Debug)]
struct Node {
    low: [f64; 3],
    high: [f64; 3],
    parent: u32,
    children: Option<[u32; 8]>,
    held: Vec<Held>,
    /// Number of boxes in this node and below it.
    count: u32,
    depth: usize,
}

#[derive(Clone, Debug)]
struct Tree<const LOOSE: bool> {
    /// Nodes, the root first.
    nodes: Vec<Node>,
    /// Unused nodes, in groups of eight: the first node of each group.
    free: Vec<u32>,
    /// Number of the node that holds the box, by key.
    homes: Vec<u32>,
    items: Items,
}

impl Node {
    fn middle(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis])
    }

    /// Returns the region in which boxes of this cell lie, as its minimum and maximum corner.
    fn space<const LOOSE: bool>(&self) -> [[f64; 3]; 2] {
        if !LOOSE {
            return [self.low, self.high];
        }
        let margin = [0, 1, 2].map(|axis| 0.5 * (self.high[axis] - self.low[axis]));
        [[0, 1, 2].map(|axis| self.low[axis] - margin[axis]), [0, 1, 2].map(|axis| self.high[axis] + margin[axis])]
    }

    /// Returns the child octant that contains the center of a box.
    fn octant(&self, bounds: &MinMax) -> usize {
        let middle = self.middle();
        let center = [0, 1, 2].map(|axis| 0.5 * bounds.min()[axis] + 0.5 * bounds.max()[axis]);
        (0..3).map(|axis| usize::from(center[axis] > middle[axis]) << axis).sum()
    }
}

impl<const LOOSE: bool> Tree<LOOSE> {
    /// Returns an empty tree, whose root is the smallest cube that contains `bounds` and starts at
    /// its minimum corner.
    fn over(bounds: &MinMax) -> Self {
        let edge = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
        let (low, high) = (bounds.min(), bounds.min().map(|x| x + edge));
        let root = Node { low, high, parent: NONE, children: None, held: Vec::new(), count: 0, depth: 0 };
        Self { nodes: vec![root], free: Vec::new(), homes: Vec::new(), items: Items::default() }
    }

    /// Returns the child of a split node that contains this box; `None` if the node is a leaf or no
    /// child contains it.
    fn child_for(&self, at: u32, bounds: &MinMax) -> Option<u32> {
        let node = &self.nodes[at as usize];
        let child = node.children?[node.octant(bounds)];
        let [low, high] = self.nodes[child as usize].space::<LOOSE>();
        let holds = (0..3).all(|axis| low[axis] <= bounds.min()[axis] && bounds.max()[axis] <= high[axis]);
        holds.then_some(child)
    }

    fn put(&mut self, held: Held) {
        let mut at = 0;
        self.nodes[at as usize].count += 1;
        while let Some(child) = self.child_for(at, &held.bounds) {
            at = child;
            self.nodes[at as usize].count += 1;
        }
        self.homes[held.key as usize] = at;
        let node = &mut self.nodes[at as usize];
        node.held.push(held);
        if node.children.is_none() && node.held.len() > CAPACITY && node.depth < MAX_DEPTH {
            self.split(at);
        }
    }

    /// Splits a leaf, then every child that still holds more than [`CAPACITY`] boxes.
    fn split(&mut self, first: u32) {
        let mut full = vec![first];
        while let Some(at) = full.pop() {
            let (middle, depth) = (self.nodes[at as usize].middle(), self.nodes[at as usize].depth + 1);
            let (low, high) = (self.nodes[at as usize].low, self.nodes[at as usize].high);
            let start = self.free.pop().unwrap_or_else(|| {
                let start = self.nodes.len() as u32;
                let empty = Node { parent: NONE, children: None, held: Vec::new(), count: 0, low, high, depth };
                self.nodes.resize(self.nodes.len() + 8, empty);
                start
            });
            for octant in 0..8_u32 {
                let is_high = |axis: usize| octant >> axis & 1 == 1;
                let child = &mut self.nodes[(start + octant) as usize];
                child.low = [0, 1, 2].map(|axis| if is_high(axis) { middle[axis] } else { low[axis] });
                child.high = [0, 1, 2].map(|axis| if is_high(axis) { high[axis] } else { middle[axis] });
                (child.parent, child.children, child.count, child.depth) = (at, None, 0, depth);
            }
            self.nodes[at as usize].children = Some(std::array::from_fn(|octant| start + octant as u32));
            let held = std::mem::take(&mut self.nodes[at as usize].held);
            for held in held {
                let home = self.child_for(at, &held.bounds).unwrap_or(at);
                self.homes[held.key as usize] = home;
                self.nodes[home as usize].held.push(held);
                self.nodes[home as usize].count += u32::from(home != at);
            }
            if depth < MAX_DEPTH {
                full.extend((start..start + 8).filter(|&child| self.nodes[child as usize].held.len() > CAPACITY));
            }
        }
    }

    /// Takes a box out of its node, and joins the topmost split cell that has at most
    /// [`JOIN_COUNT`] boxes left.
    fn take(&mut self, key: u32) {
        let home = self.homes[key as usize];
        let held = &mut self.nodes[home as usize].held;
        if let Some(at) = held.iter().position(|held| held.key == key) {
            held.swap_remove(at);
        }
        let (mut at, mut joined) = (home, None);
        while at != NONE {
            let node = &mut self.nodes[at as usize];
            node.count -= 1;
            if node.children.is_some() && node.count <= JOIN_COUNT {
                joined = Some(at);
            }
            at = node.parent;
        }
        if let Some(at) = joined {
            self.join(at);
        }
    }

    fn join(&mut self, top: u32) {
        let mut below: Vec<u32> = self.nodes[top as usize].children.take().into_iter().flatten().collect();
        if let Some(&first) = below.first() {
            self.free.push(first);
        }
        while let Some(at) = below.pop() {
            let held = std::mem::take(&mut self.nodes[at as usize].held);
            for held in held {
                self.homes[held.key as usize] = top;
                self.nodes[top as usize].held.push(held);
            }
            if let Some(children) = self.nodes[at as usize].children.take() {
                self.free.push(children[0]);
                below.extend(children);
            }
        }
    }
}

impl<const LOOSE: bool> Holds for Tree<LOOSE> {
    fn items(&self) -> &Items {
        &self.items
    }
}

impl<const LOOSE: bool> Partition for Tree<LOOSE> {
    fn cells(&self) -> Cells {
        if LOOSE { Cells::Loose } else { Cells::Disjoint }
    }

    fn overlapping_counted(&self, bounds: &MinMax, work: &mut Work, visit: &mut Visitor<'_>) -> ControlFlow<()> {
        let mut stack = vec![0_u32];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            work.nodes += 1;
            for held in &node.held {
                work.boxes += 1;
                if held.bounds.overlaps(bounds) {
                    visit(held.key)?;
                }
            }
            for child in node.children.into_iter().flatten() {
                let node = &self.nodes[child as usize];
                let [low, high] = node.space::<LOOSE>();
                let reaches = |axis: usize| low[axis] <= bounds.max()[axis] && bounds.min()[axis] <= high[axis];
                if node.count > 0 && (0..3).all(reaches) {
                    stack.push(child);
                }
            }
        }
        ControlFlow::Continue(())
    }
}

impl<const LOOSE: bool> Dynamic for Tree<LOOSE> {
    fn insert(&mut self, key: u32, to: MinMax) -> Option<MinMax> {
        let from = self.items.insert(key, to);
        if key as usize >= self.homes.len() {
            self.homes.resize(key as usize + 1, NONE);
        }
        if from.is_some() {
            self.take(key);
        }
        self.put(Held { bounds: to, key });
        from
    }

    fn remove(&mut self, key: u32) -> Option<MinMax> {
        let from = self.items.remove(key)?;
        self.take(key);
        Some(from)
    }
}

impl Octree {
    /// Returns an empty tree, whose root is the smallest cube that contains `bounds` and starts at
    /// its minimum corner.
    #[must_use]
    pub fn over(bounds: &MinMax) -> Self {
        Self(Tree::over(bounds))
    }
}

impl LooseOctree {
    /// Returns an empty tree, whose root is the smallest cube that contains `bounds` and starts at
    /// its minimum corner.
    #[must_use]
    pub fn over(bounds: &MinMax) -> Self {
        Self(Tree::over(bounds))
    }
}

forward_to_inner!(Octree);
forward_to_inner!(LooseOctree);
