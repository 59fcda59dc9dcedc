//! Robots: a tree of links and joints, and which of many configurations collide.
//!
//! A [`Robot`] has [links](Link) with shapes and [joints](Joint) between them. A configuration is a
//! row of values, one for each [coordinate](Coordinate) of the joints that move. [`Robot::poses`]
//! returns where the links are. [`Robot::check`] finds the pairs of links that collide in each of
//! many configurations, and the links that collide with the parts of a [`Scene`](crate::scene).
//! [`Robot::check_motions`] proves that motions between configurations are free, and
//! [`Robot::clearances`] measures how far configurations are from a collision.
//! `impinge_files::load_robot` loads a robot from a URDF file.
//!
//! ```
//! use impinge::query::batch::Execution;
//! use impinge::robot::{CheckOptions, Joint, JointKind, Link, Other, Robot};
//! use impinge::{Pose, Shape};
//!
//! let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625)?;
//! let link = |name: &str| Link { name: name.to_owned(), shape: Some(rod.clone()) };
//! let at_tip = Pose::from_translation([1.0, 0.0, 0.0])?;
//! let elbow = Joint::fixed("elbow", "upper", "fore", at_tip).moving(JointKind::Revolute, [0.0, 0.0, 1.0]);
//! let wrist = Joint::fixed("wrist", "fore", "hand", at_tip).moving(JointKind::Revolute, [0.0, 0.0, 1.0]);
//! let robot = Robot::new(vec![link("upper"), link("fore"), link("hand")], vec![elbow, wrist])?;
//! assert_eq!(robot.pairs(), [[0, 2]]); // a joint connects the other pairs
//!
//! // Straight, and folded into a triangle.
//! let found = robot.check(&[0.0, 0.0, 2.2, 2.2], &CheckOptions::default(), Execution::default())?;
//! assert!(found.values[0].is_empty());
//! assert_eq!((found.values[1][0].link, found.values[1][0].other), (0, Other::Link(2)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `joint` has the joints and their motions, `tree` validates the tree, `model` has the robot and
//! its kinematics, and `frame` the maps that they compose. `outline` and `proxy` have volumes about
//! links, `cull` culls pairs by them, and `shell` by convex hulls. `lanes` and `cull_lanes` place
//! and cull four configurations at a time. `links` and `obstacles` place shapes. `check` has the
//! checks, `clearance` the clearances, and `motion` the proofs of motions: `reach` bounds how far
//! links move, `interval` examines a time and what is free about it, and `certificate` verifies
//! proofs. `audit` finds the pairs that never collide. Guarded by `tests/it/robots`.

mod audit;
mod certificate;
mod check;
mod clearance;
mod cull;
mod cull_lanes;
mod error;
mod frame;
mod interval;
mod joint;
mod lanes;
mod links;
mod model;
mod motion;
mod obstacles;
mod outline;
mod proxy;
mod reach;
mod shell;
mod tree;

pub use audit::{AuditOptions, AuditedPair, PairFinding};
pub use certificate::{Certificate, CertificateError};
pub use check::{CheckError, CheckOptions, Collision, Other};
pub use clearance::{Clearance, ClearanceOptions};
pub use error::{ConfigurationError, RobotError};
pub use interval::CertificateRow;
pub use joint::{Joint, JointKind, Mimic};
pub use model::{Coordinate, IgnoredReason, Link, Robot};
pub use motion::{MotionCheck, MotionOptions, Verdict};
