//! Repairs the open parts of a scene.

use std::collections::HashMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::parts::{PartId, Scene};
use crate::mesh::{Mesh, Repair, RepairOptions};

/// An open part that [`Scene::repair`] changed.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairedPart {
    /// The part.
    pub part: PartId,
    /// Whether the part is closed now.
    pub is_closed: bool,
    /// The changes of its mesh. Parts with the same mesh share them.
    pub repair: Arc<Repair>,
}

impl Scene {
    /// Repairs the mesh of each open part with the options [`RepairOptions::closing`]: turns faces,
    /// and welds vertices that are almost in one place. Returns the parts that changed, in their
    /// order. Parts that are closed stay as they are.
    ///
    /// The inside of a closed part is certain, so answers about it are proved, and they take less
    /// time. Many files from modeling programs have solids of which some faces are turned.
    ///
    /// ```
    /// use impinge::scene::Scene;
    /// use impinge::{Mesh, Pose, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 2, 3]]; // the third is turned
    /// let mut scene = Scene::new();
    /// let part = scene.add("tip", Mesh::new(Positions::F32(corners), faces)?.solid(), Pose::IDENTITY)?;
    /// let repaired = scene.repair();
    /// assert_eq!((repaired[0].part, &repaired[0].repair.turned_faces[..]), (part, &[2][..]));
    /// assert!(repaired[0].is_closed);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Complexity
    /// That of [`Mesh::repaired`] for each open mesh, however many parts share it. The work is
    /// shared among all threads of the current rayon pool.
    pub fn repair(&mut self) -> Vec<RepairedPart> {
        let meshes = self.parts().filter_map(|part| self.shape(part).as_mesh());
        let meshes: HashMap<usize, &Mesh> = meshes.map(|(mesh, _)| (key(mesh), mesh)).collect();
        let improve = |(&key, mesh): (&usize, &&Mesh)| Some((key, repaired(mesh)?));
        let better: HashMap<usize, (Mesh, Arc<Repair>)> = meshes.par_iter().filter_map(improve).collect();
        let mut changed = Vec::new();
        for (part, shape) in self.shapes_mut() {
            let Some((mesh, is_solid)) = shape.as_mesh() else { continue };
            let Some((mesh, repair)) = better.get(&key(mesh)) else { continue };
            *shape = if is_solid { mesh.solid().into() } else { mesh.into() };
            changed.push(RepairedPart { part, is_closed: mesh.is_closed(), repair: Arc::clone(repair) });
        }
        changed
    }
}

/// Returns an open mesh repaired, and the changes, or `None` if the mesh is closed or needs none.
fn repaired(mesh: &Mesh) -> Option<(Mesh, Arc<Repair>)> {
    if mesh.is_closed() {
        return None;
    }
    let (better, repair) = mesh.repaired(RepairOptions::closing(mesh)).ok()?;
    let is_changed = !repair.turned_faces.is_empty() || !repair.welded_vertices.is_empty();
    is_changed.then(|| (better, Arc::new(repair)))
}

/// Returns a number that two meshes have in common if they share their faces.
fn key(mesh: &Mesh) -> usize {
    mesh.faces().as_ptr().addr()
}
