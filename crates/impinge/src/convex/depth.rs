//! Penetration depth of two shapes: the length of the shortest translation that separates them, as
//! a proved interval.
//!
//! For any direction n, moving B along n by the height of the set of differences along n separates
//! the cores. That gives the upper bound, with a normal that is therefore always valid. A polytope
//! inscribed in the set of differences holds a sphere about the origin whose radius is the distance
//! of its nearest facet. That gives the lower bound. The nearest facets are pushed outwards first,
//! until both bounds agree.
//!
//! The inscribed polytope is the one of `expand` as long as the origin is inside. Otherwise it is a
//! [`Hull`], built anew in each round from all points so far. A hull is exact for any points, so no
//! facet can be inverted or undecided, however flat the set is. A hull also has a kind: if it is
//! only a segment or has no volume, the search goes on perpendicular to it.
//!
//! # Source
//! See `expand`. Ours departs in the exact hull, used if floats are not enough, and in the
//! interval.
//!
//! The proof is docs/notes/proof.md, L22. The tests are in `tests/it/shapes`.

use super::around::about_origin;
use super::closed;
use super::core_depth::CoreDepth;
use super::descent::descend;
use super::distance::world_bounds;
use super::expand::Polytope;
use super::facet::Facet;
use super::gjk::{Gap, gap, means};
use super::interval::{above, below};
use super::posed::{Difference, Pair, Swept, to_unit_entries, to_unit_length};
use super::push::Push;
use super::simplex;
use crate::exact::world_point;
use crate::hull::{Hull, HullKind};
use crate::math::dyadic::{self, Dyadic};
use crate::math::vec3::cross;
use crate::math::{Pose, Sign};

/// Maximum number of hulls that are built. Polytopes without volume need about 3 to 8.
const MAX_HULL_ROUNDS: usize = 24;

/// Maximum number of facets that are pushed in one round, the nearest first. Each costs two
/// supports, and the round costs one hull.
const MAX_PUSHED_FACETS: usize = 16;

/// Width of an interval, in the common unit, below which another round is not worth its cost:
/// 2^-46.
const TARGET_WIDTH: f64 = 64.0 * f64::EPSILON;

/// Width of an interval for polytopes, in the common unit, above which exact hulls are tried:
/// 2^-43. A wider interval comes from a polytope that rounding has bent, or from a set without
/// volume. Exact hulls cost about 10 times as much.
pub(super) const HULL_FALLBACK_WIDTH: f64 = 1.0 / (1_u64 << 43) as f64;

/// Gain of a step, relative to the smaller set, below which a local search ends: 2^-24. The error
/// of a smooth shape's normal is then about 2^-12, the square root of that. A smaller value costs
/// steps.
const DESCENT_ACCURACY: f64 = 1.0 / (1 << 24) as f64;

/// Stopping rule of the depth computation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Width of the interval, in the common unit, at which the computation stops.
    target_width: f64,
    /// Maximum number of points of the expanding polytope. Boxes and small hulls end with about 10.
    /// Round cores keep the interval that they have at this number.
    max_points: usize,
    /// Whether exact hulls continue after the polytope of round cores has proved nothing.
    is_thorough: bool,
    /// Size of the smaller set in the common unit, if a local search improves the direction of the
    /// depth. Otherwise `None`.
    descent: Option<f64>,
}

impl Effort {
    /// For the depth of polytopes, which ends at the depth of a facet.
    pub(super) const DEPTH: Self =
        Self { target_width: TARGET_WIDTH, max_points: 320, is_thorough: true, descent: None };

    /// For the depth of round shapes. Rounding leaves an interval up to 2^-44 wide, which more
    /// steps do not narrow. Before that, three or four steps give two digits; beyond it, hundreds
    /// would be needed. The width is 2^-40.
    pub(super) const ROUND_DEPTH: Self = Self { target_width: 1.0 / (1_u64 << 40) as f64, ..Self::DEPTH };

    /// For the normal of a contact of polytopes, which the next step of a simulation computes anew.
    const CONTACT: Self =
        Self { target_width: 1.0 / (1 << 24) as f64, max_points: 64, is_thorough: false, descent: None };

