//! `impinge hits`: fits hit volumes to the parts of a rigged character.

mod json;
mod poses;
mod report;

use std::num::NonZero;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use impinge::character::{Character, Leak, Mode, Plan, Rig};
use impinge_report::picture;

use crate::check::timed;
use crate::failure::Failure;
use crate::{Verdict, console, output};

/// Default maximum number of volumes: a head, a torso and four limbs.
const DEFAULT_VOLUMES: NonZero<usize> = NonZero::new(6).expect("not zero");

/// Fit hit volumes to the parts of a rigged character
///
/// Fits a sphere, capsule, box, lozenge or hull to each part, whichever costs rays the least.
/// Reports how tight each volume is and how much of the skinned surface lies outside it.
/// Conservative volumes contain the whole surface at every time of every animation.
///
/// Exit code: 0 if the character could be read, 2 if not.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The character: a rigged glTF or GLB file
    character: PathBuf,
    /// Show frames of this animation in the picture, instead of one frame of each animation
    #[arg(long, value_name = "NAME", requires = "picture")]
    animation: Option<String>,
    /// Maximum number of volumes
    #[arg(long, value_name = "N", default_value_t = DEFAULT_VOLUMES)]
    volumes: NonZero<usize>,
    /// Whether the volumes contain the whole surface, or fit snugly
    #[arg(long, value_name = "MODE", default_value = "conservative")]
    mode: Fitting,
    /// Read the parts, their names and the kinds of their volumes from this file, as written by
    /// `--save`; whatever it leaves out is chosen automatically
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// Write the parts and their volumes to a file that can be edited and loaded
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Draw frames of the mesh with the volumes over it, to a .png file
    #[arg(long, value_name = "OUT")]
    picture: Option<PathBuf>,
    /// Print one JSON object instead of the report
    #[arg(long)]
    json: bool,
}

/// Values of `--mode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Fitting {
    Conservative,
    Snug,
}

/// All results of a fit.
struct Outcome<'a> {
    arguments: &'a Arguments,
    rig: Rig,
    character: Character,
    leaks: Vec<Leak>,
    /// Number of frames in the picture; `None` if no picture was requested.
    frames: Option<usize>,
    seconds: Seconds,
}

/// Duration of each phase, in seconds.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct Seconds {
    load: f64,
    fit: f64,
    measure: f64,
}

/// Fits the volumes, prints the answer, and writes the requested picture and plan.
///
/// # Errors
/// Returns an error if the character cannot be read or has no surface, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let path = &arguments.character;
    for written in arguments.picture.iter().chain(&arguments.save) {
        let inputs: Vec<_> = std::iter::once(path).chain(&arguments.plan).map(PathBuf::as_path).collect();
        output::validate(written, &inputs)?;
    }
    if let Some(picture) = arguments.picture.as_ref().filter(|picture| output::extension(picture) != "png") {
        return Err(output::unknown_extension(picture, ".png"));
    }
    let (rig, load) = timed("loading", || impinge_files::load_rig(path));
    let rig = rig?;
    let broken = |error: impinge::character::RigError| Failure::new("rig", error.to_string()).in_file(path);
    let mode = match arguments.mode {
        Fitting::Conservative => Mode::Conservative,
        Fitting::Snug => Mode::Snug,
    };
    let plan = match &arguments.plan {
        Some(file) => Some(impinge_files::load_plan(file, &rig)?),
        None => None,
    };
    let (character, fit) = timed("fitting", || {
        let plan = plan.map_or_else(|| Plan::automatic(&rig, arguments.volumes.get()), Ok)?;
        Character::fit(&rig, &plan, mode)
    });
    let character = character.map_err(broken)?;
    let (leaks, measure) = timed("measuring", || character.leaks(&rig));
    let leaks = leaks.map_err(broken)?;
    let mut frames = None;
    if let Some(file) = &arguments.picture {
        let poses = poses::poses(&rig, arguments.animation.as_deref(), path)?;
        let (sheet, _) = timed("drawing", || picture::character(&rig, &character, &poses));
        output::write(file, |out| out.write_all(&sheet.png()?))?;
        frames = Some(poses.len());
    }
    if let Some(file) = &arguments.save {
        let text = impinge_files::character_text(&rig, &character);
        output::write(file, |out| out.write_all(text.as_bytes()))?;
    }
    let seconds = Seconds { load, fit, measure };
    let outcome = Outcome { arguments, rig, character, leaks, frames, seconds };
    console::print_answer(&if arguments.json { json::object(&outcome) } else { report::text(&outcome) })?;
    Ok(Verdict::Clear)
}
