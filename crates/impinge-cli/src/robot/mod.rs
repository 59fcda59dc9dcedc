//! `impinge robot`: collisions of a robot in configurations and on motions.

mod audit;
mod check;
mod clearance;
mod inspect;
mod load;
mod motion;
mod page;
mod rows;

use clap::{Args, Subcommand};

use crate::Verdict;
use crate::failure::Failure;

/// Find the collisions of a robot in configurations and on motions
///
/// The robot is a URDF file, with meshes and optionally an SRDF file. Lengths are in meters and
/// angles in radians. Closed meshes are solids.
///
/// Exit code: 0 if all is free, 1 if something collides or nothing is proved, 2 if there is no
/// answer.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    question: Question,
}

#[derive(Subcommand)]
enum Question {
    Inspect(inspect::Arguments),
    Check(check::Arguments),
    Motion(motion::Arguments),
    Clearance(clearance::Arguments),
    Audit(audit::Arguments),
}

/// Answers a question about a robot.
///
/// # Errors
/// Returns an error if there is no answer, or it cannot be printed.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    match &arguments.question {
        Question::Inspect(arguments) => inspect::run(arguments),
        Question::Check(arguments) => check::run(arguments),
        Question::Motion(arguments) => motion::run(arguments),
        Question::Clearance(arguments) => clearance::run(arguments),
        Question::Audit(arguments) => audit::run(arguments),
    }
}
