//! `--timeout` and `--memory`: a thread ends the process once a limit is reached.

use std::thread;
use std::time::{Duration, Instant};

use clap::Args;

use crate::console;
use crate::failure::Failure;

/// Time between two checks of the memory. A process that takes two gigabytes a second exceeds its
/// limit by some 40 megabytes.
const INTERVAL: Duration = Duration::from_millis(20);

/// Limits of a run.
#[derive(Args, Clone, Copy)]
pub(crate) struct Limits {
    /// End without an answer after this many seconds
    ///
    /// The exit code is then 2. Files that were being written are removed.
    #[arg(long, value_name = "SECONDS", global = true, value_parser = parse_positive, help_heading = "Limits")]
    timeout: Option<f64>,
    /// End without an answer if the process takes more memory, in gigabytes of 10^9 bytes
    ///
    /// The exit code is then 2. Memory is checked 50 times a second.
    #[arg(long, value_name = "GIGABYTES", global = true, value_parser = parse_positive, help_heading = "Limits")]
    memory: Option<f64>,
}

fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(limit) if limit > 0.0 && limit.is_finite() => Ok(limit),
        _ => Err("a limit is a finite number above 0".to_owned()),
    }
}

impl Limits {
    /// Starts the thread that watches the limits, if there are any.
    pub(crate) fn watch(self, json: bool) {
        if self.timeout.is_none() && self.memory.is_none() {
            return;
        }
        let begun = Instant::now();
        thread::spawn(move || {
            loop {
                if let Some(failure) = self.failure(begun) {
                    console::exit_without_answer(&failure, json);
                    return;
                }
                thread::sleep(INTERVAL);
            }
        });
    }

    /// Returns the failure for the limit that is reached, or `None` if no limit is.
    fn failure(self, begun: Instant) -> Option<Failure> {
        if let Some(timeout) = self.timeout.filter(|&timeout| begun.elapsed().as_secs_f64() > timeout) {
            return Some(Failure::new("timeout", format!("no answer after {timeout} seconds")).at("--timeout"));
        }
        let memory = self.memory?;
        let used = memory_stats::memory_stats()?.physical_mem as f64;
        (used > memory * 1e9)
            .then(|| Failure::new("memory", format!("no answer with {memory} gigabytes of memory")).at("--memory"))
    }
}
