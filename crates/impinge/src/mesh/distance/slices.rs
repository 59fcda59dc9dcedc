//! Slices of a search, between which it may be interrupted.

use std::ops::ControlFlow::{self, Break, Continue};

use crate::mesh::Interrupt;

/// Number of tasks in a slice: about 100 microseconds.
const TASKS: usize = 1 << 9;

pub(super) struct Slices<'i> {
    interrupt: Interrupt<'i>,
    tasks: usize,
    /// Whether the search was interrupted.
    pub(super) is_interrupted: bool,
}

impl<'i> Slices<'i> {
    pub(super) fn new(interrupt: Interrupt<'i>) -> Self {
        Self { interrupt, tasks: 0, is_interrupted: false }
    }

    /// Counts a task. Breaks if a slice ends with it and the search is interrupted.
    #[inline(always)]
    pub(super) fn count_task(&mut self) -> ControlFlow<()> {
        self.tasks += 1;
        if self.tasks.is_multiple_of(TASKS) && self.interrupt.is_wanted() {
            self.is_interrupted = true;
            return Break(());
        }
        Continue(())
    }
}
