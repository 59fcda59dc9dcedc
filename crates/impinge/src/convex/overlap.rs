//! The places where two facing polygons lie over each other, seen along a normal: corners of either
//! over the other, and crossings of edges.
//!
//! These are the corners of the intersection of the polygons' shadows, which clipping one polygon
//! against the other would give (Sutherland, Hodgman, *Reentrant polygon clipping*, 1974). Here all
//! pairs of edges are tried instead. That costs as much, knows the origin of each corner, and
//! treats both polygons alike. Segments and points are polygons here.
//!
//! Every point is a mean of corners with weights that are not negative. So it is in the core up to
//! rounding, whatever the shadows look like.

use super::facing::{Corner, Facing};
use super::posed::Pair;
use super::short_list::ShortList;
use crate::math::vec3::{cross, dot, length, sub};

/// Maximum distance in the shadows, relative to the smaller set, of points that count as lying over
/// each other: 2^-30. It keeps corners that touch borders.
const SHADOW_TOLERANCE: f64 = 1.0 / (1 << 30) as f64;

/// Returns the distance in the shadows, in the common unit, up to which points count as lying over
/// each other, for two sets of which the smaller one has the given size.
pub(super) fn shadow_tolerance(pair: &Pair<'_>, size: f64) -> f64 {
    SHADOW_TOLERANCE * size + pair.point_error()
}

/// A corner, an edge or a facet of a shape, named by a number, or by two ascending numbers for an
/// edge.
///
/// Numbers stay the same when a shape moves. A corner's number is the index of the point that the
/// shape was made of. For a hull it is the index into
/// [`Hull::positions`](crate::hull::Hull::positions). A box has eight corners; bit k of the number
/// is set on the positive side of axis k. Each shape numbers its facets in its own way. For a
/// cylinder, a cone, an ellipsoid or a custom set, the part that faces the other shape is a polygon
/// of up to eight of its points, numbered by direction, or one point with number 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// A corner, the center of a sphere, or an end of a capsule's axis.
    Vertex(u32),
    /// The edge between two corners.
    Edge(u32, u32),
    /// A facet, a half-space's plane, or a face of a mesh.
    Face(u32),
}

/// A point of each facing polygon. The points lie over each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Over {
    pub(super) points: [[f64; 3]; 2],
    pub(super) features: [Feature; 2],
}

/// The places where two facing polygons lie over each other. Two rectangles have at most eight
/// places.
pub(super) type Places = ShortList<Over, 8>;

impl Over {
    /// Returns an empty list of places.
    pub(super) fn none() -> Places {
        ShortList::new(Self { points: [[0.0; 3]; 2], features: [Feature::Vertex(0); 2] })
    }
}

/// Adds the places where facing polygons of two shapes lie over each other along a normal of length
/// 1 to `found`. `near` is the tolerance of the shadows.
///
/// # Complexity
/// O(n log n + k) for n polygons and k pairs whose shadows overlap along one axis.
pub(super) fn overlap(a: &[Facing], b: &[Facing], normal: &[f64; 3], near: f64, found: &mut Places) {
    let axes = across(normal);
    if let ([a], [b]) = (a, b) {
        // As for almost all shapes, so no lists are needed.
        return overlap_of_two(&Shadow::new(a, &axes, near), &Shadow::new(b, &axes, near), found);
    }
    let [a, b] = [a, b].map(|all| all.iter().map(|one| Shadow::new(one, &axes, near)).collect::<Vec<_>>());
    let mut by_left: Vec<usize> = (0..b.len()).collect();
    by_left.sort_by(|&i, &j| b[i].bounds[0][0].total_cmp(&b[j].bounds[0][0]));
    let widest = b.iter().map(|shadow| shadow.bounds[1][0] - shadow.bounds[0][0]).fold(0.0, f64::max);
    for shadow in &a {
        let [left, right] = [shadow.bounds[0][0] - widest - 4.0 * near, shadow.bounds[1][0] + 4.0 * near];
        let first = by_left.partition_point(|&at| b[at].bounds[0][0] < left);
        let beside = by_left[first..].iter().take_while(|&&at| b[at].bounds[0][0] <= right);
        let mut others: Vec<usize> = beside.copied().filter(|&at| shadow.may_overlap(&b[at])).collect();
        others.sort_unstable();
        others.into_iter().for_each(|at| overlap_of_two(shadow, &b[at], found));
    }
}

