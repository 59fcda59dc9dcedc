//! The search for the first time at which two bodies may touch: a descent over intervals of time and
//! pairs of pieces.
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

use super::body::Body;
use super::interval::{Interval, Verdict};
use super::span::Span;
use crate::math::vec3::Vector;
use crate::mesh::Interrupt;

/// Maximum number of times that the motion is halved. Its intervals still have ends that are exact
/// in doubles.
const MAX_LEVEL: u32 = 52;

/// Number of pairs between two checks of the interrupt. They take about 50 microseconds.
const PAIRS_PER_CHECK: u64 = 64;

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
    /// The limit on the work was reached.
    Exhausted { t: f64 },
    /// The interrupt ended the search.
    Interrupted { t: f64 },
}

/// A search of two bodies.
pub(super) struct Search<'s, 'm> {
    pub(super) bodies: &'s mut [Body<'m>; 2],
    /// Distance at which bodies count as touching, in world units.
    pub(super) clearance: f64,
    /// Pieces that approach each other by no more than this over an interval are not divided in
    /// time.
    pub(super) resolution: f64,
    /// Maximum number of pairs of pieces that are compared.
    pub(super) max_pairs: u64,
    pub(super) interrupt: Interrupt<'s>,
}

impl Search<'_, '_> {
    /// Runs the search. Also returns the number of pairs of pieces that were compared.
    pub(super) fn run(&mut self) -> (Found, u64) {
        let mut compared = 0;
        let all = self.bodies[0].roots.iter().flat_map(|&a| self.bodies[1].roots.iter().map(move |&b| [a, b]));
        let all = all.map(|pieces| Pair { pieces, direction: [0.0, 0.0, 1.0] }).collect();
        let mut waiting: Vec<(Span, Vec<Pair>)> = vec![(Span::WHOLE, all)];
        while let Some((span, mut pairs)) = waiting.pop() {
            let interval = Interval::new(self.bodies, span);
            let mut rest = Vec::new();
            while let Some(pair) = pairs.pop() {
                compared += 1;
                if compared % PAIRS_PER_CHECK == 0 && self.interrupt.is_wanted() {
                    return (Found::Interrupted { t: span.low() }, compared);
                }
                if compared > self.max_pairs {
                    return (Found::Exhausted { t: span.low() }, compared);
                }
                match self.divide(&interval, span, pair) {
                    Division::Apart => {}
                    Division::Pieces(parts) => pairs.extend(parts),
                    Division::Time(pair) => rest.push(pair),
                    Division::Contact(pair) => return (Found::Contact { t: span.low(), pair }, compared),
                }
            }
            if !rest.is_empty() {
                let [left, right] = span.halves();
                waiting.push((right, rest.clone()));
                waiting.push((left, rest));
            }
        }
        (Found::Never, compared)
    }

    /// Compares two pieces over an interval, and divides them if they are not proved apart.
    fn divide(&mut self, interval: &Interval, span: Span, mut pair: Pair) -> Division {
        let [a, b] = pair.pieces;
        let pieces = [&self.bodies[0].pieces[a as usize], &self.bodies[1].pieces[b as usize]];
        match interval.classify(self.bodies, pieces, pair.direction, self.clearance) {
            Verdict::Apart => return Division::Apart,
            Verdict::Unknown(direction) => pair.direction = direction,
        }
        let approach = interval.approach(self.bodies, pieces);
        let sizes = pieces.map(|piece| piece.diameter);
        let can_divide = [self.bodies[0].is_divisible(a), self.bodies[1].is_divisible(b)];
        let is_long = span.level < MAX_LEVEL && approach > self.resolution;
        let size = f64::max(if can_divide[0] { sizes[0] } else { 0.0 }, if can_divide[1] { sizes[1] } else { 0.0 });
        if is_long && (approach > size || can_divide == [false; 2]) {
            return Division::Time(pair);
        }
        if can_divide == [false; 2] {
            return Division::Contact(pair);
        }
        let side = usize::from(!can_divide[0] || can_divide[1] && sizes[1] > sizes[0]);
        let parts = self.bodies[side].divide(pair.pieces[side]);
        let with = |part: u32| {
            let mut pieces = pair.pieces;
            pieces[side] = part;
            Pair { pieces, ..pair }
        };
        Division::Pieces(parts.into_iter().map(with).collect())
    }
}

/// What remains of a pair of pieces over an interval.
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
