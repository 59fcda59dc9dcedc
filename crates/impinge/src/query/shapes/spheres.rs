//! A lower bound of the depth of two shapes: two spheres about one point, one inside each shape.
//!
//! If a sphere of radius r lies in A, and a sphere of radius s about the same point lies in B, no
//! translation shorter than r + s separates the interiors (docs/notes/proof.md, L30). The search
//! for the point starts between the points that touched last. It uses radii in plain floats and
//! goes uphill: away from the nearest point of either shape's surface, or between these two
//! directions if they oppose each other. The radii at the final point are proved.
//!
//! # Source
//! Lemaréchal, *An extension of Davidon methods to non differentiable problems*, Mathematical
//! Programming Study 3, 1975 (bundles of slopes).

use super::surfaces::surface_of;
use crate::budget::Budget;
use crate::convex::{self, Core, Surface, Swept, depth, nearest_of_hull};
use crate::math::Pose;
use crate::math::vec3::{Vector, cross, dot, length, sub};
use crate::mesh::{Containment, Mesh, Positions};
use crate::query::{Proximity, of_meshes};
use crate::shape::{Form, PlacedShape};

/// Maximum number of steps of the search for the point with the largest spheres.
const MAX_SPHERE_STEPS: usize = 32;

/// Relative tolerance of the search, 2^-12. The search ends if the sum of the radii is below the
/// upper bound of the depth by less than this part of it. It takes no step shorter than this part
/// of the upper bound.
const TOLERANCE: f64 = 1.0 / (1 << 12) as f64;

/// Returns the largest proved sum found of the radii of two spheres about one point, one inside
/// each shape. Returns zero if no such point is found.
pub(super) fn spheres_in_both(a: &PlacedShape, b: &PlacedShape, points: &[Vector; 2], upper: f64) -> f64 {
    let mut sides = [a, b].map(Spheres::of);
    let at = climb(&mut sides, points, [a.bounds(), b.bounds()], upper);
    let sum: f64 = sides.iter_mut().map(|side| side.proved_radius(&at)).sum();
    if sum > 0.0 && sum.is_finite() { sum * (1.0 - 8.0 * f64::EPSILON) } else { 0.0 }
}

/// Returns a point about which both spheres are large.
fn climb(sides: &mut [Spheres<'_>; 2], points: &[Vector; 2], bounds: [Option<[Vector; 2]>; 2], upper: f64) -> Vector {
    let enough = upper * (1.0 - TOLERANCE);
    let mut best = start(sides, points, bounds, upper);
    let (mut step, mut slopes) = (0.25 * upper, vec![best]);
    for _ in 0..MAX_SPHERE_STEPS {
        let hull = nearest_of_hull(&Vec::from_iter(slopes.iter().map(|place| place.uphill)));
        let weights = &hull.weights[..slopes.len()];
        let steepness = length(&hull.vector);
        // How far the linear pieces of a concave sum lie above the best sum. Spheres in convex
        // shapes have a concave sum.
        let above = |place: &Place| place.sum + dot(&place.uphill, &sub(&best.at, &place.at)) - best.sum;
        let above: f64 = slopes.iter().zip(weights).map(|(place, weight)| weight * above(place)).sum();
        if best.sum >= enough || above.max(0.0) + steepness * upper < TOLERANCE * upper || step < TOLERANCE * upper {
            break;
        }
        let mut left = weights.iter();
        slopes.retain(|_| left.next().is_some_and(|&weight| weight > 0.0));
        if slopes.len() == 4 || steepness < TOLERANCE {
            (step, slopes) = (0.5 * step, vec![best]);
            continue;
        }
        let place = Place::of(sides, std::array::from_fn(|k| best.at[k] + step / steepness * hull.vector[k]));
        if place.sum > best.sum {
            (best, slopes) = (place, vec![place]);
        } else if place.sum.is_finite() {
            slopes.push(place);
        } else {
            step *= 0.5;
        }
    }
    best.at
}

/// Returns a point to start from: inside both shapes if such a point is found.
fn start(sides: &mut [Spheres<'_>; 2], points: &[Vector; 2], bounds: [Option<[Vector; 2]>; 2], upper: f64) -> Place {
    let mut best = Place::of(sides, middle(points));
    // If one shape is inside the other, the middle of the points may be in only one of them. If
    // walls are aligned, the middle may be in the walls.
    for bounds in likely_boxes(bounds) {
        if best.sum < upper * (1.0 - TOLERANCE) {
            let place = Place::of(sides, middle(&bounds));
            best = if place.sum > best.sum { place } else { best };
        }
    }
    let mut step = 0.25 * upper;
    while !best.sum.is_finite() && step > TOLERANCE * upper {
        // No slope of one shape shows the way to the other, so all axes are tried.
        for way in 0..6 {
            let offset = [step, -step][way % 2];
            let place = Place::of(sides, std::array::from_fn(|k| best.at[k] + if k == way / 2 { offset } else { 0.0 }));
            best = if place.sum > best.sum { place } else { best };
        }
        step *= 0.5;
    }
    best
}

fn middle([p, q]: &[Vector; 2]) -> Vector {
    std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k])
}

/// Point with the sum of the radii of the spheres about it, in plain floats.
#[derive(Clone, Copy)]
struct Place {
    at: Vector,
    sum: f64,
    /// Direction in which the sum of the radii grows.
    uphill: Vector,
}

