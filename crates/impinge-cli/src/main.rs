//! The `impinge` program. The library crate `impinge_cli` does all the work.

#![forbid(unsafe_code)]

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(impinge_cli::run(env::args_os().skip(1)))
}
