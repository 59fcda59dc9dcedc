//! `impinge check`: do two meshes meet, and where?

mod curves_file;
mod json;
mod pairs_file;
mod report;

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use impinge::query::{self, Curves, Distance};
use impinge::{InputError, Pose};
use impinge_files::Unit;

use crate::body::{Body, Loaded};
use crate::bounds::Bounds;
use crate::failure::Failure;
use crate::progress::Phase;
use crate::{Verdict, console, output, pose, units};
use pairs_file::PairsFormat;

/// More threads than any machine has processors for; an answer does not depend on them.
const MOST_THREADS: i64 = 1024;

/// Do two meshes meet, and where?
///
/// The answer is exact: it is the truth about the closed triangles whose corners are the numbers in the files, mapped by
/// the poses. Touching counts. A mesh is its surface, not what that encloses.
///
/// Exit code: 0 where they are clear of each other, 1 where they meet or come within the clearance, 2 where there is no
/// answer.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The first mesh: OBJ, STL, PLY, OFF, glTF, GLB or 3MF
    a: PathBuf,
    /// The second mesh
    b: PathBuf,
    /// Where A stands: tx,ty,tz or tx,ty,tz,qw,qx,qy,qz or a file with a 4x4 matrix
    ///
    /// The quaternion is of unit length. The matrix is row-major, for column vectors: 16 numbers with spaces or commas
    /// between them, or JSON. It may scale. Lengths are in the finer unit of A and B.
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pose_a: Option<OsString>,
    /// Where B stands
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pose_b: Option<OsString>,
    /// The unit of A: um, mm, cm, in, ft or m; overrides what the file states
    #[arg(long, value_name = "U")]
    unit_a: Option<Unit>,
    /// The unit of B
    #[arg(long, value_name = "U")]
    unit_b: Option<Unit>,
    /// Write every pair of faces that meet, to a .csv or .npy file
    #[arg(long, value_name = "OUT")]
    pairs: Option<PathBuf>,
    /// Write the curves in which the meshes meet, to an .obj file
    #[arg(long, value_name = "OUT")]
    curves: Option<PathBuf>,
    /// Tell how far apart they are, with nearest points and faces; 0 where they meet
    #[arg(long)]
    distance: bool,
    /// Whether they come within this distance of each other, decided exactly; at it is within it
    ///
    /// In the finer unit of A and B. Where they do, the exit code is 1.
    #[arg(long, value_name = "D", value_parser = parse_clearance, allow_hyphen_values = true)]
    clearance: Option<f64>,
    /// Print one JSON object in place of the report
    #[arg(long)]
    json: bool,
    /// How many threads to use; all processors without it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
}

/// Everything that there is to tell.
struct Outcome {
    bodies: [Body; 2],
    /// World from mesh, units included.
    poses: [Pose; 2],
    /// In each mesh's own frame; none for a mesh without faces.
    bounds: [Option<Bounds>; 2],
    pairs: Vec<[u32; 2]>,
    curves: Option<Curves>,
    distance: Option<Distance>,
    clearance: Option<Clearance>,
    seconds: Seconds,
}

/// A clearance that was asked for, and whether the meshes come within it.
#[derive(Clone, Copy)]
struct Clearance {
    required: f64,
    is_violated: bool,
}

/// How long each phase took.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    query: f64,
}

/// Answers, prints and writes what was asked for.
///
/// # Errors
/// Where there is no answer, or it cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let pairs_file = match &arguments.pairs {
        Some(path) => Some((path, PairsFormat::of(path)?)),
        None => None,
    };
    let curves_file = arguments.curves.as_deref();
    if let Some(path) = curves_file {
        curves_file::judge(path)?;
    }
    for path in [arguments.pairs.as_deref(), curves_file].into_iter().flatten() {
        output::spare(path, &[&arguments.a, &arguments.b])?;
    }
    let poses = arguments.poses()?;
    let outcome = match arguments.threads {
        None => answer(arguments, poses)?,
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|error| Failure::new("threads", format!("no {threads} threads can be had: {error}")))?
            .install(|| answer(arguments, poses))?,
    };
    if let Some((path, format)) = pairs_file {
        format.write(path, &outcome)?;
    }
    if let (Some(path), Some(curves)) = (curves_file, &outcome.curves) {
        curves_file::write(path, curves)?;
    }
    let text = if arguments.json { json::object(&outcome) } else { report::text(&outcome) };
    outcome.hint_at_containment();
    console::conclude(&text)?;
    Ok(outcome.verdict())
}

