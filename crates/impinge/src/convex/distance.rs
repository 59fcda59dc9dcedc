//! Distance of two swept cores, and whether they are within a distance of each other.
//!
//! Closed forms answer first, if there are any for the two cores. Otherwise floats compute an
//! interval. If it does not decide the answer, or is too wide, and both cores are polytopes, the
//! exact least distance takes over. For other cores the answer may be
//! undecided.

use super::around::{certainly_intersect, polytope_holds_origin};
use super::closed;
use super::facet::Facet;
use super::gjk::{Gap, gap, gap_until, means};
use super::interval::{EXACT_DISTANCE_WIDTH, Separation, above, below};
use super::min_norm::{LeastDistance, least_distance};
use super::posed::{Pair, Swept, to_unit_length};
use crate::math::dyadic::Dyadic;
use crate::math::vec3::{dot, sub};
use crate::volume::Proximity;

/// Returns the distance of two shapes, and whether they intersect. The two answers never contradict
/// each other.
pub(crate) fn separation(a: &Swept<'_>, b: &Swept<'_>) -> Separation {
    if a.is_before(b) {
        return separation_in_order(a, b);
    }
    let mut found = separation_in_order(b, a);
    found.points.swap(0, 1);
    found
}

/// Proved bounds on the distance of two shapes, in world units, with the direction from A to B
/// along which their cores are proved apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parting {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) direction: [f64; 3],
}

/// Returns bounds on the distance of two shapes by the iteration in floats alone.
pub(crate) fn parting(a: &Swept<'_>, b: &Swept<'_>) -> Parting {
    let pair = Pair::new(a, b);
    let gap = gap(&pair);
    let [lower, upper] = world_bounds(&gap, &pair);
    let sum = |end: usize| a.radius[end] + b.radius[end];
    let [lower, upper] = [below(lower - above(sum(1))), above(upper - below(sum(0)))];
    Parting { lower, upper, direction: gap.direction }
}

fn separation_in_order(a: &Swept<'_>, b: &Swept<'_>) -> Separation {
    closed::separation(a, b).unwrap_or_else(|| separation_by_iteration(a, b))
}

/// Returns the same as [`separation`], or `None` if the distance is proved to be above `limit`, in
/// world units. The proof starts from `known`, the state of the last query, and mostly takes fewer
/// steps than the distance.
pub(super) fn separation_within(a: &Swept<'_>, b: &Swept<'_>, limit: f64, known: &mut Coherence) -> Option<Separation> {
    let is_turned = !a.is_before(b);
    let [first, second] = if is_turned { [b, a] } else { [a, b] };
    let mut found = match closed::separation(first, second) {
        Some(found) => found,
        None => {
            let pair = Pair::new(first, second);
            let reach = above(above(first.radius[1] + second.radius[1]) + limit);
            let gap = known.used(&pair, is_turned, |known| {
                if known.prove_apart(&pair, reach) {
                    return None;
                }
                let is_far = |gap: &Gap| world_bounds(gap, &pair)[0] > reach;
                let gap = gap_until(&pair, is_far);
                known.keep(&gap);
                (!is_far(&gap)).then_some(gap)
            })?;
            separation_from(first, second, &pair, gap)
        }
    };
    if is_turned {
        found.points.swap(0, 1);
    }
    Some(found)
}

/// Returns the same as [`separation`], for shapes in order, without closed forms.
pub(super) fn separation_by_iteration(a: &Swept<'_>, b: &Swept<'_>) -> Separation {
    let pair = Pair::new(a, b);
    let gap = gap(&pair);
    separation_from(a, b, &pair, gap)
}

/// Returns the same as [`separation`], from the complete iteration in floats.
fn separation_from(a: &Swept<'_>, b: &Swept<'_>, pair: &Pair<'_>, mut gap: Gap) -> Separation {
    let mut exact = None;
    if gap.upper - gap.lower > EXACT_DISTANCE_WIDTH * gap.upper && !intersects_by_floats(pair, &gap) {
        exact = least_distance(pair, &gap.simplex);
        if let Some(least) = &exact {
            [gap.lower, gap.upper] = least.bounds(pair.unit);
            gap.points = means(&least.simplex, &least.weights);
        }
    }
    let proximity = classify(pair, [a.radius, b.radius], &gap, exact, 0.0);
    let [lower, upper] = world_bounds(&gap, pair);
    let sum = |end: usize| a.radius[end] + b.radius[end];
    let [lower, upper] = [below(lower - above(sum(1))).max(0.0), above(upper - below(sum(0))).max(0.0)];
    let [lower, upper] = match proximity {
        Proximity::Apart => [lower, upper],
        Proximity::Undecided => [0.0, upper],
        Proximity::Intersects => [0.0; 2],
    };
    let points = on_surfaces(gap.points.map(|point| pair.world(point)), [a.radius[0], b.radius[0]]);
    Separation { lower, upper, points, proximity }
}

