//! `impinge inspect`: reports the quality of a mesh and of its hierarchy, and draws one level of
//! the hierarchy.

mod json;
mod page;
mod proxies;
mod report;

use std::path::{Path, PathBuf};

use clap::Args;
use impinge::Pose;
use impinge::hierarchy::{Builder, MAX_DEPTH, TreeStatistics};
use impinge::mesh::Health;
use impinge_report::picture::HierarchyPicture;

use crate::axis::Axis;
use crate::body::{Body, Loaded, Reading};
use crate::bounds::Bounds;
use crate::check::timed;
use crate::failure::Failure;
use crate::{Verdict, console, output, repair};
use proxies::Summary;

/// Maximum number of boxes in a picture if no level is requested: the deepest level within it is
/// drawn. More boxes hide each other.
const MAX_BOXES: usize = 160;

/// Report the quality of a mesh and of its hierarchy
///
/// Reports the quality and the memory of the hierarchy, and whatever is unusual about the mesh:
/// faces without area, duplicates, open and non-manifold edges, separate pieces. All counts are
/// exact. None of these keeps a mesh from being checked. For a file baked with proxies, it reports
/// their sizes too.
///
/// Exit code: 0 if the mesh could be read, 2 if not.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or a baked file, optionally compressed
    /// as .gz
    mesh: PathBuf,
    /// Draw the boxes of one level of the hierarchy over the mesh, to a .png or .svg file
    #[arg(long, value_name = "OUT")]
    picture: Option<PathBuf>,
    /// Level to draw; level 0 is the box of the whole mesh. Default: the deepest level with at most
    /// 160 boxes
    #[arg(long, value_name = "N", requires = "picture")]
    level: Option<usize>,
    /// Write a page for a browser to an .html file: the mesh, and the boxes of each level with a
    /// slider
    ///
    /// The page needs no other file and no network.
    #[arg(long, value_name = "OUT")]
    view: Option<PathBuf>,
    /// Axis that points up in the picture and in the page
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: Axis,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    repairs: repair::Arguments,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
}

/// Format of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PictureFormat {
    Png,
    Svg,
}

/// All results of an inspection.
struct Inspection {
    body: Body,
    /// Bounding box in the mesh frame; `None` for a mesh without faces.
    bounds: Option<Bounds>,
    tree: TreeStatistics,
    health: Health,
    /// Summary of the proxies in a baked file; `None` if there are none.
    proxies: Option<Summary>,
    drawn: Option<Drawn>,
    seconds: Seconds,
}

/// Description of the picture.
#[derive(Clone, Debug, serde::Serialize)]
struct Drawn {
    path: String,
    level: usize,
    boxes: usize,
}

/// Duration of each phase, in seconds.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    inspect: f64,
}

/// Inspects the mesh, prints the answer and draws the requested picture.
///
/// # Errors
/// Returns an error if the mesh cannot be read, or the picture or the report cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let picture = match &arguments.picture {
        Some(path) => {
            output::validate(path, &[&arguments.mesh])?;
            Some((path, PictureFormat::of(path)?))
        }
        None => None,
    };
    if let Some(path) = &arguments.view {
        output::validate_page(path, &[&arguments.mesh])?;
    }
    let (loaded, load) = timed("loading", || Loaded::from_file(&arguments.mesh, None, arguments.reading));
    let loaded = loaded?;
    loaded.warn();
    let baked = loaded.baked().cloned();
    let (body, build) = timed("building the hierarchy", || loaded.build(Builder::default(), &arguments.repairs));
    let body = body?;
    // The proxies of a baked mesh do not fit the repaired mesh.
    let proxies = match baked.filter(|_| body.repair.is_none()) {
        Some(baked) => timed("validating the proxies", || baked.proxies(&body.mesh)).0?,
        None => None,
    };
    let proxies = proxies.as_ref().map(Summary::of);
    let ((tree, health), inspect) = timed("inspecting", || (body.mesh.tree_statistics(), body.mesh.health()));

    let mut drawn = None;
    if let Some((path, format)) = picture {
        let level = arguments.level.unwrap_or_else(|| default_level(&body));
        let boxes = body.mesh.tree_level(level);
        let (picture, _) = timed("drawing", || HierarchyPicture::draw(&body.mesh, &boxes, arguments.up.into()));
        output::write(path, |out| match format {
            PictureFormat::Png => picture.write_png(out),
            PictureFormat::Svg => picture.write_svg(out),
        })?;
        drawn = Some(Drawn { path: path.display().to_string(), level, boxes: boxes.len() });
    }
    let bounds = Bounds::of(&body.mesh, &Pose::IDENTITY);
    let seconds = Seconds { load, build, inspect };
    let inspection = Inspection { body, bounds, tree, health, proxies, drawn, seconds };
    if let Some(path) = &arguments.view {
        page::write(path, &inspection, arguments.up)?;
    }
    console::print_answer(&if arguments.json { json::object(&inspection) } else { report::text(&inspection) })?;
    Ok(Verdict::Clear)
}

fn default_level(body: &Body) -> usize {
    let fits = |&level: &usize| body.mesh.tree_level(level).len() <= MAX_BOXES;
    // All levels below the deepest leaf are equal.
    let deepest = body.mesh.tree_statistics().depth.min(MAX_DEPTH);
    (1..=deepest).take_while(fits).last().unwrap_or(0)
}

impl PictureFormat {
    /// Returns the format that the extension of a path names.
    ///
    /// # Errors
    /// Returns an error if the extension is neither `.png` nor `.svg`.
    fn of(path: &Path) -> Result<Self, Failure> {
        match output::extension(path).as_str() {
            "png" => Ok(Self::Png),
            "svg" => Ok(Self::Svg),
            _ => Err(output::unknown_extension(path, ".png or .svg")),
        }
    }
}
