//! The search for the first time at which two bodies may touch: a descent over intervals of time
//! and pairs of pieces.
//!
//! Intervals are halved, the earlier half first. For each interval there is a list of pairs of
//! pieces that are not proved apart. A pair that is not proved apart over an interval is divided:
//! into pairs of smaller pieces, or into the halves of the interval if the pieces move by more than
//! their size.
//!
//! Source: Redon, Kheddar, Coquillart, *Fast continuous collision detection between rigid bodies*,
//! Computer Graphics Forum 21(3), 2002, for the tree of intervals; the bounds are those of
//! `interval`.
//!
//! The proof is docs/notes/proof.md, L34. The tests are in `tests/it/sweep`.

use std::cell::Cell;

use super::body::Body;
use super::interval::{Interval, Verdict};
use super::span::Span;
use crate::budget::Budget;
use crate::math::vec3::Vector;

/// Maximum number of times that the motion is halved. Its intervals still have ends that are exact
/// in doubles.
const MAX_LEVEL: u32 = 52;

/// Number of pairs between two checks of the budget. They take about 50 microseconds.
const PAIRS_PER_CHECK: u64 = 64;

/// Number of pairs that an exact distance counts for, as it may take a hundred times as long.
const PAIRS_PER_EXACT_DISTANCE: u64 = 128;

/// Maximum number of pairs in the search for a body that stays inside the circles of the other. It
/// finds one with few pairs, or not at all.
const MAX_ENVELOPE_PAIRS: u64 = 1 << 14;

/// Two pieces, and the direction along which they were last found to be apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) pieces: [u32; 2],
    pub(super) direction: Vector,
}

/// The result of a search. Nothing touches before the time `t`.
pub(super) enum Found {
    /// The bodies are proved apart for the whole motion.
    Never,
    /// Two pieces may touch from a time on.
    Contact { t: f64, pair: Pair },
    /// The limit on the work was reached, or the budget ended the search.
    Stopped { t: f64 },
}

/// A search of two bodies.
pub(super) struct Search<'s, 'm> {
    bodies: &'s mut [Body<'m>; 2],
    /// Lower bound on the gap that proves two pieces apart, in world units.
    gap: f64,
    /// Gap along one direction that two pieces may keep from the start on although it does not
    /// prove them apart, if bodies may touch. It is less than zero by more than rounding.
    touch_gap: Option<f64>,
    /// Pieces that approach each other by no more than this over an interval are not divided in
    /// time.
    resolution: f64,
    budget: &'s Budget<'s>,
    is_stopped: bool,
    max_pairs: u64,
    /// Number of pairs of pieces that were compared.
    compared: u64,
    /// Number of distances that were computed exactly.
    exact_distances: Cell<u64>,
    /// Amount of work at which the budget is checked next.
    next_check: u64,
}

impl<'s, 'm> Search<'s, 'm> {
    /// Returns a search without limits.
    pub(super) fn new(bodies: &'s mut [Body<'m>; 2], gap: f64, resolution: f64, max_pairs: u64) -> Self {
        Self {
            bodies,
            gap,
            touch_gap: None,
            resolution,
            budget: Budget::unlimited(),
            is_stopped: false,
            max_pairs,
            compared: 0,
            exact_distances: Cell::new(0),
            next_check: PAIRS_PER_CHECK,
        }
    }

    /// Returns this search with a budget.
    pub(super) fn with_budget(self, budget: &'s Budget<'s>) -> Self {
        Self { budget, ..self }
    }

    /// Returns this search for bodies that may touch.
    pub(super) fn with_touch_gap(self, touch_gap: Option<f64>) -> Self {
        Self { touch_gap, ..self }
    }

    /// Reports whether the budget ended the search.
    pub(super) fn is_stopped(&self) -> bool {
        self.is_stopped
    }
}

impl Search<'_, '_> {
    /// Runs the search.
    pub(super) fn run(&mut self) -> Found {
        let all = self.bodies[0].roots.iter().flat_map(|&a| self.bodies[1].roots.iter().map(move |&b| [a, b]));
        let all: Vec<Pair> = all.map(|pieces| Pair { pieces, direction: [0.0, 0.0, 1.0] }).collect();
        if [0, 1].into_iter().any(|side| self.is_apart_from_envelope(side, all.clone())) {
            return Found::Never;
        }
        let mut waiting: Vec<(Span, Vec<Pair>)> = vec![(Span::WHOLE, all)];
        while let Some((span, mut pairs)) = waiting.pop() {
            let times = [span.low(), span.high()];
            let interval = Interval::new(self.bodies, times);
            let since_start = self.touch_gap.map(|gap| (Interval::new(self.bodies, [0.0, times[1]]), gap));
            let window = Window { interval, since_start };
            let mut rest = Vec::new();
            while let Some(pair) = pairs.pop() {
                if self.must_stop() {
                    return Found::Stopped { t: span.low() };
                }
                match self.divide(&window, span, pair) {
                    Division::Apart => {}
                    Division::Pieces(parts) => pairs.extend(parts),
                    Division::Time(pair) => rest.push(pair),
                    Division::Contact(pair) => return Found::Contact { t: span.low(), pair },
                }
            }
            if !rest.is_empty() {
                let [left, right] = span.halves();
                waiting.push((right, rest.clone()));
                waiting.push((left, rest));
            }
        }
        Found::Never
    }

