//! Verbs on two shapes: the table of pairs of representations, the search for a depth, and contacts.
//!
//! `table` says what a verb makes of two parts, by what they are. `search` finds the depth of shapes that are not convex, with
//! `beyond` and `balls`. `contacts` makes manifolds.

mod balls;
mod beyond;
pub(super) mod contacts;
pub(super) mod search;
pub(super) mod table;

use super::Proximity;
use crate::convex::{self, Coherence};
use crate::shape::{Form, PlacedShape};

/// Beyond this, 2^320 world units, everything is nearer, and sums stay in range below it.
const FAR: f64 = f64::from_bits((1023 + 320) << 52);

/// Whether two shapes come within a clearance, which is not negative.
pub(super) fn nearness(a: &PlacedShape, b: &PlacedShape, clearance: f64) -> Proximity {
    // No two shapes are farther apart than that.
    table::nearness(a, b, clearance.min(FAR))
}

/// [`nearness`], from what was known last of two convex shapes.
pub(super) fn nearness_from(a: &PlacedShape, b: &PlacedShape, clearance: f64, known: &mut Coherence) -> Proximity {
    if let ([part_a], [part_b]) = (a.parts(), b.parts())
        && let (Form::Convex(a), Form::Convex(b)) = (part_a.form(), part_b.form())
        && clearance <= FAR
    {
        // As without a cache, so that the answer is the same.
        let is_far = table::gap_of_boxes(part_a, part_b) > clearance;
        return if is_far { Proximity::Apart } else { convex::nearness_from(&a, &b, clearance, known) };
    }
    nearness(a, b, clearance)
}
