//! Values that are computed from the arrays of a mesh when a query first needs them, and cached.
//!
//! `topology` has vertices at equal positions, the border and the connected components. `cap` has
//! boxes about the border, beyond which an open mesh may be treated as closed. `moments` has the
//! moments of the faces below each node, for winding numbers. `copies` finds faces that are copies
//! of another face. `facets` has the flat parts of a surface. None of them uses `Mesh`, which owns
//! them.

pub(super) mod cap;
pub(super) mod copies;
pub(super) mod facets;
pub(super) mod moments;
pub(super) mod topology;
