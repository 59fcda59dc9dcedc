//! `impinge check`: tests whether two meshes intersect, and where.

mod curves_file;
mod json;
mod page;
mod pairs_file;
mod report;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use impinge::hierarchy::Builder;
use impinge::mesh::PlacedMesh;
use impinge::query::{self, Curves, Distance, LimitedPairs, Penetrates, SolidIntersection};
use impinge::{InputError, Pose};
use impinge_files::Unit;

use crate::axis::Axis;
use crate::body::{Body, Loaded, Reading};
use crate::bounds::Bounds;
use crate::failure::Failure;
use crate::progress::Phase;
use crate::{Verdict, console, numerals, output, pose, repair, units};
use pairs_file::PairsFormat;

/// Maximum value of `--threads`: more than any machine has processors. The answer does not depend
/// on the number of threads.
const MAX_THREADS: i64 = 1024;

/// Maximum number of face pairs that are stored: 1 GiB of memory. Only meshes with piles of
/// duplicate faces exceed it.
const MAX_PAIRS: usize = 1 << 27;

/// Check whether two meshes intersect, and where
///
/// The answer is exact for the closed triangles whose corners are the numbers in the files, mapped
/// by the poses. Touching counts as intersecting. A mesh is a surface unless `--solid` makes it a
/// solid.
///
/// Exit code: 0 if the meshes are clear of each other, 1 if they intersect or come within the
/// clearance, 2 if there is no answer. With `--penetrates`, only intersecting interiors count, so
/// meshes that merely touch are clear.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The first mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or a baked file, optionally
    /// compressed as .gz
    a: PathBuf,
    /// The second mesh
    b: PathBuf,
    /// Pose of A: tx,ty,tz or tx,ty,tz,qw,qx,qy,qz or a file with a 4x4 matrix
    ///
    /// The quaternion must have unit length. The matrix is row-major, for column vectors: 16
    /// numbers separated by spaces or commas, or JSON. It may scale. Lengths are in the finer unit
    /// of A and B.
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pose_a: Option<OsString>,
    /// Pose of B, in the same forms
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pose_b: Option<OsString>,
    /// Unit of A: um, mm, cm, in, ft or m; overrides the unit in the file
    #[arg(long, value_name = "U")]
    unit_a: Option<Unit>,
    /// Unit of B; overrides the unit in the file
    #[arg(long, value_name = "U")]
    unit_b: Option<Unit>,
    /// Treat both meshes, or only A or B, as solids: a mesh that lies entirely inside a solid
    /// intersects it
    ///
    /// A point is inside if the generalized winding number of the mesh there exceeds one half in
    /// absolute value. This is exact for a closed mesh; for an open mesh a warning is printed.
    #[arg(long, value_name = "SIDE", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    solid: Option<SolidArgument>,
    /// Check whether the interiors of both meshes, as solids, intersect; touching does not count
    #[arg(long)]
    penetrates: bool,
    /// Write every pair of intersecting faces to a .csv or .npy file
    #[arg(long, value_name = "OUT")]
    pairs: Option<PathBuf>,
    /// Write the intersection curves to an .obj file
    #[arg(long, value_name = "OUT")]
    curves: Option<PathBuf>,
    /// Write a page for a browser to an .html file: both meshes, and where they intersect or where
    /// they are nearest
    ///
    /// The page needs no other file and no network.
    #[arg(long, value_name = "OUT")]
    view: Option<PathBuf>,
    /// Axis that points up in the page; y for glTF and z for other files by default
    #[arg(long, value_name = "AXIS", requires = "view")]
    up: Option<Axis>,
    /// Report the distance with nearest points and faces; 0 if the meshes intersect, as solids if
    /// `--solid` is given
    #[arg(long)]
    distance: bool,
    /// Check exactly whether the distance is at most D
    ///
    /// D is in the finer unit of A and B. If the distance is at most D, the exit code is 1.
    #[arg(long, value_name = "D", value_parser = parse_clearance, allow_hyphen_values = true)]
    clearance: Option<f64>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    repairs: repair::Arguments,
    /// Accept a mesh without faces, such as a point cloud; it intersects nothing
    #[arg(long)]
    allow_empty: bool,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
    /// Number of threads to use; all processors by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    threads: Option<u16>,
}

/// The meshes that `--solid` selects.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SolidArgument {
    A,
    B,
    #[value(hide = true)]
    Both,
}

/// All results of a check.
struct Outcome {
    bodies: [Body; 2],
    /// Pose of each mesh, from its own frame and unit to the world frame in the common unit.
    poses: [Pose; 2],
    /// Bounding box of each mesh in its own frame; `None` for a mesh without faces.
    bounds: [Option<Bounds>; 2],
    pairs: Vec<[u32; 2]>,
    curves: Option<Curves>,
    distance: Option<Distance>,
    clearance: Option<Clearance>,
    /// Intersection as solids; `None` if it was not requested.
    solid: Option<SolidIntersection>,
    /// Penetration of the solids; `None` if it was not requested.
    penetrates: Option<Penetrates>,
    seconds: Seconds,
}

