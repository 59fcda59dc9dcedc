//! Closed forms for two shapes whose cores are points, segments or boxes, and for a point and a
//! triangle, a cylinder or a cone. A sphere is a point with a radius, a capsule a segment with a
//! radius, and any core may have the radius that its shape is rounded with.
//!
//! A core of the first kinds is its center plus multiples within ±1 of at most three half edges. So
//! the set of differences of two cores is a zonotope of at most six half edges. `differences`
//! computes it, `nearest` proposes its point nearest to the origin, and `slabs` finds how deep the
//! origin is inside. `around_point` has the other pairs, and `parallel` the depth of cylinders and
//! cones with parallel axes.
//!
//! A closed form only proposes: the interval of the distance is proved from the proposed point,
//! whatever that is. If the interval does not decide the query, or is wider than the iteration's,
//! the answer is `None`, and the iteration and exact arithmetic answer instead. They are also the
//! oracle in the tests.
//!
//! The proof is docs/notes/proof.md, L33, L35 and L47. The tests are in `closed/tests.rs`, and the
//! benchmark is `shapes` in `impinge-bench`.

mod around_point;
mod differences;
mod nearest;
mod parallel;
mod slabs;

use self::around_point::Found;
use self::differences::{Differences, Gap};
use self::nearest::nearest;
use self::slabs::Slabs;
use super::core_depth::CoreDepth;
use super::interval::{EXACT_DISTANCE_WIDTH, Separation, above, below};
use super::posed::{Core, Swept};
use crate::math::relative::UNIT_ROUNDOFF;
use crate::math::vec3::{Vector, add};
use crate::volume::Proximity;

/// Maximum width of an interval of depths, relative to the sizes: 2^-45. The iteration's is about
/// as wide.
const MAX_DEPTH_WIDTH: f64 = 256.0 * UNIT_ROUNDOFF;

/// Maximum width of an interval of the distance from a cylinder or a cone, relative to the sizes:
/// 2^-42. The iteration's is narrowed to 2^-40.
const MAX_TURNED_WIDTH: f64 = 2048.0 * UNIT_ROUNDOFF;

/// Maximum length of a proposed difference that counts as zero, relative to the sizes: 2^-44.
const COMMON_POINT: f64 = 512.0 * UNIT_ROUNDOFF;

/// Reports whether two shapes are within `clearance` of each other, in world units, or returns
/// `None` if closed forms do not decide it.
#[inline]
pub(super) fn nearness(a: &Swept<'_>, b: &Swept<'_>, clearance: f64) -> Option<Proximity> {
    if let Some(found) = around_point::found_of_points(a, b) {
        return decide([a, b], &found.gap, clearance);
    }
    let Some(differences) = Differences::between(a, b) else {
        return decide([a, b], &around_point::found(a, b)?.gap, clearance);
    };
    if differences.are_boxes() {
        let answer = Slabs::of(&differences, [a, b]).proximity();
        if answer == Proximity::Intersects || a.radius[1] + b.radius[1] + clearance == 0.0 {
            return (answer != Proximity::Undecided).then_some(answer);
        }
        return decide([a, b], &differences.gap(&nearest(&differences)?.vector), clearance);
    }
    let gap = differences.gap(&nearest(&differences)?.vector);
    decide([a, b], &gap, clearance).or_else(|| certainly_overlap(&differences, [a, b]).then_some(Proximity::Intersects))
}

/// Returns the distance of two shapes, or `None` if closed forms do not decide whether they
/// intersect, or exact arithmetic would give a narrower interval.
pub(super) fn separation(a: &Swept<'_>, b: &Swept<'_>) -> Option<Separation> {
    let of_points = around_point::found_of_points(a, b);
    let Some(differences) = of_points.is_none().then(|| Differences::between(a, b)).flatten() else {
        let found = of_points.or_else(|| around_point::found(a, b))?;
        let proximity = decide([a, b], &found.gap, 0.0)?;
        return separation_of([a, b], &found, proximity);
    };
    let nearest = nearest(&differences)?;
    let gap = differences.gap(&nearest.vector);
    let proximity = match decide([a, b], &gap, 0.0) {
        Some(proximity) => proximity,
        None if certainly_overlap(&differences, [a, b]) => Proximity::Intersects,
        None => return None,
    };
    let points = differences.points(&nearest.shares);
    separation_of([a, b], &Found { gap, vector: nearest.vector, points, extent: differences.extent }, proximity)
}

