//! The answer for a program: one object of schema `impinge.check/1`. What was not asked is absent.

use impinge::query::Curves;
use serde::Serialize;

use super::{Outcome, Seconds};
use crate::console;
use crate::pose::rows;

#[derive(Serialize)]
struct Object {
    schema: &'static str,
    version: &'static str,
    a: Side,
    b: Side,
    intersects: bool,
    pairs: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<CurveSummary>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Side {
    path: String,
    triangles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    /// From the file's own numbers to the common frame, in the finer of the two units.
    pose: [[f64; 4]; 4],
}

#[derive(Serialize)]
struct CurveSummary {
    count: usize,
    closed: usize,
    length: f64,
}

/// The object, as one line.
pub(super) fn object(outcome: &Outcome) -> String {
    let side = |side: usize| {
        let body = &outcome.bodies[side];
        Side {
            path: body.about.path.display().to_string(),
            triangles: body.mesh.faces().len(),
            unit: body.about.unit.map(|unit| unit.symbol()),
            pose: rows(&outcome.poses[side]),
        }
    };
    console::to_line(&Object {
        schema: "impinge.check/1",
        version: env!("CARGO_PKG_VERSION"),
        a: side(0),
        b: side(1),
        intersects: !outcome.pairs.is_empty(),
        pairs: outcome.pairs.len(),
        curves: outcome.curves.as_ref().map(summary),
        seconds: outcome.seconds,
    })
}

fn summary(curves: &Curves) -> CurveSummary {
    CurveSummary { count: curves.polylines.len(), closed: curves.closed(), length: curves.length() }
}
