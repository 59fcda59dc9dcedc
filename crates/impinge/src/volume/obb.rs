//! The oriented box (*Notes*, 2.3, where principal components lead to it; Ericson 4.4).
//!
//! Tests: `tests/it/volumes/fitted.rs`, `tests/it/volumes/exact.rs`. Benchmark: `volumes`.

use super::min_max::{in_range, lengths_in_range};
use super::rounding::{add_down, add_up, mul_down, mul_up};
use crate::input::{InputError, InputErrorKind};
use crate::math::vec3::{add, dot, normalized, scale, sub};

/// Maximum deviation of the axes from orthonormal ones: 2^-40. Rounding orthonormal axes to doubles
/// stays far below it. A much larger value would make boxes loose. Axes from single precision must
/// be orthonormalized first.
const MAX_DEVIATION: f64 = 1.0 / (1_u64 << 40) as f64;

/// The points `center + Σ tᵢ axisᵢ` with |tᵢ| ≤ half-extentᵢ.
///
/// The axes are doubles, so they are orthonormal only up to rounding. The set is the parallelepiped
/// that the numbers define; constructions enlarge the half-extents by that deviation.
///
/// ```
/// use impinge::volume::{BoundingVolume, Obb};
/// let axes = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
/// let turned = Obb::new([0.0; 3], axes, [5.0, 1.0, 1.0])?;
/// assert!(turned.contains([3.0, 4.0, 0.0]) && !turned.contains([4.0, 3.0, 0.0]));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obb {
    pub(super) center: [f64; 3],
    pub(super) axes: [[f64; 3]; 3],
    pub(super) half_extents: [f64; 3],
}

const _: () = assert!(size_of::<Obb>() == 120);

impl Obb {
    /// Builds the box from its center, its axes (unit vectors, one per row) and its half-extents
    /// along them.
    ///
    /// # Errors
    /// Returns [`NonFinite`](InputErrorKind::NonFinite) or
    /// [`OutOfRange`](InputErrorKind::OutOfRange) (beyond 2^320) for an invalid number,
    /// [`Negative`](InputErrorKind::Negative) for a negative half-extent, and
    /// [`NotRigid`](InputErrorKind::NotRigid) if the axes deviate from orthonormal ones by more
    /// than 2^-40.
    pub fn new(center: [f64; 3], axes: [[f64; 3]; 3], half_extents: [f64; 3]) -> Result<Self, InputError> {
        in_range("box center or axis", center.into_iter().chain(axes.into_iter().flatten()))?;
        lengths_in_range("half-extent", half_extents)?;
        let deviation = deviation(&axes);
        if deviation > MAX_DEVIATION {
            return Err(InputError::new(InputErrorKind::NotRigid { deviation })
                .with_hint("the axes of a box must be orthonormal: normalize them and make them perpendicular"));
        }
        Ok(Self { center, axes, half_extents })
    }

    /// Returns the center.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        self.center
    }

    /// Returns the axes, one per row: unit vectors up to rounding.
    #[must_use]
    pub fn axes(&self) -> [[f64; 3]; 3] {
        self.axes
    }

    /// Returns half the lengths of the box along its axes.
    #[must_use]
    pub fn half_extents(&self) -> [f64; 3] {
        self.half_extents
    }

    /// Returns a box with the given center and axes that encloses every point x whose projections
    /// are within `reach`: `|axis · (x - center)| ≤ reach` on each axis. The axes must be
    /// orthonormal up to rounding; the half-extents are rounded up.
    ///
    /// With y the projections and s the coordinates of a point, y = G s for the Gram matrix G of
    /// the axes. So |s - y| ≤ κ |s| ≤ κ / (1 - κ) |y| in the maximum norm, with κ the norm of G -
    /// I.
    pub(super) fn of_reach(center: [f64; 3], axes: [[f64; 3]; 3], reach: [f64; 3]) -> Self {
        let deviation = deviation(&axes);
        let largest = reach.into_iter().fold(0.0, f64::max);
        // κ is below 2^-40, so 2 κ exceeds κ / (1 - κ).
        let skew = mul_up(2.0 * deviation, largest);
        Self { center, axes, half_extents: reach.map(|y| add_up(y, skew)) }
    }

    /// Returns the box with the given center and axes that encloses the points. The axes must be
    /// orthonormal up to rounding.
    pub(super) fn about(center: [f64; 3], axes: [[f64; 3]; 3], points: &[[f64; 3]]) -> Self {
        let reach = |axis| points.iter().map(|&point| projection_up(axis, point, center)).fold(0.0, f64::max);
        Self::of_reach(center, axes, axes.map(reach))
    }

    /// Returns the eight corners, computed in floats: a corner may lie slightly inside or outside
    /// the box. Bit k of a corner's index is set on the positive side of axis k.
    #[must_use]
    pub fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|corner| {
            (0..3).fold(self.center, |sum, k| {
                let t = if corner >> k & 1 == 1 { self.half_extents[k] } else { -self.half_extents[k] };
                add(&sum, &scale(&self.axes[k], t))
            })
        })
    }

    /// Returns a box with the given axes that encloses several parallelepipeds.
    pub(super) fn around(axes: [[f64; 3]; 3], parts: &[Generated]) -> Self {
        let origin = parts[0].center;
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for part in parts {
            for (range, &axis) in ranges.iter_mut().zip(&axes) {
                let middle = dot(&axis, &sub(&part.center, &origin));
                let half: f64 = (0..3).map(|k| part.half_extents[k] * dot(&axis, &part.generators[k]).abs()).sum();
                *range = [range[0].min(middle - half), range[1].max(middle + half)];
            }
        }
        let middle = |k: usize| scale(&axes[k], 0.5 * (ranges[k][0] + ranges[k][1]));
        let center = (0..3).map(middle).fold(origin, |sum, middle| add(&sum, &middle));
        let reach = axes.map(|axis| parts.iter().map(|part| part.reach(axis, center)).fold(0.0, f64::max));
        Self::of_reach(center, axes, reach)
    }

    pub(super) fn generated(&self) -> Generated {
        Generated { center: self.center, generators: self.axes, half_extents: self.half_extents, error: 0.0 }
    }
}

