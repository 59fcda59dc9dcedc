//! Examines a time of a motion: which pairs collide, and how long before and after it each pair
//! cannot, by its distance and by how far it can move.

use std::collections::HashMap;

use super::check::{CheckOptions, Collision, Other, collision, proximity};
use super::cull::Culling;
use super::frame::Frame;
use super::links::{PlacedLink, PlacedLinks, may_be_near};
use super::model::Robot;
use super::obstacles::Obstacles;
use super::proxy::Proxy;
use super::reach::{Chains, Levers, Moment, Rates, Reach};
use crate::budget::Budget;
use crate::query::{Cache, Proximity, Query};

/// Maximum distance for which shapes are compared, 2^200. Links that may move farther are not.
const MAX_NEEDED: f64 = f64::from_bits((1023 + 200) << 52);

/// Largest distance of the capsules of a pair, as a share of their radii, at which the distance of
/// the shapes is computed. It is larger by about a radius, and frees longer intervals, but costs as
/// much as ten times. If this is larger, more distances are computed at fewer times.
const EXACT_SHARE: f64 = 0.2;

/// Largest distance of the convex hulls of a pair, as a share of the radii of its capsules, at
/// which the distance of the shapes is computed. That takes about 25 times as long as a bound by
/// hulls, and frees more only if a shape is not convex. If this is smaller, such pairs need more
/// times.
const SHARE_OF_HULLS: f64 = 0.01;

/// An interval of a motion in which a pair of links, or a link and all obstacles, are proved to
/// keep their clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertificateRow {
    /// Index of the link.
    pub link: usize,
    /// Index of the other link, which is larger; `None` for all obstacles.
    pub other: Option<usize>,
    /// Time in the middle of the interval, from 0 at the start of the motion to 1 at its end.
    pub time: f64,
    /// Half of the length of the interval.
    pub half: f64,
}

/// Subject of a proof: a pair of links that is checked, or a link and all obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Subject {
    pub(super) link: usize,
    /// Index of the pair and the other link; `None` for all obstacles.
    pub(super) pair: Option<(usize, usize)>,
}

/// Answer about a subject at a time.
pub(super) enum Answer {
    /// The subject keeps its clearance for this long before and after. Zero if nothing is known.
    Free(f64),
    Hit(Collision),
}

/// How long an interval a subject is to be freed for, before and after the current time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    pub(super) half: f64,
    /// Whether distances of shapes may be computed. Otherwise only volumes are compared.
    pub(super) is_exact: bool,
}

/// The parts of a proof that do not depend on the motion.
pub(super) struct Scan<'s> {
    pub(super) robot: &'s Robot,
    options: &'s CheckOptions<'s>,
    obstacles: Obstacles,
    chains: Chains,
    /// For each pair the joints between the links.
    paths: Vec<Vec<usize>>,
}

/// State that consecutive times share.
pub(super) struct State {
    rates: Rates,
    ends: [Vec<f64>; 2],
    configuration: Vec<f64>,
    frames: Vec<Frame>,
    culling: Culling,
    links: PlacedLinks,
    levers: Levers,
    reach: Reach,
    /// State of the last query of each pair, and of each link and obstacle.
    caches: Vec<Cache>,
    obstacle_caches: HashMap<(usize, usize), Cache>,
    near: Vec<(f64, usize)>,
}

/// Returns the configuration at a time between 0 and 1.
pub(super) fn between(start: &[f64], end: &[f64], time: f64) -> Vec<f64> {
    let at = |(p, q): (&f64, &f64)| if time == 1.0 { *q } else { p + time * (q - p) };
    start.iter().zip(end).map(at).collect()
}

impl<'s> Scan<'s> {
    pub(super) fn new(robot: &'s Robot, options: &'s CheckOptions<'s>) -> Self {
        let chains = Chains::new(robot);
        let paths = robot.pairs().iter().map(|&pair| chains.between(pair)).collect();
        let obstacles = Obstacles::new(options.obstacles, &options.ignored);
        Self { robot, options, obstacles, chains, paths }
    }

