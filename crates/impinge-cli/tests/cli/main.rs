//! End-to-end tests of the command: exit codes, both output streams, and the files that it writes.

mod answers;
mod bake;
mod clash;
mod clash_bcf;
mod decompose;
mod distances;
mod errors;
mod files;
mod fit;
mod help;
mod hits;
mod inspect;
mod interrupt;
mod limits;
mod pages;
mod robot;
mod solids;
mod streams;
mod units;
mod world;

use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A temporary folder with small meshes, in which the command runs.
struct Folder(TempDir);

/// Result of one run.
#[derive(Debug, PartialEq)]
struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Folder {
    /// Creates the folder with `cube.obj`, from 0 to 1 on each axis, and `big.obj`, from -2 to 3.
    fn new() -> Self {
        let folder = Self(TempDir::new().unwrap());
        folder.write("cube.obj", &cuboid("cube", [0.0; 3], 1.0));
        folder.write("big.obj", &cuboid("big", [-2.0; 3], 5.0));
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn command<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_impinge"));
        command.current_dir(self.0.path()).args(arguments);
        for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
            command.env_remove(variable);
        }
        command
    }

    /// Runs the command with arguments separated by spaces.
    fn run(&self, arguments: &str) -> Run {
        self.command(arguments.split_whitespace()).output().unwrap().into()
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

/// Returns a closed cube of 12 triangles as OBJ, with 8 vertices and 6 quadrilaterals.
fn cuboid(name: &str, min: [f64; 3], edge: f64) -> String {
    let corner = |i: usize| [0, 1, 2].map(|axis| min[axis] + if i >> axis & 1 == 1 { edge } else { 0.0 });
    let vertices = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"].map(|face| format!("f {face}\n"));
    vertices.chain([format!("o {name}\n")]).chain(faces).collect()
}

/// Returns the JSON object up to the times, which differ between runs. Asserts that the times come
/// last and are complete.
fn without_seconds(json: &str) -> &str {
    let (before, seconds) = json.split_once(",\"seconds\":").unwrap();
    let times: serde_json::Value = serde_json::from_str(seconds.strip_suffix("}\n").unwrap()).unwrap();
    assert_eq!(times.as_object().unwrap().len(), 3);
    assert!(["load", "build", "query"].iter().all(|phase| times[phase].as_f64().unwrap() >= 0.0));
    let at = ["load", "build", "query"].map(|phase| seconds.find(phase).unwrap());
    assert!(at.is_sorted());
    before
}
