//! Shares of a search for clashes, for several machines: the broad phase, the kinds of some pairs,
//! and the report about all of them.

use std::collections::HashMap;
use std::sync::Arc;

use impinge::clash::{Asked, Finding, Inner, Job, Kind, Why, classify};
use impinge::query::batch::Execution;
use impinge::shape::PlacedShape;
use numpy::{PyArray2, PyArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::arrays::row_array;
use crate::clash::{Question, Search, written};
use crate::poses;
use crate::scene_shares::numbers_of_box;
use crate::shapes::read_shape;
use crate::workers::{self, Call};

/// Number of columns of a finding as Python passes it on: the kind, whether it is proved, why it is
/// not, the depth, the gap, the point, the faces, the normal and the volume. What is absent is NaN.
const COLUMNS: usize = 17;

/// Returns the pairs to check, (k, 2), the tolerance and the clearance of each, (k, 2), and the box
/// between its parts, (k, 6). Parts are numbered through all scenes. What is absent is NaN.
#[pyfunction]
pub(crate) fn clash_candidates<'py>(py: Python<'py>, question: Question<'py>) -> PyResult<Bound<'py, PyAny>> {
    let search = Arc::new(Search::read(py, question)?);
    let asking = Arc::clone(&search);
    let found = workers::run(py, move |budget| {
        let sides = asking.sides();
        let job = Job::new(&sides, asking.options(&sides), budget)?;
        let mut first = 0;
        let mut numbers = HashMap::new();
        for (label, scene) in &asking.scenes {
            numbers.insert(label.as_str(), first);
            first += scene.parts().count();
        }
        let (mut pairs, mut asked, mut boxes) = (Vec::new(), Vec::new(), Vec::new());
        for candidate in 0..job.candidates() {
            let (members, question) = job.question(candidate);
            pairs.push(members.map(|member| (numbers[member.scene.as_str()] + member.part.index()) as u32));
            asked.push([question.tolerance, question.clearance.unwrap_or(f64::NAN)]);
            boxes.push(numbers_of_box(job.bounds(candidate)));
        }
        Ok((pairs, asked, boxes))
    })?;
    let (pairs, asked, boxes) = found.map_err(|error| search.raised(py, error))?;
    let count = [pairs.len()];
    let arrays = (row_array(py, pairs, &count)?, row_array(py, asked, &count)?, row_array(py, boxes, &count)?);
    Ok(arrays.into_pyobject(py)?.into_any())
}

/// Returns the findings of some pairs of parts, (k, 17). `asked` has the tolerance and the
/// clearance of each pair, and `listed` tells whether contacts are listed and volumes computed.
#[pyfunction]
pub(crate) fn clash_pairs<'py>(
    py: Python<'py>,
    parts: Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
    pairs: &Bound<'py, PyArray2<u32>>,
    asked: &Bound<'py, PyArray2<f64>>,
    listed: (bool, bool),
) -> PyResult<Bound<'py, PyAny>> {
    let place = |(at, (thing, pose)): (usize, (Bound<'py, PyAny>, Bound<'py, PyAny>))| -> PyResult<PlacedShape> {
        let name = format!("part {at}");
        let pose = poses::read_one(&pose, &name, "a part has one pose, (4, 4)")?;
        let placed = read_shape(&thing, &name, true)?.shape.at(pose);
        placed.map_err(|error| poses::fault(&error, &name, Vec::new()).raised(py))
    };
    let placed = parts.into_iter().enumerate().map(place).collect::<PyResult<Vec<_>>>()?;
    let (pairs, asked) = (pairs.readonly(), asked.readonly());
    let (contacts, volume) = listed;
    let question = |(pair, &[tolerance, clearance]): (&[u32; 2], &[f64; 2])| {
        let asked = Asked { tolerance, clearance: Some(clearance).filter(|x| !x.is_nan()), contacts, volume };
        (pair.map(|part| part as usize), asked)
    };
    let (pairs, asked) = (pairs.as_slice()?.as_chunks::<2>().0, asked.as_slice()?.as_chunks::<2>().0);
    let questions: Vec<_> = pairs.iter().zip(asked).map(question).collect();
    if questions.iter().flat_map(|(pair, _)| pair).any(|&part| part >= placed.len()) {
        return Err(PyIndexError::new_err("there is no such part"));
    }
    let call = Call { rows: questions.len(), is_brief: false, progress: false };
    let work = move |execution: Execution<'_>| classify(&placed, &questions, execution);
    let (found, _) = workers::execute(py, call, work)?;
    let rows: Vec<_> = found.iter().map(numbers_of).collect();
    let count = rows.len();
    row_array(py, rows, &[count])
}

