//! A sweep of two moving things with options.

use super::body::Body;
use super::impact::{Impact, Touch};
use super::motion::Motion;
use super::piece::{Content, Piece};
use super::search::{Found, Pair, Search};
use crate::budget::Budget;
use crate::convex::separation;
use crate::input::InputError;
use crate::query::{ContactOptions, Penetrates, Query};
use crate::shape::{Form, PlacedShape, Shape};

/// Maximum distance of bodies that count as touching, relative to the sum of their sizes: 2^-38.
/// Nothing more can be proved below it.
pub(super) const TOUCHING: f64 = 1.0 / (1_u64 << 38) as f64;

/// Maximum number of pairs of pieces that one sweep compares: 2^21. Each takes about a microsecond.
const MAX_PAIRS: u64 = 1 << 21;

/// A sweep with options.
///
/// Most callers do not need it: [`time_of_impact(a, b, ..)`](super::time_of_impact()) is
/// `Sweep::new().time_of_impact(a, b, ..)`.
///
/// ```
/// use impinge::sweep::{Impact, Motion, Sweep};
/// use impinge::{Pose, Shape};
///
/// let (sphere, floor) = (Shape::sphere([0.0; 3], 0.5)?, Shape::half_space([0.0, 0.0, 1.0], 0.0)?);
/// let between = |from: f64, to: f64| {
///     Motion::between(Pose::from_translation([0.0, 0.0, from])?, Pose::from_translation([9.0, 0.0, to])?)
/// };
/// let (fall, slide, rest) = (between(2.5, 0.5)?, between(0.5, 0.5)?, Motion::default());
/// let impact = Sweep::new().with_clearance(0.5).time_of_impact(&sphere, &floor, &fall, &rest)?;
/// assert!(impact.t_lower <= 0.75 && impact.t_lower > 0.75 - 1e-9);
/// assert_eq!(Sweep::new().time_of_impact(&sphere, &floor, &slide, &rest)?.t_upper, 0.0);
/// let impact = Sweep::new().ignoring_touch().time_of_impact(&sphere, &floor, &slide, &rest)?;
/// assert_eq!(impact, Impact::NEVER);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'s> {
    clearance: f64,
    ignores_touch: bool,
    budget: &'s Budget<'s>,
    max_pairs: u64,
}

impl Default for Sweep<'_> {
    /// Returns a sweep without options.
    fn default() -> Self {
        Self { clearance: 0.0, ignores_touch: false, budget: Budget::unlimited(), max_pairs: MAX_PAIRS }
    }
}

impl<'s> Sweep<'s> {
    /// Returns a sweep to contact, without limits.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns this sweep with a clearance in world units: things touch if their distance is at
    /// most the clearance. Negative numbers and NaN count as zero.
    #[must_use]
    pub fn with_clearance(self, clearance: f64) -> Self {
        Self { clearance: clearance.max(0.0), ..self }
    }

    /// Returns this sweep so that things may touch: contact counts only once the things reach into
    /// each other by more than 2^-36 of their sizes. So things that touch at the start may move
    /// apart or slide along each other.
    ///
    /// With a clearance, things may come as near as the clearance. If they are nearer at the start,
    /// they may stay as near as they are.
    ///
    /// Two solid meshes may touch at the start if [`penetrates`](crate::query::penetrates()) is
    /// `No`. If a solid mesh and a shape touch at the start, that counts as contact.
    #[must_use]
    pub fn ignoring_touch(self) -> Self {
        Self { ignores_touch: true, ..self }
    }

    /// Returns this sweep with limits on its work. They are checked about every 100
    /// microseconds while the sweep compares pieces. Once one is reached, the answer is undecided:
    /// the things are proved apart up to `t_lower`.
    #[must_use]
    pub fn with_budget(self, budget: &'s Budget<'s>) -> Self {
        Self { budget, ..self }
    }

    /// Returns this sweep with a limit on the number of pairs of pieces that it compares, if that
    /// is less than 2^21, the default. If the limit is reached, the answer is undecided: the things
    /// are proved apart up to `t_lower`. An exact distance of two polytopes counts as 128 pairs.
    #[must_use]
    pub fn with_max_pairs(self, max_pairs: u64) -> Self {
        Self { max_pairs: max_pairs.min(MAX_PAIRS), ..self }
    }

    /// Returns the clearance in world units.
    pub(crate) fn clearance(&self) -> f64 {
        self.clearance
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
        // The motions determine the order of the arithmetic, so swapping the things changes no
        // digit.
        let mut impact = self.in_order([&b, &a], [motion_b, motion_a])?;
        if let Some(touch) = &mut impact.touch {
            touch.normal = touch.normal.map(|x| 0.0 - x);
            touch.parts.swap(0, 1);
            touch.faces.swap(0, 1);
        }
        Ok(impact)
    }

