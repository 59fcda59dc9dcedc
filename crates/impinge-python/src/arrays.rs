//! NumPy arrays, in and out.

use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

/// Arrays of doubles whose last axes are fixed.
pub(crate) struct Plain {
    /// The last axes: `[4, 4]`.
    pub(crate) core: &'static [usize],
    /// What of `impinge._arrays` reads everything that is not such an array yet.
    pub(crate) reader: &'static str,
}

impl Plain {
    /// The array itself where its doubles lie side by side; else what the reader makes of it.
    ///
    /// # Errors
    /// `InputError` where it is none, naming it.
    pub(crate) fn read<'py>(&self, value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
        if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
            && array.is_c_contiguous()
            && array.shape().ends_with(self.core)
            && array.data().is_aligned()
        {
            return Ok(array.readonly());
        }
        static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
        let py = value.py();
        let module = MODULE.get_or_try_init(py, || py.import("impinge._arrays").map(Bound::unbind))?;
        let made = module.bind(py).call_method1(self.reader, (value, name))?;
        Ok(made.cast_into::<PyArrayDyn<f64>>()?.readonly())
    }
}

/// The numbers of an array that is of this type and of any layout, row by row.
///
/// # Errors
/// `TypeError` where it is something else.
pub(crate) fn plain_column<T: Element + Copy>(value: &Bound<'_, PyAny>) -> PyResult<Vec<T>> {
    let numpy = value.py().import("numpy")?;
    let plain = numpy.call_method1("require", (value, value.py().None(), ("C_CONTIGUOUS", "ALIGNED")))?;
    Ok(plain.cast::<PyArrayDyn<T>>()?.readonly().as_slice()?.to_vec())
}

/// An array with these axes.
pub(crate) fn array<'py, T: Element>(py: Python<'py>, values: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let count = values.len();
    let flat = PyArray1::from_vec(py, values);
    // One axis, as of the point of a single answer, needs no second array object.
    if shape == [count] {
        return Ok(flat.into_any());
    }
    Ok(flat.reshape(shape.to_vec())?.into_any())
}

/// An array of rows of `N` with these leading axes.
pub(crate) fn row_array<'py, T: Element, const N: usize>(
    py: Python<'py>,
    rows: Vec<[T; N]>,
    lead: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    array(py, rows.into_flattened(), &[lead, &[N]].concat())
}

/// The same array, which nobody can write to.
pub(crate) fn read_only(array: Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    let named = PyDict::new(array.py());
    named.set_item("write", false)?;
    array.call_method("setflags", (), Some(&named))?;
    Ok(array.unbind())
}

/// Answers of uneven number, one after another, with the places at which each begins and the last ends.
pub(crate) fn ragged<T>(answers: Vec<Vec<T>>) -> (Vec<i64>, Vec<T>) {
    let mut offsets = vec![0];
    let mut all = Vec::with_capacity(answers.iter().map(Vec::len).sum());
    for answer in answers {
        all.extend(answer);
        offsets.push(all.len() as i64);
    }
    (offsets, all)
}
