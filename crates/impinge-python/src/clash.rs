//! Clash detection over scenes. The answer is the JSON and the CSV report, and what they lack.

use std::sync::Arc;

use impinge::Budget;
use impinge::clash::{
    ClashError, Counts, Grouping, Job, Options, Previous, Report, Shared, Side, default_tolerance, find,
};
use impinge::query::batch::Execution;
use impinge::scene::{Details, Scene, SceneError};
use impinge_files::{
    Asked, Length, Limits, LoadError, ReportAbout, RulesFile, RulesFormat, SceneAbout, Unit, length_text,
    load_previous, load_rules, parse_previous, parse_rules, write_clash_csv, write_clash_json,
};
use impinge_report::bcf::{BcfError, is_bcf, load_previous_bcf};
use impinge_report::picture::Axis;
use pyo3::prelude::*;

use crate::clash_files::ClashFiles;
use crate::errors::{Fault, content_error, error_at, load_error};
use crate::model::unit_of;
use crate::pictures::axis;
use crate::poses;
use crate::question::Progress;
use crate::scene::Ignored;
use crate::shapes::read_shape;
use crate::workers::{self, Call};

/// Version of the package, which reports state.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A part as Python passes it: its name, its mesh or shape, its pose, and its key, type and path.
pub(crate) type Part<'py> = (String, Bound<'py, PyAny>, Bound<'py, PyAny>, (String, String, Vec<String>));

/// A scene as Python passes it: its label, its parts, and pairs of indices of parts that are
/// ignored.
pub(crate) type Labeled<'py> = (String, Vec<Part<'py>>, Ignored<'py>);

/// A length as Python passes it: in the unit of the scenes, or a text that may have a unit.
#[derive(FromPyObject)]
pub(crate) enum LengthOption {
    Number(f64),
    Text(String),
}

/// A file as Python passes it.
#[derive(FromPyObject)]
pub(crate) enum Source {
    /// The path of a file.
    Path(String),
    /// The content of a file, in a list of one text.
    Content([String; 1]),
}

/// A question as Python passes it: the scenes, their unit and the axis that points up, and so on.
pub(crate) type Question<'py> = (Vec<Labeled<'py>>, (Option<String>, String), Lengths, Flags, Files);

/// The tolerance and the clearance.
type Lengths = (Option<LengthOption>, Option<LengthOption>);

/// Whether only parts of different scenes are compared, whether contacts are listed, whether
/// volumes are computed, and whether curves are traced.
type Flags = (bool, bool, bool, bool);

/// The rules and the previous report.
type Files = (Option<Source>, Option<Source>);

/// A question about some scenes.
pub(crate) struct Search {
    pub(crate) scenes: Vec<(String, Scene)>,
    pub(crate) unit: Option<Unit>,
    /// The axis that points up.
    pub(crate) up: Axis,
    tolerance: Option<f64>,
    /// The question. Its tolerance is that of the option or of the rules, if there is one.
    asked: Asked,
    rules: Option<RulesFile>,
    previous: Option<Previous>,
}