/// A parallelepiped with arbitrary generators. Each of its points has an error of up to `error`.
pub(super) struct Generated {
    pub(super) center: [f64; 3],
    pub(super) generators: [[f64; 3]; 3],
    pub(super) half_extents: [f64; 3],
    pub(super) error: f64,
}

impl Generated {
    /// Returns a double not below `|axis · (x - center)|` for any point x of the parallelepiped.
    fn reach(&self, axis: [f64; 3], center: [f64; 3]) -> f64 {
        let mut reach = projection_up(axis, self.center, center);
        for (generator, half) in self.generators.iter().zip(self.half_extents) {
            reach = add_up(reach, mul_up(half, projection_up(axis, *generator, [0.0; 3])));
        }
        // The length of an axis is at most 1 + 2^-40.
        add_up(reach, mul_up(self.error, 1.0 + MAX_DEVIATION))
    }
}

/// Returns a double not below |axis · (p - q)|. It is exact if no operation rounds.
pub(super) fn projection_up(axis: [f64; 3], p: [f64; 3], q: [f64; 3]) -> f64 {
    let (mut low, mut high) = (0.0, 0.0);
    for k in 0..3 {
        let difference = [add_down(p[k], -q[k]), add_up(p[k], -q[k])];
        low = add_down(low, mul_down(axis[k], difference[0]).min(mul_down(axis[k], difference[1])));
        high = add_up(high, mul_up(axis[k], difference[0]).max(mul_up(axis[k], difference[1])));
    }
    high.max(-low)
}

/// Returns a bound on the maximum norm of G - I, with G the Gram matrix of the axes. The bound is
/// zero if the axes are exactly orthonormal.
pub(super) fn deviation(axes: &[[f64; 3]; 3]) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..3 {
        let mut row = 0.0;
        for j in 0..3 {
            let (mut low, mut high) = if i == j { (-1.0, -1.0) } else { (0.0, 0.0) };
            for k in 0..3 {
                low = add_down(low, mul_down(axes[i][k], axes[j][k]));
                high = add_up(high, mul_up(axes[i][k], axes[j][k]));
            }
            row = add_up(row, high.max(-low));
        }
        worst = worst.max(row);
    }
    worst
}

/// Returns orthonormal axes, up to rounding: the first along the first vector, the second in the
/// plane of the first two. Zero or dependent vectors are skipped, and coordinate axes complete the
/// frame.
///
/// # Source
/// Gram and Schmidt, done twice, because one pass leaves an error if the vectors nearly cancel.
pub(super) fn orthonormal(vectors: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut axes = [[0.0; 3]; 3];
    let mut found = 0;
    for candidate in vectors.into_iter().chain(IDENTITY) {
        if found == 3 {
            break;
        }
        let Some(mut axis) = normalized(&candidate) else { continue };
        let mut left = 1.0;
        for _ in 0..2 {
            for &other in &axes[..found] {
                axis = sub(&axis, &scale(&other, dot(&axis, &other)));
            }
            left = dot(&axis, &axis);
            axis = normalized(&axis).unwrap_or([0.0; 3]);
        }
        // A vector that was nearly in the span of the others has no reliable direction of its own.
        if left > 0.5 && dot(&axis, &axis) > 0.5 {
            axes[found] = axis;
            found += 1;
        }
    }
    if found == 3 { axes } else { IDENTITY }
}
