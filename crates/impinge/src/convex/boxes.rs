//! Intersection and depth in closed form for two boxes under affine maps.
//!
//! The set of differences of two parallelepipeds is the sum of six segments, moved by the
//! difference of the centers. It is a zonotope, and each of its facets is perpendicular to the
//! cross product of two of the segments. So fifteen directions are enough. The boxes are disjoint
//! if the origin is outside along one direction, and they intersect if it is inside along all. The
//! nearest facet gives the depth. Whatever is not certain in floats, for example if edges are
//! nearly parallel, is left to the iteration, which is also the oracle in the tests.
//!
//! # Source
//! Gottschalk, Lin, Manocha, *OBBTree*, SIGGRAPH 1996, for the fifteen axes; McMullen, *On
//! zonotopes*, Transactions of the AMS 159, 1971, for the proof that they are enough. Ours departs
//! in affine maps, in an error bound for each direction (docs/notes/proof.md, L33), and in the
//! points.
//!
//! The tests below guard this file, and the benchmark is `shapes` in `impinge-bench`.

use super::core_depth::CoreDepth;
use super::gjk::SLACK;
use super::posed::{Core, Pair, Posed, to_unit_length};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{dot, length, sub};
use crate::volume::Proximity;

/// Largest cosine of the angle between a segment and a direction that count as perpendicular:
/// 2^-40.
const PERPENDICULAR_COSINE: f64 = 1.0 / (1_u64 << 40) as f64;

/// Maximum distance of the returned points from their exact relation, in the common unit: 2^-36.
/// Points with a larger error are discarded, and the iteration takes over.
const MAX_POINT_ERROR: f64 = 1.0 / (1_u64 << 36) as f64;

/// Maximum number of sweeps over the free segments. One is enough if the facet is made of a face of
/// one box and a corner of the other.
const MAX_SWEEPS: usize = 32;

/// Two boxes in the common frame.
pub(super) struct Boxes<'p> {
    pair: &'p Pair<'p>,
    /// Half edges of A, then of B.
    edges: [Edge; 6],
    /// Vector from A's center to B's center.
    between: [f64; 3],
}

/// Half an edge of a box.
#[derive(Clone, Copy)]
struct Edge {
    vector: [f64; 3],
    /// Direction of the edge: an exact column of the pose, of any length.
    direction: [f64; 3],
    is_point: bool,
}

/// Direction perpendicular to two edges, and the depth of the origin in the set of differences
/// along it.
struct Slab {
    /// Normal towards B, of any length.
    normal: [f64; 3],
    height: f64,
    /// Bound on the error of the height along the normal.
    error: f64,
    /// Bound on the error of the height along the exact product of the edges, which differs from
    /// the normal by at most `off`.
    facet_error: f64,
    off: f64,
}

