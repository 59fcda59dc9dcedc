//! `impinge robot audit`: which pairs of links can collide at all.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use impinge::query::batch::Execution;
use impinge::robot::{AuditOptions, AuditedPair, PairFinding};
use serde::Serialize;

use super::load::{Loaded, RobotArguments, failure};
use crate::failure::Failure;
use crate::numerals::{count, counted, time};
use crate::progress::Bar;
use crate::{Verdict, console, output};

/// Find the pairs of links that never collide, by proof
///
/// Samples within the limits of the joints find pairs that collide. Of the others it is proved that
/// they never do, as far as that is possible.
///
/// Exit code: 0 if all pairs that collide are checked, 1 if the SRDF file disables one that
/// collides, 2 if there is no answer.
#[derive(Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Number of random configurations
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    samples: usize,
    /// Start of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Maximum number of boxes of configurations that are examined for each pair
    #[arg(long, value_name = "N", default_value_t = 1 << 12)]
    max_boxes: usize,
    /// Write an SRDF file that disables the pairs that need no check
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Serialize)]
struct Object<'o> {
    schema: &'static str,
    version: &'static str,
    robot: &'o str,
    samples: usize,
    pairs: Vec<Pair<'o>>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Pair<'o> {
    links: [&'o str; 2],
    finding: &'static str,
    checked: bool,
    /// A configuration in which the links collide.
    #[serde(skip_serializing_if = "Option::is_none")]
    witness: Option<&'o [f64]>,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    audit: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let loaded = arguments.robot.load(None)?;
    let Arguments { samples, seed, max_boxes, .. } = *arguments;
    let options = AuditOptions { samples, seed, max_boxes };
    let bar = Bar::begin("auditing configurations and pairs", samples as u64);
    let advance = |rows: usize| bar.advance_by(rows as u64);
    let start = std::time::Instant::now();
    let found = loaded.robot().audit(&options, Execution::default().with_progress(&advance));
    let seconds = Seconds { load: loaded.seconds, audit: start.elapsed().as_secs_f64() };
    drop(bar);
    let found = found.map_err(|error| failure(&error))?;
    if let Some(path) = &arguments.out {
        output::write(path, |out| out.write_all(loaded.robot.srdf(&found).as_bytes()))?;
    }
    let is_sound = !found.iter().any(is_missed);
    let answer = if arguments.robot.json {
        console::to_line(&object(&loaded, samples, &found, seconds))
    } else {
        text(&loaded, &found, &seconds)
    };
    console::print_answer(&answer)?;
    Ok(if is_sound { Verdict::Clear } else { Verdict::Collision })
}

/// Reports whether a pair collides, but is not checked.
fn is_missed(pair: &AuditedPair) -> bool {
    matches!(pair.finding, PairFinding::Witness(_)) && !pair.is_checked
}

fn name_of(finding: &PairFinding) -> &'static str {
    match finding {
        PairFinding::Adjacent => "adjacent",
        PairFinding::ProvedNever => "proved_never",
        PairFinding::Witness(_) => "witness",
        PairFinding::Always(_) => "always",
        PairFinding::Open => "open",
    }
}

fn object<'l>(loaded: &'l Loaded, samples: usize, found: &'l [AuditedPair], seconds: Seconds) -> Object<'l> {
    let pair = |pair: &'l AuditedPair| Pair {
        links: pair.links.map(|link| loaded.robot().links()[link].name.as_str()),
        finding: name_of(&pair.finding),
        checked: pair.is_checked,
        witness: match &pair.finding {
            PairFinding::Witness(q) | PairFinding::Always(q) => Some(q),
            _ => None,
        },
    };
    Object {
        schema: "impinge.robot.audit/1",
        version: env!("CARGO_PKG_VERSION"),
        robot: &loaded.robot.name,
        samples,
        pairs: found.iter().map(pair).collect(),
        seconds,
    }
}

fn text(loaded: &Loaded, found: &[AuditedPair], seconds: &Seconds) -> String {
    let kinds = [
        ("proved_never", "never collide, which is proved"),
        ("witness", "collide in some configurations"),
        ("always", "collide in every sample"),
        ("open", "collide in no sample, and nothing is proved"),
        ("adjacent", "are connected by a joint"),
    ];
    let mut text = format!("{}  {}\n", loaded.robot.name, counted(found.len(), "pair"));
    // Writing to a String cannot fail.
    for (kind, meaning) in kinds {
        let number = found.iter().filter(|pair| name_of(&pair.finding) == kind).count();
        let _ = writeln!(text, "{:>7}  {meaning}", count(number));
    }
    let names = |pair: &AuditedPair| {
        let [a, b] = pair.links.map(|link| loaded.robot().links()[link].name.as_str());
        format!("  {a} and {b}\n")
    };
    let missed: Vec<String> = found.iter().filter(|pair| is_missed(pair)).map(names).collect();
    if !missed.is_empty() {
        let _ = write!(text, "collide, but are disabled:\n{}", missed.concat());
    }
    let _ = writeln!(text, "\ntime      load {}, audit {}", time(seconds.load), time(seconds.audit));
    text
}
