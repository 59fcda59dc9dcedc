//! The generalised winding number of a mesh about a point: how often its faces wind round it, and so what is inside.
//!
//! It is the sum of the solid angles of the faces over 4π: an integer where the mesh is closed, and a fraction that
//! falls off smoothly through the holes where it is open (Jacobson, Kavan and Sorkine-Hornung, *Robust Inside-Outside
//! Segmentation using Generalized Winding Numbers*, ACM Transactions on Graphics 32(4), 2013).
//!
//! A ray from the point crosses the faces a whole number of times, which is exact and quick by the tree. Let strips from
//! every border edge to infinity, against the ray, make the mesh closed: its winding number is the crossings of the
//! ray, as the ray meets no strip, and the mesh's is that less the strips'. A strip is a spherical triangle of its edge
//! and the direction against the ray (Martens and Bessmeltsev, *One-shot Method for Computing Generalized Winding
//! Numbers*, Computer Graphics Forum 44(5), 2025, who integrate curves; ours are polygons, with a bound of the error, and
//! the rays along the axes, with their ties, are exact). So the cost is that of the border, not of the mesh; where the
//! border is long, as that of a soup of triangles is, the faces are summed up with expansions for those that are far.

use rayon::prelude::*;

use super::crossings;
use super::solid_angle::{AngleSum, Bounded, Direction};
use crate::exact::{AxisRay, PosedPoint, Spot};
use crate::input::{InputError, InputErrorKind};
use crate::math::Sign;
use crate::math::relative::UNIT_ROUNDOFF;
use crate::mesh::Mesh;
use crate::mesh::derived::topology::BorderEdge;

/// How often a mesh winds round a point, with what is proved of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindingNumber {
    /// About 1 inside a mesh whose faces are counterclockwise seen from outside, 0 outside.
    pub value: f64,
    /// The true number is not below this.
    pub lower: f64,
    /// The true number is not above this.
    pub upper: f64,
}

/// Where a point is to a mesh taken as a solid: inside is where the winding number is beyond one half, of either sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Containment {
    /// Outside, and not on the surface.
    Outside,
    /// On the surface, exactly.
    Surface,
    /// Inside, and not on the surface.
    Inside,
    /// The mesh is open there, and its winding number so close to one half that the proved interval holds it.
    Undecided,
}

impl Containment {
    /// Whether the point counts as contained: the surface does, and what is undecided does, which is the safe side.
    #[must_use]
    pub fn is_contained(self) -> bool {
        self != Self::Outside
    }
}

impl WindingNumber {
    /// Edges of a border that are summed up for each point; longer ones give way to expansions of the faces. More cost time
    /// that grows with them, fewer give wider intervals to meshes that could have narrow ones.
    pub const LONG_BORDER: usize = 8192;

    fn exactly(count: i64) -> Self {
        let value = count as f64;
        Self { value, lower: value, upper: value }
    }

    /// A whole number and a fraction.
    fn about(count: i64, turns: &Bounded) -> Self {
        let whole = count as f64;
        let value = whole + turns.value;
        // The sum, and the steps to the bounds, round by less than two units of the larger.
        let error = turns.error + 2.0 * f64::EPSILON * (whole.abs() + turns.value.abs() + turns.error);
        Self { value, lower: value - error, upper: value + error }
    }

    /// By which side of one half it is surely on, for a point that is not on the surface.
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
    /// Whether every edge is run through as often one way as the other, edges being named by the positions of their
    /// ends: then the winding number is an integer everywhere off the surface.
    ///
    /// # Complexity
    /// O(n log n) the first time, then constant.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.topology().border.is_empty()
    }

    /// The winding numbers of points in the mesh's own frame.
    ///
    /// On the surface, a face whose plane holds the point counts nothing: within a face of a closed mesh the number is
    /// the mean of those of both sides.
    ///
    /// # Accuracy
    /// Exact off the surface of a closed mesh. Otherwise the interval is proved, and about 1e-13 wide for a border of a
    /// thousand edges; at most 1e-5 wide where the border is longer than [`LONG_BORDER`](WindingNumber::LONG_BORDER), as far
    /// as rounding allows.
    ///
    /// # Complexity
    /// For each point logarithmic in the faces for each layer that a ray crosses, and linear in the border. Where that is
    /// long, or the point in line with border vertices along all three axes, as many faces and groups of faces as the width of
    /// the interval needs. On all cores of the current rayon pool.
    ///
    /// # Errors
    /// A coordinate that is not finite, or not below 2^128 in magnitude.
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
        self.for_each_point(points, |judge, point| judge.winding_number(point))
    }

    /// Where points in the mesh's own frame are to it, taken as a solid.
    ///
    /// # Accuracy
    /// Exact for a closed mesh, and on the surface of any; for an open one as sure as the proved interval.
    ///
    /// # Complexity
    /// As [`winding_number`](Self::winding_number).
    ///
    /// # Errors
    /// A coordinate that is not finite, or not below 2^128 in magnitude.
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
        self.for_each_point(points, |judge, point| judge.containment(point))
    }

    fn for_each_point<T: Send>(
        &self,
        points: &[[f64; 3]],
        answer: impl Fn(&mut Judge<'_>, &PosedPoint<'_>) -> T + Sync,
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
        let judge = || Judge::new(self);
        Ok(points
            .par_iter()
            .map_init(judge, |judge, &point| answer(judge, &PosedPoint::local(Spot::At(point))))
            .collect())
    }
}

