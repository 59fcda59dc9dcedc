//! A sweep of two moving things with options.

use super::body::Body;
use super::impact::{Impact, Touch};
use super::motion::Motion;
use super::piece::{Content, Piece, Volume};
use super::search::{Found, Pair, Search};
use crate::convex::{HalfSpace, separation};
use crate::input::InputError;
use crate::math::vec3::{Vector, dot};
use crate::mesh::Interrupt;
use crate::query::Query;
use crate::shape::{PlacedShape, Shape};

/// Maximum distance of bodies that count as touching, relative to the sum of their sizes: 2^-38.
/// Nothing more can be proved below it.
const TOUCHING: f64 = 1.0 / (1_u64 << 38) as f64;

/// Maximum number of pairs of pieces that one sweep compares: 2^22. Each takes about a microsecond.
const MAX_PAIRS: u64 = 1 << 22;

/// A sweep with options.
///
/// Most callers do not need it: [`time_of_impact(a, b, ..)`](super::time_of_impact()) is
/// `Sweep::new().time_of_impact(a, b, ..)`.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'s> {
    clearance: f64,
    interrupt: Interrupt<'s>,
    max_pairs: u64,
}

impl Default for Sweep<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl<'s> Sweep<'s> {
    /// Returns a sweep to contact, which nothing interrupts.
    #[must_use]
    pub fn new() -> Self {
        Self { clearance: 0.0, interrupt: Interrupt::NEVER, max_pairs: MAX_PAIRS }
    }

    /// Returns this sweep with a clearance in world units: things touch if their distance is at
    /// most the clearance. Negative numbers and NaN count as zero.
    #[must_use]
    pub fn with_clearance(self, clearance: f64) -> Self {
        Self { clearance: clearance.max(0.0), ..self }
    }

    /// Returns this sweep with an interrupt, a function that can end the sweep early. It is checked
    /// about every 100 microseconds. The answer then is undecided: the things are proved apart up
    /// to `t_lower`.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt<'s>) -> Self {
        Self { interrupt, ..self }
    }

    /// Returns this sweep with a limit on the number of pairs of pieces that it compares, if that is
    /// less than 2^22, the default. If the limit is reached, the answer is undecided: the things are
    /// proved apart up to `t_lower`.
    #[must_use]
    pub fn with_max_pairs(self, max_pairs: u64) -> Self {
        Self { max_pairs: max_pairs.min(MAX_PAIRS), ..self }
    }

    /// Returns the time at which two things first touch, as
    /// [`time_of_impact`](super::time_of_impact()) does.
    ///
    /// # Errors
    /// The errors of [`Shape::at`], for either shape at a pose of its motion.
    pub fn time_of_impact(
        self,
        a: impl Into<Shape>,
        b: impl Into<Shape>,
        motion_a: &Motion,
        motion_b: &Motion,
    ) -> Result<Impact, InputError> {
        let (a, b) = (a.into(), b.into());
        if motion_a.is_before(motion_b) {
            return self.in_order([&a, &b], [motion_a, motion_b]);
        }
        // The motions determine the order of the arithmetic, so swapping the things changes no digit.
        let mut impact = self.in_order([&b, &a], [motion_b, motion_a])?;
        if let Some(touch) = &mut impact.touch {
            touch.normal = touch.normal.map(|x| 0.0 - x);
            touch.parts.swap(0, 1);
            touch.faces.swap(0, 1);
        }
        Ok(impact)
    }

    fn in_order(self, [a, b]: [&Shape; 2], [motion_a, motion_b]: [&Motion; 2]) -> Result<Impact, InputError> {
        let at =
            |t: f64| -> Result<[PlacedShape; 2], InputError> { Ok([a.at(motion_a.at(t))?, b.at(motion_b.at(t))?]) };
        let touches =
            |[a, b]: &[PlacedShape; 2]| Query::new().with_interrupt(self.interrupt).within(a, b, self.clearance);
        let start = at(0.0)?;
        if touches(&start) {
            return Ok(Impact::between(0.0, 0.0));
        }
        if motion_a.is_in_step_with(motion_b) {
            return Ok(Impact::NEVER);
        }
        if start.iter().zip([motion_a, motion_b]).any(|(shape, motion)| shape.is_unbounded() && motion.turns()) {
            return Ok(Impact::between(0.0, f64::INFINITY));
        }
        let mut bodies = [Body::new(a, motion_a)?, Body::new(b, motion_b)?];
        let resolution = TOUCHING * (bodies[0].reach + bodies[1].reach);
        let mut search = Search {
            bodies: &mut bodies,
            clearance: self.clearance,
            resolution,
            max_pairs: self.max_pairs,
            interrupt: self.interrupt,
        };
        let (found, _) = search.run();
        let contact_after = |t: f64| contact_after(t, |t| at(t).is_ok_and(|shapes| touches(&shapes)));
        Ok(match found {
            Found::Never => Impact::NEVER,
            Found::Interrupted { t } => Impact::between(t, f64::INFINITY),
            Found::Exhausted { t } => Impact::between(t, contact_after(t)),
            Found::Contact { t, pair } => {
                let touch = touch(&bodies, t, pair, &at(t)?);
                Impact { touch, ..Impact::between(t, contact_after(t)) }
            }
        })
    }
}

/// Returns the place at which two pieces touch at a time.
fn touch(bodies: &[Body<'_>; 2], t: f64, pair: Pair, shapes: &[PlacedShape; 2]) -> Option<Touch> {
    let pieces: [&Piece; 2] = [0, 1].map(|side| &bodies[side].pieces[pair.pieces[side] as usize]);
    let poses = [0, 1].map(|side| bodies[side].motion.at(t));
    let _ = (shapes, dot, HalfSpace::new);
    let points =
        bodies[0].at(pieces[0], &poses[0], |a| bodies[1].at(pieces[1], &poses[1], |b| separation(a, b).points));
    let points: [Vector; 2] = points.flatten()?;
    Some(Touch {
        point: [0, 1, 2].map(|k| 0.5 * points[0][k] + 0.5 * points[1][k]),
        normal: pair.direction.map(|x| x + 0.0),
        parts: pieces.map(|piece| piece.part),
        faces: pieces.map(|piece| if let Content::Face(face) = piece.content { Some(face) } else { None }),
    })
}

/// Returns a time at or after `t` at which the bodies touch, or infinity. It tries growing steps.
fn contact_after(t: f64, touch: impl Fn(f64) -> bool) -> f64 {
    let steps = (0..13).map(|k| 16.0 * TOUCHING * (1_u64 << (2 * k)) as f64);
    std::iter::once(0.0).chain(steps).map(|step| (t + step).min(1.0)).find(|&t| touch(t)).unwrap_or(f64::INFINITY)
}
