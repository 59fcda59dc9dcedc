//! Poses, exact numbers, and small linear algebra with proved error bounds.

pub(crate) mod arctangent;
pub(crate) mod direction;
pub(crate) mod dyadic;
mod pose;
pub(crate) mod relative;
mod sign;
pub(crate) mod sine;
pub(crate) mod vec3;

pub use pose::Pose;
pub use relative::RelativeMap;
pub use sign::Sign;
