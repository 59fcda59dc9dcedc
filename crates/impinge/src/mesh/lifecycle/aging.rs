//! Measures how refits have degraded a hierarchy, and rebuilds it as a whole or in part.
//!
//! A refit keeps every answer correct and keeps the layout of the hierarchy. But if neighboring
//! faces have moved apart, the boxes above them grow and overlap others, and queries visit more
//! nodes. The expected cost of a query by the surface area heuristic measures this.

use std::sync::Arc;

use rayon::prelude::*;

use super::build::built;
use super::moved::Moved;
use crate::hierarchy::{Aged, BinaryTree, Builder, MAX_DEPTH, Origin, WideTree};
use crate::mesh::storage::leaf::{CHUNK, Leaf};
use crate::mesh::storage::positions::{Positions, Vertices};
use crate::mesh::triangle_mesh::{Data, Mesh};
use crate::storage::{Buffer, Pages};
use crate::volume::Aabb;

/// How a hierarchy has degraded since it was built. Each cost is the expected number of nodes that
/// a small object in the root's box overlaps, so it does not depend on the size of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aging {
    /// Cost of the hierarchy as it is.
    pub cost: f64,
    /// Cost when the hierarchy was built or last rebuilt.
    pub cost_when_built: f64,
}

impl Aging {
    /// Ratio of the costs above which a rebuild pays, if the mesh is queried more than once between
    /// moves. A smaller value causes rebuilds that gain little; a larger one leaves queries slower
    /// than necessary. The measurement is in `docs/notes/hierarchies.md`.
    pub const WORTH_REBUILDING: f64 = 1.5;

    /// Returns the cost now divided by the cost when built: 1 for a new hierarchy, and less than 1
    /// if moving the vertices has improved it.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.cost / self.cost_when_built
    }

    /// Reports whether the ratio is above [`WORTH_REBUILDING`](Self::WORTH_REBUILDING).
    #[must_use]
    pub fn is_worth_rebuilding(&self) -> bool {
        self.ratio() > Self::WORTH_REBUILDING
    }
}

impl Mesh {
    /// Returns the cost of the hierarchy now, and its cost when it was built or last rebuilt.
    #[must_use]
    pub fn aging(&self) -> Aging {
        let data = &*self.0;
        Aging { cost: data.cost(), cost_when_built: data.costs_as_built().first().copied().unwrap_or(1.0) }
    }

    /// Builds the hierarchy again for the current vertices. Clones of the mesh keep the old one. No
    /// answer depends on it.
    ///
    /// ```
    /// # use impinge::{Mesh, Positions, hierarchy::Builder};
    /// # let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # let mut mesh = Mesh::new(Positions::F32(corners.clone()), vec![[0, 1, 2]])?;
    /// if mesh.refit(Positions::F32(corners))?.is_worth_rebuilding() {
    ///     mesh.rebuild(Builder::default());
    /// }
    /// assert_eq!(mesh.aging().ratio(), 1.0);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Complexity
    /// As [`Builder::build`].
    pub fn rebuild(&mut self, builder: Builder) {
        let data = &*self.0;
        let (tree, leaves) = built(data.vertices.slice(), &data.faces, &data.frame, builder);
        self.with_vertices(|vertices, old| Data::new(vertices, old.faces.clone(), old.frame, tree, Arc::new(leaves)));
    }

