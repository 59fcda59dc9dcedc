//! The part of a core that faces along a direction: a corner, an edge or a facet of a polytope. For
//! a round core it is a polygon of its points.

use super::facets::Facets;
use super::posed::{Core, Posed, to_unit_entries, to_unit_length};
use super::short_list::ShortList;
use crate::math::vec3::{cross, dot, length, sub};

/// Maximum sine of the angle between a facet's normal and a direction for the facet to count as
/// facing it, or between an edge and the plane perpendicular to the direction: about 14 degrees. A
/// larger value makes contacts of parts that only lean. A smaller value loses corners of shapes
/// that rock.
const MAX_FACING_SINE: f64 = 0.25;

/// Tilts of the direction that find the border of the part of a round core that faces a plane. The
/// smallest tilt that sees more than one place is the most accurate, so they are tried in ascending
/// order.
const TILTS: [f64; 3] = [1.0 / 65_536.0, 1.0 / 2_048.0, 1.0 / 64.0];

/// Maximum distance of points on a round core that count as one, relative to the core's reach.
const SAME_PLACE_DISTANCE: f64 = 1.0 / 16.0;

/// A corner of the facing part: its number, and its position in the common frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) number: u32,
    pub(super) point: [f64; 3],
}

/// The least and the greatest coordinates of a polygon along two axes.
pub(super) type Bounds = [[f64; 2]; 2];

/// The corners of a facing part. The facets of boxes, and the parts of round cores, have at most
/// eight.
pub(super) type Corners = ShortList<Corner, 8>;

/// The part that faces a direction: a convex polygon, a segment or a point, given by its corners in
/// order.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    pub(super) corners: Corners,
    /// Number of the facet. Meaningful only if there are more than two corners.
    pub(super) facet: u32,
}

fn no_corners() -> Corners {
    ShortList::new(Corner { number: 0, point: [0.0; 3] })
}

/// Returns the part of a core that faces a direction of length 1 in the common frame. Facets are
/// needed for polytopes.
pub(super) fn facing(set: &Posed<'_>, facets: Option<&Facets>, direction: [f64; 3]) -> Facing {
    match facets {
        Some(facets) if !facets.corners.is_empty() => of_polytope(set, facets, direction),
        _ => of_round(set, direction),
    }
}

/// The facets of a polytope, with their corners and normals in the common frame. They serve many
/// directions.
pub(super) struct PosedFacets<'f> {
    facets: &'f Facets,
    corners: Vec<Corner>,
    /// Outward normals of the facets, of length 1.
    normals: Vec<[f64; 3]>,
}

impl<'f> PosedFacets<'f> {
    pub(super) fn new(set: &Posed<'_>, facets: &'f Facets) -> Self {
        let corner = |&(number, local): &(u32, [f64; 3])| Corner { number, point: set.spot(local).point };
        let corners: Vec<Corner> = facets.corners.iter().map(corner).collect();
        let normal = |facet| facets.normal(facet, set, |corner| corners[corner as usize].point);
        let normals = facets.all().map(normal).collect();
        Self { facets, corners, normals }
    }

    /// Returns all facets that lean towards a direction, the one that leans most first. If there is
    /// none, returns the edge or the corner that faces it.
    pub(super) fn leaning(&self, set: &Posed<'_>, direction: [f64; 3]) -> AllFacing<'_> {
        let first = of_polytope(set, self.facets, direction);
        let leans = |facet: &u32| *facet != first.facet && faces(dot(&direction, &self.normals[*facet as usize]));
        let others = if first.corners.len() < 3 { Vec::new() } else { self.facets.all().filter(leans).collect() };
        AllFacing { first, others, facets: Some(self) }
    }
}

/// All parts of a shape that face a direction.
pub(super) struct AllFacing<'f> {
    /// The part that faces the direction most.
    pub(super) first: Facing,
    /// Numbers of the other facets.
    others: Vec<u32>,
    /// The facets, if there may be others.
    facets: Option<&'f PosedFacets<'f>>,
}

