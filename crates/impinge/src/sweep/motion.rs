//! A rigid motion over the time from 0 to 1: a screw, or the motion between two poses.
//!
//! The platform's sine and cosine are not used, so results do not depend on it. A rotation is a
//! quaternion of a small angle, computed by its series, and squared as often as the angle was
//! halved.
//!
//! The proof is docs/notes/proof.md, L24. The tests are in `tests/it/sweep/rigid.rs`.

use crate::input::{InputError, InputErrorKind};
use crate::math::Pose;
use crate::math::arctangent::angle;
use crate::math::vec3::scaled_length;

/// Maximum Frobenius norm of RᵀR - I of a linear part that counts as rigid, as for round shapes.
const MAX_DEVIATION: f64 = 1e-4;

/// Maximum magnitude of an entry of a velocity or a pivot: 2^300, as for a translation.
const LIMIT: f64 = f64::from_bits((1023 + 300) << 52);

/// Maximum magnitude of an entry of the angular velocity, in radians: 2^20. The error of the
/// rotation grows with the angle.
const ANGULAR_LIMIT: f64 = (1 << 20) as f64;

const UNIT: f64 = 0.5 * f64::EPSILON;

/// The poses of a rigid body at all times from 0 to 1.
///
/// Let P₀ be the first pose, p the pivot, l the linear and w the angular velocity, each being the
/// real numbers that its floats represent. A point v of the body is at time t at
/// `p + l t + exp(t [w]) (P₀ v - p) + t D v`, in the world frame. D is zero for a screw. For a
/// motion between two poses, D is the difference between the second linear part and the rotated
/// first one. That is only rounding, and the first linear part's deviation from a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    world_from_body_t0: Pose,
    linear: [f64; 3],
    angular: [f64; 3],
    pivot: [f64; 3],
    /// The matrix D, rounded.
    difference: [[f64; 3]; 3],
}

impl Motion {
    /// Returns the motion of a body that rests at a pose, which maps the body's frame to the world
    /// frame.
    #[must_use]
    pub fn resting(world_from_body: Pose) -> Self {
        let pivot = *world_from_body.translation();
        Self {
            world_from_body_t0: world_from_body,
            linear: [0.0; 3],
            angular: [0.0; 3],
            pivot,
            difference: [[0.0; 3]; 3],
        }
    }

