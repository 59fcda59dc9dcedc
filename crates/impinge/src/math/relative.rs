//! The affine map from one mesh's frame to another's, in floats with proved error bounds.
//!
//! The map itself, `x_a = R_A⁻¹ (R_B v + t_B - t_A)`, has rational entries that floats cannot hold. Three ways lead to
//! its approximation, the cheapest that applies being taken:
//!
//! 1. Equal poses, or `R_A` the identity: the linear part is exact.
//! 2. An approximate inverse with a bound of its residual (Rump, *Verification methods*, Acta Numerica 19, 2010,
//!    section 10; here by components, so that the bounds keep to the scale of each entry).
//! 3. For maps so sheared or scaled that this bound is loose: quotients of exact determinants, rounded once.
//!
//! Bounds are sums of products of magnitudes, evaluated in floats. A sum of up to 30 such roundings is below the true
//! value by a factor of 1 - 2^-48 at most, and each product that underflows loses 2^-1075 at most, so a bound that is
//! multiplied by [`INFLATE`] and increased by [`UNDERFLOW`] holds over the reals. That is done once a stage, where the
//! operands are bounds already.

use super::Pose;
use super::dyadic::{self, Dyadic};
use super::vec3::dot;

/// Half a unit in the last place of 1: the relative error of one rounding is below it.
pub(crate) const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

/// More than all the relative rounding errors of a bound with fewer than 60 operations; 1 + 2^-46.
pub(crate) const INFLATE: f64 = 1.0 + 64.0 * f64::EPSILON;

/// More than what 32 products lose to underflow, and no subnormal number, with which processors take a hundred times as long: 2^-1000.
pub(crate) const UNDERFLOW: f64 = f64::from_bits((1023 - 1000) << 52);

/// The largest error of the linear part, relative to the largest entry of the row, with which an approximate inverse is
/// taken: 2^-40. Rigid maps have 2^-48. Looser bounds would only send more triangles to exact arithmetic, while exact
/// quotients cost some microseconds, once a query.
const ACCURACY: f64 = 4096.0 * f64::EPSILON;

/// The largest magnitude, 2^64, of an entry of the approximate inverse, so that no bound comes near overflow.
const INVERSE_LIMIT: f64 = (1_u128 << 64) as f64;

/// An approximation of the affine map from B's frame to A's, with bounds of how far it is off.
///
/// For every real point `v` of B's frame, the point that it is in A's frame differs from `linear · v + translation`,
/// evaluated over the reals, by at most `linear_error · |v| + translation_error`, component by component.
///
/// All entries are finite or, where a value is beyond 2^1022, zero with an infinite error; a consumer must then let
/// NaN, which `∞ · 0` yields, count as "unknown".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeMap {
    /// The linear part, rows first.
    pub linear: [[f64; 3]; 3],
    /// The translation, in A's units.
    pub translation: [f64; 3],
    /// Bounds of the error of each entry of [`linear`](Self::linear).
    pub linear_error: [[f64; 3]; 3],
    /// Bounds of the error of each entry of [`translation`](Self::translation).
    pub translation_error: [f64; 3],
}

impl RelativeMap {
    /// The map that moves nothing, without error.
    pub const IDENTITY: Self = Self {
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
        linear_error: [[0.0; 3]; 3],
        translation_error: [0.0; 3],
    };

    /// The map from B's frame to A's, of which each pose gives the way to the world.
    ///
    /// # Accuracy
    /// Exact where the poses are equal. The linear part is exact where A's is the identity or both are the same, the
    /// translation where A's linear part is the identity and `t_B - t_A` is a float. Otherwise the errors of the linear
    /// part are below 2^-40 of the largest entry of their row, underflow aside, and below 1e-14 where the poses are
    /// rigid; that of the translation is as small next to the magnitudes that sum up to it.
    #[must_use]
    pub fn a_from_b(world_from_a: &Pose, world_from_b: &Pose) -> Self {
        if world_from_a == world_from_b {
            return Self::IDENTITY;
        }
        let offset = Offset::between(world_from_a, world_from_b);
        if world_from_a.linear() == Pose::IDENTITY.linear() {
            return Self {
                linear: *world_from_b.linear(),
                translation: offset.rounded,
                linear_error: [[0.0; 3]; 3],
                translation_error: offset.rest.map(f64::abs),
            };
        }
        let mut map = Self::by_residual(world_from_a, world_from_b, &offset)
            .unwrap_or_else(|| Self::by_quotients(world_from_a, world_from_b));
        if world_from_a.linear() == world_from_b.linear() {
            map.linear = Self::IDENTITY.linear;
            map.linear_error = Self::IDENTITY.linear_error;
        }
        if offset.is_zero() {
            map.translation = [0.0; 3];
            map.translation_error = [0.0; 3];
        }
        map
    }

