//! `impinge robot inspect`: what the files say about a robot.

use std::fmt::Write;

use clap::Args;
use impinge::robot::IgnoredReason;
use serde::Serialize;

use super::load::{Loaded, RobotArguments};
use crate::failure::Failure;
use crate::numerals::{counted, time};
use crate::{Verdict, console};

/// Report the links, joints, limits and checked pairs of a robot
///
/// Exit code: 0 if the robot is sound, 2 if there is no answer.
#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
}

#[derive(Serialize)]
struct Object<'o> {
    schema: &'static str,
    version: &'static str,
    robot: &'o str,
    links: Vec<&'o str>,
    links_without_shape: Vec<&'o str>,
    coordinates: Vec<Coordinate<'o>>,
    pairs: Vec<[&'o str; 2]>,
    ignored: Vec<Ignored<'o>>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Coordinate<'o> {
    name: &'o str,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    upper: Option<f64>,
}

#[derive(Serialize)]
struct Ignored<'o> {
    pair: [&'o str; 2],
    reason: String,
}

pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let loaded = arguments.robot.load(None)?;
    let answer = if arguments.robot.json { console::to_line(&object(&loaded)) } else { text(&loaded) };
    console::print_answer(&answer)?;
    Ok(Verdict::Clear)
}

fn reason(reason: IgnoredReason) -> String {
    match reason {
        IgnoredReason::Rigid => "rigid".to_owned(),
        IgnoredReason::Adjacent => "adjacent".to_owned(),
        IgnoredReason::Disabled(reason) if !reason.is_empty() => format!("disabled: {reason}"),
        _ => "disabled".to_owned(),
    }
}

fn object(loaded: &Loaded) -> Object<'_> {
    let robot = loaded.robot();
    let name = |link: usize| robot.links()[link].name.as_str();
    let finite = |limit: f64| Some(limit).filter(|limit| limit.is_finite());
    let coordinates = robot.coordinates().iter().map(|coordinate| {
        let [lower, upper] = coordinate.limits.map(finite);
        Coordinate { name: &coordinate.name, lower, upper }
    });
    let ignored = robot.ignored().into_iter().map(|(pair, why)| Ignored { pair: pair.map(name), reason: reason(why) });
    let bare = robot.links().iter().filter(|link| link.shape.is_none());
    Object {
        schema: "impinge.robot.inspect/1",
        version: env!("CARGO_PKG_VERSION"),
        robot: &loaded.robot.name,
        links: robot.links().iter().map(|link| link.name.as_str()).collect(),
        links_without_shape: bare.map(|link| link.name.as_str()).collect(),
        coordinates: coordinates.collect(),
        pairs: robot.pairs().iter().map(|&pair| pair.map(name)).collect(),
        ignored: ignored.collect(),
        warnings: loaded.robot.warnings.iter().map(ToString::to_string).collect(),
    }
}

fn text(loaded: &Loaded) -> String {
    let robot = loaded.robot();
    let bare: Vec<&str> =
        robot.links().iter().filter(|link| link.shape.is_none()).map(|link| link.name.as_str()).collect();
    let mut text = format!(
        "{}  {}  {}  {} checked, {} ignored\n",
        loaded.robot.name,
        counted(robot.links().len(), "link"),
        counted(robot.coordinates().len(), "coordinate"),
        counted(robot.pairs().len(), "pair"),
        robot.ignored().len(),
    );
    // Writing to a String cannot fail.
    for coordinate in robot.coordinates() {
        let [lower, upper] = coordinate.limits;
        let _ = writeln!(text, "  {:<24}{lower:>10.4} to {upper:.4}", coordinate.name);
    }
    if !bare.is_empty() {
        let _ = writeln!(text, "links without a shape: {}", bare.join(", "));
    }
    let _ = writeln!(text, "\ntime      load {}", time(loaded.seconds));
    text
}
