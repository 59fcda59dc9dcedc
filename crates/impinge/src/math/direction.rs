//! The direction of an exact vector in floats.

use super::Sign;
use super::dyadic::Dyadic;

/// Returns a vector divided by its greatest entry, each entry rounded once, or `None` if it is
/// zero.
pub(crate) fn rounded_direction(vector: &[Dyadic; 3]) -> Option<[f64; 3]> {
    let over = |k: usize| {
        let by = |j: usize| Dyadic::nearest_quotient(&vector[j], &vector[k]);
        let flip = if vector[k].sign() == Sign::Negative { -1.0 } else { 1.0 };
        (vector[k].sign() != Sign::Zero).then(|| [flip * by(0), flip * by(1), flip * by(2)])
    };
    (0..3).filter_map(over).find(|direction| direction.iter().all(|x| x.abs() <= 1.0))
}
