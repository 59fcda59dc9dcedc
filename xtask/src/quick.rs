//! `cargo xtask quick [ROOM]`: the checks that follow an edit of `impinge`.

use std::path::Path;

use anyhow::{Context, Result, ensure};

use crate::build::cargo;
use crate::layers_hold;
use crate::test_run::{Tests, programs};

/// Arguments of Cargo that select the unit tests of `impinge` and its integration tests, which
/// contain the cases. Without default features, kernels are compiled for two vector levels. Every
/// processor has one of them.
const PROGRAMS: [&str; 6] = ["--package=impinge", "--no-default-features", "--lib", "--test", "it", "--quiet"];

/// Formats the code, checks the layers, builds `impinge`, and runs the unit tests of a room and the
/// cases. Returns `true` if everything passes.
///
/// A room is a module, named by its path: `query` or `mesh/pairs/filter`. Without a room, all unit
/// tests run.
///
/// # Errors
/// Returns an error if the room does not exist, or if the code cannot be parsed or compiled.
pub(crate) fn run(root: &Path, room: Option<&str>) -> Result<bool> {
    if let Some(room) = room {
        let module = root.join("crates/impinge/src").join(room);
        let is_room = module.is_dir() || module.with_extension("rs").is_file();
        ensure!(
            is_room,
            "{room}: not a module of impinge. Name one by its path, such as `query` or `mesh/pairs/filter`."
        );
    }
    let format = cargo().args(["fmt", "--all"]).current_dir(root).status().context("starting cargo fmt")?;
    ensure!(format.success(), "cargo fmt cannot parse the code");
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
