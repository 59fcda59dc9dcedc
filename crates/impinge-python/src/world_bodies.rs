//! Options, handles and traits of bodies by their names in Python, and errors that name the row of
//! an argument.

use impinge::budget::Stopped;
use impinge::world::{BodyId, BroadPhase, Kind, Layers, NarrowPhase, PairKey, Realignment, Traits, WorldError};
use impinge::{InputError, InputErrorKind};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::row_array;
use crate::errors::{Fault, OUT_OF_MEMORY, kind_and_place, message};

/// A shape, the realignment of its box, and the poses of bodies with that shape.
pub(crate) type Placement<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Handles, one in each row of an array of u64.
pub(crate) type Handles<'py> = Bound<'py, PyArray1<u64>>;

/// Traits of bodies as Python passes them: the kind, the layers that a body is on, the layers that
/// it intersects, and the surface.
pub(crate) type TraitArguments<'py> = (Bound<'py, PyAny>, u32, u32, Option<u64>);

pub(crate) const BROAD_PHASES: [(&str, BroadPhase); 7] = [
    ("auto", BroadPhase::Auto),
    ("every", BroadPhase::Every),
    ("tree", BroadPhase::Tree),
    ("columns", BroadPhase::Columns),
    ("grid", BroadPhase::Grid),
    ("one_axis", BroadPhase::OneAxis),
    ("three_axes", BroadPhase::ThreeAxes),
];

pub(crate) const NARROW_PHASES: [(&str, NarrowPhase); 3] =
    [("boxes", NarrowPhase::Boxes), ("intersections", NarrowPhase::Intersections), ("contacts", NarrowPhase::Contacts)];

pub(crate) const REALIGNMENTS: [(&str, Realignment); 5] = [
    ("own", Realignment::Own),
    ("rotated", Realignment::Rotated),
    ("loose", Realignment::Loose),
    ("hull", Realignment::Hull),
    ("climbing", Realignment::Climbing),
];

pub(crate) const KINDS: [(&str, Kind); 3] =
    [("static", Kind::Static), ("kinematic", Kind::Kinematic), ("moving", Kind::Moving)];

/// Returns the value with the name in an option.
///
/// # Errors
/// `InputError` if there is no such name; it lists the names.
pub(crate) fn chosen<T: Copy>(option: &Bound<'_, PyAny>, argument: &str, values: &[(&str, T)]) -> PyResult<T> {
    let name = option.extract::<&str>().ok();
    let found = values.iter().find(|(own, _)| Some(*own) == name);
    found.map(|(_, value)| *value).ok_or_else(|| match option.repr() {
        Ok(given) => {
            let names: Vec<String> = values.iter().map(|(name, _)| format!("{name:?}")).collect();
            let message = format!("must be one of {}, not {given}", names.join(", "));
            Fault::new("option", argument, message).raised(option.py())
        }
        Err(error) => error,
    })
}

pub(crate) fn traits((kind, on, meets, surface): &TraitArguments<'_>) -> PyResult<Traits> {
    let (kind, layers) = (chosen(kind, "kind", &KINDS)?, Layers { on: *on, meets: *meets });
    Ok(Traits { kind, layers, surface: *surface, ..Traits::default() })
}

pub(crate) fn numbers(handles: &Handles<'_>) -> PyResult<Vec<u64>> {
    Ok(handles.readonly().as_slice()?.to_vec())
}

pub(crate) fn ids(handles: &Handles<'_>) -> PyResult<Vec<BodyId>> {
    Ok(handles.readonly().as_slice()?.iter().copied().map(BodyId::from_bits).collect())
}

/// Returns the handles of pairs, (k, 2).
pub(crate) fn keys<'py>(py: Python<'py>, pairs: &[PairKey]) -> PyResult<Bound<'py, PyAny>> {
    row_array(py, pairs.iter().map(|pair| [pair.a.to_bits(), pair.b.to_bits()]).collect(), &[pairs.len()])
}

/// Returns an error about the row of an argument that belongs to the body in an error of the world.
/// If a pose is invalid, the error is about the poses.
pub(crate) fn of_bodies(error: &WorldError, ids: &[BodyId], poses: &str) -> Fault {
    let body = match error {
        WorldError::Stale { body } | WorldError::Static { body } | WorldError::NotAMesh { body } => Some(*body),
        WorldError::Input { body, .. } => *body,
        _ => None,
    };
    let row = ids.iter().position(|&id| Some(id) == body).unwrap_or(0);
    refused(error, if matches!(error, WorldError::Input { .. }) { poses } else { "bodies" }, row)
}

/// Returns an error about a row of an argument.
pub(crate) fn refused(error: &WorldError, argument: &str, row: usize) -> Fault {
    let (kind, text, hint) = match error {
        WorldError::Input { error, .. } if is_about_margin(error) => {
            return Fault::new(kind_and_place(error).0, "margin", message(error));
        }
        WorldError::Input { error, .. } => (kind_and_place(error).0, message(error), error.hint()),
        WorldError::Stale { .. } => ("stale", error.to_string(), None),
        WorldError::Static { .. } => ("static", error.to_string(), Some("set_poses() moves it, between two steps")),
        WorldError::NotAMesh { .. } => ("type", error.to_string(), None),
        WorldError::Stopped(Stopped::Memory) => (OUT_OF_MEMORY, error.to_string(), None),
        _ => ("too-many", error.to_string(), None),
    };
    Fault::new(kind, argument, text).at(vec![row]).hint(hint)
}

/// Reports whether an error is about the margin of a body, which is one number for all bodies.
fn is_about_margin(error: &InputError) -> bool {
    match error.kind() {
        InputErrorKind::NonFinite { what, .. }
        | InputErrorKind::Negative { what, .. }
        | InputErrorKind::OutOfRange { what, .. } => *what == "margin",
        _ => false,
    }
}
