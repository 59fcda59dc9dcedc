//! Checks that every program prints the content of its file in `examples/expected`.
//!
//! `python/tests/test_examples.py` compares the programs in Python with the same files, so both
//! languages print the same bytes.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Makes a test for each program. Cargo builds the programs before.
macro_rules! tests {
    ($($name:ident),*) => {
        mod prints_what_is_expected {
            $(
                #[test]
                fn $name() {
                    super::check(stringify!($name), env!(concat!("CARGO_BIN_EXE_", stringify!($name))));
                }
            )*
        }

        const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

tests!(
    bounding_volumes,
    character,
    closest_points,
    deforming_mesh,
    many_poses,
    moving_part,
    ray_casting,
    scene_of_parts,
    two_meshes,
    world
);

fn check(name: &str, program: &str) {
    let done = Command::new(program).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let expected = fs::read_to_string(root().join("../expected").join(name).with_extension("txt")).unwrap();
    assert_eq!(String::from_utf8(done.stdout).unwrap(), expected);
}

#[test]
fn every_program_is_tested() {
    let files = fs::read_dir(root().join("src/bin")).unwrap();
    let mut names: Vec<String> =
        files.map(|file| file.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned()).collect();
    names.sort();
    assert_eq!(names, NAMES);
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
