//! Splits the triangles of a file by their parts: each part with a mesh of its own.

use impinge::{Pose, Positions};

use crate::{
    error::LoadError,
    instance::Affine,
    model::{Model, Warnings},
    scene_draft::{Draft, PartDraft},
    scene_frame::SceneFrame,
    scene_model::SceneMesh,
};

/// Returns the parts of a model. Each has a mesh in the frame of the scene, with the vertices that
/// it uses in the order of the file.
///
/// # Errors
/// Returns an error if a coordinate is too large for a mesh.
///
/// # Complexity
/// O(n log n) in the number of triangles, and linear in the number of vertices.
pub(super) fn by_part(model: Model, frame: SceneFrame) -> Result<Draft, LoadError> {
    let positions = if frame.is_that_of_the_file() {
        frame.in_own_frame(model.positions)?
    } else {
        frame.in_scene(&model.positions, &Affine::IDENTITY)?
    };
    let mut of_part: Vec<Vec<u32>> = vec![Vec::new(); model.parts.len()];
    for (face, &part) in (0_u32..).zip(&model.part_of) {
        of_part[part as usize].push(face);
    }
    // The index in the current part of each vertex that the part uses.
    let mut local = vec![0_u32; positions.len()];
    let mesh = |faces: &Vec<u32>| {
        let corners = || faces.iter().flat_map(|&face| model.faces[face as usize]);
        let mut used: Vec<u32> = corners().collect();
        used.sort_unstable();
        used.dedup();
        for (at, &vertex) in (0_u32..).zip(&used) {
            local[vertex as usize] = at;
        }
        SceneMesh {
            positions: chosen(&positions, &used),
            faces: faces.iter().map(|&face| model.faces[face as usize].map(|corner| local[corner as usize])).collect(),
            sources: faces.iter().map(|&face| model.sources[face as usize]).collect(),
        }
    };
    let meshes = of_part.iter().map(mesh).collect();
    let part = |(mesh, title)| PartDraft {
        title,
        path: Vec::new(),
        extras: Vec::new(),
        mesh,
        world_from_part: Pose::IDENTITY,
    };
    let parts = model.parts.into_iter().enumerate().map(part).collect();
    let mut warnings = Warnings::default();
    warnings.extend(model.warnings);
    Ok(Draft { meshes, parts, unit: frame.unit, warnings })
}

/// Returns some of the positions.
fn chosen(positions: &Positions, vertices: &[u32]) -> Positions {
    match positions {
        Positions::F32(rows) => Positions::F32(vertices.iter().map(|&at| rows[at as usize]).collect()),
        Positions::F64(rows) => Positions::F64(vertices.iter().map(|&at| rows[at as usize]).collect()),
    }
}
