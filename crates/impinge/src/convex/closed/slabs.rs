//! How deep the origin is in a set of differences: intersection and depth of cores of which one is
//! a box, or of two segments that cross.
//!
//! The set is a zonotope, and each of its facets is perpendicular to the cross product of two half
//! edges. The cores are disjoint if the origin is outside along one of these directions, and they
//! intersect if it is inside along all. The nearest facet gives the depth. Whatever is not certain
//! in floats, for example if edges are nearly parallel, is undecided.
//!
//! # Source
//! Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996, for the fifteen axes of two boxes; McMullen,
//! *On zonotopes*, Transactions of the AMS 159, 1971, for the proof that they are enough. Ours
//! departs in affine maps, in an error bound for each direction (docs/notes/proof.md, L33), and in
//! the points.

use super::differences::{Differences, Gap};
use crate::convex::core_depth::CoreDepth;
use crate::convex::gjk::SLACK;
use crate::convex::posed::{Core, Swept, to_unit_length};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{Vector, cross, dot, length};
use crate::volume::Proximity;

/// Largest cosine of the angle between a half edge and a direction that count as perpendicular:
/// 2^-40.
const PERPENDICULAR_COSINE: f64 = 1.0 / (1_u64 << 40) as f64;

/// Maximum distance of the returned points from their exact relation, relative to the sizes: 2^-37.
/// Points with a larger error are discarded.
const MAX_POINT_ERROR: f64 = 1.0 / (1_u64 << 37) as f64;

/// Maximum number of sweeps over the free half edges. One is enough if the facet is made of a face
/// of one box and a corner of the other core.
const MAX_SWEEPS: usize = 32;

/// Pairs of half edges of a segment or a point and a box, or of two segments.
const PAIRS: [[usize; 2]; 6] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];

/// The slabs of a set of differences.
pub(super) struct Slabs<'d> {
    differences: &'d Differences,
    /// Length of each half edge of a box. For a segment, the sum over the axes of the magnitudes of
    /// the terms of its half edge. Errors of products with the half edge are relative to it.
    sizes: [f64; 6],
    shapes: [&'d Swept<'d>; 2],
    /// Sum of all sizes, of the length of the center, and of a quarter of the extent.
    total: f64,
}

/// Slabs that were compared with the origin so far.
struct Compared {
    /// Whether the origin is certainly inside one of them.
    is_inside_one: bool,
    /// Whether it is certainly inside all of them.
    is_inside_all: bool,
}

impl Default for Compared {
    fn default() -> Self {
        Self { is_inside_one: false, is_inside_all: true }
    }
}

impl Compared {
    /// Adds a slab, and reports whether the origin is certainly outside. Parallel half edges have
    /// no slab; the product of exactly parallel ones is zero, so they never prove anything.
    #[inline(always)]
    fn is_apart(&mut self, height: f64, error: f64, are_parallel: impl Fn() -> bool) -> bool {
        if height > error {
            self.is_inside_one = true;
        } else if height < -error {
            return true;
        } else if !are_parallel() {
            self.is_inside_all = false;
        }
        false
    }

    /// Returns the answer if no slab proves the cores apart. If the origin is strictly inside one
    /// slab, the half edges span space.
    fn proximity(&self) -> Proximity {
        if self.is_inside_one && self.is_inside_all { Proximity::Intersects } else { Proximity::Undecided }
    }
}

impl<'d> Slabs<'d> {
    pub(super) fn of(differences: &'d Differences, shapes: [&'d Swept<'d>; 2]) -> Self {
        let count_a = differences.edges_of_each()[0].len();
        let mut sizes = [0.0; 6];
        for (at, edge) in differences.edges().iter().enumerate() {
            let swept = shapes[usize::from(at >= count_a)];
            sizes[at] = segment_size(swept).unwrap_or_else(|| length(edge));
        }
        let total = sizes.iter().sum::<f64>() + length(&differences.between) + 0.25 * differences.extent;
        Self { differences, sizes, shapes, total }
    }

