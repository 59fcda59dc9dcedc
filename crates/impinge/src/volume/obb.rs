//! The oriented box (*Notes*, 2.3: what principal components also give; Ericson 4.4).

use super::min_max::{in_range, lengths_in_range};
use super::rounding::{add_down, add_up, mul_down, mul_up};
use crate::input::{InputError, InputErrorKind};
use crate::math::vec3::{add, dot, normalized, scale, sub};

/// The most by which the axes may deviate from being orthonormal: far more than rounding them takes, far less than what
/// would loosen a box. Axes from single precision are to be orthonormalised first.
const ORTHONORMAL: f64 = 1.0 / (1_u64 << 40) as f64;

/// The points `centre + Σ tᵢ axisᵢ` with |tᵢ| ≤ half-extentᵢ.
///
/// Axes are doubles, so they are orthonormal but for rounding; the set is the parallelepiped that the numbers say, and
/// whatever makes a box counts that deviation into its half-extents.
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
    pub(super) centre: [f64; 3],
    pub(super) axes: [[f64; 3]; 3],
    pub(super) half_extents: [f64; 3],
}

const _: () = assert!(size_of::<Obb>() == 120);

impl Obb {
    /// The box about a centre, with these axes.
    ///
    /// # Errors
    /// [`NonFinite`](InputErrorKind::NonFinite), [`OutOfRange`](InputErrorKind::OutOfRange) (beyond 2^320),
    /// [`Negative`](InputErrorKind::Negative) for a half-extent, and [`NotRigid`](InputErrorKind::NotRigid) where the axes
    /// deviate from orthonormal ones by more than 2^-40.
    pub fn new(centre: [f64; 3], axes: [[f64; 3]; 3], half_extents: [f64; 3]) -> Result<Self, InputError> {
        in_range("box centre or axis", centre.into_iter().chain(axes.into_iter().flatten()))?;
        lengths_in_range("half-extent", half_extents)?;
        let deviation = deviation(&axes);
        if deviation > ORTHONORMAL {
            return Err(InputError::new(InputErrorKind::NotRigid { deviation })
                .with_hint("the axes of a box are orthonormal: normalise them"));
        }
        Ok(Self { centre, axes, half_extents })
    }

    /// The centre.
    #[must_use]
    pub fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// The axes, one a row.
    #[must_use]
    pub fn axes(&self) -> [[f64; 3]; 3] {
        self.axes
    }

    /// Half the lengths along the axes.
    #[must_use]
    pub fn half_extents(&self) -> [f64; 3] {
        self.half_extents
    }

    /// The box with these axes, orthonormal up to rounding, about some centre, that holds all points which have a
    /// projection on each axis from the centre, axis · (x - centre), of magnitude at most `reach`, rounded up.
    ///
    /// With y the projections and s the coordinates of a point, y = G s for the Gram matrix G of the axes, so
    /// |s - y| ≤ κ |s| ≤ κ / (1 - κ) |y| in the maximum norm, κ being that of G - I.
    pub(super) fn of_reach(centre: [f64; 3], axes: [[f64; 3]; 3], reach: [f64; 3]) -> Self {
        let deviation = deviation(&axes);
        let largest = reach.into_iter().fold(0.0, f64::max);
        // κ is below 2^-40, so 2 κ is more than κ / (1 - κ).
        let skew = mul_up(2.0 * deviation, largest);
        Self { centre, axes, half_extents: reach.map(|y| add_up(y, skew)) }
    }

    /// The box about a centre with these axes, orthonormal up to rounding, that holds the points.
    pub(super) fn about(centre: [f64; 3], axes: [[f64; 3]; 3], points: &[[f64; 3]]) -> Self {
        let reach = |axis| points.iter().map(|&point| projection_up(axis, point, centre)).fold(0.0, f64::max);
        Self::of_reach(centre, axes, axes.map(reach))
    }

    /// The corners, rounded.
    #[must_use]
    pub fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|corner| {
            (0..3).fold(self.centre, |sum, k| {
                let t = if corner >> k & 1 == 1 { self.half_extents[k] } else { -self.half_extents[k] };
                add(&sum, &scale(&self.axes[k], t))
            })
        })
    }

    /// The box with these axes that holds several parallelepipeds.
    pub(super) fn around(axes: [[f64; 3]; 3], parts: &[Generated]) -> Self {
        let origin = parts[0].centre;
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for part in parts {
            for (range, &axis) in ranges.iter_mut().zip(&axes) {
                let middle = dot(&axis, &sub(&part.centre, &origin));
                let half: f64 = (0..3).map(|k| part.half_extents[k] * dot(&axis, &part.generators[k]).abs()).sum();
                *range = [range[0].min(middle - half), range[1].max(middle + half)];
            }
        }
        let middle = |k: usize| scale(&axes[k], 0.5 * (ranges[k][0] + ranges[k][1]));
        let centre = (0..3).map(middle).fold(origin, |sum, middle| add(&sum, &middle));
        let reach = axes.map(|axis| parts.iter().map(|part| part.reach(axis, centre)).fold(0.0, f64::max));
        Self::of_reach(centre, axes, reach)
    }

    pub(super) fn generated(&self) -> Generated {
        Generated { centre: self.centre, generators: self.axes, half_extents: self.half_extents, off: 0.0 }
    }
}

/// A parallelepiped of any generators, each point of which may be off by up to `off`.
pub(super) struct Generated {
    pub(super) centre: [f64; 3],
    pub(super) generators: [[f64; 3]; 3],
    pub(super) half_extents: [f64; 3],
    pub(super) off: f64,
}

impl Generated {
    /// A double not below |axis · (x - centre)| for any point x.
    fn reach(&self, axis: [f64; 3], centre: [f64; 3]) -> f64 {
        let mut reach = projection_up(axis, self.centre, centre);
        for (generator, half) in self.generators.iter().zip(self.half_extents) {
            reach = add_up(reach, mul_up(half, projection_up(axis, *generator, [0.0; 3])));
        }
        // An axis is at most 1 + 2^-40 long.
        add_up(reach, mul_up(self.off, 1.0 + ORTHONORMAL))
    }
}

/// A double not below |axis · (p - q)|, and exact where no operation rounds.
pub(super) fn projection_up(axis: [f64; 3], p: [f64; 3], q: [f64; 3]) -> f64 {
    let (mut low, mut high) = (0.0, 0.0);
    for k in 0..3 {
        let difference = [add_down(p[k], -q[k]), add_up(p[k], -q[k])];
        low = add_down(low, mul_down(axis[k], difference[0]).min(mul_down(axis[k], difference[1])));
        high = add_up(high, mul_up(axis[k], difference[0]).max(mul_up(axis[k], difference[1])));
    }
    high.max(-low)
}

/// A bound on the maximum norm of G - I, G being the Gram matrix of the axes; zero where they are exactly orthonormal.
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

/// Orthonormal axes, up to rounding: the first along the first vector, the second in the plane of the first two.
///
/// # Source
/// Gram and Schmidt, twice over, as one pass leaves what cancels.
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
        // What was nearly in the span of the others has no direction of its own.
        if left > 0.5 && dot(&axis, &axis) > 0.5 {
            axes[found] = axis;
            found += 1;
        }
    }
    if found == 3 { axes } else { IDENTITY }
}
