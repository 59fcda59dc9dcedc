//! Half-spaces in the world, and their position relative to convex shapes and other half-spaces.
//!
//! The image of {v : n·v ≤ c} under x = R v + t is {x : m·(x - t) ≤ |det R| c}. Here m is the
//! cofactor matrix of R, times the sign of det R, applied to n. All of that is exact, and so are
//! the heights of vertices. Only lengths are roots; they are squared if something is decided.
//!
//! The proof is docs/notes/proof.md, L21 and L28. The tests are in `tests/it/shapes/pairs.rs` and
//! `tests/it/shapes/surfaces.rs`.

use super::depth::Depth;
use super::facing::{Corner, facing};
use super::interval::{Separation, above, below};
use super::manifold::{Contact, Contacts, Faceted};
use super::overlap::Feature;
use super::posed::{Pair, Swept, to_unit_length};
use crate::exact::world_point;
use crate::math::direction::rounded_direction;
use crate::math::dyadic::{self, Dyadic};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{dot, length, sub};
use crate::math::{Pose, Sign};
use crate::volume::Proximity;

/// A half-space in the world: the points on one side of a plane.
#[derive(Clone, Debug)]
pub(crate) struct HalfSpace<'a> {
    /// The normal n and the level c in the frame of the half-space.
    local: ([f64; 3], f64),
    /// The normal m divided by its greatest entry, and the level divided by the same entry. Each
    /// number is rounded once.
    direction: [f64; 3],
    rounded_level: f64,
    pose: &'a Pose,
}

/// The plane of a half-space in exact numbers.
struct ExactPlane {
    /// The exact normal m, which points out of the half-space.
    normal: [Dyadic; 3],
    /// The exact level |det R| c. Points of the half-space have m·(x - t) of at most this level.
    level: Dyadic,
}

/// Signed distance of a shape above the half-space's plane: the least of m·(x - t) over |m|, minus
/// the level and the radius. It is negative if the shape reaches into the half-space. It is an
/// interval in world units, with the deepest point of the shape.
struct Start {
    lower: f64,
    upper: f64,
    point: [f64; 3],
}

/// Heights of points of a common frame above the plane of a half-space, along its normal.
pub(super) struct Heights<'p> {
    pair: &'p Pair<'p>,
    direction: [f64; 3],
    /// The direction with length 1.
    normal: [f64; 3],
    /// Length of the direction.
    across: f64,
    /// Level of the plane along the direction, in the common unit.
    level: f64,
    /// Bound on the error of a height, in the common unit.
    error: f64,
}

impl Heights<'_> {
    /// Returns an interval that holds the height of a point of the common frame, in world units.
    #[inline]
    pub(super) fn of(&self, point: &[f64; 3]) -> [f64; 2] {
        let height = (dot(&self.direction, point) - self.level) / self.across;
        [below(height - self.error) * self.pair.unit, above(height + self.error) * self.pair.unit]
    }

    /// Returns the contact of a corner of a shape with this radius.
    pub(super) fn contact(&self, radius: [f64; 2], corner: &Corner) -> Contact {
        let [low, high] = self.of(&corner.point);
        let [lower, upper] = [below(radius[0] - high), above(radius[1] - low)];
        let core = self.pair.world(corner.point);
        let point: [f64; 3] = std::array::from_fn(|k| core[k] - self.normal[k] * radius[0]);
        let on_plane = std::array::from_fn(|k| point[k] + self.normal[k] * (0.5 * (lower + upper)));
        let features = [Feature::Face(0), Feature::Vertex(corner.number)];
        Contact { points: [on_plane, point], lower, upper, features }
    }
}

impl<'a> HalfSpace<'a> {
    /// Builds the image of {v : normal·v ≤ level} under `pose`. The normal must not be zero.
    pub(crate) fn new(normal: [f64; 3], level: f64, pose: &'a Pose) -> Self {
        let unscaled = Self { local: (normal, level), direction: [0.0; 3], rounded_level: 0.0, pose };
        let (direction, rounded_level) = unscaled.turned().unwrap_or_else(|| {
            let ExactPlane { normal, level } = unscaled.exact();
            let direction = rounded_direction(&normal).unwrap_or([0.0; 3]);
            let greatest = (0..3).find(|&k| direction[k].abs() == 1.0).unwrap_or(0);
            let scale = Dyadic::nearest_quotient(&level, &normal[greatest]);
            (direction, scale * direction[greatest])
        });
        Self { direction, rounded_level, ..unscaled }
    }

    /// Returns the half-space of [`new`](Self::new), given its direction and rounded level, which
    /// [`rounded`](Self::rounded) returned.
    pub(crate) fn known(local: ([f64; 3], f64), pose: &'a Pose, (direction, rounded_level): ([f64; 3], f64)) -> Self {
        Self { local, direction, rounded_level, pose }
    }