    /// The point of A's frame that a point of B's is mapped to, in floats; [`image_error`](Self::image_error) bounds
    /// its error.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = point;
        std::array::from_fn(|i| {
            let row = self.linear[i];
            row[0] * x + row[1] * y + row[2] * z + self.translation[i]
        })
    }

    /// How far [`apply`](Self::apply) may be from the true image of any point whose coordinates are within `extent`,
    /// the error of the map and that of its evaluation together. `extent` is not negative.
    #[must_use]
    pub fn image_error(&self, extent: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = extent;
        std::array::from_fn(|i| {
            // Four roundings on the way of a product, one on that of the translation: 4.1 units, taken as 5.
            let weight = |k: usize| self.linear_error[i][k] + 5.0 * UNIT_ROUNDOFF * self.linear[i][k].abs();
            let constant = self.translation_error[i] + 5.0 * UNIT_ROUNDOFF * self.translation[i].abs();
            // The weights may underflow too, before they are multiplied by the extent.
            let underflow = UNDERFLOW * (1.0 + x + y + z);
            (weight(0) * x + weight(1) * y + weight(2) * z + constant) * INFLATE + underflow
        })
    }

    /// By an approximate inverse `Y` of `R = R_A`. With `E = I - Y R` it is `R⁻¹ = (I - E)⁻¹ Y`, so
    /// `|R⁻¹ - Y| <= |E| |Y| + |E|² |Y| + ...`. Let `g` be the row sums of `|Y|`, and `|E| g <= κ g` with `κ < 1`. Then
    /// row i of the terms from the second on sums to at most `κ² / (1 - κ) g_i`: relative to that row, however the axes
    /// are scaled.
    ///
    /// Nothing where the series is not bounded so, or the bound of the error is not small.
    fn by_residual(world_from_a: &Pose, world_from_b: &Pose, offset: &Offset) -> Option<Self> {
        let r_a = world_from_a.linear();
        let r_b = world_from_b.linear();
        let inverse = approximate_inverse(r_a);
        if !inverse.iter().flatten().all(|entry| entry.abs() <= INVERSE_LIMIT) {
            return None;
        }
        let mut residual = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let terms: [f64; 3] = std::array::from_fn(|k| inverse[i][k] * r_a[k][j]);
                let unit = if i == j { 1.0 } else { 0.0 };
                let value = unit - (terms[0] + terms[1] + terms[2]);
                // Three roundings on the way of a product, and that of the difference, which `INFLATE` covers.
                let rounding = 4.0 * UNIT_ROUNDOFF * (terms[0].abs() + terms[1].abs() + terms[2].abs());
                residual[i][j] = (value.abs() + rounding) * INFLATE + UNDERFLOW;
            }
        }
        let sizes = inverse.map(|row| (row[0].abs() + row[1].abs() + row[2].abs()) * INFLATE);
        let contraction = (0..3).fold(0.0_f64, |largest, i| {
            let image = dot(&residual[i], &sizes);
            largest.max((image * INFLATE + UNDERFLOW) / sizes[i] * INFLATE)
        });
        // Infinite where a row of the inverse underflowed to nothing; never NaN, as all entries are within 2^64.
        if contraction > 0.5 {
            return None;
        }
        let mut inverse_error = [[0.0; 3]; 3];
        for i in 0..3 {
            // κ² / (1 - κ) <= 2 κ².
            let rest = 2.0 * contraction * contraction * sizes[i];
            for j in 0..3 {
                let first = (0..3).map(|k| residual[i][k] * inverse[k][j].abs()).sum::<f64>();
                inverse_error[i][j] = (first + rest) * INFLATE + UNDERFLOW;
            }
        }
        let mut map = Self::IDENTITY;
        for i in 0..3 {
            let y = inverse[i];
            // The error of an entry of the inverse, with three roundings of a sum of products with it and one of the
            // offset.
            let weight: [f64; 3] = std::array::from_fn(|k| inverse_error[i][k] + 5.0 * UNIT_ROUNDOFF * y[k].abs());
            for j in 0..3 {
                map.linear[i][j] = y[0] * r_b[0][j] + y[1] * r_b[1][j] + y[2] * r_b[2][j];
                let error = (0..3).map(|k| weight[k] * r_b[k][j].abs()).sum::<f64>();
                map.linear_error[i][j] = error * INFLATE + UNDERFLOW;
            }
            let largest = |row: &[f64; 3]| row[0].abs().max(row[1].abs()).max(row[2].abs());
            if largest(&map.linear_error[i]) > ACCURACY * largest(&map.linear[i]) {
                return None;
            }
            let d = offset.rounded;
            map.translation[i] = dot(&y, &d);
            let error = (0..3).map(|k| weight[k] * d[k].abs()).sum::<f64>();
            map.translation_error[i] = error * INFLATE + UNDERFLOW;
        }
        Some(map)
    }

    /// By Cramer's rule: the columns of the adjugate are cross products of the rows of `R_A`.
    fn by_quotients(world_from_a: &Pose, world_from_b: &Pose) -> Self {
        let exact = |rows: &[[f64; 3]; 3]| rows.map(|row| row.map(Dyadic::from_f64));
        let [x, y, z] = exact(world_from_a.linear());
        let columns = [dyadic::cross(&y, &z), dyadic::cross(&z, &x), dyadic::cross(&x, &y)];
        let determinant = dyadic::dot(&columns[0], &x);
        let r_b = exact(world_from_b.linear());
        let (t_a, t_b) = (world_from_a.translation(), world_from_b.translation());
        let offset: [Dyadic; 3] = std::array::from_fn(|k| &Dyadic::from_f64(t_b[k]) - &Dyadic::from_f64(t_a[k]));

        let mut map = Self::IDENTITY;
        for i in 0..3 {
            let adjugate = columns.each_ref().map(|column| column[i].clone());
            for j in 0..3 {
                let numerator = dyadic::dot(&adjugate, &r_b.each_ref().map(|row| row[j].clone()));
                (map.linear[i][j], map.linear_error[i][j]) = rounded_quotient(&numerator, &determinant);
            }
            let numerator = dyadic::dot(&adjugate, &offset);
            (map.translation[i], map.translation_error[i]) = rounded_quotient(&numerator, &determinant);
        }
        map
    }
}