/// The answer, as Python keeps it.
#[derive(IntoPyObject)]
pub(crate) struct Found {
    json: String,
    csv: String,
    /// Number of pairs of each kind.
    counts: Vec<(&'static str, usize)>,
    /// A sentence about each clash.
    sentences: Vec<String>,
    /// Groups by part, by type and by scene.
    groups: Vec<(&'static str, Vec<GroupRow>)>,
    files: ClashFiles,
}

/// A group: the names that its clashes share, the indices of the clashes, and a sentence.
type GroupRow = (Vec<String>, Vec<usize>, String);

/// Finds the clashes of some scenes, which have a unit and an axis that points up.
#[pyfunction]
pub(crate) fn clash<'py>(py: Python<'py>, question: Question<'py>, progress: Progress) -> PyResult<Bound<'py, PyAny>> {
    let Progress(progress) = progress;
    let search = Arc::new(Search::read(py, question)?);
    let rows = if progress { count(py, &search)? } else { 0 };
    let asking = Arc::clone(&search);
    let work = move |execution: Execution<'_>| match found(&asking, execution) {
        Err(ClashError::Stopped(stopped)) => Err(stopped),
        found => Ok(found),
    };
    let call = Call { rows, is_brief: false, progress };
    let (found, stopped) = workers::execute(py, call, work)?;
    let found = found.map_err(|error| search.raised(py, error))?;
    match stopped {
        Some(stopped) => Err(crate::limits::raised(stopped)),
        None => Ok(found.into_pyobject(py)?.into_any()),
    }
}

/// Returns the number of pairs that the search compares.
fn count(py: Python<'_>, search: &Arc<Search>) -> PyResult<usize> {
    let asking = Arc::clone(search);
    let counted = workers::run(py, move |budget| asking.candidates(budget))?;
    counted.map_err(|error| search.raised(py, error))
}

fn scene(py: Python<'_>, (label, parts, ignored): Labeled<'_>) -> PyResult<(String, Scene)> {
    let mut scene = scene_of(py, parts)?;
    ignored.apply(&mut scene)?;
    Ok((label, scene))
}

/// Returns a scene of parts.
pub(crate) fn scene_of(py: Python<'_>, parts: Vec<Part<'_>>) -> PyResult<Scene> {
    let mut scene = Scene::new();
    for (name, thing, given, (key, kind, path)) in parts {
        let argument = format!("poses[{name:?}]");
        let pose = poses::read_one(&given, &argument, "a part has one pose, (4, 4)")?;
        let added = scene.add(name.clone(), &read_shape(&thing, &name, true)?.shape, pose);
        let part = added.map_err(|error| match error {
            SceneError::Pose { error, .. } => poses::fault(&error, &argument, Vec::new()).raised(py),
            _ => Fault::new("name", "scenes", error.to_string()).raised(py),
        })?;
        scene.set_details(part, Details { key, kind, path, extras: Vec::new() });
    }
    Ok(scene)
}

fn read_length(py: Python<'_>, option: Option<LengthOption>, name: &str, unit: Option<Unit>) -> PyResult<Option<f64>> {
    let text = match option {
        None => return Ok(None),
        Some(LengthOption::Number(number)) => return Ok(Some(number)),
        Some(LengthOption::Text(text)) => text,
    };
    let invalid = |kind, message: String| Fault::new(kind, name, message);
    let length: Length = text.parse().map_err(|error| invalid("option", format!("{text:?}: {error}")).raised(py))?;
    let in_unit = length.in_unit(unit).ok_or_else(|| {
        let message = format!("{length} has a unit, but the scenes state none");
        invalid("unit", message).hint(Some("pass unit= to load_scene, or a number")).raised(py)
    });
    in_unit.map(Some)
}

fn read_rules(py: Python<'_>, source: &Source, unit: Option<Unit>) -> PyResult<RulesFile> {
    match source {
        Source::Path(path) => load_rules(path, unit, &Limits::default()).map_err(|error| load_error(py, &error)),
        Source::Content([text]) => {
            let rules = parse_rules(text.as_bytes(), RulesFormat::Toml, unit);
            rules.map_err(|error| content_error(py, "rules", &error))
        }
    }
}

fn read_previous(py: Python<'_>, source: &Source, unit: Option<Unit>) -> PyResult<Previous> {
    let content = |error: LoadError| content_error(py, "previous", &error);
    match source {
        Source::Path(path) if is_bcf(path) => {
            let unit = unit.ok_or_else(|| no_unit(py))?;
            load_previous_bcf(path, unit).map_err(|error| match error {
                BcfError::Io(error) => std::io::Error::new(error.kind(), format!("{path}: {error}")).into(),
                invalid => error_at(py, "bcf", path, None, &invalid.to_string(), None),
            })
        }
        Source::Path(path) => load_previous(path, unit, &Limits::default()).map_err(|error| load_error(py, &error)),
        Source::Content([text]) => parse_previous(text.as_bytes(), unit).map_err(content),
    }
}

/// Returns the exception for scenes without a unit, of which BCF files need one.
pub(crate) fn no_unit(py: Python<'_>) -> PyErr {
    let fault = Fault::new("unit", "scenes", "state no unit, and BCF is in meters");
    fault.hint(Some("pass unit= to load_scene")).raised(py)
}

impl Search {
    /// Reads the question.
    pub(crate) fn read<'py>(py: Python<'py>, question: Question<'py>) -> PyResult<Self> {
        let (scenes, (unit, up), (tolerance, clearance), (between, contacts, volume, curves), (rules, previous)) =
            question;
        let unit = unit_of(py, unit.as_deref())?;
        let scenes = scenes.into_iter().map(|labeled| scene(py, labeled)).collect::<PyResult<Vec<_>>>()?;
        let path = |source: &Option<Source>| match source {
            Some(Source::Path(path)) => Some(path.clone()),
            _ => None,
        };
        let stated = [path(&rules), path(&previous)];
        let rules = rules.map(|source| read_rules(py, &source, unit)).transpose()?;
        let previous = previous.map(|source| read_previous(py, &source, unit)).transpose()?;
        let of_rules = |length: fn(&RulesFile) -> Option<f64>| rules.as_ref().and_then(length);
        let tolerance = read_length(py, tolerance, "tolerance", unit)?.or(of_rules(|rules| rules.tolerance));
        let clearance = read_length(py, clearance, "clearance", unit)?.or(of_rules(|rules| rules.clearance));
        let [rules_path, previous_path] = stated;
        let asked = Asked {
            default_tolerance: tolerance.is_none(),
            clearance,
            contacts,
            volume,
            curves,
            between,
            rules: rules_path,
            previous: previous_path,
            ..Asked::default()
        };
        Ok(Self { scenes, unit, up: axis(&up), tolerance, asked, rules, previous })
    }

