//! A sign of life on a terminal, for what takes longer than a second.

use std::io::{self, IsTerminal};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// What is done within this time shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);

/// Something that runs; its spinner goes when this is dropped.
pub(crate) struct Phase(Option<(Sender<()>, JoinHandle<()>)>);

impl Phase {
    /// Begins what `doing` names. Nothing is ever shown where standard error is no terminal.
    pub(crate) fn begin(doing: &'static str) -> Self {
        if !io::stderr().is_terminal() {
            return Self(None);
        }
        let (done, ended) = mpsc::channel();
        let shows = thread::spawn(move || {
            if ended.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                let spinner = ProgressBar::new_spinner().with_elapsed(PATIENCE).with_message(doing);
                spinner.set_style(
                    ProgressStyle::with_template("{spinner} {msg} ({elapsed})")
                        .unwrap_or_else(|_| ProgressStyle::default_spinner()),
                );
                spinner.enable_steady_tick(Duration::from_millis(100));
                let _ = ended.recv(); // an error: the phase was dropped
                spinner.finish_and_clear();
            }
        });
        Self(Some((done, shows)))
    }
}

/// Something whose steps are counted; its bar goes when this is dropped.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// Begins what `doing` names. Nothing is ever shown where standard error is no terminal.
    pub(crate) fn begin(doing: &'static str, steps: u64) -> Self {
        let bar = ProgressBar::new(steps).with_message(doing);
        bar.set_style(
            ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} ({eta})")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        Self(bar)
    }

    /// One more step is done.
    pub(crate) fn advance(&self) {
        self.0.inc(1);
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
            // A spinner that broke has nothing to clear.
            let _ = shows.join();
        }
    }
}
