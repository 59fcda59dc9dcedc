//! The clearance of configurations: the distance of the nearest pair.

use std::collections::HashMap;

use super::check::{CheckError, Other};
use super::cull::Culling;
use super::frame::Frame;
use super::links::{PlacedLink, PlacedLinks};
use super::model::Robot;
use super::obstacles::Obstacles;
use crate::budget::Budget;
use crate::query::batch::{Answers, Execution, Status};
use crate::query::{Cache, Proximity, Query};
use crate::scene::{PartId, Scene};

/// Options of [`Robot::clearances`].
#[derive(Clone, Debug)]
pub struct ClearanceOptions<'s> {
    /// Obstacles, as for [`CheckOptions::obstacles`](super::CheckOptions::obstacles).
    pub obstacles: Option<&'s Scene>,
    /// Pairs of a link and an obstacle that are not compared.
    pub ignored: Vec<(usize, PartId)>,
    /// Distance beyond which clearances do not matter. A smaller limit takes less time.
    pub limit: f64,
}

impl Default for ClearanceOptions<'_> {
    /// Returns the options of clearances between links, without a limit.
    fn default() -> Self {
        Self { obstacles: None, ignored: Vec::new(), limit: f64::INFINITY }
    }
}

/// Clearance of a configuration: the distance of the nearest pair that is checked, as an interval
/// that is proved to hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Lower bound, in units of length. Zero if the configuration collides, and the limit if all
    /// pairs are farther apart.
    pub lower: f64,
    /// Upper bound, in units of length. Zero if a collision is proved; infinite if all pairs are
    /// farther apart than the limit.
    pub upper: f64,
    /// Index of the link and the other link or the obstacle of the nearest pair; `None` if all
    /// pairs are farther apart than the limit. Of several pairs it is any.
    pub pair: Option<(usize, Other)>,
    /// Nearest points of the pair in the world frame, rounded. `None` without a pair, or if one
    /// shape is inside the other.
    pub points: Option<[[f64; 3]; 2]>,
    /// Whether it is undecided that the pair collides; the lower bound is zero then.
    pub is_undecided: bool,
}

