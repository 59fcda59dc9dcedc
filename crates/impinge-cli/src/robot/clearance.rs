//! `impinge robot clearance`: how far configurations are from a collision.

use std::fmt::Write;

use clap::Args;
use impinge::query::batch::Execution;
use impinge::robot::{Clearance, ClearanceOptions};
use impinge::scene::Stop;
use serde::Serialize;

use super::load::{Configurations, Loaded, RobotArguments, Surroundings, failure};
use super::rows;
use crate::failure::Failure;
use crate::numerals::{count, counted, length, time};
use crate::progress::Bar;
use crate::{Verdict, console};

/// Maximum number of configurations that the report lists.
const SHOWN: usize = 10;

/// Find how far configurations are from a collision
///
/// Exit code: 0 if all configurations are free, 1 if any collides, 2 if there is no answer.
#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    surroundings: Surroundings,
    #[command(flatten)]
    configurations: Configurations,
    /// Distance in meters beyond which clearances do not matter
    #[arg(long, value_name = "D", default_value_t = f64::INFINITY)]
    limit: f64,
}

#[derive(Serialize)]
struct Object<'o> {
    schema: &'static str,
    version: &'static str,
    robot: &'o str,
    clearances: Vec<Row>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Row {
    lower: f64,
    /// Absent if all pairs are farther apart than the limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    upper: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pair: Option<[String; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<[[f64; 3]; 2]>,
    undecided: bool,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    clearance: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let loaded = arguments.robot.load(Some(&arguments.surroundings))?;
    let values = rows::read(&arguments.configurations.configs, loaded.robot())?;
    let check = arguments.surroundings.options(&loaded, Stop::First)?;
    if check.self_padding != 0.0 || check.padding.iter().any(|padding| *padding != 0.0) {
        return Err(
            Failure::new("padding", "clearances have no padding").hint("leave out --padding and --self-padding")
        );
    }
    let options = ClearanceOptions { obstacles: check.obstacles, ignored: Vec::new(), limit: arguments.limit };
    let columns = loaded.robot().coordinates().len().max(1);
    let bar = Bar::begin("measuring clearances", (values.len() / columns) as u64);
    let advance = |rows: usize| bar.advance_by(rows as u64);
    let start = std::time::Instant::now();
    let found = loaded.robot().clearances(&values, &options, Execution::default().with_progress(&advance));
    let seconds = Seconds { load: loaded.seconds, clearance: start.elapsed().as_secs_f64() };
    drop(bar);
    let found = found.map_err(|error| failure(&error))?.values;
    let is_free = found.iter().all(|found| found.lower > 0.0);
    let answer = if arguments.robot.json {
        let clearances = found.iter().map(|found| row(&loaded, found)).collect();
        let (schema, version) = ("impinge.robot.clearance/1", env!("CARGO_PKG_VERSION"));
        console::to_line(&Object { schema, version, robot: &loaded.robot.name, clearances, seconds })
    } else {
        text(&loaded, &found, &seconds)
    };
    console::print_answer(&answer)?;
    Ok(if is_free { Verdict::Clear } else { Verdict::Collision })
}

fn row(loaded: &Loaded, found: &Clearance) -> Row {
    Row {
        lower: found.lower.min(f64::MAX),
        upper: Some(found.upper).filter(|upper| upper.is_finite()),
        pair: found.pair.map(|(link, other)| loaded.names(link, other)),
        points: found.points,
        undecided: found.is_undecided,
    }
}

fn text(loaded: &Loaded, found: &[Clearance], seconds: &Seconds) -> String {
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|&a, &b| found[a].lower.total_cmp(&found[b].lower));
    let hits = found.iter().filter(|found| found.lower == 0.0).count();
    let mut text = format!("{} of {} collide\n", count(hits), counted(found.len(), "configuration"));
    // Writing to a String cannot fail.
    for &at in order.iter().take(SHOWN) {
        let Clearance { lower, upper, pair, .. } = found[at];
        match pair {
            Some((link, other)) => {
                let [link, other] = loaded.names(link, other);
                let distance = if upper.is_finite() { upper } else { lower };
                let _ = writeln!(text, "{:>9}  {} m between {link} and {other}", count(at), length(distance));
            }
            None => {
                let _ = writeln!(text, "{:>9}  all pairs are farther apart than the limit", count(at));
            }
        }
    }
    if found.len() > SHOWN {
        let _ = writeln!(text, "           and {} with a larger clearance", count(found.len() - SHOWN));
    }
    let _ = writeln!(text, "\ntime      load {}, clearances {}", time(seconds.load), time(seconds.clearance));
    text
}
