//! How deep two shapes are in each other: the length of the shortest translation that parts them, as a proved interval.
//!
//! For any direction n, moving B along n by the height of the set of differences along n parts the cores: the upper bound, for
//! a normal that is therefore always valid. A polytope inscribed in the set of differences holds a ball about the
//! origin as large as its nearest facet is far: the lower bound. Facets are pushed outwards, those first that are nearest,
//! until both meet.
//!
//! The inscribed polytope is that of `expand`, as long as the origin is inside. Else it is a [`Hull`], built anew for each round
//! from all the points so far. That is exact for any points, so nothing can be inverted or left open however flat it is; and it
//! has a kind, so a set that has grown to a segment only, or has no volume at all, is searched across itself.
//!
//! # Source
//! See `expand`. Ours departs in the exact hull where floats do not do, and in the interval.

use super::around::about_origin;
use super::boxes::Boxes;
use super::core_depth::CoreDepth;
use super::distance::{above, below, world_bounds};
use super::expand::Polytope;
use super::facet::Facet;
use super::gjk::{Gap, gap, means};
use super::posed::{Difference, Pair, Swept, to_unit_entries, to_unit_length};
use super::simplex;
use crate::hull::{Hull, HullKind};
use crate::math::vec3::{cross, dot, length};

/// The most hulls that are built. Those of polytopes without a volume need some 3 to 8.
const ROUNDS: usize = 24;

/// Facets that are pushed in one round: those nearest, of which each costs two supports while the round costs a hull.
const PUSHED: usize = 16;

/// The width of an interval, in the common unit, that is not worth another round: 2^-46.
const NARROW: f64 = 64.0 * f64::EPSILON;

/// An interval of polytopes that is wider than this, in the common unit, was left by a polytope that rounding has bent, or by a
/// set without a volume: 2^-43. Exact hulls narrow it, at some ten times the price.
pub(super) const BENT: f64 = 1.0 / (1_u64 << 43) as f64;

/// When an interval is good enough.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// The width, in the common unit, that is not worth another step.
    narrow: f64,
    /// The most points of the expanding polytope. Boxes and small hulls end with some 10; round cores keep the interval that they
    /// have by then.
    most_points: usize,
    /// Whether exact hulls go on where the polytope of round cores has proved nothing.
    is_thorough: bool,
}

impl Effort {
    /// For a depth of polytopes, which is that of a facet in the end.
    pub(super) const DEPTH: Self = Self { narrow: NARROW, most_points: 320, is_thorough: true };

    /// For a depth of anything round. What rounding leaves of an interval is up to 2^-44 wide, which more steps do not narrow: they are
    /// three or four for each two digits before, and would be hundreds. 2^-40.
    pub(super) const ROUND_DEPTH: Self = Self { narrow: 1.0 / (1_u64 << 40) as f64, ..Self::DEPTH };

    /// For the normal of a contact, which the next step of a simulation finds anew; where it is deep, this may be too little.
    pub(super) const CONTACT: Self = Self { narrow: 1.0 / (1 << 24) as f64, most_points: 64, is_thorough: false };
}

/// What is proved of the depth of two shapes that meet, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Depth {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) normal: [f64; 3],
    /// The points of A that is deepest in B, and of B that is deepest in A, along the normal.
    pub(crate) points: [[f64; 3]; 2],
}

/// A depth, and the points of the cores, in the common frame, whose difference it is nearly.
pub(super) struct CoreWitness {
    pub(super) depth: Depth,
    pub(super) core: [[f64; 3]; 2],
}

/// The depth of two shapes; meaningful for any two, and zero at the lower end where they may be apart.
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
    let of_boxes = Boxes::of(pair).and_then(|boxes| boxes.depth(effort.narrow.max(BENT)));
    let (core, apart) = of_boxes.map_or_else(|| by_iteration(pair, effort), |core| (core, 0.0));
    let [inside, height] = [core.lower * pair.unit, core.upper * pair.unit];
    let lower = if inside > 0.0 { below(inside + below(sum(0))) } else { below(below(sum(0)) - apart).max(0.0) };
    let normal = to_unit_length(core.direction);
    let world = core.points.map(|point| pair.world(point));
    let points = [
        std::array::from_fn(|k| world[0][k] + normal[k] * a.radius[0]),
        std::array::from_fn(|k| world[1][k] - normal[k] * b.radius[0]),
    ];
    let depth = Depth { lower, upper: above(height + above(sum(1))).max(lower), normal, points };
    CoreWitness { depth, core: core.points }
}