impl<'p> Boxes<'p> {
    /// Returns the two boxes in the common frame, or `None` if one core is not a box.
    pub(super) fn of(pair: &'p Pair<'p>) -> Option<Self> {
        let halves = [half_extents(&pair.a.core())?, half_extents(&pair.b.core())?];
        let edge = |set: &Posed<'_>, half: [f64; 3], axis: usize| {
            let direction = set.pose().linear().map(|row| row[axis]);
            Edge { vector: direction.map(|x| x * half[axis] / pair.unit), direction, is_point: half[axis] == 0.0 }
        };
        let edges =
            std::array::from_fn(
                |at| {
                    if at < 3 { edge(&pair.a, halves[0], at) } else { edge(&pair.b, halves[1], at - 3) }
                },
            );
        let centers = [&pair.a, &pair.b].map(|set| set.spot([0.0; 3]).point);
        Some(Self { pair, edges, between: sub(&centers[1], &centers[0]) })
    }

    /// Reports whether the boxes intersect, or that floats do not decide it.
    pub(super) fn proximity(&self) -> Proximity {
        let (mut facets, mut is_inside) = (0, true);
        for slab in self.slabs() {
            if slab.height < -slab.error {
                return Proximity::Apart;
            }
            is_inside &= slab.height > slab.facet_error;
            facets += 1;
        }
        // The condition on `facets` matters: if the origin is strictly inside one slab, the
        // segments span space.
        if is_inside && facets > 0 { Proximity::Intersects } else { Proximity::Undecided }
    }

    /// Returns the depth, or `None` if the interval is wider than `width`, in the common unit, or
    /// the boxes are not proved to intersect.
    pub(super) fn depth(&self, width: f64) -> Option<CoreDepth> {
        let (mut lower, mut upper, mut direction) = (f64::INFINITY, f64::INFINITY, [0.0; 3]);
        for slab in self.slabs() {
            let across = length(&slab.normal);
            let [least, greatest] =
                [(slab.height - slab.facet_error) / (across + slab.off), (slab.height + slab.error) / across];
            if least.is_nan() || least <= 0.0 || !across.is_normal() {
                return None;
            }
            lower = lower.min(least * (1.0 - SLACK));
            if greatest < upper {
                (upper, direction) = (greatest * (1.0 + SLACK), slab.normal);
            }
        }
        let is_narrow = upper - lower <= width;
        let points = is_narrow.then(|| self.points(&to_unit_length(direction), 0.5 * (lower + upper)))??;
        Some(CoreDepth { lower, upper, direction, points })
    }

    /// Iterates over the slabs of all facets of the set of differences. Exactly parallel edges have
    /// no slab.
    fn slabs(&self) -> impl Iterator<Item = Slab> {
        /// Pairs of edges. The face normals come first because they separate most disjoint boxes.
        const PAIRS: [[usize; 2]; 15] = [
            [0, 1],
            [1, 2],
            [2, 0],
            [3, 4],
            [4, 5],
            [5, 3],
            [0, 3],
            [0, 4],
            [0, 5],
            [1, 3],
            [1, 4],
            [1, 5],
            [2, 3],
            [2, 4],
            [2, 5],
        ];
        PAIRS.iter().filter_map(|pair| {
            let [one, other] = pair.map(|at| &self.edges[at]);
            (!are_parallel(one, other)).then(|| self.slab(&one.vector, &other.vector))
        })
    }

    fn slab(&self, u: &[f64; 3], v: &[f64; 3]) -> Slab {
        let (mut normal, mut off, mut facet_error) = ([0.0; 3], 0.0, 0.0);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (forward, backward) = (u[i] * v[j], u[j] * v[i]);
            normal[k] = forward - backward;
            let of_component = 6.0 * UNIT_ROUNDOFF * (forward.abs() + backward.abs()) + self.pair.underflow;
            off += of_component;
            facet_error += of_component * self.pair.extent[k];
        }
        let error = self.pair.height_error(normal);
        let reach: f64 = self.edges.iter().map(|edge| dot(&edge.vector, &normal).abs()).sum();
        let along = dot(&self.between, &normal);
        if along < 0.0 {
            normal = normal.map(|x| -x);
        }
        Slab { normal, height: reach - along.abs(), error, facet_error: error + facet_error, off }
    }

    /// Returns a point of each box, such that their difference is `depth` along the normal of the
    /// nearest facet. The corner along the normal is known. Along the edges perpendicular to it,
    /// the points move until they are over each other. Returns `None` if they do not get there.
    fn points(&self, normal: &[f64; 3], depth: f64) -> Option<[[f64; 3]; 2]> {
        let mut shares = [0.0_f64; 6];
        let mut free = [false; 6];
        // The part of the difference that is still missing.
        let mut rest: [f64; 3] = std::array::from_fn(|k| normal[k] * depth + self.between[k]);
        for (at, edge) in self.edges.iter().enumerate() {
            let along = dot(&edge.vector, normal);
            free[at] = along.abs() <= PERPENDICULAR_COSINE * length(&edge.vector);
            if !free[at] {
                shares[at] = along.signum();
                rest = std::array::from_fn(|k| rest[k] - shares[at] * edge.vector[k]);
            }
        }
        for _ in 0..MAX_SWEEPS {
            if length(&rest) <= MAX_POINT_ERROR {
                break;
            }
            for at in (0..6).filter(|&at| free[at] && !self.edges[at].is_point) {
                let edge = &self.edges[at].vector;
                let share = (shares[at] + dot(&rest, edge) / dot(edge, edge)).clamp(-1.0, 1.0);
                rest = std::array::from_fn(|k| rest[k] - (share - shares[at]) * edge[k]);
                shares[at] = share;
            }
        }
        // B's edges may be used in either direction, so the difference of the points is the sum
        // over all six edges.
        let sum = |from: usize, sign: f64, start: [f64; 3]| -> [f64; 3] {
            (from..from + 3)
                .fold(start, |sum, at| std::array::from_fn(|k| sum[k] + sign * shares[at] * self.edges[at].vector[k]))
        };
        let centers = [&self.pair.a, &self.pair.b].map(|set| set.spot([0.0; 3]).point);
        (length(&rest) <= MAX_POINT_ERROR).then(|| [sum(0, 1.0, centers[0]), sum(3, -1.0, centers[1])])
    }
}

/// Returns the half-extents of a core that is a box centered at its origin, or `None` for any other
/// core. The corners must be numbered by the sides that they are on.
fn half_extents(core: &Core<'_>) -> Option<[f64; 3]> {
    let Core::Points(corners @ [.., half]) = core else { return None };
    let is_there = |(at, corner): (usize, &[f64; 3])| {
        (0..3).all(|k| corner[k] == if at >> k & 1 == 1 { half[k] } else { -half[k] })
    };
    (corners.len() == 8 && corners.iter().enumerate().all(is_there)).then_some(*half)
}

