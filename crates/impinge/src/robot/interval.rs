//! Examines an interval of a motion: which pairs cannot collide within it, by their distance in
//! its middle and by how far they can move from there.

use std::collections::HashMap;

use super::check::{CheckOptions, Collision, Other, collision, proximity};
use super::cull::Culling;
use super::frame::Frame;
use super::links::{PlacedLink, PlacedLinks, may_be_near};
use super::model::Robot;
use super::obstacles::Obstacles;
use super::proxy::Proxy;
use super::reach::{Chains, Rates, Reach};
use crate::budget::Budget;
use crate::query::{Cache, Proximity};

/// Maximum distance for which shapes are compared, 2^200. Links that may move farther are not.
const MAX_NEEDED: f64 = f64::from_bits((1023 + 200) << 52);

/// Subjects of a proof: indices of pairs of links, and then, for each link, its index after those
/// for the link and all obstacles.
pub(super) type Items = Vec<u32>;

/// An interval of a motion in which a pair of links, or a link and all obstacles, are proved to
/// keep their clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertificateRow {
    /// Index of the link.
    pub link: usize,
    /// Index of the other link, which is larger; `None` for all obstacles.
    pub other: Option<usize>,
    /// Middle of the interval, from 0 at the start of the motion to 1 at its end.
    pub time: f64,
    /// Half of the length of the interval.
    pub half: f64,
}

/// Result of the examination of an interval.
pub(super) enum Finding {
    /// Nothing collides in the middle. The items that are not proved free.
    Open(Items),
    /// A pair collides in the middle. The items that are not proved free.
    Hit(Collision, Items),
}

/// Verdict about one item.
enum Answer {
    Free,
    Open,
    Hit(Collision),
}

/// The parts of a proof that do not depend on the motion.
pub(super) struct Scan<'s> {
    pub(super) robot: &'s Robot,
    pub(super) options: &'s CheckOptions<'s>,
    pub(super) obstacles: Obstacles,
    pub(super) chains: Chains,
    /// For each pair the numbers of joints between each link and the last one that both share.
    between: Vec<[usize; 2]>,
}

/// State that consecutive intervals share.
pub(super) struct State {
    rates: Option<Rates>,
    ends: [Vec<f64>; 2],
    pub(super) frames: Vec<Frame>,
    pub(super) culling: Culling,
    pub(super) links: PlacedLinks,
    pub(super) reach: Reach,
    caches: Vec<Cache>,
    obstacle_caches: HashMap<(usize, usize), Cache>,
    pub(super) near: Vec<usize>,
}

/// Returns the configuration at a time between 0 and 1.
pub(super) fn between(start: &[f64], end: &[f64], time: f64) -> Vec<f64> {
    let at = |(p, q): (&f64, &f64)| if time == 1.0 { *q } else { p + time * (q - p) };
    start.iter().zip(end).map(at).collect()
}

impl<'s> Scan<'s> {
    pub(super) fn new(robot: &'s Robot, options: &'s CheckOptions<'s>) -> Self {
        let chains = Chains::new(robot);
        let between = robot.pairs().iter().map(|&pair| chains.between(pair)).collect();
        let obstacles = Obstacles::new(options.obstacles, &options.ignored);
        Self { robot, options, obstacles, chains, between }
    }

    pub(super) fn state(&self) -> State {
        State {
            rates: None,
            ends: [Vec::new(), Vec::new()],
            frames: Vec::new(),
            culling: Culling::default(),
            links: PlacedLinks::new(self.robot.links().len()),
            reach: Reach::default(),
            caches: self.robot.pairs().iter().map(|_| Cache::default()).collect(),
            obstacle_caches: HashMap::new(),
            near: Vec::new(),
        }
    }

    /// Starts a motion.
    pub(super) fn begin(&self, state: &mut State, ends: &[Vec<f64>; 2]) {
        state.rates = Some(Rates::new(self.robot, ends.each_ref().map(Vec::as_slice)));
        state.ends.clone_from(ends);
    }