    pub(super) fn state(&self) -> State {
        State {
            rates: Rates::default(),
            ends: [Vec::new(), Vec::new()],
            configuration: Vec::new(),
            frames: Vec::new(),
            culling: Culling::default(),
            links: PlacedLinks::new(self.robot.links().len()),
            levers: Levers::default(),
            reach: Reach::default(),
            caches: Vec::new(),
            obstacle_caches: HashMap::new(),
            near: Vec::new(),
        }
    }

    /// Starts a motion. Its distances do not depend on earlier motions.
    pub(super) fn begin(&self, state: &mut State, ends: &[Vec<f64>; 2]) {
        self.forget(state);
        self.move_between(state, ends);
    }

    /// Forgets all earlier queries.
    pub(super) fn forget(&self, state: &mut State) {
        state.caches.clear();
        state.caches.resize_with(self.paths.len(), Cache::default);
        state.obstacle_caches.clear();
    }

    /// Sets the start and the end of the motion.
    pub(super) fn move_between(&self, state: &mut State, ends: &[Vec<f64>; 2]) {
        state.rates = Rates::new(self.robot, ends.each_ref().map(Vec::as_slice));
        state.ends.clone_from(ends);
    }

    /// Returns the coordinates that move the links of a pair, given by its index, relative to each
    /// other.
    pub(super) fn coordinates_between(&self, pair: usize) -> Vec<usize> {
        let of = |&step: &usize| {
            let source = &self.robot.steps()[step].source;
            source.first..source.first + source.count
        };
        self.paths[pair].iter().flat_map(of).collect()
    }

    /// Returns the coordinate of the joint that moves a pair the most, given by its index, of those
    /// that the last examination bounded. Returns `None` if no joint moves it.
    pub(super) fn widest(&self, state: &State, pair: usize) -> Option<usize> {
        let step = self.paths[pair][state.reach.widest()?];
        let source = &self.robot.steps()[step].source;
        let width = |&coordinate: &usize| state.ends[1][coordinate] - state.ends[0][coordinate];
        (source.first..source.first + source.count).max_by(|a, b| width(a).total_cmp(&width(b)))
    }

    /// Returns all subjects of a proof.
    pub(super) fn subjects(&self) -> Vec<Subject> {
        let pair = |(at, &[link, other]): (usize, &[usize; 2])| Subject { link, pair: Some((at, other)) };
        let has_shape = |link: &usize| self.robot.links()[*link].shape.is_some();
        let links = (0..self.robot.links().len()).filter(|link| !self.obstacles.is_empty() && has_shape(link));
        let pairs = self.robot.pairs().iter().enumerate().map(pair);
        pairs.chain(links.map(|link| Subject { link, pair: None })).collect()
    }

    /// Reports whether nothing bounds the motion of a link of a subject.
    pub(super) fn is_boundless(&self, subject: Subject) -> bool {
        let is_boundless = |link: usize| matches!(self.robot.proxies()[link], Proxy::Anywhere);
        is_boundless(subject.link) || subject.pair.is_some_and(|(_, other)| is_boundless(other))
    }

    /// Moves the links to a time.
    pub(super) fn move_to(&self, state: &mut State, time: f64) {
        let State { ends: [start, end], configuration, frames, culling, links, levers, rates, .. } = state;
        let (robot, proxies) = (self.robot, self.robot.proxies());
        *configuration = between(start, end, time);
        robot.place(configuration, frames);
        links.start();
        culling.start(proxies, frames);
        let size = culling.size(proxies, frames);
        levers.start(&Moment { robot, chains: &self.chains, rates, configuration, frames }, size);
    }

