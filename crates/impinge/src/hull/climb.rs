//! Climbing from vertex to neighbor to the vertex that is farthest along a direction (*Notes on
//! Real Time Collision Detection*, 2.2; Ericson, *Real-Time Collision Detection*, 4.2.5).
//!
//! A hull lies in the cone of the edges at each of its vertices. So a vertex that no neighbor
//! exceeds is one of the farthest: there are no false summits, and no step along a plateau is
//! needed. Only rounding can mislead. So a step is taken only if it certainly leads up, and exact
//! comparisons confirm the end. Every step leads up over the reals, whatever the direction was, so
//! the climb cannot run in circles.
//!
//! A path may be long, on needles, or wide, at the tip of a cone. So once a climb has visited as
//! many vertices as there are, a scan of all vertices takes over. A query on more than a few
//! vertices then costs at most the sum of both.
//!
//! The tests are in `tests/it/hull/support.rs`.

use std::collections::HashSet;

use super::{Hull, usable};
use crate::exact::compare_along;
use crate::math::Sign::{Positive, Zero};
use crate::math::relative::{UNDERFLOW, UNIT_ROUNDOFF};
use crate::math::vec3::dot;

/// Minimum number of vertices that a climb may visit before a scan takes over. Visiting 128 costs
/// no more than starting a scan.
const MIN_SCAN_BUDGET: usize = 128;

impl Hull {
    /// Returns the same vertex as [`support`](Self::support), found by climbing from vertex
    /// `start`. Vertices are indices into [`positions`](Self::positions). The answer does not
    /// depend on `start`; a start near the answer is faster.
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
    /// If `start` is not below the number of vertices.
    ///
    /// # Complexity
    /// One step per vertex on the path from the start to the farthest vertex; each step visits all
    /// neighbors of one vertex. After as many visits as there are vertices, and at least 128,
    /// [`support`](Self::support) takes over. Ties cost extra: all equally far vertices are
    /// visited.
    #[must_use]
    pub fn support_from(&self, direction: [f64; 3], start: u32) -> u32 {
        let direction = usable(direction);
        climb_to_least(self, &direction, start)
    }
}

/// Returns a vertex that is farthest along a direction.
///
/// # Panics
/// If there is no vertex `start`.
pub(crate) fn climb(hull: &Hull, direction: &[f64; 3], start: u32) -> u32 {
    summit(hull, direction, start).0
}

/// Returns the lowest index of the vertices that are farthest along a direction. [`climb`] may
/// return any of them.
///
/// # Panics
/// If there is no vertex `start`.
fn climb_to_least(hull: &Hull, direction: &[f64; 3], start: u32) -> u32 {
    let (farthest, is_alone) = summit(hull, direction, start);
    if is_alone { farthest } else { least_of_ties(hull, direction, farthest) }
}

/// Returns a vertex that is farthest along a direction, and whether it is certainly the only one.
fn summit(hull: &Hull, direction: &[f64; 3], start: u32) -> (u32, bool) {
    let positions = hull.positions();
    let value = |vertex: u32| dot(direction, &positions[vertex as usize]);
    let reach = hull.reach();
    // Each product has three roundings, and so has a neighbor's value.
    let size = dot(&direction.map(f64::abs), &reach);
    let error = 8.0 * UNIT_ROUNDOFF * size + UNDERFLOW;
    let mut budget = positions.len().max(MIN_SCAN_BUDGET);
    let (mut at, mut height) = (start, value(start));
    loop {
        let neighbors = hull.neighbors(at);
        let Some(left) = budget.checked_sub(neighbors.len()) else {
            return (hull.extremes().along(positions, direction), false);
        };
        budget = left;
        let (mut best, mut best_height) = (at, height);
        let mut is_certain = true;
        for &neighbor in neighbors {
            let other = value(neighbor);
            if other > best_height {
                (best, best_height) = (neighbor, other);
            }
            // The comparison is false if either side is NaN, after an overflow.
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
            match neighbors.iter().find(is_higher) {
                Some(&higher) => (at, height) = (higher, value(higher)),
                None => return (at, false),
            }
        }
    }
}

/// Returns the lowest index of the vertices that are as far along a direction as `farthest`, which
/// is one of the farthest. They form a face of the hull, so its edges connect them.
fn least_of_ties(hull: &Hull, direction: &[f64; 3], farthest: u32) -> u32 {
    let positions = hull.positions();
    let is_tied =
        |vertex: u32| compare_along(direction, &positions[vertex as usize], &positions[farthest as usize]) == Zero;
    let mut ties = vec![farthest];
    let mut next = 0;
    let mut is_known = HashSet::from([farthest]);
    while let Some(&tie) = ties.get(next) {
        next += 1;
        ties.extend(hull.neighbors(tie).iter().filter(|&&other| is_tied(other) && is_known.insert(other)));
    }
    ties.into_iter().min().unwrap_or(farthest)
}
