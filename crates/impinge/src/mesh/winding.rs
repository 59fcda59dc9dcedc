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
//! the rays along the axes, with their ties, are exact). So the cost is that of the border, not of the mesh.

use rayon::prelude::*;

use super::topology::BorderEdge;
use super::{Mesh, crossings};
use crate::exact::{AxisRay, PosedPoint, Spot};
use crate::input::{InputError, InputErrorKind};
use crate::math::Sign;
use crate::math::arctangent::{ANGLE_ERROR, angle};
use crate::math::relative::UNIT_ROUNDOFF;

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
    fn exactly(count: i64) -> Self {
        let value = count as f64;
        Self { value, lower: value, upper: value }
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
    /// thousand edges.
    ///
    /// # Complexity
    /// For each point logarithmic in the faces for each layer that a ray crosses, and linear in the border; linear in the
    /// faces where the point is in line with border vertices along all three axes. On all cores of the current rayon pool.
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

/// A proved interval of a sum of angles over 2π narrower than this is not tried to be bettered along another axis.
const NARROW: f64 = 1e-9;

/// Along no axis better than this: the faces are summed up one by one. Wider intervals leave more points undecided;
/// narrower ones are sought at a cost linear in the faces.
const WIDE: f64 = 1e-3;

/// Answers where points are to one mesh, with the working memory for it.
pub(crate) struct Judge<'m> {
    mesh: &'m Mesh,
    stack: Vec<u32>,
}