    /// Bounds how far a subject moves around the current time.
    fn bound(&self, state: &mut State, subject: Subject) {
        let State { configuration, frames, culling, levers, rates, reach, .. } = state;
        let moment = Moment { robot: self.robot, chains: &self.chains, rates, configuration, frames };
        let clearance = self.clearance(subject);
        match subject.pair {
            Some((at, other)) => {
                let path = (&*self.paths[at], clearance);
                reach.of_pair([subject.link, other], path, &moment, levers, culling);
            }
            None => reach.of_link(subject.link, clearance, &moment, levers, culling),
        }
    }

    fn clearance(&self, subject: Subject) -> f64 {
        match subject.pair {
            Some(_) => self.options.self_padding,
            None => self.options.padding.get(subject.link).copied().unwrap_or(0.0),
        }
    }

    /// Decides whether a subject collides at the current time, and for how long it is free.
    pub(super) fn examine(&self, state: &mut State, subject: Subject, wish: Wish, budget: &Budget<'_>) -> Answer {
        self.bound(state, subject);
        let wanted = state.reach.wanted(wish.half);
        match subject.pair {
            Some((at, other)) => self.examine_pair(state, (at, [subject.link, other]), wish, wanted, budget),
            None => self.examine_obstacles(state, subject.link, wish, wanted, budget),
        }
    }

    fn examine_pair(
        &self,
        state: &mut State,
        (at, pair): (usize, [usize; 2]),
        wish: Wish,
        wanted: f64,
        budget: &Budget<'_>,
    ) -> Answer {
        let (robot, clearance) = (self.robot, self.options.self_padding);
        let State { frames, culling, links, caches, reach, .. } = state;
        if wanted <= MAX_NEEDED && culling.are_apart(pair, wanted, robot.proxies(), frames) {
            return Answer::Free(wish.half);
        }
        pair.iter().for_each(|&link| culling.place(link, robot.proxies(), frames));
        let least = culling.least_distance(pair, robot.proxies());
        let radii = culling.thickness(pair[0]) + culling.thickness(pair[1]);
        if !wish.is_exact || (least > clearance && least - clearance > EXACT_SHARE * radii) {
            return Answer::Free(reach.half(least, wish.half));
        }
        let least = culling.least_distance_of_hulls(pair, wanted.next_up(), robot.proxies(), frames);
        if least > wanted || (least > clearance && least - clearance > SHARE_OF_HULLS * radii) {
            return Answer::Free(reach.half(least, wish.half));
        }
        pair.iter().for_each(|&link| links.place(link, robot, frames));
        let placed = pair.map(|link| &links.placed[link]);
        if !may_be_near(placed[0], placed[1], wanted) {
            return Answer::Free(wish.half);
        }
        match distance(placed, clearance, &mut caches[at], budget) {
            Proof::Distance(distance) => Answer::Free(reach.half(distance.max(least), wish.half)),
            Proof::Hit => {
                collision(pair[0], Other::Link(pair[1]), Proximity::Intersects).map_or(Answer::Free(0.0), Answer::Hit)
            }
        }
    }

