//! NumPy arrays as arguments and results.

use numpy::ndarray::{ArrayD, ArrayViewD};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

/// Description of arrays of doubles whose last axes are fixed.
pub(crate) struct Plain {
    /// Lengths of the last axes, such as `[4, 4]`.
    pub(crate) core: &'static [usize],
    /// Name of the function of `impinge._arrays` that converts everything else to such an array.
    pub(crate) reader: &'static str,
}

impl Plain {
    /// Returns the array itself if its doubles are contiguous, a copy of an array of single
    /// precision, and otherwise the result of the reader.
    ///
    /// # Errors
    /// `InputError` if the value cannot be converted. It contains the name of the argument.
    pub(crate) fn read<'py>(&self, value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
        if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
            && array.is_c_contiguous()
            && array.shape().ends_with(self.core)
            && array.data().is_aligned()
        {
            return Ok(array.readonly());
        }
        // The reader would take several times as long for a single point.
        if let Ok(array) = value.cast::<PyArrayDyn<f32>>()
            && array.shape().ends_with(self.core)
        {
            return Ok(array.cast_array::<f64>(false)?.readonly());
        }
        static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
        let py = value.py();
        let module = MODULE.get_or_try_init(py, || py.import("impinge._arrays").map(Bound::unbind))?;
        let made = module.bind(py).call_method1(self.reader, (value, name))?;
        Ok(made.cast_into::<PyArrayDyn<f64>>()?.readonly())
    }
}

/// Returns the numbers of an array of this type and of any layout, row by row.
///
/// # Errors
/// `TypeError` if the value is something else.
pub(crate) fn plain_column<T: Element + Copy>(value: &Bound<'_, PyAny>) -> PyResult<Vec<T>> {
    let numpy = value.py().import("numpy")?;
    let plain = numpy.call_method1("require", (value, value.py().None(), ("C_CONTIGUOUS", "ALIGNED")))?;
    Ok(plain.cast::<PyArrayDyn<T>>()?.readonly().as_slice()?.to_vec())
}

/// Maximum number of values that are copied to the memory of a new NumPy array. More values keep
/// their memory, for which an array needs a second object.
const MAX_COPIED: usize = 256;

/// Returns a NumPy array of these values, with axes of the lengths in `shape`.
pub(crate) fn array<'py, T: Element>(py: Python<'py>, values: Vec<T>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let made = if values.len() <= MAX_COPIED {
        ArrayViewD::from_shape(shape, &values).map(|view| PyArrayDyn::from_array(py, &view))
    } else {
        ArrayD::from_shape_vec(shape, values).map(|owned| PyArrayDyn::from_owned_array(py, owned))
    };
    made.map(Bound::into_any).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Returns the only value if `shape` is empty, or an array with axes of the lengths in `shape`.
pub(crate) fn numbers<'py, T: Element + Copy + IntoPyObject<'py>>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    match values[..] {
        // An array without axes would take longer to make, and Python has to unwrap it.
        [value] if shape.is_empty() => value.into_bound_py_any(py),
        _ => array(py, values, shape),
    }
}

/// Returns an array of rows of `N` entries with these leading axes.
pub(crate) fn row_array<'py, T: Element, const N: usize>(
    py: Python<'py>,
    rows: Vec<[T; N]>,
    lead: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    array(py, rows.into_flattened(), &[lead, &[N]].concat())
}

/// Returns the same array, made read-only.
pub(crate) fn read_only(array: Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
    let named = PyDict::new(array.py());
    named.set_item("write", false)?;
    array.call_method("setflags", (), Some(&named))?;
    Ok(array.unbind())
}

/// Concatenates answers of different lengths. Returns the offset of the first entry of each answer
/// and the end of the last, and the entries.
pub(crate) fn ragged<T>(answers: Vec<Vec<T>>) -> (Vec<i64>, Vec<T>) {
    let mut offsets = vec![0];
    let mut all = Vec::with_capacity(answers.iter().map(Vec::len).sum());
    for answer in answers {
        all.extend(answer);
        offsets.push(all.len() as i64);
    }
    (offsets, all)
}
