//! `impinge decompose`: divides the solid of a closed mesh into convex parts, and writes their
//! hulls.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use impinge::hierarchy::Builder;
use impinge::hull::Hull;
use impinge::mesh::{ConvexParts, DecompositionOptions};
use impinge::{Budget, InputErrorKind, Mesh};
use impinge_files::{ObjPart, Unit, write_obj};
use serde::Serialize;

use crate::body::{Body, Loaded, Reading};
use crate::check::timed;
use crate::failure::Failure;
use crate::numerals::{counted, length, time};
use crate::{Verdict, console, output, repair};

/// Divide a closed mesh into convex parts, and write their hulls
///
/// The hulls together contain the solid: each of its points is in a hull. The report has a proved
/// bound: no point of a hull is farther than that from the solid. It is at most --concavity, unless
/// --max-hulls is reached first. The same mesh gives the same hulls on every machine.
///
/// Exit code: 0 if the hulls were written, 2 if the mesh cannot be read or is not closed, or if a
/// file cannot be written.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or a baked file, optionally compressed
    /// as .gz
    mesh: PathBuf,
    /// The file to write, whose name ends in .obj, or a folder
    ///
    /// A file has an object for each hull: part_0, part_1, and so on. A folder gets a file for each
    /// hull: part_0.obj, part_1.obj, and so on. A folder must be empty, and is created if it does
    /// not exist.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Maximum distance that a hull may reach outside the solid, in the unit of the file. Default:
    /// 1/40 of the largest extent of the mesh
    #[arg(long, value_name = "D", value_parser = parse_concavity, allow_hyphen_values = true)]
    concavity: Option<f64>,
    /// Maximum number of hulls, from 1 to 16384
    #[arg(long, value_name = "N", default_value_t = DecompositionOptions::default().max_parts, value_parser = parse_max_hulls)]
    max_hulls: usize,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    repairs: repair::Arguments,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
}

fn parse_concavity(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length >= 0.0 && length.is_finite() => Ok(length),
        _ => Err("a length is a finite number of at least 0".to_owned()),
    }
}

fn parse_max_hulls(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number @ 1..=16384) => Ok(number),
        _ => Err("a number of hulls is from 1 to 16384".to_owned()),
    }
}

/// JSON report of schema `impinge.decompose/1`.
#[derive(Serialize)]
struct Report {
    schema: &'static str,
    version: &'static str,
    path: String,
    triangles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<String>,
    output: String,
    /// Proved bound: no point of a hull is farther from the solid, in the unit of the mesh.
    concavity: f64,
    /// Whether the bound is at most the concavity that was asked for.
    is_within: bool,
    hulls: Vec<HullReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    repair: Option<repair::Summary>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    seconds: Seconds,
}

/// One hull of the report, with the proved bounds of its largest distance from the solid.
#[derive(Serialize)]
struct HullReport {
    vertices: usize,
    faces: usize,
    concavity_lower: f64,
    concavity_upper: f64,
}

/// Duration of each phase, in seconds.
#[derive(Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    decompose: f64,
    write: f64,
}

/// Loads the mesh, divides it and writes the hulls.
///
/// # Errors
/// Returns an error if the mesh cannot be read or is not closed, or the hulls cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let destination = Destination::of(&arguments.output, &arguments.mesh)?;
    let (loaded, load) = timed("loading", || Loaded::from_file(&arguments.mesh, None, arguments.reading));
    let loaded = loaded?;
    loaded.warn();
    let (body, build) = timed("building the hierarchy", || loaded.build(Builder::default(), &arguments.repairs));
    let Body { mesh, about, warnings, repair } = body?;
    let options = DecompositionOptions { concavity: arguments.concavity, max_parts: arguments.max_hulls };
    let (parts, decompose) = timed("dividing into convex parts", || divide(&mesh, options, &arguments.mesh));
    let parts = parts?;
    if !parts.is_within() {
        let reached = length(parts.concavity());
        console::note(&format!(
            "the hulls reach up to {reached} outside the solid; --max-hulls allows no more of them"
        ));
    }
    let (written, write) = timed("writing", || destination.write(&parts));
    written?;
    let of = |part: &impinge::mesh::ConvexPart| HullReport {
        vertices: part.hull.positions().len(),
        faces: part.hull.faces().len(),
        concavity_lower: part.concavity_lower,
        concavity_upper: part.concavity_upper,
    };
    let report = Report {
        schema: "impinge.decompose/1",
        version: env!("CARGO_PKG_VERSION"),
        path: about.path.display().to_string(),
        triangles: mesh.faces().len(),
        unit: about.unit.as_ref().map(Unit::to_string),
        output: arguments.output.display().to_string(),
        concavity: parts.concavity(),
        is_within: parts.is_within(),
        hulls: parts.parts().iter().map(of).collect(),
        repair,
        warnings,
        seconds: Seconds { load, build, decompose, write },
    };
    console::print_answer(&if arguments.json { console::to_line(&report) } else { text(&report) })?;
    Ok(Verdict::Clear)
}