    /// Returns the plane in exact numbers.
    fn exact(&self) -> ExactPlane {
        let [x, y, z] = self.pose.linear().map(|row| row.map(Dyadic::from_f64));
        // The rows of the cofactor matrix are cross products of the rows of R.
        let rows = [dyadic::cross(&y, &z), dyadic::cross(&z, &x), dyadic::cross(&x, &y)];
        let determinant = dyadic::dot(&rows[0], &x);
        let flip = if determinant.sign() == Sign::Negative { Dyadic::from_f64(-1.0) } else { Dyadic::from_f64(1.0) };
        let local = self.local.0.map(Dyadic::from_f64);
        let normal = rows.each_ref().map(|row| &flip * &dyadic::dot(row, &local));
        let level = &(&flip * &determinant) * &Dyadic::from_f64(self.local.1);
        ExactPlane { normal, level }
    }

    /// Returns the direction and the rounded level if the pose only permutes and mirrors the axes.
    /// Then the exact normal has the numbers of the local one, and the determinant is ±1.
    fn turned(&self) -> Option<([f64; 3], f64)> {
        const MIN_EXACT_QUOTIENT: f64 = f64::from_bits((1023 - 500) << 52);
        let linear = self.pose.linear();
        if !linear.as_flattened().iter().all(|x| *x == 0.0 || x.abs() == 1.0) {
            return None;
        }
        let (normal, level) = self.local;
        let image = linear.map(|row| dot(&row, &normal));
        let greatest = image.into_iter().fold(0.0_f64, |greatest, x| greatest.max(x.abs()));
        let is_exact = |x: f64| x == 0.0 || x.abs() > MIN_EXACT_QUOTIENT;
        let is_permutation = linear.iter().all(|row| row.iter().filter(|x| **x != 0.0).count() == 1);
        (is_permutation && image.into_iter().all(is_exact) && is_exact(level))
            .then(|| (image.map(|x| x / greatest + 0.0), level / greatest + 0.0))
    }

    /// Returns the normal in units of its greatest entry, the point that heights are measured from,
    /// and the height of the plane along that normal. Every number is the exact one, rounded once.
    pub(crate) fn rounded(&self) -> ([f64; 3], [f64; 3], f64) {
        (self.direction, *self.pose.translation(), self.rounded_level)
    }

    fn start(&self, shape: &Swept<'_>) -> Start {
        let pair = self.pair(shape);
        let deepest = pair.b.support(self.direction.map(|x| -x));
        let [mut lower, mut upper] = self.heights(&pair).of(&deepest.point);
        if upper - lower > 1e-11 * upper.abs()
            && let Some((least, squared)) = self.least_height(shape)
        {
            let sign = least.sign();
            let [near, far] = root_bounds(&[least, squared]);
            [lower, upper] = match sign {
                Sign::Positive => [near, far],
                Sign::Zero => [0.0; 2],
                Sign::Negative => [-far, -near],
            };
        }
        let unit = to_unit_length(self.direction);
        let point = pair.world(deepest.point);
        Start {
            lower: below(lower - shape.radius[1]),
            upper: above(upper - shape.radius[0]),
            point: std::array::from_fn(|k| point[k] - unit[k] * shape.radius[0]),
        }
    }

    /// Returns what the heights of points of a common frame follow from.
    pub(super) fn heights<'p>(&self, pair: &'p Pair<'p>) -> Heights<'p> {
        let across = length(&self.direction);
        let level = self.rounded_level / pair.unit;
        let level_error = 4.0 * UNIT_ROUNDOFF * level.abs() + f64::MIN_POSITIVE;
        let error = (pair.height_error(self.direction) + level_error) / across;
        Heights { pair, direction: self.direction, normal: to_unit_length(self.direction), across, level, error }
    }

    /// Returns the contacts of a shape with this half-space: the corners of the part that faces the
    /// plane, if they are in the half-space or at most `margin` above it. The lowest corner is
    /// always included. The first point of each contact is on the plane.
    pub(crate) fn contacts(&self, shape: &Faceted<'_>, margin: f64) -> Contacts {
        let pair = self.pair(&shape.swept);
        let (heights, normal) = (self.heights(&pair), self.unit_normal());
        let facing = facing(&pair.b, shape.facets, normal.map(|x| -x));
        let contact = |corner: &Corner| heights.contact(shape.swept.radius, corner);
        let mut contacts: Vec<Contact> = facing.corners.iter().map(contact).collect();
        let deepest = contacts.iter().map(|contact| contact.upper).fold(f64::NEG_INFINITY, f64::max);
        contacts.retain(|contact| contact.upper >= -margin || contact.upper == deepest);
        Contacts { normal, contacts }
    }

