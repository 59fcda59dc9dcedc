//! Motions of robots with proofs, and clearances of configurations.

use std::sync::Arc;

use impinge::query::batch::Execution;
use impinge::robot::{
    AuditOptions, AuditedPair, Certificate, CertificateRow, CheckError, CheckOptions, Clearance, ClearanceOptions,
    MotionCheck, MotionOptions, Other, PairFinding, Verdict,
};
use impinge::scene::{PartId, Scene, Stop};
use impinge_files::LoadedRobot;
use pyo3::prelude::*;

use crate::arrays::{array, plain_column, ragged, row_array};
use crate::errors::Fault;
use crate::question::Progress;
use crate::robot::{RobotCore, invalid};
use crate::robot_checks::obstacles;
use crate::scene::Part;
use crate::workers::{self, Call};

/// Clearances between links and of each link from obstacles, the obstacles, and the pairs of
/// indices of links and obstacles that are not checked.
type Surroundings<'py> = ((f64, Vec<f64>), Vec<Part<'py>>, Vec<(usize, usize)>);

type Object<'py> = Bound<'py, PyAny>;

/// A scene of obstacles with the clearances from them.
struct Around {
    scene: Scene,
    self_padding: f64,
    padding: Vec<f64>,
    ignored: Vec<(usize, PartId)>,
}

impl Around {
    fn of(py: Python<'_>, ((self_padding, padding), parts, ignored): Surroundings<'_>) -> PyResult<Self> {
        let scene = obstacles(py, &parts)?;
        let ids: Vec<PartId> = scene.parts().collect();
        let ignored = ignored.into_iter().map(|(link, part)| (link, ids[part])).collect();
        Ok(Self { scene, self_padding, padding, ignored })
    }

    fn options(&self) -> CheckOptions<'_> {
        let (padding, ignored) = (self.padding.clone(), self.ignored.clone());
        let obstacles = Some(&self.scene);
        CheckOptions { stop: Stop::First, obstacles, self_padding: self.self_padding, padding, ignored }
    }
}

/// Returns the values of valid configurations, and their number.
fn configurations(robot: &LoadedRobot, q: &Object<'_>) -> PyResult<(Vec<f64>, usize)> {
    let values = plain_column::<f64>(q)?;
    let rows = robot.robot.check_rows(&values).map_err(|error| invalid(&error).raised(q.py()))?;
    Ok((values, rows))
}

/// Returns the indices of a pair: the parts of a scene follow the links. Both are -1 without a
/// pair.
fn indices(pair: Option<(usize, Other)>, links: usize) -> [i64; 2] {
    pair.map_or([-1; 2], |(link, other)| match other {
        Other::Link(other) => [link as i64, other as i64],
        Other::Obstacle(part) => [link as i64, (links + part.index()) as i64],
    })
}

fn failed(error: &CheckError) -> Fault {
    Fault::new("out-of-range", "padding", error.to_string())
}