    /// Returns all subjects of a proof.
    pub(super) fn items(&self) -> Items {
        let pairs = self.robot.pairs().len();
        let has_shape = |link: &usize| self.robot.links()[*link].shape.is_some();
        let links = (0..self.robot.links().len()).filter(|link| !self.obstacles.is_empty() && has_shape(link));
        (0..pairs).chain(links.map(|link| pairs + link)).map(|item| item as u32).collect()
    }

    /// Reports whether nothing bounds the motion of a link of each item.
    pub(super) fn are_boundless(&self, items: &[u32]) -> bool {
        let is_boundless = |link: usize| matches!(self.robot.proxies()[link], Proxy::Anywhere);
        items.iter().all(|&item| match self.robot.pairs().get(item as usize) {
            Some(&[a, b]) => is_boundless(a) || is_boundless(b),
            None => is_boundless(item as usize - self.robot.pairs().len()),
        })
    }

    /// Returns a pair that collides at the start of the motion.
    pub(super) fn collision_at_start(&self, state: &mut State, budget: &Budget<'_>) -> Option<Collision> {
        self.move_to(state, 0.0, 0.0);
        self.items().into_iter().find_map(|item| match self.resolve(state, item, false, budget) {
            Answer::Hit(collision) => Some(collision),
            Answer::Free | Answer::Open => None,
        })
    }

    /// Examines an interval, given its start, middle and end. Appends the proofs of the items that
    /// are free to `rows`.
    pub(super) fn examine(
        &self,
        state: &mut State,
        [low, middle, high]: [f64; 3],
        items: &[u32],
        mut rows: Option<&mut Vec<CertificateRow>>,
        budget: &Budget<'_>,
    ) -> Finding {
        let half = 0.5 * (high - low);
        self.move_to(state, middle, half);
        let mut open = Vec::new();
        for (at, &item) in items.iter().enumerate() {
            match self.resolve(state, item, true, budget) {
                Answer::Free => {
                    if let Some(rows) = &mut rows {
                        let pair = self.robot.pairs().get(item as usize);
                        let link = pair.map_or_else(|| item as usize - self.robot.pairs().len(), |pair| pair[0]);
                        rows.push(CertificateRow { link, other: pair.map(|pair| pair[1]), time: middle, half });
                    }
                }
                Answer::Open => open.push(item),
                Answer::Hit(collision) => {
                    open.extend(&items[at..]);
                    return Finding::Hit(collision, open);
                }
            }
        }
        Finding::Open(open)
    }

    /// Places the volumes at a time, and bounds how far the links move within `half` of it.
    pub(super) fn move_to(&self, state: &mut State, time: f64, half: f64) {
        let State { rates, ends: [start, end], frames, culling, links, reach, .. } = state;
        let (robot, proxies) = (self.robot, self.robot.proxies());
        let configuration = between(start, end, time);
        robot.place(&configuration, frames);
        links.start();
        culling.start(proxies, frames);
        culling.place_all(proxies, frames);
        let size = culling.size(proxies, frames);
        if let Some(rates) = rates {
            let limbs = |link: usize| culling.placed_limbs(link, proxies);
            reach.compute(robot, (&self.chains, rates), (&configuration, frames), half, size, limbs);
        }
    }

    /// Returns the distance of a pair of links, given by its index, at which the proof holds.
    pub(super) fn needed(&self, state: &State, pair: usize) -> f64 {
        state.reach.needed(self.robot.pairs()[pair], self.between[pair], self.options.self_padding, &self.chains)
    }

    /// Returns the distance of a link from obstacles at which the proof holds.
    pub(super) fn needed_of_obstacles(&self, state: &State, link: usize) -> f64 {
        state.reach.needed_of_obstacles(link, self.padding(link), &self.chains)
    }

    fn padding(&self, link: usize) -> f64 {
        self.options.padding.get(link).copied().unwrap_or(0.0)
    }

