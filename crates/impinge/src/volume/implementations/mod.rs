//! The trait [`BoundingVolume`](super::BoundingVolume) for the volumes that [`fit`](super::fit) makes.
//!
//! The trait makes volumes from points by `fit`, and `fit` needs the volumes. So these implementations come after both.

mod capsule;
mod lozenge;
mod obb;
mod sphere;
