//! The `impinge` command, which the wheel contains.

use std::ffi::OsString;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

/// Runs the command with its arguments, without the name of the program, and returns its exit code.
///
/// The command takes over the process: an interrupt ends the process with exit code 2, without the
/// interpreter. The lock of the interpreter is released while the command runs.
#[pyfunction]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    // The default pool of this process has one thread (`workers::limit_default_pool`).
    let all_processors = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("cannot start the threads of the command: {error}")))?;
    Ok(py.detach(|| all_processors.install(|| impinge_cli::run(arguments))))
}
