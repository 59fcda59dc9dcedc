//! Intersection and distance of two meshes, as surfaces or as solids.

use super::last_hit::LastHit;
use super::nesting::nested;
use super::{Distance, Proximity, Witness};
use crate::budget::Budget;
use crate::mesh::{self, Options, PlacedMesh, WarmStart};

/// Reports whether two meshes have a point in common. `last_hit` makes a repeated query faster.
pub(super) fn proximity(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    last_hit: &mut LastHit,
    options: &Options<'_>,
) -> Proximity {
    match surfaces_intersect(a, b, last_hit, options) {
        true if options.budget.stopped().is_some() => Proximity::Undecided,
        true => Proximity::Intersects,
        false => nested(a, b, options.budget),
    }
}

fn surfaces_intersect(a: PlacedMesh<'_>, b: PlacedMesh<'_>, last_hit: &mut LastHit, options: &Options<'_>) -> bool {
    if let Some(faces) = last_hit.faces_to_try() {
        let is_hit = mesh::faces_intersect(a, b, faces);
        last_hit.record_try(is_hit);
        if is_hit {
            return true;
        }
    }
    let hit = mesh::any_hit(a, b, options);
    last_hit.remember(hit);
    hit.is_some()
}

/// Reports whether two meshes are at most `clearance` apart. `clearance` must not be negative or
/// NaN.
pub(super) fn nearness(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    clearance: f64,
    warm_start: &mut WarmStart,
    options: &Options<'_>,
) -> Proximity {
    let near_faces = mesh::within(a, b, clearance, warm_start, options);
    match near_faces {
        Some(_) if options.budget.stopped().is_some() => Proximity::Undecided,
        Some(_) => Proximity::Intersects,
        None => nested(a, b, options.budget),
    }
}

/// Returns the distance of two meshes, without state from an earlier query.
pub(super) fn distance_without_cache(a: PlacedMesh<'_>, b: PlacedMesh<'_>, budget: &Budget<'_>) -> Distance {
    distance(a, b, &mut WarmStart::default(), &Options { budget, ..Options::default() })
}

/// Returns the distance of two meshes. `warm_start` holds state of the last query, which makes this
/// one faster, and is updated.
pub(super) fn distance(
    a: PlacedMesh<'_>,
    b: PlacedMesh<'_>,
    warm_start: &mut WarmStart,
    options: &Options<'_>,
) -> Distance {
    let Some(found) = mesh::nearest(a, b, warm_start, options) else {
        return Distance { lower: f64::INFINITY, upper: f64::INFINITY, witness: None, proximity: Proximity::Apart };
    };
    let ([point_a, point_b], upper) = (found.points, found.upper);
    let witness = Some(Witness { point_a, point_b, faces: Some(found.faces) });
    if upper == 0.0 {
        return Distance { lower: found.lower, upper, witness, proximity: Proximity::Intersects };
    }
    if options.budget.stopped().is_some() {
        return Distance { lower: 0.0, upper, witness, proximity: Proximity::Undecided };
    }
    match nested(a, b, options.budget) {
        Proximity::Intersects => Distance { lower: 0.0, upper: 0.0, witness: None, proximity: Proximity::Intersects },
        Proximity::Undecided => Distance { lower: 0.0, upper, witness, proximity: Proximity::Undecided },
        Proximity::Apart => Distance { lower: found.lower, upper, witness, proximity: Proximity::Apart },
    }
}