/// A real number in floats, and how far off it may be; infinite where nothing is known.
#[derive(Clone, Copy)]
struct Bounded {
    value: f64,
    error: f64,
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
        } else {
            self.winding_number(point).containment()
        }
    }

    /// How often the mesh winds round a point.
    pub(crate) fn winding_number(&mut self, point: &PosedPoint<'_>) -> WindingNumber {
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
        let (count, turns) = match best {
            Some((count, turns)) if turns.error < WIDE => (count, turns),
            _ => (0, self.face_by_face(point)),
        };
        let whole = count as f64;
        let value = whole + turns.value;
        // The sum, and the steps to the bounds, round by less than two units of the larger.
        let error = turns.error + 2.0 * f64::EPSILON * (whole.abs() + turns.value.abs() + turns.error);
        WindingNumber { value, lower: value - error, upper: value + error }
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

    /// The sum of the solid angles of all faces over 4π.
    ///
    /// # Source
    /// Van Oosterom and Strackee, *The Solid Angle of a Plane Triangle*, IEEE Transactions on Biomedical Engineering 30(2),
    /// 1983.
    fn face_by_face(&self, point: &PosedPoint<'_>) -> Bounded {
        let mut sum = AngleSum::default();
        for face in 0..self.mesh.faces().len() as u32 {
            let corners = self.mesh.corners(face);
            let side = point.above(&corners);
            if side == Sign::Zero {
                continue;
            }
            let [a, b, c] = corners.each_ref().map(|corner| Direction::to(corner, point));
            let dot =
                |x: &Direction, y: &Direction| x.unit[0] * y.unit[0] + x.unit[1] * y.unit[1] + x.unit[2] * y.unit[2];
            let re = 1.0 + dot(&a, &b) + dot(&b, &c) + dot(&c, &a);
            let im: f64 = (0..3)
                .map(|k| {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    a.unit[k] * (b.unit[i] * c.unit[j] - b.unit[j] * c.unit[i])
                })
                .sum();
            // Each of the unit vectors stands in three terms of size one, four with products of errors.
            let error = 4.0 * (a.error + b.error + c.error) + 32.0 * UNIT_ROUNDOFF;
            // The normal points away from a point that the face winds round the right way.
            sum.add(re, im, error, -side, 1);
        }
        sum.turns()
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

/// The unit vector from a point to a corner, off by at most `error` in length.
struct Direction {
    unit: [f64; 3],
    error: f64,
}

/// A direction, projected stereographically from that of a ray onto the plane across it.
struct Projected {
    x: f64,
    y: f64,
    error: f64,
}

impl Direction {
    fn to(corner: &[f64; 3], point: &PosedPoint<'_>) -> Self {
        let difference: [f64; 3] = std::array::from_fn(|k| corner[k] - point.approximate[k]);
        // Divided by the largest first, so that no square vanishes or overflows.
        let largest = difference.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let scaled = difference.map(|x| x / largest);
        let length = (scaled[0] * scaled[0] + scaled[1] * scaled[1] + scaled[2] * scaled[2]).sqrt();
        let unit = scaled.map(|x| x / length);
        // The error of the point turns the vector by at most twice that over its length, up to a quarter of it. Each
        // component is rounded by the difference, two quotients and the length: 6 units in all, of which the square sum of
        // three is below 11.
        let relative = (point.error[0] + point.error[1] + point.error[2]) / largest;
        let error = if relative <= 0.25 { 2.0 * relative + 16.0 * UNIT_ROUNDOFF } else { f64::INFINITY };
        Self { unit, error }
    }

    /// From the direction of the ray, which goes to infinity; that against it goes to zero.
    fn project(&self, ray: AxisRay) -> Projected {
        let [i, j] = ray.across();
        let (x, y) = (self.unit[i], self.unit[j]);
        let along = if ray.ascending { self.unit[ray.axis] } else { -self.unit[ray.axis] };
        if along <= 0.0 {
            // The quotient has a denominator of at least one and is at most one.
            let scale = 1.0 / (1.0 - along);
            return Projected { x: x * scale, y: y * scale, error: 3.0 * self.error + 8.0 * UNIT_ROUNDOFF };
        }
        let across_squared = x * x + y * y;
        let across = across_squared.sqrt();
        let scale = (1.0 + along) / across_squared;
        // Relative to the distance from the axis, which stands once above and twice below the line, and for `1 + along`.
        let relative = self.error / across;
        let size = (1.0 + along) / across;
        let error = if relative <= 1.0 / 16.0 { size * (6.0 * relative + 16.0 * UNIT_ROUNDOFF) } else { f64::INFINITY };
        Projected { x: x * scale, y: y * scale, error }
    }
}

impl Projected {
    /// An upper bound of the distance from zero.
    fn size(&self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt() * (1.0 + 8.0 * UNIT_ROUNDOFF)
    }
}

/// A sum of angles of complex numbers, each times an integer.
#[derive(Default)]
struct AngleSum {
    sum: f64,
    error: f64,
    size: f64,
    terms: f64,
}

impl AngleSum {
    /// Adds `times` the angle of `re + i im`, which is off by at most `error`; the true angle has the sign of `side`.
    fn add(&mut self, re: f64, im: f64, error: f64, side: Sign, times: i32) {
        let length = (re * re + im * im).sqrt();
        // The sine of the angle between both numbers is at most their distance over the length of either, and the angle
        // at most π/2 times its sine.
        let off = 1.6 * (error / length) + ANGLE_ERROR;
        let (magnitude, off) = match off {
            off if off < 1.0 => (angle(re, im.abs()), off),
            _ => (std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2 + ANGLE_ERROR),
        };
        let weight = f64::from(times);
        match side {
            Sign::Positive => self.sum += weight * magnitude,
            Sign::Negative => self.sum -= weight * magnitude,
            Sign::Zero => {}
        }
        self.error += weight.abs() * off;
        self.size += weight.abs() * magnitude;
        self.terms += 1.0;
    }

    /// The sum over 2π.
    fn turns(&self) -> Bounded {
        use std::f64::consts::TAU;
        // Each partial sum is at most the sum of magnitudes, and rounded once, as is that of the errors.
        let rounding = 2.0 * UNIT_ROUNDOFF * (self.terms + 4.0) * (self.size + self.error);
        Bounded { value: self.sum / TAU, error: (self.error + rounding) / TAU * (1.0 + 8.0 * f64::EPSILON) }
    }
}
