//! The JSON answer: one object of schema `impinge.check/1`. Answers that were not requested are
//! absent.

use impinge::query::{Contained, Curves, Distance, Penetrates, Witness};
use serde::Serialize;

use super::{Outcome, Seconds};
use crate::pose::rows;
use crate::{console, repair};

#[derive(Serialize)]
struct Object {
    schema: &'static str,
    version: &'static str,
    a: Side,
    b: Side,
    intersects: bool,
    pairs: usize,
    /// "a", "b" or "both".
    #[serde(skip_serializing_if = "Option::is_none")]
    contained: Option<&'static str>,
    /// Whether the solids penetrate each other; also `true` if that is undecided.
    #[serde(skip_serializing_if = "Option::is_none")]
    penetrates: Option<bool>,
    /// Names of the answers that are reported as true although they are undecided.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    undecided: Vec<&'static str>,
    /// Names of the meshes that are not closed although a question about their inside was asked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    open: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<CurveSummary>,
    /// Absent if the distance is infinite because a mesh has no faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<DistanceSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<ClearanceSummary>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Side {
    path: String,
    triangles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    /// Maps the coordinates in the file to the common frame, in the finer of the two units.
    pose: [[f64; 4]; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    repair: Option<repair::Summary>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct CurveSummary {
    count: usize,
    closed: usize,
    length: f64,
}

#[derive(Serialize)]
struct DistanceSummary {
    distance: f64,
    lower: f64,
    upper: f64,
    /// Absent if one mesh lies inside the other.
    #[serde(flatten)]
    nearest: Option<Nearest>,
}

#[derive(Serialize)]
struct Nearest {
    /// Nearest point of mesh A, in the common frame and unit.
    point_a: [f64; 3],
    /// Nearest point of mesh B, in the common frame and unit.
    point_b: [f64; 3],
    face_a: u32,
    face_b: u32,
}

#[derive(Serialize)]
struct ClearanceSummary {
    required: f64,
    within: bool,
}

/// Returns the JSON object as one line.
pub(super) fn object(outcome: &Outcome) -> String {
    let side = |side: usize| {
        let body = &outcome.bodies[side];
        Side {
            path: body.about.path.display().to_string(),
            triangles: body.mesh.faces().len(),
            unit: body.about.unit.map(|unit| unit.symbol()),
            pose: rows(&outcome.poses[side]),
            repair: body.repair.clone(),
            warnings: body.warnings.clone(),
        }
    };
    let undecided = names_that_hold(
        &["contained", "penetrates"],
        &[outcome.solid.is_some_and(|solid| solid.undecided), outcome.penetrates == Some(Penetrates::Undecided)],
    );
    console::to_line(&Object {
        schema: "impinge.check/1",
        version: env!("CARGO_PKG_VERSION"),
        a: side(0),
        b: side(1),
        intersects: outcome.intersects(),
        pairs: outcome.pairs.len(),
        contained: outcome.solid.and_then(|solid| solid.contained).map(|contained| match contained {
            Contained::A => "a",
            Contained::B => "b",
            Contained::Both => "both",
        }),
        penetrates: outcome.penetrates.map(Penetrates::possibly),
        undecided,
        open: names_that_hold(&["a", "b"], &outcome.open()),
        curves: outcome.curves.as_ref().map(summary),
        distance: outcome.distance.as_ref().and_then(distance_summary),
        clearance: outcome
            .clearance
            .map(|clearance| ClearanceSummary { required: clearance.required, within: clearance.is_violated }),
        seconds: outcome.seconds,
    })
}

/// Returns the distance and the nearest points; `None` if the distance is infinite because a mesh
/// is empty.
fn distance_summary(distance: &Distance) -> Option<DistanceSummary> {
    let Distance { lower, upper, witness, .. } = *distance;
    let nearest = witness.and_then(|Witness { point_a, point_b, faces }| {
        faces.map(|[face_a, face_b]| Nearest { point_a, point_b, face_a, face_b })
    });
    upper.is_finite().then_some(DistanceSummary { distance: distance.distance(), lower, upper, nearest })
}

/// Returns the names whose flag in `hold` is set.
fn names_that_hold(names: &[&'static str], hold: &[bool]) -> Vec<&'static str> {
    names.iter().zip(hold).filter_map(|(&name, &holds)| holds.then_some(name)).collect()
}

fn summary(curves: &Curves) -> CurveSummary {
    CurveSummary { count: curves.polylines.len(), closed: curves.closed(), length: curves.length() }
}
