//! Shapes in Python, and how an argument is read as a shape.

use std::sync::Arc;

use impinge::character::HitVolume;
use impinge::hull::Hull;
use impinge::shape::Shape;
use impinge::volume::Lozenge;
use impinge::{HeightField, InputError, InputErrorKind, Pose};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::plain_column;
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::{MeshBase, mesh_of};
use crate::planning_scene::PlanningSceneFile;
use crate::points::Points;
use crate::poses;
use crate::robot::RobotCore;
use crate::workers;

/// Exponent of the magnitude below which coordinates and lengths must be, 2^128.
const EXPONENT: i32 = 128;

/// Number of pieces that a height field counts as. A query compares only the faces that are near.
const FIELD_WEIGHT: u64 = 64;

/// Number of sides of a circle in the triangles of round shapes.
const SEGMENTS: usize = 8;

/// Base class of `impinge.Shape`.
#[pyclass(subclass, frozen, module = "impinge._impinge")]
pub(crate) struct ShapeBase {
    shape: Shape,
    weight: u64,
}

/// A shape, and the number of pieces that a query of it compares: the faces of its meshes, and one
/// for each other part.
#[derive(Clone)]
pub(crate) struct WeighedShape {
    pub(crate) shape: Shape,
    pub(crate) weight: u64,
}

#[pymethods]
impl ShapeBase {
    /// Makes a shape of a kind from its source and its numbers. The source is points, (k, 3), a
    /// mesh, a shape, or a list of parts, each a shape and a pose.
    #[new]
    fn new(kind: &str, source: &Bound<'_, PyAny>, numbers: Vec<f64>) -> PyResult<Self> {
        let py = source.py();
        let points = |name: &str| Points::read(source, name, EXPONENT).map(|points| points.rows);
        let ends = || -> PyResult<[[f64; 3]; 2]> {
            let end = |row: usize, name| -> PyResult<[f64; 3]> {
                Ok(Points::read(&source.get_item(row)?, name, EXPONENT)?.rows[0])
            };
            Ok([end(0, "start")?, end(1, "end")?])
        };
        let mut weight = 1;
        let made = match (kind, &numbers[..]) {
            ("sphere", &[radius]) => Shape::sphere(points("center")?[0], radius),
            ("capsule", &[radius]) => {
                let [start, end] = ends()?;
                Shape::capsule(start, end, radius)
            }
            ("tapered_capsule", &[at_start, at_end]) => {
                let [start, end] = ends()?;
                Shape::tapered_capsule(start, end, [at_start, at_end])
            }
            ("rounded", &[radius]) => {
                let inner = read_shape(source, "shape", false)?;
                weight = inner.weight;
                inner.shape.rounded(radius)
            }
            ("box", &[x, y, z]) => Shape::cuboid([x, y, z]),
            ("lozenge", &[radius]) => {
                let rectangle = points("edges")?;
                Lozenge::new(rectangle[0], [rectangle[1], rectangle[2]], radius)
                    .and_then(|plate| HitVolume::Lozenge(plate).shape_in(Pose::IDENTITY))
                    .map(|(shape, _)| shape)
            }
            ("cylinder", &[half_height, radius]) => Shape::cylinder(half_height, radius),
            ("cone", &[half_height, radius]) => Shape::cone(half_height, radius),
            ("ellipsoid", &[x, y, z]) => Shape::ellipsoid([x, y, z]),
            ("half_space", &[level]) => Shape::half_space(points("normal")?[0], level),
            ("triangle", []) => {
                let corners = points("corners")?;
                Shape::triangle([corners[0], corners[1], corners[2]])
            }
            ("hull", []) => {
                let points = points("points")?;
                workers::run(py, move |_| Hull::new(&points))?.map(|hull| Shape::hull(Arc::new(hull)))
            }
            ("mesh" | "solid", []) => {
                let mesh = mesh_of(source, "mesh")?;
                weight = mesh.faces().len() as u64;
                Ok(if kind == "solid" { Shape::solid(&mesh) } else { Shape::mesh(&mesh) })
            }
            ("height_field", &[x, y]) => {
                let (rows, holes): (Bound<'_, PyAny>, Bound<'_, PyAny>) = source.extract()?;
                let (row_count, column_count): (usize, usize) = rows.getattr("shape")?.extract()?;
                let heights = plain_column::<f32>(&rows)?;
                let holes = if holes.is_none() { Vec::new() } else { plain_column::<bool>(&holes)? };
                weight = FIELD_WEIGHT;
                let made = workers::run(py, move |_| {
                    HeightField::with_holes(row_count, column_count, [x, y], heights, |row, column| {
                        holes.get(row * (column_count - 1) + column).copied().unwrap_or(false)
                    })
                })?;
                made.map(|field| Shape::height_field(&field))
            }
            ("link", &[link]) => {
                let core = source.getattr("_core")?;
                let found = core.cast::<RobotCore>()?.get().shape(link as usize).cloned();
                let faces = found.as_ref().and_then(Shape::as_mesh).map(|(mesh, _)| mesh.faces().len() as u64);
                weight = faces.unwrap_or(FIELD_WEIGHT);
                found.ok_or_else(|| InputError::new(InputErrorKind::Empty { what: "link" }))
            }
            ("obstacle", &[part]) => {
                let found = source.cast::<PlanningSceneFile>()?.get().shape(part as usize).cloned();
                let faces = found.as_ref().and_then(Shape::as_mesh).map(|(mesh, _)| mesh.faces().len() as u64);
                weight = faces.unwrap_or(FIELD_WEIGHT);
                found.ok_or_else(|| InputError::new(InputErrorKind::Empty { what: "obstacle" }))
            }
            ("compound", []) => {
                let parts = parts_of(source)?;
                weight = parts.iter().map(|(part, _)| part.weight).sum();
                Shape::compound(&parts.into_iter().map(|(part, pose)| (part.shape, pose)).collect::<Vec<_>>())
            }
            _ => {
                return Err(
                    Fault::new("option", "kind", format!("there is no shape {kind:?} of {numbers:?}")).raised(py)
                );
            }
        };
        let shape = made.map_err(|error| refused(&error).raised(py))?;
        Ok(Self { shape, weight })
    }

