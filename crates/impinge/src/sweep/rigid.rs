//! The time at which two rigidly moving meshes first touch, by conservative advancement (see
//! [`time_of_impact`](super::time_of_impact)).

use super::impact::Impact;
use super::motion::Motion;
use crate::mesh::{Mesh, PlacedMesh};
use crate::query::{Cache, Query, intersects};

/// Maximum number of steps. Meshes that approach each other directly take one or two for each
/// radian of rotation. Meshes that pass each other at a small gap take about one step each time
/// they have moved by the length of the gap.
const MAX_STEPS: usize = 1024;

/// Maximum distance of meshes that count as touching, relative to the sum of their sizes: 2^-38.
/// Nothing more can be proved below it.
pub(super) const TOUCHING: f64 = 1.0 / (1_u64 << 38) as f64;

/// Bound on a length whose square underflows; added so that computed lengths are never too small.
pub(super) const VANISHING: f64 = 1e-150;

/// Returns the time at which two rigidly moving meshes first touch. Each mesh is a surface or a
/// solid. A mesh that starts outside a solid touches its surface first.
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

/// Bounds on the approach of two bodies.
pub(super) struct Course {
    /// Upper bound on the speed at which any two of their points approach each other, in world
    /// units over the whole time.
    pub(super) speed: f64,
    /// Bound on the error of a distance that comes from rounded poses. At time 0 there is none.
    pub(super) error: f64,
    /// Distance that counts as touching.
    pub(super) touching: f64,
}

impl Course {
    /// Returns a time before which nothing touches, or `None` if the bodies stay apart. At that
    /// time the bodies nearly touch, or the limit on steps was reached. `distance` must return a
    /// lower bound on the distance at a time.
    pub(super) fn first_contact(&self, mut distance: impl FnMut(f64) -> f64) -> Option<f64> {
        let Self { speed, error, touching } = *self;
        let mut t = 0.0_f64;
        for _ in 0..MAX_STEPS {
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

/// Returns a time at or after `t` at which the meshes intersect, or infinity. It tries growing
/// steps.
pub(super) fn contact_after(t: f64, intersect: impl Fn(f64) -> bool) -> f64 {
    let steps = (0..13).map(|k| 16.0 * TOUCHING * (1_u64 << (2 * k)) as f64);
    std::iter::once(0.0).chain(steps).map(|step| (t + step).min(1.0)).find(|&t| intersect(t)).unwrap_or(f64::INFINITY)
}

/// Returns an upper bound on the distance of the farthest vertex from the origin of the mesh's
/// frame.
fn reach(mesh: &Mesh) -> f64 {
    let squared = points(mesh).map(|p| p.iter().map(|x| x * x).sum::<f64>()).fold(0.0, f64::max);
    squared.sqrt() * (1.0 + 1e-12) + VANISHING
}

fn points(mesh: &Mesh) -> impl Iterator<Item = [f64; 3]> {
    (0..mesh.positions().len()).map(|vertex| mesh.positions().get(vertex))
}
