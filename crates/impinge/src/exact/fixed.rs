//! Signs of determinants of integers that fit a machine word.
//!
//! If both poses keep a common grid, the six corners of a pair usually span few enough bits to be
//! integers below 2^60. Coordinates in single precision between 1e-4 and 1e6 do. A determinant
//! below 2^187 is then exact in a handful of multiplications. The proof is docs/notes/proof.md, L6.

use super::exact_points::{Corners, ExactPoints};
use super::placement::Frame;
use crate::math::Sign;
use crate::math::dyadic::decompose;

/// A corner on the common grid. Each coordinate is below 2^60 in magnitude.
type Point = [i64; 3];

/// Maximum number of bits that the given coordinates may span. The image of a corner under entries
/// -1, 0, 1 and an offset is a sum of up to four coordinates, so it is below 2^60. Differences are
/// then below 2^61, two-by-two minors below 2^123, and the two halves of `orient3d` below 2^127. A
/// larger span could overflow.
const SPAN: i32 = 58;

/// The corners of A, then of B, on the finest grid that holds all of them.
pub(super) struct FixedPoints([Point; 6]);

impl FixedPoints {
    /// Builds the points. Returns `None` if the frame has no grid, or if the corners span too many
    /// bits of it.
    pub(super) fn new(frame: &Frame, a: &Corners, b: &Corners) -> Option<Self> {
        match frame {
            Frame::World => None,
            Frame::Local => {
                let grid = Grid::spanning(a.iter().chain(b))?;
                Some(Self(std::array::from_fn(|i| grid.point(if i < 3 { &a[i] } else { &b[i - 3] }))))
            }
            Frame::Grid { linear_a, linear_b, offset } => {
                let grid = Grid::spanning(a.iter().chain(b).chain([offset]))?;
                let offset = grid.point(offset);
                Some(Self(std::array::from_fn(|i| {
                    if i < 3 {
                        image(linear_a, grid.point(&a[i]), [0; 3])
                    } else {
                        image(linear_b, grid.point(&b[i - 3]), offset)
                    }
                })))
            }
        }
    }
}

impl ExactPoints for FixedPoints {
    fn orient3d(&self, [p, q, r, s]: [usize; 4]) -> Sign {
        let from_p = |x: usize| -> Point { std::array::from_fn(|k| self.0[x][k] - self.0[p][k]) };
        let (u, v, w) = (from_p(q), from_p(r), from_p(s));
        // The determinant is high · 2^64 + low.
        let (mut high, mut low) = (0_i128, 0_i128);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let minor = i128::from(u[i]) * i128::from(v[j]) - i128::from(u[j]) * i128::from(v[i]);
            high += (minor >> 64) * i128::from(w[k]);
            low += i128::from(minor as u64) * i128::from(w[k]);
        }
        high += low >> 64;
        match high.cmp(&0).into() {
            Sign::Zero if low as u64 != 0 => Sign::Positive,
            sign => sign,
        }
    }

    fn orient2d(&self, axis: usize, [p, q, r]: [usize; 3]) -> Sign {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let product =
            |x: usize, y: usize| i128::from(self.0[x][i] - self.0[p][i]) * i128::from(self.0[y][j] - self.0[p][j]);
        product(q, r).cmp(&product(r, q)).into()
    }

    fn compare(&self, axis: usize, [p, q]: [usize; 2]) -> Sign {
        self.0[p][axis].cmp(&self.0[q][axis]).into()
    }
}

/// The multiples of `2^exponent`.
struct Grid {
    exponent: i32,
}

impl Grid {
    fn spanning<'p>(points: impl Iterator<Item = &'p [f64; 3]>) -> Option<Self> {
        let (mut lowest, mut highest) = (i32::MAX, i32::MIN);
        for &x in points.flatten() {
            if x != 0.0 {
                let (_, mantissa, exponent) = decompose(x);
                lowest = lowest.min(exponent + mantissa.trailing_zeros() as i32);
                highest = highest.max(exponent + 64 - mantissa.leading_zeros() as i32);
            }
        }
        let all_zero = lowest > highest;
        (all_zero || highest - lowest <= SPAN).then_some(Self { exponent: if all_zero { 0 } else { lowest } })
    }

    fn point(&self, point: &[f64; 3]) -> Point {
        point.map(|x| {
            let (negative, mantissa, exponent) = decompose(x);
            let shift = exponent - self.exponent;
            // The value is a multiple of the grid unit, so a right shift drops only zeros.
            let magnitude = if mantissa == 0 {
                0
            } else if shift < 0 {
                (mantissa >> -shift) as i64
            } else {
                (mantissa << shift) as i64
            };
            if negative { -magnitude } else { magnitude }
        })
    }
}

fn image(linear: &[[i64; 3]; 3], point: Point, offset: Point) -> Point {
    std::array::from_fn(|i| linear[i][0] * point[0] + linear[i][1] * point[1] + linear[i][2] * point[2] + offset[i])
}
