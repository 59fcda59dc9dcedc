//! The generalized winding number of a mesh about a point: how often the faces wind around it. It
//! decides whether a point is inside.
//!
//! The winding number is the sum of the solid angles of the faces over 4π. It is an integer if the
//! mesh is closed. Otherwise it is a fraction that falls off smoothly through the holes (Jacobson,
//! Kavan and Sorkine-Hornung, *Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers*, ACM Transactions on Graphics 32(4), 2013).
//!
//! A ray from the point crosses faces an integer number of times, which the tree counts exactly and
//! fast. Let strips from every border edge to infinity, against the ray, make the mesh closed. The
//! ray crosses no strip, so the crossings of the ray are the winding number of the closed mesh. The
//! mesh's own winding number is that number less the strips' own. A strip is seen as a spherical
//! triangle of its edge and the direction against the ray (Martens and Bessmeltsev, *One-shot
//! Method for Computing Generalized Winding Numbers*, Computer Graphics Forum 44(5), 2025). They
//! integrate curves. Ours are polygons with an error bound, and our rays along the axes, with their
//! ties, are exact. So the cost depends on the border, not on the mesh. If the border is long, as
//! for a soup of triangles, the solid angles of the faces are summed up instead. Far faces are
//! summed up by expansions. Away from the border the crossings of one ray alone tell what is inside
//! (L19a).
//!
//! Proof: docs/notes/proof.md, L16 and L17. Guarded by `tests/it/solids/winding.rs` and
//! `containment.rs`, and by the benchmark `solids` of `impinge-bench`.

use rayon::prelude::*;

use super::crossings::{Crossings, PackedPoint, are_apart};
use super::solid_angle::{AngleSum, Bounded, Direction};
use crate::exact::{AxisRay, PosedPoint, Spot};
use crate::input::{InputError, InputErrorKind};
use crate::math::Sign;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::mesh::Mesh;
use crate::mesh::derived::topology::BorderEdge;
use crate::volume::Aabb;

/// The winding number of a mesh about a point, with a proved interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindingNumber {
    /// Approximate winding number: about 1 inside a mesh whose faces are counterclockwise seen from
    /// outside, and 0 outside.
    pub value: f64,
    /// Lower bound of the true winding number.
    pub lower: f64,
    /// Upper bound of the true winding number.
    pub upper: f64,
}

/// Position of a point relative to a mesh taken as a solid. A point is inside if its winding number
/// is above 1/2 or below -1/2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Containment {
    /// The point is outside, and not on the surface.
    Outside,
    /// The point is exactly on the surface.
    Surface,
    /// The point is inside, and not on the surface.
    Inside,
    /// The mesh is open, and the proved interval of the winding number contains 1/2 or -1/2.
    Undecided,
}

impl Containment {
    /// Returns `true` unless the point is outside. So points on the surface count as contained, and
    /// so do undecided points.
    #[must_use]
    pub fn is_contained(self) -> bool {
        self != Self::Outside
    }
}

impl WindingNumber {
    /// Maximum number of border edges that are summed up for each point. If the border is longer,
    /// expansions of the faces are summed up instead. A larger number costs time in proportion to
    /// the border. A smaller number gives wider intervals to meshes that could have narrow ones.
    pub const MAX_BORDER_EDGES: usize = 8192;

    fn exactly(count: i64) -> Self {
        let value = count as f64;
        Self { value, lower: value, upper: value }
    }

    /// Returns the sum of an integer and a fraction.
    fn about(count: i64, turns: &Bounded) -> Self {
        let whole = count as f64;
        let value = whole + turns.value;
        // The sum and the steps to the bounds round by less than two units of the larger number.
        let error = turns.error + 2.0 * f64::EPSILON * (whole.abs() + turns.value.abs() + turns.error);
        Self { value, lower: value - error, upper: value + error }
    }

    /// Returns the containment of a point that is not on the surface.
    fn containment(&self) -> Containment {
        if self.lower > 0.5 || self.upper < -0.5 {
            Containment::Inside
        } else if self.lower >= -0.5 && self.upper <= 0.5 {
            Containment::Outside
        } else {
            Containment::Undecided
        }
    }
}