    /// Tries to prove at once that one body, divided into pieces, is apart from all that the other
    /// body sweeps over the whole motion, as for a wheel in its housing.
    fn is_apart_from_envelope(&mut self, divided: usize, mut pairs: Vec<Pair>) -> bool {
        let window = Window { interval: Interval::new(self.bodies, [0.0, 1.0]), since_start: None };
        for _ in 0..MAX_ENVELOPE_PAIRS {
            let Some(pair) = pairs.pop() else { return true };
            if self.must_stop() {
                return false;
            }
            if let Some(pair) = self.remains(&window, pair) {
                if !self.bodies[divided].is_divisible(pair.pieces[divided]) {
                    return false;
                }
                pairs.extend(self.parts(pair, divided));
            }
        }
        false
    }

    /// Counts one more pair. Reports whether the limit on the work is reached or the budget ends
    /// the search.
    fn must_stop(&mut self) -> bool {
        self.compared += 1;
        let work = self.compared + PAIRS_PER_EXACT_DISTANCE * self.exact_distances.get();
        if work >= self.next_check {
            self.next_check = work + PAIRS_PER_CHECK;
            self.is_stopped |= self.budget.is_spent();
        }
        self.is_stopped || work > self.max_pairs
    }

    /// Returns a pair with its direction if it is not proved apart over an interval.
    fn remains(&self, window: &Window, pair: Pair) -> Option<Pair> {
        let pieces = [0, 1].map(|side| &self.bodies[side].pieces[pair.pieces[side] as usize]);
        let classify = |interval: &Interval, direction: Vector, gap: f64| {
            interval.classify(self.bodies, pieces, direction, gap, &self.exact_distances)
        };
        let Verdict::Unknown(direction) = classify(&window.interval, pair.direction, self.gap) else { return None };
        if let Some((since_start, gap)) = &window.since_start
            && let Verdict::Apart = classify(since_start, direction, *gap)
        {
            return None;
        }
        Some(Pair { direction, ..pair })
    }

    /// Returns the pairs into which a pair is divided on one side.
    fn parts(&mut self, pair: Pair, side: usize) -> impl Iterator<Item = Pair> + use<> {
        self.bodies[side].divide(pair.pieces[side]).into_iter().map(move |part| {
            let mut pieces = pair.pieces;
            pieces[side] = part;
            Pair { pieces, ..pair }
        })
    }

    /// Compares two pieces over an interval, and divides them if they are not proved apart.
    fn divide(&mut self, window: &Window, span: Span, pair: Pair) -> Division {
        let Some(pair) = self.remains(window, pair) else { return Division::Apart };
        let pieces = [0, 1].map(|side| &self.bodies[side].pieces[pair.pieces[side] as usize]);
        let approach = window.interval.approach(self.bodies, pieces);
        let can_divide = [0, 1].map(|side| self.bodies[side].is_divisible(pair.pieces[side]));
        let sizes = [0, 1].map(|side| if can_divide[side] { pieces[side].diameter } else { 0.0 });
        let is_long = span.level < MAX_LEVEL && approach > self.resolution;
        if is_long && (approach > sizes[0].max(sizes[1]) || can_divide == [false; 2]) {
            return Division::Time(pair);
        }
        if can_divide == [false; 2] {
            return Division::Contact(pair);
        }
        let side = usize::from(!can_divide[0] || can_divide[1] && sizes[1] > sizes[0]);
        Division::Pieces(self.parts(pair, side).collect())
    }
}

/// An interval of time, and the interval from the start to its end with the gap that bodies which
/// may touch keep over it.
struct Window {
    interval: Interval,
    since_start: Option<(Interval, f64)>,
}

/// Remainder of a pair of pieces over an interval.
enum Division {
    /// Nothing: the pieces are proved apart.
    Apart,
    /// Pairs of smaller pieces.
    Pieces(Vec<Pair>),
    /// The pair over both halves of the interval.
    Time(Pair),
    /// The pair, which cannot be divided.
    Contact(Pair),
}