/// Returns the report of a search from the findings of all of its pairs, in order.
#[pyfunction]
pub(crate) fn clash_report<'py>(
    py: Python<'py>,
    question: Question<'py>,
    findings: &Bound<'py, PyArray2<f64>>,
) -> PyResult<Bound<'py, PyAny>> {
    let search = Arc::new(Search::read(py, question)?);
    let findings = findings.readonly();
    let rows: Vec<_> = findings.as_slice()?.as_chunks::<COLUMNS>().0.iter().map(finding_of).collect();
    let asking = Arc::clone(&search);
    let found = workers::run(py, move |budget| {
        let sides = asking.sides();
        let job = Job::new(&sides, asking.options(&sides), budget)?;
        if rows.len() != job.candidates() {
            return Ok(None);
        }
        written(&asking, job.report(rows, None), budget).map(Some)
    })?;
    let found = found.map_err(|error| search.raised(py, error))?;
    let found = found.ok_or_else(|| PyIndexError::new_err("each pair has one finding"))?;
    Ok(found.into_pyobject(py)?.into_any())
}

const KINDS: [Kind; 8] = [
    Kind::Duplicate,
    Kind::Contained(Inner::A),
    Kind::Contained(Inner::B),
    Kind::Clash,
    Kind::Undecided,
    Kind::Contact,
    Kind::Clearance,
    Kind::Clear,
];

const REASONS: [Why; 3] = [Why::Budget, Why::NotSolid, Why::AboutTolerance];

/// Returns a finding as numbers.
fn numbers_of(finding: &Finding) -> [f64; COLUMNS] {
    let Finding { kind, depth, gap, volume, point, faces, normal, proved, why } = *finding;
    let place = |at: Option<usize>| at.map_or(f64::NAN, |at| at as f64);
    let two = |numbers: Option<[f64; 2]>| numbers.unwrap_or([f64::NAN; 2]);
    let three = |numbers: Option<[f64; 3]>| numbers.unwrap_or([f64::NAN; 3]);
    let mut row = [0.0; COLUMNS];
    row[0] = place(KINDS.iter().position(|&one| one == kind));
    row[1] = f64::from(proved);
    row[2] = place(REASONS.iter().position(|&one| Some(one) == why));
    row[3..5].copy_from_slice(&two(depth));
    row[5..7].copy_from_slice(&two(gap));
    row[7..10].copy_from_slice(&three(point));
    row[10..12].copy_from_slice(&two(faces.map(|pair| pair.map(f64::from))));
    row[12..15].copy_from_slice(&three(normal));
    row[15..17].copy_from_slice(&two(volume));
    row
}

/// Returns the finding with some numbers, or `None` for a clear pair.
fn finding_of(row: &[f64; COLUMNS]) -> Option<Box<Finding>> {
    let some = |at: usize| Some(row[at]).filter(|x| !x.is_nan());
    let two = |at: usize| Some([some(at)?, some(at + 1)?]);
    let three = |at: usize| Some([some(at)?, some(at + 1)?, some(at + 2)?]);
    let kind = KINDS.get(row[0] as usize).copied().filter(|&kind| kind != Kind::Clear)?;
    Some(Box::new(Finding {
        kind,
        depth: two(3),
        gap: two(5),
        point: three(7),
        faces: two(10).map(|pair| pair.map(|face| face as u32)),
        normal: three(12),
        volume: two(15),
        proved: row[1] != 0.0,
        why: some(2).and_then(|at| REASONS.get(at as usize)).copied(),
    }))
}
