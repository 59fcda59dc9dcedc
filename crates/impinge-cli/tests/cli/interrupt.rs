//! Tests of runs that are interrupted before there is an answer.
#![cfg(unix)]

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::process::{Command, Stdio};

use crate::{Folder, Run};

/// Runs a check of a standard input that never ends, and interrupts it while it loads.
fn interrupted(arguments: &[&str]) -> Run {
    let folder = Folder::new();
    let mut command = folder.command(["check", "-", "cube.obj", "--format", "obj"].iter().chain(arguments));
    let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = streams.spawn().unwrap();
    // A pipe holds far less than this, so writing ends only after the command has read most of it.
    // By then the interrupt handler is installed.
    let mut held_open = child.stdin.take().unwrap();
    held_open.write_all(&[b'\n'; 1 << 20]).unwrap();
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let run = child.wait_with_output().unwrap().into();
    drop(held_open);
    run
}

#[test]
fn an_interrupt_exits_with_two_and_an_error() {
    let stderr = "error: interrupted before the answer was known\n".to_owned();
    assert_eq!(interrupted(&[]), Run { code: 2, stdout: String::new(), stderr: stderr.clone() });
    let object =
        r#"{"error":{"kind":"interrupted","message":"interrupted before the answer was known"},"complete":false}"#;
    assert_eq!(interrupted(&["--json"]), Run { code: 2, stdout: format!("{object}\n"), stderr });
}

/// Returns 1,500 thin triangles along one axis. Each of those with `along` 0 crosses each of those
/// with `along` 1.
fn blades(along: usize) -> String {
    let mut text = String::new();
    for i in 0..1_500 {
        let at = f64::from(i) / 1_500.0;
        let corner = |reach: f64, z: f64| if along == 0 { [reach, at, z] } else { [at, reach, z] };
        for [x, y, z] in [corner(-1.0, 0.0), corner(3.0, 0.0), corner(0.0, 1.0)] {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        writeln!(text, "f -3 -2 -1").unwrap();
    }
    text
}

#[test]
fn an_interrupt_while_a_file_is_written_leaves_the_old_one_and_nothing_else() {
    let folder = Folder::new();
    folder.write("a.obj", &blades(0));
    folder.write("b.obj", &blades(1));
    folder.write("pairs.csv", "the old file");
    let names = || -> Vec<String> {
        let entries = fs::read_dir(folder.path("")).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    let before = names();
    let mut command = folder.command("check a.obj b.obj --pairs pairs.csv".split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while names() == before {
        assert_eq!(child.try_wait().unwrap(), None, "the command ended before its temporary file was seen");
    }
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(2), "the command ended before it was interrupted");
    assert_eq!((names(), folder.read("pairs.csv").as_str()), (before, "the old file"));
}
