//! The margins of bodies: distances at which pairs are reported before the bodies touch.

use impinge::world::World;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::world::WorldCore;
use crate::world_bodies::{Handles, ids, of_bodies};

/// Returns the margins of bodies, (n,).
#[pyfunction]
pub(crate) fn world_margins<'py>(world: &Bound<'py, WorldCore>, bodies: &Handles<'py>) -> PyResult<Bound<'py, PyAny>> {
    let found = world.get().of_each(bodies, World::margin)?;
    let count = found.len();
    array(world.py(), found, &[count])
}

/// Sets the margin of bodies. If one handle or the margin is invalid, nothing changes.
#[pyfunction]
pub(crate) fn world_set_margin(world: &Bound<'_, WorldCore>, bodies: &Handles<'_>, margin: f64) -> PyResult<()> {
    let ids = ids(bodies)?;
    let set = world.get().change(world.py(), |world| {
        ids.iter().try_for_each(|&id| world.traits(id).map(drop))?;
        ids.iter().try_for_each(|&id| world.set_margin(id, margin))
    })?;
    set.map_err(|error| of_bodies(&error, &ids, "bodies").raised(world.py()))
}
