//! First time of contact of a vertex and a face, or of two edges, whose corners move along lines.
//!
//! The time is exact: the root of a polynomial with rational coefficients, isolated by Sturm's
//! theorem. One query takes about 20 ms. It checks `sweep::vertex_face` and `sweep::edge_edge`.
//!
//! Contact is possible only at roots of the volume of the four corners. If the volume is zero at
//! all times, contact can begin only at the root of an area or of a difference of coordinates. Each
//! root is tested in turn. Signs at a root are signs of polynomials at an algebraic number.

use std::cmp::Ordering;

use dashu_ratio::RBig;

use super::polynomial::Polynomial;
use crate::ccd::QueryKind;

/// Root of a polynomial: the only one above `low` and up to `high`, or `low` itself if the two are
/// equal.
#[derive(Clone, Debug)]
pub struct Root {
    polynomial: Polynomial,
    low: RBig,
    high: RBig,
}

/// Position over time, by axis.
type Point = [Polynomial; 3];

/// Returns the first time in [0, 1] at which the sets touch, or `None` if they never do.
///
/// # Panics
/// Panics if a coordinate is not finite.
pub fn first_contact(kind: QueryKind, t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4]) -> Option<Root> {
    let exact = |x: f64| RBig::try_from(x).expect("finite");
    let corners: [Point; 4] =
        std::array::from_fn(|i| std::array::from_fn(|k| Polynomial::linear(exact(t0[i][k]), exact(t1[i][k]))));
    let [a, b, c, d] = &corners;
    let volume = dot(&cross(&minus(b, a), &minus(c, a)), &minus(d, a));
    let candidates = if volume.is_zero() {
        let mut all = Polynomial::linear(RBig::ZERO, RBig::ONE);
        let mut seen = vec![all.clone()];
        let faces = [[a, b, c], [a, b, d], [a, c, d], [b, c, d]];
        let areas = faces.iter().flat_map(|[p, q, r]| cross(&minus(q, p), &minus(r, p)));
        let pairs = [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)];
        let differences = pairs.iter().flat_map(|(p, q)| minus(p, q));
        for polynomial in areas.chain(differences).filter(|p| !p.is_constant()).map(|p| p.monic()) {
            if !seen.contains(&polynomial) {
                all = all.times(&polynomial).squarefree();
                seen.push(polynomial);
            }
        }
        all
    } else {
        volume
    };
    Root::all_of(&candidates).into_iter().find_map(|mut root| touches(kind, &corners, &mut root).then_some(root))
}

/// Reports whether the sets have a point in common at a time at which their corners are in one
/// plane.
fn touches(kind: QueryKind, [a, b, c, d]: &[Point; 4], t: &mut Root) -> bool {
    match kind {
        QueryKind::VertexFace => {
            let normal = cross(&minus(c, b), &minus(d, b));
            if let Some((axis, facing)) = across(&normal, t) {
                return [(b, c), (c, d), (d, b)].into_iter().all(|(p, q)| {
                    let side = t.sign(&cross(&minus(q, p), &minus(a, p))[axis]);
                    side == facing || side == Ordering::Equal
                });
            }
            [(b, c), (c, d), (d, b)].into_iter().any(|(p, q)| on_segment(a, p, q, t))
        }
        QueryKind::EdgeEdge => {
            let normal = cross(&minus(b, a), &minus(d, c));
            if let Some((axis, _)) = across(&normal, t) {
                let mut straddles = |p: &Point, q: &Point, r: &Point, s: &Point| {
                    let sides = [r, s].map(|x| t.sign(&cross(&minus(q, p), &minus(x, p))[axis]));
                    sides[0] == Ordering::Equal || sides[0] != sides[1]
                };
                return straddles(a, b, c, d) && straddles(c, d, a, b);
            }
            [(a, c, d), (b, c, d), (c, a, b), (d, a, b)].into_iter().any(|(x, p, q)| on_segment(x, p, q, t))
        }
    }
}

/// Returns an axis along which a vector is not zero, and its sign there, or `None` for a zero
/// vector.
fn across(vector: &Point, t: &mut Root) -> Option<(usize, Ordering)> {
    (0..3).map(|axis| (axis, t.sign(&vector[axis]))).find(|(_, sign)| *sign != Ordering::Equal)
}

fn on_segment(x: &Point, p: &Point, q: &Point, t: &mut Root) -> bool {
    across(&cross(&minus(q, p), &minus(x, p)), t).is_none()
        && (0..3).all(|k| t.sign(&x[k].minus(&p[k]).times(&x[k].minus(&q[k]))) != Ordering::Greater)
}

