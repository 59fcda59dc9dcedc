//! The parts of space that are far from the border of an open mesh, which counts as closed there
//! (docs/notes/proof.md, L19a).
//!
//! Guarded by the test below and by `tests/it/solids/open.rs`.

use rayon::prelude::*;

use crate::mesh::derived::cap::{Cap, bounds_of};
use crate::mesh::{Mesh, PlacedMesh};
use crate::volume::{BoundingVolume, MinMax};

impl Mesh {
    /// Returns the boxes about the cap of the border. The first call computes them.
    ///
    /// # Complexity
    /// O(n log n) in the edges of the border the first time, then constant.
    pub(crate) fn cap(&self) -> &Cap {
        let border = &self.topology().border;
        self.0.derived.cap.get_or_init(|| Cap::of(self.positions(), border))
    }
}

impl PlacedMesh<'_> {
    /// Reports whether everything within reach of this mesh's border is proved to be apart from
    /// another mesh. This includes the other mesh's faces and everything within reach of its
    /// border. Both meshes are compared in the world frame. Returns `false` if a box is out of
    /// range.
    ///
    /// # Complexity
    /// Linear in the faces of the other mesh, times the boxes about loops that overlap the other
    /// mesh's box.
    pub(crate) fn has_border_clear_of(&self, other: &Self) -> bool {
        let [mine, others] = [self, other].map(|placed| placed.mesh.cap().within_reach(&placed.world_from_mesh));
        // Boxes out of range prove nothing.
        let (Ok(mut mine), Ok(others)) = (mine, others) else { return false };
        if mine.iter().any(|near| others.iter().any(|other| near.overlaps(other))) {
            return false;
        }
        let faces = 0..other.mesh.faces().len() as u32;
        let in_world = |bounds: Option<MinMax>| bounds.and_then(|bounds| bounds.moved(&other.world_from_mesh).ok());
        let corners = |face: u32| other.mesh.corners(face).into_iter();
        if let Some(whole) = in_world(bounds_of(faces.clone().flat_map(corners))) {
            mine.retain(|near| near.overlaps(&whole));
        }
        mine.is_empty()
            || faces.into_par_iter().all(|face| {
                in_world(bounds_of(corners(face))).is_some_and(|bounds| mine.iter().all(|near| !near.overlaps(&bounds)))
            })
    }
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;
    use crate::mesh::Positions;

    /// The cap of the unit cube's open top is a square of area 1, so the reach is √(1 / 2π).
    #[test]
    fn faces_are_far_from_a_hole_beyond_twice_its_reach() -> Result<(), Box<dyn Error>> {
        let corners: Vec<[f64; 3]> = (0_u32..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let sides: [[u32; 4]; 5] = [[0, 2, 3, 1], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let faces: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let bin = Mesh::new(Positions::F64(corners), faces)?;
        let twice_the_reach = 2.0 / std::f64::consts::TAU.sqrt();
        let below =
            |depth: f64| bin.cap().is_far_from(&[[0.0; 2], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| [x, y, 1.0 - depth]));
        assert!(below(twice_the_reach + 1e-6));
        assert!(!below(twice_the_reach - 1e-6));
        Ok(())
    }
}
