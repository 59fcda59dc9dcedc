//! Many parts at once: which pairs of parts intersect, penetrate or come near, in one configuration
//! or in many.
//!
//! A [`Scene`] has named parts, each a mesh, a solid, a shape or a compound with a pose. Parts may
//! share meshes and shapes, which are fast to clone. You can ignore single pairs, such as
//! neighboring links of a robot, and put parts into groups whose parts are not checked against each
//! other. [`Scene::pairs`] checks all pairs of parts in their current poses. [`Scene::check`]
//! checks many [`Configurations`], each a row of poses for the parts that move.
//! [`Scene::candidates`] and [`Scene::check_pairs`] divide the check of one configuration.
//!
//! ```
//! use impinge::query::batch::{Execution, Poses};
//! use impinge::scene::{Question, Scene, Stop};
//! use impinge::{Pose, Shape};
//!
//! let link = Shape::cuboid([0.5; 3])?;
//! let at = |x: f64| Pose::from_translation([x, 0.0, 0.0]);
//! let mut scene = Scene::new();
//! let [base, arm, hand] = [scene.add("base", &link, at(0.0)?)?, scene.add("arm", &link, at(1.0)?)?,
//!     scene.add("hand", &link, at(9.0)?)?];
//! scene.ignore(base, arm);
//! assert!(scene.pairs(Question::Intersects)?.is_empty());
//! let mut moves = scene.configurations();
//! moves.set(hand, Poses::from(vec![at(9.0)?, at(2.0)?]))?;
//! let found = scene.check(Question::Intersects, Stop::All, &moves, Execution::default())?;
//! assert!(found.values[0].is_empty());
//! assert_eq!(found.values[1].iter().map(|pair| pair.parts).collect::<Vec<_>>(), [[arm, hand]]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `parts` contains the scene, `details` the details of a part, `configurations` the rows of poses,
//! `near` the broad phase of a row, `check` the checks, and `repair` the repair of open parts.
//! Guarded by `tests/it/scene`.

mod check;
mod configurations;
mod details;
mod near;
mod parts;
mod repair;

pub use check::{Candidates, FoundPair, Question, Stop};
pub use configurations::{Configurations, ConfigurationsError};
pub use details::Details;
pub use parts::{PartId, Scene, SceneError};
pub use repair::RepairedPart;
