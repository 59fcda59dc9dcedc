//! Convex sets: distance, depth, contacts and intersection.
//!
//! A shape is a *core* swept by a sphere. Every core has a support function; polytopes have
//! vertices too. Whether two polytopes intersect is decided exactly, whatever the poses are. For
//! round cores the answer is the one that floats prove, or undecided.
//!
//! - `gjk` computes an interval that holds the distance, and decides nothing;
//! - `min_norm` computes the least distance of polytopes exactly, if that interval is not enough;
//! - `depth` computes an interval that holds the depth, with a normal that is valid whatever
//!   rounding does; `descent` improves the normal for contacts of round shapes;
//! - `closed` answers for spheres, capsules and boxes in closed form, if floats are certain;
//! - `half_space` compares shapes with planes;
//! - `manifold` computes the points of a contact, from the `facets` of polytopes, the parts
//!   `facing` along the normal, and their `overlap`; `reduction` keeps a few of them;
//! - `piece` divides the touched part of a mesh into convex pieces, whose contacts
//!   `surface_contacts` returns.
//!
//! The errors are derived in docs/notes/proof.md, L20 to L22, L28, L29, L33 and L35. The tests are
//! in `tests/it/shapes`, and the benchmark is `shapes` in `impinge-bench`.

mod along;
mod around;
mod beside;
mod bounds;
mod closed;
mod core_depth;
mod depth;
mod descent;
mod distance;
mod expand;
mod facet;
mod facets;
mod facing;
mod gjk;
mod half_space;
mod half_space_surface;
mod interval;
mod manifold;
mod min_norm;
mod near_faces;
mod overlap;
mod piece;
mod posed;
mod push;
mod reduction;
mod short_list;
mod simplex;
mod support;
mod surface;
mod surface_contacts;
mod turned;

pub(crate) use along::contacts_along_facets;
pub(crate) use depth::{Depth, depth};
pub(crate) use distance::{Coherence, nearness, nearness_from, parting, separation};
pub(crate) use facets::Facets;
pub(crate) use half_space::HalfSpace;
pub(crate) use interval::Separation;
pub(crate) use manifold::{Contact, Contacts, Faceted, contacts};
pub use overlap::Feature;
pub(crate) use piece::{Body, Found, OrientedFace, Touched, contacts_of_bodies, pieces, unresolved};
pub(crate) use posed::{Core, Swept, to_unit_entries, to_unit_length};
pub(crate) use simplex::nearest as nearest_of_hull;
pub use support::Support;
pub(crate) use surface::Surface;
pub(crate) use turned::Turned;
