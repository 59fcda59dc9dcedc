//! `cargo xtask fuzz [TARGET ...] --seconds S`: runs fuzz targets and records their executions.

use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

/// File that has a row for each run of a target.
const RECORD: &str = "fuzz/record.csv";

/// Options of libFuzzer. An input that takes 10 seconds or 2 GiB is a failure. Inputs of more than
/// 4 KiB rarely find anything that shorter ones do not.
const LIMITS: [&str; 4] = ["-timeout=10", "-rss_limit_mb=2048", "-max_len=4096", "-print_final_stats=1"];

/// Targets whose own output is closed, because they print a report for each input.
const CHATTY: [&str; 1] = ["command"];

/// A run of a target.
#[derive(Serialize, Deserialize)]
struct Run {
    commit: String,
    target: String,
    seconds: u64,
    executions: u64,
    crashes: u64,
}

/// Runs targets, all by default, each for its share of the time, and appends their executions to
/// the record. Without a time nothing is run. Prints the totals of the record. Returns `false` if
/// an input failed.
///
/// # Errors
/// Returns an error if a target does not exist, or if it cannot be built or started.
pub(crate) fn run(root: &Path, chosen: &[String], seconds: Option<u64>) -> Result<bool> {
    let all = targets(root)?;
    if let Some(unknown) = chosen.iter().find(|target| !all.contains(target)) {
        bail!("{unknown}: not a fuzz target. The targets are {}.", all.join(", "));
    }
    let chosen = if chosen.is_empty() { &all } else { chosen };
    let mut passed = true;
    if let Some(seconds) = seconds {
        let share = seconds / chosen.len() as u64;
        ensure!(share > 0, "{seconds} seconds are too short for {} targets", chosen.len());
        for target in chosen {
            ensure!(fuzz(root, "build", target).status().context(NEEDS)?.success(), NEEDS);
        }
        let commit = commit(root)?;
        for target in chosen {
            let run = run_target(root, target, share, &commit)?;
            let rate = run.executions / run.seconds.max(1);
            println!("{target}: {} executions, {rate} a second, {} crashes", run.executions, run.crashes);
            passed &= run.crashes == 0;
            append(root, &run)?;
        }
    }
    print_totals(&recorded(root)?);
    Ok(passed)
}

/// Error if Cargo cannot fuzz, with the programs that it needs.
const NEEDS: &str = "cargo fuzz failed: it needs `rustup toolchain install nightly`, a C++ compiler, and `cargo install \
    cargo-fuzz`";

/// Returns the names of all targets, sorted.
fn targets(root: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(root.join("fuzz/targets")).context("reading fuzz/targets")? {
        let path = entry?.path();
        names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
    }
    names.sort();
    Ok(names)
}

/// Leaves two vector levels in the kernels, AVX2 and the baseline. The answers do not depend on the
/// level, and a build with all levels takes twice as long.
const TWO_LEVELS: &str = "--cfg disable_dispatch_avx512 --cfg disable_dispatch_sse4_2";

/// Returns a command of `cargo fuzz` for a target. Sanitizers are off: there is almost no `unsafe`
/// to check, and without them four times as many inputs run.
fn fuzz(root: &Path, verb: &str, target: &str) -> Command {
    let mut command = Command::new("cargo");
    command.args(["+nightly", "fuzz", verb, "--sanitizer", "none", "--codegen-units", "8", target]);
    command.current_dir(root).env("RUSTFLAGS", TWO_LEVELS);
    // Cargo sets these for the stable toolchain that runs this chore.
    for variable in ["CARGO", "RUSTC", "RUSTUP_TOOLCHAIN"] {
        command.env_remove(variable);
    }
    command
}