impl AllFacing<'_> {
    pub(super) fn only(first: Facing) -> Self {
        Self { first, others: Vec::new(), facets: None }
    }

    /// Returns the part with a number. The first one has number zero.
    pub(super) fn part(&self, number: usize) -> Facing {
        let facet = number.checked_sub(1).and_then(|other| self.others.get(other));
        let Some((&facet, PosedFacets { facets, corners, .. })) = facet.zip(self.facets) else {
            return self.first.clone();
        };
        let mut outline = no_corners();
        outline.extend(facets.outlines.list(facet).iter().map(|&corner| corners[corner as usize]));
        Facing { corners: outline, facet }
    }

    /// Returns all parts, in order.
    #[cfg(test)]
    pub(super) fn parts(&self) -> Vec<Facing> {
        (0..=self.others.len()).map(|number| self.part(number)).collect()
    }

    /// Returns for each part, in order, the least and the greatest coordinates along two axes.
    pub(super) fn bounds(&self, axes: &[[f64; 3]; 2]) -> Vec<Bounds> {
        let place = |corner: &Corner| axes.each_ref().map(|axis| dot(axis, &corner.point));
        let first = bounds_of(self.first.corners.iter().map(place));
        let Some(PosedFacets { facets, corners, .. }) = self.facets else { return vec![first] };
        let places: Vec<[f64; 2]> = corners.iter().map(place).collect();
        let of_facet =
            |&facet: &u32| bounds_of(facets.outlines.list(facet).iter().map(|&corner| places[corner as usize]));
        std::iter::once(first).chain(self.others.iter().map(of_facet)).collect()
    }
}

/// Returns the least and the greatest coordinates of some places.
pub(super) fn bounds_of(places: impl Iterator<Item = [f64; 2]>) -> Bounds {
    places.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[least, greatest], place| {
        [[0, 1].map(|k| f64::min(least[k], place[k])), [0, 1].map(|k| f64::max(greatest[k], place[k]))]
    })
}

/// Reports whether a facet with this cosine between its normal and a direction faces it.
fn faces(cosine: f64) -> bool {
    cosine > 0.0 && cosine * cosine >= 1.0 - MAX_FACING_SINE * MAX_FACING_SINE
}

/// Returns the outward normals of all facets of a core, of length 1 in the common frame.
pub(super) fn facet_normals(set: &Posed<'_>, facets: &Facets) -> Vec<[f64; 3]> {
    PosedFacets::new(set, facets).normals
}

impl Facets {
    fn all(&self) -> std::ops::Range<u32> {
        0..self.outlines.len() as u32
    }

    /// Returns the cosine of the angle between the outward normal of a facet and a direction.
    fn cosine(&self, set: &Posed<'_>, facet: u32, direction: &[f64; 3]) -> f64 {
        dot(direction, &self.normal(facet, set, |corner| set.spot(self.corners[corner as usize].1).point))
    }

    /// Returns the outward normal of a facet, of length 1 in the common frame, given the positions
    /// of corners there.
    fn normal(&self, facet: u32, set: &Posed<'_>, position: impl Fn(u32) -> [f64; 3]) -> [f64; 3] {
        let outline = self.outlines.list(facet).iter().map(|&corner| position(corner));
        let outward = if set.pose().mirrors() { -1.0 } else { 1.0 };
        to_unit_length(vector_area(outline).map(|x| outward * x))
    }

    fn facing(&self, set: &Posed<'_>, facet: u32) -> Facing {
        let corner = |&corner: &u32| {
            let (number, local) = self.corners[corner as usize];
            Corner { number, point: set.spot(local).point }
        };
        let mut corners = no_corners();
        corners.extend(self.outlines.list(facet).iter().map(corner));
        Facing { corners, facet }
    }
}

fn of_polytope(set: &Posed<'_>, facets: &Facets, direction: [f64; 3]) -> Facing {
    of_box(set, facets, direction).unwrap_or_else(|| of_any_polytope(set, facets, direction))
}

fn of_any_polytope(set: &Posed<'_>, facets: &Facets, direction: [f64; 3]) -> Facing {
    let point = |corner: u32| set.spot(facets.corners[corner as usize].1).point;
    let corner = |corner: u32| Corner { number: facets.corners[corner as usize].0, point: point(corner) };
    let farthest = match set.core() {
        Core::Hull(_) => set.farthest_vertex(direction),
        _ => {
            let height = |&corner: &u32| dot(&direction, &point(corner));
            (0..facets.corners.len() as u32).max_by(|x, y| height(x).total_cmp(&height(y)).then(y.cmp(x))).unwrap_or(0)
        }
    };
    let facet = facets.facets_at.list(farthest).iter().map(|&facet| (facets.cosine(set, facet, &direction), facet));
    let facet = facet.max_by(|x, y| x.0.total_cmp(&y.0).then(y.1.cmp(&x.1)));
    if let Some((cosine, facet)) = facet
        && faces(cosine)
    {
        return facets.facing(set, facet);
    }
    let sine = |other: u32| dot(&direction, &to_unit_length(sub(&point(other), &point(farthest)))).abs();
    let edge = facets.neighbors.list(farthest).iter().map(|&other| (sine(other), other));
    let edge = edge.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1))).filter(|edge| edge.0 <= MAX_FACING_SINE);
    let mut corners = no_corners();
    corners.extend(std::iter::once(corner(farthest)).chain(edge.map(|(_, other)| corner(other))));
    Facing { corners, facet: 0 }
}

