//! Poses and positions from and to the types and formats of other crates, each behind a feature of its crate's name.
//!
//! Numbers are taken as they are, singles widened: what a pose or a vertex is, is what the other crate's type holds, and no more
//! is rounded but where a function says so.

#[cfg(feature = "glam")]
mod glam;
#[cfg(feature = "nalgebra")]
mod nalgebra;
#[cfg(feature = "serde")]
mod serde;
