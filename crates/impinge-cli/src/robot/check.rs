//! `impinge robot check`: which configurations collide.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use impinge::query::batch::Execution;
use impinge::robot::{CheckOptions, Collision};
use impinge::scene::Stop;
use impinge_report::picture::{Axis, RobotView, robot};
use serde::Serialize;

use super::load::{Configurations, Loaded, RobotArguments, Surroundings, View, failure};
use super::{page, rows};
use crate::failure::Failure;
use crate::numerals::{count, counted, short_time, time};
use crate::progress::Bar;
use crate::{Verdict, console, output};

/// Maximum number of pairs that the report lists.
const SHOWN: usize = 10;

/// Find which configurations collide
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
    #[command(flatten)]
    page: View,
    /// Find all pairs that collide, not only the first of each configuration
    #[arg(long)]
    all: bool,
    /// Write a PNG picture of the first configuration that collides: what collides in colors
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

#[derive(Serialize)]
struct Object<'o> {
    schema: &'static str,
    version: &'static str,
    robot: &'o str,
    configurations: usize,
    colliding: usize,
    undecided: usize,
    /// Configurations that collide, by their index.
    collisions: Vec<Row>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Row {
    configuration: usize,
    pairs: Vec<Pair>,
}

#[derive(Serialize)]
struct Pair {
    link: String,
    other: String,
    undecided: bool,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    check: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    if let Some(path) = &arguments.page.view {
        output::validate_page(path, &[&arguments.configurations.configs])?;
    }
    if let Some(picture) = &arguments.picture {
        output::validate(picture, &[&arguments.configurations.configs])?;
        if output::extension(picture) != "png" {
            return Err(output::unknown_extension(picture, ".png"));
        }
    }
    let loaded = arguments.robot.load(Some(&arguments.surroundings))?;
    let values = rows::read(&arguments.configurations.configs, loaded.robot())?;
    let stop = if arguments.all { Stop::All } else { Stop::First };
    let options = arguments.surroundings.options(&loaded, stop)?;
    let columns = loaded.robot().coordinates().len().max(1);
    let bar = Bar::begin("checking configurations", (values.len() / columns) as u64);
    let advance = |rows: usize| bar.advance_by(rows as u64);
    let start = std::time::Instant::now();
    let found = loaded.robot().check(&values, &options, Execution::default().with_progress(&advance));
    let seconds = Seconds { load: loaded.seconds, check: start.elapsed().as_secs_f64() };
    drop(bar);
    let found = found.map_err(|error| failure(&error))?.values;
    if let Some(path) = &arguments.page.view {
        page::of_configurations(path, &loaded, &values, &found)?;
    }
    let is_free = found.iter().all(Vec::is_empty);
    if let (Some(path), Some(row)) = (&arguments.picture, found.iter().position(|pairs| !pairs.is_empty())) {
        draw(&loaded, &values[row * columns..(row + 1) * columns], &options, path)?;
    }
    let answer = if arguments.robot.json {
        console::to_line(&object(&loaded, &found, seconds))
    } else {
        text(&loaded, &found, arguments.all, &seconds)
    };
    console::print_answer(&answer)?;
    Ok(if is_free { Verdict::Clear } else { Verdict::Collision })
}

/// Draws a configuration.
fn draw(loaded: &Loaded, configuration: &[f64], options: &CheckOptions<'_>, path: &Path) -> Result<(), Failure> {
    let view = RobotView { size: [960, 720], angles: [-35.0, 25.0], up: Axis::Z };
    let picture = robot(loaded.robot(), configuration, options, view).map_err(|error| failure(&error))?;
    output::write(path, |out| out.write_all(&picture.png()?))
}

fn object<'l>(loaded: &'l Loaded, found: &[Vec<Collision>], seconds: Seconds) -> Object<'l> {
    let pair = |collision: &Collision| {
        let [link, other] = loaded.names_of(collision);
        Pair { link, other, undecided: collision.is_undecided }
    };
    let hits = found.iter().enumerate().filter(|(_, pairs)| !pairs.is_empty());
    let collisions: Vec<Row> =
        hits.map(|(configuration, pairs)| Row { configuration, pairs: pairs.iter().map(pair).collect() }).collect();
    let undecided = found.iter().filter(|pairs| pairs.iter().any(|collision| collision.is_undecided)).count();
    Object {
        schema: "impinge.robot.check/1",
        version: env!("CARGO_PKG_VERSION"),
        robot: &loaded.robot.name,
        configurations: found.len(),
        colliding: collisions.len(),
        undecided,
        collisions,
        seconds,
    }
}

fn text(loaded: &Loaded, found: &[Vec<Collision>], is_all: bool, seconds: &Seconds) -> String {
    let hits = found.iter().filter(|pairs| !pairs.is_empty()).count();
    let mut text = if hits == 0 {
        format!("All of {} are free\n", counted(found.len(), "configuration"))
    } else {
        format!("{} of {} collide\n", count(hits), counted(found.len(), "configuration"))
    };
    let mut pairs: Vec<([String; 2], usize)> = Vec::new();
    for collision in found.iter().flatten() {
        let names = loaded.names_of(collision);
        match pairs.iter_mut().find(|(known, _)| *known == names) {
            Some((_, count)) => *count += 1,
            None => pairs.push((names, 1)),
        }
    }
    pairs.sort_by_key(|pair| std::cmp::Reverse(pair.1));
    // Writing to a String cannot fail.
    for ([link, other], hits) in pairs.iter().take(SHOWN) {
        let _ = writeln!(text, "{:>9}  {link} and {other}", count(*hits));
    }
    if pairs.len() > SHOWN {
        let _ = writeln!(text, "           and {} more", counted(pairs.len() - SHOWN, "pair"));
    }
    if !is_all && hits > 0 {
        text += "Only the first pair of each configuration is counted; --all finds the others.\n";
    }
    let each = seconds.check / found.len() as f64;
    let _ = writeln!(text, "\ntime      load {}, check {} a configuration", time(seconds.load), short_time(each));
    text
}
