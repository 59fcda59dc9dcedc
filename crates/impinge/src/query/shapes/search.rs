//! How deep shapes are in each other that are not convex: a translation that is proved to part them, and a ball that is
//! in both.
//!
//! From where the second shape is surely beyond the first along some direction it is brought back towards its place, each
//! step no longer than the proved distance, so that it never touches. Where it nearly does, the nearest points give a plane that
//! the translation is to stay beyond; the shortest translation beyond all such planes is the next goal. Several directions to
//! start from are tried and the shortest translation wins. Each one was asked of the exact query where it ends.
//!
//! From below: with balls of radii r and s about one point, the first in A and the second in B, no translation shorter
//! than r + s parts the interiors (docs/proof.md, L30). The point is looked for between the points that touched last.
//!
//! # Source
//! Je, Tang, Lee, Lee, Kim, *PolyDepth: real-time penetration depth computation using iterative contact-space projection*, ACM
//! Transactions on Graphics 31, 2012. Ours departs in that it advances by proved distances, so that what it returns parts the
//! shapes, and in the bound from below.

use super::Proximity;
use super::table::separation;
use crate::convex::{Core, Depth, Surface, Swept, depth};
use crate::math::Pose;
use crate::shape::{Form, PlacedShape};

type Vector = [f64; 3];

/// Directions that are searched from, of those that promise most.
const STARTS: usize = 3;

/// Planes that are gathered from one direction.
const PLANES: usize = 12;

/// Steps towards one goal. Those head on take two or three; a goal that is never reached costs the rest.
const STEPS: usize = 24;

/// Shapes nearer than this, next to their sizes, count as having arrived: 2^-26. Less costs steps, more leaves the depth loose.
const NEAR: f64 = 1.0 / (1 << 26) as f64;

/// Steps that look for the point of the greatest balls, each of which asks six times for both.
const BALL_STEPS: usize = 24;

/// How deep two shapes that intersect are in each other. Which of them is searched from does not depend on which is named first, as
/// far as their boxes differ.
pub(super) fn depth_by_search(a: &PlacedShape, b: &PlacedShape) -> Depth {
    let key = |shape: &PlacedShape| shape.bounds().map(|bounds| bounds.concat());
    if key(b) < key(a) {
        let mut found = depth_in_order(b, a);
        found.points.swap(0, 1);
        found.normal = found.normal.map(|x| 0.0 - x);
        return found;
    }
    depth_in_order(a, b)
}

fn depth_in_order(a: &PlacedShape, b: &PlacedShape) -> Depth {
    let mut starts: Vec<(f64, Vector)> = directions(a, b)
        .into_iter()
        .map(|direction| (parting(a, b, &direction), direction))
        .filter(|start| start.0.is_finite())
        .collect();
    starts.sort_by(|x, y| x.0.total_cmp(&y.0));
    starts.truncate(STARTS);
    let mut best: Option<Parted> = None;
    for (length, direction) in starts {
        if let Some(found) = descend(a, b, length, &direction)
            && best.as_ref().is_none_or(|best| found.length < best.length)
        {
            best = Some(found);
        }
    }
    let Some(best) = best else {
        let points = separation(a, b).points;
        return Depth { lower: 0.0, upper: f64::INFINITY, normal: [1.0, 0.0, 0.0], points };
    };
    let points = [best.points[0], sub(&best.points[1], &best.translation)];
    let lower = ball_in_both(a, b, &points, best.length).min(best.length);
    let normal = scaled(&best.translation, 1.0 / length(&best.translation));
    Depth { lower, upper: best.length, normal, points }
}

/// A translation of the second shape that parts it from the first, and where they are nearest then.
struct Parted {
    translation: Vector,
    length: f64,
    points: [Vector; 2],
}

/// Directions that may part the shapes: from centre to centre, and along the axes; out of half-spaces.
fn directions(a: &PlacedShape, b: &PlacedShape) -> Vec<Vector> {
    let mut found = Vec::new();
    let centre = |[min, max]: [Vector; 2]| -> Vector { std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]) };
    if let (Some(a), Some(b)) = (a.bounds(), b.bounds()) {
        let between = sub(&centre(b), &centre(a));
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
    for k in 0..3 {
        for sign in [1.0, -1.0] {
            found.push(std::array::from_fn(|j| if j == k { sign } else { 0.0 }));
        }
    }
    found
}