/// Returns the distance of two shapes, given that of their cores. Returns `None` if exact
/// arithmetic or the iteration would give a narrower interval.
fn separation_of([a, b]: [&Swept<'_>; 2], found: &Found, proximity: Proximity) -> Option<Separation> {
    let Found { gap, vector, points, extent } = found;
    let radius = [a.radius[0], b.radius[0]];
    let points = surface_points(*points, vector, gap.length, radius).map(|point| add(&point, a.pose.translation()));
    if proximity == Proximity::Intersects {
        let is_common = gap.upper <= below(radius[0] + radius[1]) || gap.length <= COMMON_POINT * extent;
        return is_common.then_some(Separation { lower: 0.0, upper: 0.0, points, proximity });
    }
    let is_wide = match (a.core, b.core) {
        (Core::Turned(_), _) | (_, Core::Turned(_)) => gap.upper - gap.lower > MAX_TURNED_WIDTH * extent,
        _ => gap.upper - gap.lower > EXACT_DISTANCE_WIDTH * gap.upper,
    };
    let sum = |end: usize| a.radius[end] + b.radius[end];
    let [lower, upper] = [below(gap.lower - above(sum(1))).max(0.0), above(gap.upper - below(sum(0))).max(0.0)];
    (!is_wide).then_some(Separation { lower, upper, points, proximity })
}

/// Bounds on the depth of two cores, in world units, with points relative to the translation of
/// A, and an upper bound of the distance of the cores.
pub(super) struct Depth {
    pub(super) core: CoreDepth,
    pub(super) apart: f64,
}

/// Returns bounds on the depth of two cores in world units. Returns `None` if closed forms do not
/// give them, or they are wider than `width` and than the iteration's.
pub(super) fn depth(a: &Swept<'_>, b: &Swept<'_>, width: f64) -> Option<Depth> {
    if let Some(found) = around_point::found_of_points(a, b) {
        let Found { gap, points, extent, .. } = &found;
        if gap.upper > MAX_DEPTH_WIDTH * extent || gap.lower > 0.5 * gap.upper {
            return of_apart(found, width);
        }
        // Two centers in one place: every direction is as good as any other.
        let (apart, direction) = (gap.upper, [1.0, 0.0, 0.0]);
        return Some(Depth { core: CoreDepth { lower: -apart, upper: apart, direction, points: *points }, apart });
    }
    let Some(differences) = Differences::between(a, b) else {
        let inside = parallel::depth(a, b, width).map(|core| Depth { core, apart: 0.0 });
        return inside.or_else(|| of_apart(around_point::found(a, b)?, width));
    };
    let width = width.max(MAX_DEPTH_WIDTH * differences.extent);
    if differences.are_boxes() {
        let core = Slabs::of(&differences, [a, b]).depth(width)?;
        return Some(Depth { core, apart: 0.0 });
    }
    let nearest = nearest(&differences)?;
    let (gap, points) = (differences.gap(&nearest.vector), differences.points(&nearest.shares));
    let apart = gap.upper;
    if gap.lower > 0.5 * gap.upper {
        return of_apart(Found { gap, vector: nearest.vector, points, extent: differences.extent }, width);
    }
    let core = match differences.count() {
        0 | 1 => return None,
        2 => Slabs::of(&differences, [a, b]).flat(&gap, points, width)?,
        _ => Slabs::of(&differences, [a, b]).depth(width)?,
    };
    Some(Depth { core, apart })
}

/// Returns the negative depth of cores that are apart, or `None` if they may not be, or the
/// interval is wider than `width` and than rounding explains.
fn of_apart(found: Found, width: f64) -> Option<Depth> {
    let Found { gap, vector, points, extent } = found;
    let is_narrow = gap.upper - gap.lower <= width.max(MAX_DEPTH_WIDTH * extent);
    let core = CoreDepth { lower: -gap.upper, upper: -gap.lower, direction: vector, points };
    (gap.lower > 0.5 * gap.upper && is_narrow).then_some(Depth { core, apart: gap.upper })
}

/// Returns the answer that the bounds on the cores' distance prove, or `None`.
#[inline]
fn decide([a, b]: [&Swept<'_>; 2], gap: &Gap, clearance: f64) -> Option<Proximity> {
    let sum = |end: usize| a.radius[end] + b.radius[end] + clearance;
    if gap.lower > above(sum(1)) {
        Some(Proximity::Apart)
    } else if gap.upper <= below(sum(0)) {
        Some(Proximity::Intersects)
    } else {
        None
    }
}

/// Reports whether a box and another core certainly have a point in common. `false` means
/// undecided.
fn certainly_overlap(differences: &Differences, [a, b]: [&Swept<'_>; 2]) -> bool {
    differences.count() >= 3 && Slabs::of(differences, [a, b]).proximity() == Proximity::Intersects
}

/// Moves points of cores to the surfaces around them, along the vector between them. If the
/// surfaces overlap, both points become one common point.
fn surface_points([p, q]: [Vector; 2], between: &Vector, length: f64, radius: [f64; 2]) -> [Vector; 2] {
    if radius == [0.0; 2] {
        return [p, q];
    }
    let along = |at: f64| if length > 0.0 { std::array::from_fn(|k| p[k] + between[k] / length * at) } else { p };
    let (from_a, from_b) = (radius[0].min(length), (length - radius[1]).max(0.0));
    if from_a < from_b { [along(from_a), along(from_b)] } else { [along(0.5 * (from_a + from_b)); 2] }
}

#[cfg(test)]
mod tests;
