//! The program `impinge`. Everything that it does is in the library beside it.

#![forbid(unsafe_code)]

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(impinge_cli::run(env::args_os().skip(1)))
}
