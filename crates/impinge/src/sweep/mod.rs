//! Continuous collision detection: the times at which moving things first touch.
//!
//! - `time_of_impact` handles meshes and shapes that move rigidly, and [`Sweep`] has its options. A
//!   `body` is a tree of `piece`s, an `interval` proves two pieces apart, and `search` divides
//!   both;
//! - a `carrier` bounds the place of a moving thing, for worlds;
//! - `linear` handles a vertex and a face, or two edges, whose corners move along lines;
//! - `deforming` handles surfaces whose vertices move along lines.
//!
//! The proofs are in docs/notes/proof.md, L23 to L25 and L34. The tests are in `tests/it/sweep`,
//! and the benchmark is `ccd` in `impinge-bench`.

mod ask;
mod batch;
mod body;
mod carrier;
mod deforming;
mod exact;
mod floats;
mod impact;
mod interval;
mod linear;
mod motion;
mod piece;
mod polynomials;
mod search;
mod span;
mod time_of_impact;

pub use ask::Sweep;
pub use batch::times_of_impact;
pub(crate) use carrier::Carrier;
pub use deforming::{Deforming, Features, SweptContact};
pub use impact::{Impact, Touch};
pub use linear::{edge_edge, vertex_face};
pub use motion::Motion;
pub use time_of_impact::time_of_impact;
