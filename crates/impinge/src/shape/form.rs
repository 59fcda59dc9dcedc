//! The representations of a placed shape.

use crate::convex::{HalfSpace, Surface, Swept};
use crate::mesh::HeightField;

/// Representation of a placed shape, or of a part of a compound, in a query.
pub(crate) enum Form<'a> {
    Convex(Swept<'a>),
    HalfSpace(HalfSpace<'a>),
    Surface(Surface<'a>),
    Field(Surface<'a, HeightField>),
}
