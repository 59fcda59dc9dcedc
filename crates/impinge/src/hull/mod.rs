//! Convex hulls of points, with the adjacency of their vertices. Support functions, climbs and
//! bounding boxes are built on them.
//!
//! Every decision is exact, so a hull exists for every set of points: flat, straight, cospherical
//! or all in one place.
//!
//! The proof is docs/notes/proof.md, L10. The tests are in `tests/it/hull`, and the benchmark is
//! `hulls` in `impinge-bench`.

mod build;
mod climb;
mod cull;
mod extremes;
mod facets;
mod flat;
mod order;
mod parts;
mod proof;

use rayon::prelude::*;

use crate::exact::{Plane, orient2d, orient3d};
use crate::input::{InputError, InputErrorKind};
use crate::math::Sign::{Positive, Zero};
use build::Surface;
pub(crate) use climb::climb;
pub(crate) use cull::stored;
pub(crate) use extremes::Extremes;
use facets::Facets;
use flat::Flat;
pub(crate) use parts::HullParts;

/// Exclusive limit on the magnitude of coordinates: 2^128, the range of the proofs.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// The convex hull of a set of points.
///
/// Its *vertices* are the extreme points of the set, each once: the points that are not in the hull
/// of the others. They have the order of the given points. If points are equal, the first is the
/// vertex.
///
/// ```
/// use impinge::hull::{Hull, HullKind};
///
/// // The corners of a cube, and points in a face, in an edge and inside.
/// let mut points: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
/// points.extend([[0.5, 0.5, 1.0], [0.5, 1.0, 1.0], [0.5, 0.5, 0.5]]);
/// let hull = Hull::new(&points)?;
/// assert_eq!(hull.kind(), HullKind::Solid);
/// assert_eq!(hull.vertices(), [0, 1, 2, 3, 4, 5, 6, 7]);
/// assert_eq!(hull.faces().len(), 12);
/// assert_eq!(hull.neighbors(0), [1, 2, 4]);
/// assert_eq!(hull.support([1.0, 2.0, 3.0]), 7);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// Exact: vertices, faces and neighbors are those of the hull of the real points that the floats
/// represent. The same points give the same hull, on any number of threads and with any vector
/// unit. Apart from the indices, vertices and adjacency do not depend on the order of the points
/// either.
///
/// # Complexity
/// Expected O(n log n) for points in general position, in any order. There is no proof for many
/// points in one plane; docs/notes/realigning.md has measurements of lattices and prisms. No input
/// takes more than O(n² log n).
///
/// # Source
/// See `build` for the insertion, `order` for its order, `cull` for the points culled before it,
/// and `flat` for fewer dimensions.
#[derive(Clone, Debug)]
pub struct Hull {
    kind: HullKind,
    vertices: Vec<u32>,
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// The neighbors of vertex `i` are the entries from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
    neighbors: Vec<u32>,
    extremes: Extremes,
    /// The greatest magnitude of a coordinate on each axis.
    reach: [f64; 3],
}

/// Kind of a hull, by its dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum HullKind {
    /// A point, to which all given points are equal.
    Point,
    /// A segment between two vertices, which are neighbors.
    Segment,
    /// A convex polygon.
    Polygon,
    /// A convex polyhedron.
    Solid,
}

