//! Clash detection over assemblies: which parts of some scenes run into each other, and how deep.
//!
//! Parts are solids. Each pair of parts has one [`Kind`]: duplicate, contained, clash, contact,
//! clearance or clear. Common material that is no deeper than a tolerance counts as contact,
//! because the coordinates of parts that touch are rounded.
//!
//! [`find`] searches some scenes, each with a label ([`Side`]). [`Rules`] state which sets of parts
//! are checked against each other. The [`Report`] lists the clashes, the worst first, with an
//! identity that stays the same from one report to the next. With a [`Previous`] report, statuses
//! carry over.
//!
//! ```
//! use impinge::clash::{self, Kind, Options, Side, default_tolerance};
//! use impinge::query::batch::Execution;
//! use impinge::scene::Scene;
//! use impinge::Pose;
//! # use impinge::{Mesh, Positions, InputError};
//! # fn cuboid(low: [f64; 3], high: [f64; 3]) -> Result<Mesh, InputError> {
//! #     let corners = (0..8).map(|at| std::array::from_fn(|k| if at >> k & 1 == 0 { low[k] } else { high[k] }));
//! #     let faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
//! #         [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
//! #     Mesh::new(Positions::F64(corners.collect()), faces.to_vec())
//! # }
//!
//! let wall = cuboid([0.0; 3], [1.0, 1.0, 1.0])?;
//! let mut scene = Scene::new();
//! for (name, x) in [("left", 0.0), ("right", 0.98), ("beside", 2.0)] {
//!     scene.add(name, &wall, Pose::from_translation([x, 0.0, 0.0])?)?;
//! }
//! let sides = [Side { label: "walls".to_owned(), scene: &scene }];
//! // The unit of the scene is the meter.
//! let options = Options { clearance: Some(0.05), ..Options::new(default_tolerance(&sides, Some(1.0))) };
//! let report = clash::find(&sides, options, Execution::default())?;
//! let kinds: Vec<Kind> = report.clashes.iter().map(|clash| clash.kind).collect();
//! assert_eq!(kinds, [Kind::Clash, Kind::Clearance]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `sides` has the scenes and their parts, `rules` and `matching` the rules, `near` the broad
//! phase, `kinds` the kind of a pair, and `job` the search. `report`, `identity`, `status`,
//! `decades`, `groups`, `sentence` and `curves` make the report. Guarded by `tests/it/clash`.

mod curves;
mod decades;
mod error;
mod groups;
mod identity;
mod job;
mod kinds;
mod matching;
mod meeting;
mod near;
mod options;
mod report;
mod rules;
mod sentence;
mod sides;
mod status;

pub use curves::curves;
pub use decades::{Decade, Decades, DepthGap};
pub use error::ClashError;
pub use groups::{Group, Grouping, Shared};
pub use identity::identity;
pub use job::{Job, find};
pub use kinds::{Asked, Finding, Inner, Kind, Why, classify};
pub use options::Options;
pub use report::{Clash, Counts, DuplicateSet, Report};
pub use rules::{ALL, Accept, Ignore, Rule, Rules, Selector, Set};
pub use sides::{Member, Side, default_tolerance};
pub use status::{Gone, Known, Previous, Status, UnknownStatus};
