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

use super::facing::{AllFacing, Bounds, Corner, Facing, bounds_of};
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

/// Adds the places where two facing polygons lie over each other along a normal of length 1 to
/// `found`. `near` is the tolerance of the shadows.
pub(super) fn overlap(a: &Facing, b: &Facing, normal: &[f64; 3], near: f64, found: &mut Places) {
    let axes = across(normal);
    overlap_of_two(&Shadow::new(a, &axes, near), &Shadow::new(b, &axes, near), found);
}

/// Adds the places where any of the facing polygons of two shapes lie over each other to `found`,
/// like [`overlap`].
///
/// # Complexity
/// O(n log n + k) for n polygons and k pairs whose shadows overlap along one axis.
pub(super) fn overlap_of_all(a: &AllFacing<'_>, b: &AllFacing<'_>, normal: &[f64; 3], near: f64, found: &mut Places) {
    let axes = across(normal);
    let pairs = pairs_of_bounds(&a.bounds(&axes), &b.bounds(&axes), near);
    let mut numbers: Vec<usize> = pairs.iter().map(|pair| pair[1]).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let parts: Vec<Facing> = numbers.iter().map(|&number| b.part(number)).collect();
    let shadows: Vec<Shadow<'_>> = parts.iter().map(|part| Shadow::new(part, &axes, near)).collect();
    for beside in pairs.chunk_by(|x, y| x[0] == y[0]) {
        let part = a.part(beside[0][0]);
        let shadow = Shadow::new(&part, &axes, near);
        for other in beside.iter().filter_map(|pair| numbers.binary_search(&pair[1]).ok()) {
            overlap_of_two(&shadow, &shadows[other], found);
        }
    }
}

/// Returns the pairs of rectangles of two lists that are not clearly apart, in ascending order.
fn pairs_of_bounds(a: &[Bounds], b: &[Bounds], near: f64) -> Vec<[usize; 2]> {
    // Places that count as over a polygon are at most twice the tolerance outside of it.
    let reach = 4.0 * near;
    let is_apart = |x: &Bounds, y: &Bounds| (0..2).any(|k| f64::max(y[0][k] - x[1][k], x[0][k] - y[1][k]) > reach);
    let [all_a, all_b] = [a, b].map(|list| bounds_of(list.iter().flatten().copied()));
    let of_a = (0..a.len()).filter(|&at| !is_apart(&a[at], &all_b));
    let mut of_b: Vec<usize> = (0..b.len()).filter(|&at| !is_apart(&b[at], &all_a)).collect();
    of_b.sort_by(|&i, &j| b[i][0][0].total_cmp(&b[j][0][0]));
    let widest = of_b.iter().map(|&at| b[at][1][0] - b[at][0][0]).fold(0.0, f64::max);
    let mut pairs = Vec::new();
    for at in of_a {
        let [left, right] = [a[at][0][0] - widest - reach, a[at][1][0] + reach];
        let first = of_b.partition_point(|&other| b[other][0][0] < left);
        let beside = of_b[first..].iter().take_while(|&&other| b[other][0][0] <= right);
        let start = pairs.len();
        pairs.extend(beside.filter(|&&other| !is_apart(&a[at], &b[other])).map(|&other| [at, other]));
        pairs[start..].sort_unstable();
    }
    pairs
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
    /// 1 if the corners turn left, -1 if they turn right.
    turn: f64,
    /// Distance up to which places count as one.
    near: f64,
}

impl<'f> Shadow<'f> {
    fn new(facing: &'f Facing, [x, y]: &[[f64; 3]; 2], near: f64) -> Self {
        let mut at = ShortList::new([0.0; 2]);
        at.extend(facing.corners.iter().map(|corner| [dot(x, &corner.point), dot(y, &corner.point)]));
        let mut shadow = Self { facing, at, turn: 0.0, near };
        let doubled_area: f64 = shadow.edges().map(|[from, to]| wedge(shadow.at[from], shadow.at[to])).sum();
        shadow.turn = doubled_area.signum();
        shadow
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

#[cfg(test)]
mod tests {
    use super::super::facets::Facets;
    use super::super::facing::PosedFacets;
    use super::super::posed::{Core, Swept, to_unit_length};
    use super::*;
    use crate::hull::Hull;
    use crate::math::Pose;
    use impinge_testkit::generate::Rng;

    /// Returns a round polytope with corners on a grid, so that edges of two lie over each other.
    fn round(rng: &mut Rng, radius: f64) -> Hull {
        let mut point = || to_unit_length([0; 3].map(|_: i32| rng.unit() - 0.5)).map(|x| (x * radius).round());
        let points: Vec<[f64; 3]> = (0..300).map(|_| point()).collect();
        Hull::new(&points).expect("a hull")
    }

    /// Shapes on a grid, along directions of the grid, mirrored or not.
    #[test]
    fn lists_of_polygons_have_the_places_of_all_their_pairs() {
        let mut rng = Rng::new(574);
        let (mut places, mut many, mut empty) = (0, 0, 0);
        for case in 0..200 {
            let hulls = [round(&mut rng, 12.0), round(&mut rng, 10.0)];
            let facets = hulls.each_ref().map(Facets::of_hull);
            let sign = if case % 2 == 0 { 1.0 } else { -1.0 };
            let poses = [0, 1].map(|side| {
                let offset = [0; 3].map(|_: i32| rng.integer(-4, 4) as f64 * f64::from(side));
                Pose::new([[sign, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], offset).expect("a pose")
            });
            let [a, b] =
                [0, 1].map(|side| Swept { core: Core::Hull(&hulls[side]), pose: &poses[side], radius: [0.0; 2] });
            let pair = Pair::new(&a, &b);
            let normal = to_unit_length([0; 3].map(|_: i32| rng.integer(-3, 3) as f64));
            let (posed_a, posed_b) = (PosedFacets::new(&pair.a, &facets[0]), PosedFacets::new(&pair.b, &facets[1]));
            let all_a = posed_a.leaning(&pair.a, normal);
            let all_b = posed_b.leaning(&pair.b, normal.map(|x| -x));
            let near = shadow_tolerance(&pair, 1.0);
            let (mut found, mut expected) = (Over::none(), Over::none());
            overlap_of_all(&all_a, &all_b, &normal, near, &mut found);
            let [parts_a, parts_b] = [&all_a, &all_b].map(AllFacing::parts);
            parts_a.iter().for_each(|a| parts_b.iter().for_each(|b| overlap(a, b, &normal, near, &mut expected)));
            assert_eq!(found[..], expected[..], "{case}");
            places += found.len();
            many += usize::from(parts_a.len() > 2 && parts_b.len() > 2);
            empty += usize::from(found.is_empty());
        }
        assert!(places > 2_000 && many > 50 && empty > 20, "{places} {many} {empty}");
    }
}