impl Hull {
    /// Builds the hull of points in single or double precision, in any one frame and unit.
    ///
    /// # Errors
    /// - [`Empty`](InputErrorKind::Empty) if there are no points;
    /// - [`NonFinite`](InputErrorKind::NonFinite) if a coordinate is not finite;
    /// - [`OutOfRange`](InputErrorKind::OutOfRange) if a coordinate is not below 2^128 in
    ///   magnitude;
    /// - [`TooMany`](InputErrorKind::TooMany) if there are 2^32 - 1 points or more.
    pub fn new<T: Copy + Into<f64> + Sync>(points: &[[T; 3]]) -> Result<Self, InputError> {
        let bounds = validate_points(points)?;
        let kept = cull::may_be_on_hull(points, bounds);
        let order = order::insertion_order(&kept);
        let positions: Vec<[f64; 3]> = order.iter().map(|&at| kept[at as usize].0).collect();
        let numbers: Vec<u32> = order.iter().map(|&at| kept[at as usize].1).collect();
        drop((kept, order));
        let (kind, facets) = match Surface::of(&positions) {
            Some(surface) => (HullKind::Solid, Facets::of(&surface, positions.len())),
            None => match Flat::of(&positions) {
                Flat::Point(only) => {
                    return Ok(Self::of_few(HullKind::Point, &[(numbers[only as usize], positions[only as usize])]));
                }
                Flat::Segment(ends) => {
                    let mut ends = ends.map(|end| (numbers[end as usize], positions[end as usize]));
                    ends.sort_unstable_by_key(|end| end.0);
                    return Ok(Self::of_few(HullKind::Segment, &ends));
                }
                Flat::Polygon(polygon) => (HullKind::Polygon, Facets::of_both_sides(&polygon)),
            },
        };
        Ok(Self::of_facets(kind, &facets, &numbers, &positions))
    }

    /// Returns the kind of the hull, by its dimension.
    #[must_use]
    pub fn kind(&self) -> HullKind {
        self.kind
    }

    /// Returns for each vertex its index in the given points, in ascending order.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Returns the positions of the vertices, in the frame of the given points, without rounding.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Returns the boundary as triangles. Their corners are indices into
    /// [`positions`](Self::positions), in counterclockwise order seen from outside. The list is
    /// empty if the hull is a point or a segment.
    ///
    /// The triangles form a closed surface in which every edge has one triangle on either side. A
    /// facet with more than three corners is a fan around its vertex of lowest index. A polygon has
    /// two sides that face away from each other. The fan of its second side is around that vertex's
    /// neighbor of lower index.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns the vertices that an edge of the hull connects to `vertex`, ascending. Vertices are
    /// indices into [`positions`](Self::positions). An edge that only divides a facet into
    /// triangles is not an edge of the hull.
    ///
    /// # Panics
    /// If `vertex` is not below the number of vertices.
    #[inline]
    #[must_use]
    pub fn neighbors(&self, vertex: u32) -> &[u32] {
        let at = vertex as usize;
        &self.neighbors[self.first[at] as usize..self.first[at + 1] as usize]
    }

    /// Reports whether a point, in the frame of the given points, is inside the hull or on its
    /// boundary. Returns `false` if the point is not finite.
    ///
    /// # Accuracy
    /// Exact, for coordinates below 2^128 in magnitude.
    ///
    /// # Complexity
    /// O(faces).
    #[must_use]
    pub fn contains(&self, point: [f64; 3]) -> bool {
        if !point.iter().all(|x| x.abs() < LIMIT) {
            return false;
        }
        let corner = |vertex: u32| &self.positions[vertex as usize];
        match (self.kind, &self.positions[..]) {
            (HullKind::Point, [only]) => *only == point,
            (HullKind::Segment, [start, end]) => {
                let is_within = |k: usize| (start[k].min(end[k])..=start[k].max(end[k])).contains(&point[k]);
                (0..3).all(is_within) && (0..3).all(|axis| orient2d(axis, start, end, &point) == Zero)
            }
            _ => {
                // Both sides of a polygon have its plane. If no face sees the point, the polygon's
                // edges decide.
                let extent = std::array::from_fn(|k| {
                    self.positions.iter().fold(0.0_f64, |extent, position| extent.max((point[k] - position[k]).abs()))
                });
                self.faces.iter().all(|face| {
                    let [p, q, r] = face.map(corner);
                    let side = Plane::new(p, q, r, &extent).side(&point).unwrap_or_else(|| orient3d(p, q, r, &point));
                    side != Positive
                }) && (self.kind == HullKind::Solid || self.polygon_contains(&point))
            }
        }
    }

