//! Conversions of poses and positions from and to the types of other crates. Each crate has a
//! feature of its own name.
//!
//! Numbers keep their values; single precision is widened to double. A conversion that rounds says
//! so in its documentation.

#[cfg(feature = "glam")]
mod glam;
#[cfg(feature = "nalgebra")]
mod nalgebra;
#[cfg(feature = "serde")]
mod serde;
