//! `impinge fit`: every bounding volume about one mesh, measured on the spot.

mod advice;
mod json;
mod measure;
mod report;

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use impinge::hierarchy::Builder;

use crate::body::{Body, Loaded, Reading};
use crate::failure::Failure;
use crate::progress::Phase;
use crate::{Verdict, console, repair};
use measure::{HullRow, Row};

/// Which bounding volume suits a mesh?
///
/// Every volume is fitted to the corners of the triangles and measured here and now: its size beside that of their convex
/// hull, the time to build it, its bytes, the time of one overlap test and the time to follow a rotation. Times are of one thread.
///
/// Exit code: 0 where there is an answer, 2 where there is none.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF or COLLADA, also as .gz
    mesh: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Print one JSON object in place of the report
    #[arg(long)]
    json: bool,
}

/// Everything that there is to tell.
struct Outcome {
    body: Body,
    /// How many different vertices the faces use.
    points: usize,
    hull: HullRow,
    rows: Vec<Row>,
    seconds: Seconds,
}

/// How long each phase took.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
struct Seconds {
    load: f64,
    measure: f64,
}

/// Measures and prints.
///
/// # Errors
/// Where there is no mesh, or none with a triangle.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let start = Instant::now();
    let phase = Phase::begin("loading");
    let loaded = Loaded::from_file(&arguments.mesh, None, arguments.reading)?;
    loaded.warn();
    let body = loaded.build(Builder::default(), &repair::Arguments::default())?;
    drop(phase);
    let load = start.elapsed().as_secs_f64();
    let points = corners(&body);
    if points.is_empty() {
        return Err(
            Failure::new("empty", "the mesh has no triangles, so there is nothing to bound").in_file(&arguments.mesh)
        );
    }
    let start = Instant::now();
    let phase = Phase::begin("measuring volumes");
    let measured = measure::hull(&points).and_then(|hull| Ok((hull, measure::rows(&points)?)));
    let (hull, rows) = measured.map_err(|error| Failure::from_input(&error).in_file(&arguments.mesh))?;
    drop(phase);
    let seconds = Seconds { load, measure: start.elapsed().as_secs_f64() };
    let outcome = Outcome { body, points: points.len(), hull, rows, seconds };
    console::conclude(&if arguments.json { json::object(&outcome) } else { report::text(&outcome) })?;
    Ok(Verdict::Clear)
}

/// The vertices that some face uses, each once.
fn corners(body: &Body) -> Vec<[f64; 3]> {
    let positions = body.mesh.positions();
    let mut used = vec![false; positions.len()];
    body.mesh.faces().iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    (0..positions.len()).filter(|&vertex| used[vertex]).map(|vertex| positions.get(vertex)).collect()
}