    /// Returns the motion from one pose, at time 0, to another, at time 1. The poses map the body's
    /// frame to the world frame. The origin of the body's frame moves along a line at constant
    /// speed, and the body turns about it by the smallest angle at constant speed. Poses with equal
    /// linear parts need not be rigid, because then nothing turns.
    ///
    /// ```
    /// use impinge::Pose;
    /// use impinge::sweep::Motion;
    ///
    /// let quarter = Pose::from_quaternion_wxyz([2.0, 0.0, 0.0], [0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()])?;
    /// let motion = Motion::between(Pose::IDENTITY, quarter)?;
    /// let [x, y, _] = motion.at(0.5).apply([1.0, 0.0, 0.0]);
    /// assert!((x - 1.0 - 0.5_f64.sqrt()).abs() < 1e-12 && (y - 0.5_f64.sqrt()).abs() < 1e-12);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Errors
    /// [`NotRigid`](InputErrorKind::NotRigid) if the linear parts differ and one deviates from a
    /// rotation by more than 1e-4, or only one of the poses mirrors.
    pub fn between(world_from_body_t0: Pose, world_from_body_t1: Pose) -> Result<Self, InputError> {
        let (from, to) = (world_from_body_t0.linear(), world_from_body_t1.linear());
        let (start, end) = (world_from_body_t0.translation(), world_from_body_t1.translation());
        let linear = [0, 1, 2].map(|k| end[k] - start[k]);
        let resting = Self { linear, ..Self::resting(world_from_body_t0) };
        if from == to {
            return Ok(resting);
        }
        let deviation = deviation(from).max(deviation(to));
        if deviation > MAX_DEVIATION {
            return Err(InputError::new(InputErrorKind::NotRigid { deviation }));
        }
        if world_from_body_t0.mirrors() != world_from_body_t1.mirrors() {
            let kind = InputErrorKind::NotRigid { deviation: 2.0 };
            return Err(InputError::new(kind)
                .with_hint("one pose mirrors and the other does not; give two poses of the same handedness"));
        }
        let turn = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| to[i][k] * from[j][k]).sum::<f64>()));
        let turning = Self { angular: rotation_vector(&turn), ..resting };
        let turned = product(&turning.rotation(1.0), from);
        let difference = [0, 1, 2].map(|i| [0, 1, 2].map(|j| to[i][j] - turned[i][j]));
        Ok(Self { difference, ..turning })
    }

    /// Returns a screw motion. The body turns about an axis through `pivot` at constant speed, by
    /// the vector `angular` in radians over the whole time; any number of turns is valid. The pivot
    /// moves by `linear` at constant speed. All vectors are in the world frame. `None` as pivot
    /// means the origin of the body's frame.
    ///
    /// # Errors
    /// - [`NonFinite`](InputErrorKind::NonFinite) if an entry is not finite;
    /// - [`OutOfRange`](InputErrorKind::OutOfRange) if an entry is beyond 2^20 radians or 2^300
    ///   units;
    /// - [`NotRigid`](InputErrorKind::NotRigid) if the body turns and the pose deviates from a
    ///   rotation by more than 1e-4.
    pub fn screw(
        world_from_body_t0: Pose,
        linear: [f64; 3],
        angular: [f64; 3],
        pivot: Option<[f64; 3]>,
    ) -> Result<Self, InputError> {
        let pivot = pivot.unwrap_or(*world_from_body_t0.translation());
        let rows = [
            ("linear velocity", linear, LIMIT, "2^300"),
            ("angular velocity", angular, ANGULAR_LIMIT, "2^20"),
            ("pivot", pivot, LIMIT, "2^300"),
        ];
        for (what, row, largest, limit) in rows {
            for (index, x) in row.into_iter().enumerate() {
                if !x.is_finite() {
                    return Err(InputError::new(InputErrorKind::NonFinite { what, index }));
                }
                if x.abs() > largest {
                    return Err(InputError::new(InputErrorKind::OutOfRange { what, index, limit }));
                }
            }
        }
        let deviation = deviation(world_from_body_t0.linear());
        if angular != [0.0; 3] && deviation > MAX_DEVIATION {
            return Err(InputError::new(InputErrorKind::NotRigid { deviation }));
        }
        Ok(Self { linear, angular, pivot, ..Self::resting(world_from_body_t0) })
    }

    /// Returns the pose at a time from 0 to 1, rounded: the map from the body's frame to the world
    /// frame. At time 0 it is exactly the first pose.
    /// Times outside [0, 1] count as the nearer end, and NaN as 0.
    ///
    /// # Accuracy
    /// The error of a point is about 1e-15 of its distances from the pivot and the origin, times
    /// the angle in radians.
    #[must_use]
    pub fn at(&self, t: f64) -> Pose {
        let start = &self.world_from_body_t0;
        let t = if t > 0.0 { t.min(1.0) } else { return *start };
        let turned = self.rotation(t);
        let linear = product(&turned, start.linear());
        let linear = [0, 1, 2].map(|i| [0, 1, 2].map(|j| linear[i][j] + t * self.difference[i][j]));
        let arm = [0, 1, 2].map(|k| start.translation()[k] - self.pivot[k]);
        let translation = [0, 1, 2].map(|k| {
            let moved = turned[k][0] * arm[0] + turned[k][1] * arm[1] + turned[k][2] * arm[2];
            moved + (self.pivot[k] + t * self.linear[k])
        });
        // A pose that is nearly a rotation is invertible. If nothing turns, the linear part is the
        // first one's. A translation beyond the range of poses stays at its limit, where nothing is
        // near anything.
        let within = translation.map(|x| x.clamp(-LIMIT, LIMIT));
        Pose::new(linear, within).unwrap_or(*start)
    }

    /// Returns the velocity of the pivot, in world units over the whole time.
    pub(super) fn linear(&self) -> [f64; 3] {
        self.linear
    }

    /// Returns the pivot at a time, `p + l t`, rounded.
    pub(super) fn pivot_at(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| self.pivot[k] + t * self.linear[k])
    }

    /// Returns how the body turns.
    pub(super) fn turn(&self) -> Turn {
        let rate = length(self.angular);
        let axis = if rate > 0.0 { self.angular.map(|x| x / rate) } else { [0.0; 3] };
        let drift = length(self.difference.map(length)) * (1.0 + 1e-12);
        Turn { axis, rate: rate * (1.0 + 1e-12), drift }
    }

    /// Returns the arm of a point of the body at time 0, `P₀ v - p`, rounded.
    pub(super) fn arm(&self, point: [f64; 3]) -> [f64; 3] {
        let start = self.world_from_body_t0.apply(point);
        [0, 1, 2].map(|k| start[k] - self.pivot[k])
    }

    /// Reports whether the linear part of the pose changes.
    pub(super) fn turns(&self) -> bool {
        self.angular != [0.0; 3] || self.difference != [[0.0; 3]; 3]
    }

    /// Reports whether two bodies that move by these motions keep their distance: both motions are
    /// the same map of the world at each time, and it is rigid.
    pub(super) fn is_in_step_with(&self, other: &Self) -> bool {
        let is_rigid = |motion: &Self| motion.difference == [[0.0; 3]; 3];
        let is_same_turn = self.angular == other.angular && (self.angular == [0.0; 3] || self.pivot == other.pivot);
        is_rigid(self) && is_rigid(other) && is_same_turn && self.linear == other.linear
    }

    /// Reports whether this motion comes before another one in the order of their numbers. Equal
    /// motions come before each other.
    pub(super) fn is_before(&self, other: &Self) -> bool {
        let numbers = |motion: &Self| {
            let start = &motion.world_from_body_t0;
            let vectors = [*start.translation(), motion.linear, motion.angular, motion.pivot];
            vectors.into_iter().chain(*start.linear()).chain(motion.difference).flatten().collect::<Vec<f64>>()
        };
        let (here, there) = (numbers(self), numbers(other));
        let differs = here.iter().zip(&there).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne());
        differs.is_none_or(std::cmp::Ordering::is_lt)
    }

    /// Returns an upper bound on the error of [`at`](Self::at), at any time except zero, for the
    /// image of a point within `reach` of the body's origin.
    pub(super) fn error(&self, reach: f64) -> f64 {
        let start = self.world_from_body_t0.translation();
        let stretch = length(self.world_from_body_t0.linear().map(length));
        let arm = length([0, 1, 2].map(|k| start[k] - self.pivot[k]));
        let sizes = length(*start) + length(self.pivot) + length(self.linear) + stretch * reach;
        let turning = if self.angular == [0.0; 3] { 0.0 } else { self.rotation_error() };
        ((turning + 32.0 * UNIT) * (arm + 3.0 * stretch * reach) + 32.0 * UNIT * sizes) * (1.0 + 1e-12)
    }

    /// Returns an upper bound on the error of [`rotation`](Self::rotation), as an operator norm.
    ///
    /// The quaternion of the smallest angle is wrong by at most 16 u: the halved product of time
    /// and velocity, the series and their product together. Each squaring doubles that and adds
    /// less than 8 u. After k squarings it is 2^k · 24 u, with 2^k at most 8 |w| + 1. The matrix is
    /// wrong by four times as much, and its own rounding is below 40 u.
    fn rotation_error(&self) -> f64 {
        UNIT * (160.0 + 800.0 * length(self.angular))
    }

    /// Returns exp(t [w]), rounded.
    fn rotation(&self, t: f64) -> [[f64; 3]; 3] {
        if self.angular == [0.0; 3] {
            return *Pose::IDENTITY.linear();
        }
        let mut half = self.angular.map(|x| 0.5 * (t * x));
        let mut squarings = 0;
        while length(half) > 0.125 {
            half = half.map(|x| 0.5 * x);
            squarings += 1;
        }
        let z = half.iter().map(|x| x * x).sum::<f64>();
        let series = |terms: [f64; 6]| terms.iter().fold(1.0, |sum, n| 1.0 - z / n * sum);
        // 1 - z/2! + z²/4! … and 1 - z/3! + z²/5! …, which leave out less than 2^-80.
        let mut w = series([132.0, 90.0, 56.0, 30.0, 12.0, 2.0]);
        let over = series([156.0, 110.0, 72.0, 42.0, 20.0, 6.0]);
        let mut v = half.map(|x| over * x);
        for _ in 0..squarings {
            let square = v.iter().map(|x| x * x).sum::<f64>();
            v = v.map(|x| 2.0 * w * x);
            w = w * w - square;
        }
        let [x, y, z] = v;
        let (ww, xx, yy, zz) = (w * w, x * x, y * y, z * z);
        let squared_length = ww + xx + yy + zz;
        [
            [ww + xx - yy - zz, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), ww - xx + yy - zz, 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), ww - xx - yy + zz],
        ]
        .map(|row| row.map(|entry| entry / squared_length))
    }
}

