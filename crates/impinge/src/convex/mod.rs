//! Convex sets: how far apart, how deep in each other, and whether they meet at all.
//!
//! A shape is a *core* swept by a ball. Cores are known by their support functions; those that are polytopes are known
//! by their vertices too, and about them every boolean is decided exactly, whatever the poses are. About round ones what the
//! floats prove is said, and what they leave open is said to be open.
//!
//! - `gjk` finds an interval that holds the distance, and decides nothing;
//! - `min_norm` finds the least distance of polytopes exactly, where the interval does not do;
//! - `depth` finds an interval for the depth, with a normal that is valid whatever else went wrong;
//! - `boxes` does both for two boxes in closed form, where floats are certain;
//! - `half_space` compares shapes to planes;
//! - `manifold` finds the points of a contact, from `facets` of polytopes, what is `facing` along the normal, and the `overlap`.
//!
//! The errors are derived in docs/proof.md, L20 to L22, L28 and L29.

mod around;
mod bounds;
mod boxes;
mod core_depth;
mod depth;
mod distance;
mod expand;
mod facet;
mod facets;
mod facing;
mod gjk;
mod half_space;
mod half_space_surface;
mod manifold;
mod min_norm;
mod overlap;
mod posed;
mod simplex;
mod surface;
mod surface_contacts;

pub(crate) use depth::{Depth, depth};
pub(crate) use distance::{Coherence, Separation, nearness, nearness_from, separation};
pub(crate) use facets::Facets;
pub(crate) use half_space::HalfSpace;
pub(crate) use manifold::{Contact, Contacts, Faceted, contacts};
pub use overlap::Feature;
pub use posed::Support;
pub(crate) use posed::{Core, Swept, to_unit_length};
pub(crate) use simplex::nearest as nearest_of_hull;
pub(crate) use surface::Surface;
