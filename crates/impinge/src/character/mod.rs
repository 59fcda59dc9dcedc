//! Characters: a rigged body, hit volumes fitted to its bones, and queries for the part that was
//! struck (*Notes on Real Time Collision Detection*, chapter 3).
//!
//! A [`Rig`] is plain data: a [`Skeleton`], the [`Skin`] over it and its [`Animation`]s. A [`Plan`]
//! groups bones into parts, and [`Character::fit`] fits a volume to each part. [`Posed`] answers
//! which parts a ray, a moving volume, a shape, a mesh or another character strikes. [`Surface`]
//! confirms the answer on the skinned mesh.
//!
//! Nothing here depends on the platform's mathematics library or on the number of threads: the same
//! rig always gives the same volumes.
//!
//! Tests: those of this module, and `impinge-files/tests/it/characters`. Benchmark: `characters`.

mod animation;
mod body;
mod candidates;
mod channel;
mod clusters;
mod corners;
mod crossing;
mod error;
mod fit;
mod frame;
mod in_world;
mod motion_bound;
mod names;
mod overlap;
mod plan;
mod posed;
mod rig;
mod rig_pose;
mod samples;
mod segments;
mod skeleton;
mod skin;
mod skin_tree;
mod strike;
mod surface;
mod surface_rays;
mod timeline;
mod transform;
mod visit;
mod volume;
mod volume_pair;
mod work;

pub use animation::Animation;
pub use body::{Character, Leak};
pub use channel::{Channel, Interpolation, Target};
pub use error::{RigError, RigErrorKind, RigPlace};
pub use fit::{HitPart, Mode};
pub use frame::Frame;
pub use in_world::PartBodies;
pub use plan::{PartPlan, Plan};
pub use posed::{PartHit, PartPair, Posed};
pub use rig::Rig;
pub use rig_pose::RigPose;
pub use skeleton::{Bone, BoneSet, PlacedBone, Skeleton};
pub use skin::{Influence, Joint, Morph, Skin};
pub use strike::Strike;
pub use surface::{Surface, SurfaceHit};
pub use surface_rays::SurfaceRays;
pub use transform::Transform;
pub use volume::{HitHull, HitVolume, VolumeKind};