/// Runs a built target for some seconds and counts its executions.
fn run_target(root: &Path, target: &str, seconds: u64, commit: &str) -> Result<Run> {
    // A target may work in another folder.
    let [corpus, seeds] = ["corpus", "seeds"].map(|folder| root.join("fuzz").join(folder).join(target));
    fs::create_dir_all(&corpus).context("making a folder for the corpus")?;
    let mut command = fuzz(root, "run", target);
    command.args([corpus, seeds]).arg("--").args(LIMITS).arg(format!("-max_total_time={seconds}"));
    let dictionary = root.join(format!("fuzz/dictionaries/{target}.dict"));
    if dictionary.exists() {
        command.arg(format!("-dict={}", dictionary.display()));
    }
    if CHATTY.contains(&target) {
        command.arg("-close_fd_mask=3");
    }
    let start = Instant::now();
    let mut running = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().context(NEEDS)?;
    let mut executions = 0;
    let mut last: Vec<String> = Vec::new();
    for line in BufReader::new(running.stderr.take().context("standard error is piped")?).lines() {
        let line = line.unwrap_or_default();
        if let Some(count) = executions_in(&line) {
            executions = count;
        }
        last.push(line);
        last.drain(..last.len().saturating_sub(REPORTED));
    }
    let crashes = u64::from(!running.wait()?.success());
    if crashes > 0 {
        println!("{}", last.join("\n"));
    }
    let seconds = start.elapsed().as_secs();
    Ok(Run { commit: commit.into(), target: target.into(), seconds, executions, crashes })
}

/// Number of lines of a failed run that are printed.
const REPORTED: usize = 60;

/// Returns the number of executions that a line of final statistics states, or `None` for any
/// other line.
fn executions_in(line: &str) -> Option<u64> {
    line.strip_prefix("stat::number_of_executed_units:")?.trim().parse().ok()
}

/// Returns the short name of the current commit.
fn commit(root: &Path) -> Result<String> {
    let output = Command::new("git").args(["rev-parse", "--short", "HEAD"]).current_dir(root).output();
    Ok(String::from_utf8_lossy(&output.context("starting git")?.stdout).trim().to_owned())
}

/// Appends a run to the record.
fn append(root: &Path, run: &Run) -> Result<()> {
    let path = root.join(RECORD);
    let is_new = !path.exists();
    let file = OpenOptions::new().create(true).append(true).open(&path).context(RECORD)?;
    let mut rows = csv::WriterBuilder::new().has_headers(is_new).from_writer(file);
    rows.serialize(run).context(RECORD)?;
    rows.flush().context(RECORD)
}

/// Returns all recorded runs.
fn recorded(root: &Path) -> Result<Vec<Run>> {
    let path = root.join(RECORD);
    if !path.exists() {
        return Ok(Vec::new());
    }
    csv::Reader::from_path(path)?.deserialize().collect::<Result<_, _>>().context(RECORD)
}

/// Prints the seconds and executions of each target, and of all.
fn print_totals(runs: &[Run]) {
    let mut totals: BTreeMap<&str, [u64; 3]> = BTreeMap::new();
    for run in runs {
        for name in [run.target.as_str(), "~ all"] {
            let total = totals.entry(name).or_default();
            for (sum, more) in total.iter_mut().zip([run.seconds, run.executions, run.crashes]) {
                *sum += more;
            }
        }
    }
    println!("{:16} {:>10} {:>14} {:>8}", "recorded", "seconds", "executions", "crashes");
    for (name, [seconds, executions, crashes]) in totals {
        println!("{:16} {seconds:10} {executions:14} {crashes:8}", name.trim_start_matches("~ "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn executions_are_read_from_the_final_statistics() {
        assert_eq!(executions_in("stat::number_of_executed_units: 524288"), Some(524_288));
        assert_eq!(executions_in("#524288 DONE cov: 10"), None);
    }

    #[test]
    fn a_record_is_appended_to_and_read_back() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("fuzz")).unwrap();
        for executions in [5, 7] {
            let run = Run { commit: "a".into(), target: "obj".into(), seconds: 1, executions, crashes: 0 };
            append(folder.path(), &run).unwrap();
        }
        let runs = recorded(folder.path()).unwrap();
        assert_eq!(runs.iter().map(|run| run.executions).sum::<u64>(), 12);
        assert_eq!(fs::read_to_string(folder.path().join(RECORD)).unwrap().lines().count(), 3);
    }

    #[test]
    fn every_target_has_seeds_and_is_a_program() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let manifest = fs::read_to_string(root.join("fuzz/Cargo.toml")).unwrap();
        let targets = targets(root).unwrap();
        assert!(targets.len() >= 18, "{targets:?}");
        for target in targets {
            assert!(manifest.contains(&format!("path = \"targets/{target}.rs\"")), "{target}");
            assert!(root.join("fuzz/seeds").join(&target).is_dir(), "{target}");
        }
        for dictionary in fs::read_dir(root.join("fuzz/dictionaries")).unwrap() {
            let name = dictionary.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned();
            assert!(root.join("fuzz/targets").join(&name).with_extension("rs").exists(), "{name}");
        }
    }
}
