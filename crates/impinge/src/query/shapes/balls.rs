//! How deep shapes are in each other at least: two balls about one point, one in each of them.
//!
//! From below: with balls of radii r and s about one point, the first in A and the second in B, no translation shorter
//! than r + s parts the interiors (docs/proof.md, L30). The point is looked for between the points that touched last.

use super::Proximity;
use super::table::placed;
use crate::convex::{self, Core, Swept, depth};
use crate::math::Pose;
use crate::mesh::{Containment, Mesh, Options, Positions};
use crate::query::{WitnessCache, distance_with};
use crate::shape::{Form, PlacedShape};

type Vector = [f64; 3];

/// Steps that look for the point of the greatest balls, each of which asks six times for both.
const BALL_STEPS: usize = 24;

/// The greatest sum found of the radii of two balls about one point, one in each shape.
pub(super) fn ball_in_both(a: &PlacedShape, b: &PlacedShape, points: &[Vector; 2], upper: f64) -> f64 {
    let [mut in_a, mut in_b] = [a, b].map(Balls::of);
    let mut sum = |point: &Vector| in_a.radius(point) + in_b.radius(point);
    let middle = |p: &Vector, q: &Vector| -> Vector { std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]) };
    let mut at = middle(&points[0], &points[1]);
    let mut best = sum(&at);
    // Where one shape is all inside the other the middle may be in but one of them, and where walls are in line in the walls.
    for [min, max] in likely_boxes(a.bounds(), b.bounds()) {
        let centre = middle(&min, &max);
        let value = sum(&centre);
        if value > best {
            (best, at) = (value, centre);
        }
    }
    let mut step = 0.25 * upper;
    for _ in 0..BALL_STEPS {
        if best >= upper * (1.0 - 1e-9) {
            break;
        }
        let mut found = None;
        for k in 0..3 {
            for sign in [step, -step] {
                let point = std::array::from_fn(|j| if j == k { at[j] + sign } else { at[j] });
                let value = sum(&point);
                if value > best {
                    (best, found) = (value, Some(point));
                }
            }
        }
        match found {
            Some(point) => at = point,
            None => step *= 0.5,
        }
    }
    if best > 0.0 && best.is_finite() { best * (1.0 - 8.0 * f64::EPSILON) } else { 0.0 }
}

/// Boxes about what the shapes have in common: of each, and what these share.
fn likely_boxes(a: Option<[Vector; 2]>, b: Option<[Vector; 2]>) -> impl Iterator<Item = [Vector; 2]> {
    let shared = a.zip(b).map(|([min, max], [other_min, other_max])| {
        [[0, 1, 2].map(|k| min[k].max(other_min[k])), [0, 1, 2].map(|k| max[k].min(other_max[k]))]
    });
    [shared, a, b].into_iter().flatten()
}

/// Balls in the parts of a shape.
struct Balls<'s> {
    parts: &'s [PlacedShape],
    /// A mesh of one face that is a point, to measure its distance from surfaces.
    point: Option<Mesh>,
    caches: Vec<WitnessCache>,
}

impl<'s> Balls<'s> {
    fn of(shape: &'s PlacedShape) -> Self {
        let parts = shape.parts();
        let point = Mesh::new(Positions::F32(vec![[0.0; 3]]), vec![[0; 3]]).ok();
        Self { parts, point, caches: vec![WitnessCache::default(); parts.len()] }
    }

    /// The radius of a ball about a point of the world that is in one of the parts; negative infinity where the point is not proved to
    /// be in any.
    fn radius(&mut self, point: &Vector) -> f64 {
        let mut greatest = f64::NEG_INFINITY;
        for (part, cache) in self.parts.iter().zip(&mut self.caches) {
            let is_outside = |[min, max]: [Vector; 2]| (0..3).any(|k| point[k] < min[k] || point[k] > max[k]);
            if part.bounds().is_some_and(is_outside) {
                continue;
            }
            greatest = greatest.max(radius_in_part(part, point, self.point.as_ref(), cache));
        }
        greatest
    }
}

fn radius_in_part(part: &PlacedShape, point: &Vector, point_mesh: Option<&Mesh>, cache: &mut WitnessCache) -> f64 {
    let corner = [*point];
    let swept = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    match part.form() {
        Form::Convex(shape) if convex::nearness(&shape, &swept, 0.0) == Proximity::Meets => depth(&shape, &swept).lower,
        Form::HalfSpace(plane) if plane.nearness(&swept, 0.0) == Proximity::Meets => plane.depth(&swept).lower,
        Form::Surface(surface) if surface.containment(&swept) == Containment::Inside => {
            let (Some(mesh), Ok(pose)) = (point_mesh, Pose::from_translation(*point)) else { return f64::NEG_INFINITY };
            distance_with(placed(&surface), mesh.at(pose), cache, &Options::default()).lower
        }
        _ => f64::NEG_INFINITY,
    }
}
