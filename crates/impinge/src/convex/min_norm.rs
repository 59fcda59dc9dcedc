//! The exact least distance of two posed polytopes. It decides every boolean query about them.
//!
//! The square of that distance is rational. The descent goes from simplex to simplex, each spanned
//! by differences of vertices, starting with the one that floats proposed. The nearest point of the
//! simplex gives a direction. A vertex beyond it gives a simplex that is strictly nearer. If there
//! is no vertex beyond it, the simplex is nearest. No simplex occurs twice and there are finitely
//! many, so no limit of steps is needed. A good start leaves one or two.
//!
//! Nothing is divided. Only Δ·x of the nearest point x is formed; Δ is the Gram determinant of the
//! simplex, which is above zero.
//!
//! # Source
//! The descent is that of Wolfe, *Finding the nearest point in a polytope*, Mathematical
//! Programming 11, 1976. The weights are the determinants of Johnson's subalgorithm (Gilbert,
//! Johnson, Keerthi 1988). With Δ_i(\{i\}) = 1 and Δ_j(S ∪ \{j\}) = Σ_i Δ_i(S) (y_i·y_k - y_i·y_j),
//! k being any member of S, the nearest point is that of the part S for which all Δ_i(S) are above
//! zero and no Δ_j(S ∪ \{j\}) is. In exact numbers such a part exists.
//!
//! The proof is docs/notes/proof.md, L21, and the tests are in `tests/it/shapes/hulls.rs`.

use super::posed::{Difference, Pair, Posed, Spot};
use crate::exact::world_point;
use crate::math::Sign;
use crate::math::direction::rounded_direction;
use crate::math::dyadic::{self, Dyadic};
use crate::math::vec3::dot;

type Point = [Dyadic; 3];

/// An exact difference of vertices.
#[derive(Clone, Debug)]
struct Vertex {
    rounded: Difference,
    exact: Point,
}

/// The nearest point x of a simplex, as the vector Δ x, the Gram determinant Δ, and Δ |x|².
#[derive(Debug)]
struct Foot {
    vector: Point,
    gram: Dyadic,
    squared: Dyadic,
    weights: Vec<Dyadic>,
}

/// The least distance of two polytopes.
#[derive(Debug)]
pub(super) struct LeastDistance {
    /// The squared distance in world units, as numerator and denominator. The denominator is above
    /// zero.
    squared: [Dyadic; 2],
    /// The differences that span the nearest points, and the weight of each.
    pub(super) simplex: Vec<Difference>,
    pub(super) weights: Vec<f64>,
}

impl LeastDistance {
    /// Reports whether the polytopes have a common point.
    pub(super) fn is_zero(&self) -> bool {
        !is_positive(self.squared[0].sign())
    }

    /// Reports whether the distance is at most the root of `squared`.
    pub(super) fn is_at_most_root_of(&self, squared: &Dyadic) -> bool {
        !is_positive((&self.squared[0] - &(squared * &self.squared[1])).sign())
    }

    /// Returns a lower and an upper bound on the distance, in a unit that is a power of two.
    ///
    /// # Accuracy
    /// The quotient is rounded once and its root once, so two neighboring floats on either side
    /// hold the truth. A distance below 2^-509 units gets the lower bound zero.
    pub(super) fn bounds(&self, unit: f64) -> [f64; 2] {
        const MIN_ROOT: f64 = f64::from_bits((1023 - 509) << 52);
        if self.is_zero() {
            return [0.0; 2];
        }
        let numerator = &self.squared[0] * &Dyadic::product(1.0 / unit, 1.0 / unit);
        let root = Dyadic::nearest_quotient(&numerator, &self.squared[1]).sqrt();
        if root < MIN_ROOT { [0.0, MIN_ROOT] } else { [root.next_down().next_down(), root.next_up().next_up()] }
    }
}

/// Returns the least distance of two polytopes, starting from a simplex that is probably near.
/// Returns `None` if either core is not a polytope.
pub(super) fn least_distance(pair: &Pair<'_>, start: &[Difference]) -> Option<LeastDistance> {
    let (corners_a, corners_b) = (pair.a.corners()?, pair.b.corners()?);
    let first = Difference::between(pair.a.spot(*corners_a.first()?), pair.b.spot(*corners_b.first()?));
    let mut simplex: Vec<Vertex> =
        start.iter().take(4).chain(start.is_empty().then_some(&first)).map(|&rounded| exactly(pair, rounded)).collect();
    loop {
        let foot = nearest(&mut simplex);
        let beyond =
            if is_positive(foot.squared.sign()) { vertex_beyond(pair, &foot, corners_a, corners_b) } else { None };
        match beyond {
            Some(vertex) => simplex.push(vertex),
            None => {
                let weights = foot.weights.iter().map(|weight| Dyadic::nearest_quotient(weight, &foot.gram)).collect();
                let simplex = simplex.iter().map(|vertex| vertex.rounded).collect();
                // |x|² = Δ |x|² / Δ.
                return Some(LeastDistance { squared: [foot.squared, foot.gram], simplex, weights });
            }
        }
    }
}

