//! A small tree over any volume and of any degree. It serves to measure volumes, degrees and
//! enclosures; the benchmark `hierarchies` does. Queries use [`WideTree`](super::WideTree), which
//! was the fastest.

mod boxes;
mod traverse;
mod volume;

pub use volume::NodeVolume;

use super::area::half_area;
use super::binary::BinaryTree;
use super::wide::Child;

/// The content that the volume of an inner node encloses (*Notes on Real Time Collision Detection*,
/// 3: a parent need not enclose its children's volumes, only their items).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Enclosure {
    /// The items below. Tight, and fitted anew at each level.
    Wrapped,
    /// The volumes of the children. Faster to build and to refit. Looser, unless merging loses
    /// nothing, as for boxes.
    Layered,
}

/// A tree of nodes with at most `DEGREE` children, from 2 to 32, each with a volume of kind `V`.
///
/// ```
/// use impinge::Pose;
/// use impinge::hierarchy::{Builder, Enclosure, GenericTree};
/// use impinge::volume::Aabb;
///
/// let points: Vec<[f64; 3]> = (0..100).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let boxes: Vec<Aabb> = points.iter().map(|p| Aabb::of_points([p.map(|x| x as f32)])).collect();
/// let binary = Builder::Median.build_with_leaves_of(1, &boxes);
/// let own_points = |item: u32, own: &mut Vec<[f64; 3]>| own.push(points[item as usize]);
/// let tree = GenericTree::<Aabb, 4>::new(&binary, own_points, Enclosure::Wrapped).unwrap();
///
/// let mut near = Vec::new();
/// let work = tree.pairs(&tree, &Pose::from_translation([99.0, 0.0, 0.0])?, |a, b| near.push((a, b)));
/// assert!(near == [(99, 0)] && work.volume_tests < 100);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct GenericTree<V: NodeVolume, const DEGREE: usize> {
    /// The root first. There are no nodes if there are no items.
    nodes: Vec<GenericNode<V, DEGREE>>,
    /// For each leaf the start and the length of its range of `order`.
    leaves: Vec<[u32; 2]>,
    order: Vec<u32>,
    root: Option<V>,
}

/// The children of a node, with volumes side by side. Lanes from `count` on are unused.
#[derive(Clone, Debug)]
struct GenericNode<V: NodeVolume, const DEGREE: usize> {
    volumes: V::Lanes<DEGREE>,
    children: [Child; DEGREE],
    count: usize,
}

impl<V: NodeVolume, const DEGREE: usize> GenericTree<V, DEGREE> {
    /// Builds the tree from a binary tree. It opens the nodes of the binary tree, the largest boxes
    /// first, until each node has `DEGREE` children. It fits the volumes to the points that
    /// `points_of` appends for an item; each item needs at least one point. All points are in one
    /// frame, the frame of the tree. Returns `None` if no volume can be fitted to some points.
    ///
    /// # Complexity
    /// O(n) fits of the points of an item. With [`Enclosure::Wrapped`] the fits process O(n log n)
    /// points in all.
    #[must_use]
    pub fn new(binary: &BinaryTree, points_of: impl Fn(u32, &mut Vec<[f64; 3]>), enclosure: Enclosure) -> Option<Self> {
        const { assert!(2 <= DEGREE && DEGREE <= 32) };
        let tree = Self { nodes: Vec::new(), leaves: Vec::new(), order: binary.order.to_vec(), root: None };
        let mut opening = Opening { binary, points_of, enclosure, tree, points: Vec::new() };
        if !binary.nodes.is_empty() {
            opening.tree.root = Some(opening.node(0)?.1);
        }
        Some(opening.tree)
    }

    /// Returns the size of the nodes in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }

    /// Returns the number of nodes with children.
    #[must_use]
    pub fn inner_count(&self) -> usize {
        self.nodes.len()
    }

    fn held(&self, leaf: u32) -> &[u32] {
        let [first, count] = self.leaves[leaf as usize];
        &self.order[first as usize..][..count as usize]
    }
}

struct Opening<'a, V: NodeVolume, P, const DEGREE: usize> {
    binary: &'a BinaryTree,
    points_of: P,
    enclosure: Enclosure,
    tree: GenericTree<V, DEGREE>,
    /// The points of the items of one volume.
    points: Vec<[f64; 3]>,
}

impl<V: NodeVolume, P: Fn(u32, &mut Vec<[f64; 3]>), const DEGREE: usize> Opening<'_, V, P, DEGREE> {
    /// Appends the node for a node of the binary tree and all below it, and returns its volume. The
    /// recursion is at most as deep as the binary tree, whose depth is bounded. The root becomes a
    /// node even if it is a leaf.
    fn node(&mut self, root: u32) -> Option<(Child, V)> {
        let (opened, count) = self.children(root);
        let at = self.tree.nodes.len();
        let is_leaf = self.binary.nodes[root as usize].right.is_none();
        if is_leaf && at > 0 {
            return self.leaf(root);
        }
        let nothing =
            GenericNode { volumes: V::lanes(std::array::from_fn(|_| None)), children: [Child::Leaf(0); DEGREE], count };
        self.tree.nodes.push(nothing);
        let mut volumes = [None; DEGREE];
        let mut children = [Child::Leaf(0); DEGREE];
        for lane in 0..count {
            let (child, volume) = if is_leaf { self.leaf(root)? } else { self.node(opened[lane])? };
            children[lane] = child;
            volumes[lane] = Some(volume);
        }
        let own = match self.enclosure {
            Enclosure::Wrapped => self.fitted(root)?,
            Enclosure::Layered => volumes.into_iter().flatten().reduce(|a, b| a.merged(&b))?,
        };
        self.tree.nodes[at] = GenericNode { volumes: V::lanes(volumes), children, count };
        Some((Child::Inner(at as u32), own))
    }

    fn leaf(&mut self, node: u32) -> Option<(Child, V)> {
        let volume = self.fitted(node)?;
        let held = &self.binary.nodes[node as usize];
        self.tree.leaves.push([held.first, held.count]);
        Some((Child::Leaf(self.tree.leaves.len() as u32 - 1), volume))
    }

    /// Fits a volume to all points below a node.
    fn fitted(&mut self, node: u32) -> Option<V> {
        self.points.clear();
        for &item in self.binary.held(node) {
            (self.points_of)(item, &mut self.points);
        }
        V::of_points(&self.points)
    }

    /// Returns the binary nodes that become the children. The largest is opened until there are
    /// enough.
    fn children(&self, root: u32) -> ([u32; DEGREE], usize) {
        let nodes = &self.binary.nodes;
        let mut lanes = [root; DEGREE];
        let mut count = 1;
        while count < DEGREE {
            let inner = (0..count).filter(|&lane| nodes[lanes[lane] as usize].right.is_some());
            let area = |lane: &usize| half_area(&nodes[lanes[*lane] as usize].bounds);
            let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b)).then(b.cmp(a))) else { break };
            let opened = lanes[largest];
            let Some(right) = nodes[opened as usize].right else { break };
            lanes.copy_within(largest + 1..count, largest + 2);
            lanes[largest] = opened + 1;
            lanes[largest + 1] = opened + right.get();
            count += 1;
        }
        (lanes, count)
    }
}