    /// For the normal of a contact of other cores. Narrowing the interval takes many points: 18 for
    /// cylinders and 34 for ellipsoids to 2^-13, but 23 and 59 to 2^-24. So a local search, whose
    /// steps cost a fifth of a point, takes over at 2^-14.
    const ROUND_CONTACT: Self =
        Self { target_width: 1.0 / (1 << 14) as f64, max_points: 128, is_thorough: false, descent: Some(1.0) };

    /// Returns the accuracy of the upper bound that the computation aims for, in the common unit.
    fn accuracy(&self) -> f64 {
        self.descent.map_or(self.target_width, |size| DESCENT_ACCURACY * size)
    }

    /// Returns the effort for the normal of a contact of two sets, of which the smaller one has
    /// this size in the common unit.
    pub(super) fn for_contact(pair: &Pair<'_>, size: f64) -> Self {
        let are_polytopes = pair.a.corners().is_some() && pair.b.corners().is_some();
        let relative = if are_polytopes { Self::CONTACT } else { Self::ROUND_CONTACT };
        let target_width = (relative.target_width * size).max(TARGET_WIDTH);
        Self { target_width, descent: relative.descent.map(|relative| relative * size), ..relative }
    }
}

/// Bounds on the depth of two intersecting shapes, in world units. The shapes are apart after B has
/// moved by more than `upper` along `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Depth {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) normal: [f64; 3],
    /// The point of A deepest in B and the point of B deepest in A, along the normal, in the world
    /// frame.
    pub(crate) points: [[f64; 3]; 2],
}

/// A depth, and the points of the cores in the common frame whose difference approximates it.
pub(super) struct CoreWitness {
    pub(super) depth: Depth,
    pub(super) core: [[f64; 3]; 2],
}

/// Returns the depth of two shapes. It is meaningful for any two; the lower end is zero if they may
/// be disjoint.
pub(crate) fn depth(a: &Swept<'_>, b: &Swept<'_>) -> Depth {
    let are_polytopes = a.core.corners().is_some() && b.core.corners().is_some();
    let effort = if are_polytopes { Effort::DEPTH } else { Effort::ROUND_DEPTH };
    if a.is_before(b) {
        return depth_in_order(&Pair::new(a, b), a, b, effort).depth;
    }
    let mut found = depth_in_order(&Pair::new(b, a), b, a, effort).depth;
    found.points.swap(0, 1);
    found.normal = found.normal.map(|x| 0.0 - x);
    found
}

pub(super) fn depth_in_order(pair: &Pair<'_>, a: &Swept<'_>, b: &Swept<'_>, effort: Effort) -> CoreWitness {
    let sum = |end: usize| a.radius[end] + b.radius[end];
    let width = effort.accuracy().max(HULL_FALLBACK_WIDTH) * pair.unit;
    let (core, apart) = match closed::depth(a, b, width) {
        Some(closed::Depth { core, apart }) => (core.scaled(1.0 / pair.unit), apart),
        None => by_iteration(pair, effort),
    };
    let [inside, height] = [core.lower * pair.unit, core.upper * pair.unit];
    let lower = if inside > 0.0 { below(inside + below(sum(0))) } else { below(below(sum(0)) - apart).max(0.0) };
    let normal = to_unit_length(core.direction);
    let world = core.points.map(|point| pair.world(point));
    let points = [
        std::array::from_fn(|k| world[0][k] + normal[k] * a.radius[0]),
        std::array::from_fn(|k| world[1][k] - normal[k] * b.radius[0]),
    ];
    let mut upper = above(height + above(sum(1))).max(lower);
    if lower == 0.0 && upper <= pair.unit * MAX_TOUCHING_DEPTH && sum(1) == 0.0 && only_touch(a, b, &core.direction) {
        upper = 0.0;
    }
    let depth = Depth { lower, upper, normal, points };
    CoreWitness { depth, core: core.points }
}

