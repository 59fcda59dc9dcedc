//! Slices of a search. After each slice the search may end.

use std::ops::ControlFlow::{self, Break, Continue};

use crate::budget::Budget;

/// Number of tasks in a slice. A slice takes about 100 microseconds.
const TASKS_PER_SLICE: usize = 1 << 9;

/// Counts the tasks of a search and checks the budget after each slice.
pub(super) struct Slices<'i> {
    budget: &'i Budget<'i>,
    /// Number of tasks so far.
    tasks: usize,
    /// Whether the budget was spent before the search was complete.
    pub(super) is_stopped: bool,
}

impl<'i> Slices<'i> {
    pub(super) fn new(budget: &'i Budget<'i>) -> Self {
        Self { budget, tasks: 0, is_stopped: false }
    }

    /// Counts a task. Breaks if the task ends a slice and the budget is spent.
    #[inline(always)]
    pub(super) fn count_task(&mut self) -> ControlFlow<()> {
        self.tasks += 1;
        if self.tasks.is_multiple_of(TASKS_PER_SLICE) && self.budget.is_spent() {
            self.is_stopped = true;
            return Break(());
        }
        Continue(())
    }
}