    /// Reports whether the cores intersect, or that floats do not decide it.
    pub(super) fn proximity(&self) -> Proximity {
        let mut compared = Compared::default();
        let is_apart = !self.all_heights(|pair, height| {
            let error = self.off(pair) * self.total;
            !compared.is_apart(height, error, || self.are_parallel(pair))
        });
        if is_apart { Proximity::Apart } else { compared.proximity() }
    }

    /// Calls `visit` with all pairs of half edges whose product may be the normal of a facet, and
    /// with the height of the set along that product. Ends as soon as `visit` returns `false`, and
    /// then returns `false`.
    #[inline(always)]
    fn all_heights(&self, mut visit: impl FnMut([usize; 2], f64) -> bool) -> bool {
        match self.differences.edges() {
            &[p, q, r, x, y, z] => self.all_heights_of_boxes(&[p, q, r], &[x, y, z], visit),
            edges => self.pairs().iter().all(|&pair| visit(pair, self.height(pair, edges))),
        }
    }

    /// Does the same for two boxes. Two half edges of one box and one of the other make a product
    /// that is the height of a half edge along two directions, so most are computed once. The face
    /// normals come first because they separate most disjoint boxes.
    #[inline(always)]
    fn all_heights_of_boxes(
        &self,
        a: &[Vector; 3],
        b: &[Vector; 3],
        mut visit: impl FnMut([usize; 2], f64) -> bool,
    ) -> bool {
        const NEXT: [usize; 3] = [1, 2, 0];
        const AFTER: [usize; 3] = [2, 0, 1];
        let between = &self.differences.between;
        let normals = |edges: &[Vector; 3]| [0, 1, 2].map(|k| cross(&edges[NEXT[k]], &edges[AFTER[k]]));
        let heights = |normals: &[Vector; 3], edges: &[Vector; 3]| {
            normals.map(|normal| edges.map(|edge| dot(&normal, &edge).abs()))
        };
        let [normals_a, normals_b] = [normals(a), normals(b)];
        let [of_b, of_a] = [heights(&normals_a, b), heights(&normals_b, a)];
        let sides = [(0, &normals_a, &of_b, a), (3, &normals_b, &of_a, b)];
        for (first, normals, others, edges) in sides {
            let own = dot(&normals[0], &edges[0]).abs();
            for k in 0..3 {
                let reach = own + (others[k][0] + others[k][1] + others[k][2]);
                let height = reach - dot(&normals[k], between).abs();
                if !visit([first + NEXT[k], first + AFTER[k]], height) {
                    return false;
                }
            }
        }
        for i in 0..3 {
            let turned = cross(between, &a[i]);
            for j in 0..3 {
                let reach = of_b[NEXT[i]][j] + of_b[AFTER[i]][j] + (of_a[NEXT[j]][i] + of_a[AFTER[j]][i]);
                if !visit([i, 3 + j], reach - dot(&turned, &b[j]).abs()) {
                    return false;
                }
            }
        }
        true
    }

    /// Returns the depth, or `None` if the interval is wider than `width`, or the cores are not
    /// proved to intersect.
    pub(super) fn depth(&self, width: f64) -> Option<CoreDepth> {
        let (mut lower, mut upper, mut direction) = (f64::INFINITY, f64::INFINITY, [0.0; 3]);
        let is_bounded = self.all_heights(|pair, height| {
            let (normal, off) = (self.normal(pair), self.off(pair));
            let (across, error) = (length(&normal), off * self.total);
            let least = (height - error) / (across + off);
            if least.is_nan() || least <= 0.0 || !across.is_normal() {
                // Parallel half edges have no slab. Their exact product is zero, so their height is
                // at most its error, and they always get here.
                return self.are_parallel(pair);
            }
            lower = lower.min(least * (1.0 - SLACK));
            let greatest = (height + error) / across;
            if greatest < upper {
                (upper, direction) = (greatest * (1.0 + SLACK), normal);
            }
            true
        });
        let is_narrow = is_bounded && upper - lower <= width;
        let direction = is_narrow.then(|| to_unit_length(self.towards_b(direction)))?;
        let points = self.points(&direction, 0.5 * (lower + upper))?;
        Some(CoreDepth { lower, upper, direction, points })
    }