    /// Returns the lower and the upper corner of a box that contains the shape in its own frame,
    /// (2, 3). Returns `None` if the shape is unbounded or empty.
    fn local_box(&self) -> Option<[[f64; 3]; 2]> {
        self.shape.at(Pose::IDENTITY).ok()?.bounds()
    }

    /// Returns the corners of triangles that look like the shape, as bytes. A mesh has its faces.
    fn triangles<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let corners = self.shape.to_meshes(SEGMENTS).into_iter().flat_map(|(mesh, pose)| {
            let faces = 0..mesh.faces().len() as u32;
            faces.flat_map(move |face| mesh.corners(face)).map(move |corner| pose.apply(corner))
        });
        let bytes: Vec<u8> = corners.flatten().flat_map(f64::to_le_bytes).collect();
        PyBytes::new(py, &bytes)
    }
}

/// Returns an error about an argument of a constructor, which is found by the noun in the library's
/// error.
fn refused(error: &InputError) -> Fault {
    let what = match *error.kind() {
        InputErrorKind::NonFinite { what, .. }
        | InputErrorKind::OutOfRange { what, .. }
        | InputErrorKind::Negative { what, .. }
        | InputErrorKind::TooMany { what, .. }
        | InputErrorKind::Empty { what } => what,
        InputErrorKind::ZeroAxis => "normal",
        InputErrorKind::NotRoundable { .. } => "shape",
        _ => "parts",
    };
    let (argument, is_single) = match what {
        "half-extent" => ("half_extents", false),
        "half-axis" => ("half_axes", false),
        "half-height" => ("half_height", true),
        "end radius" => ("radii", false),
        "cells" => ("heights", true),
        "radius" | "level" | "normal" => (what, true),
        _ => (what, false),
    };
    let (kind, place) = kind_and_place(error);
    let text = if kind == "zero-axis" { "the normal is zero".to_owned() } else { message(error) };
    Fault::new(kind, argument, text).at(if is_single { Vec::new() } else { place }).hint(error.hint())
}

/// Returns the parts of a compound: pairs of a shape or a mesh, and a pose or `None`.
fn parts_of(source: &Bound<'_, PyAny>) -> PyResult<Vec<(WeighedShape, Pose)>> {
    let mut parts = Vec::new();
    for (row, part) in source.try_iter()?.enumerate() {
        let (shape, pose): (Bound<'_, PyAny>, Bound<'_, PyAny>) = part?.extract()?;
        let name = format!("parts[{row}]");
        let pose = poses::read_one(&pose, &name, "a part has one pose, (4, 4)")?;
        parts.push((read_shape(&shape, &name, false)?, pose));
    }
    Ok(parts)
}

/// Returns the shape of an argument. A mesh is its surface, unless `is_solid` is set.
///
/// # Errors
/// `InputError` if the argument is something else.
pub(crate) fn read_shape(value: &Bound<'_, PyAny>, name: &str, is_solid: bool) -> PyResult<WeighedShape> {
    if let Ok(base) = value.cast::<ShapeBase>() {
        let ShapeBase { shape, weight } = base.get();
        return Ok(WeighedShape { shape: shape.clone(), weight: *weight });
    }
    if value.cast::<MeshBase>().is_ok() {
        let mesh = mesh_of(value, name)?;
        let shape = if is_solid { Shape::solid(&mesh) } else { Shape::mesh(&mesh) };
        return Ok(WeighedShape { shape, weight: mesh.faces().len() as u64 });
    }
    let message = format!("must be an impinge.Mesh or an impinge.Shape, not {}", value.get_type().qualname()?);
    Err(Fault::new("type", name, message)
        .hint(Some("impinge.load(path) reads a mesh; impinge.Shape.box(...), .sphere(...), .hull(...) make shapes"))
        .raised(value.py()))
}
