//! `impinge clash`: finds the parts of scenes that run into each other.

mod choices;
mod handover;
mod notes;
mod report;
mod scenes;

use std::path::{Path, PathBuf};

use clap::Args;
use impinge::clash::{Accept, ClashError, Job, Options, Previous, Report, Rules, Side, default_tolerance};
use impinge::query::batch::Execution;
use impinge_files::{
    Asked, Length, Limits, ReportAbout, RulesFile, RulesFormat, SceneAbout, Unit, load_rules, write_clash_csv,
    write_clash_json,
};
use impinge_report::bcf::is_bcf;
use impinge_report::html::write_clash_page;

use crate::axis::Axis;
use crate::check::timed;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{Verdict, console, output};
use choices::{BcfVersionArgument, GroupingArgument};
use handover::HandedOver;
use scenes::Loaded;

/// Maximum value of `--threads`: more than any machine has processors. The answer does not depend
/// on the number of threads.
const MAX_THREADS: i64 = 1024;

/// Version of the program, which reports state.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Find the parts of scenes that clash, and how deep
///
/// Parts are solids. Each pair of parts is a duplicate, contained, a clash (it shares material
/// deeper than the tolerance), a contact, within the clearance, or clear. Lengths may have a unit:
/// um, mm, cm, in, ft or m, as in 25mm or 1/2in. Without a unit they are in the unit of the scenes.
///
/// Exit code: 0 if all parts are clear or each clash is approved, 1 if there are clashes, 2 if
/// there is no answer.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenes: glTF, GLB or any format of meshes with parts, each optionally with a label before it
    ///
    /// The label names the scene in the report and belongs to the identity of each clash. By
    /// default it is the name of the file without its extension.
    #[arg(required = true, value_name = "[LABEL=]SCENE")]
    scenes: Vec<String>,
    /// Compare only parts of different scenes
    #[arg(long)]
    between: bool,
    /// Depth up to which parts may overlap, unless their rule has a tolerance of its own
    ///
    /// By default it is 0.1 mm, or a millionth of the size of the scenes if they state no unit. It
    /// is at least 16 units in the last place of the largest f32 coordinate.
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    tolerance: Option<Length>,
    /// Report also pairs of parts whose gap is at most D
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    clearance: Option<Length>,
    /// List pairs of parts that touch, too
    #[arg(long)]
    contacts: bool,
    /// Compute the volume of the material that two parts share, for --json and --csv
    #[arg(long)]
    volume: bool,
    /// Trace the curves in which the surfaces of two parts intersect, for --json
    #[arg(long, requires = "json")]
    curves: bool,
    /// Sets, rules, ignores and accepted clashes in a .toml file, a .csv matrix of groups, or the
    /// .json clash sets of IfcClash
    #[arg(long, value_name = "RULES")]
    rules: Option<PathBuf>,
    /// A report that --json or --bcf wrote before: statuses carry over from it, and what is gone is
    /// listed
    #[arg(long, value_name = "OLD")]
    previous: Option<PathBuf>,
    /// Accepted clashes, as [[accept]] tables in a .toml file
    #[arg(long, value_name = "A.toml")]
    accept: Option<PathBuf>,
    /// How to group clashes
    #[arg(long, value_name = "BY", default_value = "part")]
    group: GroupingArgument,
    /// Move the middle of all scenes to the origin before coordinates are rounded
    ///
    /// Models far from the origin, as in UTM coordinates, then keep their precision.
    #[arg(long)]
    shift: bool,
    /// Unit of the report: um, mm, cm, in, ft or m; files that state no unit are taken to be in it
    #[arg(long, value_name = "U")]
    unit: Option<Unit>,
    /// Unit of the numbers in the files, in place of the one that they state: um, mm, cm, in, ft or
    /// m
    ///
    /// For example `mm` for a glTF file in millimeters, although glTF is in meters.
    #[arg(long, value_name = "U")]
    file_unit: Option<Unit>,
    /// Repair open parts: turn faces so that neighbors agree, and weld vertices
    ///
    /// Many parts are closed then. The inside of a closed part is certain, so its depths are
    /// proved, and the search takes less time. Vertices move by at most a millionth of the size of
    /// their part. No hole is filled.
    #[arg(long)]
    repair: bool,
    /// Chordal error of tessellated surfaces, which is added to each tolerance twice, once for each
    /// part
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    sag: Option<Length>,
    /// JSON file with keys, types and names of nodes, for all scenes or for the one with the label
    #[arg(long, value_name = "[LABEL=]N.json")]
    names: Vec<String>,
    /// Print one JSON object instead of the report, or write it to a file
    #[arg(long, value_name = "OUT", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// Write one row a clash to a .csv file
    #[arg(long, value_name = "OUT")]
    csv: Option<PathBuf>,
    /// Write a page for a browser to an .html file: the list of clashes and the parts in 3D
    ///
    /// The page needs no other file and no network.
    #[arg(long, value_name = "OUT")]
    view: Option<PathBuf>,
    /// Write a picture of the worst clash of each group to a folder, as ID.png; at most 100
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Write one topic for each group to a .bcfzip file, with a viewpoint and a picture
    #[arg(long, value_name = "OUT")]
    bcf: Option<PathBuf>,
    /// Version of the BCF file
    #[arg(long, value_name = "V", default_value = "2.1", requires = "bcf")]
    bcf_version: BcfVersionArgument,
    /// Axis of the scenes that points up in the page, pictures and BCF; y for glTF and z for other
    /// files by default
    #[arg(long, value_name = "AXIS")]
    up: Option<Axis>,
    /// Number of threads to use; all processors by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    threads: Option<u16>,
}