/// What is proved of the cores, and how far they may be apart, in world units.
pub(super) fn by_iteration(pair: &Pair<'_>, effort: Effort) -> (CoreDepth, f64) {
    let gap = gap(pair);
    let [_, apart] = world_bounds(&gap, pair);
    let core = if gap.lower > 0.5 * gap.upper { of_apart(pair, &gap) } else { expand(pair, &gap, effort) };
    (core, apart)
}

/// Cores that are apart: the deepest points of the shapes are around the nearest of the cores.
fn of_apart(pair: &Pair<'_>, gap: &Gap) -> CoreDepth {
    let upper = Push::along(pair, gap.direction).height;
    CoreDepth { lower: -gap.upper, upper, direction: gap.direction, points: gap.points }
}

/// A direction, what is farthest along it, and how far no difference is beyond.
struct Push {
    farthest: Difference,
    height: f64,
}

impl Push {
    fn along(pair: &Pair<'_>, direction: [f64; 3]) -> Self {
        let farthest = pair.support(direction);
        let height = dot(&direction, &farthest.a.point) - dot(&direction, &farthest.b.point);
        Self { farthest, height: above((height + pair.height_error(direction)) / length(&direction)) }
    }
}

/// A direction to push along, and a facet's corners where it is across one.
struct Candidate {
    lower: f64,
    direction: [f64; 3],
    face: Option<[usize; 3]>,
}

fn expand(pair: &Pair<'_>, gap: &Gap, effort: Effort) -> CoreDepth {
    let mut best = CoreDepth { lower: 0.0, upper: f64::INFINITY, direction: [1.0, 0.0, 0.0], points: gap.points };
    let mut known: Vec<Difference> = gap.simplex.to_vec();
    for direction in both_ways(&AXES) {
        offer(pair, &mut best, &mut known, &Candidate { lower: 0.0, direction, face: None });
    }
    let polytope = about_origin(pair, &gap.simplex);
    let is_flat = polytope.is_none();
    if let Some(polytope) = polytope {
        grow(pair, polytope, &mut best, effort);
    }
    let is_open = match (pair.a.corners(), pair.b.corners()) {
        (Some(_), Some(_)) => best.upper - best.lower > BENT,
        _ => best.lower == 0.0 && best.upper > NARROW && (is_flat || effort.is_thorough),
    };
    if is_open {
        by_hulls(pair, known, &mut best);
    }
    if best.lower == 0.0 {
        // They only touch, as far as is known: nowhere else than where they are nearest.
        best.points = gap.points;
    }
    best
}

/// Grows a polytope until its nearest facet is one of the set's, or no more is to be gained.
fn grow(pair: &Pair<'_>, mut polytope: Polytope, best: &mut CoreDepth, effort: Effort) {
    while let Some(nearest) = polytope.nearest() {
        // What an earlier polytope held, the set holds.
        best.lower = best.lower.max(nearest.lower - pair.point_error());
        let push = Push::along(pair, nearest.direction);
        if push.height < best.upper {
            (best.upper, best.direction) = (push.height, nearest.direction);
        }
        if best.upper - best.lower <= effort.narrow || !polytope.grow(&nearest, push.farthest, effort.most_points) {
            break;
        }
    }
    if best.lower > 0.0
        && let Some(points) = polytope.points_along(&best.direction)
    {
        best.points = points;
    }
}

/// Looks along a direction, and keeps what it finds.
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

/// Grows exact hulls of all points so far, which have a kind, and so are grown across themselves where they have no volume.
fn by_hulls(pair: &Pair<'_>, mut known: Vec<Difference>, best: &mut CoreDepth) {
    for _ in 0..ROUNDS {
        let vectors: Vec<[f64; 3]> = known.iter().map(|difference| difference.vector).collect();
        let Ok(hull) = Hull::new(&vectors) else { break };
        let mut candidates = candidates(&hull, &vectors);
        candidates.sort_by(|x, y| x.lower.total_cmp(&y.lower));
        best.lower =
            candidates.first().map_or(best.lower, |nearest| best.lower.max(nearest.lower - pair.point_error()));
        if best.upper - best.lower <= NARROW {
            break;
        }
        let before = known.len();
        // One facet may have the best height already and be no farther: then its points are the better ones.
        for candidate in
            candidates.iter().filter(|candidate| candidate.lower < best.upper).take(PUSHED).collect::<Vec<_>>()
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

/// The directions in which the hull of the differences is to grow, each with how far the hull reaches about the origin at
/// least. A hull without a volume grows across itself.
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

/// The points of A and of B whose difference is nearest to the origin among the hull of some.
fn foot(corners: &[Difference]) -> [[f64; 3]; 2] {
    let vectors: Vec<[f64; 3]> = corners.iter().map(|difference| difference.vector).collect();
    means(corners, &simplex::nearest(&vectors).weights)
}
