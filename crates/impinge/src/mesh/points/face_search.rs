//! Finds the faces of a mesh that may be near something, through the tree, by a caller's bound for
//! boxes (docs/notes/proof.md, L31).
//!
//! Guarded by `tests/it/shapes/surfaces.rs`.

use std::ops::ControlFlow::{self, Break};

use crate::hierarchy::{Child, Node};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{dot, length, normalized};
use crate::mesh::Mesh;
use crate::mesh::storage::frame::{PACKING_ERROR, REACH};

/// A search for the faces of a mesh.
pub(crate) trait FaceSearch {
    /// Returns a lower bound of the distance to everything in a box of the mesh's own frame. NaN
    /// counts as near.
    fn bound(&self, center: &[f64; 3], half_extents: &[f64; 3]) -> f64;

    /// Returns the distance above which boxes are skipped.
    fn cut(&self) -> f64;

    /// Processes a face. Every face whose boxes are not farther than the cut comes once, unless the
    /// search is stopped by `Break`.
    fn visit(&mut self, face: u32) -> ControlFlow<()>;
}

impl Mesh {
    /// Runs a search: visits the faces of near boxes, the nearest boxes of each node first.
    ///
    /// # Accuracy
    /// Boxes are enlarged by the rounding error of unpacking: two roundings of coordinates of at
    /// most the origin's magnitude and the mesh's extent.
    pub(crate) fn search(&self, search: &mut impl FaceSearch) {
        let nodes = self.0.tree.nodes();
        if nodes.is_empty() {
            return;
        }
        let mut tasks = vec![(f64::NEG_INFINITY, Child::Inner(0))];
        while let Some((bound, child)) = tasks.pop() {
            if bound > search.cut() {
                continue;
            }
            match child {
                Child::Inner(node) => self.open(&nodes[node as usize], search, &mut tasks),
                Child::Leaf(leaf) => {
                    let faces = self.leaf(leaf).faces;
                    for (lane, &face) in faces.iter().enumerate() {
                        // Unused lanes repeat the first face.
                        if (lane == 0 || face != faces[0]) && search.visit(face) == Break(()) {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Queues the near children of a node, the nearest last.
    fn open(&self, node: &Node, search: &impl FaceSearch, tasks: &mut Vec<(f64, Child)>) {
        let start = tasks.len();
        for lane in 0..node.count() {
            let [center, half_extents] = self.child_box(node, lane);
            let bound = search.bound(&center, &half_extents);
            if bound > search.cut() {
                continue;
            }
            let mut at = tasks.len();
            while at > start && tasks[at - 1].0 < bound {
                at -= 1;
            }
            tasks.insert(at, (bound, node.child(lane)));
        }
    }

    /// Returns the center and the half-extents of a box that holds a child of a node, in the mesh's
    /// own frame.
    fn child_box(&self, node: &Node, lane: usize) -> [[f64; 3]; 2] {
        let frame = &self.0.frame;
        let (mut center, mut half_extents) = ([0.0; 3], [0.0; 3]);
        for k in 0..3 {
            let (min, max) = (f64::from(node.min[k][lane]), f64::from(node.max[k][lane]));
            center[k] = frame.origin[k] + 0.5 * (min + max) / frame.scale;
            let slack = 4.0 * UNIT_ROUNDOFF * (frame.origin[k].abs() + 2.0 * REACH / frame.scale);
            half_extents[k] = 0.5 * (max - min) / frame.scale + slack;
        }
        [center, half_extents]
    }

    /// Returns the children of a node, each with the center and the half-extents of a box that
    /// holds it, in the mesh's own frame.
    pub(crate) fn children(&self, node: u32) -> impl Iterator<Item = (Child, [[f64; 3]; 2])> {
        let node = &self.0.tree.nodes()[node as usize];
        (0..node.count()).map(move |lane| (node.child(lane), self.child_box(node, lane)))
    }

    /// Returns a slab that holds everything below a node, in the mesh's own frame: a unit normal,
    /// rounded, and bounds on the product of the normal and a point. Returns `None` if the node has
    /// no slab.
    ///
    /// # Accuracy
    /// The slab is widened by the rounding errors of packing and unpacking a point, and by those of
    /// a product of its rounded normal with a point of the mesh.
    pub(crate) fn slab(&self, node: u32) -> Option<([f64; 3], [f64; 2])> {
        let (slab, frame) = (self.0.tree.nodes()[node as usize].slab, &self.0.frame);
        let packed = slab.normal.map(f64::from);
        let (normal, across) = (normalized(&packed)?, length(&packed));
        let sizes: f64 = frame.origin.iter().map(|x| x.abs()).sum::<f64>() + 4.0 * REACH / frame.scale;
        let slack = 32.0 * UNIT_ROUNDOFF * sizes + 4.0 * PACKING_ERROR / frame.scale;
        let level = |packed: f32| f64::from(packed) / across / frame.scale + dot(&normal, &frame.origin);
        let bounds = [level(slab.min) - slack, level(slab.max) + slack];
        bounds.iter().all(|x| x.is_finite()).then_some((normal, bounds))
    }

    /// Returns the minimum and maximum corner of a box that holds the mesh, in the mesh's own
    /// frame, or `None` for a mesh without faces.
    pub(crate) fn local_bounds(&self) -> Option<[[f64; 3]; 2]> {
        let root = self.0.tree.nodes().first()?;
        let frame = &self.0.frame;
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for lane in 0..root.count() {
            for k in 0..3 {
                let slack = 4.0 * UNIT_ROUNDOFF * (frame.origin[k].abs() + 2.0 * REACH / frame.scale);
                let at = |packed: f32| frame.origin[k] + f64::from(packed) / frame.scale;
                bounds[0][k] = bounds[0][k].min(at(root.min[k][lane]) - slack);
                bounds[1][k] = bounds[1][k].max(at(root.max[k][lane]) + slack);
            }
        }
        Some(bounds)
    }
}