/// All results of a search.
struct Outcome<'r> {
    about: ReportAbout<'r>,
    report: Report,
    handed_over: HandedOver,
    seconds: Seconds,
}

/// Duration of each phase, in seconds.
#[derive(Clone, Copy, Default)]
struct Seconds {
    load: f64,
    search: f64,
    /// Duration of drawing pictures and BCF files, which have pictures.
    draw: Option<f64>,
}

/// Finds the clashes, prints the report and writes the requested files.
///
/// # Errors
/// Returns an error if there is no answer, or it cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    arguments.validate_outputs()?;
    match arguments.threads {
        None => answer(arguments),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|error| Failure::new("threads", format!("cannot start {threads} threads: {error}")))?
            .install(|| answer(arguments)),
    }
}

fn answer(arguments: &Arguments) -> Result<Verdict, Failure> {
    let (loaded, load) = timed("loading", || scenes::load(arguments));
    let loaded = loaded?;
    let unit = loaded.iter().find_map(|scene| scene.unit);
    let limits = Limits::default();
    let rules_file = match &arguments.rules {
        Some(path) => Some(load_rules(path, unit, &limits)?),
        None => None,
    };
    let previous = match &arguments.previous {
        Some(path) => Some(handover::previous(path, unit, &limits)?),
        None => None,
    };
    let accepts = match &arguments.accept {
        Some(path) => load_rules(path, unit, &limits)?.rules.accepts,
        None => Vec::new(),
    };
    let sides: Vec<Side<'_>> =
        loaded.iter().map(|Loaded { label, scene, .. }| Side { label: label.clone(), scene }).collect();
    let asked = arguments.asked(&sides, unit, rules_file.as_ref())?;
    let rules = arguments.with_sag(rules_file.as_ref(), &asked, accepts);
    let (report, search) = timed_search(&sides, &options(arguments, &asked, rules.as_ref(), previous.as_ref()));
    let mut report = report.map_err(|error| failure(&error, arguments, rules_file.as_ref()))?;
    if arguments.curves {
        let bar = Bar::begin("tracing curves", report.clashes.len() as u64);
        let advance = |rows: usize| bar.advance_by(rows as u64);
        let traced = report.trace_curves(&sides, Execution::default().with_progress(&advance));
        traced.map_err(|error| Failure::new("memory", error.to_string()))?;
    }
    previous.iter().for_each(|previous| notes::on_previous(previous, &asked, unit));
    rules.iter().for_each(|rules| notes::on_accepts(rules, &report));
    let scenes = loaded.iter().map(Loaded::about).collect();
    let stated = rules.as_ref().filter(|_| rules_file.is_some());
    let about = ReportAbout { unit, scenes, asked, rules: stated };
    let start = std::time::Instant::now();
    let handed_over = handover::write(arguments, &loaded, &sides, &report, &about)?;
    let draw = handed_over.is_any().then(|| start.elapsed().as_secs_f64());
    let outcome = Outcome { about, report, handed_over, seconds: Seconds { load, search, draw } };
    if let Some(path) = &arguments.view {
        let Outcome { about, report, .. } = &outcome;
        let up = handover::up(arguments, &loaded);
        output::write(path, |out| write_clash_page(out, &sides, report, about, up, VERSION))?;
    }
    outcome.write(arguments)?;
    Ok(if outcome.report.is_clear() { Verdict::Clear } else { Verdict::Collision })
}

