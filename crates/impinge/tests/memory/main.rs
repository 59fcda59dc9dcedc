//! Tests that measure memory. They are a program of their own, because its allocator counts the memory of the whole program.

mod churn;
mod explosion;

use std::sync::{Mutex, MutexGuard, PoisonError};

use peak_alloc::PeakAlloc;

#[global_allocator]
static COUNTED: PeakAlloc = PeakAlloc;

/// Waits until no other test of this program runs, so that the memory that is counted is the caller's alone.
fn alone() -> MutexGuard<'static, ()> {
    static RUNNING: Mutex<()> = Mutex::new(());
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}
