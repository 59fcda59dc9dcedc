//! The `impinge` command as a library. The `impinge` program and the Python package both run it.
//!
//! The report or the JSON object goes to standard output. Notes, warnings and errors go to standard
//! error.

#![forbid(unsafe_code)]

mod axis;
mod bake;
mod body;
mod bounds;
mod check;
mod clash;
mod completions;
mod console;
mod decompose;
mod failure;
mod fit;
mod hits;
mod inspect;
mod limits;
mod man;
mod numerals;
mod output;
mod pose;
mod progress;
mod repair;
mod robot;
mod units;
mod world;

use std::ffi::OsString;
use std::iter;

use clap::error::ErrorKind::{DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion};
use clap::{CommandFactory, Parser, Subcommand};

use failure::Failure;

/// Common uses, which the help shows after the options. A test runs each of them. Lines have at
/// most 71 columns, so that they fit in a manual page of 80.
const EXAMPLES: &str = "\
Examples:
  impinge check a.stl b.stl                  Do they intersect? Where?
  impinge check a.stl b.stl --pose-b 1,0,0   The same, with B moved
  impinge check a.stl b.stl --distance       How far apart are they?
  impinge check a.stl b.stl --clearance 2.5  Is the gap at most 2.5?
  impinge check a.stl b.stl --penetrates     Do interiors intersect?
  impinge check a.stl b.stl --pairs out.csv  Save the pairs of faces
  impinge clash a.stl b.stl                  Which parts clash?
  impinge inspect a.stl --picture boxes.png  Is the mesh sound?
  impinge bake a.stl -o a.impinge            Save it to load at once
  impinge decompose a.stl -o parts.obj       Divide it into hulls
  impinge fit a.stl                          Which volume fits it best?
  impinge hits robot.glb --save parts.toml   Fit its hit volumes

Exit codes of `check` and `clash`: 0 clear, 1 collision, 2 no answer.
--json prints one JSON object instead of the report.";

/// Exact and fast collision detection for triangle meshes.
#[derive(Parser)]
#[command(name = "impinge", version, arg_required_else_help = true, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    limits: limits::Limits,
}

#[derive(Subcommand)]
enum Command {
    Bake(bake::Arguments),
    Check(check::Arguments),
    Clash(clash::Arguments),
    Completions(completions::Arguments),
    Decompose(decompose::Arguments),
    Fit(fit::Arguments),
    Hits(hits::Arguments),
    Inspect(inspect::Arguments),
    Man(man::Arguments),
    Robot(robot::Arguments),
    World(world::Arguments),
}

impl Command {
    fn run(&self) -> Result<Verdict, Failure> {
        match self {
            Self::Bake(arguments) => bake::run(arguments),
            Self::Check(arguments) => check::run(arguments),
            Self::Clash(arguments) => clash::run(arguments),
            Self::Completions(arguments) => completions::run(arguments, Cli::command()),
            Self::Decompose(arguments) => decompose::run(arguments),
            Self::Fit(arguments) => fit::run(arguments),
            Self::Hits(arguments) => hits::run(arguments),
            Self::Inspect(arguments) => inspect::run(arguments),
            Self::Man(arguments) => man::run(arguments, Cli::command()),
            Self::Robot(arguments) => robot::run(arguments),
            Self::World(arguments) => world::run(arguments),
        }
    }
}

/// The answer of a command. The numeric value is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Clear = 0,
    Collision = 1,
}

/// Exit code if there is no answer: the arguments are invalid, or the command failed.
const NO_ANSWER: u8 = 2;

/// Runs the command with the given arguments and returns its exit code.
///
/// The arguments do not include the name of the program. The exit code is 0 if the answer is
/// "clear", 1 if it is "collision", and 2 if there is no answer. If there is no answer, an error on
/// standard error gives the reason. With `--json` the error also goes to standard output.
///
/// Call this function at most once per process, in a process that does nothing else: it installs a
/// handler that ends the process with exit code 2 on an interrupt (Ctrl-C). Parallel work runs on
/// the current rayon pool unless `--threads` is given.
///
/// ```
/// assert_eq!(impinge_cli::run(["--version"]), 0);
/// ```
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString>>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    // Search the raw arguments: an error is reported as JSON even if the arguments cannot be
    // parsed.
    let json = arguments.iter().any(|argument| argument == "--json");
    console::exit_on_interrupt(json);
    // The parser expects the name of the program as the first argument.
    let answer = match Cli::try_parse_from(iter::once("impinge".into()).chain(arguments)) {
        Ok(cli) => {
            cli.limits.watch(json);
            cli.command.run()
        }
        Err(error)
            if matches!(error.kind(), DisplayHelp | DisplayVersion | DisplayHelpOnMissingArgumentOrSubcommand) =>
        {
            // Ignore a closed standard output: then nobody reads the text.
            let _ = error.print();
            return if error.use_stderr() { NO_ANSWER } else { 0 };
        }
        Err(error) => Err(Failure::from_usage(&error)),
    };
    match answer {
        Ok(verdict) => verdict as u8,
        Err(failure) => {
            console::print_failure(&failure, json);
            NO_ANSWER
        }
    }
}