    /// Returns the common frame in which heights above the plane are computed.
    pub(super) fn pair<'p>(&'p self, shape: &Swept<'p>) -> Pair<'p> {
        let origin = Swept { core: super::posed::Core::Points(&[[0.0; 3]]), pose: self.pose, radius: [0.0; 2] };
        Pair::new(&origin, shape)
    }

    /// Returns the normal that points out of the half-space, in the world frame. Its length is 1 up
    /// to rounding.
    pub(crate) fn unit_normal(&self) -> [f64; 3] {
        to_unit_length(self.direction)
    }

    pub(super) fn direction(&self) -> [f64; 3] {
        self.direction
    }

    /// Returns the contact of two half-spaces. There is one, because planes have no corners. The
    /// depth is infinite if the half-spaces do not face each other, and negative if they face each
    /// other across a gap.
    pub(crate) fn contact_of_half_spaces(&self, other: &HalfSpace<'_>) -> Contacts {
        let features = [Feature::Face(0); 2];
        let Separation { lower, upper, points, proximity } = self.separation_of_half_spaces(other);
        if proximity == Proximity::Apart {
            let contact = Contact { points, lower: -upper, upper: -lower, features };
            return Contacts { normal: to_unit_length(self.direction), contacts: vec![contact] };
        }
        let Depth { lower, upper, normal, points } = self.depth_of_half_spaces(other);
        Contacts { normal, contacts: vec![Contact { points, lower, upper, features }] }
    }

    /// Returns the exact least height m·(x - t) of a polytope's corner over the plane, less the
    /// level, and the squared length of m. Returns `None` for any other core.
    fn least_height(&self, shape: &Swept<'_>) -> Option<(Dyadic, Dyadic)> {
        let corners = shape.core.corners()?;
        let plane = self.exact();
        let origin = self.pose.translation().map(Dyadic::from_f64);
        let height = |corner: &[f64; 3]| {
            let point = world_point(shape.pose, corner);
            &dyadic::dot(&plane.normal, &[0, 1, 2].map(|k| &point[k] - &origin[k])) - &plane.level
        };
        let lower = |least: Dyadic, height: Dyadic| {
            if (&height - &least).sign() == Sign::Negative { height } else { least }
        };
        Some((corners.iter().map(height).reduce(lower)?, dyadic::dot(&plane.normal, &plane.normal)))
    }

    /// Reports whether a shape is within `clearance` of this half-space, in world units. The
    /// clearance must be finite and not negative. `Intersects` means that it is.
    pub(crate) fn nearness(&self, shape: &Swept<'_>, clearance: f64) -> Proximity {
        let start = self.start(shape);
        if start.lower > clearance {
            return Proximity::Apart;
        }
        if start.upper <= clearance {
            return Proximity::Intersects;
        }
        let Some((least, squared)) = self.least_height(shape) else { return Proximity::Undecided };
        let is_within = |end: usize| {
            let reach = &Dyadic::from_f64(shape.radius[end]) + &Dyadic::from_f64(clearance);
            let limit = &(&reach * &reach) * &squared;
            least.sign() != Sign::Positive || (&(&least * &least) - &limit).sign() != Sign::Positive
        };
        match (is_within(0), is_within(1)) {
            (true, _) => Proximity::Intersects,
            (false, true) => Proximity::Undecided,
            (false, false) => Proximity::Apart,
        }
    }

    /// Returns the distance of a shape from this half-space, in world units.
    pub(crate) fn separation(&self, shape: &Swept<'_>) -> Separation {
        let (start, proximity) = (self.start(shape), self.nearness(shape, 0.0));
        let [lower, upper] = match proximity {
            Proximity::Apart => [start.lower.max(0.0), start.upper],
            Proximity::Undecided => [0.0, start.upper.max(0.0)],
            Proximity::Intersects => [0.0; 2],
        };
        let points = [self.moved(start.point, -start.lower.max(0.0)), start.point];
        Separation { lower, upper, points, proximity }
    }

    /// Returns the depth of a shape in this half-space, in world units. The normal is the
    /// half-space's.
    pub(crate) fn depth(&self, shape: &Swept<'_>) -> Depth {
        let start = self.start(shape);
        let lower = (-start.upper).max(0.0);
        let points = [self.moved(start.point, (-start.lower).max(0.0)), start.point];
        Depth { lower, upper: (-start.lower).max(lower), normal: to_unit_length(self.direction), points }
    }