    fn examine_obstacles(
        &self,
        state: &mut State,
        link: usize,
        wish: Wish,
        wanted: f64,
        budget: &Budget<'_>,
    ) -> Answer {
        let (robot, clearance) = (self.robot, self.clearance(Subject { link, pair: None }));
        let State { frames, culling, links, obstacle_caches, reach, near, .. } = state;
        let limit = wanted.min(MAX_NEEDED);
        let limbs = culling.limbs(link, robot.proxies(), frames);
        if limbs.is_some_and(|(limbs, slack)| !self.obstacles.may_be_near(limbs, limit + slack)) {
            return Answer::Free(reach.half(limit.next_up(), wish.half));
        }
        near.clear();
        self.obstacles.distances(link, limbs, limit, |at, least| near.push((least, at)));
        let by_distance = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        near.sort_unstable_by(by_distance);
        // All others are beyond the limit.
        let mut least = limit.next_up();
        for (distance, at) in &mut *near {
            if *distance >= least {
                break;
            }
            if let Some(limbs) = limbs.filter(|_| wish.is_exact) {
                *distance = distance.max(self.obstacles.least_distance(limbs, *at, least));
            }
            least = least.min(*distance);
        }
        near.sort_unstable_by(by_distance);
        let radius = culling.thickness(link);
        if !wish.is_exact || (least > clearance && least - clearance > EXACT_SHARE * radius) {
            return Answer::Free(reach.half(least, wish.half));
        }
        links.place(link, robot, frames);
        let placed = &links.placed[link];
        let mut best = limit.next_up();
        for &(least, at) in &*near {
            if least > best || budget.is_spent() {
                break;
            }
            let (part, obstacle) = self.obstacles.part(at);
            if !may_be_near(placed, obstacle, best) {
                continue;
            }
            let cache = obstacle_caches.entry((link, at)).or_default();
            match distance([placed, obstacle], clearance, cache, budget) {
                Proof::Distance(distance) => best = best.min(distance.max(least)),
                Proof::Hit => {
                    let hit = collision(link, Other::Obstacle(part), Proximity::Intersects);
                    return hit.map_or(Answer::Free(0.0), Answer::Hit);
                }
            }
        }
        Answer::Free(reach.half(best, wish.half))
    }

    /// Reports whether the distances at the current time prove that a subject keeps its clearance
    /// for `half` of the time before and after, by distances that no earlier query influenced.
    pub(super) fn holds(&self, state: &mut State, subject: Subject, half: f64) -> bool {
        self.bound(state, subject);
        let needed = state.reach.needed(half);
        let State { frames, culling, links, near, .. } = state;
        links.place(subject.link, self.robot, frames);
        if let Some((_, other)) = subject.pair {
            links.place(other, self.robot, frames);
            return are_apart([&links.placed[subject.link], &links.placed[other]], needed);
        }
        if !needed.is_finite() {
            return false;
        }
        let placed = &links.placed[subject.link];
        near.clear();
        let limbs = culling.limbs(subject.link, self.robot.proxies(), frames);
        self.obstacles.distances(subject.link, limbs, needed, |at, least| near.push((least, at)));
        near.iter().all(|&(_, at)| are_apart([placed, self.obstacles.part(at).1], needed))
    }
}

/// Result of a comparison of two shapes.
enum Proof {
    /// They are farther apart than the clearance, by at least this distance, or nothing if zero.
    Distance(f64),
    /// They are within the clearance.
    Hit,
}

/// Compares two shapes.
fn distance(placed: [&PlacedLink; 2], clearance: f64, cache: &mut Cache, budget: &Budget<'_>) -> Proof {
    let [PlacedLink::At(a), PlacedLink::At(b)] = placed else {
        let is_nowhere = placed.iter().any(|placed| placed.is_nowhere());
        return Proof::Distance(if is_nowhere { f64::MAX } else { 0.0 });
    };
    let found = Query::new().with_cache(cache).with_budget(budget).distance(&**a, &**b);
    if found.proximity == Proximity::Apart && found.lower > clearance {
        return Proof::Distance(found.lower);
    }
    match if clearance > 0.0 { proximity(placed, clearance, cache, budget) } else { found.proximity } {
        Proximity::Intersects => Proof::Hit,
        Proximity::Apart => Proof::Distance(found.lower),
        Proximity::Undecided => Proof::Distance(0.0),
    }
}

/// Reports whether the lower bound of the distance of two shapes is above a distance.
fn are_apart(placed: [&PlacedLink; 2], needed: f64) -> bool {
    match placed {
        [PlacedLink::Nowhere, _] | [_, PlacedLink::Nowhere] => true,
        [PlacedLink::At(a), PlacedLink::At(b)] => {
            let found = crate::query::distance(&**a, &**b);
            found.proximity == Proximity::Apart && found.lower > needed
        }
        _ => false,
    }
}