impl Root {
    /// Returns the roots in [0, 1] of a polynomial that is not zero, in order.
    fn all_of(polynomial: &Polynomial) -> Vec<Self> {
        let polynomial = polynomial.squarefree();
        let mut roots = Vec::new();
        if polynomial.at(&RBig::ZERO) == RBig::ZERO {
            roots.push(Self { polynomial: polynomial.clone(), low: RBig::ZERO, high: RBig::ZERO });
        }
        let sturm = polynomial.sturm();
        let mut stack = vec![(RBig::ZERO, RBig::ONE)];
        while let Some((low, high)) = stack.pop() {
            match sturm.roots_between(&low, &high) {
                0 => {}
                1 => roots.push(Self { polynomial: polynomial.clone(), low, high }),
                _ => {
                    let middle = halfway(&low, &high);
                    stack.push((middle.clone(), high));
                    stack.push((low, middle));
                }
            }
        }
        roots
    }

    /// Compares the root with a number.
    ///
    /// # Panics
    /// Panics if the number is not finite.
    pub fn compare(&self, t: f64) -> Ordering {
        let t = RBig::try_from(t).expect("finite");
        if self.low == self.high || t <= self.low {
            // Above the lower end, unless the root is the lower end.
            return if self.low == self.high { self.low.cmp(&t) } else { Ordering::Greater };
        }
        if t > self.high {
            return Ordering::Less;
        }
        if self.polynomial.at(&t) == RBig::ZERO {
            return Ordering::Equal;
        }
        if self.polynomial.sturm().roots_between(&self.low, &t) == 1 { Ordering::Less } else { Ordering::Greater }
    }

    /// Compares the value of another polynomial at this root with zero.
    fn sign(&mut self, of: &Polynomial) -> Ordering {
        if of.is_zero() {
            return Ordering::Equal;
        }
        if self.low == self.high {
            return of.at(&self.low).cmp(&RBig::ZERO);
        }
        let common = self.polynomial.common_divisor(of);
        if !common.is_constant() && common.squarefree().sturm().roots_between(&self.low, &self.high) > 0 {
            return Ordering::Equal;
        }
        let sturm = of.squarefree().sturm();
        while sturm.roots_between(&self.low, &self.high) > 0 {
            let middle = halfway(&self.low, &self.high);
            if self.polynomial.sturm().roots_between(&self.low, &middle) == 1 {
                self.high = middle;
            } else {
                self.low = middle;
            }
        }
        of.at(&self.high).cmp(&RBig::ZERO)
    }
}

fn halfway(low: &RBig, high: &RBig) -> RBig {
    (low + high) / RBig::from(2)
}

fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|k| a[k].minus(&b[k]))
}

fn cross(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].times(&b[j]).minus(&a[j].times(&b[i]))
    })
}

fn dot(a: &Point, b: &Point) -> Polynomial {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_hit_faces_at_known_times() {
        let face = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let query = |from: [f64; 3], to: [f64; 3]| {
            let with = |vertex| [vertex, face[0], face[1], face[2]];
            first_contact(QueryKind::VertexFace, &with(from), &with(to))
        };
        // Through the face after 1/3 of the way, onto it at the end, along it in its plane, beside
        // it, above it.
        let third = query([1.0, 1.0, 1.0], [1.0, 1.0, -2.0]).expect("contact");
        assert_eq!(third.compare(1.0 / 3.0), Ordering::Greater);
        assert_eq!(third.compare((1.0_f64 / 3.0).next_up()), Ordering::Less);
        assert_eq!(query([1.0, 1.0, 1.0], [1.0, 1.0, 0.0]).expect("contact").compare(1.0), Ordering::Equal);
        assert_eq!(query([-1.0, 1.0, 0.0], [3.0, 1.0, 0.0]).expect("contact").compare(0.25), Ordering::Equal);
        assert_eq!(query([1.0, 1.0, 0.0], [3.0, 1.0, 0.0]).expect("contact").compare(0.0), Ordering::Equal);
        assert!(query([3.0, 3.0, 1.0], [3.0, 3.0, -1.0]).is_none());
        assert!(query([1.0, 1.0, 1.0], [1.0, 1.0, 0.1]).is_none());
    }

    #[test]
    fn crossed_edges_touch_at_a_known_time() {
        // One of two crossed edges moves from z = 1 to z = -2, through the other one at t = 1/3.
        let t0 = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let t1 = [[-1.0, 0.0, -2.0], [1.0, 0.0, -2.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let root = first_contact(QueryKind::EdgeEdge, &t0, &t1).expect("contact");
        assert_eq!((root.compare(0.333), root.compare(0.334)), (Ordering::Greater, Ordering::Less));
        let beside = [t1[0].map(|x| x - 1.0), t1[0], t1[2], t1[3]];
        assert!(first_contact(QueryKind::EdgeEdge, &[t0[0].map(|x| x - 1.0), t0[0], t0[2], t0[3]], &beside).is_none());
    }
}
