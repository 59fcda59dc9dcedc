//! How deep shapes are in each other at least: two balls about one point, one in each of them.
//!
//! From below: with balls of radii r and s about one point, the first in A and the second in B, no translation shorter
//! than r + s parts the interiors (docs/proof.md, L30). The point is looked for between the points that touched last, by
//! radii in plain floats, and uphill: away from what is nearest in either shape, or between such ways where they go against each other.
//! What is told of it is proved in the end.
//!
//! # Source
//! Lemaréchal, *An extension of Davidon methods to non differentiable problems*, Mathematical Programming Study 3, 1975 (bundles of
//! slopes).

use super::table::surface_of;
use crate::convex::{self, Core, Surface, Swept, depth, nearest_of_hull};
use crate::math::Pose;
use crate::math::vec3::{Vector, cross, dot, length, sub};
use crate::mesh::{Containment, Mesh, Positions};
use crate::query::{Proximity, of_meshes};
use crate::shape::{Form, PlacedShape};

/// Steps that look for the point of the greatest balls.
const BALL_STEPS: usize = 32;

/// Balls that fall short of the upper end by less than this, next to it, are not looked for any longer: 2^-12. Nor are steps shorter
/// than this taken.
const CLOSE: f64 = 1.0 / (1 << 12) as f64;

/// The greatest sum found of the radii of two balls about one point, one in each shape.
pub(super) fn ball_in_both(a: &PlacedShape, b: &PlacedShape, points: &[Vector; 2], upper: f64) -> f64 {
    let mut sides = [a, b].map(Balls::of);
    let at = climb(&mut sides, points, [a.bounds(), b.bounds()], upper);
    let sum: f64 = sides.iter_mut().map(|side| side.proved_radius(&at)).sum();
    if sum > 0.0 && sum.is_finite() { sum * (1.0 - 8.0 * f64::EPSILON) } else { 0.0 }
}

