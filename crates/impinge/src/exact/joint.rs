//! End points of intersection curves: each is identified by the features that it lies on. Its
//! coordinates are computed on request.

use super::double_double::{self, DoubleDouble};
use super::exact_points::Corners;
use super::feature::Feature;
use super::placement::{Placement, world_point};
use crate::math::Pose;
use crate::math::dyadic::{self, Dyadic};

/// One of the two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    A,
    B,
}

/// End of a piece of an intersection curve: a corner of either triangle, or the point where an edge
/// of one passes through the plane of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Joint {
    /// Corner or edge of A that the point lies on, or A's face if it lies on neither.
    pub(crate) on_a: Feature,
    /// Corner or edge of B that the point lies on, or B's face if it lies on neither.
    pub(crate) on_b: Feature,
    /// Triangle whose edge passes through the other's plane. Not used if the point is a corner.
    pub(super) edge_of: Side,
}

impl Joint {
    /// Returns the point in the world frame, each coordinate rounded to the nearest float. It has
    /// the same bits for every pair of triangles that intersects there.
    pub(crate) fn point(&self, placement: &Placement, a: &Corners, b: &Corners) -> [f64; 3] {
        let (a, b) = (Posed(placement.world_from_a(), a), Posed(placement.world_from_b(), b));
        match (self.on_a, self.on_b, self.edge_of) {
            (Feature::Vertex(corner), ..) => a.nearest_corner(corner),
            (_, Feature::Vertex(corner), _) => b.nearest_corner(corner),
            (Feature::Edge(edge), _, Side::A) => a.nearest_on_plane(edge, &b),
            (_, Feature::Edge(edge), Side::B) => b.nearest_on_plane(edge, &a),
            _ => unreachable!("a joint off all corners lies on an edge of `edge_of`"),
        }
    }
}

/// A triangle in the world.
struct Posed<'p>(&'p Pose, &'p Corners);

impl Posed<'_> {
    fn nearest_corner(&self, corner: u8) -> [f64; 3] {
        let corner = &self.1[usize::from(corner)];
        settled(&DoubleDouble::world_point(self.0, corner)).unwrap_or_else(|| {
            let one = Dyadic::from_f64(1.0);
            world_point(self.0, corner).each_ref().map(|x| Dyadic::nearest_quotient(x, &one))
        })
    }

    /// Returns the point where an edge intersects the plane of another triangle, in the world
    /// frame, rounded to nearest. The ends of the edge must be on different sides. With the heights
    /// `h` of its ends p and q, the point is `p + h_p / (h_p - h_q) (q - p)`.
    fn nearest_on_plane(&self, edge: u8, other: &Posed<'_>) -> [f64; 3] {
        let ends = [edge, (edge + 1) % 3].map(|corner| &self.1[usize::from(corner)]);
        let rough = || {
            let [p, q] = ends.map(|end| DoubleDouble::world_point(self.0, end));
            let plane = other.1.each_ref().map(|corner| DoubleDouble::world_point(other.0, corner));
            let from_first = |x: &[DoubleDouble; 3]| double_double::difference(x, &plane[0]);
            let normal = double_double::cross(&from_first(&plane[1]), &from_first(&plane[2]));
            let [h_p, h_q] = [&p, &q].map(|end| double_double::dot(&normal, &from_first(end)));
            let along = h_p.over(&h_p.minus(&h_q));
            settled(&[0, 1, 2].map(|k| p[k].plus(&q[k].minus(&p[k]).times(&along))))
        };
        rough().unwrap_or_else(|| {
            let [p, q] = ends.map(|end| world_point(self.0, end));
            let plane = other.1.each_ref().map(|corner| world_point(other.0, corner));
            exactly_nearest_on_plane(&p, &q, &plane)
        })
    }
}

/// Returns a point rounded to the nearest floats, or `None` if the error bounds do not determine
/// them.
fn settled([x, y, z]: &[DoubleDouble; 3]) -> Option<[f64; 3]> {
    Some([x.nearest()?, y.nearest()?, z.nearest()?])
}

#[cold]
fn exactly_nearest_on_plane(p: &[Dyadic; 3], q: &[Dyadic; 3], plane: &[[Dyadic; 3]; 3]) -> [f64; 3] {
    let from_first = |x: &[Dyadic; 3]| [&x[0] - &plane[0][0], &x[1] - &plane[0][1], &x[2] - &plane[0][2]];
    let normal = dyadic::cross(&from_first(&plane[1]), &from_first(&plane[2]));
    let (h_p, h_q) = (dyadic::dot(&normal, &from_first(p)), dyadic::dot(&normal, &from_first(q)));
    let denominator = &h_p - &h_q;
    std::array::from_fn(|k| {
        let numerator = &(&h_p * &q[k]) - &(&h_q * &p[k]);
        Dyadic::nearest_quotient(&numerator, &denominator)
    })
}
