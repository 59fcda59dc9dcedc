//! Queries about two shapes: the table of pairs of representations, the search for a depth, and
//! contacts.
//!
//! `table` chooses the kernel for two parts by their representations; `surfaces` has those of two
//! meshes, `fields` those of height fields and meshes. `search` finds the depth of
//! shapes that are not convex, with `directions`, `beyond` and `spheres`. `contacts` makes
//! manifolds, with `seams` for those of compounds.

mod beyond;
pub(super) mod contacts;
mod directions;
mod fields;
pub(super) mod seams;
pub(super) mod search;
mod spheres;
mod surfaces;
pub(super) mod table;

use super::Proximity;
use crate::budget::Budget;
use crate::convex::{self, Coherence};
use crate::shape::{Form, PlacedShape};

/// Maximum clearance, 2^320 world units. All distances are smaller, and sums of smaller numbers do
/// not overflow.
const MAX_CLEARANCE: f64 = f64::from_bits((1023 + 320) << 52);

/// Returns whether two shapes are at most `clearance` apart. `clearance` must not be negative or
/// NaN. The answer is undecided if the budget ends the query.
pub(super) fn nearness(a: &PlacedShape, b: &PlacedShape, clearance: f64, budget: &Budget<'_>) -> Proximity {
    // No two shapes are farther apart than that.
    table::nearness(a, b, clearance.min(MAX_CLEARANCE), budget)
}

/// Returns [`nearness`], starting from the direction along which two convex shapes were last apart,
/// and updates it.
pub(super) fn nearness_from(
    a: &PlacedShape,
    b: &PlacedShape,
    clearance: f64,
    known: &mut Coherence,
    budget: &Budget<'_>,
) -> Proximity {
    if let ([part_a], [part_b]) = (a.parts(), b.parts())
        && let (Form::Convex(a), Form::Convex(b)) = (part_a.form(), part_b.form())
        && clearance <= MAX_CLEARANCE
    {
        // The same test as without a cache, so that the answer is the same.
        let is_far = table::are_boxes_farther(part_a, part_b, clearance);
        return if is_far { Proximity::Apart } else { convex::nearness_from(&a, &b, clearance, known) };
    }
    nearness(a, b, clearance, budget)
}