/// A required clearance, and whether the meshes come within it.
#[derive(Clone, Copy)]
struct Clearance {
    required: f64,
    is_violated: bool,
}

/// Duration of each phase, in seconds.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    query: f64,
}

/// Answers the query, prints the answer and writes the requested files.
///
/// # Errors
/// Returns an error if there is no answer, or it cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let pairs_file = match &arguments.pairs {
        Some(path) => Some((path, PairsFormat::of(path)?)),
        None => None,
    };
    let curves_file = arguments.curves.as_deref();
    if let Some(path) = curves_file {
        curves_file::validate_extension(path)?;
    }
    for path in [arguments.pairs.as_deref(), curves_file].into_iter().flatten() {
        output::validate(path, &[&arguments.a, &arguments.b])?;
    }
    if let Some(path) = &arguments.view {
        output::validate_page(path, &[&arguments.a, &arguments.b])?;
    }
    if [&arguments.a, &arguments.b].into_iter().all(|path| path == Path::new("-")) {
        return Err(Failure::new("usage", "standard input holds one mesh; read the other one from a file").at("-"));
    }
    let poses = arguments.poses()?;
    let outcome = match arguments.threads {
        None => answer(arguments, poses)?,
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|error| Failure::new("threads", format!("cannot start {threads} threads: {error}")))?
            .install(|| answer(arguments, poses))?,
    };
    if let Some((path, format)) = pairs_file {
        format.write(path, &outcome)?;
    }
    if let (Some(path), Some(curves)) = (curves_file, &outcome.curves) {
        curves_file::write(path, curves)?;
    }
    if let Some(path) = &arguments.view {
        page::write(path, &outcome, arguments.up)?;
    }
    let text = if arguments.json { json::object(&outcome) } else { report::text(&outcome) };
    outcome.hint_at_containment();
    outcome.warn_of_open_solids();
    console::print_answer(&text)?;
    Ok(outcome.verdict())
}

fn parse_clearance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(distance) if distance >= 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("a clearance is a finite number of at least 0".to_owned()),
    }
}

impl Arguments {
    fn poses(&self) -> Result<[Pose; 2], Failure> {
        let parse = |argument: &Option<OsString>, option| match argument {
            Some(argument) => pose::parse(argument, option),
            None => Ok(Pose::IDENTITY),
        };
        Ok([parse(&self.pose_a, "--pose-a")?, parse(&self.pose_b, "--pose-b")?])
    }

    /// Reports whether to compute the intersection curves: for every text report, and for JSON only
    /// with `--curves` or `--view`.
    fn wants_curves(&self) -> bool {
        !self.json || self.curves.is_some() || self.view.is_some()
    }
}

fn answer(arguments: &Arguments, poses: [Pose; 2]) -> Result<Outcome, Failure> {
    let ((a, b), load) = timed("loading", || {
        rayon::join(
            || Loaded::from_file(&arguments.a, arguments.unit_a, arguments.reading),
            || Loaded::from_file(&arguments.b, arguments.unit_b, arguments.reading),
        )
    });
    let loaded = [a?, b?];
    loaded.iter().for_each(Loaded::warn);
    let stated = [loaded[0].about().unit, loaded[1].about().unit];
    units::note_choice(stated);
    let poses = scaled(poses, units::scales(stated))?;

    let [a, b] = loaded;
    // Use the fastest builder: for a single query, a better hierarchy takes longer to build than it
    // saves.
    let built = |loaded: Loaded| loaded.build(Builder::Morton, &arguments.repairs);
    let ((a, b), build) = timed("building hierarchies", || rayon::join(|| built(a), || built(b)));
    let bodies = [a?, b?];
    if let Some(empty) = bodies.iter().find(|body| body.mesh.faces().is_empty() && !arguments.allow_empty) {
        let failure = Failure::new("empty", "the mesh has no faces, so there is nothing to check");
        let hint = "pass --allow-empty to accept a mesh that intersects nothing";
        return Err(failure.in_file(&empty.about.path).hint(hint));
    }
    let bounds = [0, 1].map(|side| Bounds::of(&bodies[side].mesh, &Pose::IDENTITY));
    if let [Some(a), Some(b)] = &bounds {
        units::warn_of_mismatch(stated, [a.diagonal(), b.diagonal()], [&poses[0], &poses[1]]);
    }

    let start = Outcome {
        bodies,
        poses,
        bounds,
        pairs: Vec::new(),
        curves: None,
        distance: None,
        clearance: None,
        solid: None,
        penetrates: None,
        seconds: Seconds::default(),
    };
    let (outcome, query) = timed("intersecting", || {
        let [a, b] = start.placed(arguments.solid.map_or([false; 2], SolidArgument::sides));
        let LimitedPairs { pairs, truncated } = query::intersecting_pairs_up_to(a, b, MAX_PAIRS);
        if truncated {
            let message = format!("more than {} pairs of faces intersect", numerals::count(MAX_PAIRS));
            return Err(Failure::new("too-many", message).hint("run impinge inspect to look for duplicate faces"));
        }
        let curves = arguments.wants_curves().then(|| query::curves_of_pairs(a, b, &pairs));
        let solid = arguments.solid.map(|_| query::solid_intersection_of_pairs(a, b, &pairs));
        let penetrates = arguments.penetrates.then(|| query::penetrates_of_pairs(a, b, &pairs));
        let distance = arguments.distance.then(|| query::distance(a, b));
        let clearance = arguments.clearance.map(|required| {
            let is_violated = solid.is_some_and(|solid| solid.intersects) || query::within(a, b, required);
            Clearance { required, is_violated }
        });
        Ok(Outcome { pairs, curves, distance, clearance, solid, penetrates, ..start })
    });
    let mut outcome = outcome?;
    outcome.seconds = Seconds { load, build, query };
    Ok(outcome)
}

