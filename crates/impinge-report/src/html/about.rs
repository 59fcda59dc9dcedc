//! The facts of a page about something other than clashes.

use std::io;

use impinge_files::Unit;
use serde::Serialize;

use super::MAX_TRIANGLES;
use super::parts::Drawn;
use crate::picture::Axis;

/// The words of a page, and the frame of its view.
#[derive(Clone, Debug)]
pub struct PageAbout<'p> {
    /// Title: the names of the files.
    pub title: String,
    /// The answer in one sentence.
    pub heading: String,
    /// Names and values, as the report of the command states them.
    pub rows: Vec<[String; 2]>,
    /// Unit of all lengths, if it is known.
    pub unit: Option<Unit>,
    /// The axis that points up.
    pub up: Axis,
    /// Version of the program.
    pub version: &'p str,
}

#[derive(Serialize)]
struct Facts<'f, C> {
    title: &'f str,
    heading: &'f str,
    rows: &'f [[String; 2]],
    version: &'f str,
    up: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    /// Length of the unit in meters.
    #[serde(skip_serializing_if = "Option::is_none")]
    meters: Option<f64>,
    /// Name and type of each part that is drawn.
    parts: &'f [[String; 2]],
    /// Number of parts that are drawn as boxes.
    boxes: usize,
    max_triangles: usize,
    /// Largest distance between a corner and its drawn position, in world units.
    rounding: f64,
    #[serde(flatten)]
    content: C,
}

/// Returns the facts as JSON. `content` has the kind of the page and the facts of that kind.
///
/// # Errors
/// Returns an error if there is not enough memory.
pub(super) fn json(
    about: &PageAbout<'_>,
    parts: &[[String; 2]],
    drawn: &Drawn,
    content: impl Serialize,
) -> io::Result<Vec<u8>> {
    let PageAbout { title, heading, rows, unit, up, version } = about;
    let facts = Facts {
        title,
        heading,
        rows,
        version,
        up: up.name(),
        unit: unit.map(Unit::symbol),
        meters: unit.map(Unit::meters),
        parts,
        boxes: drawn.boxes(),
        max_triangles: MAX_TRIANGLES,
        rounding: drawn.error(),
        content,
    };
    serde_json::to_vec(&facts).map_err(io::Error::other)
}
