//! The depth of two things of which one is not a mesh.
//!
//! A translation that separates the things moves each common point out of one thing, and back out
//! of the other. So no common point is deeper than the penetration depth. Points near the deepest
//! points of the penetration show a lower bound.

use super::answer::Depth;
use crate::budget::Budget;
use crate::math::Pose;
use crate::math::vec3::{Vector, add, scale, sub};
use crate::query::{Placed, Proximity, Query};
use crate::shape::{PlacedShape, Shape};

/// Shares of the way from the deepest point of one thing to that of the other. The ends lie on a
/// surface, where rounding may put a point outside.
const SHARES: [f64; 3] = [1e-9, 0.5, 1.0 - 1e-9];

/// Returns an interval that holds the depth of two things.
pub(super) fn depth_of_shapes(a: &Placed<'_>, b: &Placed<'_>, budget: &Budget<'_>) -> Depth {
    let Some(way_out) = Query::new().with_budget(budget).penetration(a, b) else { return Depth::NONE };
    let way = sub(&way_out.point_b, &way_out.point_a);
    let mut depth = Depth { lower: 0.0, upper: way_out.upper, point: None, is_proved: true };
    for share in SHARES {
        let point = add(&way_out.point_a, &scale(&way, share));
        let own = [a, b].map(|thing| depth_of_point(&point, thing, budget));
        if let [Some(x), Some(y)] = own
            && x.max(y) > depth.lower
        {
            (depth.lower, depth.point) = (x.max(y), Some(point));
        }
    }
    depth
}

/// Returns a lower bound of the distance of a point from the surface of a thing that holds it, or
/// `None` if the thing does not hold it.
fn depth_of_point(point: &Vector, thing: &Placed<'_>, budget: &Budget<'_>) -> Option<f64> {
    let point = placed_point(*point)?;
    let query = || Query::new().with_budget(budget);
    if query().proximity(&point, thing) != Proximity::Intersects {
        return None;
    }
    match thing.mesh() {
        // The surface of a mesh has a distance of its own.
        Some(mesh) => Some(query().distance(&point, mesh.mesh.at(mesh.world_from_mesh)).lower),
        None => query().penetration(&point, thing).map(|found| found.lower),
    }
}

fn placed_point(point: Vector) -> Option<PlacedShape> {
    Shape::sphere([0.0; 3], 0.0).ok()?.at(Pose::from_translation(point).ok()?).ok()
}