    fn in_order(self, shapes: [&Shape; 2], motions: [&Motion; 2]) -> Result<Impact, InputError> {
        let at = |t: f64| -> Result<[PlacedShape; 2], InputError> {
            Ok([shapes[0].at(motions[0].at(t))?, shapes[1].at(motions[1].at(t))?])
        };
        let query = || Query::new().with_budget(self.budget);
        let start = at(0.0)?;
        let mut clearance = self.clearance;
        if query().within(&start[0], &start[1], clearance) {
            if !self.may_touch(&start) {
                return Ok(Impact::between(0.0, 0.0));
            }
            clearance = clearance.min(query().distance(&start[0], &start[1]).lower);
        }
        if motions[0].is_in_step_with(motions[1]) {
            return Ok(Impact::NEVER);
        }
        if (0..2).any(|side| start[side].is_unbounded() && motions[side].turns()) {
            return Ok(Impact::between(0.0, f64::INFINITY));
        }
        let mut bodies = [Body::new(shapes[0], motions[0])?, Body::new(shapes[1], motions[1])?];
        let resolution = TOUCHING * (bodies[0].reach + bodies[1].reach);
        let error = bodies[0].error + bodies[1].error;
        // A direction along which two pieces are apart by more than they may overlap along another
        // one cannot be its opposite. So flat pieces do not pass through each other.
        let overlap = 2.0 * error + resolution;
        let gap = clearance + if self.ignores_touch { overlap } else { error };
        let mut search = Search::new(&mut bodies, gap, resolution, self.max_pairs)
            .with_touch_gap(self.ignores_touch.then_some(clearance - overlap))
            .with_budget(self.budget);
        let found = search.run();
        let is_stopped = search.is_stopped();
        let touches = |[a, b]: &[PlacedShape; 2]| {
            if !self.ignores_touch {
                query().within(a, b, clearance)
            } else if clearance > 0.0 {
                query().within(a, b, clearance * (1.0 - TOUCHING))
            } else {
                !is_surface(a) && !is_surface(b) && query().penetrates(a, b) == Penetrates::Yes
            }
        };
        let contact_after = |t: f64| {
            let touches = |t: f64| at(t).is_ok_and(|shapes| touches(&shapes));
            if is_stopped { f64::INFINITY } else { contact_after(t, touches) }
        };
        Ok(match found {
            Found::Never => Impact::NEVER,
            Found::Stopped { t } => Impact::between(t, contact_after(t)),
            Found::Contact { t, pair } => {
                let touch = touch(&bodies, t, pair, &at(t)?, clearance + 4.0 * (error + resolution));
                Impact { touch, ..Impact::between(t, contact_after(t)) }
            }
        })
    }

    /// Reports whether things that touch at the start are swept all the same.
    fn may_touch(self, [a, b]: &[PlacedShape; 2]) -> bool {
        let is_solid = |shape: &PlacedShape| {
            shape.parts().iter().any(|part| matches!(part.form(), Form::Surface(surface) if surface.is_solid))
        };
        let penetrates = || Query::new().with_budget(self.budget).penetrates(a, b);
        self.ignores_touch && (!is_solid(a) && !is_solid(b) || penetrates() == Penetrates::No)
    }
}

/// Reports whether a shape has a mesh as its surface, or a height field: they have no interior.
fn is_surface(shape: &PlacedShape) -> bool {
    shape.parts().iter().any(|part| match part.form() {
        Form::Surface(surface) => !surface.is_solid,
        Form::Field(_) => true,
        Form::Convex(_) | Form::HalfSpace(_) => false,
    })
}

/// Returns the place at which two pieces touch at a time, up to `margin`.
fn touch(bodies: &[Body<'_>; 2], t: f64, pair: Pair, shapes: &[PlacedShape; 2], margin: f64) -> Option<Touch> {
    let pieces: [&Piece; 2] = [0, 1].map(|side| &bodies[side].pieces[pair.pieces[side] as usize]);
    let poses = [0, 1].map(|side| bodies[side].motion.at(t));
    let form = |side: usize| shapes[side].parts()[pieces[side].part as usize].form();
    let points = match [form(0), form(1)] {
        [Form::HalfSpace(plane), Form::HalfSpace(other)] => plane.separation_of_half_spaces(&other).points,
        [Form::HalfSpace(plane), _] => bodies[1].at(pieces[1], &poses[1], |b| plane.separation(b).points)?,
        [_, Form::HalfSpace(plane)] => bodies[0].at(pieces[0], &poses[0], |a| plane.separation(a).points)?,
        _ => bodies[0]
            .at(pieces[0], &poses[0], |a| bodies[1].at(pieces[1], &poses[1], |b| separation(a, b).points))??,
    };
    let mut normal = pair.direction;
    if pieces.iter().all(|piece| piece.content == Content::Whole) {
        // Two convex sets that nearly touch have an exact normal only as a contact.
        let parts = [0, 1].map(|side| &shapes[side].parts()[pieces[side].part as usize]);
        let contacts = ContactOptions { margin, ..ContactOptions::default() };
        normal = Query::new().with_contacts(contacts).contacts(parts[0], parts[1]).first()?.normal;
    }
    Some(Touch {
        point: [0, 1, 2].map(|k| 0.5 * points[0][k] + 0.5 * points[1][k]),
        normal: normal.map(|x| x + 0.0),
        parts: pieces.map(|piece| piece.part),
        faces: pieces.map(|piece| if let Content::Face(face) = piece.content { Some(face) } else { None }),
    })
}

/// Returns a time at or after `t` at which the bodies touch, or infinity. It tries growing steps.
fn contact_after(t: f64, touch: impl Fn(f64) -> bool) -> f64 {
    let steps = (0..13).map(|k| 16.0 * TOUCHING * (1_u64 << (2 * k)) as f64);
    std::iter::once(0.0).chain(steps).map(|step| (t + step).min(1.0)).find(|&t| touch(t)).unwrap_or(f64::INFINITY)
}
