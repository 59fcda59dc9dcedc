//! Checks many configurations of a robot against itself and against obstacles.

use std::collections::HashMap;
use std::error::Error;
use std::fmt;
use std::ops::Range;

use super::cull::Culling;
use super::cull_lanes::{CullLanes, Plan};
use super::error::ConfigurationError;
use super::frame::Frame;
use super::lanes::{self, FrameLanes, ROWS};
use super::links::{PlacedLink, PlacedLinks, may_be_near};
use super::model::Robot;
use super::obstacles::Obstacles;
use crate::budget::{Budget, Stopped};
use crate::query::batch::{Answers, Execution, Status};
use crate::query::{Cache, Proximity, Query};
use crate::scene::{PartId, Scene, Stop};
use crate::simd::best_level;

/// Options of [`Robot::check`].
#[derive(Clone, Debug)]
pub struct CheckOptions<'s> {
    /// When the check of a configuration ends.
    pub stop: Stop,
    /// Obstacles: the parts of a scene, at their poses in it. The frame of the robot's root link is
    /// the world frame of the scene. Pairs of two obstacles are not checked.
    pub obstacles: Option<&'s Scene>,
    /// Clearance that two links must keep, in units of length: the pair is found if the links are
    /// [within](crate::query::within()) this distance.
    pub self_padding: f64,
    /// Clearance that each link must keep from obstacles, by the index of the link. Missing links
    /// have zero.
    pub padding: Vec<f64>,
    /// Pairs of a link and an obstacle that are not checked, such as a base and the floor that it
    /// stands on.
    pub ignored: Vec<(usize, PartId)>,
}

impl Default for CheckOptions<'_> {
    /// Returns the options of a check of all pairs of links, without obstacles and clearances.
    fn default() -> Self {
        Self { stop: Stop::All, obstacles: None, self_padding: 0.0, padding: Vec::new(), ignored: Vec::new() }
    }
}

impl CheckOptions<'_> {
    /// Validates the clearances.
    pub(super) fn validate(&self) -> Result<(), CheckError> {
        let is_valid = |clearance: &f64| clearance.is_finite() && *clearance >= 0.0;
        let all = self.padding.iter().chain([&self.self_padding]);
        if all.copied().all(|clearance| is_valid(&clearance)) { Ok(()) } else { Err(CheckError::Padding) }
    }
}

/// The link or obstacle that a link collides with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Other {
    /// Another link, by its index, which is larger.
    Link(usize),
    /// A part of the scene of obstacles.
    Obstacle(PartId),
}

/// A link that collides, or is too near.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Collision {
    /// Index of the link.
    pub link: usize,
    /// The link or obstacle that it collides with.
    pub other: Other,
    /// `true` if nothing was proved about the pair, so that it counts as colliding to be safe.
    pub is_undecided: bool,
}

/// The error that configurations could not be checked.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CheckError {
    /// A configuration is invalid.
    Configuration(ConfigurationError),
    /// A clearance is negative, NaN or infinite.
    Padding,
    /// The starts and the ends of motions are lists of different lengths.
    Lengths {
        /// Number of values of the starts.
        starts: usize,
        /// Number of values of the ends.
        ends: usize,
    },
    /// A limit of the budget was reached.
    Stopped(Stopped),
}

impl Robot {
    /// Returns for each configuration the pairs that collide: pairs of links in the order of
    /// [`pairs`](Self::pairs), then pairs of a link and an obstacle, in the order of the links and
    /// of the scene. Undecided pairs are included. With [`Stop::First`] only the first pair is
    /// returned.
    ///
    /// The configurations are rows of one value for each coordinate. A pair collides exactly if
    /// [`intersects`](crate::query::intersects()) is true for the two shapes at the
    /// [`poses`](Self::poses) of the configuration, or [`within`](crate::query::within()) if the
    /// pair has a clearance. Limits of joints are not checked.
    ///
    /// # Errors
    /// Returns an error if a configuration or a clearance is invalid, or if a limit of the budget
    /// of `execution` was reached.
    ///
    /// # Complexity
    /// For each configuration, time linear in the number of links and pairs for the kinematics and
    /// the boxes, and one query for each pair whose boxes are near.
    pub fn check(
        &self,
        configurations: &[f64],
        options: &CheckOptions<'_>,
        execution: Execution<'_>,
    ) -> Result<Answers<Vec<Collision>>, CheckError> {
        let rows = self.check_rows(configurations).map_err(CheckError::Configuration)?;
        options.validate()?;
        let obstacles = Obstacles::new(options.obstacles, &options.ignored);
        let plan = Plan::new(self, options.self_padding);
        let check = Check { robot: self, options, configurations, rows, obstacles, plan };
        let values = execution.rows(rows, || State::new(self), |state, row| check.row(row, state, execution.budget()));
        let values = values.map_err(CheckError::Stopped)?;
        let answers = Answers { shape: vec![rows], status: vec![Status::Ok; rows], values };
        Ok(answers.mark_undecided(|found| found.iter().any(|collision| collision.is_undecided)))
    }
}

struct Check<'c> {
    robot: &'c Robot,
    options: &'c CheckOptions<'c>,
    configurations: &'c [f64],
    rows: usize,
    obstacles: Obstacles,
    plan: Plan<'c>,
}

