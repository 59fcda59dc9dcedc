//! `impinge robot motion`: whether a path is free, by proof.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use impinge::query::batch::Execution;
use impinge::robot;
use impinge::robot::{MotionCheck, MotionOptions};
use impinge::scene::Stop;
use serde::Serialize;

use super::load::{Loaded, RobotArguments, Surroundings, View, failure};
use super::{page, rows};
use crate::failure::Failure;
use crate::numerals::{count, counted, time};
use crate::progress::Bar;
use crate::{Verdict, console, output};

/// Prove that a path of straight motions is free, or find its first contact
///
/// The path goes in straight lines in the space of configurations. No verdict is by sampling.
///
/// Exit code: 0 if the path is proved free, 1 if it collides or is undecided, 2 if there is no
/// answer.
#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    surroundings: Surroundings,
    /// Waypoints, at least two: a .csv file, which may begin with the names of the joints, or a
    /// .npy file
    #[arg(long, value_name = "FILE")]
    path: PathBuf,
    #[command(flatten)]
    page: View,
    /// Maximum number of configurations that are examined for each leg of the path
    #[arg(long, value_name = "N", default_value_t = 1 << 17)]
    max_steps: usize,
}

#[derive(Serialize)]
struct Object<'o> {
    schema: &'static str,
    version: &'static str,
    robot: &'o str,
    verdict: &'static str,
    legs: Vec<Leg>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Leg {
    verdict: &'static str,
    /// The leg is proved free before this time, from 0 at its start to 1 at its end.
    t_free: f64,
    /// A time at which the robot collides.
    #[serde(skip_serializing_if = "Option::is_none")]
    t_hit: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pair: Option<[String; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    q_hit: Option<Vec<f64>>,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    proof: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    if let Some(path) = &arguments.page.view {
        output::validate_page(path, &[&arguments.path])?;
    }
    let loaded = arguments.robot.load(Some(&arguments.surroundings))?;
    let values = rows::read(&arguments.path, loaded.robot())?;
    let columns = loaded.robot().coordinates().len();
    let legs = (values.len() / columns.max(1)).saturating_sub(1);
    if legs == 0 {
        return Err(Failure::new("path", "a path has at least two waypoints").in_file(&arguments.path));
    }
    let check = arguments.surroundings.options(&loaded, Stop::First)?;
    let options = MotionOptions { check, max_steps: arguments.max_steps, keeps_certificate: false };
    let bar = Bar::begin("proving legs", legs as u64);
    let advance = |rows: usize| bar.advance_by(rows as u64);
    let start = std::time::Instant::now();
    let (starts, ends) = (&values[..legs * columns], &values[columns..]);
    let execution = Execution::default().with_progress(&advance);
    let found = loaded.robot().check_motions(starts, ends, &options, execution);
    let seconds = Seconds { load: loaded.seconds, proof: start.elapsed().as_secs_f64() };
    drop(bar);
    let found = found.map_err(|error| failure(&error))?.values;
    if let Some(path) = &arguments.page.view {
        page::of_path(path, &loaded, &values, &found)?;
    }
    let verdict = verdict(&found);
    let answer = if arguments.robot.json {
        let legs = found.iter().map(|leg| leg_object(&loaded, leg)).collect();
        let robot = &loaded.robot.name;
        let version = env!("CARGO_PKG_VERSION");
        console::to_line(&Object {
            schema: "impinge.robot.motion/1",
            version,
            robot,
            verdict: name(verdict),
            legs,
            seconds,
        })
    } else {
        text(&loaded, &found, verdict, &seconds)
    };
    console::print_answer(&answer)?;
    Ok(if verdict == robot::Verdict::Free { Verdict::Clear } else { Verdict::Collision })
}

/// Returns the verdict about all legs.
fn verdict(legs: &[MotionCheck]) -> robot::Verdict {
    let has = |verdict| legs.iter().any(|leg| leg.verdict == verdict);
    [robot::Verdict::Collides, robot::Verdict::Undecided]
        .into_iter()
        .find(|&verdict| has(verdict))
        .unwrap_or(robot::Verdict::Free)
}

fn name(verdict: robot::Verdict) -> &'static str {
    match verdict {
        robot::Verdict::Free => "free",
        robot::Verdict::Collides => "collides",
        robot::Verdict::Undecided => "undecided",
    }
}

fn leg_object(loaded: &Loaded, leg: &MotionCheck) -> Leg {
    Leg {
        verdict: name(leg.verdict),
        t_free: leg.free_until,
        t_hit: leg.hit_at,
        pair: leg.collision.map(|collision| loaded.names_of(&collision)),
        q_hit: leg.hit.clone(),
    }
}

fn text(loaded: &Loaded, legs: &[MotionCheck], verdict: robot::Verdict, seconds: &Seconds) -> String {
    let mut text = match verdict {
        robot::Verdict::Free => format!("The path is free: {} proved\n", counted(legs.len(), "leg")),
        robot::Verdict::Collides => "The path collides\n".to_owned(),
        robot::Verdict::Undecided => "The path is undecided\n".to_owned(),
    };
    // Writing to a String cannot fail.
    for (at, leg) in legs.iter().enumerate().filter(|(_, leg)| leg.verdict != robot::Verdict::Free) {
        let _ = write!(text, "  leg {}: free until {:.9}", count(at), leg.free_until);
        match (leg.hit_at, leg.collision) {
            (Some(time), Some(collision)) => {
                let [link, other] = loaded.names_of(&collision);
                let _ = writeln!(text, "; {link} and {other} collide at {time:.9}");
            }
            _ => text += "; nothing is proved after that\n",
        }
    }
    let _ = writeln!(text, "\ntime      load {}, proof {}", time(seconds.load), time(seconds.proof));
    text
}