fn overlap_of_two(a: &Shadow<'_>, b: &Shadow<'_>, found: &mut Places) {
    for (at, corner) in a.at.iter().zip(a.facing.corners.iter()) {
        if let Some(point) = b.point_at(at) {
            let features = [Feature::Vertex(corner.number), b.facing.feature()];
            found.push(Over { points: [corner.point, point], features });
        }
    }
    for (at, corner) in b.at.iter().zip(b.facing.corners.iter()) {
        if let Some(point) = a.point_at(at) {
            let features = [a.facing.feature(), Feature::Vertex(corner.number)];
            found.push(Over { points: [point, corner.point], features });
        }
    }
    for edge_a in a.edges() {
        for edge_b in b.edges() {
            if let Some(weights) = crossing(edge_a.map(|i| a.at[i]), edge_b.map(|i| b.at[i])) {
                let points = [a.on_edge(edge_a, weights[0]), b.on_edge(edge_b, weights[1])];
                found.push(Over { points, features: [a.edge(edge_a), b.edge(edge_b)] });
            }
        }
    }
}

impl Facing {
    /// Returns the feature that the whole facing part is.
    pub(super) fn feature(&self) -> Feature {
        match self.corners[..] {
            [only] => Feature::Vertex(only.number),
            [from, to] => edge_between(from, to),
            _ => Feature::Face(self.facet),
        }
    }
}

/// A facing polygon seen along the normal.
struct Shadow<'f> {
    facing: &'f Facing,
    at: ShortList<[f64; 2], 8>,
    /// Least and greatest coordinates of the corners.
    bounds: [[f64; 2]; 2],
    /// 1 if the corners turn left, -1 if they turn right.
    turn: f64,
    /// Distance up to which places count as one.
    near: f64,
}

impl<'f> Shadow<'f> {
    fn new(facing: &'f Facing, [x, y]: &[[f64; 3]; 2], near: f64) -> Self {
        let mut at = ShortList::new([0.0; 2]);
        at.extend(facing.corners.iter().map(|corner| [dot(x, &corner.point), dot(y, &corner.point)]));
        let end = |pick: fn(f64, f64) -> f64, start: f64| {
            std::array::from_fn(|k| at.iter().fold(start, |end, place: &[f64; 2]| pick(end, place[k])))
        };
        let bounds = [end(f64::min, f64::INFINITY), end(f64::max, f64::NEG_INFINITY)];
        let mut shadow = Self { facing, at, bounds, turn: 0.0, near };
        let doubled_area: f64 = shadow.edges().map(|[from, to]| wedge(shadow.at[from], shadow.at[to])).sum();
        shadow.turn = doubled_area.signum();
        shadow
    }

    /// Reports whether the bounds of two shadows are not clearly apart. Places that count as over a
    /// polygon are at most twice the tolerance outside of it.
    fn may_overlap(&self, other: &Self) -> bool {
        (0..2).all(|k| {
            let gap = f64::max(other.bounds[0][k] - self.bounds[1][k], self.bounds[0][k] - other.bounds[1][k]);
            gap.is_nan() || gap <= 4.0 * self.near
        })
    }

