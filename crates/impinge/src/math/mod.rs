//! Poses and the small, error-bounded linear algebra that the rest stands on.

mod pose;

pub use pose::Pose;