/// Reports whether two shapes are within `clearance` of each other, in world units. The clearance
/// must be finite and not negative. `Intersects` means that they are.
pub(crate) fn nearness(a: &Swept<'_>, b: &Swept<'_>, clearance: f64) -> Proximity {
    let [a, b] = if a.is_before(b) { [a, b] } else { [b, a] };
    closed::nearness(a, b, clearance).unwrap_or_else(|| by_iteration(&Pair::new(a, b), [a.radius, b.radius], clearance))
}

/// Returns the same as [`nearness`], for any cores, without closed forms.
pub(super) fn by_iteration(pair: &Pair<'_>, radii: [[f64; 2]; 2], clearance: f64) -> Proximity {
    let gap = gap_until(pair, |gap| by_bounds(pair, radii, gap, clearance).is_some());
    classify(pair, radii, &gap, None, clearance)
}

/// State kept from an earlier query about the same two shapes: a direction from A to B along which
/// they were apart, and the vertices at which the climbs over their hulls ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Coherence {
    direction: [f64; 3],
    vertices: [u32; 2],
}

impl Coherence {
    /// Answers a query with the state, which is for the two shapes in the order in which they were
    /// named; `is_turned` says whether the pair has the other order.
    fn used<T>(&mut self, pair: &Pair<'_>, is_turned: bool, query: impl FnOnce(&mut Self) -> T) -> T {
        let turned = |state: Self| {
            let direction = state.direction.map(|x| 0.0 - x);
            if is_turned { Self { direction, vertices: [state.vertices[1], state.vertices[0]] } } else { state }
        };
        let mut state = turned(*self);
        pair.start_at(state.vertices);
        let answer = query(&mut state);
        state.vertices = pair.vertices();
        *self = turned(state);
        answer
    }

    /// Keeps the direction that proves a gap, if there is one.
    fn keep(&mut self, gap: &Gap) {
        self.direction = if gap.lower > 0.0 { gap.direction } else { [0.0; 3] };
    }

    /// Reports whether a gap along the known direction, clearly larger than `reach`, proves the
    /// cores farther apart than that, in world units.
    fn prove_apart(&self, pair: &Pair<'_>, reach: f64) -> bool {
        /// Minimum gap along the last direction, relative to the sizes, that decides the query:
        /// 2^-20.
        const MIN_DECISIVE_GAP: f64 = 1.0 / (1 << 20) as f64;
        self.direction != [0.0; 3] && {
            let farthest = pair.support(self.direction);
            let lower = super::gjk::separation(pair, self.direction, &farthest);
            (lower - MIN_DECISIVE_GAP * (1.0 + lower)) * pair.unit > reach
        }
    }
}

/// Returns the same as [`nearness`], starting from `known`, the state of the last query. A large
/// gap along the last direction proves the shapes apart. Otherwise the full iteration runs. It
/// would find a large gap too, so no answer depends on `known`.
pub(crate) fn nearness_from(a: &Swept<'_>, b: &Swept<'_>, clearance: f64, known: &mut Coherence) -> Proximity {
    let is_turned = !a.is_before(b);
    let [first, second] = if is_turned { [b, a] } else { [a, b] };
    if let Some(answer) = closed::nearness(first, second, clearance) {
        return answer;
    }
    let (pair, radii) = (Pair::new(first, second), [first.radius, second.radius]);
    known.used(&pair, is_turned, |known| {
        if known.prove_apart(&pair, above(first.radius[1] + second.radius[1] + clearance)) {
            return Proximity::Apart;
        }
        let gap = gap_until(&pair, |gap| by_bounds(&pair, radii, gap, clearance).is_some());
        known.keep(&gap);
        classify(&pair, radii, &gap, None, clearance)
    })
}