fn exactly(pair: &Pair<'_>, rounded: Difference) -> Vertex {
    let (a, b) = (world_point(pair.a.pose(), &rounded.a.local), world_point(pair.b.pose(), &rounded.b.local));
    Vertex { rounded, exact: [0, 1, 2].map(|k| &a[k] - &b[k]) }
}

/// Returns the nearest point of a simplex, and leaves the simplex with the vertices that span it.
fn nearest(simplex: &mut Vec<Vertex>) -> Foot {
    let count = simplex.len();
    let products: Vec<Vec<Dyadic>> =
        simplex.iter().map(|y| simplex.iter().map(|z| dyadic::dot(&y.exact, &z.exact)).collect()).collect();
    // Determinants by part (a set of bits), then by member of the part or by the vertex that would
    // be added.
    let mut determinants = vec![[const { Dyadic::ZERO }; 4]; 1 << count];
    let members = |part: usize| (0..count).filter(move |&i| part >> i & 1 == 1);
    for i in 0..count {
        determinants[1 << i][i] = Dyadic::from_f64(1.0);
    }
    let mut found = None;
    for part in 1_usize..1 << count {
        let k = part.trailing_zeros() as usize;
        let is_inside = members(part).all(|i| is_positive(determinants[part][i].sign()));
        let mut is_nearest = is_inside;
        for j in (0..count).filter(|j| part >> j & 1 == 0) {
            let grown = members(part)
                .fold(Dyadic::ZERO, |sum, i| &sum + &(&determinants[part][i] * &(&products[i][k] - &products[i][j])));
            is_nearest &= !is_positive(grown.sign());
            determinants[part | 1 << j][j] = grown;
        }
        if is_nearest {
            found = Some(part);
            break;
        }
    }
    // Exact arithmetic always finds a part. The last part keeps this function total.
    let part = found.unwrap_or((1 << count) - 1);
    let k = part.trailing_zeros() as usize;
    let weights: Vec<Dyadic> = members(part).map(|i| determinants[part][i].clone()).collect();
    let mut foot =
        Foot { vector: [Dyadic::ZERO; 3], gram: Dyadic::ZERO, squared: Dyadic::ZERO, weights: weights.clone() };
    for (i, weight) in members(part).zip(&weights) {
        foot.vector = [0, 1, 2].map(|axis| &foot.vector[axis] + &(weight * &simplex[i].exact[axis]));
        foot.gram = &foot.gram + weight;
        // x·y is the same for all members, and equals |x|².
        foot.squared = &foot.squared + &(weight * &products[i][k]);
    }
    let mut position = 0..;
    simplex.retain(|_| position.next().is_some_and(|i: usize| part >> i & 1 == 1));
    foot
}

/// Returns the difference of vertices that is farthest beyond the plane through the nearest point,
/// or `None` if none is beyond it.
fn vertex_beyond(pair: &Pair<'_>, foot: &Foot, corners_a: &[[f64; 3]], corners_b: &[[f64; 3]]) -> Option<Vertex> {
    let direction = rounded_direction(&foot.vector)?.map(|x| -x);
    let against = [0, 1, 2].map(|k| &Dyadic::ZERO - &foot.vector[k]);
    let a = farthest(&pair.a, corners_a, direction, &against, pair.height_error(direction));
    let b = farthest(&pair.b, corners_b, direction.map(|x| -x), &foot.vector, pair.height_error(direction));
    let vertex = exactly(pair, Difference::between(a, b));
    is_positive((&foot.squared - &dyadic::dot(&foot.vector, &vertex.exact)).sign()).then_some(vertex)
}

/// Returns the corner that is farthest along a direction, exactly. The rounded direction and its
/// error avoid most exact comparisons.
fn farthest(set: &Posed<'_>, corners: &[[f64; 3]], rounded: [f64; 3], exact: &Point, error: f64) -> Spot {
    let height = |spot: &Spot| dot(&rounded, &spot.point);
    let spots = || corners.iter().map(|&corner| set.spot(corner));
    let highest = spots().map(|spot| height(&spot)).fold(f64::NEG_INFINITY, f64::max);
    let mut best: Option<(Dyadic, Spot)> = None;
    for spot in spots().filter(|spot| height(spot) >= highest - 2.0 * error) {
        let found = dyadic::dot(exact, &world_point(set.pose(), &spot.local));
        if best.as_ref().is_none_or(|(least, _)| is_positive((&found - least).sign())) {
            best = Some((found, spot));
        }
    }
    best.map_or_else(|| set.spot([0.0; 3]), |(_, spot)| spot)
}

fn is_positive(sign: Sign) -> bool {
    sign == Sign::Positive
}