    pub(crate) fn sides(&self) -> Vec<Side<'_>> {
        self.scenes.iter().map(|(label, scene)| Side { label: label.clone(), scene }).collect()
    }

    pub(crate) fn options(&self, sides: &[Side<'_>]) -> Options<'_> {
        let tolerance = self.tolerance.unwrap_or_else(|| default_tolerance(sides, self.unit.map(Unit::meters)));
        let Asked { clearance, contacts, volume, between, .. } = self.asked;
        let rules = self.rules.as_ref().map(|file| &file.rules);
        Options {
            clearance,
            contacts,
            volume,
            between,
            rules,
            previous: self.previous.as_ref(),
            ..Options::new(tolerance)
        }
    }

    fn candidates(&self, budget: &Budget<'_>) -> Result<usize, ClashError> {
        let sides = self.sides();
        Ok(Job::new(&sides, self.options(&sides), budget)?.candidates())
    }

    pub(crate) fn about(&self, sides: &[Side<'_>]) -> ReportAbout<'_> {
        let options = self.options(sides);
        let scene = |(label, scene): &(String, Scene)| SceneAbout {
            unit: self.unit.map(Unit::symbol),
            ..SceneAbout::new(label, scene)
        };
        ReportAbout {
            unit: self.unit,
            scenes: self.scenes.iter().map(scene).collect(),
            asked: Asked { tolerance: options.tolerance, ..self.asked.clone() },
            rules: options.rules,
        }
    }

    pub(crate) fn raised(&self, py: Python<'_>, error: ClashError) -> PyErr {
        let fault = |kind, argument: &str| Fault::new(kind, argument, error.to_string()).raised(py);
        let in_rules = |kind: &str, line: Option<u64>| {
            let what = self.asked.rules.as_deref().unwrap_or("rules");
            error_at(py, kind, what, line.map(|line| format!("line {line}")), &error.to_string(), None)
        };
        match &error {
            ClashError::Label { .. } => fault("name", "scenes"),
            ClashError::Length { name, .. } => fault("out-of-range", name),
            ClashError::UnknownSet { .. } => in_rules("name", None),
            ClashError::EmptySet { set, .. } => {
                in_rules("empty", self.rules.as_ref().and_then(|rules| rules.line_of_set(set)))
            }
            ClashError::Part { error, .. } => poses::fault(error, "scenes", Vec::new()).raised(py),
            ClashError::Stopped(stopped) => crate::limits::raised(*stopped),
            _ => fault("input", "scenes"),
        }
    }
}

fn found(search: &Arc<Search>, execution: Execution<'_>) -> Result<Found, ClashError> {
    let sides = search.sides();
    let report = find(&sides, search.options(&sides), execution)?;
    written(search, report, execution.budget())
}

/// Returns the answer with a report, whose curves are traced first if they were asked for.
pub(crate) fn written(search: &Arc<Search>, mut report: Report, budget: &Budget<'_>) -> Result<Found, ClashError> {
    let sides = search.sides();
    if search.asked.curves {
        report.trace_curves(&sides, Execution::default().with_budget(budget))?;
    }
    let about = search.about(&sides);
    let (mut json, mut csv) = (Vec::new(), Vec::new());
    // Writing to a list of bytes cannot fail, and both reports are UTF-8.
    let _ = write_clash_json(&mut json, &report, &about, VERSION);
    let _ = write_clash_csv(&mut csv, &report, &about);
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    let length = |x: f64| length_text(x, search.unit);
    let groups = [("part", Grouping::Part), ("type", Grouping::Type), ("scene", Grouping::Scene)];
    Ok(Found {
        json: text(json),
        csv: text(csv),
        counts: counts(&report.counts),
        sentences: report.clashes.iter().map(|clash| clash.sentence(&length)).collect(),
        groups: groups.map(|(name, grouping)| (name, group_rows(&report, grouping, &length))).into(),
        files: ClashFiles::new(search, report),
    })
}

fn counts(counts: &Counts) -> Vec<(&'static str, usize)> {
    let Counts { candidates, unchecked, ignored, duplicate, contained, clash, undecided, contact, clearance, clear } =
        *counts;
    vec![
        ("candidates", candidates),
        ("unchecked", unchecked),
        ("ignored", ignored),
        ("duplicate", duplicate),
        ("contained", contained),
        ("clash", clash),
        ("undecided", undecided),
        ("contact", contact),
        ("clearance", clearance),
        ("clear", clear),
    ]
}

fn group_rows(report: &Report, grouping: Grouping, length: &dyn Fn(f64) -> String) -> Vec<GroupRow> {
    let row = |group: impinge::clash::Group| {
        let sentence = group.sentence(report, length);
        let shared = match group.by {
            Shared::Part(member) => vec![member.identity()],
            Shared::Types(pair) | Shared::Scenes(pair) => pair.into(),
        };
        (shared, group.clashes, sentence)
    };
    report.grouped(grouping).into_iter().map(row).collect()
}
