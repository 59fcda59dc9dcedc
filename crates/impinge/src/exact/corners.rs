//! The six corners of a pair of triangles, and the signs of their determinants by the cheapest tier that is certain.

use super::filter::{self, Errors};
use super::fixed::FixedPoints;
use super::placement::Placement;
use super::unbounded::UnboundedPoints;
use super::wide::WidePoints;
use crate::math::Sign;

/// The corners of a triangle in the frame of its mesh; single precision is widened, which loses nothing.
pub type Corners = [[f64; 3]; 3];

/// The dearest arithmetic that a decision took.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tier {
    /// Floats with an error bound, or comparisons of given coordinates.
    Filter,
    /// Integers of one machine word.
    Fixed,
    /// Integers of three machine words.
    Wide,
    /// Integers of any size.
    Unbounded,
}

/// Six corners with exact coordinates in some frame.
pub(super) trait ExactPoints {
    /// The sign of `det(q - p, r - p, s - p)` of corners `[p, q, r, s]`.
    fn orient3d(&self, corners: [usize; 4]) -> Sign;

    /// The sign of `det(q - p, r - p)` of corners `[p, q, r]`, projected along an axis.
    fn orient2d(&self, axis: usize, corners: [usize; 3]) -> Sign;

    /// How corner `p` compares to `q` along an axis, of `[p, q]`.
    fn compare(&self, axis: usize, corners: [usize; 2]) -> Sign;
}

/// Corners by number, those of A being 0, 1, 2 and those of B 3, 4, 5, with whatever is known of their coordinates.
pub(super) struct PairCorners<'p> {
    placement: &'p Placement,
    a: &'p Corners,
    b: &'p Corners,
    /// B's corners in A's frame, each coordinate off by at most `image_error`.
    image_b: Corners,
    image_error: [f64; 3],
    exact: Option<Exact>,
}

/// Exact coordinates in the frame of the placement, in the smallest integers that hold them.
#[expect(clippy::large_enum_variant, reason = "one a pair, on the stack of its decision")]
enum Exact {
    Fixed(FixedPoints),
    Wide(WidePoints),
    Unbounded(Box<UnboundedPoints>),
}

const NO_ERROR: [f64; 3] = [0.0; 3];

impl<'p> PairCorners<'p> {
    pub(super) fn new(placement: &'p Placement, a: &'p Corners, b: &'p Corners) -> Self {
        let (image_b, image_error) = if placement.is_shared() {
            (*b, NO_ERROR)
        } else {
            let map = placement.relative();
            let extent = std::array::from_fn(|k| b[0][k].abs().max(b[1][k].abs()).max(b[2][k].abs()));
            (b.map(|corner| map.apply(corner)), map.image_error(extent))
        };
        Self { placement, a, b, image_b, image_error, exact: None }
    }

    /// The dearest tier that was needed so far.
    pub(super) fn tier(&self) -> Tier {
        match self.exact {
            None => Tier::Filter,
            Some(Exact::Fixed(_)) => Tier::Fixed,
            Some(Exact::Wide(_)) => Tier::Wide,
            Some(Exact::Unbounded(_)) => Tier::Unbounded,
        }
    }

    /// On which sides of A's plane the corners of B are; all zero where A has no plane.
    pub(super) fn sides_of_a(&mut self) -> [Sign; 3] {
        let [p, q, r] = self.a;
        let (u, v) = (filter::difference(q, p), filter::difference(r, p));
        let ws = self.image_b.each_ref().map(|corner| filter::difference(corner, p));
        let certain = filter::signs(&u, &v, &ws, &Errors { u: &NO_ERROR, v: &NO_ERROR, w: &self.image_error });
        std::array::from_fn(|j| certain[j].unwrap_or_else(|| self.exact_orient3d(0, 1, 2, 3 + j)))
    }

    /// On which sides of B's plane the corners of A are; all zero where B has no plane.
    pub(super) fn sides_of_b(&mut self) -> [Sign; 3] {
        let [p, q, r] = &self.image_b;
        let (u, v) = (filter::difference(q, p), filter::difference(r, p));
        let ws = self.a.each_ref().map(|corner| filter::difference(corner, p));
        let twice = self.image_error.map(|error| 2.0 * error);
        let certain = filter::signs(&u, &v, &ws, &Errors { u: &twice, v: &twice, w: &self.image_error });
        std::array::from_fn(|i| certain[i].unwrap_or_else(|| self.exact_orient3d(3, 4, 5, i)))
    }

    /// The orientation of an edge of A, from corner `a0` to `a1`, and one of B, from its corner `b0` to `b1`; corners
    /// of either count from zero.
    pub(super) fn edges(&mut self, [a0, a1]: [usize; 2], [b0, b1]: [usize; 2]) -> Sign {
        let u = filter::difference(&self.a[a1], &self.a[a0]);
        let v = filter::difference(&self.image_b[b1], &self.image_b[b0]);
        let w = filter::difference(&self.image_b[b0], &self.a[a0]);
        let twice = self.image_error.map(|error| 2.0 * error);
        let [certain] = filter::signs(&u, &v, &[w], &Errors { u: &NO_ERROR, v: &twice, w: &self.image_error });
        // det(u, w, v + w) = -det(u, v, w).
        certain.map_or_else(|| self.exact_orient3d(a0, a1, 3 + b0, 3 + b1), |sign| -sign)
    }

    /// The orientation of three corners in the projection along an axis of the exact frame.
    pub(super) fn orient2d(&mut self, axis: usize, p: usize, q: usize, r: usize) -> Sign {
        self.exact().orient2d(axis, [p, q, r])
    }

    /// How corner `p` compares to corner `q` along an axis of the exact frame.
    pub(super) fn compare(&mut self, axis: usize, p: usize, q: usize) -> Sign {
        self.exact().compare(axis, [p, q])
    }

    /// The sign of `det(q - p, r - p, s - p)` in A's frame.
    fn exact_orient3d(&mut self, p: usize, q: usize, r: usize, s: usize) -> Sign {
        // The exact frame is A's own, or the world, which A's pose may have mirrored.
        let mirrored = !self.placement.is_shared() && self.placement.world_from_a().mirrors();
        self.exact().orient3d([p, q, r, s]).negated_if(mirrored)
    }

    fn exact(&mut self) -> &dyn ExactPoints {
        let (placement, a, b) = (self.placement, self.a, self.b);
        let exact = self.exact.get_or_insert_with(|| {
            if let Some(points) = FixedPoints::new(placement.frame(), a, b) {
                return Exact::Fixed(points);
            }
            match WidePoints::new(placement, a, b) {
                Some(points) => Exact::Wide(points),
                None => Exact::Unbounded(Box::new(UnboundedPoints::new(placement, a, b))),
            }
        });
        match exact {
            Exact::Fixed(points) => points,
            Exact::Wide(points) => points,
            Exact::Unbounded(points) => &**points,
        }
    }
}
