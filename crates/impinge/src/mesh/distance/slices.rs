//! Slices of a search. After each slice the search may be interrupted.

use std::ops::ControlFlow::{self, Break, Continue};

use crate::mesh::Interrupt;

/// Number of tasks in a slice. A slice takes about 100 microseconds.
const TASKS_PER_SLICE: usize = 1 << 9;

/// Counts the tasks of a search and checks for an interruption after each slice.
pub(super) struct Slices<'i> {
    interrupt: Interrupt<'i>,
    /// Number of tasks so far.
    tasks: usize,
    /// Whether the search was interrupted.
    pub(super) is_interrupted: bool,
}

impl<'i> Slices<'i> {
    pub(super) fn new(interrupt: Interrupt<'i>) -> Self {
        Self { interrupt, tasks: 0, is_interrupted: false }
    }

    /// Counts a task. Breaks if the task ends a slice and an interruption is wanted.
    #[inline(always)]
    pub(super) fn count_task(&mut self) -> ControlFlow<()> {
        self.tasks += 1;
        if self.tasks.is_multiple_of(TASKS_PER_SLICE) && self.interrupt.is_wanted() {
            self.is_interrupted = true;
            return Break(());
        }
        Continue(())
    }
}