/// Upper bound of a depth, in the common unit, up to which polytopes may only touch: 2^-40.
const MAX_TOUCHING_DEPTH: f64 = 1.0 / (1_u64 << 40) as f64;

/// Reports whether no corner of a polytope is beyond a corner of another one along a direction,
/// exactly. Then their interiors have no common point.
fn only_touch(a: &Swept<'_>, b: &Swept<'_>, direction: &[f64; 3]) -> bool {
    let (Some(corners_a), Some(corners_b)) = (a.core.corners(), b.core.corners()) else { return false };
    if *direction == [0.0; 3] {
        return false;
    }
    let direction = direction.map(Dyadic::from_f64);
    let height = |pose: &Pose, corner: &[f64; 3]| dyadic::dot(&direction, &world_point(pose, corner));
    let greater = |x: Dyadic, y: Dyadic| if (&y - &x).sign() == Sign::Positive { y } else { x };
    let highest = corners_a.iter().map(|corner| height(a.pose, corner)).reduce(greater);
    let Some(highest) = highest else { return false };
    corners_b.iter().all(|corner| (&height(b.pose, corner) - &highest).sign() != Sign::Negative)
}

/// Returns the bounds for the cores, and the largest distance that they may have, in world units.
pub(super) fn by_iteration(pair: &Pair<'_>, effort: Effort) -> (CoreDepth, f64) {
    let gap = gap(pair);
    let [_, apart] = world_bounds(&gap, pair);
    let core = if gap.lower > 0.5 * gap.upper { of_apart(pair, &gap) } else { expand(pair, &gap, effort) };
    (core, apart)
}

/// Returns the bounds for cores that are apart. The deepest points of the shapes are near the
/// nearest points of the cores.
fn of_apart(pair: &Pair<'_>, gap: &Gap) -> CoreDepth {
    let upper = Push::along(pair, gap.direction).height;
    CoreDepth { lower: -gap.upper, upper, direction: gap.direction, points: gap.points }
}

/// A direction to push along, and the corners of the facet that it is normal to, if there is one.
struct Candidate {
    lower: f64,
    direction: [f64; 3],
    face: Option<[usize; 3]>,
}

fn expand(pair: &Pair<'_>, gap: &Gap, effort: Effort) -> CoreDepth {
    let mut best = CoreDepth { lower: 0.0, upper: f64::INFINITY, direction: [1.0, 0.0, 0.0], points: gap.points };
    let mut known = Vec::with_capacity(gap.simplex.len() + 2 * AXES.len());
    known.extend_from_slice(&gap.simplex);
    for direction in both_ways(&AXES) {
        offer(pair, &mut best, &mut known, &Candidate { lower: 0.0, direction, face: None });
    }
    let polytope = about_origin(pair, &gap.simplex);
    let is_flat = polytope.is_none();
    if let Some(polytope) = polytope {
        grow(pair, polytope, &mut best, effort);
    }
    let needs_hulls = match (pair.a.corners(), pair.b.corners()) {
        (Some(_), Some(_)) => best.upper - best.lower > HULL_FALLBACK_WIDTH,
        _ => best.lower == 0.0 && best.upper > TARGET_WIDTH && (is_flat || effort.is_thorough),
    };
    if needs_hulls {
        by_hulls(pair, known, &mut best);
    }
    if best.lower == 0.0 {
        // As far as is known the cores only touch, so the points are the nearest ones.
        best.points = gap.points;
    }
    best
}

/// Grows a polytope until its nearest facet belongs to the set of differences, or no more is
/// gained.
fn grow(pair: &Pair<'_>, mut polytope: Polytope, best: &mut CoreDepth, effort: Effort) {
    while let Some(nearest) = polytope.nearest() {
        // The set holds every polytope that an earlier step had.
        best.lower = best.lower.max(nearest.lower - pair.point_error());
        let push = Push::along(pair, nearest.direction);
        if push.height < best.upper {
            (best.upper, best.direction) = (push.height, nearest.direction);
        }
        if best.upper - best.lower <= effort.target_width || !polytope.grow(&nearest, push.farthest, effort.max_points)
        {
            break;
        }
    }
    if best.lower > 0.0
        && let Some((corners, points)) = polytope.along(&best.direction)
    {
        best.points = points;
        if let Some(size) = effort.descent
            && best.upper - best.lower > effort.accuracy()
        {
            descend(pair, &corners, best, size, effort.accuracy());
        }
    }
}

