//! Robots from URDF and SRDF files.

mod meshes;
mod mutants;
mod srdf;
mod urdf;

use std::{
    fs,
    path::{Path, PathBuf},
};

use impinge_files::{LoadError, LoadedRobot, RobotOptions, load_robot};
use tempfile::TempDir;

/// Folder of the robot that is made of primitives.
fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robots")
}

/// A folder with a URDF file and other files.
struct Folder(TempDir);

impl Folder {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, text) in files {
            let path = folder.path(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, options: &RobotOptions) -> Result<LoadedRobot, LoadError> {
        load_robot(self.path("robot.urdf"), options)
    }
}

/// Loads the text of a URDF file.
fn load(text: &str) -> Result<LoadedRobot, LoadError> {
    Folder::new(&[("robot.urdf", text)]).load(&RobotOptions::default())
}

/// Returns the message of an error, without the folder of the file.
fn message(error: &LoadError) -> String {
    let text = error.to_string();
    let folder = format!("{}/", error.path().parent().unwrap().display());
    text.replace(&folder, "")
}

/// Returns the text of a robot with these elements, each in a line of its own after the first line.
fn robot(elements: &[&str]) -> String {
    format!("<robot name=\"r\">\n{}\n</robot>", elements.join("\n"))
}
