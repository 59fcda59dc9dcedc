//! Axis-aligned boxes in three forms and in packed forms, and queries of one box against many.

use impinge::InputError;
use impinge::volume::{
    AabbBatch, BoundingVolume, CenterRadius, MinMax, MinWidths, PackedCenterRadius, PackedMinWidths,
};
use pyo3::prelude::*;

use crate::arrays::array;
use crate::boxes::Boxes;
use crate::errors::{Fault, kind_and_place, message};
use crate::partitions::EXPONENT;
use crate::points::Points;
use crate::poses;

/// Contents of `Aabb`, `MinWidths` and `CenterRadius` of `impinge.fit`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct BoxCore(Form);

#[derive(Clone, Copy)]
enum Form {
    MinMax(MinMax),
    MinWidths(MinWidths),
    CenterRadius(CenterRadius),
}

/// Contents of `PackedMinWidths` and `PackedCenterRadius` of `impinge.fit`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct PackedCore(Packed);

enum Packed {
    MinWidths8(PackedMinWidths<u8>),
    MinWidths16(PackedMinWidths<u16>),
    CenterRadius8(PackedCenterRadius<u8>),
    CenterRadius16(PackedCenterRadius<u16>),
}

/// Contents of `impinge.fit.AabbBatch`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct BatchCore(AabbBatch);

impl Form {
    fn min_max(self) -> MinMax {
        match self {
            Self::MinMax(own) => own,
            Self::MinWidths(own) => own.into(),
            Self::CenterRadius(own) => own.into(),
        }
    }

    /// Returns the result of `of` for this box and another box of the same form.
    ///
    /// # Errors
    /// `InputError` if the other box has another form.
    fn with_same_form<T>(self, other: &Bound<'_, BoxCore>, of: impl Fn(Self, Self) -> Option<T>) -> PyResult<T> {
        of(self, other.get().0).ok_or_else(|| {
            Fault::new("type", "other", "is a box in another form")
                .hint(Some("convert one of the two boxes to the form of the other"))
                .raised(other.py())
        })
    }
}

#[pymethods]
impl BoxCore {
    /// Makes a box from two rows of three numbers. The names of the rows select the form.
    #[new]
    fn new<'py>(names: (String, String), first: &Bound<'py, PyAny>, second: &Bound<'py, PyAny>) -> PyResult<Self> {
        let py = first.py();
        if names.1 == "high" {
            let Boxes { shape, rows } = Boxes::read(first, Some(second), EXPONENT)?;
            return match (&shape[..], &rows[..]) {
                ([], &[bounds]) => Ok(Self(Form::MinMax(bounds))),
                _ => Err(Fault::new("shape", "low", "one corner is expected, (3,)").raised(py)),
            };
        }
        let row = |value: &Bound<'py, PyAny>, name: &str| {
            let points = Points::read(value, name, EXPONENT)?;
            match (&points.shape[..], &points.rows[..]) {
                ([], &[row]) => Ok(row),
                _ => Err(Fault::new("shape", name, "three numbers are expected, (3,)").raised(py)),
            }
        };
        let (first, second) = (row(first, &names.0)?, row(second, &names.1)?);
        let made = if names.1 == "widths" {
            MinWidths::new(first, second).map(Form::MinWidths)
        } else {
            CenterRadius::new(first, second).map(Form::CenterRadius)
        };
        made.map(Self).map_err(|error| fault(&error, &names.1).raised(py))
    }

    /// Returns the two rows of numbers, (3,) each, the volume and the surface area.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (first, second, volume, area) = match self.0 {
            Form::MinMax(own) => (own.min(), own.max(), own.volume(), own.surface_area()),
            Form::MinWidths(own) => (own.min(), own.widths(), own.volume(), own.surface_area()),
            Form::CenterRadius(own) => (own.center(), own.half_extents(), own.volume(), own.surface_area()),
        };
        let columns = (array(py, first.to_vec(), &[3])?, array(py, second.to_vec(), &[3])?, volume, area);
        Ok(columns.into_pyobject(py)?.into_any())
    }

    fn to_min_max(&self) -> Self {
        Self(Form::MinMax(self.0.min_max()))
    }

    fn to_min_widths(&self) -> Self {
        Self(match self.0 {
            Form::MinWidths(_) => self.0,
            form => Form::MinWidths(form.min_max().into()),
        })
    }

    fn to_center_radius(&self) -> Self {
        Self(match self.0 {
            Form::CenterRadius(_) => self.0,
            form => Form::CenterRadius(form.min_max().into()),
        })
    }

    fn overlaps(&self, other: &Bound<'_, Self>) -> PyResult<bool> {
        self.0.with_same_form(other, |own, other| match (own, other) {
            (Form::MinMax(own), Form::MinMax(other)) => Some(own.overlaps(&other)),
            (Form::MinWidths(own), Form::MinWidths(other)) => Some(own.overlaps(&other)),
            (Form::CenterRadius(own), Form::CenterRadius(other)) => Some(own.overlaps(&other)),
            _ => None,
        })
    }

    fn encloses(&self, other: &Bound<'_, Self>) -> PyResult<bool> {
        self.0.with_same_form(other, |own, other| match (own, other) {
            (Form::MinMax(own), Form::MinMax(other)) => Some(own.encloses(&other)),
            (Form::MinWidths(own), Form::MinWidths(other)) => Some(own.encloses(&other)),
            (Form::CenterRadius(own), Form::CenterRadius(other)) => Some(own.encloses(&other)),
            _ => None,
        })
    }

    fn merged(&self, other: &Bound<'_, Self>) -> PyResult<Self> {
        let merged = self.0.with_same_form(other, |own, other| match (own, other) {
            (Form::MinMax(own), Form::MinMax(other)) => Some(Form::MinMax(own.merged(&other))),
            (Form::MinWidths(own), Form::MinWidths(other)) => Some(Form::MinWidths(own.merged(&other))),
            (Form::CenterRadius(own), Form::CenterRadius(other)) => Some(Form::CenterRadius(own.merged(&other))),
            _ => None,
        });
        merged.map(Self)
    }

    /// Returns whether the box contains each point, as booleans of shape (...).
    fn contains<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let Points { shape, rows } = Points::read(points, "points", EXPONENT)?;
        let holds = |&point: &[f64; 3]| match self.0 {
            Form::MinMax(own) => own.contains(point),
            Form::MinWidths(own) => own.contains(point),
            Form::CenterRadius(own) => own.contains(point),
        };
        array(points.py(), rows.iter().map(holds).collect(), &shape)
    }

    /// Returns a box of the same form that contains the image of this box under a pose.
    fn moved(&self, pose: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (py, pose) = (pose.py(), &poses::read_one(pose, "pose", "one pose is expected, (4, 4)")?);
        let moved = match self.0 {
            Form::MinMax(own) => own.moved(pose).map(Form::MinMax),
            Form::MinWidths(own) => own.moved(pose).map(Form::MinWidths),
            Form::CenterRadius(own) => own.moved(pose).map(Form::CenterRadius),
        };
        moved.map(Self).map_err(|error| fault(&error, "pose").at(Vec::new()).raised(py))
    }

    /// Returns the box packed with extents of 8 or 16 bits. A box given by its corners is packed by
    /// its widths.
    fn packed(&self, py: Python<'_>, bits: u32) -> PyResult<PackedCore> {
        let packed = match (self.0, bits) {
            (Form::CenterRadius(own), 8) => own.try_into().map(Packed::CenterRadius8),
            (Form::CenterRadius(own), _) => own.try_into().map(Packed::CenterRadius16),
            (Form::MinWidths(own), 8) => own.try_into().map(Packed::MinWidths8),
            (Form::MinWidths(own), _) => own.try_into().map(Packed::MinWidths16),
            (Form::MinMax(own), 8) => MinWidths::from(own).try_into().map(Packed::MinWidths8),
            (Form::MinMax(own), _) => MinWidths::from(own).try_into().map(Packed::MinWidths16),
        };
        packed.map(PackedCore).map_err(|error| fault(&error, "box").raised(py))
    }
}

