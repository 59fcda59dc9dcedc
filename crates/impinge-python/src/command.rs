//! The `impinge` command, which the wheel brings along.

use std::ffi::OsString;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

/// Runs the command with these arguments, the program's name not among them, and returns its exit code.
///
/// The command takes over the process: an interrupt ends the process with exit code 2, without the interpreter. The
/// interpreter's lock is released meanwhile.
#[pyfunction]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    // The default pool of this process has one thread (`workers::keep_callers_alone`).
    let all_processors = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("the threads of the command cannot be started: {error}")))?;
    Ok(py.detach(|| all_processors.install(|| impinge_cli::run(arguments))))
}
