//! `impinge bake`: saves a mesh with its hierarchy, so that loading it needs no parsing and no
//! building.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use impinge::hierarchy::Builder;
use impinge_files::{Format, Provenance};

use crate::body::{Body, Loaded, Reading};
use crate::check::timed;
use crate::failure::Failure;
use crate::numerals::{count, counted};
use crate::{Verdict, console, output, repair};

/// Save a mesh with its hierarchy, so that it loads without parsing and building
///
/// The file holds the vertices, faces and hierarchy in their in-memory layout. It also holds the
/// polygons, parts and unit of the original and, with --proxies, the convex hull and the bounding
/// volumes. `check`, `inspect` and `fit` accept it in place of a mesh and give the same answers.
/// The same mesh gives the same bytes on every machine. Another version of impinge may refuse the
/// file; then bake the mesh again.
///
/// Exit code: 0 if the file was written, 2 if the mesh cannot be read or the file cannot be
/// written.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or a baked file, optionally compressed
    /// as .gz
    mesh: PathBuf,
    /// The file to write; its name must end in .impinge
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// How to build the hierarchy: `fast` builds in the least time, `tight` makes queries faster
    #[arg(long, value_enum, default_value_t = Hierarchy::Auto)]
    hierarchy: Hierarchy,
    /// Also save the convex hull and the bounding volumes fitted to it
    ///
    /// Fitting them takes up to about four times as long as building the hierarchy (1.3 s for 3
    /// million triangles). The file opens as fast as without them, because they are validated only
    /// when used. `inspect` reports their sizes.
    #[arg(long)]
    proxies: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    repairs: repair::Arguments,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
}

/// The builder of the hierarchy, by the name that `--hierarchy` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Hierarchy {
    /// Up to 8,192 faces: the best of all planes by surface area; up to 131,072: like `tight`;
    /// above: like `fast`
    Auto,
    /// Sorts the faces along a space-filling curve; the fastest build
    Fast,
    /// Splits at the best of a few planes by surface area; faster queries
    Tight,
}

/// JSON report of schema `impinge.bake/1`.
#[derive(serde::Serialize)]
struct Report {
    schema: &'static str,
    version: &'static str,
    path: String,
    triangles: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    hull_vertices: Option<usize>,
    bytes: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    repair: Option<repair::Summary>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    seconds: Seconds,
}

/// Duration of each phase, in seconds.
#[derive(serde::Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    proxies: Option<f64>,
    write: f64,
}

/// Loads the mesh, builds its hierarchy and writes the baked file.
///
/// # Errors
/// Returns an error if the mesh cannot be read or the file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let path = &arguments.output;
    if Format::from_extension(&output::extension(path)) != Some(Format::Baked) {
        return Err(output::unknown_extension(path, ".impinge"));
    }
    output::validate(path, &[&arguments.mesh])?;
    let (loaded, load) = timed("loading", || Loaded::from_file(&arguments.mesh, None, arguments.reading));
    let loaded = loaded?;
    loaded.warn();
    let builder = match arguments.hierarchy {
        Hierarchy::Auto => Builder::Auto,
        Hierarchy::Fast => Builder::Morton,
        Hierarchy::Tight => Builder::BinnedSah,
    };
    let (body, build) = timed("building the hierarchy", || loaded.build(builder, &arguments.repairs));
    let Body { mesh, about, warnings, repair } = body?;
    let timed_proxies = arguments.proxies.then(|| timed("fitting the hull and the volumes", || mesh.proxies()));
    let (proxies, proxy_seconds) = timed_proxies.map_or((None, None), |(proxies, seconds)| (proxies, Some(seconds)));
    let provenance =
        Provenance { sources: about.sources, part_of: about.part_of, parts: about.parts, unit: about.unit };
    let (written, write) = timed("writing", || {
        output::write(path, |out| impinge_files::write_baked(&mesh, &provenance, proxies.as_ref(), out))
    });
    written?;
    let bytes = std::fs::metadata(path).map_or(0, |file| file.len());
    let report = Report {
        schema: "impinge.bake/1",
        version: env!("CARGO_PKG_VERSION"),
        path: path.display().to_string(),
        triangles: mesh.faces().len(),
        hull_vertices: proxies.as_ref().map(|proxies| proxies.hull().vertices().len()),
        bytes,
        repair,
        warnings,
        seconds: Seconds { load, build, proxies: proxy_seconds, write },
    };
    console::print_answer(&if arguments.json {
        console::to_line(&report)
    } else {
        let (triangles, bytes) = (counted(report.triangles, "triangle"), count(report.bytes as usize));
        let hull = report.hull_vertices.map_or(String::new(), |n| format!(", a hull of {}", counted(n, "corner")));
        format!("{}: {triangles}{hull}, {bytes} bytes\n", report.path)
    })?;
    Ok(Verdict::Clear)
}