/// Classifies the shapes as within `clearance` of each other or not, from the bounds on their
/// cores. If `exact` is given, it must be the exact distance of the same cores.
fn classify(
    pair: &Pair<'_>,
    [a, b]: [[f64; 2]; 2],
    gap: &Gap,
    exact: Option<LeastDistance>,
    clearance: f64,
) -> Proximity {
    if exact.is_none() {
        if let Some(found) = by_bounds(pair, [a, b], gap, clearance) {
            return found;
        }
        if intersects_by_floats(pair, gap) {
            return Proximity::Intersects;
        }
    }
    let Some(least) = exact.or_else(|| least_distance(pair, &gap.simplex)) else {
        let meets = gap.lower == 0.0 && certainly_intersect(pair, &gap.simplex);
        return if meets { Proximity::Intersects } else { Proximity::Undecided };
    };
    let is_within = |end: usize| {
        let reach = &(&Dyadic::from_f64(a[end]) + &Dyadic::from_f64(b[end])) + &Dyadic::from_f64(clearance);
        least.is_at_most_root_of(&(&reach * &reach))
    };
    if is_within(0) {
        Proximity::Intersects
    } else if is_within(1) {
        Proximity::Undecided
    } else {
        Proximity::Apart
    }
}

/// Returns the answer that the bounds on the cores' distance prove, or `None`.
#[inline(always)]
fn by_bounds(pair: &Pair<'_>, [a, b]: [[f64; 2]; 2], gap: &Gap, clearance: f64) -> Option<Proximity> {
    let sum = |end: usize| a[end] + b[end] + clearance;
    let [lower, upper] = world_bounds(gap, pair);
    if lower > above(sum(1)) {
        Some(Proximity::Apart)
    } else if upper <= below(sum(0)) {
        Some(Proximity::Intersects)
    } else {
        None
    }
}

/// Reports whether floats prove that the cores have a common point: by the simplex that the
/// iteration left, or by a few points around it.
fn intersects_by_floats(pair: &Pair<'_>, gap: &Gap) -> bool {
    gap.lower == 0.0 && (holds_origin(pair, gap) || polytope_holds_origin(pair, &gap.simplex))
}

/// Reports whether a tetrahedron of differences contains the origin with a margin above the error
/// of the differences. Then the cores have a common point.
fn holds_origin(pair: &Pair<'_>, gap: &Gap) -> bool {
    let [p, q, r, s] = match gap.simplex[..] {
        [p, q, r, s] => [p.vector, q.vector, r.vector, s.vector],
        _ => return false,
    };
    let margin = pair.point_error();
    let is_outside = |a, b, c| Facet::of(a, b, c).is_some_and(|facet| facet.lower > margin);
    let faces = [[&q, &r, &s], [&p, &s, &r], [&p, &q, &s], [&p, &r, &q]];
    faces.iter().all(|[a, b, c]| is_outside(a, b, c)) || faces.iter().all(|[a, b, c]| is_outside(a, c, b))
}

/// Returns the interval in world units. A product with a power of two rounds only if it underflows;
/// then the ends are moved outwards.
pub(super) fn world_bounds(gap: &Gap, pair: &Pair<'_>) -> [f64; 2] {
    let is_rounded = |bound: f64| 0.0 < bound && bound < f64::MIN_POSITIVE;
    let [lower, upper] = [gap.lower * pair.unit, gap.upper * pair.unit];
    let is_lost = upper == 0.0 && gap.upper > 0.0;
    [
        if is_rounded(lower) { lower.next_down() } else { lower },
        if is_rounded(upper) || is_lost { upper.next_up() } else { upper },
    ]
}

/// Moves points of cores to the surfaces around them, towards each other. If the surfaces overlap,
/// both points become one common point.
fn on_surfaces([p, q]: [[f64; 3]; 2], radius: [f64; 2]) -> [[f64; 3]; 2] {
    let between = sub(&q, &p);
    let direction = to_unit_length(between);
    let length = dot(&direction, &between);
    let along = |at: f64| std::array::from_fn(|k| p[k] + direction[k] * at);
    let (from_a, from_b) = (radius[0].min(length), (length - radius[1]).max(0.0));
    if radius == [0.0; 2] {
        [p, q]
    } else if from_a < from_b {
        [along(from_a), along(from_b)]
    } else {
        [along(0.5 * (from_a + from_b)); 2]
    }
}

#[cfg(test)]
mod tests;
