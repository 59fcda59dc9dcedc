//! Tests of standard output and standard error when they are closed, full or not a terminal.

use std::io;

use crate::Folder;

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = Folder::new();
    for (arguments, code) in [
        (["check", "cube.obj", "cube.obj", "--pose-b", "0.5,0,0"], 1),
        (["check", "cube.obj", "cube.obj", "--pose-b", "5,0,0"], 0),
        (["check", "cube.obj", "gone.obj", "--pose-b", "5,0,0"], 2),
        (["check", "--help", "", "", ""], 0),
    ] {
        for json in [&[][..], &["--json"]] {
            let (reader, writer) = io::pipe().unwrap();
            drop(reader);
            let output = folder.command(arguments.iter().chain(json)).stdout(writer).output().unwrap();
            assert_eq!(output.status.code(), Some(code), "{arguments:?}");
            let stderr = String::from_utf8(output.stderr).unwrap();
            assert_eq!(stderr.is_empty(), code != 2, "{stderr}");
            assert!(!stderr.contains("panicked"), "{stderr}");
        }
    }
    let (reader, writer) = io::pipe().unwrap();
    drop(reader);
    let status = folder.command(["check", "cube.obj", "gone.obj"]).stderr(writer).status().unwrap();
    assert_eq!(status.code(), Some(2));
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_that_cannot_be_written_is_an_error() {
    let folder = Folder::new();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = folder.command(["check", "cube.obj", "cube.obj"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.starts_with("error: the report cannot be written to standard output: "), "{stderr}");
}

#[test]
fn colors_are_printed_only_on_terminals_or_if_forced() {
    let folder = Folder::new();
    let colored = |variables: &[(&str, &str)], arguments: &[&str]| {
        let mut command = folder.command(arguments);
        command.envs(variables.iter().copied());
        let output = command.output().unwrap();
        [output.stdout, output.stderr].map(|bytes| bytes.contains(&0x1b))
    };
    let check = ["check", "cube.obj", "big.obj"];
    assert_eq!(colored(&[], &check), [false, false]);
    assert_eq!(colored(&[("CLICOLOR_FORCE", "1")], &check), [true, true]);
    assert_eq!(colored(&[("CLICOLOR_FORCE", "1")], &["check", "cube.obj", "big.obj", "--json"]), [false, true]);
    assert_eq!(colored(&[("CLICOLOR_FORCE", "0"), ("NO_COLOR", "1")], &check), [false, false]);
}