    /// Rebuilds the smallest subtrees whose cost exceeds
    /// [`WORTH_REBUILDING`](Aging::WORTH_REBUILDING) times their cost when built, and keeps the
    /// others. If only a part of the mesh has moved, this is less work than
    /// [`rebuild`](Self::rebuild). Kept subtrees continue to age from their old cost. Subtrees with
    /// rebuilt parts age from now on. Returns the number of faces in rebuilt subtrees.
    ///
    /// # Complexity
    /// A refit, and O(k log k) for subtrees of k faces.
    pub fn rebuild_aged(&mut self) -> usize {
        let data = &*self.0;
        let aged = data.tree.aged_subtrees(data.costs_as_built(), Aging::WORTH_REBUILDING);
        if aged.is_empty() {
            return 0;
        }
        let built: Vec<(WideTree, Vec<Leaf>)> = aged.iter().map(|subtree| data.rebuilt_subtree(subtree)).collect();
        let (replacements, layouts): (Vec<WideTree>, Vec<Vec<Leaf>>) = built.into_iter().unzip();
        let mut renewal = data.tree.renewed(&aged, &replacements);
        if aged[0].nodes == (0..data.tree.nodes().len()) || renewal.tree.depth() > MAX_DEPTH {
            self.rebuild(Builder::default());
            return self.faces().len();
        }
        let mut leaves: Buffer<Leaf> = Pages::zeroed(renewal.leaves.len());
        let placed = leaves.to_mut().par_iter_mut().zip(&renewal.leaves).with_min_len(CHUNK);
        placed.for_each(|(leaf, origin)| {
            *leaf = match *origin {
                Origin::Kept(old) => data.leaves[old as usize],
                Origin::Replaced { replacement, leaf } => layouts[replacement as usize][leaf as usize],
            }
        });
        let cost = data.moved().fit(&mut renewal.tree, &leaves);
        let mut costs = renewal.costs_as_built(data.costs_as_built());
        // The cost of the root, which has a rebuilt part below it.
        costs[0] = cost;
        let tree = renewal.tree;
        let faces = layouts.iter().flatten().map(|leaf| leaf.held().len()).sum();
        self.with_vertices(|vertices, old| {
            let data = Data::new(vertices, old.faces.clone(), old.frame, tree, Arc::new(leaves));
            let _ = data.costs_as_built.set(costs.into());
            data
        });
        faces
    }

    /// Replaces the data of the mesh by the result of `data`, which gets the same vertices.
    fn with_vertices(&mut self, data: impl FnOnce(Vertices, &Data) -> Data) {
        let vertices = match Arc::get_mut(&mut self.0) {
            Some(old) => std::mem::replace(&mut old.vertices, Vertices::Given(Positions::F32(Vec::new()))),
            None => Vertices::Given(self.positions().clone()),
        };
        self.0 = Arc::new(data(vertices, &self.0));
    }
}

impl Data {
    /// Returns the cost of each subtree when it was built. If no refit has stored it, this is the
    /// current cost.
    pub(in crate::mesh) fn costs_as_built(&self) -> &Arc<[f64]> {
        self.costs_as_built.get_or_init(|| {
            let mut costs = self.tree.subtree_costs();
            costs.iter_mut().take(1).for_each(|root| *root = self.cost());
            costs.into()
        })
    }

    /// Returns the cost of the tree, computed at the first call.
    fn cost(&self) -> f64 {
        *self.cost.get_or_init(|| self.tree.cost(self.leaves.len()))
    }

    /// Returns the vertices, faces and frame, for fitting a tree.
    fn moved(&self) -> Moved<'_> {
        Moved { vertices: self.vertices.slice(), faces: &self.faces, frame: &self.frame }
    }

    /// Builds a new tree of the faces below an aged subtree. Returns it with its leaves.
    fn rebuilt_subtree(&self, aged: &Aged) -> (WideTree, Vec<Leaf>) {
        let faces: Vec<u32> = self.leaves[aged.leaves.clone()].iter().flat_map(|leaf| leaf.held()).copied().collect();
        let boxes: Vec<Aabb> = faces.par_iter().map(|&face| self.face_bounds(face)).collect();
        let mut binary: BinaryTree = Builder::default().build(&boxes);
        binary.order.to_mut().iter_mut().for_each(|face| *face = faces[*face as usize]);
        let (tree, leaves) = WideTree::collapse(&binary);
        let layouts = leaves.iter().map(|&leaf| Leaf::holding(binary.held(leaf))).collect();
        (tree, layouts)
    }

    /// Returns the box of a face in the packed frame, rounded to nearest, as builders expect it.
    fn face_bounds(&self, face: u32) -> Aabb {
        let corners = self.faces[face as usize].map(|vertex| self.frame.pack(self.vertices.get(vertex as usize)));
        Aabb::of_points(corners.map(|corner| corner.map(|x| x as f32)))
    }
}