    /// Returns the depth of two segments that cross, of which `gap` bounds the distance, or `None`
    /// if the interval is wider than `width`. The points are the nearest ones.
    pub(super) fn flat(&self, gap: &Gap, points: [Vector; 2], width: f64) -> Option<CoreDepth> {
        let pair = [0, 1];
        let (normal, error) = (self.normal(pair), self.off(pair) * self.total);
        let height = self.height(pair, self.differences.edges());
        let upper = (height + error) / length(&normal) * (1.0 + SLACK);
        let is_narrow = upper + gap.upper <= width;
        let direction = self.towards_b(normal);
        is_narrow.then_some(CoreDepth { lower: -gap.upper, upper, direction, points })
    }

    /// Returns the pairs of half edges of two cores that are not two boxes.
    fn pairs(&self) -> &'static [[usize; 2]] {
        match self.differences.count() {
            4 => &PAIRS,
            3 => &PAIRS[..3],
            _ => &PAIRS[..1],
        }
    }

    /// Returns the product of two half edges, which is perpendicular to both.
    #[inline]
    fn normal(&self, [one, other]: [usize; 2]) -> Vector {
        let edges = self.differences.edges();
        cross(&edges[one], &edges[other])
    }

    /// Returns the height of the set along the product of two half edges: the reach of all half
    /// edges less that of the center, times the length of the product.
    fn height(&self, pair: [usize; 2], edges: &[Vector]) -> f64 {
        let normal = self.normal(pair);
        let reach: f64 = edges.iter().map(|edge| dot(edge, &normal).abs()).sum();
        reach - dot(&self.differences.between, &normal).abs()
    }

    /// Returns a bound on the distance of a computed product of two half edges from the exact one.
    /// Times the total of the sizes, it bounds the error of a height along the product.
    ///
    /// A product of three half edges, or of two and the center, has an error of at most 7.5 u of
    /// the product of their sizes. Half edges are off by 4.1 u of their sizes. The sum of seven
    /// products is rounded six times: 26 u in all, taken as 28. The center is off by 6.2 u of the
    /// extent, for which a quarter of it is in the total (u = 2^-53).
    #[inline]
    fn off(&self, [one, other]: [usize; 2]) -> f64 {
        28.0 * UNIT_ROUNDOFF * self.sizes[one] * self.sizes[other]
    }

    /// Returns a normal or its opposite, whichever points from A to B.
    fn towards_b(&self, normal: Vector) -> Vector {
        if dot(&self.differences.between, &normal) < 0.0 { normal.map(|x| -x) } else { normal }
    }

    /// Reports whether half edges are proved to be exactly parallel, or one is zero. Returns
    /// `false` for all half edges that are not parallel.
    fn are_parallel(&self, [one, other]: [usize; 2]) -> bool {
        let count_a = self.differences.edges_of_each()[0].len();
        let direction = |at: usize| {
            if at < count_a {
                exact_direction(self.shapes[0], at)
            } else {
                exact_direction(self.shapes[1], at - count_a)
            }
        };
        let (Some(u), Some(v)) = (&direction(one), &direction(other)) else { return false };
        let is_multiple = u == v || *u == v.map(|x| -x);
        let vanishes = |i: usize, j: usize| u[i] == 0.0 || v[j] == 0.0;
        is_multiple || (0..3).all(|i| (0..3).all(|j| i == j || vanishes(i, j)))
    }

    /// Returns a point of each core, relative to the translation of A, such that their difference
    /// is `depth` along the normal of the nearest facet. The corner along the normal is known.
    /// Along the half edges perpendicular to it, the points move until they are over each other.
    /// Two such half edges have one solution, and more of them are moved in turn. Returns `None` if
    /// the points do not get there.
    fn points(&self, normal: &Vector, depth: f64) -> Option<[Vector; 2]> {
        let edges = self.differences.edges();
        let (mut shares, mut free) = ([0.0_f64; 6], [false; 6]);
        // The part of the difference that is still missing.
        let mut rest: Vector = std::array::from_fn(|k| self.differences.between[k] + normal[k] * depth);
        for (at, edge) in edges.iter().enumerate() {
            let along = dot(edge, normal);
            free[at] = along.abs() <= PERPENDICULAR_COSINE * length(edge);
            if !free[at] {
                shares[at] = -along.signum();
                rest = std::array::from_fn(|k| rest[k] + shares[at] * edge[k]);
            }
        }
        let mut perpendicular = (0..edges.len()).filter(|&at| free[at]);
        if let (Some(i), Some(j), None) = (perpendicular.next(), perpendicular.next(), perpendicular.next()) {
            let moves = solve(&edges[i], &edges[j], &rest).map(|share| share.clamp(-1.0, 1.0));
            (shares[i], shares[j]) = (moves[0], moves[1]);
            rest = std::array::from_fn(|k| rest[k] + moves[0] * edges[i][k] + moves[1] * edges[j][k]);
        }
        let max_error = MAX_POINT_ERROR * self.differences.extent;
        for _ in 0..MAX_SWEEPS {
            if length(&rest) <= max_error {
                break;
            }
            for (at, edge) in edges.iter().enumerate() {
                let squared = dot(edge, edge);
                if free[at] && squared > 0.0 {
                    let share = (shares[at] - dot(&rest, edge) / squared).clamp(-1.0, 1.0);
                    rest = std::array::from_fn(|k| rest[k] + (share - shares[at]) * edge[k]);
                    shares[at] = share;
                }
            }
        }
        (length(&rest) <= max_error).then(|| self.differences.points(&shares))
    }
}