    /// Returns the point of the polygon over a place of the plane, or `None` if there is none.
    fn point_at(&self, place: &[f64; 2]) -> Option<[f64; 3]> {
        let corner = |i: usize| self.facing.corners[i].point;
        let mean = |corners: [usize; 3], weights: [f64; 3]| {
            let [p, q, r] = corners.map(corner);
            std::array::from_fn(|k| weights[0] * p[k] + weights[1] * q[k] + weights[2] * r[k])
        };
        match self.at.len() {
            0 => None,
            1 => is_near(place, &self.at[0], self.near).then(|| corner(0)),
            2 => {
                let weight = share_along(place, &self.at[0], &self.at[1]);
                let foot: [f64; 2] = std::array::from_fn(|k| (1.0 - weight) * self.at[0][k] + weight * self.at[1][k]);
                is_near(place, &foot, self.near).then(|| self.on_edge([0, 1], weight))
            }
            count => {
                // Of the triangles of a fan, uses the one with the place farthest on its inner
                // side.
                let is_outside = |from: usize, to: usize| {
                    let [p, q] = [self.at[from], self.at[to]];
                    let edge = [q[0] - p[0], q[1] - p[1]];
                    self.turn * wedge(edge, [place[0] - p[0], place[1] - p[1]])
                        < -self.near * (edge[0].abs() + edge[1].abs())
                };
                if self.edges().any(|[from, to]| is_outside(from, to)) {
                    return None;
                }
                let weights = |i: usize| {
                    let part = |p: [f64; 2], q: [f64; 2]| {
                        self.turn * wedge([p[0] - place[0], p[1] - place[1]], [q[0] - place[0], q[1] - place[1]])
                    };
                    let [p, q, r] = [self.at[0], self.at[i], self.at[i + 1]];
                    [part(q, r), part(r, p), part(p, q)]
                };
                let least = |i: &usize| weights(*i).into_iter().fold(f64::INFINITY, f64::min);
                let best = (1..count - 1).max_by(|i, j| least(i).total_cmp(&least(j)))?;
                let shares = weights(best).map(|share| share.max(0.0));
                let total: f64 = shares.iter().sum();
                (total > 0.0).then(|| mean([0, best, best + 1], shares.map(|share| share / total)))
            }
        }
    }

    fn edges(&self) -> impl Iterator<Item = [usize; 2]> {
        let count = self.at.len();
        let edges = if count > 2 { count } else { count.saturating_sub(1) };
        (0..edges).map(move |from| [from, if from + 1 == count { 0 } else { from + 1 }])
    }

    fn edge(&self, [from, to]: [usize; 2]) -> Feature {
        edge_between(self.facing.corners[from], self.facing.corners[to])
    }

    fn on_edge(&self, [from, to]: [usize; 2], weight: f64) -> [f64; 3] {
        let (p, q) = (self.facing.corners[from].point, self.facing.corners[to].point);
        std::array::from_fn(|k| (1.0 - weight) * p[k] + weight * q[k])
    }
}

fn edge_between(from: Corner, to: Corner) -> Feature {
    Feature::Edge(from.number.min(to.number), from.number.max(to.number))
}

/// Returns the crossing of two segments strictly inside both, as the weight of the end of each
/// segment, or `None`.
fn crossing([p, q]: [[f64; 2]; 2], [r, s]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (e, f, between) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]], [r[0] - p[0], r[1] - p[1]]);
    let turn = wedge(e, f);
    let weights = [wedge(between, f) / turn, wedge(between, e) / turn];
    weights.iter().all(|weight| 0.0 < *weight && *weight < 1.0).then_some(weights)
}

/// Returns the weight of the end of a segment in the point of the segment nearest to a place.
fn share_along(place: &[f64; 2], from: &[f64; 2], to: &[f64; 2]) -> f64 {
    let edge = [to[0] - from[0], to[1] - from[1]];
    let share =
        ((place[0] - from[0]) * edge[0] + (place[1] - from[1]) * edge[1]) / (edge[0] * edge[0] + edge[1] * edge[1]);
    if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}

fn is_near(p: &[f64; 2], q: &[f64; 2], near: f64) -> bool {
    (p[0] - q[0]).abs() <= near && (p[1] - q[1]).abs() <= near
}

fn wedge(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// Returns two directions of length 1 that are perpendicular to a direction and to each other.
pub(super) fn across(normal: &[f64; 3]) -> [[f64; 3]; 2] {
    let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()).then(i.cmp(&j))).unwrap_or(0);
    let axis = std::array::from_fn(|k| f64::from(u8::from(k == least)) - normal[k] * normal[least]);
    let scale = 1.0 / length(&axis);
    let x = axis.map(|entry| entry * scale);
    [x, cross(normal, &x)]
}

/// Reports whether two points are one place up to the tolerance of the shadows.
pub(super) fn is_one_place(p: &[f64; 3], q: &[f64; 3], near: f64) -> bool {
    sub(p, q).iter().all(|x| x.abs() <= 16.0 * near)
}