/// Returns for each motion: the verdict (0 free, 1 collides, 2 undecided), (n,); the time until
/// which it is free and that of a collision, NaN without one, (n, 2); the pair that collides, (n,
/// 2); the configuration that collides, NaN without one, (n, dof); and the rows of its certificate:
/// offsets (n + 1,), links and others, -1 for obstacles, (k, 2), and times and halves, (k, 2).
#[pyfunction]
#[allow(clippy::type_complexity, reason = "the arrays of the answer")]
pub(crate) fn robot_motions<'py>(
    robot: &RobotCore,
    ends: (Object<'py>, Object<'py>),
    surroundings: Surroundings<'py>,
    max_steps: usize,
    keeps_certificate: bool,
    progress: Progress,
) -> PyResult<((Object<'py>, Object<'py>, Object<'py>, Object<'py>), (Object<'py>, Object<'py>, Object<'py>))> {
    let (py, loaded, Progress(progress)) = (ends.0.py(), robot.loaded().clone(), progress);
    let (starts, rows) = configurations(&loaded, &ends.0)?;
    let (ends, _) = configurations(&loaded, &ends.1)?;
    let around = Around::of(py, surroundings)?;
    let (links, dof) = (loaded.robot.links().len(), loaded.robot.coordinates().len());
    let work = move |execution: Execution<'_>| {
        let options = MotionOptions { check: around.options(), max_steps, keeps_certificate };
        match loaded.robot.check_motions(&starts, &ends, &options, execution) {
            Err(CheckError::Stopped(stopped)) => Err(stopped),
            found => Ok(found),
        }
    };
    let (found, _) = workers::execute(py, Call { rows, is_brief: false, progress }, work)?;
    let found: Vec<MotionCheck> = found.map_err(|error| failed(&error).raised(py))?.values;
    let verdict = |found: &MotionCheck| match found.verdict {
        Verdict::Free => 0,
        Verdict::Collides => 1,
        Verdict::Undecided => 2,
    };
    let verdicts: Vec<u8> = found.iter().map(verdict).collect();
    let times = found.iter().map(|found| [found.free_until, found.hit_at.unwrap_or(f64::NAN)]).collect();
    let pair = |found: &MotionCheck| indices(found.collision.map(|hit| (hit.link, hit.other)), links);
    let pairs = found.iter().map(pair).collect();
    let hit = |found: &MotionCheck| found.hit.clone().unwrap_or_else(|| vec![f64::NAN; dof]);
    let hits: Vec<f64> = found.iter().flat_map(hit).collect();
    let certificate = |found: MotionCheck| found.certificate.map_or(Vec::new(), |certificate| certificate.rows);
    let (offsets, kept) = ragged(found.into_iter().map(certificate).collect());
    let subject = |row: &CertificateRow| [row.link as i64, row.other.map_or(-1, |other| other as i64)];
    let subjects = kept.iter().map(subject).collect();
    let intervals = kept.iter().map(|row| [row.time, row.half]).collect();
    let (places, count) = (offsets.len(), kept.len());
    let answers = (
        array(py, verdicts, &[rows])?,
        row_array(py, times, &[rows])?,
        row_array(py, pairs, &[rows])?,
        array(py, hits, &[rows, dof])?,
    );
    let certificates =
        (array(py, offsets, &[places])?, row_array(py, subjects, &[count])?, row_array(py, intervals, &[count])?);
    Ok((answers, certificates))
}

/// Verifies the certificate of a motion. Returns the reason why it proves nothing, if it does not.
#[pyfunction]
pub(crate) fn robot_verify(
    robot: &RobotCore,
    ends: (Object<'_>, Object<'_>),
    surroundings: Surroundings<'_>,
    subjects: &Object<'_>,
    intervals: &Object<'_>,
) -> PyResult<Option<String>> {
    let (py, loaded) = (ends.0.py(), robot.loaded().clone());
    let (start, _) = configurations(&loaded, &ends.0)?;
    let (end, _) = configurations(&loaded, &ends.1)?;
    let around = Around::of(py, surroundings)?;
    let (subjects, intervals) = (plain_column::<i64>(subjects)?, plain_column::<f64>(intervals)?);
    let row = |(subject, interval): (&[i64; 2], &[f64; 2])| CertificateRow {
        link: usize::try_from(subject[0]).unwrap_or(usize::MAX),
        other: usize::try_from(subject[1]).ok(),
        time: interval[0],
        half: interval[1],
    };
    let rows = subjects.as_chunks().0.iter().zip(intervals.as_chunks().0).map(row).collect();
    let certificate = Certificate { start, end, rows };
    let found = workers::run(py, move |_| loaded.robot.verify(&certificate, &around.options()))?;
    Ok(found.err().map(|error| error.to_string()))
}

/// Audit: pairs of links, (n, 2); the finding (0 adjacent, 1 proved never, 2 witness, 3 always, 4
/// open), (n,); whether the pair is checked, (n,); a configuration that collides, NaN without one,
/// (n, dof); and an SRDF file.
type Audited<'py> = (Object<'py>, Object<'py>, Object<'py>, Object<'py>, String);

