//! Octrees: cubes in cubes, each of which is split where it holds many boxes (Ericson, 7.3).

use std::ops::ControlFlow;

use super::{Cells, Changes, Dynamic, Held, Holds, Items, Move, Partition, Visitor, Work, forward_to_inner};
use crate::volume::{BoundingVolume, MinMax};

/// Boxes that a cell holds before it is split: comparing so many costs about as much as opening eight cells.
const CAPACITY: usize = 16;

/// Boxes below a split cell at which it is joined again: so much fewer that none is split and joined by one box that comes
/// and goes.
const JOINED: u32 = 8;

/// Splits from the root: cells are 2^-20 of it then, and boxes that are closer are compared.
const DEEPEST: usize = 20;

/// Not a node.
const NONE: u32 = u32::MAX;

/// An octree whose cells share no inner point, with each box in the smallest cell that holds it.
///
/// A box across the middle of a cell stays there however small it is, so that large cells collect small boxes and every
/// question near a middle looks at them: [`LooseOctree`] is the cure. Boxes outside the root are in the root.
///
/// # Complexity
/// A change O(depth), at most 20; a question O(cells and boxes near it, and boxes across the middles of these cells).
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

/// An octree whose cells are twice as wide as those that they are made of, so that a box is about as deep as it is small,
/// wherever it lies.
///
/// # Complexity
/// As [`Octree`]; a question opens up to eight times as many cells, none of which holds boxes that are small and far.
///
/// # Source
/// Ulrich, *Loose octrees*, Game Programming Gems, 2000; ours departs in that cells are split only where they hold many.
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
    /// Boxes here and below.
    count: u32,
    depth: usize,
}

#[derive(Clone, Debug)]
struct Tree<const LOOSE: bool> {
    /// The root first.
    nodes: Vec<Node>,
    /// Nodes out of use: the first of eight each.
    free: Vec<u32>,
    /// The node of each key.
    homes: Vec<u32>,
    items: Items,
}

impl Node {
    fn middle(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis])
    }

    /// Where boxes of this cell may be.
    fn space<const LOOSE: bool>(&self) -> [[f64; 3]; 2] {
        if !LOOSE {
            return [self.low, self.high];
        }
        let margin = [0, 1, 2].map(|axis| 0.5 * (self.high[axis] - self.low[axis]));
        [[0, 1, 2].map(|axis| self.low[axis] - margin[axis]), [0, 1, 2].map(|axis| self.high[axis] + margin[axis])]
    }

    /// The child about the middle of a box.
    fn octant(&self, bounds: &MinMax) -> usize {
        let middle = self.middle();
        let centre = [0, 1, 2].map(|axis| 0.5 * bounds.min()[axis] + 0.5 * bounds.max()[axis]);
        (0..3).map(|axis| usize::from(centre[axis] > middle[axis]) << axis).sum()
    }
}

impl<const LOOSE: bool> Tree<LOOSE> {
    /// A tree of nothing over the least cube about `bounds`.
    fn over(bounds: &MinMax) -> Self {
        let edge = (0..3).map(|axis| bounds.max()[axis] - bounds.min()[axis]).fold(0.0, f64::max);
        let (low, high) = (bounds.min(), bounds.min().map(|x| x + edge));
        let root = Node { low, high, parent: NONE, children: None, held: Vec::new(), count: 0, depth: 0 };
        Self { nodes: vec![root], free: Vec::new(), homes: Vec::new(), items: Items::default() }
    }

    /// The child of a split node that holds this box.
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
        if node.children.is_none() && node.held.len() > CAPACITY && node.depth < DEEPEST {
            self.split(at);
        }
    }

    /// Splits a leaf, and those of its children that hold too many.
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
            if depth < DEEPEST {
                full.extend((start..start + 8).filter(|&child| self.nodes[child as usize].held.len() > CAPACITY));
            }
        }
    }

    /// Takes a box out of its node, and joins the topmost cell that has become nearly empty.
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
            if node.children.is_some() && node.count <= JOINED {
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
    /// Returns an empty tree, whose root is the least cube from the least corner of `bounds` that holds it.
    #[must_use]
    pub fn over(bounds: &MinMax) -> Self {
        Self(Tree::over(bounds))
    }
}

impl LooseOctree {
    /// Returns an empty tree, whose root is the least cube from the least corner of `bounds` that holds it.
    #[must_use]
    pub fn over(bounds: &MinMax) -> Self {
        Self(Tree::over(bounds))
    }
}

forward_to_inner!(Octree);
forward_to_inner!(LooseOctree);
