//! `impinge inspect`: the hierarchy of a mesh, the mesh's health, and a picture of the boxes of one level.

mod json;
pub(crate) mod picture;
mod proxies;
mod report;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use impinge::Pose;
use impinge::hierarchy::{Builder, MAX_DEPTH, TreeStatistics};
use impinge::mesh::Health;

use crate::body::{Body, Loaded, Reading};
use crate::bounds::Bounds;
use crate::check::timed;
use crate::failure::Failure;
use crate::{Verdict, console, output, repair};
use picture::{Picture, PictureFormat};
use proxies::Summary;

/// The level that is drawn where none is asked for is the last one with no more boxes than this: more of them hide each
/// other.
const MOST_BOXES: usize = 160;

/// What is this mesh like, and what does its hierarchy look like?
///
/// Reports how well the hierarchy is built, what it takes, and what is odd about the mesh: faces without area, duplicates,
/// open and non-manifold edges, pieces. All counts are exact. None of it keeps a mesh from being checked. Of a file that was baked
/// with proxies, their sizes too.
///
/// Exit code: 0, or 2 where the mesh cannot be read.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or baked, also as .gz
    mesh: PathBuf,
    /// Draw the boxes of one level over the mesh, to a .png or .svg file
    #[arg(long, value_name = "OUT")]
    picture: Option<PathBuf>,
    /// Which level to draw, the box of all being level 0; the last with at most 160 boxes without it
    #[arg(long, value_name = "N", requires = "picture")]
    level: Option<usize>,
    /// Which axis points up in the picture
    #[arg(long, value_name = "AXIS", default_value = "y", requires = "picture")]
    up: Axis,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    repairs: repair::Arguments,
    /// Print one JSON object in place of the report
    #[arg(long)]
    json: bool,
}

/// An axis of the mesh's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Axis {
    X = 0,
    Y = 1,
    Z = 2,
}

/// Everything that there is to tell.
struct Inspection {
    body: Body,
    /// In the mesh's own frame; none for a mesh without faces.
    bounds: Option<Bounds>,
    tree: TreeStatistics,
    health: Health,
    /// Of a baked file that brings some.
    proxies: Option<Summary>,
    drawn: Option<Drawn>,
    seconds: Seconds,
}

/// What the picture shows.
#[derive(Clone, Debug, serde::Serialize)]
struct Drawn {
    path: String,
    level: usize,
    boxes: usize,
}

/// How long each phase took.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    inspect: f64,
}

/// Inspects, prints, and draws where that was asked for.
///
/// # Errors
/// Where the mesh cannot be read, or the picture or the report cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let picture = match &arguments.picture {
        Some(path) => {
            output::judge(path, &[&arguments.mesh])?;
            Some((path, PictureFormat::of(path)?))
        }
        None => None,
    };
    let (loaded, load) = timed("loading", || Loaded::from_file(&arguments.mesh, None, arguments.reading));
    let loaded = loaded?;
    loaded.warn();
    let baked = loaded.baked().cloned();
    let (body, build) = timed("building the hierarchy", || loaded.build(Builder::default(), &arguments.repairs));
    let body = body?;
    // Those of a baked mesh are not those of its repair.
    let proxies = match baked.filter(|_| body.repair.is_none()) {
        Some(baked) => timed("proving the proxies", || baked.proxies(&body.mesh)).0?,
        None => None,
    };
    let proxies = proxies.as_ref().map(Summary::of);
    let ((tree, health), inspect) = timed("inspecting", || (body.mesh.tree_statistics(), body.mesh.health()));

    let mut drawn = None;
    if let Some((path, format)) = picture {
        let level = arguments.level.unwrap_or_else(|| default_level(&body));
        let boxes = body.mesh.tree_level(level);
        let (picture, _) = timed("drawing", || Picture::draw(&body.mesh, &boxes, arguments.up as usize));
        output::write(path, |out| picture.write(format, out))?;
        drawn = Some(Drawn { path: path.display().to_string(), level, boxes: boxes.len() });
    }
    let bounds = Bounds::of(&body.mesh, &Pose::IDENTITY);
    let seconds = Seconds { load, build, inspect };
    let inspection = Inspection { body, bounds, tree, health, proxies, drawn, seconds };
    console::conclude(&if arguments.json { json::object(&inspection) } else { report::text(&inspection) })?;
    Ok(Verdict::Clear)
}

fn default_level(body: &Body) -> usize {
    let fits = |&level: &usize| body.mesh.tree_level(level).len() <= MOST_BOXES;
    // Below the depth of the tree, levels are all alike.
    let deepest = body.mesh.tree_statistics().depth.min(MAX_DEPTH);
    (1..=deepest).take_while(fits).last().unwrap_or(0)
}
