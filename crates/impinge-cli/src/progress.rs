//! Progress on a terminal, for phases that take longer than a second.

use std::io::{self, IsTerminal};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Delay before a spinner appears. Shorter phases show nothing.
const SPINNER_DELAY: Duration = Duration::from_secs(1);

/// A running phase with a spinner. Dropping it removes the spinner.
pub(crate) struct Phase(Option<(Sender<()>, JoinHandle<()>)>);

impl Phase {
    /// Begins a phase; `doing` is its label. Shows nothing if standard error is not a terminal.
    pub(crate) fn begin(doing: &'static str) -> Self {
        if !io::stderr().is_terminal() {
            return Self(None);
        }
        let (done, ended) = mpsc::channel();
        let shows = thread::spawn(move || {
            if ended.recv_timeout(SPINNER_DELAY) == Err(RecvTimeoutError::Timeout) {
                let spinner = ProgressBar::new_spinner().with_elapsed(SPINNER_DELAY).with_message(doing);
                spinner.set_style(
                    ProgressStyle::with_template("{spinner} {msg} ({elapsed})")
                        .unwrap_or_else(|_| ProgressStyle::default_spinner()),
                );
                spinner.enable_steady_tick(Duration::from_millis(100));
                let _ = ended.recv(); // Returns an error when the phase is dropped.
                spinner.finish_and_clear();
            }
        });
        Self(Some((done, shows)))
    }
}

/// A phase whose steps are counted, with a progress bar. Dropping it removes the bar.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// Begins a phase of `steps` steps; `doing` is its label. Shows nothing if standard error is
    /// not a terminal.
    pub(crate) fn begin(doing: &'static str, steps: u64) -> Self {
        let bar = ProgressBar::new(steps).with_message(doing);
        bar.set_style(
            ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} ({eta})")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        Self(bar)
    }

    /// Counts one more step as done.
    pub(crate) fn advance(&self) {
        self.advance_by(1);
    }

    /// Counts more steps as done. Several threads may call it at the same time.
    pub(crate) fn advance_by(&self, steps: u64) {
        self.0.inc(steps);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

impl Drop for Phase {
    fn drop(&mut self) {
        if let Some((done, shows)) = self.0.take() {
            drop(done);
            // Ignore a spinner that panicked: there is nothing to clear.
            let _ = shows.join();
        }
    }
}