/// How far along a direction the second shape is surely beyond the first; infinite where that is not known.
fn parting(a: &PlacedShape, b: &PlacedShape, direction: &Vector) -> f64 {
    let height = |[min, max]: [Vector; 2], sign: f64| -> f64 {
        (0..3).map(|k| if sign * direction[k] > 0.0 { max[k] * direction[k] } else { min[k] * direction[k] }).sum()
    };
    let mut farthest = 0.0_f64;
    for part_a in a.parts() {
        for part_b in b.parts() {
            let needed = match (part_a.form(), part_b.form()) {
                (Form::HalfSpace(_), Form::HalfSpace(_)) => f64::INFINITY,
                (Form::HalfSpace(plane), other) => out_of(&plane.unit_normal(), direction, depth_in(&plane, &other)),
                (other, Form::HalfSpace(plane)) => {
                    out_of(&plane.unit_normal(), &scaled(direction, -1.0), depth_in(&plane, &other))
                }
                _ => match (part_a.bounds(), part_b.bounds()) {
                    (Some(bounds_a), Some(bounds_b)) => height(bounds_a, 1.0) - height(bounds_b, -1.0),
                    _ => 0.0,
                },
            };
            farthest = farthest.max(needed);
        }
    }
    farthest
}

fn depth_in(plane: &crate::convex::HalfSpace<'_>, form: &Form<'_>) -> f64 {
    match form {
        Form::Convex(shape) => plane.depth(shape).upper,
        Form::Surface(surface) => plane.depth_of_surface(surface).map_or(0.0, |depth| depth.upper),
        Form::HalfSpace(_) => f64::INFINITY,
    }
}

/// How far a shape that is so deep in a half-space is to move along a direction to be out.
fn out_of(normal: &Vector, direction: &Vector, depth: f64) -> f64 {
    /// The cosine of directions along which it is out in reasonable time.
    const STEEP: f64 = 1.0 / 64.0;
    let cosine = dot(normal, direction);
    if cosine >= STEEP { depth / cosine } else { f64::INFINITY }
}

/// The shortest translation found from far along a direction.
fn descend(a: &PlacedShape, b: &PlacedShape, start: f64, direction: &Vector) -> Option<Parted> {
    let size = start + length_of_bounds(a) + length_of_bounds(b);
    let near = NEAR * size;
    let mut at = [1.0, 2.0, 16.0]
        .into_iter()
        .find_map(|factor| Place::new(a, b, scaled(direction, start * factor + 4.0 * near)))?;
    let mut best = at.parted();
    let mut planes: Vec<(Vector, f64)> = Vec::new();
    let mut goal = [0.0; 3];
    for _ in 0..PLANES {
        let Some(arrived) = advance(a, b, &mut at, &goal, near) else { break };
        if at.length() < best.length {
            best = at.parted();
        }
        if arrived {
            break;
        }
        let between = sub(&at.points[1], &at.points[0]);
        let apart = length(&between);
        if apart.is_nan() || apart <= 0.0 {
            break;
        }
        let normal = scaled(&between, 1.0 / apart);
        planes.push((normal, dot(&normal, &at.translation) - at.distance));
        let Some(next) = shortest_beyond(&planes) else { break };
        if length(&next) >= at.length() - near {
            break;
        }
        goal = next;
    }
    Some(best)
}

/// Where the second shape is moved to, apart from the first.
struct Place {
    translation: Vector,
    distance: f64,
    points: [Vector; 2],
}

impl Place {
    /// None where the shapes are not proved apart there.
    fn new(a: &PlacedShape, b: &PlacedShape, translation: Vector) -> Option<Self> {
        let moved = moved(b, &translation)?;
        let found = separation(a, &moved);
        // What was truly added, after rounding.
        let translation = sub(moved.world_from_local().translation(), b.world_from_local().translation());
        (found.proximity == Proximity::Apart && found.lower.is_finite()).then_some(Self {
            translation,
            distance: found.lower,
            points: found.points,
        })
    }

    fn length(&self) -> f64 {
        // Above the rounding of the length and of the difference of the translations.
        length(&self.translation) * (1.0 + 8.0 * f64::EPSILON)
    }

    fn parted(&self) -> Parted {
        Parted { translation: self.translation, length: self.length(), points: self.points }
    }
}

/// Moves towards a goal until it or contact is near; whether the goal was reached. None where nothing could be gained.
fn advance(a: &PlacedShape, b: &PlacedShape, at: &mut Place, goal: &Vector, near: f64) -> Option<bool> {
    for _ in 0..STEPS {
        let way = sub(goal, &at.translation);
        let left = length(&way);
        if left <= near {
            return Some(true);
        }
        if at.distance <= near {
            return Some(false);
        }
        let step = (at.distance - 0.25 * near).min(left);
        let next = std::array::from_fn(|k| at.translation[k] + way[k] * (step / left));
        *at = Place::new(a, b, next)?;
    }
    Some(false)
}

