//! Merges parts whose common hull is still near the solid.
//!
//! Source: the last step of Wei and others, *Approximate convex decomposition for 3D meshes with
//! collision-aware concavity and tree search*, 2022. Ours departs in the order, by the volume that
//! the common hull adds, and in proving the bound of every merged hull.

use rayon::prelude::*;

use super::covering::volume;
use super::outside::{Goal, Outside, Work, bounds};
use crate::budget::Budget;
use crate::hull::Hull;
use crate::math::vec3::Vector;
use crate::mesh::Mesh;

/// A hull and how far it reaches outside the solid.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) hull: Hull,
    pub(super) outside: Outside,
}

/// Two parts that may be merged.
struct Union {
    /// Places of both parts in the list, the lesser first.
    of: [usize; 2],
    /// Volume of the common hull less those of both parts.
    added: f64,
    /// Upper bound on the distance of the common hull from the solid, once it is computed.
    upper: Option<f64>,
}

/// Ratio of the bounds of common hulls that are merged although they are farther from the solid.
const FORCED_RATIO: f64 = 1.25;

/// Merges parts as long as the common hull of two is proved to be at most `concavity` from the
/// solid, those that add least volume first. Then it merges the parts whose common hull is nearest
/// to the solid, until there are at most `max_parts`. Ends early if the budget is spent.
pub(super) fn merge(
    mesh: &Mesh,
    parts: Vec<Part>,
    (concavity, max_parts): (f64, usize),
    work: &Work,
    budget: &Budget<'_>,
) -> Vec<Part> {
    let mut merging = Merging::of(parts, concavity);
    while !budget.is_spent() {
        let is_measured = |union: &Union| union.upper.is_some();
        if let Some(at) = merging.least(|union| if is_measured(union) { f64::INFINITY } else { union.added })
            && !is_measured(&merging.unions[at])
        {
            let Some(hull) = merging.common_hull(merging.unions[at].of) else { break };
            // One point that is farther is enough to reject the hull, unless there are too many
            // parts.
            let ratio = if merging.count > max_parts { FORCED_RATIO } else { f64::INFINITY };
            let outside = Outside::of(mesh, &hull, Goal { enough: concavity, ratio }, work, budget);
            merging.unions[at].upper = Some(outside.upper);
            if outside.upper <= concavity {
                merging.replace(at, Part { hull, outside });
            }
        } else if merging.count > max_parts {
            if merging.unions.is_empty() {
                merging.reach = f64::INFINITY;
                merging.add_all();
            }
            let Some(at) = merging.least(|union| union.upper.unwrap_or(union.added)) else { break };
            let Some(hull) = merging.common_hull(merging.unions[at].of) else { break };
            let outside = Outside::of(mesh, &hull, Goal { enough: concavity, ratio: FORCED_RATIO }, work, budget);
            merging.replace(at, Part { hull, outside });
        } else {
            break;
        }
    }
    merging.parts.into_iter().flatten().collect()
}

struct Merging {
    /// The parts; merged parts leave their places empty.
    parts: Vec<Option<Part>>,
    /// Number of parts.
    count: usize,
    unions: Vec<Union>,
    /// Maximum gap between the boxes of two parts that may be merged.
    reach: f64,
    /// The largest coordinate, as the unit of volumes.
    size: f64,
}

impl Merging {
    fn of(parts: Vec<Part>, reach: f64) -> Self {
        let size = parts.iter().flat_map(|part| part.hull.reach()).fold(f64::MIN_POSITIVE, f64::max);
        let count = parts.len();
        let parts = parts.into_iter().map(Some).collect();
        let mut merging = Self { parts, count, unions: Vec::new(), reach, size };
        merging.add_all();
        merging
    }

    fn add_all(&mut self) {
        (1..self.parts.len()).for_each(|later| self.add_unions_with(later));
    }

    /// Adds the unions of a part with all parts before it that are near.
    fn add_unions_with(&mut self, later: usize) {
        let Some(Part { hull, .. }) = &self.parts[later] else { return };
        let (own_bounds, own) = (bounds(hull), volume(hull, self.size));
        let union = |earlier: usize| {
            let other = &self.parts[earlier].as_ref()?.hull;
            let of = [earlier, later];
            if gap(&own_bounds, &bounds(other)) > self.reach {
                return None;
            }
            let added = volume(&self.common_hull(of)?, self.size) - own - volume(other, self.size);
            Some(Union { of, added, upper: None })
        };
        let added: Vec<Union> = (0..later).into_par_iter().filter_map(union).collect();
        self.unions.extend(added);
    }

    fn common_hull(&self, of: [usize; 2]) -> Option<Hull> {
        let [a, b] = of.map(|at| self.parts[at].as_ref());
        let positions = [a?.hull.positions(), b?.hull.positions()].concat();
        Hull::new(Hull::new(&positions).ok()?.positions()).ok()
    }

    /// Returns the place of the union with the least cost.
    fn least(&self, cost: impl Fn(&Union) -> f64) -> Option<usize> {
        let key = |at: usize| (cost(&self.unions[at]), self.unions[at].of);
        (0..self.unions.len()).min_by(|&a, &b| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1)))
    }

    /// Replaces both parts of a union by their common hull.
    fn replace(&mut self, union: usize, part: Part) {
        let Union { of, .. } = self.unions.swap_remove(union);
        of.into_iter().for_each(|at| self.parts[at] = None);
        self.unions.retain(|union| !union.of.iter().any(|at| of.contains(at)));
        self.parts.push(Some(part));
        self.count -= 1;
        self.add_unions_with(self.parts.len() - 1);
    }
}

/// Returns the largest gap along an axis between two boxes; negative if they overlap.
fn gap(a: &[Vector; 2], b: &[Vector; 2]) -> f64 {
    (0..3).map(|k| (a[0][k] - b[1][k]).max(b[0][k] - a[1][k])).fold(f64::NEG_INFINITY, f64::max)
}