/// Returns the part of a box that faces a direction, found from the edges of the box alone. Returns
/// `None` for a box without volume, and for any other core.
fn of_box(set: &Posed<'_>, facets: &Facets, direction: [f64; 3]) -> Option<Facing> {
    let Core::Cuboid(points) = set.core() else { return None };
    let edges = set.half_edges_of_box()?;
    let outward = if set.pose().mirrors() { -1.0 } else { 1.0 };
    let cosine = |vector: &[f64; 3]| dot(&direction, vector) / length(vector);
    let normal = |axis: usize| cross(&edges[(axis + 1) % 3], &edges[(axis + 2) % 3]);
    let cosines = [0, 1, 2].map(|axis| outward * cosine(&normal(axis)));
    let by_size = |of: [f64; 3]| move |i: &usize, j: &usize| of[*i].abs().total_cmp(&of[*j].abs());
    let axis = (0..3).max_by(by_size(cosines))?;
    // Bit k of the number of a corner is set on the positive side of axis k.
    if faces(cosines[axis].abs()) {
        let is_on_side = |&corner: &u32| (facets.corners[corner as usize].0 >> axis & 1 == 1) == (cosines[axis] > 0.0);
        let facet = facets.all().find(|&facet| facets.outlines.list(facet).iter().all(is_on_side))?;
        return Some(facets.facing(set, facet));
    }
    let sines = edges.each_ref().map(cosine);
    let farthest = (0..3).fold(0, |number, axis| number | u32::from(sines[axis] > 0.0) << axis);
    let axis = (0..3).min_by(by_size(sines))?;
    let edge = (sines[axis].abs() <= MAX_FACING_SINE).then_some(farthest ^ 1 << axis);
    let mut corners = no_corners();
    let corner = |number: u32| Corner { number, point: set.spot(points[number as usize]).point };
    corners.extend(std::iter::once(farthest).chain(edge).map(corner));
    Some(Facing { corners, facet: 0 })
}

/// Returns the farthest points along eight directions about the given one, numbered by direction,
/// if they are in more than one place. Otherwise returns one point with number 8.
fn of_round(set: &Posed<'_>, direction: [f64; 3]) -> Facing {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const TURNS: [[f64; 2]; 8] =
        [[1.0, 0.0], [HALF, HALF], [0.0, 1.0], [-HALF, HALF], [-1.0, 0.0], [-HALF, -HALF], [0.0, -1.0], [HALF, -HALF]];
    let along = set.turned(direction);
    let axis = (0..3).max_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs()).then(j.cmp(&i))).unwrap_or(0);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let near = SAME_PLACE_DISTANCE * set.reach();
    for tilt in TILTS {
        let mut corners = no_corners();
        for (number, turn) in (0..).zip(TURNS) {
            let mut tilted = along;
            tilted[i] += tilt * turn[0];
            tilted[j] += tilt * turn[1];
            let point = set.spot(set.farthest_local(to_unit_entries(tilted))).point;
            if corners.iter().all(|known| length(&sub(&known.point, &point)) > near) {
                corners.push(Corner { number, point });
            }
        }
        if corners.len() > 1 {
            return Facing { corners, facet: 0 };
        }
    }
    {
        let mut corners = no_corners();
        corners.push(Corner { number: 8, point: set.support(direction).point });
        Facing { corners, facet: 0 }
    }
}

/// Returns the vector area of a polygon times 2.
fn vector_area(mut outline: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    let Some(first) = outline.next() else { return [0.0; 3] };
    let mut area = [0.0; 3];
    let mut before = [0.0; 3];
    for point in outline {
        let from_first = sub(&point, &first);
        let triangle = cross(&before, &from_first);
        area = std::array::from_fn(|k| area[k] + triangle[k]);
        before = from_first;
    }
    area
}

#[cfg(test)]
mod tests {
    use super::super::posed::{Pair, Swept};
    use super::*;
    use crate::hull::Hull;
    use crate::math::Pose;
    use impinge_testkit::generate::{Rng, poses, solids};