/// Reports whether edges are proved to be exactly parallel, or one is a point. Returns `false` for
/// all edges that are not parallel.
fn are_parallel(one: &Edge, other: &Edge) -> bool {
    let (u, v) = (&one.direction, &other.direction);
    let is_multiple = u == v || *u == v.map(|x| -x);
    let vanishes = |i: usize, j: usize| u[i] == 0.0 || v[j] == 0.0;
    one.is_point || other.is_point || is_multiple || (0..3).all(|i| (0..3).all(|j| i == j || vanishes(i, j)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::depth::{self, Effort, HULL_FALLBACK_WIDTH};
    use crate::convex::distance;
    use crate::convex::posed::Swept;
    use crate::math::Pose;
    use impinge_testkit::generate::{Rng, poses};

    fn corners(half: [f64; 3]) -> [[f64; 3]; 8] {
        std::array::from_fn(|at| [0, 1, 2].map(|k| if at >> k & 1 == 1 { half[k] } else { -half[k] }))
    }

    /// Returns a tiny rotation about a random axis, to first order, which makes edges nearly
    /// parallel.
    fn nudge(rng: &mut Rng, angle: f64) -> [[f64; 3]; 3] {
        let [x, y, z] = [0; 3].map(|_| angle * rng.uniform(-1.0, 1.0));
        [[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]]
    }

    fn linear(rng: &mut Rng, kind: usize) -> [[f64; 3]; 3] {
        match kind {
            0 => poses::cube_symmetry(rng),
            1 => poses::rotation(rng).linear,
            2 => poses::large_integer_map(rng).linear,
            _ => nudge(rng, 10.0_f64.powi(-(kind as i32))),
        }
    }

    /// Boxes on grids: turned by quarters, by tiny angles and by random rotations, flat ones and
    /// sheared ones. Every certain answer must agree with the iteration and exact arithmetic, and
    /// depths must be equal.
    #[test]
    fn boxes_are_as_the_iteration_finds_them() {
        let mut rng = Rng::new(172);
        let mut proximities = [[0; 3]; 2];
        let (mut depths, mut asked) = (0, 0);
        for round in 0..12_000 {
            let kinds = [round % 3, [0, 1, 2, 3, 6, 9, 12, 15][round / 3 % 8]];
            let halves = [0; 2].map(|_| [0; 3].map(|_| [0.0, 0.5, 0.5, 1.0, 1.0, 2.0][rng.integer(0, 5) as usize]));
            let linears = kinds.map(|kind| linear(&mut rng, kind));
            let size = linears.as_flattened().as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
            let at = [0; 3].map(|_| size * rng.integer(-6, 6) as f64 * if rng.one_in(2) { 0.25 } else { 0.31 });
            let poses = [Pose::new(linears[0], [0.0; 3]).unwrap(), Pose::new(linears[1], at).unwrap()];
            let corners = halves.map(corners);
            let [a, b] = [0, 1].map(|i| Swept { core: Core::Points(&corners[i]), pose: &poses[i], radius: [0.0; 2] });
            let pair = Pair::new(&a, &b);
            let boxes = Boxes::of(&pair).expect("boxes");
            let truth = distance::by_iteration(&pair, [[0.0; 2]; 2], 0.0);
            let found = boxes.proximity();
            assert!(found == Proximity::Undecided || found == truth, "{a:?} {b:?}: {found:?}, not {truth:?}");
            proximities[usize::from(truth == Proximity::Intersects)][found as usize] += 1;
            asked += u32::from(truth == Proximity::Intersects);
            let Some(found) = boxes.depth(HULL_FALLBACK_WIDTH) else { continue };
            assert_eq!(truth, Proximity::Intersects);
            depths += 1;
            let (other, _) = depth::by_iteration(&pair, Effort::DEPTH);
            assert!(
                found.lower <= other.upper && other.lower <= found.upper,
                "{a:?} {b:?}: {} {}",
                found.lower,
                other.upper
            );
            let normal = to_unit_length(found.direction);
            let beyond = pair.support(normal);
            assert!((dot(&beyond.vector, &normal) - found.upper).abs() < 1e-12);
            let [p, q] = found.points;
            let off = sub(&sub(&p, &q), &normal.map(|x| x * found.upper));
            assert!(length(&off) < 1e-10, "{a:?} {b:?}: points {p:?} and {q:?}, {} along {normal:?}", found.upper);
            // Each point is within its box.
            for direction in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.3, 0.5, -0.7], normal, normal.map(|x| -x)] {
                assert!(dot(&p, &direction) <= dot(&pair.a.support(direction).point, &direction) + 1e-12);
                assert!(dot(&q, &direction) <= dot(&pair.b.support(direction).point, &direction) + 1e-12);
            }
        }
        // The undecided pairs touch, are flat in one plane, or are too near to that.
        let certain = |truth: usize, found: Proximity| {
            f64::from(proximities[truth][found as usize]) / f64::from(proximities[truth].iter().sum::<i32>())
        };
        assert!(certain(0, Proximity::Apart) > 0.95 && certain(1, Proximity::Intersects) > 0.6, "{proximities:?}");
        assert!(f64::from(depths) > 0.5 * f64::from(asked), "{depths} depths of {asked}");
    }

    #[test]
    fn cores_that_are_not_boxes_are_rejected() {
        let half = [1.0, 0.0, 3.0];
        assert_eq!(half_extents(&Core::Points(&corners(half))), Some(half));
        let mut other = corners(half);
        other.swap(1, 2);
        assert_eq!(half_extents(&Core::Points(&other)), None);
        assert_eq!(half_extents(&Core::Points(&corners(half)[..7])), None);
        assert_eq!(half_extents(&Core::Points(&[])), None);
    }
}
