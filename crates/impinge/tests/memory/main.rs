//! Tests that measure memory. They are a separate program, because the allocator counts the memory
//! of the whole program.

mod churn;
mod explosion;

use std::sync::{Mutex, MutexGuard, PoisonError};

use peak_alloc::PeakAlloc;

#[global_allocator]
static COUNTED: PeakAlloc = PeakAlloc;

/// Waits until no other test of this program runs, so that only the caller's memory is counted.
fn alone() -> MutexGuard<'static, ()> {
    static RUNNING: Mutex<()> = Mutex::new(());
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}
