//! Turns at a world, one call after another, and what whoever has one may look at and change.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use impinge::world::World;

use crate::workers;
use crate::world_state::Shapes;

/// A world that calls take turns at. They wait for theirs before they go to the pool of threads, never in it: a thread that
/// steps may take up other work of the pool while it waits, which must not wait for that step.
pub(crate) struct Shared {
    world: RwLock<World>,
    /// For whoever has a turn.
    shapes: Mutex<Shapes>,
    is_taken: Mutex<bool>,
    freed: Condvar,
}

/// A call's turn, which ends where this is dropped.
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

    /// Waits for a turn, for a while; none where it did not come.
    pub(crate) fn take(self: &Arc<Self>) -> Option<Turn> {
        let is_taken = self.is_taken.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.freed.wait_timeout_while(is_taken, workers::LISTENING_INTERVAL, |is_taken| *is_taken);
        let mut is_taken = waited.unwrap_or_else(PoisonError::into_inner).0;
        (!std::mem::replace(&mut *is_taken, true)).then(|| Turn(self.clone()))
    }
}
