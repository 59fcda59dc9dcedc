//! Turns at a world. One call at a time has the turn, and may read and change the world.

use std::sync::{
    Arc, Condvar, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError,
};

use impinge::world::World;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::workers;
use crate::world_state::Shapes;

/// A world that calls use in turns. A call waits for its turn before it goes to the pool of
/// threads, never in the pool. A thread of the pool that waits within a step may start other work
/// of the pool, and that work must not wait for the step.
pub(crate) struct Shared {
    world: RwLock<World>,
    /// Sources of the shapes; only the call that has the turn uses them.
    shapes: Mutex<Shapes>,
    is_taken: Mutex<bool>,
    freed: Condvar,
    /// Number of forks before the process that made this value.
    forks: usize,
}

/// Turn of a call. It ends when this value is dropped.
pub(crate) struct Turn(Arc<Shared>);

impl Turn {
    pub(crate) fn read(&self) -> RwLockReadGuard<'_, World> {
        self.0.world.read().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn write(&self) -> RwLockWriteGuard<'_, World> {
        self.0.world.write().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn shapes(&self) -> MutexGuard<'_, Shapes> {
        self.0.shapes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        *self.0.is_taken.lock().unwrap_or_else(PoisonError::into_inner) = false;
        self.0.freed.notify_one();
    }
}

/// Returns the guard of a lock that a panic poisoned, or `None` if the lock is taken.
fn unpoisoned<G>(error: TryLockError<G>) -> Option<G> {
    match error {
        TryLockError::Poisoned(poisoned) => Some(poisoned.into_inner()),
        TryLockError::WouldBlock => None,
    }
}

impl Shared {
    pub(crate) fn new(world: World) -> Self {
        let (world, shapes) = (RwLock::new(world), Mutex::default());
        Self { world, shapes, is_taken: Mutex::new(false), freed: Condvar::new(), forks: workers::forks() }
    }

    /// Returns the world of this process. After a fork it replaces the world of the parent by a
    /// copy. The thread must be attached to the interpreter, so that no fork leaves `own` locked.
    ///
    /// # Errors
    /// A `RuntimeError` if another thread was changing the world when this process was forked.
    pub(crate) fn of_this_process(own: &Mutex<Arc<Self>>) -> PyResult<Arc<Self>> {
        let mut own = own.lock().unwrap_or_else(PoisonError::into_inner);
        if own.forks != workers::forks() {
            let message = "another thread was changing the world when this process was forked: \
                           make a new world, and restore a state that was saved before";
            *own = Arc::new(own.copied().ok_or_else(|| PyRuntimeError::new_err(message))?);
        }
        Ok(own.clone())
    }

    /// Returns a copy of the world of a parent, for use in this process. Threads of the parent do
    /// not exist here, so turns that they had never end. Returns `None` if such a thread was
    /// changing the world.
    fn copied(&self) -> Option<Self> {
        let own = Self::new(self.world.try_read().map_or_else(unpoisoned, Some)?.clone());
        let shapes = self.shapes.try_lock().map_or_else(unpoisoned, Some)?.clone();
        Some(Self { shapes: Mutex::new(shapes), ..own })
    }

    /// Waits for a turn for a limited time. Returns `None` if the turn did not come.
    pub(crate) fn take(self: &Arc<Self>) -> Option<Turn> {
        let is_taken = self.is_taken.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.freed.wait_timeout_while(is_taken, workers::LISTENING_INTERVAL, |is_taken| *is_taken);
        let mut is_taken = waited.unwrap_or_else(PoisonError::into_inner).0;
        (!std::mem::replace(&mut *is_taken, true)).then(|| Turn(self.clone()))
    }
}
