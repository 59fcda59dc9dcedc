//! The shape of a mesh's hierarchy.

use rayon::prelude::*;

use crate::hierarchy::TreeStatistics;
use crate::mesh::Mesh;

impl Mesh {
    /// Returns statistics of the hierarchy that queries descend.
    #[must_use]
    pub fn tree_statistics(&self) -> TreeStatistics {
        self.0.tree.statistics(|leaf| self.leaf(leaf).count())
    }

    /// Returns the hierarchy's boxes at a level as (minimum, maximum) corners in the mesh's own
    /// frame, rounded to nearest. Level 0 has one box, level 1 has the boxes of its children, and
    /// so on. A leaf above the level is included instead of the missing boxes below it. Returns no
    /// boxes for a mesh without faces.
    #[must_use]
    pub fn tree_level(&self, level: usize) -> Vec<[[f64; 3]; 2]> {
        let frame = &self.0.frame;
        let local = |corner: [f32; 3]| -> [f64; 3] {
            std::array::from_fn(|axis| f64::from(corner[axis]) / frame.scale + frame.origin[axis])
        };
        self.0.tree.level(level).par_iter().map(|bounds| [local(bounds.min), local(bounds.max)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Builder;
    use crate::math::Pose;
    use crate::mesh::Positions;
    use crate::query::{intersecting_pairs, intersects};
    use impinge_testkit::generate::Rng;
    use impinge_testkit::generate::knots::{TREFOIL, stadium, torus_knot};
    use impinge_testkit::generate::solids::grid_soup;

    #[test]
    fn no_builder_changes_an_answer() {
        let soup = grid_soup(&mut Rng::new(3), 700, 9, 3);
        for (name, mesh, offset) in [
            ("soup", &soup, [1.0, 0.0, -1.0]),
            ("slivers", &stadium(60, 15, 40), [0.0006, 0.0004, 0.0005]),
            ("knot", &torus_knot(100, 25, TREFOIL), [0.3, 0.2, 0.1]),
        ] {
            let pose = Pose::from_translation(offset).expect("a valid pose");
            let built = Builder::ALL.map(|builder| {
                let positions = Positions::F64(mesh.vertices.clone());
                Mesh::with_builder(positions, mesh.faces.clone(), builder).expect("a valid mesh")
            });
            let expected = intersecting_pairs(&built[0], built[0].at(pose));
            assert!(expected.len() > 50, "{name}: {}", expected.len());
            for (a, builder_a) in built.iter().zip(Builder::ALL) {
                for (b, builder_b) in built.iter().zip(Builder::ALL) {
                    let names = (name, builder_a.name(), builder_b.name());
                    assert_eq!(intersecting_pairs(a, b.at(pose)), expected, "{names:?}");
                    assert!(intersects(a, b.at(pose)), "{names:?}");
                }
            }
        }
    }

    #[test]
    fn the_boxes_of_a_level_hold_the_mesh() {
        let knot = torus_knot(100, 25, TREFOIL);
        let mesh = Mesh::new(Positions::F64(knot.vertices.clone()), knot.faces).expect("a valid mesh");
        let statistics = mesh.tree_statistics();
        assert!(statistics.leaves >= 5_000 / 8 && statistics.leaf_fill > 0.9 && statistics.sah > 1.0, "{statistics:?}");
        let holds = |[min, max]: &[[f64; 3]; 2], p: &[f64; 3]| (0..3).all(|k| min[k] <= p[k] && p[k] <= max[k]);
        for level in [0, 2, statistics.depth] {
            let boxes = mesh.tree_level(level);
            assert!(
                boxes.len() > 8 * level && (level > 0 || boxes.len() == 1),
                "{} boxes of level {level}",
                boxes.len()
            );
            assert!(knot.vertices.iter().all(|p| boxes.iter().any(|bounds| holds(bounds, p))), "level {level}");
        }
    }
}