    /// Boxes at rotated and mirrored poses, along directions of a grid and others.
    #[test]
    fn parts_of_boxes_are_those_of_other_polytopes() {
        let mut rng = Rng::new(576);
        let mut found = [0; 3];
        for case in 0..4_000 {
            let half: [f64; 3] = std::array::from_fn(|_| rng.choose(&[0.25, 0.5, 1.0]));
            let points: Vec<[f64; 3]> = (0..8)
                .map(|corner| std::array::from_fn(|k| if corner >> k & 1 == 1 { half[k] } else { -half[k] }))
                .collect();
            let facets = Facets::of_points(&points).expect("a hull");
            let mut linear =
                if case % 2 == 0 { poses::cube_symmetry(&mut rng) } else { poses::rotation(&mut rng).linear };
            if case % 3 == 0 {
                linear.iter_mut().for_each(|row| row[0] = -row[0]);
            }
            let pose = Pose::new(linear, [0.5, 1.0, -2.0]).expect("a pose");
            let swept = Swept { core: Core::Cuboid(&points), pose: &pose, radius: [0.0; 2] };
            let pair = Pair::new(&swept, &swept);
            let direction = to_unit_length([0; 3].map(|_: i32| rng.integer(-6, 6) as f64));
            let quick = of_box(&pair.a, &facets, direction).expect("a box with volume");
            let expected = of_any_polytope(&pair.a, &facets, direction);
            assert_eq!(quick.corners.len(), expected.corners.len(), "{half:?} {direction:?}");
            if let ([p, q], [r, s]) = (&quick.corners[..], &expected.corners[..]) {
                // Two edges may lean alike.
                let sine = |from: &Corner, to: &Corner| dot(&direction, &to_unit_length(sub(&to.point, &from.point)));
                assert!((sine(p, q).abs() - sine(r, s).abs()).abs() < 1e-12, "{half:?} {direction:?}");
            } else {
                assert_eq!(quick.feature(), expected.feature(), "{half:?} {direction:?}");
                assert!(quick.corners.iter().all(|corner| expected.corners.contains(corner)));
            }
            found[quick.corners.len().min(3) - 1] += 1;
        }
        assert!(found.iter().all(|&found| found > 100), "{found:?}");
    }

    /// Facets whose corners and normals are computed for each direction.
    #[test]
    fn posed_facets_have_the_same_parts_as_facets() {
        let mut rng = Rng::new(575);
        let sphere = Hull::new(&solids::icosphere(2).vertices).expect("a hull");
        let facets = Facets::of_hull(&sphere);
        let (mut parts, mut edges) = (0, 0);
        for case in 0..200 {
            let place = poses::rotation(&mut rng);
            let pose = Pose::new(place.linear, place.translation).expect("a pose");
            let swept = Swept { core: Core::Hull(&sphere), pose: &pose, radius: [0.0; 2] };
            let pair = Pair::new(&swept, &swept);
            let posed = PosedFacets::new(&pair.a, &facets);
            let direction = if case % 2 == 0 {
                facets.normal(case, &pair.a, |corner| pair.a.spot(facets.corners[corner as usize].1).point)
            } else {
                to_unit_length([0; 3].map(|_: i32| rng.integer(-2, 2) as f64))
            };
            let all = posed.leaning(&pair.a, direction);
            let first = facing(&pair.a, Some(&facets), direction);
            let others = facets.all().filter(|&facet| {
                facet != first.facet && first.corners.len() > 2 && faces(facets.cosine(&pair.a, facet, &direction))
            });
            let mut expected = vec![first.clone()];
            expected.extend(others.map(|facet| facets.facing(&pair.a, facet)));
            let found = all.parts();
            assert_eq!(found.len(), expected.len());
            let axes = [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]];
            for ((found, expected), bounds) in found.iter().zip(&expected).zip(all.bounds(&axes)) {
                assert_eq!((found.facet, &found.corners[..]), (expected.facet, &expected.corners[..]));
                for corner in found.corners.iter() {
                    let place = axes.each_ref().map(|axis| dot(axis, &corner.point));
                    assert!((0..2).all(|k| bounds[0][k] <= place[k] && place[k] <= bounds[1][k]));
                }
            }
            parts += found.len();
            edges += usize::from(first.corners.len() < 3);
        }
        assert!(parts > 800, "{parts} {edges}");
    }
}