fn options<'o>(
    arguments: &Arguments,
    asked: &Asked,
    rules: Option<&'o Rules>,
    previous: Option<&'o Previous>,
) -> Options<'o> {
    Options {
        tolerance: asked.tolerance + 2.0 * asked.sag.unwrap_or(0.0),
        clearance: asked.clearance,
        contacts: arguments.contacts,
        volume: arguments.volume,
        between: arguments.between,
        rules,
        previous,
        grouping: arguments.group.into(),
    }
}

/// Searches with a progress bar, and returns the report with the duration in seconds.
fn timed_search(sides: &[Side<'_>], options: &Options<'_>) -> (Result<Report, ClashError>, f64) {
    let start = std::time::Instant::now();
    let search = || {
        let job = Job::new(sides, *options, Execution::default().budget())?;
        let bar = Bar::begin("comparing pairs", job.candidates() as u64);
        let advance = |rows: usize| bar.advance_by(rows as u64);
        let findings = job.classify(0..job.candidates(), Execution::default().with_progress(&advance))?;
        Ok(job.report(findings, None))
    };
    (search(), start.elapsed().as_secs_f64())
}

fn failure(error: &ClashError, arguments: &Arguments, rules: Option<&RulesFile>) -> Failure {
    let in_rules = |set: Option<&str>| {
        let failure = Failure::new("rules", error.to_string());
        let failure = arguments.rules.iter().fold(failure, |failure, path| failure.in_file(path));
        let line = set.and_then(|set| rules?.line_of_set(set));
        line.into_iter().fold(failure, |failure, line| failure.at(format!("line {line}")))
    };
    match error {
        ClashError::Label { .. } => Failure::new("label", error.to_string()).hint("write LABEL=SCENE, as in old=a.glb"),
        ClashError::UnknownSet { .. } => in_rules(None),
        ClashError::EmptySet { set, .. } => in_rules(Some(set))
            .hint("correct the patterns of the set, or remove the rule if the model has no such parts"),
        ClashError::Stopped(_) => Failure::new("memory", error.to_string()),
        _ => Failure::new("input", error.to_string()),
    }
}

impl Arguments {
    /// Reports whether the JSON object replaces the report on standard output.
    fn prints_json(&self) -> bool {
        self.json.as_deref() == Some(Path::new("-"))
    }

    fn json_file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|&path| path != Path::new("-"))
    }

    /// Validates the names of the output files, before any work.
    fn validate_outputs(&self) -> Result<(), Failure> {
        if self.between && self.scenes.len() < 2 {
            let failure =
                Failure::new("option", "--between compares parts of different scenes, and there is one scene");
            return Err(failure.hint("name two scenes or more, or leave out --between"));
        }
        if let Some(path) = self.csv.as_deref().filter(|path| output::extension(path) != "csv") {
            return Err(output::unknown_extension(path, ".csv"));
        }
        if let Some(path) = self.json_file().filter(|path| output::extension(path) != "json") {
            return Err(output::unknown_extension(path, ".json"));
        }
        if let Some(path) = self.view.as_deref().filter(|path| output::extension(path) != "html") {
            return Err(output::unknown_extension(path, ".html"));
        }
        if let Some(path) = self.bcf.as_deref().filter(|path| !is_bcf(path)) {
            return Err(output::unknown_extension(path, ".bcfzip or .bcf"));
        }
        if let Some(path) = &self.pictures {
            handover::validate_folder(path)?;
        }
        if let Some(path) = self.accept.as_deref().filter(|path| output::extension(path) != "toml") {
            return Err(Failure::new("rules", "accepted clashes are in a .toml file").in_file(path));
        }
        if let Some(path) = &self.rules
            && RulesFormat::from_extension(&output::extension(path)).is_none()
        {
            return Err(Failure::new("rules", "rules are in a .toml, .csv or .json file").in_file(path));
        }
        // A previous report may be replaced by the new one.
        let scenes: Vec<PathBuf> = self.scenes.iter().map(|argument| scenes::split(argument).1).collect();
        let inputs: Vec<&Path> = scenes.iter().chain(&self.rules).chain(&self.accept).map(PathBuf::as_path).collect();
        [self.json_file(), self.csv.as_deref(), self.view.as_deref(), self.bcf.as_deref()]
            .into_iter()
            .flatten()
            .try_for_each(|path| output::validate(path, &inputs))
    }

    /// Returns the question, with lengths in the unit of the scenes.
    fn asked(&self, sides: &[Side<'_>], unit: Option<Unit>, rules: Option<&RulesFile>) -> Result<Asked, Failure> {
        let length = |length: Option<Length>, option: &str| {
            let converted = length.map(|length| {
                length.in_unit(unit).ok_or_else(|| {
                    let message = format!("{length} has a unit, but the scenes state none");
                    Failure::new("unit", message).at(option).hint("state the unit of the scenes with --unit")
                })
            });
            converted.transpose()
        };
        let stated = length(self.tolerance, "--tolerance")?.or(rules.and_then(|rules| rules.tolerance));
        Ok(Asked {
            tolerance: stated.unwrap_or_else(|| default_tolerance(sides, unit.map(Unit::meters))),
            default_tolerance: stated.is_none(),
            clearance: length(self.clearance, "--clearance")?.or(rules.and_then(|rules| rules.clearance)),
            sag: length(self.sag, "--sag")?,
            contacts: self.contacts,
            volume: self.volume,
            curves: self.curves,
            between: self.between,
            rules: path_text(self.rules.as_deref()),
            previous: path_text(self.previous.as_deref()),
            accept: path_text(self.accept.as_deref()),
        })
    }

    /// Returns the rules with the sag in their tolerances, and with all accepted clashes, or
    /// `None` without rules and accepted clashes.
    fn with_sag(&self, file: Option<&RulesFile>, asked: &Asked, accepts: Vec<Accept>) -> Option<Rules> {
        if file.is_none() && accepts.is_empty() {
            return None;
        }
        let mut rules = file.map_or_else(Rules::default, |file| file.rules.clone());
        for tolerance in rules.rules.iter_mut().filter_map(|rule| rule.tolerance.as_mut()) {
            *tolerance += 2.0 * asked.sag.unwrap_or(0.0);
        }
        rules.accepts.extend(accepts);
        Some(rules)
    }
}

fn path_text(path: Option<&Path>) -> Option<String> {
    path.map(|path| path.display().to_string())
}

impl Outcome<'_> {
    /// Prints the report or the JSON object, and writes the requested files.
    fn write(&self, arguments: &Arguments) -> Result<(), Failure> {
        let Self { about, report, .. } = self;
        if let Some(path) = arguments.json_file() {
            output::write(path, |out| write_clash_json(out, report, about, VERSION))?;
        }
        if let Some(path) = &arguments.csv {
            output::write(path, |out| write_clash_csv(out, report, about))?;
        }
        if arguments.prints_json() {
            let mut object = Vec::new();
            // Writing to a list of bytes cannot fail, and JSON is UTF-8.
            let _ = write_clash_json(&mut object, report, about, VERSION);
            return console::print_answer(&String::from_utf8_lossy(&object));
        }
        console::print_answer(&report::text(self))
    }

    fn scenes(&self) -> &[SceneAbout] {
        &self.about.scenes
    }
}