impl Place {
    fn of(sides: &mut [Spheres<'_>; 2], at: Vector) -> Self {
        let [a, b] = sides.each_mut().map(|side| side.about(&at));
        Self { at, sum: a.radius + b.radius, uphill: std::array::from_fn(|k| a.uphill[k] + b.uphill[k]) }
    }
}

/// Sphere inside one part of a shape, in plain floats.
#[derive(Clone, Copy)]
struct InnerSphere {
    center: Vector,
    /// Radius; negative infinity if the center is not in the part.
    radius: f64,
    /// Direction of length 1 away from the nearest point of the surface.
    uphill: Vector,
}

/// Returns boxes that may hold the intersection of two shapes: the intersection of their boxes,
/// then the box of each.
fn likely_boxes([a, b]: [Option<[Vector; 2]>; 2]) -> impl Iterator<Item = [Vector; 2]> {
    let shared = a.zip(b).map(|([min, max], [other_min, other_max])| {
        [[0, 1, 2].map(|k| min[k].max(other_min[k])), [0, 1, 2].map(|k| max[k].min(other_max[k]))]
    });
    [shared, a, b].into_iter().flatten()
}

/// Search for spheres in the parts of a shape.
struct Spheres<'s> {
    parts: &'s [PlacedShape],
    /// For each part, the last sphere whose center was in the part.
    known: Vec<Option<InnerSphere>>,
}

impl<'s> Spheres<'s> {
    fn of(shape: &'s PlacedShape) -> Self {
        let parts = shape.parts();
        Self { parts, known: vec![None; parts.len()] }
    }

    /// Returns the parts whose boxes contain a point, with their indices.
    fn near<'p>(parts: &'p [PlacedShape], point: &Vector) -> impl Iterator<Item = (usize, &'p PlacedShape)> {
        parts.iter().enumerate().filter(move |(_, part)| {
            let is_outside = |[min, max]: [Vector; 2]| (0..3).any(|k| point[k] < min[k] || point[k] > max[k]);
            !part.bounds().is_some_and(is_outside)
        })
    }

    /// Returns the largest sphere about a point that lies in one of the parts.
    fn about(&mut self, point: &Vector) -> InnerSphere {
        let mut largest = InnerSphere { center: *point, radius: f64::NEG_INFINITY, uphill: [0.0; 3] };
        for (number, part) in Self::near(self.parts, point) {
            let known = &mut self.known[number];
            let Some(sphere) = sphere_in_part(part, point, known.as_ref()) else { continue };
            *known = Some(sphere);
            if sphere.radius > largest.radius {
                largest = sphere;
            }
        }
        largest
    }

    /// Returns the radius of a sphere about a point that is proved to lie in one of the parts.
    /// Returns negative infinity if the point is in no part.
    fn proved_radius(&mut self, point: &Vector) -> f64 {
        let radii = Self::near(self.parts, point).filter_map(|(_, part)| match part.form() {
            Form::Surface(surface) => proved_radius_in_solid(&surface, point),
            _ => sphere_in_part(part, point, None).map(|sphere| sphere.radius),
        });
        radii.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Returns the sphere about a point that lies in a part, or `None` if the point is not in the part.
/// The sphere is proved for convex parts, and in plain floats for meshes.
fn sphere_in_part(part: &PlacedShape, point: &Vector, known: Option<&InnerSphere>) -> Option<InnerSphere> {
    let corner = [*point];
    let swept = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    let found = match part.form() {
        Form::Convex(shape) => {
            (convex::nearness(&shape, &swept, 0.0) == Proximity::Intersects).then(|| depth(&shape, &swept))
        }
        Form::HalfSpace(plane) => (plane.nearness(&swept, 0.0) == Proximity::Intersects).then(|| plane.depth(&swept)),
        Form::Field(_) => return None,
        Form::Surface(surface) => {
            let is_known = known.is_some_and(|known| length(&sub(point, &known.center)) < known.radius);
            let is_inside = is_known || surface.containment(&swept) == Containment::Inside;
            let foot = nearest(&surface, point).filter(|_| is_inside)?;
            let away = sub(point, &foot);
            let radius = length(&away);
            let uphill = if radius > 0.0 { away.map(|x| x / radius) } else { [0.0; 3] };
            return Some(InnerSphere { center: *point, radius, uphill });
        }
    };
    found.map(|depth| InnerSphere { center: *point, radius: depth.lower, uphill: depth.normal.map(|x| 0.0 - x) })
}

/// Returns the point of a surface that is nearest to a point in the world. The distance is measured
/// in the frame of the mesh, and both are in the world frame, rounded.
fn nearest(surface: &Surface<'_>, point: &Vector) -> Option<Vector> {
    let [x, y, z] = *surface.pose.linear();
    let from = sub(point, surface.pose.translation());
    let columns = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
    let determinant = dot(&x, &columns[0]);
    let local = std::array::from_fn(|k| (0..3).map(|row| columns[row][k] * from[row]).sum::<f64>() / determinant);
    let nearest = surface.mesh.closest_point(local).ok()??;
    Some(surface.pose.apply(nearest.point))
}

/// Returns the radius of a sphere about a point that lies in a solid mesh, if the point is proved
/// to be inside.
fn proved_radius_in_solid(surface: &Surface<'_>, point: &Vector) -> Option<f64> {
    let corner = [*point];
    let swept = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    if surface.containment(&swept) != Containment::Inside {
        return None;
    }
    // A mesh whose one face is a point.
    let mesh = Mesh::new(Positions::F32(vec![[0.0; 3]]), vec![[0; 3]]).ok()?;
    let there = mesh.at(Pose::from_translation(*point).ok()?);
    Some(of_meshes::distance_without_cache(surface_of(surface), there, Budget::unlimited()).lower)
}