fn parse_clearance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(distance) if distance >= 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("a clearance is a number that is not negative".to_owned()),
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

    /// Whether the curves are to be computed: they are in every report, but a program asks for them.
    fn wants_curves(&self) -> bool {
        !self.json || self.curves.is_some()
    }
}

fn answer(arguments: &Arguments, poses: [Pose; 2]) -> Result<Outcome, Failure> {
    let ((a, b), load) = timed("loading", || {
        rayon::join(
            || Loaded::from_file(&arguments.a, arguments.unit_a),
            || Loaded::from_file(&arguments.b, arguments.unit_b),
        )
    });
    let loaded = [a?, b?];
    for body in &loaded {
        for warning in &body.warnings {
            console::warn(&format!("{}: {warning}", body.about().path.display()));
        }
    }
    let stated = [loaded[0].about().unit, loaded[1].about().unit];
    units::explain(stated);
    let poses = scaled(poses, units::scales(stated))?;

    let [a, b] = loaded;
    let ((a, b), build) = timed("building hierarchies", || rayon::join(|| a.build(), || b.build()));
    let bodies = [a?, b?];
    let bounds = [0, 1].map(|side| Bounds::of(&bodies[side].mesh, &Pose::IDENTITY));
    if let [Some(a), Some(b)] = &bounds {
        units::doubt(stated, [a.diagonal(), b.diagonal()], [&poses[0], &poses[1]]);
    }

    let (mut outcome, query) = timed("intersecting", || {
        let (a, b) = (bodies[0].mesh.at(poses[0]), bodies[1].mesh.at(poses[1]));
        let pairs = query::intersecting_pairs(a, b);
        let curves = arguments.wants_curves().then(|| query::curves_of_pairs(a, b, &pairs));
        let distance = arguments.distance.then(|| query::distance(a, b));
        let clearance =
            arguments.clearance.map(|required| Clearance { required, is_violated: query::within(a, b, required) });
        Outcome { bodies, poses, bounds, pairs, curves, distance, clearance, seconds: Seconds::default() }
    });
    outcome.seconds = Seconds { load, build, query };
    Ok(outcome)
}

/// The poses of the meshes in their own units; vertices stay the numbers that they are.
fn scaled(poses: [Pose; 2], scales: [f64; 2]) -> Result<[Pose; 2], Failure> {
    let scaled = |side: usize, option: &str| {
        let factor = scales[side];
        let scale = Pose::new([[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, factor]], [0.0; 3]);
        let refuse = |error: InputError| Failure::from_input(&error).at(option);
        poses[side].compose(&scale.map_err(refuse)?).map_err(refuse)
    };
    Ok([scaled(0, "--pose-a")?, scaled(1, "--pose-b")?])
}

/// What `work` gives, and the seconds that it takes.
fn timed<T>(doing: &'static str, work: impl FnOnce() -> T) -> (T, f64) {
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

    fn verdict(&self) -> Verdict {
        let is_clear = self.pairs.is_empty() && !self.clearance.is_some_and(|clearance| clearance.is_violated);
        if is_clear { Verdict::Clear } else { Verdict::Collision }
    }

    /// Surfaces that do not meet may still be one inside the other, which is a collision in most minds.
    fn hint_at_containment(&self) {
        if !self.pairs.is_empty() {
            return;
        }
        let [a, b] = [0, 1].map(|side| Bounds::of(&self.bodies[side].mesh, &self.poses[side]));
        let (Some(a), Some(b)) = (a, b) else { return };
        for (inner, outer, encloses) in [("A", "B", b.encloses(&a)), ("B", "A", a.encloses(&b))] {
            if encloses {
                console::note(&format!(
                    "{inner} may lie wholly inside {outer}: its box is inside {outer}'s box; only surfaces were compared, \
                     not what they enclose"
                ));
            }
        }
    }
}
