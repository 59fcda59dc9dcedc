//! A scene for the tests of packets: a few triangles of any size in a mesh of size one.

use impinge_testkit::generate::Rng;

use crate::hierarchy::Builder;
use crate::mesh::{Mesh, Positions};

/// Eight small triangles, faces 0 to 7, with a packet of their own. Face 8 has no area, and keeps
/// the frame of the mesh at size one.
pub(super) struct SmallTriangles {
    pub(super) size: f64,
    pub(super) center: [f64; 3],
    /// Corners of the mesh: 24 of the small triangles, on a coarse grid, so that many triangles are
    /// needles, edge-on or without area. Two more for the last face.
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) mesh: Mesh,
}

impl SmallTriangles {
    /// Returns triangles of one of 30 sizes, by the number of the round.
    pub(super) fn random(rng: &mut Rng, round: i32) -> Self {
        let size = 2.0_f64.powi(-(round % 30));
        let center = [0; 3].map(|_| rng.uniform(-1.0, 1.0));
        let mut vertices: Vec<[f64; 3]> =
            (0..24).map(|_| center.map(|x| x + size * rng.integer(-4, 4) as f64 / 4.0)).collect();
        vertices.extend([[-1.0; 3], [1.0; 3]]);
        let faces: Vec<[u32; 3]> = (0..8).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).chain([[24, 25, 25]]).collect();
        let positions = Positions::F64(vertices.clone());
        let mesh = Mesh::with_builder(positions, faces, Builder::Morton).expect("a valid mesh");
        Self { size, center, vertices, mesh }
    }
}
