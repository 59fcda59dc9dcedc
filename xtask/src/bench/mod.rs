//! `cargo xtask bench NAME`: runs a benchmark and appends its numbers to its record.
//!
//! A benchmark writes rows to the file that the environment variable [`ROWS`] names, by
//! `impinge_bench::record` in Rust and by `bench/record.py` in Python. The chore adds the date, the
//! commit and the command once the benchmark has succeeded. So a benchmark that finds a wrong
//! answer records nothing.

pub(crate) mod compare;
pub(crate) mod cpu;

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use cargo_metadata::{MetadataCommand, TargetKind};

use crate::build::cargo;
use crate::records::{self, Circumstances};

/// Environment variable that names the file for the rows of a benchmark.
const ROWS: &str = "IMPINGE_RECORD";

/// Package of the benchmarks in Rust.
const PACKAGE: &str = "impinge-bench";

/// Runs a benchmark and appends its numbers to `bench/record/NAME/CPU.csv`.
///
/// Returns `false` if the benchmark fails. It then records nothing, and has printed the reason.
///
/// # Errors
/// There is no benchmark of this name, it cannot be started, or it wrote no rows.
pub(crate) fn run(root: &Path, name: &str, arguments: &[String]) -> Result<bool> {
    let rows = root.join("target/bench").join(format!("{name}.csv"));
    fs::create_dir_all(root.join("target/bench")).context("creating target/bench")?;
    fs::write(&rows, "").with_context(|| format!("emptying {}", rows.display()))?;
    let circumstances = circumstances(root, name, arguments)?;
    let mut command = command(root, name)?;
    let status = command.args(arguments).env(ROWS, &rows).current_dir(root).status();
    if !status.with_context(|| format!("starting {command:?}"))?.success() {
        println!("{name} failed, so nothing is recorded. The rows so far are in {}.", rows.display());
        return Ok(false);
    }
    let measured = records::read_measured(&rows)?;
    ensure!(!measured.is_empty(), "{name} wrote no rows. Record its numbers as CONTRIBUTING.md describes.");
    let (count, file) = (measured.len(), records::path(name, &cpu::slug()));
    records::append(&root.join(&file), &circumstances, measured)?;
    println!("{count} rows recorded in {}", file.display());
    Ok(true)
}

/// Prints the last two commits of each record side by side, or of the records of one benchmark.
///
/// # Errors
/// A record cannot be read, or this benchmark has no record.
pub(crate) fn compare(root: &Path, name: Option<&str>) -> Result<()> {
    let mut records = records::read_all(root)?;
    records.retain(|record| name.is_none_or(|name| record.bench == name));
    ensure!(!records.is_empty(), "no records in {}", Path::new(records::FOLDER).join(name.unwrap_or("")).display());
    for record in &records {
        match compare::last_two(record) {
            Some(comparison) => println!("{comparison}"),
            None => println!("{} on {}: no two commits to compare\n", record.bench, record.cpu),
        }
    }
    Ok(())
}

/// Returns the command that runs a benchmark: a script of `bench/`, or a program of `impinge-bench`
/// with the features that it needs.
fn command(root: &Path, name: &str) -> Result<Command> {
    let script = Path::new("bench").join(format!("{name}.py"));
    if root.join(&script).is_file() {
        let mut python = Command::new(if cfg!(windows) { "python" } else { "python3" });
        python.arg(script);
        return Ok(python);
    }
    let metadata = MetadataCommand::new().no_deps().current_dir(root).exec()?;
    let package = metadata.packages.iter().find(|package| package.name.as_str() == PACKAGE);
    let targets = &package.with_context(|| format!("the workspace has no package {PACKAGE}"))?.targets;
    let mut programs = targets.iter().filter(|target| target.kind.contains(&TargetKind::Bin));
    let target = programs.find(|target| target.name == name).with_context(|| {
        format!("{name}: not a benchmark. Name a script of bench/ or a program of {PACKAGE}, without its extension.")
    })?;
    let mut cargo = cargo();
    cargo.args(["run", "--release", "--package", PACKAGE, "--bin", name]);
    for feature in &target.required_features {
        cargo.args(["--features", feature]);
    }
    cargo.arg("--");
    Ok(cargo)
}

/// Returns the circumstances of a run that begins now.
fn circumstances(root: &Path, name: &str, arguments: &[String]) -> Result<Circumstances> {
    let git = Command::new("git")
        .args(["describe", "--always", "--dirty", "--exclude=*"])
        .current_dir(root)
        .output()
        .context("starting git")?;
    ensure!(git.status.success(), "git describe: {}", String::from_utf8_lossy(&git.stderr).trim());
    let mut command = format!("cargo xtask bench {name}");
    if !arguments.is_empty() {
        command += " --";
    }
    for argument in arguments {
        command = format!("{command} {}", quoted(argument));
    }
    Ok(Circumstances {
        date: time::OffsetDateTime::now_utc().date().to_string(),
        commit: String::from_utf8_lossy(&git.stdout).trim().to_owned(),
        command,
    })
}

/// Returns an argument as a shell reads it back: between quotes if it has other signs than letters,
/// digits and common punctuation.
fn quoted(argument: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@".contains(c);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        argument.to_owned()
    } else {
        format!("'{}'", argument.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_can_be_repeated_in_a_shell() {
        assert_eq!(["--rounds", "5", "a b", "it's", ""].map(quoted), ["--rounds", "5", "'a b'", "'it'\\''s'", "''"]);
    }

    #[test]
    fn scripts_and_programs_are_found_by_name() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let words = |name| {
            let command = command(root, name)?;
            anyhow::Ok(command.get_args().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" "))
        };
        assert_eq!(words("rivals").unwrap().replace('\\', "/"), "bench/rivals.py");
        assert_eq!(
            words("headline").unwrap(),
            "run --release --package impinge-bench --bin headline --",
            "a program without features"
        );
        assert!(words("shapes").unwrap().contains("--features peers"));
        assert!(words("no such benchmark").is_err());
    }
}
