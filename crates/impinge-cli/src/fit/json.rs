//! The JSON answer: one object of schema `impinge.fit/1`. Values that are not known are absent.

use std::collections::BTreeMap;

use serde::Serialize;

use super::advice::advice;
use super::{Outcome, Seconds};
use crate::console;

#[derive(Serialize)]
struct Object {
    schema: &'static str,
    version: &'static str,
    mesh: MeshSummary,
    hull: HullSummary,
    volumes: Vec<Volume>,
    advice: BTreeMap<&'static str, Advised>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct MeshSummary {
    path: String,
    triangles: usize,
    corners: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
}

#[derive(Serialize)]
struct HullSummary {
    vertices: usize,
    bytes: usize,
    volume: f64,
    surface_area: f64,
    build_seconds: f64,
    overlap_seconds: f64,
    follow_seconds: f64,
}

#[derive(Serialize)]
struct Volume {
    name: &'static str,
    bytes: usize,
    volume: f64,
    /// Volume divided by the volume of the hull; absent if the hull is flat.
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_volume: Option<f64>,
    surface_area: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    build_seconds: f64,
    overlap_seconds: f64,
    follow_seconds: f64,
}

#[derive(Serialize)]
struct Advised {
    volume: &'static str,
    sentence: String,
}

/// Returns the JSON object as one line.
pub(super) fn object(outcome: &Outcome) -> String {
    let about = &outcome.body.about;
    let hull = &outcome.hull;
    let volumes = outcome.rows.iter().map(|row| Volume {
        name: row.name,
        bytes: row.bytes,
        volume: row.volume,
        relative_volume: (hull.volume > 0.0).then(|| row.volume / hull.volume),
        surface_area: row.surface_area,
        radius: row.radius,
        build_seconds: row.build,
        overlap_seconds: row.overlap,
        follow_seconds: row.follow,
    });
    let advised = advice(hull, &outcome.rows).into_iter();
    console::to_line(&Object {
        schema: "impinge.fit/1",
        version: env!("CARGO_PKG_VERSION"),
        mesh: MeshSummary {
            path: about.path.display().to_string(),
            triangles: outcome.body.mesh.faces().len(),
            corners: outcome.points,
            unit: about.unit.map(|unit| unit.symbol()),
        },
        hull: HullSummary {
            vertices: hull.vertices,
            bytes: hull.bytes,
            volume: hull.volume,
            surface_area: hull.surface_area,
            build_seconds: hull.build,
            overlap_seconds: hull.overlap,
            follow_seconds: hull.follow,
        },
        volumes: volumes.collect(),
        advice: advised.map(|a| (a.key, Advised { volume: a.name, sentence: a.sentence })).collect(),
        seconds: outcome.seconds,
    })
}
