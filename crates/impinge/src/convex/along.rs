//! Contacts of two convex shapes along given normals. They are needed if the shortest way apart is
//! no way out, because it leads into other parts of the same surface.
//!
//! The tests are in `tests/it/shapes/surfaces.rs` and `tests/it/shapes/mesh_contacts.rs`.

use super::facing::facet_normals;
use super::manifold::{Contacts, Faceted, Side, contacts_over};
use super::posed::{Pair, Posed};
use crate::math::vec3::dot;

/// Two shapes whose contacts along many normals are asked for.
pub(super) struct Along<'s> {
    pair: Pair<'s>,
    sides: [Side<'s>; 2],
    /// Whether the second shape comes first in the arithmetic.
    is_swapped: bool,
}

impl<'s> Along<'s> {
    pub(super) fn new(a: &Faceted<'s>, b: &Faceted<'s>) -> Self {
        let is_swapped = !a.swept.is_before(&b.swept);
        let [a, b] = if is_swapped { [b, a] } else { [a, b] };
        let pair = Pair::new(&a.swept, &b.swept);
        let sides = [Side::new(&pair.a, a), Side::new(&pair.b, b)];
        Self { pair, sides, is_swapped }
    }

    /// Returns how far the second shape must move along a normal of length 1 to be beyond the
    /// first, rounded. It is negative if it is beyond it already.
    pub(super) fn depth(&self, normal: [f64; 3]) -> f64 {
        let normal = self.in_order(normal);
        let radius: f64 = self.sides.iter().map(Side::radius).sum();
        dot(&normal, &self.pair.support(normal).vector) * self.pair.unit + radius
    }

    /// Returns the contacts along a normal of length 1 from the first shape to the second. They are
    /// the places where the facing sides lie over each other and are at most `margin` apart. The
    /// list may be empty.
    pub(super) fn contacts(&self, normal: [f64; 3], margin: f64) -> Contacts {
        let [a, b] = &self.sides;
        let found = contacts_over(&self.pair, [a, b], self.in_order(normal), margin);
        if self.is_swapped { found.swapped() } else { found }
    }

    fn in_order(&self, normal: [f64; 3]) -> [f64; 3] {
        if self.is_swapped { normal.map(|x| 0.0 - x) } else { normal }
    }
}

/// Returns the contacts of two shapes along the normal of each facet of either, the least deep
/// first. Normals along which nothing is at most `margin` apart are left out.
pub(crate) fn contacts_along_facets(a: &Faceted<'_>, b: &Faceted<'_>, margin: f64) -> Vec<Contacts> {
    let pair = Pair::new(&a.swept, &b.swept);
    let normals =
        |set: &Posed<'_>, shape: &Faceted<'_>| shape.facets.map_or(Vec::new(), |facets| facet_normals(set, facets));
    let opposite = normals(&pair.b, b).into_iter().map(|normal| normal.map(|x| 0.0 - x));
    let normals = normals(&pair.a, a).into_iter().chain(opposite);
    let along = Along::new(a, b);
    let mut found: Vec<Contacts> = normals.map(|normal| along.contacts(normal, margin)).collect();
    found.retain(|found| !found.contacts.is_empty());
    found.sort_by(|x, y| x.deepest().total_cmp(&y.deepest()));
    found
}