/// Returns for each pair of links whether it can collide.
#[pyfunction]
pub(crate) fn robot_audit<'py>(
    py: Python<'py>,
    robot: &RobotCore,
    samples: usize,
    seed: u64,
    max_boxes: usize,
    progress: Progress,
) -> PyResult<Audited<'py>> {
    let (loaded, Progress(progress)) = (robot.loaded().clone(), progress);
    let options = AuditOptions { samples, seed, max_boxes };
    let work = {
        let loaded = loaded.clone();
        move |execution: Execution<'_>| match loaded.robot.audit(&options, execution) {
            Err(CheckError::Stopped(stopped)) => Err(stopped),
            found => Ok(found),
        }
    };
    let (found, _) = workers::execute(py, Call { rows: samples, is_brief: false, progress }, work)?;
    let found: Vec<AuditedPair> = found.map_err(|error| failed(&error).raised(py))?;
    let srdf = loaded.srdf(&found);
    let dof = loaded.robot.coordinates().len();
    let number = |pair: &AuditedPair| match pair.finding {
        PairFinding::Adjacent => 0_u8,
        PairFinding::ProvedNever => 1,
        PairFinding::Witness(_) => 2,
        PairFinding::Always(_) => 3,
        PairFinding::Open => 4,
    };
    let witness = |pair: &AuditedPair| match &pair.finding {
        PairFinding::Witness(q) | PairFinding::Always(q) => q.clone(),
        _ => vec![f64::NAN; dof],
    };
    let count = found.len();
    let pairs = found.iter().map(|pair| pair.links.map(|link| link as i64)).collect();
    let checked: Vec<bool> = found.iter().map(|pair| pair.is_checked).collect();
    let witnesses: Vec<f64> = found.iter().flat_map(witness).collect();
    Ok((
        row_array(py, pairs, &[count])?,
        array(py, found.iter().map(number).collect::<Vec<u8>>(), &[count])?,
        array(py, checked, &[count])?,
        array(py, witnesses, &[count, dof])?,
        srdf,
    ))
}

/// Returns for each configuration the bounds of its clearance, (n, 2), the nearest pair, (n, 2),
/// its nearest points, NaN without points, (n, 2, 3), and whether it is undecided, (n,).
#[pyfunction]
pub(crate) fn robot_clearance<'py>(
    robot: &RobotCore,
    q: &Object<'py>,
    limit: f64,
    parts: Vec<Part<'py>>,
    ignored: Vec<(usize, usize)>,
    progress: Progress,
) -> PyResult<(Object<'py>, Object<'py>, Object<'py>, Object<'py>)> {
    let (py, loaded, Progress(progress)): (_, Arc<LoadedRobot>, _) = (q.py(), robot.loaded().clone(), progress);
    let (values, rows) = configurations(&loaded, q)?;
    let around = Around::of(py, ((0.0, Vec::new()), parts, ignored))?;
    let links = loaded.robot.links().len();
    let work = move |execution: Execution<'_>| {
        let options = ClearanceOptions { obstacles: Some(&around.scene), ignored: around.ignored.clone(), limit };
        match loaded.robot.clearances(&values, &options, execution) {
            Err(CheckError::Stopped(stopped)) => Err(stopped),
            found => Ok(found),
        }
    };
    let (found, _) = workers::execute(py, Call { rows, is_brief: false, progress }, work)?;
    let found: Vec<Clearance> = found.map_err(|error| failed(&error).raised(py))?.values;
    let bounds = found.iter().map(|found| [found.lower, found.upper]).collect();
    let pairs = found.iter().map(|found| indices(found.pair, links)).collect();
    let points = found.iter().flat_map(|found| found.points.unwrap_or([[f64::NAN; 3]; 2])).collect();
    let undecided = found.iter().map(|found| found.is_undecided).collect();
    Ok((
        row_array(py, bounds, &[rows])?,
        row_array(py, pairs, &[rows])?,
        row_array(py, points, &[rows, 2])?,
        array::<bool>(py, undecided, &[rows])?,
    ))
}
