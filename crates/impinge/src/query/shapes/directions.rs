//! Directions along which a shape may leave another one, and lengths that are certainly enough.
//!
//! `search` starts from them. Tests: `tests/it/solids/depths.rs`.

use super::surfaces::surface_of;
use crate::budget::Budget;
use crate::convex::{Core, Surface, Swept, depth, to_unit_length};
use crate::hull::Hull;
use crate::math::Pose;
use crate::math::vec3::{Vector, dot, scaled_length as length, sub};
use crate::query::normals_of_regions;
use crate::shape::{Form, PlacedShape};

/// Maximum number of regions of intersection whose normals are searched, the largest regions first.
const MAX_REGIONS: usize = 3;

/// Maximum number of vertices of a mesh whose hull is made, which takes less than a few distances.
const MAX_HULL_VERTICES: usize = 1024;

/// Returns directions from center to center, out of half-spaces and hulls, and across regions.
pub(super) fn directions(a: &PlacedShape, b: &PlacedShape, budget: &Budget<'_>) -> Vec<Vector> {
    let mut found = Vec::new();
    let center = |[min, max]: [Vector; 2]| -> Vector { std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]) };
    if let (Some(a), Some(b)) = (a.bounds(), b.bounds()) {
        let between = sub(&center(b), &center(a));
        let apart = length(&between);
        if apart > 0.0 {
            found.push(scaled(&between, 1.0 / apart));
        }
    }
    for (shape, sign) in [(a, 1.0), (b, -1.0)] {
        for part in shape.parts() {
            if let Form::HalfSpace(plane) = part.form() {
                found.push(scaled(&plane.unit_normal(), sign));
            }
        }
    }
    found.extend(out_of_hulls(a, b));
    if let Some([a, b]) = surfaces(a, b) {
        let mut regions = normals_of_regions([surface_of(&a), surface_of(&b)], budget);
        regions.sort_by(|x, y| y.0.total_cmp(&x.0));
        found.extend(regions.iter().take(MAX_REGIONS).map(|(_, normal)| normal));
    }
    found
}

/// Returns the direction that separates the hulls of convex shapes or of meshes of few vertices.
fn out_of_hulls(a: &PlacedShape, b: &PlacedShape) -> Option<Vector> {
    let ([a], [b]) = (a.parts(), b.parts()) else { return None };
    let (form_a, form_b) = (a.form(), b.form());
    let hulls = [&form_a, &form_b].map(|form| match form {
        Form::Surface(surface) => hull_of_few(surface),
        _ => None,
    });
    let [swept_a, swept_b] = [swept(&form_a, hulls[0].as_ref())?, swept(&form_b, hulls[1].as_ref())?];
    Some(depth(&swept_a, &swept_b).normal)
}

fn swept<'h>(form: &Form<'h>, hull: Option<&'h Hull>) -> Option<Swept<'h>> {
    match (form, hull) {
        (Form::Convex(swept), _) => Some(*swept),
        (Form::Surface(surface), Some(hull)) => {
            Some(Swept { core: Core::Hull(hull), pose: surface.pose, radius: [0.0; 2] })
        }
        _ => None,
    }
}

fn hull_of_few(surface: &Surface<'_>) -> Option<Hull> {
    let positions = surface.mesh.positions();
    let is_small = positions.len() <= MAX_HULL_VERTICES;
    let points: Vec<Vector> = is_small.then(|| (0..positions.len()).map(|i| positions.get(i)).collect())?;
    Hull::new(&points).ok()
}

/// Returns the axes of the world and of each shape's own frame, in both directions.
pub(super) fn along_axes(a: &PlacedShape, b: &PlacedShape) -> impl Iterator<Item = Vector> {
    let own = [&Pose::IDENTITY, a.world_from_local(), b.world_from_local()];
    let axis = |pose: &Pose, j: usize| to_unit_length(pose.linear().map(|row| row[j]));
    let axes: Vec<Vector> = own.into_iter().flat_map(|pose| [0, 1, 2].map(|j| axis(pose, j))).collect();
    axes.into_iter().flat_map(|axis| [axis, scaled(&axis, -1.0)])
}

/// Returns both surfaces, or `None` if one of the shapes is not one mesh.
pub(super) fn surfaces<'s>(a: &'s PlacedShape, b: &'s PlacedShape) -> Option<[Surface<'s>; 2]> {
    match (a.parts(), b.parts()) {
        ([a], [b]) => match (a.form(), b.form()) {
            (Form::Surface(a), Form::Surface(b)) => Some([a, b]),
            _ => None,
        },
        _ => None,
    }
}

/// Returns a length by which the second shape moves along a direction to be certainly beyond the
/// first. Infinite if no such length is known.
pub(super) fn separating_length(a: &PlacedShape, b: &PlacedShape, direction: &Vector) -> f64 {
    let mut farthest = 0.0_f64;
    for part_a in a.parts() {
        for part_b in b.parts() {
            let needed = match (part_a.form(), part_b.form()) {
                (Form::HalfSpace(_), Form::HalfSpace(_)) => f64::INFINITY,
                (Form::HalfSpace(plane), other) => out_of(&plane.unit_normal(), direction, depth_in(&plane, &other)),
                (other, Form::HalfSpace(plane)) => {
                    out_of(&plane.unit_normal(), &scaled(direction, -1.0), depth_in(&plane, &other))
                }
                _ => match (height(part_a, direction), height(part_b, &scaled(direction, -1.0))) {
                    (Some(top), Some(bottom)) => top + bottom,
                    _ => 0.0,
                },
            };
            farthest = farthest.max(needed);
        }
    }
    farthest
}

/// Returns an upper bound of how far a part reaches along a direction, from its boxes.
fn height(part: &PlacedShape, direction: &Vector) -> Option<f64> {
    let greatest = |[min, max]: [Vector; 2], direction: &Vector| -> f64 {
        (0..3).map(|k| if direction[k] > 0.0 { max[k] * direction[k] } else { min[k] * direction[k] }).sum()
    };
    let by_world = greatest(part.bounds()?, direction);
    let Form::Surface(surface) = part.form() else { return Some(by_world) };
    let pose = surface.pose;
    let turned = std::array::from_fn(|j| (0..3).map(|k| pose.linear()[k][j] * direction[k]).sum());
    let own = greatest(surface.mesh.local_bounds()?, &turned) + dot(pose.translation(), direction);
    Some(by_world.min(own))
}

fn depth_in(plane: &crate::convex::HalfSpace<'_>, form: &Form<'_>) -> f64 {
    match form {
        Form::Convex(shape) => plane.depth(shape).upper,
        Form::Surface(surface) => plane.depth_of_surface(surface).map_or(0.0, |depth| depth.upper),
        Form::Field(field) => plane.depth_of_surface(field).map_or(0.0, |depth| depth.upper),
        Form::HalfSpace(_) => f64::INFINITY,
    }
}

/// Returns how far a shape `depth` deep in a half-space must move to leave it, or infinity.
fn out_of(normal: &Vector, direction: &Vector, depth: f64) -> f64 {
    /// Minimum cosine with the normal; along flatter directions the shape moves too far.
    const MIN_COSINE: f64 = 1.0 / 64.0;
    let cosine = dot(normal, direction);
    if cosine >= MIN_COSINE { depth / cosine } else { f64::INFINITY }
}

pub(super) fn scaled(p: &Vector, by: f64) -> Vector {
    p.map(|x| x * by)
}
