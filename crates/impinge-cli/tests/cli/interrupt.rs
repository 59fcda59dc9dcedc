//! Interrupted before there is an answer.
#![cfg(unix)]

use std::fs::File;
use std::process::{Command, Stdio};

use crate::{Folder, Run};

/// Runs a check of a file that never comes to its end, and interrupts it while it loads.
fn interrupted(arguments: &[&str]) -> Run {
    let folder = Folder::new();
    let endless = folder.path("endless.obj");
    assert!(Command::new("mkfifo").arg(&endless).status().unwrap().success());
    let mut command = folder.command(["check", "endless.obj", "cube.obj"].iter().chain(arguments));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Opening it for writing waits for the command to open it for reading, which is after it minds interrupts.
    let held_open = File::options().write(true).open(&endless).unwrap();
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    drop(held_open);
    Run {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn an_interrupt_is_no_answer_and_says_so() {
    let stderr = "error: interrupted before the answer was known\n".to_owned();
    assert_eq!(interrupted(&[]), Run { code: 2, stdout: String::new(), stderr: stderr.clone() });
    let object =
        r#"{"error":{"kind":"interrupted","message":"interrupted before the answer was known"},"complete":false}"#;
    assert_eq!(interrupted(&["--json"]), Run { code: 2, stdout: format!("{object}\n"), stderr });
}
