//! Tests of runs that reach a limit before there is an answer.

use std::io::Write as _;
use std::process::Stdio;

use crate::{Folder, Run};

/// Runs a check of a standard input that never ends.
fn limited(arguments: &[&str]) -> Run {
    let folder = Folder::new();
    let mut command = folder.command(["check", "-", "cube.obj", "--format", "obj"].iter().chain(arguments));
    let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = streams.spawn().unwrap();
    let mut held_open = child.stdin.take().unwrap();
    // The command may end before it reads all of this.
    let _ = held_open.write_all(&[b'\n'; 1 << 16]);
    let run = child.wait_with_output().unwrap().into();
    drop(held_open);
    run
}

#[test]
fn a_run_ends_at_its_limits_with_two_and_an_error() {
    for (argument, value, kind, message) in [
        ("--timeout", "0.05", "timeout", "no answer after 0.05 seconds"),
        ("--memory", "0.0001", "memory", "no answer with 0.0001 gigabytes of memory"),
    ] {
        let stderr = format!("error: {argument}: {message}\n");
        assert_eq!(limited(&[argument, value]), Run { code: 2, stdout: String::new(), stderr: stderr.clone() });
        let object =
            format!(r#"{{"error":{{"kind":"{kind}","where":"{argument}","message":"{message}"}},"complete":false}}"#);
        assert_eq!(limited(&["--json", argument, value]), Run { code: 2, stdout: format!("{object}\n"), stderr });
    }
}

#[test]
fn limits_that_are_not_reached_change_nothing() {
    let folder = Folder::new();
    let plain = folder.run("check cube.obj big.obj --pairs pairs.csv");
    let limited = folder.run("check cube.obj big.obj --pairs pairs.csv --timeout 3600 --memory 1000");
    assert_eq!((limited.code, limited.stderr), (plain.code, plain.stderr));
    for value in ["0", "-1", "nan", "inf", "x"] {
        let run = folder.run(&format!("inspect cube.obj --timeout={value}"));
        assert!(run.code == 2 && run.stderr.contains("a limit is a finite number above 0"), "{value}: {run:?}");
    }
}