    /// Decides about an item. If no proof is wanted, it is only compared at the current time.
    fn resolve(&self, state: &mut State, item: u32, wants_proof: bool, budget: &Budget<'_>) -> Answer {
        let item = item as usize;
        match self.robot.pairs().get(item) {
            Some(&pair) => {
                // Room for the rounding of the distance by which a certificate is verified.
                let needed = self.needed(state, item) + state.reach.rounding();
                self.resolve_pair(state, (item, pair), wants_proof.then_some(needed), budget)
            }
            None => {
                let link = item - self.robot.pairs().len();
                let needed = self.needed_of_obstacles(state, link) + state.reach.rounding();
                self.resolve_obstacles(state, link, wants_proof.then_some(needed), budget)
            }
        }
    }

    fn resolve_pair(
        &self,
        state: &mut State,
        (at, pair): (usize, [usize; 2]),
        needed: Option<f64>,
        budget: &Budget<'_>,
    ) -> Answer {
        let (robot, clearance) = (self.robot, self.options.self_padding);
        let State { frames, culling, links, caches, .. } = state;
        let needed = needed.filter(|needed| *needed <= MAX_NEEDED);
        if needed.is_some_and(|needed| culling.are_apart(pair, needed, robot.proxies(), frames)) {
            return Answer::Free;
        }
        pair.iter().for_each(|&link| links.place(link, robot, frames));
        let placed = pair.map(|link| &links.placed[link]);
        let is_hit = || !culling.are_apart(pair, clearance, robot.proxies(), frames);
        let collision = |found| collision(pair[0], Other::Link(pair[1]), found);
        decide(placed, [clearance, needed.unwrap_or(f64::INFINITY)], is_hit, &mut caches[at], budget, collision)
    }

    fn resolve_obstacles(&self, state: &mut State, link: usize, needed: Option<f64>, budget: &Budget<'_>) -> Answer {
        let (robot, clearance) = (self.robot, self.padding(link));
        let State { frames, culling, links, obstacle_caches, near, .. } = state;
        let needed = needed.filter(|needed| *needed <= MAX_NEEDED);
        let margin = needed.unwrap_or(clearance);
        let limbs = culling.limbs(link, robot.proxies(), frames);
        if limbs.is_some_and(|(limbs, slack)| !self.obstacles.may_be_near(limbs, margin + slack)) {
            return if needed.is_some() { Answer::Free } else { Answer::Open };
        }
        links.place(link, robot, frames);
        let placed = &links.placed[link];
        self.obstacles.near((link, placed), margin, near);
        let mut is_free = needed.is_some();
        for &at in &*near {
            let (part, obstacle) = self.obstacles.part(at);
            let cache = obstacle_caches.entry((link, at)).or_default();
            let collision = |found| collision(link, Other::Obstacle(part), found);
            let limits = [clearance, needed.unwrap_or(f64::INFINITY)];
            match decide([placed, obstacle], limits, || true, cache, budget, collision) {
                Answer::Free => {}
                Answer::Open => is_free = false,
                hit @ Answer::Hit(_) => return hit,
            }
        }
        if is_free { Answer::Free } else { Answer::Open }
    }
}

/// Decides about two shapes: whether they are farther apart than the needed distance, and
/// otherwise whether they are within the clearance.
fn decide(
    placed: [&PlacedLink; 2],
    [clearance, needed]: [f64; 2],
    may_hit: impl FnOnce() -> bool,
    cache: &mut Cache,
    budget: &Budget<'_>,
    collision: impl FnOnce(Proximity) -> Option<Collision>,
) -> Answer {
    if placed.iter().any(|placed| placed.is_nowhere()) {
        return Answer::Free;
    }
    if needed.is_finite()
        && (!may_be_near(placed[0], placed[1], needed) || proximity(placed, needed, cache, budget) == Proximity::Apart)
    {
        return Answer::Free;
    }
    if !may_hit() || !may_be_near(placed[0], placed[1], clearance) {
        return Answer::Open;
    }
    match proximity(placed, clearance, cache, budget) {
        Proximity::Intersects => collision(Proximity::Intersects).map_or(Answer::Open, Answer::Hit),
        Proximity::Apart | Proximity::Undecided => Answer::Open,
    }
}
