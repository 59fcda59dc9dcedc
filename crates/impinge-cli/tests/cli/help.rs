//! Tests of the help and its examples, of the completion scripts, and of the manual pages.

use std::fs;

use crate::Folder;

/// A tetrahedron in ASCII STL.
const TETRAHEDRON: &str = "solid t\n\
    facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n\
    facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n\
    facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n\
    facet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n\
    endsolid t\n";

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/robot.glb");

const COMMANDS: [&str; 11] =
    ["bake", "check", "clash", "completions", "decompose", "fit", "hits", "inspect", "man", "robot", "world"];

/// Returns the commands of the section "Examples" of a help text.
fn examples(help: &str) -> Vec<&str> {
    let (_, section) = help.split_once("\nExamples:\n").unwrap();
    let lines = section.lines().map_while(|line| line.strip_prefix("  impinge "));
    lines.map(|line| line.split_once("  ").unwrap().0).collect()
}

#[test]
fn the_twelve_examples_of_the_help_run() {
    let folder = Folder::new();
    folder.write("a.stl", TETRAHEDRON);
    folder.write("b.stl", TETRAHEDRON);
    fs::copy(ROBOT, folder.path("robot.glb")).unwrap();
    let help = folder.run("--help");
    assert_eq!((help.code, help.stderr.as_str()), (0, ""));
    let (_, section) = help.stdout.split_once("\nExamples:\n").unwrap();
    assert!(section.lines().all(|line| line.chars().count() <= 71), "{section}");
    let examples = examples(&help.stdout);
    assert_eq!(examples.len(), 12);
    for example in examples {
        let run = folder.run(example);
        assert!(run.code < 2 && run.stderr.is_empty(), "{example}: {run:?}");
    }
}

#[test]
fn no_arguments_print_the_help_with_its_examples_to_standard_error() {
    let folder = Folder::new();
    let run = folder.run("");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert_eq!(examples(&run.stderr), examples(&folder.run("--help").stdout));
}

#[test]
fn every_shell_gets_a_completion_script() {
    let folder = Folder::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let run = folder.run(&format!("completions {shell}"));
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{shell}");
        assert!(COMMANDS.iter().all(|command| run.stdout.contains(command)), "{shell}: {}", run.stdout);
        assert!(run.stdout.contains("clearance"), "{shell}: {}", run.stdout);
    }
    assert_eq!(folder.run("completions tcsh").code, 2);
}

#[cfg(target_os = "linux")]
#[test]
fn bash_completes_options_by_the_script() {
    let folder = Folder::new();
    folder.write("script", &folder.run("completions bash").stdout);
    let lines = "source ./script; COMP_WORDS=(impinge check --cl); COMP_CWORD=2; _impinge impinge --cl check; \
        echo ${COMPREPLY[*]}";
    let output = std::process::Command::new("bash").args(["-c", lines]).current_dir(folder.path("")).output().unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "--clearance\n", "{:?}", output.stderr);
}

#[test]
fn each_command_has_a_manual_page() {
    let folder = Folder::new();
    let run = folder.run("man share/man1");
    assert_eq!((run.code, run.stdout.as_str(), run.stderr.as_str()), (0, "", ""));
    let entries = fs::read_dir(folder.path("share/man1")).unwrap();
    let mut pages: Vec<_> = entries.map(|page| page.unwrap().file_name().into_string().unwrap()).collect();
    pages.sort();
    let mut expected: Vec<_> = COMMANDS.iter().map(|command| format!("impinge-{command}.1")).collect();
    expected.extend(
        ["audit", "check", "clearance", "inspect", "motion"].map(|question| format!("impinge-robot-{question}.1")),
    );
    expected.push("impinge.1".to_owned());
    expected.sort();
    assert_eq!(pages, expected);
    assert!(folder.read("share/man1/impinge.1").contains("Examples:"));
    assert!(folder.read("share/man1/impinge-check.1").contains(r"\-\-clearance"));
}

#[test]
fn manual_pages_are_not_written_over_a_file() {
    let folder = Folder::new();
    let run = folder.run("man cube.obj");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.starts_with("error: cube.obj: the manual pages cannot be written: "), "{}", run.stderr);
}
