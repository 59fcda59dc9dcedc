//! The `impinge` command: collisions of real meshes, exactly.
//!
//! The report, or the JSON, goes to standard output and everything else to standard error. The exit code is 0 where the
//! answer is "clear", 1 where it is "collision" and 2 where there is no answer.

#![forbid(unsafe_code)]

mod bake;
mod body;
mod bounds;
mod check;
mod console;
mod failure;
mod fit;
mod hits;
mod inspect;
mod numerals;
mod output;
mod pose;
mod progress;
mod repair;
mod units;
mod world;

use std::env;
use std::process::ExitCode;

use clap::error::ErrorKind::{DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion};
use clap::{Parser, Subcommand};

use failure::Failure;

/// Collision detection for triangle meshes: exact, and fast.
#[derive(Parser)]
#[command(name = "impinge", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Bake(bake::Arguments),
    Check(check::Arguments),
    Fit(fit::Arguments),
    Hits(hits::Arguments),
    Inspect(inspect::Arguments),
    World(world::Arguments),
}

/// What a question was answered with; its value is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Clear = 0,
    Collision = 1,
}

/// The exit code where a question could not be answered.
const NO_ANSWER: u8 = 2;

fn main() -> ExitCode {
    // Read off the raw arguments, as an error must be told as JSON even where the arguments cannot be parsed.
    let json = env::args_os().any(|argument| argument == "--json");
    console::conclude_when_interrupted(json);
    let answer = match Cli::try_parse() {
        Ok(cli) => match cli.command {
            Command::Bake(arguments) => bake::run(&arguments),
            Command::Check(arguments) => check::run(&arguments),
            Command::Fit(arguments) => fit::run(&arguments),
            Command::Hits(arguments) => hits::run(&arguments),
            Command::Inspect(arguments) => inspect::run(&arguments),
            Command::World(arguments) => world::run(&arguments),
        },
        Err(error)
            if matches!(error.kind(), DisplayHelp | DisplayVersion | DisplayHelpOnMissingArgumentOrSubcommand) =>
        {
            // Where nobody reads it, nothing is lost.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(NO_ANSWER) } else { ExitCode::SUCCESS };
        }
        Err(error) => Err(Failure::from_usage(&error)),
    };
    match answer {
        Ok(verdict) => ExitCode::from(verdict as u8),
        Err(failure) => {
            console::conclude_with_failure(&failure, json);
            ExitCode::from(NO_ANSWER)
        }
    }
}
