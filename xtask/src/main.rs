//! The chores of the workspace, each a command of `cargo xtask`: checks (`layers`, `file-length`,
//! `prose`), tests (`quick`, `test`), benchmarks and their page (`bench`, `performance`), the
//! documentation site (`docs`), fuzzing (`fuzz`), the page of reports (`viewer`), and `demo`.
#![allow(clippy::print_stdout, reason = "a chore reports to the terminal")]

mod bench;
mod build;
mod demo;
mod docs;
mod environment;
mod file_length;
mod fuzz;
mod layers;
mod performance;
mod prose;
mod python_tests;
mod quick;
mod records;
mod slowest;
mod sources;
mod test_run;
mod unsafe_code;
mod viewer;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

/// Chores of the workspace.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Fail on an import against the order of crates or modules, on files of a module that import
    /// each other, and on `unsafe` outside the permitted modules.
    Layers,
    /// Warn of source files with more than 400 lines, and fail on more than 800.
    FileLength,
    /// After an edit: format, check the layers, build, and run the unit tests of a module and the
    /// cases.
    Quick {
        /// Path of a module of `impinge`, such as `query` or `mesh/pairs/filter`. By default all
        /// unit tests run.
        room: Option<String>,
    },
    /// Run every test, also of the Python package, and print their counts last.
    Test,
    /// Fail on banned phrases, on long lines of prose, and on doc comments that do not begin with a
    /// verb.
    Prose {
        /// Show only the violations below this path.
        path: Option<PathBuf>,
    },
    /// Run a benchmark and append its numbers to `bench/record/NAME/CPU.csv`.
    Bench {
        /// Script of `bench/` or program of `impinge-bench`, without its extension.
        #[arg(required_unless_present = "compare")]
        name: Option<String>,
        /// Run nothing: print the last two commits of each record, or of NAME's, side by side.
        #[arg(long)]
        compare: bool,
        /// Arguments of the benchmark.
        #[arg(last = true)]
        arguments: Vec<String>,
    },
    /// Write `docs/performance.md` from the records of the benchmarks.
    Performance {
        /// Write nothing: fail if the page is not what the records give.
        #[arg(long)]
        check: bool,
    },
    /// Run fuzz targets, record their executions in fuzz/record.csv, and print its totals.
    Fuzz {
        /// Targets of fuzz/targets. By default all run.
        targets: Vec<String>,
        /// Time for all targets together, in seconds. Without a time, only the totals are printed.
        #[arg(long, conflicts_with = "hours")]
        seconds: Option<u64>,
        /// Time for all targets together, in hours.
        #[arg(long)]
        hours: Option<u64>,
    },
    /// Build the documentation site into target/site, and fail on any warning.
    Docs,
    /// Check the page of reports: its types, whether `viewer/` builds the page in the crate, and
    /// what a browser does with it. Without Node or Chromium, say so and skip.
    Viewer {
        /// Replace the page in the crate by the fresh one, and run no browser.
        #[arg(long)]
        write: bool,
    },
    /// Check a human of 26,756 triangles against a torus knot of 2,000,000.
    Demo,
}

fn main() -> Result<ExitCode> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask lies in the workspace")?;
    let passed = match Arguments::parse().chore {
        Chore::Layers => layers_hold(root)?,
        Chore::FileLength => {
            let found = file_length::check(root)?;
            for (_, line) in &found {
                println!("{line}");
            }
            println!("file-length: {} long files", found.len());
            found.iter().all(|(verdict, _)| *verdict != file_length::Verdict::TooLong)
        }
        Chore::Prose { path } => prose_is_plain(root, path.as_deref())?,
        Chore::Bench { name, compare: true, .. } => {
            bench::compare(root, name.as_deref())?;
            true
        }
        Chore::Bench { name, arguments, .. } => bench::run(root, &name.unwrap_or_default(), &arguments)?,
        Chore::Performance { check: true } => {
            let is_current = performance::is_current(root)?;
            println!("performance: the page is {}", if is_current { "current" } else { "not what the records give" });
            is_current
        }
        Chore::Performance { check: false } => {
            performance::write(root)?;
            true
        }
        Chore::Quick { room } => quick::run(root, room.as_deref())?,
        Chore::Test => test_run::run(root)?,
        Chore::Fuzz { targets, seconds, hours } => {
            fuzz::run(root, &targets, seconds.or(hours.map(|hours| 3600 * hours)))?
        }
        Chore::Docs => docs::build(root)?,
        Chore::Viewer { write } => viewer::run(root, write)?,
        Chore::Demo => demo::run(root)?,
    };
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Prints each violation of the order of crates and modules, and each `unsafe` outside the
/// permitted modules. Returns `true` if there are no violations.
fn layers_hold(root: &Path) -> Result<bool> {
    let mut violations = layers::check(root)?;
    violations.extend(unsafe_code::check(root)?);
    for violation in &violations {
        println!("{violation}");
    }
    println!("layers: {} violations", violations.len());
    Ok(violations.is_empty())
}

/// Prints each violation of the rules of prose, below `path` if it is given, and the word counts.
/// Returns `true` if there are no violations.
fn prose_is_plain(root: &Path, path: Option<&Path>) -> Result<bool> {
    let mut violations = prose::check(root)?;
    violations.retain(|violation| path.is_none_or(|path| violation.file.starts_with(path)));
    for violation in &violations {
        println!("{violation}");
    }
    println!("\nIn 1,000 words of prose:");
    for folder in prose::thermometer::FOLDERS {
        println!("{}", prose::thermometer::measure(root, folder)?);
    }
    println!("prose: {} violations", violations.len());
    Ok(violations.is_empty())
}