#[pymethods]
impl PackedCore {
    /// Returns the box that the packed numbers represent, exactly.
    fn unpacked(&self) -> BoxCore {
        BoxCore(match self.0 {
            Packed::MinWidths8(own) => Form::MinWidths(own.into()),
            Packed::MinWidths16(own) => Form::MinWidths(own.into()),
            Packed::CenterRadius8(own) => Form::CenterRadius(own.into()),
            Packed::CenterRadius16(own) => Form::CenterRadius(own.into()),
        })
    }

    /// Returns the number of bytes that the numbers take.
    fn size(&self) -> usize {
        match &self.0 {
            Packed::MinWidths8(own) => size_of_val(own),
            Packed::MinWidths16(own) => size_of_val(own),
            Packed::CenterRadius8(own) => size_of_val(own),
            Packed::CenterRadius16(own) => size_of_val(own),
        }
    }
}

#[pymethods]
impl BatchCore {
    /// Makes boxes from lower and upper corners, (n, 3), in single precision.
    #[new]
    fn new(low: &Bound<'_, PyAny>, high: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Boxes { shape, rows } = Boxes::read(low, high, EXPONENT)?;
        if shape.len() != 1 {
            let message = format!("leading axes {shape:?}, but (n, 3) is expected");
            return Err(Fault::new("shape", "low", message).raised(low.py()));
        }
        Ok(Self(low.py().detach(|| rows.iter().map(MinMax::to_aabb).collect())))
    }

    fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the indices of the boxes that overlap a box, (k,), in ascending order.
    fn overlapping<'py>(&self, one: &Bound<'py, BoxCore>) -> PyResult<Bound<'py, PyAny>> {
        let (py, one) = (one.py(), one.get().0.min_max().to_aabb());
        let found = py.detach(|| {
            let mut found = Vec::new();
            self.0.overlapping(&one, &mut found);
            found
        });
        let count = found.len();
        array(py, found, &[count])
    }
}

fn fault(error: &InputError, name: &str) -> Fault {
    let (kind, at) = kind_and_place(error);
    Fault::new(kind, name, message(error)).at(at).hint(error.hint())
}
