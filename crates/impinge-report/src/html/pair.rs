//! A page about two meshes: where they intersect, or where they are nearest.

use std::io::{self, Write};

use impinge::mesh::PlacedMesh;
use serde::Serialize;

use super::about::{PageAbout, json};
use super::curves::Curves;
use super::parts::Drawn;
use super::{MAX_TRIANGLES, geometry, write_page};

/// Two meshes, and the facts that are known about them.
#[derive(Clone, Debug)]
pub struct PairPage<'p> {
    /// Names of the meshes.
    pub names: [String; 2],
    /// The meshes in their places.
    pub meshes: [PlacedMesh<'p>; 2],
    /// Pairs of intersecting faces.
    pub pairs: &'p [[u32; 2]],
    /// The curves in which the meshes intersect.
    pub curves: &'p [Vec<[f64; 3]>],
    /// Nearest points of meshes that do not intersect.
    pub nearest: Option<[[f64; 3]; 2]>,
}

#[derive(Serialize)]
struct Content {
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest: Option<[[f64; 3]; 2]>,
    /// Whether the intersecting faces are drawn. There may be too many of them.
    has_faces: bool,
    /// Whether the curves are drawn. They may have too many points.
    has_curves: bool,
}

/// Writes a page that shows two meshes, their intersecting faces, the curves in which they
/// intersect, and the line between their nearest points.
///
/// A mesh is drawn as its box if both together have more triangles than a page holds. The same
/// input gives the same bytes.
///
/// # Errors
/// Returns the errors of the output.
pub fn write_pair_page(out: &mut dyn Write, pair: &PairPage<'_>, about: &PageAbout<'_>) -> io::Result<()> {
    let things = pair.meshes.map(|placed| (placed.mesh.clone(), placed.world_from_mesh));
    let mut drawn = Drawn::of(&things, MAX_TRIANGLES);
    let hits = [0, 1].map(|side| {
        let mut faces: Vec<u32> = pair.pairs.iter().map(|pair| pair[side]).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    });
    let has_faces = hits.iter().map(Vec::len).sum::<usize>() <= MAX_TRIANGLES;
    for ((mesh, pose), faces) in things.iter().zip(&hits) {
        let shown = if has_faces { &faces[..] } else { &[] };
        drawn.push_faces(mesh, *pose, shown.iter().map(|&face| mesh.faces()[face as usize]));
    }
    let curves = Curves::of_pair(pair.curves);
    let has_curves = curves.clashes > 0 || pair.curves.is_empty();
    let content = Content { kind: "pair", nearest: pair.nearest, has_faces, has_curves };
    let parts = pair.names.clone().map(|name| [name, String::new()]);
    let view = json(about, &parts, &drawn, content)?;
    write_page(out, &[("answer", &view), ("geometry", &geometry::bytes(&drawn, &curves))])
}
