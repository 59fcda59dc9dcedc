//! The border of an open solid, and how much its winding number differs between near points.
//!
//! The winding number of an open surface has the gradient of a magnetic field: it is the integral
//! along the border of the element, across the way to it, over the cubed distance and 4π (law of
//! Biot and Savart). So its length is at most the integral of 1 over the squared distance, over 4π.
//!
//! Proof: docs/notes/proof.md, L42. Guarded by `tests/it/clash/open.rs` and by a unit test below.

use std::f64::consts::PI;

use crate::math::vec3::{Vector, length, sub};
use crate::mesh::{PlacedMesh, WindingNumber};
use crate::primitive::point_segment;

/// The border of a mesh in the frame of the search.
pub(super) struct Border {
    edges: Vec<Edge>,
    /// Whether there are too many edges to be added up for each point.
    is_long: bool,
}

struct Edge {
    from: Vector,
    way: Vector,
    length: f64,
    /// Number of faces that are missing at the edge.
    times: f64,
}

/// Factor that covers the rounding of the sum.
const ROUNDING: f64 = 1.0 + 1.0 / (1_u64 << 24) as f64;

/// Distance of an edge from the points that are compared, in units of the radius, below which
/// nothing is known.
const NEAR: f64 = 1.0 / 1024.0;

/// Cost of the rays of a winding number, in edges of the border.
const RAYS: usize = 64;

impl Border {
    /// Returns the border of a mesh. `origin` is that of the frame of the search.
    pub(super) fn new(placed: &PlacedMesh<'_>, origin: &Vector) -> Self {
        let border = &placed.mesh.topology().border;
        let is_long = border.len() > WindingNumber::MAX_BORDER_EDGES;
        let place = |vertex: u32| {
            let local = placed.mesh.positions().get(vertex as usize);
            sub(&placed.world_from_mesh.apply(local), origin)
        };
        let edges = border.iter().filter(|_| !is_long).map(|edge| {
            let [from, to] = [edge.from, edge.to].map(place);
            let way = sub(&to, &from);
            Edge { from, way, length: length(&way), times: f64::from(edge.times.unsigned_abs()) }
        });
        Self { edges: edges.collect(), is_long }
    }

    /// Returns the cost of a winding number, in edges of the border.
    pub(super) fn cost(&self) -> usize {
        if self.is_long { WindingNumber::MAX_BORDER_EDGES } else { self.edges.len().max(RAYS) }
    }

    /// Returns a bound of the difference between the winding numbers of a point and of any point
    /// within a radius, if no face crosses the straight way between the two.
    pub(super) fn variation(&self, point: &Vector, radius: f64) -> f64 {
        if self.is_long {
            return f64::INFINITY;
        }
        let mut gradient = 0.0;
        for Edge { from, way, length, times } in &self.edges {
            let distance = point_segment(&sub(point, from), way).0.sqrt() - radius;
            if distance <= NEAR * radius {
                return f64::INFINITY;
            }
            // An endless line at this distance adds no more than π over the distance.
            gradient += times * (length / (distance * distance)).min(PI / distance);
        }
        gradient * radius * ROUNDING / (4.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::{Mesh, Positions};

    #[test]
    fn winding_numbers_vary_by_no_more_than_the_bound() {
        // A tetrahedron without the face that is farthest from the origin.
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = Mesh::new(Positions::F64(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2]]).unwrap();
        let placed = mesh.at(Pose::IDENTITY);
        let border = Border::new(&placed, &[0.0; 3]);
        let (mut largest, mut count) = (0.0_f64, 0);
        for (center, radius) in [([0.2, 0.2, 0.2], 0.15), ([0.6, 0.6, 0.6], 0.2), ([2.0, 1.0, 1.0], 0.5)] {
            let bound = border.variation(&center, radius);
            assert!(bound.is_finite());
            for way in 0..26 {
                let way = [way % 3, way / 3 % 3, way / 9].map(|x| f64::from(x) - 1.0);
                let size = length(&way).max(1.0);
                let point: Vector = std::array::from_fn(|k| center[k] + radius * way[k] / size);
                let [a, b] = mesh.winding_number(&[center, point]).unwrap()[..] else { unreachable!() };
                assert!((a.value - b.value).abs() <= bound);
                largest = largest.max((a.value - b.value).abs() / bound);
                count += 1;
            }
        }
        assert!(count == 78 && largest > 0.1, "{largest}");
        assert!(border.variation(&[0.5, 0.5, 0.1], 0.2).is_infinite());
    }
}
