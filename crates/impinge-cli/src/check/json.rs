//! The answer for a program: one object of schema `impinge.check/1`. What was not asked is absent.

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
    /// True where it is undecided too.
    #[serde(skip_serializing_if = "Option::is_none")]
    penetrates: Option<bool>,
    /// Which answers count as true without proof.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    undecided: Vec<&'static str>,
    /// Which meshes are open, though their inside was asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    open: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<CurveSummary>,
    /// Absent where it is infinite: a mesh has no faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<Apart>,
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
    /// From the file's own numbers to the common frame, in the finer of the two units.
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
struct Apart {
    distance: f64,
    lower: f64,
    upper: f64,
    /// Absent where one lies inside the other.
    #[serde(flatten)]
    nearest: Option<Nearest>,
}

#[derive(Serialize)]
struct Nearest {
    /// In the common frame and unit.
    point_a: [f64; 3],
    point_b: [f64; 3],
    face_a: u32,
    face_b: u32,
}

#[derive(Serialize)]
struct ClearanceSummary {
    required: f64,
    within: bool,
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
            repair: body.repair.clone(),
            warnings: body.warnings.clone(),
        }
    };
    let undecided = named(
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
        open: named(&["a", "b"], &outcome.open()),
        curves: outcome.curves.as_ref().map(summary),
        distance: outcome.distance.as_ref().and_then(apart),
        clearance: outcome
            .clearance
            .map(|clearance| ClearanceSummary { required: clearance.required, within: clearance.is_violated }),
        seconds: outcome.seconds,
    })
}

/// What is finite: nothing is near an empty mesh.
fn apart(distance: &Distance) -> Option<Apart> {
    let Distance { lower, upper, witness, .. } = *distance;
    let nearest = witness.and_then(|Witness { point_a, point_b, faces }| {
        faces.map(|[face_a, face_b]| Nearest { point_a, point_b, face_a, face_b })
    });
    upper.is_finite().then_some(Apart { distance: distance.distance(), lower, upper, nearest })
}

/// The names of what holds.
fn named(names: &[&'static str], hold: &[bool]) -> Vec<&'static str> {
    names.iter().zip(hold).filter_map(|(&name, &holds)| holds.then_some(name)).collect()
}

fn summary(curves: &Curves) -> CurveSummary {
    CurveSummary { count: curves.polylines.len(), closed: curves.closed(), length: curves.length() }
}