/// The shortest vector that is beyond planes, each by its normal and its height; none where no three of them tell.
fn shortest_beyond(planes: &[(Vector, f64)]) -> Option<Vector> {
    let is_beyond = |point: &Vector| {
        planes.iter().all(|(normal, height)| dot(normal, point) >= height - 1e-9 * (height.abs() + length(point)))
    };
    let mut best: Option<Vector> = None;
    let mut offer = |point: Option<Vector>| {
        if let Some(point) = point.filter(is_beyond)
            && best.is_none_or(|best| length(&point) < length(&best))
        {
            best = Some(point);
        }
    };
    offer(Some([0.0; 3]));
    for i in 0..planes.len() {
        offer(Some(scaled(&planes[i].0, planes[i].1)));
        for j in i + 1..planes.len() {
            offer(on_two(&planes[i], &planes[j]));
            for k in j + 1..planes.len() {
                offer(on_three([&planes[i], &planes[j], &planes[k]]));
            }
        }
    }
    best
}

/// The point of the line of two planes that is nearest to the origin.
fn on_two((n, g): &(Vector, f64), (m, h): &(Vector, f64)) -> Option<Vector> {
    let cosine = dot(n, m);
    let determinant = 1.0 - cosine * cosine;
    let (s, t) = ((g - h * cosine) / determinant, (h - g * cosine) / determinant);
    (determinant > 1e-9).then(|| std::array::from_fn(|k| s * n[k] + t * m[k]))
}

fn on_three([p, q, r]: [&(Vector, f64); 3]) -> Option<Vector> {
    let (qr, rp, pq) = (cross(&q.0, &r.0), cross(&r.0, &p.0), cross(&p.0, &q.0));
    let determinant = dot(&p.0, &qr);
    (determinant.abs() > 1e-6).then(|| std::array::from_fn(|k| (p.1 * qr[k] + q.1 * rp[k] + r.1 * pq[k]) / determinant))
}

/// The greatest sum found of the radii of two balls about one point, one in each shape.
fn ball_in_both(a: &PlacedShape, b: &PlacedShape, points: &[Vector; 2], upper: f64) -> f64 {
    let sum = |point: &Vector| depth_of_point(a, point) + depth_of_point(b, point);
    let mut at: Vector = std::array::from_fn(|k| 0.5 * points[0][k] + 0.5 * points[1][k]);
    let mut best = sum(&at);
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
    best * (1.0 - 8.0 * f64::EPSILON)
}

/// The radius of a ball about a point of the world that is in a part of a shape; zero where there is none.
fn depth_of_point(shape: &PlacedShape, point: &Vector) -> f64 {
    let corner = [*point];
    let point = Swept { core: Core::Points(&corner), pose: &Pose::IDENTITY, radius: [0.0; 2] };
    let radius = |part: &PlacedShape| match part.form() {
        Form::Convex(shape) => depth(&shape, &point).lower,
        Form::HalfSpace(plane) => plane.depth(&point).lower,
        Form::Surface(surface) if surface.is_solid && surface.nearness(&point, 0.0) == Proximity::Meets => {
            Surface { is_solid: false, ..surface }.separation(&point).lower
        }
        Form::Surface(_) => 0.0,
    };
    let greatest = shape.parts().iter().map(radius).fold(0.0, f64::max);
    if greatest.is_finite() { greatest } else { 0.0 }
}

fn moved(shape: &PlacedShape, by: &Vector) -> Option<PlacedShape> {
    let pose = shape.world_from_local();
    let translation = std::array::from_fn(|k| pose.translation()[k] + by[k]);
    shape.moved_to(Pose::new(*pose.linear(), translation).ok()?).ok()
}

fn length_of_bounds(shape: &PlacedShape) -> f64 {
    shape.bounds().map_or(0.0, |[min, max]| length(&sub(&max, &min)))
}

fn dot(p: &Vector, q: &Vector) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

fn sub(p: &Vector, q: &Vector) -> Vector {
    std::array::from_fn(|k| p[k] - q[k])
}

fn scaled(p: &Vector, by: f64) -> Vector {
    p.map(|x| x * by)
}

fn cross(p: &Vector, q: &Vector) -> Vector {
    crate::primitive::cross(p, q)
}

fn length(p: &Vector) -> f64 {
    let largest = p.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 { largest * dot(&scaled(p, 1.0 / largest), &scaled(p, 1.0 / largest)).sqrt() } else { 0.0 }
}