/// Divides the solid of a mesh.
///
/// # Errors
/// Returns an error if the mesh is not closed or has no faces.
fn divide(mesh: &Mesh, options: DecompositionOptions, path: &Path) -> Result<ConvexParts, Failure> {
    mesh.convex_parts(options, Budget::unlimited()).map_err(|error| match error.kind() {
        InputErrorKind::Open { .. } => {
            let defects = repair::diagnosis(mesh, &mesh.health()).unwrap_or_default();
            let failure = Failure::new("open", format!("the mesh is not closed: {defects}"));
            failure.in_file(path).hint("a convex part is a part of a solid: close the mesh")
        }
        _ => Failure::from_input(&error).in_file(path),
    })
}

/// Formats the report for people.
fn text(report: &Report) -> String {
    let faces = report.hulls.iter().map(|hull| hull.faces).sum();
    let unit = report.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
    let (hulls, triangles) = (counted(report.hulls.len(), "hull"), counted(faces, "triangle"));
    let reach = length(report.concavity);
    let Seconds { load, build, decompose, write } = report.seconds;
    let [load, build, decompose, write] = [load, build, decompose, write].map(time);
    format!(
        "{}: {hulls} of {triangles}, at most {reach}{unit} outside the solid\n\
         time      load {load}, build {build}, decompose {decompose}, write {write}\n",
        report.output
    )
}

/// Place that the hulls are written to.
enum Destination<'a> {
    File(&'a Path),
    Folder(&'a Path),
}

impl<'a> Destination<'a> {
    /// Validates the name of the output before any work.
    ///
    /// # Errors
    /// Returns an error if the output has another extension, is the input, is a folder that is not
    /// empty, or is in a folder that does not exist.
    fn of(path: &'a Path, input: &Path) -> Result<Self, Failure> {
        let is_folder = path.is_dir();
        match output::extension(path).as_str() {
            "obj" if !is_folder => {
                output::validate(path, &[input])?;
                Ok(Self::File(path))
            }
            "" if !path.exists() => {
                output::validate(path, &[])?;
                Ok(Self::Folder(path))
            }
            _ if is_folder => match fs::read_dir(path).map(|mut entries| entries.next().is_none()) {
                Ok(true) => Ok(Self::Folder(path)),
                Ok(false) => Err(Failure::new("output", "the folder is not empty")
                    .in_file(path)
                    .hint("name another folder, or a file that ends in .obj")),
                Err(error) => Err(Failure::from_io(&error, "cannot be read").in_file(path)),
            },
            _ => Err(output::unknown_extension(path, ".obj, or name a folder")),
        }
    }

    /// Writes the hulls.
    ///
    /// # Errors
    /// Returns an error if a file or the folder cannot be written.
    fn write(&self, parts: &ConvexParts) -> Result<(), Failure> {
        let hulls: Vec<(String, &Hull)> =
            parts.parts().iter().enumerate().map(|(at, part)| (format!("part_{at}"), &*part.hull)).collect();
        match self {
            Self::File(path) => output::write(path, |out| write_obj(out, hulls.iter().map(obj))),
            Self::Folder(folder) => {
                fs::create_dir_all(folder)
                    .map_err(|error| Failure::from_io(&error, "cannot be created").in_file(folder))?;
                hulls.iter().try_for_each(|hull| {
                    output::write(&folder.join(format!("{}.obj", hull.0)), |out| write_obj(out, [obj(hull)]))
                })
            }
        }
    }
}

fn obj<'h>((name, hull): &'h (String, &Hull)) -> ObjPart<'h> {
    ObjPart { name, positions: hull.positions(), faces: hull.faces() }
}
