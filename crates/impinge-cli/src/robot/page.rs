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

/// Maximum number of steps of a slider, and of the contacts that it has beside them. More steps are
/// closer than pixels, and each takes about 50 bytes for each link.
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

/// Writes a page with a slider along a path: steps at equal distances, and the contacts.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(super) fn of_path(path: &Path, loaded: &Loaded, values: &[f64], legs: &[MotionCheck]) -> Result<(), Failure> {
    let columns = loaded.robot().coordinates().len();
    let spacing = Spacing::new(legs.len());
    let ends = |leg: usize| &values[leg * columns..(leg + 2) * columns];
    let steps: Vec<RobotStep> =
        spacing.places(legs).iter().map(|place| step(loaded, place, &legs[place.leg], ends(place.leg))).collect();
    let caught = legs.iter().enumerate().filter(|(_, leg)| leg.verdict != robot::Verdict::Free);
    let all = caught.clone().count();
    let mut rows = vec![["slider".to_owned(), spacing.in_words()]];
    rows.extend(caught.take(MAX_STEPS).map(|(at, leg)| {
        let after = match &leg.collision {
            Some(collision) => collision_text(loaded, collision),
            None => "nothing is proved after that".to_owned(),
        };
        [format!("leg {}", count(at)), format!("proved free until {:.9}; {after}", leg.free_until)]
    }));
    if all > MAX_STEPS {
        rows.push(["listed".to_owned(), format!("the first {} that are not free", counted(MAX_STEPS, "leg"))]);
    }
    let heading = if all == 0 {
        format!("The path is free: {} proved", counted(legs.len(), "leg"))
    } else {
        format!("{} of {} proved free", count(legs.len() - all), counted(legs.len(), "leg"))
    };
    write(path, loaded, &steps, "Path", heading, rows)
}

/// Distances of the steps of a slider along a path.
#[derive(Clone, Copy, Debug)]
struct Spacing {
    /// Number of steps of a leg.
    pieces: usize,
    /// Number of legs from one with steps to the next.
    stride: usize,
}

/// A place on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    leg: usize,
    /// Time from 0 at the start of the leg to 1 at its end.
    time: f64,
    is_contact: bool,
}

impl Spacing {
    /// Chooses at most [`MAX_STEPS`] steps for a number of legs.
    fn new(legs: usize) -> Self {
        Self { pieces: (MAX_STEPS / legs).max(1), stride: legs.div_ceil(MAX_STEPS) }
    }

    /// Returns the places of the steps, of the end of the path and of the first contacts, in their
    /// order on the path.
    fn places(self, legs: &[MotionCheck]) -> Vec<Place> {
        let mut places = Vec::new();
        let mut contacts = 0;
        for (leg, check) in legs.iter().enumerate() {
            let first = places.len();
            let mut add = |time, is_contact| places.push(Place { leg, time, is_contact });
            if leg % self.stride == 0 {
                (0..self.pieces).for_each(|piece| add(piece as f64 / self.pieces as f64, false));
            }
            if leg + 1 == legs.len() {
                add(1.0, false);
            }
            if let Some(time) = check.hit_at.filter(|_| contacts < MAX_STEPS) {
                contacts += 1;
                add(time, true);
            }
            places[first..].sort_by(|a, b| a.time.total_cmp(&b.time));
        }
        places
    }

    fn in_words(self) -> String {
        let legs =
            if self.stride == 1 { "each leg".to_owned() } else { format!("every {}", counted(self.stride, "leg")) };
        format!("{} for {legs}; the proof is about all times between them, too", counted(self.pieces, "step"))
    }
}

/// Returns a step at a place of a leg, which goes from the first half of `ends` to the second.
fn step(loaded: &Loaded, place: &Place, leg: &MotionCheck, ends: &[f64]) -> RobotStep {
    let &Place { leg: at, time, is_contact: is_hit } = place;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn leg(hit_at: Option<f64>) -> MotionCheck {
        let verdict = if hit_at.is_some() { robot::Verdict::Collides } else { robot::Verdict::Free };
        MotionCheck {
            verdict,
            free_until: hit_at.unwrap_or(1.0),
            hit_at,
            collision: None,
            hit: None,
            certificate: None,
        }
    }

    #[test]
    fn a_slider_has_few_steps_on_paths_of_any_length() {
        for legs in [1, 2, 7, 239, 240, 241, 5000] {
            let spacing = Spacing::new(legs);
            let checks: Vec<MotionCheck> = (0..legs).map(|at| leg((at % 3 == 1).then_some(0.501))).collect();
            let places = spacing.places(&checks);
            let contacts = places.iter().filter(|place| place.is_contact).count();
            assert_eq!(contacts, checks.iter().filter(|leg| leg.hit_at.is_some()).count().min(MAX_STEPS));
            let steps = places.len() - contacts;
            assert!((MAX_STEPS / 2..=MAX_STEPS + 1).contains(&steps), "{legs} legs have {steps} steps");
            let times: Vec<f64> = places.iter().map(|place| place.leg as f64 + place.time).collect();
            assert!(times.is_sorted() && times[0] == 0.0 && times[times.len() - 1] == legs as f64);
        }
        assert!(Spacing::new(3).in_words().starts_with("80 steps for each leg;"));
        assert!(Spacing::new(500).in_words().starts_with("1 step for every 3 legs;"));
    }
}
