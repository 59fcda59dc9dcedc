//! Poses and the small, error-bounded linear algebra that the rest stands on.

pub(crate) mod arctangent;
pub(crate) mod dyadic;
mod pose;
pub(crate) mod relative;
mod sign;
pub(crate) mod vec3;

pub use pose::Pose;
pub use relative::RelativeMap;
pub use sign::Sign;
