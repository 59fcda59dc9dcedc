//! What a mesh's hierarchy looks like from outside.

use rayon::prelude::*;

use super::Mesh;
use crate::hierarchy::TreeStatistics;

impl Mesh {
    /// What can be read off the hierarchy that queries descend.
    #[must_use]
    pub fn tree_statistics(&self) -> TreeStatistics {
        // Lanes of a leaf that are not in use repeat its first face.
        self.0.tree.statistics(|leaf| {
            let faces = &self.0.packets[leaf as usize].faces;
            1 + faces[1..].iter().filter(|&&face| face != faces[0]).count()
        })
    }

    /// The hierarchy's boxes at a level as (least, greatest) corners in the mesh's own frame, rounded to nearest: one box at
    /// level 0, those of its children at level 1, and so on; a leaf above the level stands for what would be below it.
    #[must_use]
    pub fn tree_level(&self, level: usize) -> Vec<[[f64; 3]; 2]> {
        let frame = &self.0.frame;
        let local = |corner: [f32; 3]| -> [f64; 3] {
            std::array::from_fn(|axis| f64::from(corner[axis]) / frame.scale + frame.origin[axis])
        };
        self.0.tree.level(level).par_iter().map(|bounds| [local(bounds.min), local(bounds.max)]).collect()
    }
}
