//! The lozenge: a rectangle swept by a sphere (*Notes*, 2.3; Larsen, Gottschalk, Lin and Manocha, *Fast proximity queries
//! with swept sphere volumes*, 1999; Ericson 4.5).

use std::f64::consts::PI;

use super::core::{Core, add, cross, dot, normalised, scale, subtract};
use super::fit;
use super::min_max::{in_range, lengths_in_range};
use super::rigid::{direction, image, stretch};
use super::rounding::{add_up, mul_up};
use super::{BoundingSphere, BoundingVolume, Round, round};
use crate::input::InputError;
use crate::math::Pose;

/// The points within `radius` of `corner + s·u + t·v` for s and t in [0, 1].
///
/// The edges u and v are meant to be at right angles and stay so up to rounding; whatever their angle, the set is the one
/// that the numbers say. An edge of length zero makes a capsule, two a sphere.
///
/// ```
/// use impinge::volume::{Lozenge, BoundingSphere, Round};
/// let plate = Lozenge::new([0.0; 3], [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], 0.5)?;
/// let ball = BoundingSphere::new([2.0, 2.0, 3.0], 0.5)?;
/// let bounds = plate.distance(&ball);
/// assert!(bounds.lower <= 2.0 && 2.0 <= bounds.upper && bounds.upper - bounds.lower < 1e-12);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lozenge {
    corner: [f64; 3],
    edges: [[f64; 3]; 2],
    radius: f64,
}

const _: () = assert!(size_of::<Lozenge>() == 80);

impl Lozenge {
    /// The lozenge of a corner, the two edges from there, and a radius.
    ///
    /// # Errors
    /// [`NonFinite`](crate::input::InputErrorKind::NonFinite), [`OutOfRange`](crate::input::InputErrorKind::OutOfRange)
    /// (beyond 2^320), [`Negative`](crate::input::InputErrorKind::Negative) for the radius.
    pub fn new(corner: [f64; 3], edges: [[f64; 3]; 2], radius: f64) -> Result<Self, InputError> {
        in_range("lozenge corner or edge", corner.into_iter().chain(edges.into_iter().flatten()))?;
        lengths_in_range("radius", [radius])?;
        Ok(Self { corner, edges, radius })
    }

    /// From numbers that are known to be in range.
    pub(super) fn from_valid(corner: [f64; 3], edges: [[f64; 3]; 2], radius: f64) -> Self {
        Self { corner, edges, radius }
    }

    /// The corner of the rectangle from which the edges go.
    #[must_use]
    pub fn corner(&self) -> [f64; 3] {
        self.corner
    }

    /// The two edges of the rectangle.
    #[must_use]
    pub fn edges(&self) -> [[f64; 3]; 2] {
        self.edges
    }

    /// The radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The rectangle.
    pub(super) fn core(&self) -> Core {
        Core { corner: self.corner, edges: self.edges, dimension: 2 }
    }

    /// The lozenge about a rectangle that holds spheres, given as centres and radii.
    pub(super) fn about(corner: [f64; 3], edges: [[f64; 3]; 2], spheres: &[([f64; 3], f64)]) -> Self {
        let core = Core { corner, edges, dimension: 2 };
        let reach = |&(centre, radius): &([f64; 3], f64)| add_up(round::distance_to_core(centre, &core), radius);
        Self { corner, edges, radius: spheres.iter().map(reach).fold(0.0, f64::max) }
    }

    /// Unit vectors along the edges, and across; any that will do where an edge has no direction.
    fn frame(&self) -> [[f64; 3]; 3] {
        let [u, v] = self.edges;
        let first = normalised(u).or_else(|| normalised(v)).unwrap_or([1.0, 0.0, 0.0]);
        let least = (0..3).min_by(|&i, &j| first[i].abs().total_cmp(&first[j].abs())).unwrap_or(0);
        let aside: [f64; 3] = std::array::from_fn(|axis| if axis == least { 1.0 } else { 0.0 });
        let normal = normalised(cross(u, v)).or_else(|| normalised(cross(first, aside))).unwrap_or([0.0, 0.0, 1.0]);
        [first, cross(normal, first), normal]
    }
}

impl BoundingVolume for Lozenge {
    /// By [`fit::lozenge`].
    fn of_points(points: &[[f64; 3]]) -> Result<Self, InputError> {
        fit::lozenge(points)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.meets(other)
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        self.meets(&BoundingSphere::from_valid(point, 0.0))
    }

    /// The smaller one of those in the directions of either.
    fn merged(&self, other: &Self) -> Self {
        let spheres: Vec<([f64; 3], f64)> = [self, other]
            .into_iter()
            .flat_map(|part| part.core().corners().map(|corner| (corner, part.widened())))
            .collect();
        let candidates = [self, other].map(|part| {
            let frame = part.frame();
            let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            for (centre, _) in &spheres {
                let offset = subtract(*centre, part.corner);
                for (range, &axis) in ranges.iter_mut().zip(&frame) {
                    let t = dot(axis, offset);
                    *range = [range[0].min(t), range[1].max(t)];
                }
            }
            let middle = 0.5 * (ranges[2][0] + ranges[2][1]);
            let offsets = [scale(frame[0], ranges[0][0]), scale(frame[1], ranges[1][0]), scale(frame[2], middle)];
            let corner = offsets.into_iter().fold(part.corner, add);
            let edges = [0, 1].map(|k| scale(frame[k], ranges[k][1] - ranges[k][0]));
            Self::about(corner, edges, &spheres)
        });
        let key = |lozenge: &Self| (lozenge.volume(), lozenge.corner);
        let [first, second] = candidates;
        if key(&first) <= key(&second) { first } else { second }
    }

    /// A rigid motion within 1e-4.
    fn moved(&self, world_from_local: &Pose) -> Result<Self, InputError> {
        let stretch = stretch(world_from_local)?;
        let (corner, off_corner) = image(world_from_local, self.corner);
        let [(u, off_u), (v, off_v)] = self.edges.map(|edge| direction(world_from_local, edge));
        let off = add_up(off_corner, add_up(off_u, off_v));
        Self::new(corner, [u, v], add_up(mul_up(self.radius, stretch), off))
    }

    fn volume(&self) -> f64 {
        let (r, [a, b], area) = (self.radius, self.lengths(), self.area());
        2.0 * r * area + PI * r * r * (a + b) + 4.0 / 3.0 * PI * r * r * r
    }

    fn surface_area(&self) -> f64 {
        let (r, [a, b], area) = (self.radius, self.lengths(), self.area());
        2.0 * area + 2.0 * PI * r * (a + b) + 4.0 * PI * r * r
    }
}

impl Lozenge {
    fn lengths(&self) -> [f64; 2] {
        self.edges.map(|edge| dot(edge, edge).sqrt())
    }

    fn area(&self) -> f64 {
        let normal = cross(self.edges[0], self.edges[1]);
        dot(normal, normal).sqrt()
    }

    /// The radius, and what its corners as computed may be off by.
    fn widened(&self) -> f64 {
        add_up(self.radius, round::off(&self.core()))
    }
}