/// Computes the support along a direction, and keeps it if it improves the bounds.
fn offer(pair: &Pair<'_>, best: &mut CoreDepth, known: &mut Vec<Difference>, candidate: &Candidate) {
    let push = Push::along(pair, candidate.direction);
    if push.height < best.upper {
        (best.upper, best.direction) = (push.height, candidate.direction);
        let corners: Vec<Difference> = match candidate.face {
            Some(face) => face.map(|corner| known[corner]).to_vec(),
            None => vec![push.farthest],
        };
        best.points = foot(&corners);
    }
    if !known.iter().any(|difference| difference.vector == push.farthest.vector) {
        known.push(push.farthest);
    }
}

/// Grows exact hulls of all points so far. A hull without volume grows perpendicular to itself.
fn by_hulls(pair: &Pair<'_>, mut known: Vec<Difference>, best: &mut CoreDepth) {
    for _ in 0..MAX_HULL_ROUNDS {
        let vectors: Vec<[f64; 3]> = known.iter().map(|difference| difference.vector).collect();
        let Ok(hull) = Hull::new(&vectors) else { break };
        let mut candidates = candidates(&hull, &vectors);
        candidates.sort_by(|x, y| x.lower.total_cmp(&y.lower));
        best.lower =
            candidates.first().map_or(best.lower, |nearest| best.lower.max(nearest.lower - pair.point_error()));
        if best.upper - best.lower <= TARGET_WIDTH {
            break;
        }
        let before = known.len();
        // If a facet already has the best height, its points are the better ones.
        for candidate in candidates
            .iter()
            .filter(|candidate| candidate.lower < best.upper)
            .take(MAX_PUSHED_FACETS)
            .collect::<Vec<_>>()
        {
            offer(pair, best, &mut known, candidate);
        }
        if known.len() == before {
            break;
        }
    }
}

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn both_ways(directions: &[[f64; 3]]) -> impl Iterator<Item = [f64; 3]> {
    directions.iter().flat_map(|direction| [*direction, direction.map(|x| -x)])
}

/// Returns the directions in which the hull of the differences is to grow, each with a lower bound
/// on the hull's reach about the origin. A hull without volume grows perpendicular to itself.
fn candidates(hull: &Hull, vectors: &[[f64; 3]]) -> Vec<Candidate> {
    let faces = hull.faces().iter().filter_map(|face| {
        let face = face.map(|corner| hull.vertices()[corner as usize] as usize);
        let facet = Facet::of(&vectors[face[0]], &vectors[face[1]], &vectors[face[2]])?;
        let lower = if hull.kind() == HullKind::Solid { facet.lower } else { 0.0 };
        Some(Candidate { lower, direction: facet.direction, face: Some(face) })
    });
    let across = match (hull.kind(), hull.positions()) {
        (HullKind::Solid | HullKind::Polygon, _) => Vec::new(),
        (HullKind::Segment, [from, to]) => {
            let along = to_unit_entries(std::array::from_fn(|k| to[k] - from[k]));
            let least = (0..3).min_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs())).unwrap_or(0);
            let first = cross(&along, &AXES[least]);
            vec![to_unit_entries(first), to_unit_entries(cross(&along, &first))]
        }
        _ => AXES.to_vec(),
    };
    let across =
        both_ways(&across).map(|direction| Candidate { lower: 0.0, direction, face: None }).collect::<Vec<_>>();
    faces.chain(across).collect()
}

/// Returns the points of A and of B whose difference is nearest to the origin in the hull of the
/// given differences.
fn foot(corners: &[Difference]) -> [[f64; 3]; 2] {
    let vectors: Vec<[f64; 3]> = corners.iter().map(|difference| difference.vector).collect();
    means(corners, &simplex::nearest(&vectors).weights)
}
