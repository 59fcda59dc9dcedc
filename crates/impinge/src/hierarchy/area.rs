//! The surface area of boxes, by which trees are judged: the chance that a random line or a small box that meets a
//! parent also meets its child is the ratio of their areas (Goldsmith, Salmon, *Automatic creation of object hierarchies
//! for ray tracing*, 1987).

use crate::volume::Aabb;

/// Half the surface area of a box that is not empty; in double precision, in which no product of extents of single
/// precision overflows or vanishes.
#[inline(always)]
pub(super) fn half_area(bounds: &Aabb) -> f64 {
    let [x, y, z] = extents(bounds);
    x * y + y * z + z * x
}

/// The lengths of the edges.
#[inline(always)]
pub(super) fn extents(bounds: &Aabb) -> [f64; 3] {
    std::array::from_fn(|axis| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]))
}

/// Half the area of what two boxes have in common; zero where they are apart.
pub(super) fn half_area_in_common(a: &Aabb, b: &Aabb) -> f64 {
    let common = Aabb {
        min: std::array::from_fn(|axis| a.min[axis].max(b.min[axis])),
        max: std::array::from_fn(|axis| a.max[axis].min(b.max[axis])),
    };
    if (0..3).all(|axis| common.min[axis] <= common.max[axis]) { half_area(&common) } else { 0.0 }
}

/// Of areas below a node, and its own, over its own.
pub(super) fn cost(below: f64, area: f64) -> f64 {
    if area > 0.0 { below / area } else { 1.0 }
}
