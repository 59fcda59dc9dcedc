//! A mesh and its moved copy, with their intersecting pairs.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use impinge::exact::{Corners, Placement, triangles_intersect};
use impinge::hierarchy::{BinaryTree, Counters, Enclosure, GenericTree, NodeVolume};
use impinge::math::RelativeMap;
use impinge::volume::Aabb;
use impinge::{Mesh, Pose, Positions, query};
use impinge_bench::scene::Surface;
use impinge_testkit::env_rob::data_folder;
use impinge_testkit::generate::knots::{TREFOIL, bumpy_sphere, stadium, torus_knot};

/// Names and files of real meshes, below the folder that `IMPINGE_DATA` names.
const REAL: [(&str, &str); 3] =
    [("human", "meshes/human_makehuman_cc0.ply"), ("bunny", "meshes/stanford-bunny.obj"), ("igea", "meshes/igea.ply")];

/// A mesh and its copy moved by `pose`.
pub(crate) struct Question {
    pub(crate) name: &'static str,
    triangles: Vec<Corners>,
    pub(crate) boxes: Vec<Aabb>,
    /// Box of each moved triangle, tight to within rounding.
    moved_boxes: Vec<Aabb>,
    pub(crate) pose: Pose,
    placement: Placement,
    /// Intersecting pairs (face, face of the copy) found by the library, sorted.
    pub(crate) pairs: Vec<[u32; 2]>,
}

impl Question {
    /// Returns the generated meshes and, if the data folder is set, the real ones.
    pub(crate) fn all() -> Result<Vec<Self>> {
        let turned = |angle, offset| Pose::from_axis_angle([1.0, 2.0, 3.0], angle, offset);
        let generated =
            |mesh: impinge_testkit::Mesh| Surface { positions: Positions::F64(mesh.vertices), faces: mesh.faces };
        let mut all = vec![
            Self::new("knots, deep", generated(torus_knot(400, 100, TREFOIL)), turned(0.7, [0.3, 0.2, 0.1])?)?,
            Self::new("near-coincident", generated(bumpy_sphere(50)), turned(0.01, [0.0; 3])?)?,
            Self::new("slivers", generated(stadium(200, 50, 100)), Pose::from_translation([0.0006, 0.0004, 0.0005])?)?,
        ];
        if let Some(folder) = data_folder() {
            for (name, file) in REAL {
                all.push(Self::of_file(name, &folder.join(file))?);
            }
        }
        Ok(all)
    }

    /// Returns a real mesh whose copy is rotated about the center of its box, and moved by 10 % of
    /// the box.
    fn of_file(name: &'static str, path: &Path) -> Result<Self> {
        let surface = Surface::load(path)?;
        let [low, high] = surface.bounds();
        let turn = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.5, [0.0; 3])?;
        let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
        let image = turn.apply(middle);
        let shift = std::array::from_fn(|axis| middle[axis] - image[axis] + 0.1 * (high[axis] - low[axis]));
        Self::new(name, surface, Pose::new(*turn.linear(), shift)?)
    }

    fn new(name: &'static str, surface: Surface, pose: Pose) -> Result<Self> {
        let mesh = Mesh::new(surface.positions, surface.faces).context(name)?;
        let pairs = query::intersecting_pairs(&mesh, mesh.at(pose));
        ensure!(!pairs.is_empty(), "{name}: the mesh does not meet itself, and so measures nothing");
        let triangles: Vec<Corners> = (0..mesh.faces().len() as u32).map(|face| mesh.corners(face)).collect();
        let map = RelativeMap::a_from_b(&Pose::IDENTITY, &pose);
        let moved = |corner: [f64; 3]| {
            let (image, error) = (map.apply(corner), map.image_error(corner.map(f64::abs)));
            Aabb {
                min: std::array::from_fn(|axis| ((image[axis] - error[axis]) as f32).next_down()),
                max: std::array::from_fn(|axis| ((image[axis] + error[axis]) as f32).next_up()),
            }
        };
        let rounded = |corners: &Corners| Aabb::of_points(corners.map(|p| p.map(|x| x as f32))).next_outward();
        Ok(Self {
            name,
            boxes: triangles.iter().map(rounded).collect(),
            moved_boxes: triangles.iter().map(|t| t.map(moved).into_iter().fold(Aabb::EMPTY, Aabb::union)).collect(),
            triangles,
            placement: Placement::new(&Pose::IDENTITY, &pose),
            pose,
            pairs,
        })
    }

    /// Returns the number of triangles of the mesh.
    pub(crate) fn size(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the corners of a triangle.
    pub(crate) fn corners(&self, face: u32) -> Corners {
        self.triangles[face as usize]
    }

    /// Returns a generic tree of the mesh.
    pub(crate) fn tree<V: NodeVolume, const DEGREE: usize>(
        &self,
        binary: &BinaryTree,
        enclosure: Enclosure,
    ) -> Result<GenericTree<V, DEGREE>> {
        let corners = |face: u32, points: &mut Vec<[f64; 3]>| points.extend(self.triangles[face as usize]);
        GenericTree::new(binary, corners, enclosure).context("a volume cannot be fitted")
    }

    /// Returns the pairs found with the tree, and its counted work. Pairs of triangles whose boxes
    /// are apart are not tested further.
    pub(crate) fn ask<V: NodeVolume, const DEGREE: usize>(
        &self,
        tree: &GenericTree<V, DEGREE>,
    ) -> (Vec<[u32; 2]>, Counters) {
        let mut found = Vec::new();
        let work = tree.pairs(tree, &self.pose, |a, b| {
            if self.meet(a, b) {
                found.push([a, b]);
            }
        });
        (found, work)
    }

    /// Reports whether triangle `a` intersects the moved triangle `b`, exactly. This is one
    /// primitive test.
    #[inline]
    pub(crate) fn meet(&self, a: u32, b: u32) -> bool {
        let (box_a, box_b) = (&self.boxes[a as usize], &self.moved_boxes[b as usize]);
        (0..3).all(|axis| box_a.min[axis] <= box_b.max[axis] && box_b.min[axis] <= box_a.max[axis])
            && triangles_intersect(&self.placement, &self.triangles[a as usize], &self.triangles[b as usize])
    }

    /// Compares an answer with the library's.
    pub(crate) fn check(&self, mut found: Vec<[u32; 2]>, who: &str) -> Result<()> {
        found.sort_unstable();
        let (count, expected) = (found.len(), self.pairs.len());
        ensure!(found == self.pairs, "{}, {who}: {count} pairs that are not the {expected} of the library", self.name);
        Ok(())
    }
}
