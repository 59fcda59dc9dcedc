//! The pages about configurations and about a path.

use std::path::Path;

use impinge::robot::{self, Collision, MotionCheck};
use impinge_files::Unit;
use impinge_report::html::{PageAbout, RobotPage, RobotStep, StepVerdict, write_robot_page};
use impinge_report::picture::Axis;

use super::load::Loaded;
use crate::failure::Failure;
use crate::numerals::{count, counted};
use crate::output;

/// Maximum number of steps of a slider. More are closer than pixels, and each takes about 50 bytes
/// for each link.
const MAX_STEPS: usize = 240;

/// Writes a page with the configurations that collide, or with all of them if none does.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn of_configurations(
    path: &Path,
    loaded: &Loaded,
    values: &[f64],
    found: &[Vec<Collision>],
) -> Result<(), Failure> {
    let columns = loaded.robot().coordinates().len();
    let hits = found.iter().filter(|pairs| !pairs.is_empty()).count();
    let shown = (0..found.len()).filter(|&row| hits == 0 || !found[row].is_empty()).take(MAX_STEPS);
    let steps: Vec<RobotStep> = shown
        .map(|row| {
            let (text, verdict) = match found[row][..] {
                [] => ("free".to_owned(), StepVerdict::Free),
                [first, ..] => (collision_text(loaded, &first), StepVerdict::Collides),
            };
            let more = match found[row].len() {
                0 | 1 => String::new(),
                pairs => format!("; {} in all", counted(pairs, "pair")),
            };
            let name = format!("configuration {}", count(row));
            RobotStep {
                text: format!("{name}: {text}{more}"),
                name,
                verdict,
                collision: found[row].first().copied(),
                configuration: values[row * columns..(row + 1) * columns].to_vec(),
            }
        })
        .collect();
    let heading = match hits {
        0 => format!("All of {} are free", counted(found.len(), "configuration")),
        _ => format!("{} of {} collide", count(hits), counted(found.len(), "configuration")),
    };
    let mut rows = Vec::new();
    if steps.len() < if hits == 0 { found.len() } else { hits } {
        rows.push(["shown".to_owned(), format!("the first {}", counted(steps.len(), "configuration"))]);
    }
    write(path, loaded, &steps, "Configuration", heading, rows)
}

/// Writes a page with a slider along a path.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn of_path(path: &Path, loaded: &Loaded, values: &[f64], legs: &[MotionCheck]) -> Result<(), Failure> {
    let columns = loaded.robot().coordinates().len();
    let pieces = (MAX_STEPS / legs.len()).max(1);
    let mut steps = Vec::new();
    let mut rows = Vec::new();
    for (at, leg) in legs.iter().enumerate().take(MAX_STEPS) {
        let ends = &values[at * columns..(at + 2) * columns];
        let mut times: Vec<(f64, bool)> = (0..=pieces).map(|piece| (piece as f64 / pieces as f64, false)).collect();
        if at > 0 {
            times.remove(0); // it is the end of the leg before
        }
        times.extend(leg.hit_at.map(|time| (time, true)));
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        steps.extend(times.into_iter().map(|(time, is_hit)| step(loaded, at, leg, ends, time, is_hit)));
        if leg.verdict != robot::Verdict::Free {
            let pair = leg
                .collision
                .map_or("nothing is proved after that".to_owned(), |collision| collision_text(loaded, &collision));
            rows.push([format!("leg {}", count(at)), format!("proved free until {:.9}; {pair}", leg.free_until)]);
        }
    }
    if legs.len() > MAX_STEPS {
        rows.push(["shown".to_owned(), format!("the first {}", counted(MAX_STEPS, "leg"))]);
    }
    let free = legs.iter().filter(|leg| leg.verdict == robot::Verdict::Free).count();
    let heading = if free == legs.len() {
        format!("The path is free: {} proved", counted(legs.len(), "leg"))
    } else {
        format!("{} of {} proved free", count(free), counted(legs.len(), "leg"))
    };
    write(path, loaded, &steps, "Path", heading, rows)
}

/// Returns a step at a time of a leg, which goes from the first half of `ends` to the second.
fn step(loaded: &Loaded, at: usize, leg: &MotionCheck, ends: &[f64], time: f64, is_hit: bool) -> RobotStep {
    let (start, end) = ends.split_at(ends.len() / 2);
    let between = || start.iter().zip(end).map(|(a, b)| (1.0 - time) * a + time * b).collect();
    let name = format!("leg {}, {:.1} %", count(at), 100.0 * time);
    let (verdict, text) = match leg.collision.filter(|_| is_hit) {
        Some(collision) => (StepVerdict::Collides, collision_text(loaded, &collision)),
        None if leg.verdict == robot::Verdict::Free || time < leg.free_until => {
            (StepVerdict::Free, "proved free".to_owned())
        }
        None => (StepVerdict::Open, "not proved, because it is after the part that is free".to_owned()),
    };
    RobotStep {
        text: format!("{name}: {text}"),
        name,
        verdict,
        collision: leg.collision.filter(|_| is_hit),
        configuration: leg.hit.clone().filter(|_| is_hit).unwrap_or_else(between),
    }
}

fn collision_text(loaded: &Loaded, collision: &Collision) -> String {
    let [link, other] = loaded.names_of(collision);
    let verb = if collision.is_undecided { "may collide" } else { "collide" };
    format!("{link} and {other} {verb}")
}

fn write(
    path: &Path,
    loaded: &Loaded,
    steps: &[RobotStep],
    slider: &str,
    heading: String,
    rows: Vec<[String; 2]>,
) -> Result<(), Failure> {
    let about = PageAbout {
        title: loaded.robot.name.clone(),
        heading,
        rows,
        unit: Some(Unit::Meter),
        up: Axis::Z,
        version: env!("CARGO_PKG_VERSION"),
    };
    let page = RobotPage { robot: loaded.robot(), obstacles: loaded.scene.as_ref(), steps, slider };
    output::write(path, |out| write_robot_page(out, &page, &about))
}