/// Returns the multiples of two vectors whose sum is nearest to the opposite of a third, or zeros
/// if the two are parallel.
fn solve(u: &Vector, v: &Vector, rest: &Vector) -> [f64; 2] {
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let (along_u, along_v) = (dot(u, rest), dot(v, rest));
    let determinant = uu * vv - uv * uv;
    let shares = [uv * along_v - vv * along_u, uv * along_u - uu * along_v];
    if determinant > 0.0 { shares.map(|share| share / determinant) } else { [0.0; 2] }
}

/// Returns the sum, over the axes, of the magnitudes of the terms of a segment's half edge, or
/// `None` for a box.
fn segment_size(swept: &Swept<'_>) -> Option<f64> {
    let Core::Points([start, end]) = swept.core else { return None };
    let half: Vector = std::array::from_fn(|k| 0.5 * (end[k] - start[k]).abs());
    Some(swept.pose.linear().iter().map(|row| dot(&row.map(f64::abs), &half)).sum())
}

/// Returns the direction of a half edge as exact numbers, of any length: a column of the pose.
/// Returns zero if the half edge is a point, and `None` if no column has the direction.
fn exact_direction(swept: &Swept<'_>, at: usize) -> Option<Vector> {
    let column = |axis: usize| swept.pose.linear().map(|row| row[axis]);
    match swept.core {
        Core::Cuboid(corners) => Some(if corners.last()?[at] == 0.0 { [0.0; 3] } else { column(at) }),
        Core::Points([start, end]) => {
            let mut axes = (0..3).filter(|&axis| start[axis] != end[axis]);
            match (axes.next(), axes.next()) {
                (None, _) => Some([0.0; 3]),
                (Some(axis), None) => Some(column(axis)),
                _ => None,
            }
        }
        _ => None,
    }
}
