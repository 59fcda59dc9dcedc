//! The facts of a page that the report does not state: sentences, names of all parts, limits.

use std::io;

use impinge::clash::{Report, Side};
use impinge_files::{ReportAbout, Unit, length_text};
use serde::Serialize;

use super::curves::Curves;
use super::parts::Drawn;
use super::{MAX_CURVES, MAX_TRIANGLES};
use crate::bcf::PageBcf;
use crate::picture::Axis;

#[derive(Serialize)]
struct Facts<'f> {
    /// Axis that points up: `x`, `y` or `z`.
    up: &'static str,
    /// Length of the unit in meters, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    meters: Option<f64>,
    /// A sentence about each clash, and then about each set of duplicates.
    sentences: Vec<String>,
    scenes: Vec<SceneFacts<'f>>,
    /// Number of parts that are drawn as boxes.
    boxes: usize,
    /// Number of the worst clashes whose curves are drawn.
    curves: usize,
    max_triangles: usize,
    max_curves: usize,
    /// Largest distance between a corner and its drawn position, in world units.
    rounding: f64,
    /// The topics of a BCF file, if the unit is known: BCF is in meters.
    #[serde(skip_serializing_if = "Option::is_none")]
    bcf: Option<PageBcf>,
}

#[derive(Serialize)]
struct SceneFacts<'f> {
    label: &'f str,
    /// Name and type of each part.
    parts: Vec<[&'f str; 2]>,
}

/// Returns the facts as JSON.
///
/// # Errors
/// Returns an error if there is not enough memory.
pub(super) fn json(
    sides: &[Side<'_>],
    report: &Report,
    about: &ReportAbout<'_>,
    up: Axis,
    drawn: &Drawn,
    curves: &Curves,
) -> io::Result<Vec<u8>> {
    let length = |x: f64| length_text(x, about.unit);
    let of_clashes = report.clashes.iter().map(|clash| clash.sentence(&length));
    let of_sets = report.duplicates.iter().map(|set| set.sentence());
    let facts = Facts {
        up: up.name(),
        meters: about.unit.map(Unit::meters),
        sentences: of_clashes.chain(of_sets).collect(),
        scenes: sides.iter().map(SceneFacts::new).collect(),
        boxes: drawn.boxes(),
        curves: curves.clashes,
        max_triangles: MAX_TRIANGLES,
        max_curves: MAX_CURVES,
        rounding: drawn.error(),
        bcf: about.unit.map(|unit| PageBcf::new(report, about, unit)),
    };
    serde_json::to_vec(&facts).map_err(io::Error::other)
}

impl<'f> SceneFacts<'f> {
    fn new(Side { label, scene }: &'f Side<'_>) -> Self {
        let parts = scene.parts().map(|part| [scene.name(part), scene.details(part).kind.as_str()]);
        Self { label, parts: parts.collect() }
    }
}