    /// Returns the vertex that is farthest along a direction, given in the frame of the points, as
    /// an index into [`positions`](Self::positions). Of equally far vertices, returns the lowest
    /// index.
    ///
    /// The direction may have any length. Its entries that are not finite count as zero. Along the
    /// zero direction all vertices are equally far.
    ///
    /// # Accuracy
    /// Exact: the greatest real value of `direction · position`.
    ///
    /// # Complexity
    /// O(vertices), eight at a time in single precision with a bound on the rounding error.
    /// Vertices within the bound of the greatest are compared exactly.
    #[must_use]
    pub fn support(&self, direction: [f64; 3]) -> u32 {
        self.extremes.along(&self.positions, &usable(direction))
    }

    /// Returns the size of the hull in memory, in bytes.
    #[must_use]
    pub fn memory(&self) -> usize {
        size_of_val(&self.vertices[..])
            + size_of_val(&self.positions[..])
            + size_of_val(&self.faces[..])
            + size_of_val(&self.first[..])
            + size_of_val(&self.neighbors[..])
            + self.extremes.memory()
    }

    /// Returns the structure that finds extreme vertices without climbing.
    pub(crate) fn extremes(&self) -> &Extremes {
        &self.extremes
    }

    /// Returns the greatest magnitude of a coordinate on each axis.
    pub(crate) fn reach(&self) -> [f64; 3] {
        self.reach
    }

    fn of_few(kind: HullKind, ends: &[(u32, [f64; 3])]) -> Self {
        let vertices = ends.iter().map(|end| end.0).collect();
        let positions: Vec<[f64; 3]> = ends.iter().map(|end| end.1).collect();
        let (first, neighbors) = if ends.len() == 2 { (vec![0, 1, 2], vec![1, 0]) } else { (vec![0, 0], Vec::new()) };
        let (extremes, reach) = (Extremes::new(&positions), reach(&positions));
        Self { kind, vertices, positions, faces: Vec::new(), first, neighbors, extremes, reach }
    }

    /// Builds the hull from facets. The facets name positions in the order of insertion; the
    /// vertices are in the order of the input.
    fn of_facets(kind: HullKind, facets: &Facets, numbers: &[u32], positions: &[[f64; 3]]) -> Self {
        let mut corners: Vec<(u32, u32)> =
            facets.iter().flatten().map(|&corner| (numbers[corner as usize], corner)).collect();
        corners.sort_unstable();
        corners.dedup();
        let mut vertex_of = vec![u32::MAX; positions.len()];
        for (vertex, &(_, corner)) in (0..).zip(&corners) {
            vertex_of[corner as usize] = vertex;
        }
        let mut faces = Vec::new();
        let mut edges = Vec::new();
        for (number, facet) in facets.iter().enumerate() {
            let mut polygon: Vec<u32> = facet.iter().map(|&corner| vertex_of[corner as usize]).collect();
            let least = (0..polygon.len()).min_by_key(|&at| polygon[at]).unwrap_or(0);
            polygon.rotate_left(least);
            if kind == HullKind::Polygon && number == 1 {
                // Fans around neighboring vertices have no inner edge in common, so the two sides
                // share only the outline.
                let last = polygon.len() - 1;
                let lesser = if polygon[1] < polygon[last] { 1 } else { last };
                polygon.rotate_left(lesser);
            }
            faces.extend(polygon.windows(2).skip(1).map(|edge| [polygon[0], edge[0], edge[1]]));
            edges.extend((0..polygon.len()).map(|at| [polygon[at], polygon[(at + 1) % polygon.len()]]));
        }
        faces.par_sort_unstable();
        // Every edge occurs once from either side, so both of its ends list it. A polygon of two
        // sides has no other edges.
        edges.par_sort_unstable();
        let mut first = vec![0; corners.len() + 1];
        for [from, _] in &edges {
            first[*from as usize + 1] += 1;
        }
        for vertex in 0..corners.len() {
            first[vertex + 1] += first[vertex];
        }
        let hull_positions: Vec<[f64; 3]> = corners.iter().map(|corner| positions[corner.1 as usize]).collect();
        Self {
            kind,
            vertices: corners.iter().map(|corner| corner.0).collect(),
            faces,
            first,
            neighbors: edges.iter().map(|edge| edge[1]).collect(),
            extremes: Extremes::new(&hull_positions),
            reach: reach(&hull_positions),
            positions: hull_positions,
        }
    }