    /// Returns the distance between two half-spaces that face each other. It is zero or the
    /// negative depth if they overlap. It is returned as a quotient: the gap, and the square of its
    /// divisor. Returns `None` if they do not face each other; they then intersect wherever they
    /// are moved.
    fn facing_gap(&self, other: &HalfSpace<'_>) -> Option<[Dyadic; 2]> {
        let (plane, across) = (self.exact(), other.exact());
        let crossed = dyadic::cross(&plane.normal, &across.normal);
        if crossed.iter().any(|x| x.sign() != Sign::Zero)
            || dyadic::dot(&plane.normal, &across.normal).sign() == Sign::Positive
        {
            return None;
        }
        // The other's plane, along this normal: m_B = -λ m_A, and m_B·(x - t_B) = l_B there.
        // Multiplied by |m_A| |m_B|: with s = m_A·m_B < 0, m_A·(x - t_A) = (s / m_B²) l_B +
        // m_A·(t_B - t_A).
        let along = dyadic::dot(&plane.normal, &across.normal);
        let squared_b = dyadic::dot(&across.normal, &across.normal);
        let offset = [0, 1, 2]
            .map(|k| &Dyadic::from_f64(other.pose.translation()[k]) - &Dyadic::from_f64(self.pose.translation()[k]));
        let there = &(&along * &across.level) + &(&squared_b * &dyadic::dot(&plane.normal, &offset));
        let gap = &there - &(&squared_b * &plane.level);
        let squared_a = dyadic::dot(&plane.normal, &plane.normal);
        Some([gap, &(&squared_b * &squared_b) * &squared_a])
    }

    /// Reports whether another half-space is within `clearance` of this one, in world units. The
    /// answer is exact.
    pub(crate) fn nearness_of_half_spaces(&self, other: &HalfSpace<'_>, clearance: f64) -> Proximity {
        let Some([gap, squared]) = self.facing_gap(other) else { return Proximity::Intersects };
        let limit = &Dyadic::product(clearance, clearance) * &squared;
        let is_within = gap.sign() != Sign::Positive || (&(&gap * &gap) - &limit).sign() != Sign::Positive;
        if is_within { Proximity::Intersects } else { Proximity::Apart }
    }

    /// Returns the distance of another half-space, in world units.
    pub(crate) fn separation_of_half_spaces(&self, other: &HalfSpace<'_>) -> Separation {
        let proximity = self.nearness_of_half_spaces(other, 0.0);
        let [lower, upper] = match (proximity, self.facing_gap(other)) {
            (Proximity::Apart, Some(facing)) => root_bounds(&facing),
            _ => [0.0; 2],
        };
        let point = if proximity == Proximity::Intersects { self.common_point(other) } else { self.on_plane() };
        Separation { lower, upper, points: [point, self.moved(point, upper)], proximity }
    }

    /// Returns the depth of another half-space, in world units. It is infinite if the half-spaces
    /// do not face each other.
    pub(crate) fn depth_of_half_spaces(&self, other: &HalfSpace<'_>) -> Depth {
        let [lower, upper] = match self.facing_gap(other) {
            Some(facing) if facing[0].sign() == Sign::Negative => root_bounds(&facing),
            Some(_) => [0.0; 2],
            None => [f64::INFINITY; 2],
        };
        let point = self.common_point(other);
        let inside = if upper.is_finite() { upper } else { 0.0 };
        Depth { lower, upper, normal: to_unit_length(self.direction), points: [point, self.moved(point, -inside)] }
    }

    /// Returns a point of both half-spaces, if they intersect. It starts on this plane and moves
    /// against both normals until it reaches the other's plane. If the half-spaces face each other
    /// up to rounding, the point of this plane is in the other already.
    fn common_point(&self, other: &HalfSpace<'_>) -> [f64; 3] {
        let point = self.on_plane();
        let (n, m) = (to_unit_length(self.direction), to_unit_length(other.direction));
        let outside = dot(&m, &sub(&point, &other.on_plane()));
        let along: [f64; 3] = std::array::from_fn(|k| n[k] + m[k]);
        let by = outside / dot(&along, &m);
        if outside > 0.0 && by.is_finite() { std::array::from_fn(|k| point[k] - along[k] * by) } else { point }
    }

    /// Returns a point of the plane in the world, rounded.
    fn on_plane(&self) -> [f64; 3] {
        let across = dot(&self.direction, &self.direction);
        std::array::from_fn(|k| self.pose.translation()[k] + self.direction[k] * (self.rounded_level / across))
    }

    fn moved(&self, point: [f64; 3], by: f64) -> [f64; 3] {
        let unit = to_unit_length(self.direction);
        std::array::from_fn(|k| point[k] + unit[k] * by)
    }
}

/// Returns a lower and an upper bound on the magnitude of a number divided by the root of another.
/// A result below 2^-500 gets the lower bound zero.
fn root_bounds([number, squared]: &[Dyadic; 2]) -> [f64; 2] {
    const MIN_ROOT: f64 = f64::from_bits((1023 - 500) << 52);
    let root = Dyadic::nearest_quotient(&(number * number), squared).sqrt();
    if root < MIN_ROOT { [0.0, MIN_ROOT] } else { [below(root), above(root)] }
}
