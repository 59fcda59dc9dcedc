//! Turns at a world. One call at a time has the turn, and may read and change the world.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use impinge::world::World;

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

impl Shared {
    pub(crate) fn new(world: World) -> Self {
        let (world, shapes) = (RwLock::new(world), Mutex::default());
        Self { world, shapes, is_taken: Mutex::new(false), freed: Condvar::new() }
    }

    /// Waits for a turn for a limited time. Returns `None` if the turn did not come.
    pub(crate) fn take(self: &Arc<Self>) -> Option<Turn> {
        let is_taken = self.is_taken.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.freed.wait_timeout_while(is_taken, workers::LISTENING_INTERVAL, |is_taken| *is_taken);
        let mut is_taken = waited.unwrap_or_else(PoisonError::into_inner).0;
        (!std::mem::replace(&mut *is_taken, true)).then(|| Turn(self.clone()))
    }
}
