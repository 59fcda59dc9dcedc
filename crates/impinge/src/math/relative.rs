//! The affine map from one mesh's frame to another's, in floats with proved error bounds.
//!
//! The map itself, `x_a = R_A⁻¹ (R_B v + t_B - t_A)`, has rational entries that floats cannot hold.
//! It is approximated by the fastest of three ways that applies:
//!
//! 1. Equal poses, or `R_A` the identity: the linear part is exact.
//! 2. An approximate inverse with a bound on its residual (Rump, *Verification methods*, Acta
//!    Numerica 19, 2010, section 10). Ours bounds each component, so the bounds keep to the scale
//!    of each entry.
//! 3. For maps so sheared or scaled that this bound is loose: quotients of exact determinants,
//!    rounded once.
//!
//! Bounds are sums of products of magnitudes, evaluated in floats. A sum with up to 30 such
//! roundings is too small by a factor of 1 - 2^-48 at most. Each product that underflows loses
//! 2^-1075 at most. So a bound that is multiplied by [`INFLATE`] and increased by [`UNDERFLOW`]
//! holds over the reals. Each stage does this once; its operands are bounds already.
//!
//! `tests/it/exact_relative_map.rs` compares the map and its bounds with rationals.

use super::Pose;
use super::dyadic::{self, Dyadic};
use super::vec3::dot;

/// Half a unit in the last place of 1: the relative error of one rounding is below it.
pub(crate) const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

/// Factor that covers all the relative rounding errors of a bound with fewer than 60 operations: 1
/// + 2^-46.
pub(crate) const INFLATE: f64 = 1.0 + 64.0 * f64::EPSILON;

/// More than 32 products lose to underflow: 2^-1000. It is not subnormal, because processors take
/// 100 times as long with subnormal numbers.
pub(crate) const UNDERFLOW: f64 = f64::from_bits((1023 - 1000) << 52);

/// Maximum error of the linear part with which an approximate inverse is accepted, relative to the
/// largest entry of the row: 2^-40. Rigid maps reach 2^-48. If it is larger, more triangles need
/// exact arithmetic. If it is smaller, more queries compute exact quotients, which take some
/// microseconds each.
const ACCURACY: f64 = 4096.0 * f64::EPSILON;

/// Maximum magnitude, 2^64, of an entry of the approximate inverse. It keeps all bounds far from
/// overflow.
const INVERSE_LIMIT: f64 = (1_u128 << 64) as f64;

/// An approximation of the affine map from B's frame to A's, with error bounds.
///
/// For every real point `v` in B's frame, its exact image in A's frame differs from
/// `linear · v + translation`, evaluated over the reals, by at most
/// `linear_error · |v| + translation_error`, component by component.
///
/// All entries are finite, with one exception: a value beyond 2^1022 is stored as zero with an
/// infinite error. `∞ · 0` is NaN, so a consumer must treat NaN as "unknown".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeMap {
    /// The linear part: the rows of a 3x3 matrix that multiplies points of B's frame from the left.
    pub linear: [[f64; 3]; 3],
    /// The translation, in A's units.
    pub translation: [f64; 3],
    /// Bounds on the absolute errors of the entries of [`linear`](Self::linear).
    pub linear_error: [[f64; 3]; 3],
    /// Bounds on the absolute errors of the entries of [`translation`](Self::translation), in A's
    /// units.
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

    /// Returns the map from B's frame to A's, given the pose of each in the world.
    ///
    /// # Accuracy
    /// The map is exact if the poses are equal. Its linear part is exact if A's linear part is the
    /// identity or both linear parts are equal. Its translation is exact if A's linear part is the
    /// identity and `t_B - t_A` is a float. Otherwise the error of the linear part is below 2^-40
    /// of the largest entry of its row, underflow aside, and below 1e-14 if the poses are rigid.
    /// The error of the translation is as small relative to the magnitudes that are summed.
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

    /// Maps a point of B's frame to A's frame, rounded. [`image_error`](Self::image_error) bounds
    /// the error of the result.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = point;
        std::array::from_fn(|i| {
            let row = self.linear[i];
            row[0] * x + row[1] * y + row[2] * z + self.translation[i]
        })
    }

    /// Returns the error bound of [`apply`](Self::apply) for any point whose coordinates are within
    /// `extent` in magnitude, per coordinate. It covers the error of the map and that of its
    /// evaluation. `extent` must not be negative.
    #[must_use]
    pub fn image_error(&self, extent: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = extent;
        std::array::from_fn(|i| {
            // A product has four roundings, the translation one: 4.1 units, taken as 5.
            let weight = |k: usize| self.linear_error[i][k] + 5.0 * UNIT_ROUNDOFF * self.linear[i][k].abs();
            let constant = self.translation_error[i] + 5.0 * UNIT_ROUNDOFF * self.translation[i].abs();
            // The weights may underflow too, before they are multiplied by the extent.
            let underflow = UNDERFLOW * (1.0 + x + y + z);
            (weight(0) * x + weight(1) * y + weight(2) * z + constant) * INFLATE + underflow
        })
    }

    /// Computes the map by an approximate inverse `Y` of `R = R_A`. With `E = I - Y R`,
    /// `R⁻¹ = (I - E)⁻¹ Y`, so `|R⁻¹ - Y| <= |E| |Y| + |E|² |Y| + ...`. Let `g` be the row sums of
    /// `|Y|`, and `|E| g <= κ g` with `κ < 1`. Then row i of the terms from the second on sums to
    /// at most `κ² / (1 - κ) g_i`. This is relative to that row, however the axes are scaled.
    ///
    /// Returns `None` if the series has no such bound, or if the error bound is not small.
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
                // A product has three roundings, and the difference one, which `INFLATE` covers.
                let rounding = 4.0 * UNIT_ROUNDOFF * (terms[0].abs() + terms[1].abs() + terms[2].abs());
                residual[i][j] = (value.abs() + rounding) * INFLATE + UNDERFLOW;
            }
        }
        let sizes = inverse.map(|row| (row[0].abs() + row[1].abs() + row[2].abs()) * INFLATE);
        let contraction = (0..3).fold(0.0_f64, |largest, i| {
            let image = dot(&residual[i], &sizes);
            largest.max((image * INFLATE + UNDERFLOW) / sizes[i] * INFLATE)
        });
        // The contraction is infinite if a row of the inverse underflowed to zero. It is never NaN,
        // because all entries are within 2^64.
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
            // The error of an entry of the inverse, plus three roundings of a sum of products with
            // it and one of the offset.
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

    /// Computes the map by Cramer's rule. The columns of the adjugate are cross products of the
    /// rows of `R_A`.
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
    /// Computes `t_B - t_A` by Knuth's two-sum. Nothing overflows, because the entries are within
    /// 2^300.
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

    /// Reports whether `rounded` alone is the exact difference.
    pub(crate) fn is_exact(&self) -> bool {
        self.rest == [0.0; 3]
    }

    fn is_zero(&self) -> bool {
        self.rounded == [0.0; 3]
    }
}

/// Returns the adjugate divided by the determinant, in floats. The result is not finite if the
/// determinant vanishes.
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

/// Returns the nearest float, and an error bound above half a unit in its last place.
fn rounded_quotient(numerator: &Dyadic, denominator: &Dyadic) -> (f64, f64) {
    let quotient = Dyadic::nearest_quotient(numerator, denominator);
    if quotient.is_finite() { (quotient, quotient.abs() * f64::EPSILON + UNDERFLOW) } else { (0.0, f64::INFINITY) }
}