/// Returns the poses with the unit scales included, so that vertices keep the numbers in the files.
fn scaled(poses: [Pose; 2], scales: [f64; 2]) -> Result<[Pose; 2], Failure> {
    let scaled = |side: usize, option: &str| {
        let factor = scales[side];
        let scale = Pose::new([[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, factor]], [0.0; 3]);
        let refuse = |error: InputError| Failure::from_input(&error).at(option);
        poses[side].compose(&scale.map_err(refuse)?).map_err(refuse)
    };
    Ok([scaled(0, "--pose-a")?, scaled(1, "--pose-b")?])
}

/// Runs `work` and returns its result and its duration in seconds, rounded to microseconds. `doing`
/// labels the spinner.
pub(crate) fn timed<T>(doing: &'static str, work: impl FnOnce() -> T) -> (T, f64) {
    let phase = Phase::begin(doing);
    let start = Instant::now();
    let result = work();
    let seconds = start.elapsed().as_secs_f64();
    drop(phase);
    (result, (seconds * 1e6).round() / 1e6)
}

impl Outcome {
    fn units(&self) -> [Option<Unit>; 2] {
        [self.bodies[0].about.unit, self.bodies[1].about.unit]
    }

    /// Returns both meshes with their poses, as surfaces or as solids.
    fn placed(&self, is_solid: [bool; 2]) -> [PlacedMesh<'_>; 2] {
        [0, 1].map(|side| PlacedMesh { is_solid: is_solid[side], ..self.bodies[side].mesh.at(self.poses[side]) })
    }

    /// Reports whether the meshes intersect, as solids if that was requested.
    fn intersects(&self) -> bool {
        self.solid.map_or(!self.pairs.is_empty(), |solid| solid.intersects)
    }

    /// Returns the verdict for the exit code. Undecided penetration counts as a collision.
    fn verdict(&self) -> Verdict {
        let collides = self.penetrates.map_or_else(|| self.intersects(), Penetrates::possibly);
        let is_close = self.clearance.is_some_and(|clearance| clearance.is_violated);
        if collides || is_close { Verdict::Collision } else { Verdict::Clear }
    }

    /// Prints a note if the surfaces do not intersect but one mesh lies inside the other: most
    /// users would call that a collision.
    fn hint_at_containment(&self) {
        if !self.pairs.is_empty() || self.solid.is_some() || self.penetrates.is_some() {
            return;
        }
        let [a, b] = [0, 1].map(|side| Bounds::of(&self.bodies[side].mesh, &self.poses[side]));
        let (Some(a), Some(b)) = (a, b) else { return };
        for (inner, outer, encloses, is_solid) in
            [("A", "B", b.encloses(&a), [false, true]), ("B", "A", a.encloses(&b), [true, false])]
        {
            let [placed_a, placed_b] = self.placed(is_solid);
            if encloses && query::intersects(placed_a, placed_b) {
                console::note(&format!(
                    "{inner} lies inside {outer}, but only the surfaces were compared; pass --solid to count this as a collision"
                ));
            }
        }
    }

    /// Reports for each mesh whether it is not closed although a question about its inside was
    /// asked.
    fn open(&self) -> [bool; 2] {
        let by_solid = self.solid.map_or([false; 2], |solid| solid.open);
        std::array::from_fn(|side| by_solid[side] || (self.penetrates.is_some() && !self.bodies[side].mesh.is_closed()))
    }

    fn warn_of_open_solids(&self) {
        for (side, open) in self.open().into_iter().enumerate() {
            if open {
                let Body { mesh, about, .. } = &self.bodies[side];
                let diagnosis = repair::diagnosis(mesh, &mesh.health());
                let diagnosis = diagnosis.map_or(String::new(), |diagnosis| format!(" ({diagnosis})"));
                console::warn(&format!(
                    "{}: the mesh is not closed, so a point counts as inside if the generalized winding number exceeds \
                     one half{diagnosis}",
                    about.path.display()
                ));
            }
        }
    }
}

impl SolidArgument {
    /// Returns for each mesh whether it is solid.
    fn sides(self) -> [bool; 2] {
        match self {
            Self::A => [true, false],
            Self::B => [false, true],
            Self::Both => [true, true],
        }
    }
}
