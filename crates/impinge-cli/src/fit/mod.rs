//! `impinge fit`: fits and measures every kind of bounding volume for one mesh.

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

/// Compare bounding volumes for a mesh
///
/// Fits every kind of bounding volume to the corners of the triangles and measures it on this
/// machine: size relative to the convex hull, bytes, and the times to build it, to test two of them
/// for overlap and to follow a rotation. All times are for one thread.
///
/// Exit code: 0 if there is an answer, 2 if not.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or a baked file, optionally compressed
    /// as .gz
    mesh: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
}

/// All measurements.
struct Outcome {
    body: Body,
    /// Number of vertices that the faces use.
    points: usize,
    hull: HullRow,
    rows: Vec<Row>,
    seconds: Seconds,
}

/// Duration of each phase, in seconds.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
struct Seconds {
    load: f64,
    measure: f64,
}

/// Measures the volumes and prints the answer.
///
/// # Errors
/// Returns an error if the mesh cannot be read or has no triangles.
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
    console::print_answer(&if arguments.json { json::object(&outcome) } else { report::text(&outcome) })?;
    Ok(Verdict::Clear)
}

/// Returns the vertices that at least one face uses, each once.
fn corners(body: &Body) -> Vec<[f64; 3]> {
    let positions = body.mesh.positions();
    let mut used = vec![false; positions.len()];
    body.mesh.faces().iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    (0..positions.len()).filter(|&vertex| used[vertex]).map(|vertex| positions.get(vertex)).collect()
}
