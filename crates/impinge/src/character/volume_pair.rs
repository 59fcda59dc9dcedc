//! Tests whether two hit volumes of characters may overlap; a no is proved.
//!
//! Tests: `impinge-files/tests/it/characters/strikes.rs`. Benchmark: `characters`.

use crate::input::InputError;
use crate::query;
use crate::volume::Proximity;

use super::frame::Frame;
use super::overlap::contains_origin;
use super::transform::apply_transposed;
use super::volume::HitVolume;
use crate::math::vec3::{Vector, add, dot, length, scale, sub};

/// A volume in its frame.
#[derive(Clone, Copy)]
pub(super) struct PlacedVolume<'a> {
    pub(super) volume: &'a HitVolume,
    pub(super) frame: &'a Frame,
    /// A sphere around it, in the world: center and radius.
    pub(super) sphere: (Vector, f64),
}

impl PlacedVolume<'_> {
    /// Returns the point that is farthest along a direction, in the world.
    fn support(&self, direction: Vector) -> Vector {
        self.frame.apply(self.volume.support(apply_transposed(&self.frame.rotation, direction)))
    }

    /// Returns a bound on the magnitude of all numbers that its points are computed from.
    fn size(&self) -> f64 {
        length(&self.sphere.0) + length(&self.frame.origin) + self.sphere.1
    }
}

/// Reports whether two volumes may overlap: `false` is returned only if they are proved apart.
pub(super) fn may_overlap(a: &PlacedVolume<'_>, b: &PlacedVolume<'_>) -> Result<bool, InputError> {
    // Most volumes of a character are spheres and capsules. They have a closed form, with margins
    // larger than its rounding errors.
    if let (Some(core_a), Some(core_b)) = (segment(a.volume), segment(b.volume)) {
        let [ends_a, ends_b] = [core_a.map(|p| a.frame.apply(p)), core_b.map(|p| b.frame.apply(p))];
        let (p, q) = super::segments::closest(ends_a, ends_b);
        let sum = a.volume.radius() + b.volume.radius();
        let size = a.size() + b.size();
        let between = sub(&q, &p);
        let reach = sum + 1e-13 * size;
        if dot(&between, &between) <= reach * reach {
            return Ok(true);
        }
        // A plane between the volumes proves them apart, whatever the rounding of the closest
        // points.
        let most = |ends: [Vector; 2]| dot(&between, &ends[0]).max(dot(&between, &ends[1]));
        let least = |ends: [Vector; 2]| dot(&between, &ends[0]).min(dot(&between, &ends[1]));
        let gap = least(ends_b) - most(ends_a);
        return Ok(gap <= (reach + 1e-13 * size) * length(&between));
    }
    let size = a.size() + b.size();
    let difference = |direction: Vector| sub(&a.support(direction), &b.support(scale(&direction, -1.0)));
    if let Some(found) = contains_origin(difference, sub(&b.sphere.0, &a.sphere.0), 1e-12 * size, size) {
        return Ok(found);
    }
    let (placed_a, placed_b) = (a.volume.placed(a.frame.pose()?)?, b.volume.placed(b.frame.pose()?)?);
    Ok(query::proximity(&placed_a, &placed_b) != Proximity::Apart)
}

/// Returns the ends of the segment that a sphere or capsule is swept along, or `None` for other
/// volumes.
fn segment(volume: &HitVolume) -> Option<[Vector; 2]> {
    match volume {
        HitVolume::Sphere(sphere) => Some([sphere.center(); 2]),
        HitVolume::Capsule(capsule) => Some(capsule.ends()),
        _ => None,
    }
}

/// Returns as a mesh the core of a sphere-swept volume, or the surface of a box or hull. Points and
/// segments become triangles without area.
pub(super) fn core(volume: &HitVolume) -> (Vec<Vector>, Vec<[u32; 3]>) {
    match volume {
        HitVolume::Sphere(sphere) => (vec![sphere.center()], vec![[0; 3]]),
        HitVolume::Capsule(capsule) => (capsule.ends().to_vec(), vec![[0, 1, 1]]),
        HitVolume::Lozenge(lozenge) => {
            let ([u, v], c) = (lozenge.edges(), lozenge.corner());
            (vec![c, add(&c, &u), add(&c, &v), add(&add(&c, &u), &v)], vec![[0, 1, 2], [1, 3, 2]])
        }
        HitVolume::Box(obb) => {
            const FACES: [[u32; 3]; 12] = [
                [0, 2, 1],
                [1, 2, 3],
                [4, 5, 6],
                [5, 7, 6],
                [0, 1, 4],
                [1, 5, 4],
                [2, 6, 3],
                [3, 6, 7],
                [0, 4, 2],
                [2, 4, 6],
                [1, 3, 5],
                [3, 7, 5],
            ];
            (obb.corners().to_vec(), FACES.to_vec())
        }
        HitVolume::Hull(hull) => (hull.hull().positions().to_vec(), hull.hull().faces().to_vec()),
    }
}