impl Robot {
    /// Returns the clearance of each of many configurations, which are rows of one value for each
    /// coordinate. It is zero exactly if [`check`](Self::check) finds a collision, and at most d
    /// exactly if a check with all clearances d finds one, up to the width of the interval.
    ///
    /// # Errors
    /// As for [`check`](Self::check); [`CheckError::Padding`] for a limit that is negative or NaN.
    ///
    /// # Complexity
    /// Volumes about the links bound all distances. A distance is computed for each pair whose
    /// bound is below the smallest distance.
    ///
    /// ```
    /// use impinge::query::batch::Execution;
    /// use impinge::robot::{ClearanceOptions, Joint, JointKind, Link, Robot};
    /// use impinge::{Pose, Shape};
    ///
    /// let sphere = Shape::sphere([0.0; 3], 0.5)?;
    /// let ball = |name: &str| Link { name: name.into(), shape: Some(sphere.clone()) };
    /// let slide = |name: &str, parent: &str, child: &str| {
    ///     Joint::fixed(name, parent, child, Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0])
    /// };
    /// let links = vec![ball("a"), Link { name: "b".into(), shape: None }, ball("c")];
    /// let robot = Robot::new(links, vec![slide("ab", "a", "b"), slide("bc", "b", "c")])?;
    /// let found = robot.clearances(&[2.0, 1.0], &ClearanceOptions::default(), Execution::default())?;
    /// assert!((found.values[0].upper - 2.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clearances(
        &self,
        configurations: &[f64],
        options: &ClearanceOptions<'_>,
        execution: Execution<'_>,
    ) -> Result<Answers<Clearance>, CheckError> {
        let rows = self.check_rows(configurations).map_err(CheckError::Configuration)?;
        if options.limit.is_nan() || options.limit < 0.0 {
            return Err(CheckError::Padding);
        }
        let obstacles = Obstacles::new(options.obstacles, &options.ignored);
        let columns = self.coordinates().len();
        let ask = |state: &mut State, row: usize| {
            let configuration = &configurations[row * columns..(row + 1) * columns];
            self.nearest(configuration, (&obstacles, options.limit), state, execution.budget())
        };
        let values = execution.rows(rows, || State::new(self), ask).map_err(CheckError::Stopped)?;
        let answers = Answers { shape: vec![rows], status: vec![Status::Ok; rows], values };
        Ok(answers.mark_undecided(|found| found.is_undecided))
    }

    fn nearest(
        &self,
        configuration: &[f64],
        (obstacles, limit): (&Obstacles, f64),
        state: &mut State,
        budget: &Budget<'_>,
    ) -> Clearance {
        let State { frames, culling, links, caches, near } = state;
        self.place(configuration, frames);
        links.start();
        culling.start(self.proxies(), frames);
        culling.place_all(self.proxies(), frames);
        near.clear();
        for &[a, b] in self.pairs() {
            near.push((culling.least_distance([a, b], self.proxies()), a, Subject::Link(b)));
        }
        for link in (0..frames.len()).filter(|&link| !obstacles.is_empty() && self.links()[link].shape.is_some()) {
            let limbs = culling.limbs(link, self.proxies(), frames);
            obstacles.distances(link, limbs, limit, |at, least| near.push((least, link, Subject::Obstacle(at))));
        }
        near.retain(|(least, ..)| *least <= limit);
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = Clearance { lower: limit, upper: f64::INFINITY, pair: None, points: None, is_undecided: false };
        for &(least, link, subject) in &*near {
            // The caller discards the result if the budget is spent.
            if least > best.upper || best.upper == 0.0 || budget.is_spent() {
                break;
            }
            let mut is_beyond = |reach: f64| match subject {
                Subject::Link(other) => {
                    let bound = reach.next_up();
                    culling.least_distance_of_hulls([link, other], bound, self.proxies(), frames) > reach
                }
                Subject::Obstacle(at) => {
                    let limbs = culling.limbs(link, self.proxies(), frames);
                    limbs.is_some_and(|limbs| !obstacles.may_reach(limbs, at, reach))
                }
            };
            let reach = best.upper.min(limit);
            if reach < f64::INFINITY && is_beyond(reach) {
                continue;
            }
            links.place(link, self, frames);
            let other = match subject {
                Subject::Link(other) => {
                    links.place(other, self, frames);
                    Other::Link(other)
                }
                Subject::Obstacle(at) => Other::Obstacle(obstacles.part(at).0),
            };
            let b = match subject {
                Subject::Link(other) => &links.placed[other],
                Subject::Obstacle(at) => obstacles.part(at).1,
            };
            let cache = caches.entry((link, subject)).or_default();
            let found = match [&links.placed[link], b] {
                [PlacedLink::Nowhere, _] | [_, PlacedLink::Nowhere] => continue,
                [PlacedLink::At(a), PlacedLink::At(b)] => {
                    let query = Query::new().with_cache(cache).with_budget(budget);
                    let found = query.distance(&**a, &**b);
                    let is_undecided = found.proximity == Proximity::Undecided;
                    (found.lower, found.upper, found.points(), is_undecided)
                }
                _ => (0.0, f64::MAX, None, true),
            };
            let (lower, upper, points, is_undecided) = found;
            if upper <= limit && upper < best.upper {
                (best.upper, best.pair, best.points) = (upper, Some((link, other)), points);
            } else if is_undecided && best.pair.is_none() {
                (best.pair, best.points) = (Some((link, other)), points);
            }
            best.lower = best.lower.min(lower);
            best.is_undecided |= is_undecided;
        }
        best.is_undecided &= best.upper > 0.0;
        best
    }
}

/// The other thing of a pair: another link, or an obstacle by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Subject {
    Link(usize),
    Obstacle(usize),
}

/// State that consecutive configurations share.
struct State {
    frames: Vec<Frame>,
    culling: Culling,
    links: PlacedLinks,
    caches: HashMap<(usize, Subject), Cache>,
    /// Pairs with a lower bound of their distance.
    near: Vec<(f64, usize, Subject)>,
}

impl State {
    fn new(robot: &Robot) -> Self {
        let links = PlacedLinks::new(robot.links().len());
        let (frames, culling) = (Vec::new(), Culling::default());
        Self { frames, culling, links, caches: HashMap::new(), near: Vec::new() }
    }
}
