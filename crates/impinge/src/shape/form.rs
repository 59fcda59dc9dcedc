//! The three representations of a placed shape.

use crate::convex::{HalfSpace, Surface, Swept};

/// What a verb makes of a placed shape, or of a part of a compound: one of the three representations.
pub(crate) enum Form<'a> {
    Convex(Swept<'a>),
    HalfSpace(Box<HalfSpace<'a>>),
    Surface(Surface<'a>),
}
