//! Surface areas of boxes, which measure the quality of trees. A random line or a small box that
//! overlaps a parent also overlaps its child with a probability equal to the ratio of their areas
//! (Goldsmith, Salmon, *Automatic creation of object hierarchies for ray tracing*, 1987).

use crate::volume::Aabb;

/// Returns half the surface area of a nonempty box. In double precision no product of
/// single-precision extents overflows or underflows.
#[inline(always)]
pub(super) fn half_area(bounds: &Aabb) -> f64 {
    let [x, y, z] = extents(bounds);
    x * y + y * z + z * x
}

/// Returns the lengths of the edges.
#[inline(always)]
pub(super) fn extents(bounds: &Aabb) -> [f64; 3] {
    std::array::from_fn(|axis| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]))
}

/// Returns half the surface area of the intersection of two boxes, or zero if they are disjoint.
pub(super) fn half_area_in_common(a: &Aabb, b: &Aabb) -> f64 {
    let common = Aabb {
        min: std::array::from_fn(|axis| a.min[axis].max(b.min[axis])),
        max: std::array::from_fn(|axis| a.max[axis].min(b.max[axis])),
    };
    if (0..3).all(|axis| common.min[axis] <= common.max[axis]) { half_area(&common) } else { 0.0 }
}

/// Returns the cost of a subtree by the surface area heuristic: `below`, the sum of the areas below
/// and of the subtree's own, divided by its own area. Returns 1 if the area is zero.
pub(super) fn cost(below: f64, area: f64) -> f64 {
    if area > 0.0 { below / area } else { 1.0 }
}
