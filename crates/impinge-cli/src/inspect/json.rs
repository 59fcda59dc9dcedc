//! The JSON answer: one object of schema `impinge.inspect/1`. Values that are not known are absent.

use serde::Serialize;

use super::proxies::Summary;
use super::{Drawn, Inspection, Seconds};
use crate::{console, repair};

#[derive(Serialize)]
struct Object<'a> {
    schema: &'static str,
    version: &'static str,
    path: String,
    triangles: usize,
    vertices: usize,
    parts: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    hierarchy: Hierarchy,
    health: Health,
    #[serde(skip_serializing_if = "Option::is_none")]
    proxies: Option<&'a Summary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<&'a Drawn>,
    #[serde(skip_serializing_if = "Option::is_none")]
    repair: Option<&'a repair::Summary>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    warnings: &'a [String],
    seconds: Seconds,
}

#[derive(Serialize)]
struct Hierarchy {
    nodes: usize,
    leaves: usize,
    depth: usize,
    sah: f64,
    overlap: f64,
    node_fill: f64,
    leaf_fill: f64,
    node_bytes: usize,
    /// Memory of the mesh and its hierarchy, in bytes.
    bytes: usize,
}

#[derive(Serialize)]
struct Health {
    closed: bool,
    components: usize,
    degenerate_faces: usize,
    duplicate_faces: usize,
    duplicate_vertices: usize,
    unused_vertices: usize,
    open_edges: usize,
    non_manifold_edges: usize,
    misoriented_edges: usize,
    /// Welding tolerance that closes open edges; absent if welding closes nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    closing_tolerance: Option<f64>,
    double_coordinates: usize,
}

/// Returns the JSON object as one line.
pub(super) fn object(inspection: &Inspection) -> String {
    let Inspection { body, tree, health, proxies, drawn, seconds, .. } = inspection;
    console::to_line(&Object {
        schema: "impinge.inspect/1",
        version: env!("CARGO_PKG_VERSION"),
        path: body.about.path.display().to_string(),
        triangles: body.mesh.faces().len(),
        vertices: body.mesh.positions().len(),
        parts: body.about.parts.len(),
        unit: body.about.unit.map(|unit| unit.symbol()),
        hierarchy: Hierarchy {
            nodes: tree.inner,
            leaves: tree.leaves,
            depth: tree.depth,
            sah: tree.sah,
            overlap: tree.overlap,
            node_fill: tree.node_fill,
            leaf_fill: tree.leaf_fill,
            node_bytes: tree.bytes,
            bytes: body.mesh.memory(),
        },
        health: Health {
            closed: body.mesh.is_closed(),
            components: health.components,
            degenerate_faces: health.degenerate_faces,
            duplicate_faces: health.duplicate_faces,
            duplicate_vertices: health.duplicate_vertices,
            unused_vertices: health.unused_vertices,
            open_edges: health.open_edges,
            non_manifold_edges: health.non_manifold_edges,
            misoriented_edges: health.misoriented_edges,
            closing_tolerance: body.mesh.closing_tolerance(),
            double_coordinates: health.double_coordinates,
        },
        proxies: proxies.as_ref(),
        picture: drawn.as_ref(),
        repair: body.repair.as_ref(),
        warnings: &body.warnings,
        seconds: *seconds,
    })
}
