//! Implements [`BoundingVolume`](super::BoundingVolume) for the volumes that [`fit`](super::fit)
//! builds.
//!
//! The trait builds volumes by `fit`, and `fit` needs the volume types. These implementations
//! depend on both, so they are a module of their own.

mod capsule;
mod lozenge;
mod obb;
mod sphere;