/// The exact value of `t_B - t_A` as an unevaluated sum of two floats.
pub(crate) struct Offset {
    pub(crate) rounded: [f64; 3],
    rest: [f64; 3],
}

impl Offset {
    /// Knuth's two-sum of `t_B` and `-t_A`; nothing overflows, the entries being within 2^300.
    pub(crate) fn between(world_from_a: &Pose, world_from_b: &Pose) -> Self {
        let mut offset = Self { rounded: [0.0; 3], rest: [0.0; 3] };
        for k in 0..3 {
            let (x, y) = (world_from_b.translation()[k], -world_from_a.translation()[k]);
            let sum = x + y;
            let y_part = sum - x;
            offset.rounded[k] = sum;
            offset.rest[k] = (x - (sum - y_part)) + (y - y_part);
        }
        offset
    }

    /// Whether `rounded` alone is the difference.
    pub(crate) fn is_exact(&self) -> bool {
        self.rest == [0.0; 3]
    }

    fn is_zero(&self) -> bool {
        self.rounded == [0.0; 3]
    }
}

/// The adjugate over the determinant, in floats; not finite where the determinant vanishes.
fn approximate_inverse(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut adjugate = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            let (r0, r1, c0, c1) = ((j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3);
            adjugate[i][j] = m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
        }
    }
    let determinant = m[0][0] * adjugate[0][0] + m[0][1] * adjugate[1][0] + m[0][2] * adjugate[2][0];
    adjugate.map(|row| row.map(|entry| entry / determinant))
}

/// The nearest float, and more than the half unit in the last place that it may be off.
fn rounded_quotient(numerator: &Dyadic, denominator: &Dyadic) -> (f64, f64) {
    let quotient = Dyadic::nearest_quotient(numerator, denominator);
    if quotient.is_finite() { (quotient, quotient.abs() * f64::EPSILON + UNDERFLOW) } else { (0.0, f64::INFINITY) }
}
