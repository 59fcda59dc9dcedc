//! Climbing from vertex to neighbour to the one that is farthest along a direction (*Notes on Real Time Collision
//! Detection*, 2.2; Ericson, *Real-Time Collision Detection*, 4.2.5).
//!
//! A hull is in the cone of the edges at any of its vertices, so a vertex that none of its neighbours exceeds is one of the
//! farthest: there are no false summits, and on a plateau none of its vertices needs another. What can go wrong is rounding,
//! so a step is taken only where it certainly leads up, and the end is confirmed by exact comparisons. Every step leads up
//! over the reals, however the turn was, so none leads back.
//!
//! A way may be long, on needles, or wide, at the tip of a cone. So once it has looked at as many vertices as there are, the
//! climb gives way to a scan of all of them: no question of more than a few costs more than both.

use std::collections::HashSet;

use super::{Hull, usable};
use crate::exact::compare_along;
use crate::math::Sign::{Positive, Zero};
use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::dot;

/// As many vertices take no longer to look at than a scan takes to begin.
const FEW: usize = 128;

impl Hull {
    /// As [`support`](Self::support), found by climbing from a vertex that is hoped to be near: the same answer from any.
    ///
    /// ```
    /// # use impinge::hull::Hull;
    /// let cube: Vec<[f32; 3]> = (0..8_u8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f32::from)).collect();
    /// let hull = Hull::new(&cube)?;
    /// // All of the upper side is as far; vertex 4 is the least of it.
    /// assert_eq!(hull.support_from([0.0, 0.0, 1.0], 7), 4);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Panics
    /// Where there is no vertex `start`.
    ///
    /// # Complexity
    /// As many steps as vertices lie between the start and the farthest, each looking at all neighbours of one. Once as many
    /// vertices were looked at as there are, or a hundred, [`support`](Self::support) takes over. Ties are walked through on top.
    #[must_use]
    pub fn support_from(&self, direction: [f64; 3], start: u32) -> u32 {
        let direction = usable(direction);
        climb_to_least(self, &direction, start)
    }
}

/// A vertex that is farthest along a direction.
///
/// # Panics
/// Where there is no vertex `start`.
pub(crate) fn climb(hull: &Hull, direction: &[f64; 3], start: u32) -> u32 {
    summit(hull, direction, start).0
}

/// The least of the vertices that are farthest along a direction, each of which [`climb`] may find.
///
/// # Panics
/// Where there is no vertex `start`.
fn climb_to_least(hull: &Hull, direction: &[f64; 3], start: u32) -> u32 {
    let (farthest, is_alone) = summit(hull, direction, start);
    if is_alone { farthest } else { least_of_ties(hull, direction, farthest) }
}

/// A vertex that is farthest along a direction, and whether that is plain of no other.
fn summit(hull: &Hull, direction: &[f64; 3], start: u32) -> (u32, bool) {
    let positions = hull.positions();
    let value = |vertex: u32| dot(direction, &positions[vertex as usize]);
    let reach = hull.reach();
    // Three roundings on the way of each product, and as many in a rival's value.
    let size = dot(&direction.map(f64::abs), &reach);
    let error = 8.0 * UNIT_ROUNDOFF * size + UNDERFLOW;
    let mut budget = positions.len().max(FEW);
    let (mut at, mut height) = (start, value(start));
    loop {
        let neighbours = hull.neighbours(at);
        let Some(left) = budget.checked_sub(neighbours.len()) else {
            return (hull.extremes().along(positions, direction), false);
        };
        budget = left;
        let (mut best, mut best_height) = (at, height);
        let mut is_certain = true;
        for &neighbour in neighbours {
            let other = value(neighbour);
            if other > best_height {
                (best, best_height) = (neighbour, other);
            }
            // Not where either is NaN, after an overflow.
            is_certain &= other < height - error;
        }
        if best_height > height + error {
            (at, height) = (best, best_height);
        } else if is_certain {
            return (at, true);
        } else {
            let is_higher = |&&other: &&u32| {
                let compared = compare_along(direction, &positions[other as usize], &positions[at as usize]);
                compared == Positive
            };
            match neighbours.iter().find(is_higher) {
                Some(&higher) => (at, height) = (higher, value(higher)),
                None => return (at, false),
            }
        }
    }
}

/// The least of the vertices that are as far along a direction as this one, which is one of the farthest: they form a
/// face of the hull, whose edges connect them.
fn least_of_ties(hull: &Hull, direction: &[f64; 3], farthest: u32) -> u32 {
    let positions = hull.positions();
    let is_tied =
        |vertex: u32| compare_along(direction, &positions[vertex as usize], &positions[farthest as usize]) == Zero;
    let mut ties = vec![farthest];
    let mut next = 0;
    let mut is_known = HashSet::from([farthest]);
    while let Some(&tie) = ties.get(next) {
        next += 1;
        ties.extend(hull.neighbours(tie).iter().filter(|&&other| is_tied(other) && is_known.insert(other)));
    }
    ties.into_iter().min().unwrap_or(farthest)
}