    /// Reports whether a point in the plane of the polygon is inside the polygon.
    fn polygon_contains(&self, point: &[f64; 3]) -> bool {
        let corner = |vertex: u32| &self.positions[vertex as usize];
        let Some([p, q, r]) = self.faces.first().map(|face| face.map(corner)) else { return false };
        let Some(axis) = (0..3).find(|&axis| orient2d(axis, p, q, r) != Zero) else { return false };
        let is_left = orient2d(axis, p, q, r);
        // Uses the triangles of one side. The other side has the same area.
        self.faces.iter().any(|face| {
            let [p, q, r] = face.map(corner);
            orient2d(axis, p, q, r) == is_left
                && [[p, q], [q, r], [r, p]].iter().all(|[from, to]| {
                    let side = orient2d(axis, from, to, point);
                    side == Zero || side == is_left
                })
        })
    }
}

fn reach(positions: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|k| positions.iter().fold(0.0, |reach: f64, position| reach.max(position[k].abs())))
}

/// Returns the direction with zero in place of entries that are not finite.
fn usable(direction: [f64; 3]) -> [f64; 3] {
    direction.map(|x| if x.is_finite() { x } else { 0.0 })
}

/// Validates the points of a hull or a box, and returns the corners of their bounding box.
///
/// # Errors
/// The errors of [`Hull::new`].
pub(crate) fn validate_points<T: Copy + Into<f64> + Sync>(points: &[[T; 3]]) -> Result<[[f64; 3]; 2], InputError> {
    const CHUNK: usize = 1 << 14;
    if points.is_empty() {
        return Err(InputError::new(InputErrorKind::Empty { what: "points" }));
    }
    let (count, limit) = (points.len(), u32::MAX as usize - 1);
    if count > limit {
        return Err(InputError::new(InputErrorKind::TooMany { what: "points", count, limit }));
    }
    let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let least = |x: [f64; 3], y: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k].min(y[k])) };
    let greatest = |x: [f64; 3], y: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k].max(y[k])) };
    let of_chunk = |points: &[[T; 3]]| {
        points.iter().fold((empty, true), |([low, high], is_good), &point| {
            let p = cull::stored(point);
            let is_in_range = p[0].abs() < LIMIT && p[1].abs() < LIMIT && p[2].abs() < LIMIT;
            ([least(low, p), greatest(high, p)], is_good & is_in_range)
        })
    };
    let (bounds, is_good) = points.par_chunks(CHUNK).map(of_chunk).reduce(
        || (empty, true),
        |(x, x_good), (y, y_good)| ([least(x[0], y[0]), greatest(x[1], y[1])], x_good & y_good),
    );
    if is_good {
        return Ok(bounds);
    }
    let is_bad = |point: &[T; 3]| !point.iter().all(|&x| x.into().abs() < LIMIT);
    let index = points.iter().position(is_bad).unwrap_or_default();
    let is_finite = points[index].iter().all(|&x| x.into().is_finite());
    Err(InputError::new(if is_finite {
        InputErrorKind::OutOfRange { what: "point", index, limit: "2^128" }
    } else {
        InputErrorKind::NonFinite { what: "point", index }
    }))
}
