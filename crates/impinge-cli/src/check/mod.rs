//! `impinge check`: do two meshes meet, and where?

mod curves_file;
mod json;
mod pairs_file;
mod report;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use impinge::hierarchy::Builder;
use impinge::mesh::PlacedMesh;
use impinge::query::{self, Curves, Distance, Penetrates, SolidIntersection, SomePairs};
use impinge::{InputError, Pose};
use impinge_files::Unit;

use crate::body::{Body, Loaded, Reading};
use crate::bounds::Bounds;
use crate::failure::Failure;
use crate::progress::Phase;
use crate::{Verdict, console, numerals, output, pose, repair, units};
use pairs_file::PairsFormat;

/// More threads than any machine has processors for; an answer does not depend on them.
const MOST_THREADS: i64 = 1024;

/// Pairs that are counted: 1 GiB of them. More are none that anybody looks at, but piles of duplicate faces.
const MOST_PAIRS: usize = 1 << 27;

/// Do two meshes meet, and where?
///
/// The answer is exact: it is the truth about the closed triangles whose corners are the numbers in the files, mapped by
/// the poses. Touching counts. A mesh is its surface, not what that encloses, unless `--solid` says so.
///
/// Exit code: 0 where they are clear of each other, 1 where they meet or come within the clearance, 2 where there is no
/// answer. With `--penetrates` meeting means that the interiors of both meet, so that parts that touch are clear.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The first mesh: OBJ, STL, PLY, OFF, glTF, GLB, 3MF, COLLADA or baked, also as .gz
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
    /// Take both meshes, or A or B alone, as solid: what lies wholly inside meets it
    ///
    /// Inside is where the generalised winding number is beyond one half: exact for a closed mesh; an open one is told.
    #[arg(long, value_name = "SIDE", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    solid: Option<SolidArgument>,
    /// Ask whether the interiors of both, taken as solids, meet: touching does not count
    #[arg(long)]
    penetrates: bool,
    /// Write every pair of faces that meet, to a .csv or .npy file
    #[arg(long, value_name = "OUT")]
    pairs: Option<PathBuf>,
    /// Write the curves in which the meshes meet, to an .obj file
    #[arg(long, value_name = "OUT")]
    curves: Option<PathBuf>,
    /// Tell how far apart they are, with nearest points and faces; 0 where they meet, as solids where `--solid` says so
    #[arg(long)]
    distance: bool,
    /// Whether they come within this distance of each other, decided exactly; at it is within it
    ///
    /// In the finer unit of A and B. Where they do, the exit code is 1.
    #[arg(long, value_name = "D", value_parser = parse_clearance, allow_hyphen_values = true)]
    clearance: Option<f64>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    repairs: repair::Arguments,
    /// Take a mesh without faces, such as a point cloud, for one that meets nothing
    #[arg(long)]
    allow_empty: bool,
    /// Print one JSON object in place of the report
    #[arg(long)]
    json: bool,
    /// How many threads to use; all processors without it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
}

/// Which mesh is solid.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SolidArgument {
    A,
    B,
    #[value(hide = true)]
    Both,
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
    /// Where it was asked for.
    solid: Option<SolidIntersection>,
    /// Where it was asked for.
    penetrates: Option<Penetrates>,
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
        output::judge(path, &[&arguments.a, &arguments.b])?;
    }
    if [&arguments.a, &arguments.b].into_iter().all(|path| path == Path::new("-")) {
        return Err(Failure::new("usage", "standard input holds one mesh, not two").at("-"));
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
    outcome.warn_of_open_solids();
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
            || Loaded::from_file(&arguments.a, arguments.unit_a, arguments.reading),
            || Loaded::from_file(&arguments.b, arguments.unit_b, arguments.reading),
        )
    });
    let loaded = [a?, b?];
    loaded.iter().for_each(Loaded::warn);
    let stated = [loaded[0].about().unit, loaded[1].about().unit];
    units::explain(stated);
    let poses = scaled(poses, units::scales(stated))?;

    let [a, b] = loaded;
    // Whoever asks once waits longer for a better hierarchy than for the answer.
    let built = |loaded: Loaded| loaded.build(Builder::Morton, &arguments.repairs);
    let ((a, b), build) = timed("building hierarchies", || rayon::join(|| built(a), || built(b)));
    let bodies = [a?, b?];
    if let Some(empty) = bodies.iter().find(|body| body.mesh.faces().is_empty() && !arguments.allow_empty) {
        let failure = Failure::new("empty", "the mesh has no faces, so there is nothing to check");
        let hint = "--allow-empty takes it for a mesh that meets nothing";
        return Err(failure.in_file(&empty.about.path).hint(hint));
    }
    let bounds = [0, 1].map(|side| Bounds::of(&bodies[side].mesh, &Pose::IDENTITY));
    if let [Some(a), Some(b)] = &bounds {
        units::doubt(stated, [a.diagonal(), b.diagonal()], [&poses[0], &poses[1]]);
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
        let SomePairs { pairs, truncated } = query::intersecting_pairs_up_to(a, b, MOST_PAIRS);
        if truncated {
            let message = format!("more than {} pairs of faces meet", numerals::count(MOST_PAIRS));
            return Err(Failure::new("too-many", message).hint("impinge inspect counts duplicate faces"));
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

    /// Both meshes, as surfaces or as solids.
    fn placed(&self, is_solid: [bool; 2]) -> [PlacedMesh<'_>; 2] {
        [0, 1].map(|side| PlacedMesh { is_solid: is_solid[side], ..self.bodies[side].mesh.at(self.poses[side]) })
    }

    /// Whether they meet, as solids where that was asked for.
    fn intersects(&self) -> bool {
        self.solid.map_or(!self.pairs.is_empty(), |solid| solid.intersects)
    }

    /// The answer to the question that was asked; of penetration, what is undecided is a collision.
    fn verdict(&self) -> Verdict {
        let collides = self.penetrates.map_or_else(|| self.intersects(), Penetrates::possibly);
        let is_close = self.clearance.is_some_and(|clearance| clearance.is_violated);
        if collides || is_close { Verdict::Collision } else { Verdict::Clear }
    }

    /// Surfaces that do not meet may still be one inside the other, which is a collision in most minds.
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
                    "{inner} lies inside {outer}, of which only the surface was compared; --solid counts that as a collision"
                ));
            }
        }
    }

    /// Which of the two have no proper inside though one was asked for.
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
                    "{}: the mesh is not closed, so its inside is where its generalised winding number is beyond one \
                     half{diagnosis}",
                    about.path.display()
                ));
            }
        }
    }
}

impl SolidArgument {
    /// Whether each of the two is solid.
    fn sides(self) -> [bool; 2] {
        match self {
            Self::A => [true, false],
            Self::B => [false, true],
            Self::Both => [true, true],
        }
    }
}