/// State that consecutive configurations share.
struct State {
    block: Block,
    frames: Vec<Frame>,
    culling: Culling,
    links: PlacedLinks,
    /// State of the last query of each pair of links, by the index of the pair.
    caches: Vec<Cache>,
    /// State of the last query of a link and an obstacle, by their indices.
    obstacle_caches: HashMap<(usize, usize), Cache>,
    near: Vec<usize>,
}

/// Consecutive rows that are placed and culled together.
#[derive(Default)]
struct Block {
    rows: Range<usize>,
    frames: Vec<FrameLanes>,
    cull: CullLanes,
}

impl State {
    fn new(robot: &Robot) -> Self {
        let caches = robot.pairs().iter().map(|_| Cache::default()).collect();
        let links = PlacedLinks::new(robot.links().len());
        let (frames, culling, near) = (Vec::new(), Culling::default(), Vec::new());
        Self { block: Block::default(), frames, culling, links, caches, obstacle_caches: HashMap::new(), near }
    }
}

impl Check<'_> {
    /// Places and culls the links in a row and in those that follow it.
    fn start(&self, block: &mut Block, row: usize) {
        block.rows = row..self.rows.min(row + ROWS);
        let columns = self.robot.coordinates().len();
        let level = best_level();
        // Lanes beyond the last row repeat it.
        let rows = std::array::from_fn(|lane| {
            let row = (row + lane).min(self.rows - 1);
            &self.configurations[row * columns..(row + 1) * columns]
        });
        lanes::place(level, self.robot, rows, &mut block.frames);
        block.cull.start(level, &self.plan, &block.frames);
    }

    /// Returns the collisions of a row.
    fn row(&self, row: usize, state: &mut State, budget: &Budget<'_>) -> Vec<Collision> {
        let robot = self.robot;
        let State { block, frames, culling, links, caches, obstacle_caches, near } = state;
        if !block.rows.contains(&row) {
            self.start(block, row);
        }
        let lane = row - block.rows.start;
        let frame = |link: usize| lanes::frame_of(&block.frames[link], lane);
        links.start();
        let mut found = Vec::new();
        let is_first = self.options.stop == Stop::First;
        let clearance = self.options.self_padding;
        for at in block.cull.near(lane, &self.plan, frame) {
            // The caller discards the result if the budget is spent.
            if budget.is_spent() {
                return found;
            }
            let (pair @ [a, b], cache) = (robot.pairs()[at], &mut caches[at]);
            pair.iter().for_each(|&link| links.place_at(link, robot, || frame(link)));
            let placed = pair.map(|link| &links.placed[link]);
            if may_be_near(placed[0], placed[1], clearance) {
                found.extend(collision(a, Other::Link(b), proximity(placed, clearance, cache, budget)));
                if is_first && !found.is_empty() {
                    return found;
                }
            }
        }
        if self.obstacles.is_empty() {
            return found;
        }
        frames.clear();
        frames.extend((0..robot.links().len()).map(frame));
        culling.start(robot.proxies(), frames);
        for link in (0..frames.len()).filter(|&link| robot.links()[link].shape.is_some()) {
            let clearance = self.options.padding.get(link).copied().unwrap_or(0.0);
            let limbs = culling.limbs(link, robot.proxies(), frames);
            self.obstacles.near(link, limbs, clearance, near);
            for &at in &*near {
                if budget.is_spent() {
                    return found;
                }
                links.place(link, robot, frames);
                let placed = &links.placed[link];
                let (part, obstacle) = self.obstacles.part(at);
                if !may_be_near(placed, obstacle, clearance) {
                    continue;
                }
                let cache = obstacle_caches.entry((link, at)).or_default();
                let proximity = proximity([placed, obstacle], clearance, cache, budget);
                found.extend(collision(link, Other::Obstacle(part), proximity));
                if is_first && !found.is_empty() {
                    return found;
                }
            }
        }
        found
    }
}

/// Returns whether two shapes are within a clearance of each other.
pub(super) fn proximity(pair: [&PlacedLink; 2], clearance: f64, cache: &mut Cache, budget: &Budget<'_>) -> Proximity {
    let [PlacedLink::At(a), PlacedLink::At(b)] = pair else { return Proximity::Undecided };
    let query = Query::new().with_cache(cache).with_budget(budget);
    if clearance > 0.0 { query.nearness(&**a, &**b, clearance) } else { query.proximity(&**a, &**b) }
}

pub(super) fn collision(link: usize, other: Other, proximity: Proximity) -> Option<Collision> {
    let is_undecided = proximity == Proximity::Undecided;
    (proximity != Proximity::Apart).then_some(Collision { link, other, is_undecided })
}

impl fmt::Display for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Configuration(error) => write!(f, "{error}"),
            Self::Padding => f.write_str("a clearance is negative, NaN or infinite"),
            Self::Lengths { starts, ends } => {
                write!(f, "the starts of motions have {starts} values and their ends {ends}: pass as many of each")
            }
            Self::Stopped(stopped) => write!(f, "{stopped}"),
        }
    }
}

impl Error for CheckError {}