impl Mesh {
    /// Reports whether the faces run along every edge as often one way as the other. Edges are
    /// named by the positions of their ends. If the mesh is closed, its winding number is an
    /// integer everywhere off the surface.
    ///
    /// # Complexity
    /// O(n log n) the first time, then constant.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.topology().border.is_empty()
    }

    /// Returns the winding numbers of points given in the mesh's own frame.
    ///
    /// A face whose plane holds the point adds nothing. So within a face of a closed mesh the
    /// winding number is the mean of both sides.
    ///
    /// # Accuracy
    /// Exact off the surface of a closed mesh. Otherwise the interval is proved, and about 1e-13
    /// wide for a border of a thousand edges. It is at most 1e-5 wide if the border is longer than
    /// [`MAX_BORDER_EDGES`](WindingNumber::MAX_BORDER_EDGES), as far as rounding allows.
    ///
    /// # Complexity
    /// For each point, logarithmic in the faces for each layer that a ray crosses, and linear in
    /// the border. The border may be long, or the point in line with border vertices along all
    /// three axes. Then the cost is linear in the faces and groups of faces that the width of the
    /// interval needs. Runs on all cores of the current rayon pool.
    ///
    /// # Errors
    /// Returns an error if a coordinate is not finite, or not below 2^128 in magnitude.
    ///
    /// ```
    /// use impinge::{Mesh, Positions};
    ///
    /// // A tetrahedron without the face that is farthest from the origin.
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let open = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2]])?;
    /// assert!(!open.is_closed());
    /// let [deep, out] = open.winding_number(&[[0.1, 0.1, 0.1], [0.5, 0.5, 0.5]])?[..] else { unreachable!() };
    /// assert!(deep.lower > 0.5 && out.upper < 0.5);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    pub fn winding_number(&self, points: &[[f64; 3]]) -> Result<Vec<WindingNumber>, InputError> {
        self.for_each_point(points, |classifier, point| classifier.winding_number(point))
    }

    /// Returns the positions of points, given in the mesh's own frame, relative to the mesh taken
    /// as a solid.
    ///
    /// # Accuracy
    /// Exact for a closed mesh, and on the surface of any mesh. Off the surface of an open mesh the
    /// answer follows from the proved interval of the winding number, and is
    /// [`Containment::Undecided`] if that does not decide.
    ///
    /// # Complexity
    /// As [`winding_number`](Self::winding_number).
    ///
    /// # Errors
    /// Returns an error if a coordinate is not finite, or not below 2^128 in magnitude.
    ///
    /// ```
    /// use impinge::mesh::Containment::{Inside, Outside, Surface};
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// let solid = Mesh::new(Positions::F32(corners), faces)?;
    /// assert_eq!(solid.contains(&[[0.1, 0.1, 0.1], [0.5, 0.5, 0.0], [0.5, 0.5, 1e-300]])?, [Inside, Surface, Outside]);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    pub fn contains(&self, points: &[[f64; 3]]) -> Result<Vec<Containment>, InputError> {
        self.for_each_point(points, |classifier, point| classifier.containment(point))
    }

    fn for_each_point<T: Send>(
        &self,
        points: &[[f64; 3]],
        answer: impl Fn(&mut PointClassifier<'_>, &PosedPoint<'_>) -> T + Sync,
    ) -> Result<Vec<T>, InputError> {
        const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;
        if let Some(index) = points.par_iter().position_first(|point| !point.iter().all(|x| x.abs() < LIMIT)) {
            let finite = points[index].iter().all(|x| x.is_finite());
            return Err(InputError::new(if finite {
                InputErrorKind::OutOfRange { what: "point", index, limit: "2^128" }
            } else {
                InputErrorKind::NonFinite { what: "point", index }
            }));
        }
        self.topology();
        let classifier = || PointClassifier::new(self);
        Ok(points
            .par_iter()
            .map_init(classifier, |classifier, &point| answer(classifier, &PosedPoint::local(Spot::At(point))))
            .collect())
    }
}

/// Error bound of the winding number below which no other axis is tried.
const NARROW_ERROR: f64 = 1e-9;

/// Error bound of the winding number above which, along every axis, expansions are used instead.
/// They are opened until the error of their sum is below it. The number of faces that they need
/// grows with the cube root of its reciprocal.
const WIDE_ERROR: f64 = 5e-6;

/// Computes the positions of points relative to one mesh, and keeps the working memory for it.
pub(crate) struct PointClassifier<'m> {
    pub(in crate::mesh) mesh: &'m Mesh,
    /// Bounds of the mesh in its packed frame.
    bounds: Aabb,
    pub(in crate::mesh) stack: Vec<u32>,
}

impl<'m> PointClassifier<'m> {
    pub(crate) fn new(mesh: &'m Mesh) -> Self {
        Self { mesh, bounds: mesh.packed_bounds(), stack: Vec::new() }
    }

    /// Returns the position of a point relative to the mesh taken as a solid.
    pub(crate) fn containment(&mut self, point: &PosedPoint<'_>) -> Containment {
        let packed = PackedPoint::new(self.mesh, point);
        if self.is_far_out(&packed) {
            return Containment::Outside;
        }
        let rays = packed.rays_by_length(&self.bounds);
        let cap = self.mesh.cap();
        let clear = rays.into_iter().find(|&ray| cap.is_clear_of(point, ray));
        let crossings = self.crossings(point, &packed, clear.unwrap_or(rays[0]));
        if !crossings.holding.is_empty() {
            Containment::Surface
        } else if clear.is_some() {
            WindingNumber::exactly(crossings.count).containment()
        } else if self.has_long_border() {
            let winding = |sum: &Bounded| WindingNumber::about(0, sum).containment();
            winding(&self.mesh.solid_angles(point, |sum| winding(sum) != Containment::Undecided))
        } else {
            let is_decided = |count: i64, strips: &Bounded| {
                WindingNumber::about(count, strips).containment() != Containment::Undecided
            };
            self.winding_by_border(point, is_decided).containment()
        }
    }