/// A point about which both balls are large.
fn climb(sides: &mut [Balls<'_>; 2], points: &[Vector; 2], bounds: [Option<[Vector; 2]>; 2], upper: f64) -> Vector {
    let enough = upper * (1.0 - CLOSE);
    let mut best = start(sides, points, bounds, upper);
    let (mut step, mut slopes) = (0.25 * upper, vec![best]);
    for _ in 0..BALL_STEPS {
        let hull = nearest_of_hull(&Vec::from_iter(slopes.iter().map(|place| place.uphill)));
        let weights = &hull.weights[..slopes.len()];
        let steepness = length(&hull.vector);
        // How far linear pieces of a concave sum, which balls in convex shapes have, are above what is there.
        let above = |place: &Place| place.sum + dot(&place.uphill, &sub(&best.at, &place.at)) - best.sum;
        let above: f64 = slopes.iter().zip(weights).map(|(place, weight)| weight * above(place)).sum();
        if best.sum >= enough || above.max(0.0) + steepness * upper < CLOSE * upper || step < CLOSE * upper {
            break;
        }
        let mut left = weights.iter();
        slopes.retain(|_| left.next().is_some_and(|&weight| weight > 0.0));
        if slopes.len() == 4 || steepness < CLOSE {
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

/// Where to start from: a place in both shapes, as far as one is found.
fn start(sides: &mut [Balls<'_>; 2], points: &[Vector; 2], bounds: [Option<[Vector; 2]>; 2], upper: f64) -> Place {
    let mut best = Place::of(sides, middle(points));
    // Where one shape is all inside the other the middle may be in but one of them, and where walls are in line in the walls.
    for bounds in likely_boxes(bounds) {
        if best.sum < upper * (1.0 - CLOSE) {
            let place = Place::of(sides, middle(&bounds));
            best = if place.sum > best.sum { place } else { best };
        }
    }
    let mut step = 0.25 * upper;
    while !best.sum.is_finite() && step > CLOSE * upper {
        // No slope of one shape tells where the other is.
        for way in 0..6 {
            let by = [step, -step][way % 2];
            let place = Place::of(sides, std::array::from_fn(|k| best.at[k] + if k == way / 2 { by } else { 0.0 }));
            best = if place.sum > best.sum { place } else { best };
        }
        step *= 0.5;
    }
    best
}

fn middle([p, q]: &[Vector; 2]) -> Vector {
    std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k])
}

/// A point, and how large the balls about it are by plain floats.
#[derive(Clone, Copy)]
struct Place {
    at: Vector,
    sum: f64,
    /// Where to they grow.
    uphill: Vector,
}

impl Place {
    fn of(sides: &mut [Balls<'_>; 2], at: Vector) -> Self {
        let [a, b] = sides.each_mut().map(|side| side.about(&at));
        Self { at, sum: a.radius + b.radius, uphill: std::array::from_fn(|k| a.uphill[k] + b.uphill[k]) }
    }
}

/// A ball in one part of a shape, by plain floats.
#[derive(Clone, Copy)]
struct Ball {
    centre: Vector,
    /// Negative infinity where the centre is not in the part.
    radius: f64,
    /// Of length 1, away from what is nearest.
    uphill: Vector,
}

/// Boxes about what the shapes have in common: of each, and what these share.
fn likely_boxes([a, b]: [Option<[Vector; 2]>; 2]) -> impl Iterator<Item = [Vector; 2]> {
    let shared = a.zip(b).map(|([min, max], [other_min, other_max])| {
        [[0, 1, 2].map(|k| min[k].max(other_min[k])), [0, 1, 2].map(|k| max[k].min(other_max[k]))]
    });
    [shared, a, b].into_iter().flatten()
}

/// Balls in the parts of a shape.
struct Balls<'s> {
    parts: &'s [PlacedShape],
    /// The last of each part that its centre was in.
    known: Vec<Option<Ball>>,
}

impl<'s> Balls<'s> {
    fn of(shape: &'s PlacedShape) -> Self {
        let parts = shape.parts();
        Self { parts, known: vec![None; parts.len()] }
    }

    /// The parts that a point may be in.
    fn near<'p>(parts: &'p [PlacedShape], point: &Vector) -> impl Iterator<Item = (usize, &'p PlacedShape)> {
        parts.iter().enumerate().filter(move |(_, part)| {
            let is_outside = |[min, max]: [Vector; 2]| (0..3).any(|k| point[k] < min[k] || point[k] > max[k]);
            !part.bounds().is_some_and(is_outside)
        })
    }

    /// The largest ball about a point in one of the parts.
    fn about(&mut self, point: &Vector) -> Ball {
        let mut largest = Ball { centre: *point, radius: f64::NEG_INFINITY, uphill: [0.0; 3] };
        for (number, part) in Self::near(self.parts, point) {
            let known = &mut self.known[number];
            let Some(ball) = ball_in_part(part, point, known.as_ref()) else { continue };
            *known = Some(ball);
            if ball.radius > largest.radius {
                largest = ball;
            }
        }
        largest
    }

    /// The radius of a ball about a point that is proved to be in one of the parts; negative infinity where the point is not.
    fn proved_radius(&mut self, point: &Vector) -> f64 {
        let radii = Self::near(self.parts, point).filter_map(|(_, part)| match part.form() {
            Form::Surface(surface) => proved_radius_in_solid(&surface, point),
            _ => ball_in_part(part, point, None).map(|ball| ball.radius),
        });
        radii.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The ball about a point in a part; of convex ones proved, of meshes by plain floats.
fn ball_in_part(part: &PlacedShape, point: &Vector, known: Option<&Ball>) -> Option<Ball> {
    let corner = [*point];
    let swept = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    let found = match part.form() {
        Form::Convex(shape) => {
            (convex::nearness(&shape, &swept, 0.0) == Proximity::Meets).then(|| depth(&shape, &swept))
        }
        Form::HalfSpace(plane) => (plane.nearness(&swept, 0.0) == Proximity::Meets).then(|| plane.depth(&swept)),
        Form::Surface(surface) => {
            let is_known = known.is_some_and(|known| length(&sub(point, &known.centre)) < known.radius);
            let is_inside = is_known || surface.containment(&swept) == Containment::Inside;
            let foot = nearest(&surface, point).filter(|_| is_inside)?;
            let away = sub(point, &foot);
            let radius = length(&away);
            let uphill = if radius > 0.0 { away.map(|x| x / radius) } else { [0.0; 3] };
            return Some(Ball { centre: *point, radius, uphill });
        }
    };
    found.map(|depth| Ball { centre: *point, radius: depth.lower, uphill: depth.normal.map(|x| 0.0 - x) })
}

/// The point of a surface that is nearest to a point of the world as its own frame sees it, rounded.
fn nearest(surface: &Surface<'_>, point: &Vector) -> Option<Vector> {
    let [x, y, z] = *surface.pose.linear();
    let from = sub(point, surface.pose.translation());
    let columns = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
    let determinant = dot(&x, &columns[0]);
    let local = std::array::from_fn(|k| (0..3).map(|row| columns[row][k] * from[row]).sum::<f64>() / determinant);
    let nearest = surface.mesh.closest_point(local).ok()??;
    Some(surface.pose.apply(nearest.point))
}

/// The radius of a ball about a point in a solid mesh, if the point is proved to be inside.
fn proved_radius_in_solid(surface: &Surface<'_>, point: &Vector) -> Option<f64> {
    let corner = [*point];
    let swept = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    if surface.containment(&swept) != Containment::Inside {
        return None;
    }
    // A mesh of one face that is a point.
    let mesh = Mesh::new(Positions::F32(vec![[0.0; 3]]), vec![[0; 3]]).ok()?;
    let there = mesh.at(Pose::from_translation(*point).ok()?);
    Some(of_meshes::distance_without_cache(surface_of(surface), there).lower)
}
