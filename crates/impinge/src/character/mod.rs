//! Characters: a rigged body, hit volumes fitted to its bones, and the part that was struck (*Notes on Real Time Collision
//! Detection*, chapter 3).
//!
//! A [`Rig`] is plain data: a [`Skeleton`], the [`Skin`] over it and its [`Animation`]s.

mod animation;
mod error;
mod rig;
mod skeleton;
mod skin;
mod transform;

pub use animation::{Animation, Channel, Interpolation, Target};
pub use error::{RigError, RigErrorKind, RigPlace};
pub use rig::{Rig, RigPose};
pub use skeleton::{Bone, PlacedBone, Skeleton};
pub use skin::{Influence, Joint, Morph, Skin};
pub use transform::Transform;