    /// Returns the faces that hold a point and the crossings of a ray from it.
    fn crossings(&mut self, point: &PosedPoint<'_>, packed: &PackedPoint, ray: AxisRay) -> Crossings {
        let is_apart = are_apart(&packed.reach(ray), &self.bounds);
        if is_apart { Crossings::default() } else { self.mesh.crossings(point, packed, ray, &mut self.stack) }
    }

    /// Reports whether a point is proved to be outside of the bounds of a closed mesh. The ray from
    /// it that leads away from the mesh crosses nothing, so the winding number is zero.
    fn is_far_out(&self, point: &PackedPoint) -> bool {
        point.is_beyond(&self.bounds) && self.mesh.topology().border.is_empty()
    }

    fn has_long_border(&self) -> bool {
        self.mesh.topology().border.len() > WindingNumber::MAX_BORDER_EDGES
    }

    /// Returns the winding number of the mesh about a point.
    pub(crate) fn winding_number(&mut self, point: &PosedPoint<'_>) -> WindingNumber {
        if self.has_long_border() {
            return WindingNumber::about(0, &self.mesh.solid_angles(point, |sum| sum.error < WIDE_ERROR));
        }
        self.winding_by_border(point, |_, strips| strips.error < NARROW_ERROR)
    }

    /// Returns the winding number of the mesh about a point, computed from the crossings of a ray
    /// and the strips of the border. Further rays are tried until the result is enough.
    fn winding_by_border(
        &mut self,
        point: &PosedPoint<'_>,
        is_enough: impl Fn(i64, &Bounded) -> bool,
    ) -> WindingNumber {
        let topology = self.mesh.topology();
        let mut best: Option<(i64, Bounded)> = None;
        let packed = PackedPoint::new(self.mesh, point);
        if self.is_far_out(&packed) {
            return WindingNumber::exactly(0);
        }
        for ray in packed.rays_by_length(&self.bounds) {
            let crossings = self.crossings(point, &packed, ray);
            let merged;
            let border = if crossings.holding.is_empty() {
                &topology.border
            } else {
                let held = crossings.holding.iter().map(|&face| self.mesh.faces()[face as usize]);
                merged = without(&topology.border, topology.border_of(held));
                &merged
            };
            if border.is_empty() {
                return WindingNumber::exactly(crossings.count);
            }
            let strips = self.strips(point, ray, border);
            if is_enough(crossings.count, &strips) {
                return WindingNumber::about(crossings.count, &strips);
            }
            if best.is_none_or(|(_, known)| strips.error < known.error) {
                best = Some((crossings.count, strips));
            }
        }
        match best {
            Some((count, strips)) if strips.error < WIDE_ERROR => WindingNumber::about(count, &strips),
            _ => WindingNumber::about(0, &self.mesh.solid_angles(point, |sum| sum.error < WIDE_ERROR)),
        }
    }

    /// Returns the mesh's winding number less the crossings of the ray: the winding number of the
    /// strips from the border against the ray, with the opposite sign.
    fn strips(&self, point: &PosedPoint<'_>, ray: AxisRay, border: &[BorderEdge]) -> Bounded {
        let positions = self.mesh.positions();
        let mut sum = AngleSum::default();
        for edge in border {
            let ends = [edge.from, edge.to].map(|vertex| positions.get(vertex as usize));
            let [a, b] = ends.map(|end| Direction::to(&end, point).project(ray));
            // arg(1 + conj(a) b): half the spherical triangle of both ends and the direction
            // against the ray, which the projection takes to zero. It is positive if the edge turns
            // left, looking against the axis.
            let re = 1.0 + (a.x * b.x + a.y * b.y);
            let im = a.x * b.y - a.y * b.x;
            let (size_a, size_b) = (a.size(), b.size());
            let error =
                size_a * b.error + size_b * a.error + a.error * b.error + 8.0 * UNIT_ROUNDOFF * (1.0 + size_a * size_b);
            let side = if im > error {
                Sign::Positive
            } else if im < -error {
                Sign::Negative
            } else if re > 2.0 * error {
                // The angle is about zero, far from where it jumps, and its error has a bound.
                Sign::from(im.total_cmp(&0.0))
            } else {
                point.ray_beside(ray, &ends[0], &ends[1])
            };
            sum.add(re, im, error, side, edge.times);
        }
        let Bounded { value, error } = sum.turns();
        Bounded { value: if ray.ascending { -value } else { value }, error }
    }
}

/// Returns the border without the border of some faces. Edges that cancel are left out.
fn without(border: &[BorderEdge], taken: Vec<BorderEdge>) -> Vec<BorderEdge> {
    let negated = taken.into_iter().map(|edge| BorderEdge { times: -edge.times, ..edge });
    let mut all: Vec<BorderEdge> = border.iter().copied().chain(negated).collect();
    all.sort_unstable_by_key(|edge| (edge.from, edge.to));
    all.chunk_by(|x, y| (x.from, x.to) == (y.from, y.to))
        .map(|run| BorderEdge { times: run.iter().map(|edge| edge.times).sum(), ..run[0] })
        .filter(|edge| edge.times != 0)
        .collect()
}
