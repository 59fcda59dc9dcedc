//! The lozenge: a rectangle swept by a sphere (*Notes*, 2.3; Larsen, Gottschalk, Lin and Manocha,
//! *Fast proximity queries with swept sphere volumes*, 1999; Ericson 4.5).

use super::core::Core;
use super::min_max::{in_range, lengths_in_range};
use super::round::sealed::Swept;
use super::round::{self, Round};
use super::rounding::add_up;
use crate::input::InputError;
use crate::math::vec3::{cross, dot, normalized};

/// All points within `radius` of `corner + s·u + t·v` for s and t in [0, 1].
///
/// The edges u and v should be perpendicular, and are so up to rounding. For any other angle the
/// set is still exactly the one defined above. One edge of length zero makes a capsule, two make a
/// sphere.
///
/// ```
/// use impinge::volume::{Lozenge, BoundingSphere, Round};
/// let plate = Lozenge::new([0.0; 3], [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], 0.5)?;
/// let sphere = BoundingSphere::new([2.0, 2.0, 3.0], 0.5)?;
/// let bounds = plate.distance(&sphere);
/// assert!(bounds.lower <= 2.0 && 2.0 <= bounds.upper && bounds.upper - bounds.lower < 1e-12);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lozenge {
    pub(super) corner: [f64; 3],
    pub(super) edges: [[f64; 3]; 2],
    pub(super) radius: f64,
}

const _: () = assert!(size_of::<Lozenge>() == 80);

impl Lozenge {
    /// Builds the lozenge from a corner, the two edge vectors from there, and a radius.
    ///
    /// # Errors
    /// Returns [`NonFinite`](crate::input::InputErrorKind::NonFinite) or
    /// [`OutOfRange`](crate::input::InputErrorKind::OutOfRange) (beyond 2^320) for an invalid
    /// number, and [`Negative`](crate::input::InputErrorKind::Negative) for a negative radius.
    pub fn new(corner: [f64; 3], edges: [[f64; 3]; 2], radius: f64) -> Result<Self, InputError> {
        in_range("lozenge corner or edge", corner.into_iter().chain(edges.into_iter().flatten()))?;
        lengths_in_range("radius", [radius])?;
        Ok(Self { corner, edges, radius })
    }

    /// Builds the lozenge from numbers that are known to be valid.
    pub(super) fn from_valid(corner: [f64; 3], edges: [[f64; 3]; 2], radius: f64) -> Self {
        Self { corner, edges, radius }
    }

    /// Returns the corner of the rectangle from which the edges start.
    #[must_use]
    pub fn corner(&self) -> [f64; 3] {
        self.corner
    }

    /// Returns the two edge vectors of the rectangle.
    #[must_use]
    pub fn edges(&self) -> [[f64; 3]; 2] {
        self.edges
    }

    /// Returns the radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the rectangle.
    pub(super) fn core(&self) -> Core {
        Core { corner: self.corner, edges: self.edges, dimension: 2 }
    }

    /// Returns the lozenge around a rectangle that encloses the given spheres (centers and radii).
    pub(super) fn about(corner: [f64; 3], edges: [[f64; 3]; 2], spheres: &[([f64; 3], f64)]) -> Self {
        let core = Core { corner, edges, dimension: 2 };
        let reach = |&(center, radius): &([f64; 3], f64)| add_up(round::distance_to_core(center, &core), radius);
        Self { corner, edges, radius: spheres.iter().map(reach).fold(0.0, f64::max) }
    }

    /// Returns three unit vectors: two in the plane of the rectangle, the first along an edge, and
    /// the normal. If an edge has length zero, any perpendicular directions are used.
    pub(super) fn frame(&self) -> [[f64; 3]; 3] {
        let [u, v] = self.edges;
        let first = normalized(&u).or_else(|| normalized(&v)).unwrap_or([1.0, 0.0, 0.0]);
        let least = (0..3).min_by(|&i, &j| first[i].abs().total_cmp(&first[j].abs())).unwrap_or(0);
        let aside: [f64; 3] = std::array::from_fn(|axis| if axis == least { 1.0 } else { 0.0 });
        let normal =
            normalized(&cross(&u, &v)).or_else(|| normalized(&cross(&first, &aside))).unwrap_or([0.0, 0.0, 1.0]);
        [first, cross(&normal, &first), normal]
    }
}

impl Lozenge {
    pub(super) fn lengths(&self) -> [f64; 2] {
        self.edges.map(|edge| dot(&edge, &edge).sqrt())
    }

    pub(super) fn area(&self) -> f64 {
        let normal = cross(&self.edges[0], &self.edges[1]);
        dot(&normal, &normal).sqrt()
    }

    /// Returns the radius plus the error bound of the computed corners.
    pub(super) fn widened(&self) -> f64 {
        add_up(self.radius, round::point_error(&self.core()))
    }
}

#[allow(private_interfaces, reason = "its members are for this module alone")]
impl Swept for Lozenge {
    fn core(&self) -> Core {
        Self::core(self)
    }

    fn reach(&self) -> f64 {
        self.radius
    }
}

impl Round for Lozenge {}