/// How a body turns: what bounds the paths of its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    /// Unit vector along the axis, rounded. It is zero if the body does not turn.
    pub(super) axis: [f64; 3],
    /// Upper bound on the angle over the whole time, in radians.
    pub(super) rate: f64,
    /// Upper bound on the norm of D, which the linear part gains over the whole time.
    pub(super) drift: f64,
}

impl Default for Motion {
    /// Returns the motion of a body at rest whose frame is the world frame.
    fn default() -> Self {
        Self::resting(Pose::IDENTITY)
    }
}

/// Returns the axis times the angle, between 0 and π, of a matrix that is nearly a rotation
/// (Shepperd 1978). A motion stores the remaining error in its difference D.
fn rotation_vector(m: &[[f64; 3]; 3]) -> [f64; 3] {
    let trace = m[0][0] + m[1][1] + m[2][2];
    let squares = [trace, m[0][0], m[1][1], m[2][2]].map(|x| (1.0 + 2.0 * x - trace).max(0.0));
    let largest = (0..4).fold(0, |best, k| if squares[k] > squares[best] { k } else { best });
    let [a, b, c] = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    let [d, e, f] = [m[0][1] + m[1][0], m[1][2] + m[2][1], m[2][0] + m[0][2]];
    let s = squares[largest];
    let [w, v @ ..] = match largest {
        0 => [s, a, b, c],
        1 => [a, s, d, f],
        2 => [b, d, s, e],
        _ => [c, f, e, s],
    };
    let sine = length(v);
    if sine == 0.0 {
        return [0.0; 3];
    }
    let (w, v) = if w < 0.0 { (-w, v.map(|x| -x)) } else { (w, v) };
    let factor = 2.0 * angle(w, sine) / sine;
    v.map(|x| factor * x)
}

/// Returns the Frobenius norm of RᵀR - I.
fn deviation(m: &[[f64; 3]; 3]) -> f64 {
    let entry = |i: usize, j: usize| m.iter().map(|row| row[i] * row[j]).sum::<f64>() - f64::from(u8::from(i == j));
    let squares = (0..9).map(|k| entry(k / 3, k % 3).powi(2)).sum::<f64>();
    squares.sqrt()
}

fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]))
}

fn length(v: [f64; 3]) -> f64 {
    scaled_length(&v)
}