/// A sum of angles over 2π that is off by less is not tried to be bettered along another axis.
const NARROW: f64 = 1e-9;

/// Along no axis better than this, the expansions take over, and are opened until their sum is off by less. The faces that
/// they need grow with the cube root of its reciprocal.
const WIDE: f64 = 5e-6;

/// Answers where points are to one mesh, with the working memory for it.
pub(crate) struct Judge<'m> {
    pub(in crate::mesh) mesh: &'m Mesh,
    pub(in crate::mesh) stack: Vec<u32>,
}

impl<'m> Judge<'m> {
    pub(crate) fn new(mesh: &'m Mesh) -> Self {
        Self { mesh, stack: Vec::new() }
    }

    /// Where a point is to the mesh.
    pub(crate) fn containment(&mut self, point: &PosedPoint<'_>) -> Containment {
        let rays = crossings::rays_by_length(self.mesh, point);
        let crossings = self.mesh.crossings(point, rays[0], &mut self.stack);
        if !crossings.holding.is_empty() {
            Containment::Surface
        } else if self.mesh.is_closed() {
            WindingNumber::exactly(crossings.count).containment()
        } else if self.has_long_border() {
            let winding = |sum: &Bounded| WindingNumber::about(0, sum).containment();
            winding(&self.mesh.solid_angles(point, |sum| winding(sum) != Containment::Undecided))
        } else {
            self.winding_number(point).containment()
        }
    }

    fn has_long_border(&self) -> bool {
        self.mesh.topology().border.len() > WindingNumber::LONG_BORDER
    }

    /// How often the mesh winds round a point.
    pub(crate) fn winding_number(&mut self, point: &PosedPoint<'_>) -> WindingNumber {
        if self.has_long_border() {
            return WindingNumber::about(0, &self.mesh.solid_angles(point, |sum| sum.error < WIDE));
        }
        let topology = self.mesh.topology();
        let mut best: Option<(i64, Bounded)> = None;
        for ray in crossings::rays_by_length(self.mesh, point) {
            let crossings = self.mesh.crossings(point, ray, &mut self.stack);
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
            if best.is_none_or(|(_, known)| strips.error < known.error) {
                best = Some((crossings.count, strips));
            }
            if strips.error < NARROW {
                break;
            }
        }
        match best {
            Some((count, strips)) if strips.error < WIDE => WindingNumber::about(count, &strips),
            _ => WindingNumber::about(0, &self.mesh.solid_angles(point, |sum| sum.error < WIDE)),
        }
    }

    /// What the strips from the border against the ray make the winding number too large by.
    fn strips(&self, point: &PosedPoint<'_>, ray: AxisRay, border: &[BorderEdge]) -> Bounded {
        let positions = self.mesh.positions();
        let mut sum = AngleSum::default();
        for edge in border {
            let ends = [edge.from, edge.to].map(|vertex| positions.get(vertex as usize));
            let [a, b] = ends.map(|end| Direction::to(&end, point).project(ray));
            // arg(1 + conj(a) b): half the spherical triangle of both ends and the direction against the ray, which the
            // projection takes to zero. Positive where the edge turns left, looking against the axis.
            let re = 1.0 + (a.x * b.x + a.y * b.y);
            let im = a.x * b.y - a.y * b.x;
            let (size_a, size_b) = (a.size(), b.size());
            let error =
                size_a * b.error + size_b * a.error + a.error * b.error + 8.0 * UNIT_ROUNDOFF * (1.0 + size_a * size_b);
            let side = if im > error {
                Sign::Positive
            } else if im < -error {
                Sign::Negative
            } else {
                point.ray_beside(ray, &ends[0], &ends[1])
            };
            sum.add(re, im, error, side, edge.times);
        }
        let Bounded { value, error } = sum.turns();
        Bounded { value: if ray.ascending { -value } else { value }, error }
    }
}

/// The border without that of some faces, edges run through as often either way left out.
fn without(border: &[BorderEdge], taken: Vec<BorderEdge>) -> Vec<BorderEdge> {
    let negated = taken.into_iter().map(|edge| BorderEdge { times: -edge.times, ..edge });
    let mut all: Vec<BorderEdge> = border.iter().copied().chain(negated).collect();
    all.sort_unstable_by_key(|edge| (edge.from, edge.to));
    all.chunk_by(|x, y| (x.from, x.to) == (y.from, y.to))
        .map(|run| BorderEdge { times: run.iter().map(|edge| edge.times).sum(), ..run[0] })
        .filter(|edge| edge.times != 0)
        .collect()
}
