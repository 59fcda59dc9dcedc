//! Margins of bodies: distances at which pairs are reported before the bodies touch.
//!
//! The bounds of a body grow by its margin, so the broad phase finds the pairs that the margins
//! join. The narrow phase decides whether the distance is at most the sum of both margins. Without
//! margins nothing of that takes place.
//!
//! Guarded by `tests/it/worlds/margins.rs`.

use super::body::{BodyId, validate_margin};
use super::error::WorldError;
use super::{Change, World, refused};

impl World {
    /// Returns the margin of a body, in world units.
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world.
    pub fn margin(&self, body: BodyId) -> Result<f64, WorldError> {
        Ok(self.resident(body)?.margin)
    }

    /// Sets the margin of a body, in world units, from the next step on. See
    /// [`Body::with_margin`](super::Body::with_margin).
    ///
    /// # Errors
    /// Returns [`Stale`](WorldError::Stale) if the body is not in the world, and
    /// [`Input`](WorldError::Input) if the margin is not finite, negative or above 2^128.
    pub fn set_margin(&mut self, body: BodyId, margin: f64) -> Result<(), WorldError> {
        let place = body.index() as u32;
        self.resident(body)?;
        validate_margin(margin).map_err(|error| refused(body, error))?;
        self.state.mark_neighbors(place);
        let resident = self.resident_mut(body)?;
        resident.margin = margin;
        let (kind, bounds) = (resident.traits.kind, resident.bounds());
        self.state.update_bounds(kind, place, bounds);
        self.state.changed.mark(place, Change::Place);
        Ok(())
    }
}
