//! When two meshes that move rigidly first touch, by conservative advancement ([`time_of_impact`](super::time_of_impact)).

use super::impact::Impact;
use super::motion::Motion;
use crate::mesh::{Mesh, PlacedMesh};
use crate::query::{Cache, Query, intersects};

/// Steps at most. Meshes that go for each other take one or two for each turn of a radian; those that pass each other
/// closely take one for each gap's length of their way.
const STEPS: usize = 1024;

/// Meshes nearer than this share of their sizes count as touching where no more can be proved: 2^-38.
pub(super) const TOUCHING: f64 = 1.0 / (1_u64 << 38) as f64;

/// More than a length whose square vanishes.
pub(super) const VANISHING: f64 = 1e-150;

/// When two meshes, as surfaces or as solids, first touch while each moves rigidly. What starts outside a solid meets its surface
/// first.
pub(super) fn of_meshes([a, b]: [&Mesh; 2], is_solid: [bool; 2], motion_a: &Motion, motion_b: &Motion) -> Impact {
    if a.faces().is_empty() || b.faces().is_empty() {
        return Impact::NEVER;
    }
    let start_a = PlacedMesh { is_solid: is_solid[0], ..a.at(motion_a.at(0.0)) };
    let start_b = PlacedMesh { is_solid: is_solid[1], ..b.at(motion_b.at(0.0)) };
    if intersects(start_a, start_b) {
        return Impact { t_lower: 0.0, t_upper: 0.0 };
    }
    let (reach_a, reach_b) = (reach(a), reach(b));
    let (linear_a, linear_b) = (motion_a.linear(), motion_b.linear());
    let approach = [0, 1, 2].map(|k| linear_a[k] - linear_b[k]);
    let turning = motion_a.turning_speed(points(a)) + motion_b.turning_speed(points(b));
    if turning == 0.0 && approach == [0.0; 3] {
        return Impact::NEVER;
    }
    let speed = (approach.iter().map(|x| x * x).sum::<f64>().sqrt() + turning) * (1.0 + 1e-12) + VANISHING;
    let error = motion_a.error(reach_a) + motion_b.error(reach_b);
    let touching = TOUCHING * (reach_a + reach_b);
    let mut cache = Cache::default();
    let course = Course { speed, error, touching };
    let found = course.first_contact(|t| {
        Query::new().with_cache(&mut cache).distance(a.at(motion_a.at(t)), b.at(motion_b.at(t))).lower
    });
    let Some(t) = found else { return Impact::NEVER };
    Impact { t_lower: t, t_upper: contact_after(t, |t| intersects(a.at(motion_a.at(t)), b.at(motion_b.at(t)))) }
}

/// How two bodies approach each other.
pub(super) struct Course {
    /// No two of their points approach each other faster.
    pub(super) speed: f64,
    /// What rounded poses add to or take from a distance at most, but at the start.
    pub(super) error: f64,
    /// A distance that counts as none.
    pub(super) touching: f64,
}

impl Course {
    /// A time before which nothing touches, where the bodies nearly do or the steps were spent; none where they stay apart. The
    /// distance at a time is not above the true one.
    pub(super) fn first_contact(&self, mut distance: impl FnMut(f64) -> f64) -> Option<f64> {
        let Self { speed, error, touching } = *self;
        let mut t = 0.0_f64;
        for _ in 0..STEPS {
            let gap = distance(t) - if t == 0.0 { 0.0 } else { error };
            if gap > speed * (1.0 - t) * (1.0 + 1e-12) {
                return None;
            }
            let next = (t + gap / speed * (1.0 - 1e-12)).next_down();
            if next.is_nan() || next <= t || gap <= touching {
                break;
            }
            t = next.min(1.0);
        }
        Some(t)
    }
}

/// A time from `t` on at which the meshes intersect, looked for in growing steps.
pub(super) fn contact_after(t: f64, intersect: impl Fn(f64) -> bool) -> f64 {
    let steps = (0..13).map(|k| 16.0 * TOUCHING * (1_u64 << (2 * k)) as f64);
    std::iter::once(0.0).chain(steps).map(|step| (t + step).min(1.0)).find(|&t| intersect(t)).unwrap_or(f64::INFINITY)
}

/// How far the farthest vertex is from the origin of the mesh's frame, or more.
fn reach(mesh: &Mesh) -> f64 {
    let squared = points(mesh).map(|p| p.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max);
    squared.sqrt() * (1.0 + 1e-12) + VANISHING
}

fn points(mesh: &Mesh) -> impl Iterator<Item = [f64; 3]> {
    (0..mesh.positions().len()).map(|vertex| mesh.positions().get(vertex))
}
