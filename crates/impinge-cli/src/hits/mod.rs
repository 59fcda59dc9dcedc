//! `impinge hits`: hit volumes about the parts of a rigged character.

mod json;
mod picture;
mod report;

use std::num::NonZero;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use impinge::character::{Character, Leak, Mode, Plan, Rig};

use crate::check::timed;
use crate::failure::Failure;
use crate::{Verdict, console, output};
use picture::Sheet;

/// As the notes have it: a sphere for the head, four pills for the limbs and a box for the torso.
const VOLUMES: NonZero<usize> = NonZero::new(6).expect("not zero");

/// Which volumes stand for the parts of a rigged character?
///
/// Fits a sphere, a capsule, a box, a lozenge or a hull to each part, whichever costs rays the least, and says how tight it is
/// and what of the skinned surface it leaves out. Conservative volumes leave out nothing, at any time of any animation.
///
/// Exit code: 0, or 2 where the character cannot be read.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The character: a rigged glTF or GLB
    character: PathBuf,
    /// Show the frames of this animation in the picture, in place of one of each
    #[arg(long, value_name = "NAME", requires = "picture")]
    animation: Option<String>,
    /// At most so many volumes
    #[arg(long, value_name = "N", default_value_t = VOLUMES)]
    volumes: NonZero<usize>,
    /// Whether the volumes hold everything, or fit snugly
    #[arg(long, value_name = "MODE", default_value = "conservative")]
    mode: Fitting,
    /// Take parts, names and kinds from this file, as `--save` writes it, and choose the rest
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// Write the parts and their volumes to a file, to be loaded or edited
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Draw frames with the volumes over the mesh, to a .png file
    #[arg(long, value_name = "OUT")]
    picture: Option<PathBuf>,
    /// Print one JSON object in place of the report
    #[arg(long)]
    json: bool,
}

/// The modes by their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Fitting {
    Conservative,
    Snug,
}

/// Everything that there is to tell.
struct Outcome<'a> {
    arguments: &'a Arguments,
    rig: Rig,
    character: Character,
    leaks: Vec<Leak>,
    /// Frames in the picture.
    frames: Option<usize>,
    seconds: Seconds,
}

/// How long each phase took.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct Seconds {
    load: f64,
    fit: f64,
    measure: f64,
}

/// Fits, prints, and draws and saves where that was asked for.
///
/// # Errors
/// Where the character cannot be read or has no surface, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let path = &arguments.character;
    for written in arguments.picture.iter().chain(&arguments.save) {
        let inputs: Vec<_> = std::iter::once(path).chain(&arguments.plan).map(PathBuf::as_path).collect();
        output::judge(written, &inputs)?;
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
        let poses = picture::poses(&rig, arguments.animation.as_deref(), path)?;
        let (sheet, _) = timed("drawing", || Sheet::draw(&rig, &character, &poses));
        output::write(file, |out| out.write_all(&sheet.png()?))?;
        frames = Some(poses.len());
    }
    if let Some(file) = &arguments.save {
        let text = impinge_files::character_text(&rig, &character);
        output::write(file, |out| out.write_all(text.as_bytes()))?;
    }
    let seconds = Seconds { load, fit, measure };
    let outcome = Outcome { arguments, rig, character, leaks, frames, seconds };
    console::conclude(&if arguments.json { json::object(&outcome) } else { report::text(&outcome) })?;
    Ok(Verdict::Clear)
}
