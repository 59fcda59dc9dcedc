//! `cargo xtask quick [ROOM]`: what can be checked within a minute of an edit.

use std::path::Path;

use anyhow::{Context, Result};

use crate::layers_hold;
use crate::test_run::{Tests, cargo, programs};

/// Programs that a quick run builds: the unit tests of `impinge` and its integration tests, which contain the cases.
const PROGRAMS: [&str; 5] = ["--package=impinge", "--lib", "--test", "it", "--quiet"];

/// Formats the code, checks the layers, builds `impinge`, and runs the unit tests of a room and the cases. Returns whether all is well.
///
/// A room is a module by its path, `query` or `mesh/filter`. Without one the unit tests of all rooms run.
pub(crate) fn run(root: &Path, room: Option<&str>) -> Result<bool> {
    cargo().args(["fmt", "--all"]).current_dir(root).status().context("starting cargo fmt")?;
    let layers_hold = layers_hold(root)?;
    let mut tests = Tests::default();
    for program in programs(root, &PROGRAMS)? {
        let filter = if program.is_of_units() {
            room.map(|room| room.replace('/', "::") + "::")
        } else {
            Some("cases::".into())
        };
        tests.run(program.command().args(filter))?;
    }
    println!("{}", tests.slowest);
    println!("{}", tests.counts);
    Ok(layers_hold && tests.all_passed())
}
