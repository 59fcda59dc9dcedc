//! The depth of shapes that are not convex: a translation that is proved to separate them, and two
//! spheres about one point, one inside each shape.
//!
//! The second shape starts beyond the first along some direction. From there it moves back towards
//! its own place, by no more than the proved distance, so that it never touches the first shape. If
//! it nearly touches, the nearest points give a plane that the translation must stay beyond. The
//! shortest translation beyond all such planes is the next goal. If the shape reaches a goal
//! without contact, the planes are dropped and the search continues. Several directions are tried.
//! The exact query proves that the shortest translation found separates the shapes.
//!
//! Proof: docs/notes/proof.md, L30. Tests: `tests/it/solids/depths.rs`,
//! `tests/it/shapes/surfaces.rs`.
//!
//! # Source
//! Je, Tang, Lee, Lee, Kim, *PolyDepth: real-time penetration depth computation using iterative
//! contact-space projection*, ACM Transactions on Graphics 31, 2012. Ours advances by proved
//! distances, so that the translation separates the shapes, and has a lower bound (`spheres`).

use super::beyond::shortest_beyond;
use super::directions::{along_axes, directions, scaled, separating_length, surfaces};
use super::spheres::spheres_in_both;
use super::surfaces::surface_of;
use super::table::separation;
use crate::budget::Budget;
use crate::convex::{Depth, Separation, Surface};
use crate::math::Pose;
use crate::math::vec3::{Vector, dot, scaled_length as length, sub};
use crate::mesh::{Options, WarmStart};
use crate::query::penetrates::Penetrates;
use crate::query::{Proximity, Query, of_meshes};
use crate::shape::PlacedShape;

/// Maximum number of directions along axes that are searched: those with the shortest translations.
const MAX_AXIS_STARTS: usize = 3;

/// Minimum cosine between two consecutive directions of which only the first one is searched.
const MIN_SAME_DIRECTION_COSINE: f64 = 1.0 - 1.0 / (1 << 12) as f64;

/// Maximum number of attempts to shorten the translation. Each takes three distances.
const TIGHTENINGS: usize = 6;

/// Minimum relative gain in length to continue after a goal, 2^-14. Less takes more steps.
const MIN_GAIN: f64 = 1.0 / (1 << 14) as f64;

/// Maximum number of planes that are collected from one direction.
const MAX_PLANES: usize = 12;

/// Maximum number of steps to a goal. A direct way takes 2 or 3, an unreachable goal takes all.
const MAX_STEPS: usize = 24;

/// Touching distance relative to the sizes, 2^-26. Less costs steps, more leaves the depth loose.
const CONTACT_TOLERANCE: f64 = 1.0 / (1 << 26) as f64;

/// Returns how deep two intersecting shapes are in each other. The search always moves the same one
/// of the two shapes, whichever is named first, if their boxes differ.
pub(in crate::query) fn depth_by_search(a: &PlacedShape, b: &PlacedShape, budget: &Budget<'_>) -> Depth {
    let key = |shape: &PlacedShape| shape.bounds().map(|bounds| bounds.concat());
    let is_swapped = key(b) < key(a);
    let mut found = if is_swapped { depth_in_order(b, a, budget) } else { depth_in_order(a, b, budget) };
    if is_swapped {
        found.points.swap(0, 1);
        found.normal = found.normal.map(|x| 0.0 - x);
    }
    if found.lower == 0.0 && certainly_only_touch(a, b, budget) {
        found.upper = 0.0;
    }
    found
}

fn depth_in_order(a: &PlacedShape, b: &PlacedShape, budget: &Budget<'_>) -> Depth {
    let start = |direction: Vector| {
        let length = separating_length(a, b, &direction);
        length.is_finite().then_some((length, direction))
    };
    let mut axes: Vec<(f64, Vector)> = along_axes(a, b).filter_map(start).collect();
    axes.sort_by(|x, y| x.0.total_cmp(&y.0));
    axes.truncate(MAX_AXIS_STARTS);
    let mut starts: Vec<(f64, Vector)> = directions(a, b, budget).into_iter().filter_map(start).chain(axes).collect();
    starts.dedup_by(|next, start| dot(&next.1, &start.1) > MIN_SAME_DIRECTION_COSINE);
    let mut least = f64::INFINITY;
    let ways = starts.iter().filter_map(|(length, direction)| {
        let way = descend(a, b, *length, direction, least, budget)?;
        least = least.min(way.length);
        Some(way)
    });
    let mut ways: Vec<Separated> = ways.collect();
    ways.sort_by(|x, y| x.length.total_cmp(&y.length));
    let Some(best) = ways
        .into_iter()
        .find(|way| is_separated(a, b, &way.translation, budget))
        .map(|way| tightened(a, b, way, budget))
    else {
        let points = separation(a, b, budget).points;
        return Depth { lower: 0.0, upper: f64::INFINITY, normal: [1.0, 0.0, 0.0], points };
    };
    let points = [best.points[0], sub(&best.points[1], &best.translation)];
    let lower = spheres_in_both(a, b, &points, best.length).min(best.length);
    let normal = scaled(&best.translation, 1.0 / length(&best.translation));
    Depth { lower, upper: best.length, normal, points }
}

/// Reports whether the shapes are solid meshes with disjoint interiors: their depth is zero.
fn certainly_only_touch(a: &PlacedShape, b: &PlacedShape, budget: &Budget<'_>) -> bool {
    surfaces(a, b).is_some_and(|[a, b]| {
        let (placed_a, placed_b) = (surface_of(&a), surface_of(&b));
        let penetrates = || Query::new().with_budget(budget).penetrates(placed_a, placed_b);
        a.is_solid && b.is_solid && penetrates() == Penetrates::No
    })
}

/// Reports whether the second shape, moved by a translation, is proved to be apart from the first.
fn is_separated(a: &PlacedShape, b: &PlacedShape, translation: &Vector, budget: &Budget<'_>) -> bool {
    moved(b, translation).is_some_and(|b| separation(a, &b, budget).proximity == Proximity::Apart)
}

/// Shortens a translation until the shapes nearly touch. Each step moves by the proved distance
/// less 1/1024 of it. If the shapes approach head on, the gap becomes 1,024 times smaller.
fn tightened(a: &PlacedShape, b: &PlacedShape, way: Separated, budget: &Budget<'_>) -> Separated {
    /// Part of the distance that is left. It is larger than the rounding error.
    const LEFT: f64 = 1.0 / (1 << 10) as f64;
    let mut warm_start = WarmStart::default();
    let mut best = way;
    for _ in 0..TIGHTENINGS {
        let Some(at) = Place::new(a, b, best.translation, &mut warm_start, budget) else { break };
        let whole = length(&best.translation);
        let share = (whole - at.distance * (1.0 - LEFT)) / whole;
        let Some(nearer) = Place::new(a, b, scaled(&best.translation, share), &mut warm_start, budget) else { break };
        if share <= 0.0 || nearer.length() >= best.length || !is_separated(a, b, &nearer.translation, budget) {
            break;
        }
        best = nearer.separated();
    }
    best
}

/// Translation of the second shape that separates it from the first, and the nearest points there.
struct Separated {
    translation: Vector,
    length: f64,
    points: [Vector; 2],
}

/// Returns the shortest translation found from far along a direction. The search ends early if it
/// cannot become shorter than `least`.
fn descend(
    a: &PlacedShape,
    b: &PlacedShape,
    start: f64,
    direction: &Vector,
    least: f64,
    budget: &Budget<'_>,
) -> Option<Separated> {
    let size = start + length_of_bounds(a) + length_of_bounds(b);
    let near = CONTACT_TOLERANCE * size;
    let mut warm_start = WarmStart::default();
    let mut at = [1.0, 2.0, 16.0]
        .into_iter()
        .map(|factor| scaled(direction, start * factor + 4.0 * near))
        .filter(|translation| is_separated(a, b, translation, budget))
        .find_map(|translation| Place::new(a, b, translation, &mut warm_start, budget))?;
    let mut best = at.separated();
    let mut planes: Vec<(Vector, f64)> = Vec::new();
    let mut goal = [0.0; 3];
    let mut arrived_at = f64::INFINITY;
    for _ in 0..MAX_PLANES {
        let Some(arrived) = advance(a, b, &mut at, &goal, near, &mut warm_start, budget) else { break };
        if at.length() < best.length {
            best = at.separated();
        }
        if arrived {
            let is_worth_more = at.distance > near && at.length() < arrived_at * (1.0 - MIN_GAIN);
            if !is_worth_more {
                break;
            }
            arrived_at = at.length();
            planes.clear();
            goal = [0.0; 3];
            continue;
        }
        let between = sub(&at.points[1], &at.points[0]);
        let apart = length(&between);
        if apart.is_nan() || apart <= 0.0 {
            break;
        }
        let normal = scaled(&between, 1.0 / apart);
        planes.push((normal, dot(&normal, &at.translation) - at.distance));
        let Some(next) = shortest_beyond(&planes) else { break };
        if length(&next) >= at.length().min(least) - near {
            break;
        }
        goal = next;
    }
    Some(best)
}

/// Place of the second shape, apart from the first.
struct Place {
    translation: Vector,
    distance: f64,
    points: [Vector; 2],
}

impl Place {
    /// Returns the place after a translation, or `None` if the shapes are not proved apart there
    /// or the budget is spent.
    /// Only the surfaces of meshes are compared. At the start neither mesh is inside the other, and
    /// a mesh that never touches the other surface stays outside.
    fn new(
        a: &PlacedShape,
        b: &PlacedShape,
        translation: Vector,
        warm_start: &mut WarmStart,
        budget: &Budget<'_>,
    ) -> Option<Self> {
        if budget.is_spent() {
            return None;
        }
        let moved = moved(b, &translation)?;
        let found = match surfaces(a, &moved) {
            Some([a, b]) => separation_of_surfaces(&a, &b, warm_start, budget),
            None => separation(a, &moved, budget),
        };
        // The translation that was really added, after rounding.
        let translation = sub(moved.world_from_local().translation(), b.world_from_local().translation());
        (found.proximity == Proximity::Apart && found.lower.is_finite()).then_some(Self {
            translation,
            distance: found.lower,
            points: found.points,
        })
    }

    fn length(&self) -> f64 {
        // Larger than the rounding errors of the length and of the difference.
        length(&self.translation) * (1.0 + 8.0 * f64::EPSILON)
    }

    fn separated(&self) -> Separated {
        Separated { translation: self.translation, length: self.length(), points: self.points }
    }
}

fn separation_of_surfaces(
    a: &Surface<'_>,
    b: &Surface<'_>,
    warm_start: &mut WarmStart,
    budget: &Budget<'_>,
) -> Separation {
    let options = Options { budget, ..Options::default() };
    let found = of_meshes::distance(surface_of(a), surface_of(b), warm_start, &options);
    let points = found.witness.map_or([[0.0; 3]; 2], |witness| [witness.point_a, witness.point_b]);
    let proximity = if found.proximity == Proximity::Apart { Proximity::Apart } else { Proximity::Intersects };
    Separation { lower: found.lower, upper: found.upper, points, proximity }
}

/// Moves towards a goal until the goal or a contact is near. Returns whether the goal was reached,
/// or `None` if a step cannot be proved to be apart.
fn advance(
    a: &PlacedShape,
    b: &PlacedShape,
    at: &mut Place,
    goal: &Vector,
    near: f64,
    warm_start: &mut WarmStart,
    budget: &Budget<'_>,
) -> Option<bool> {
    for _ in 0..MAX_STEPS {
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
        *at = Place::new(a, b, next, warm_start, budget)?;
    }
    Some(false)
}

fn moved(shape: &PlacedShape, by: &Vector) -> Option<PlacedShape> {
    let pose = shape.world_from_local();
    let translation = std::array::from_fn(|k| pose.translation()[k] + by[k]);
    shape.moved_to(Pose::new(*pose.linear(), translation).ok()?).ok()
}

fn length_of_bounds(shape: &PlacedShape) -> f64 {
    shape.bounds().map_or(0.0, |[min, max]| length(&sub(&max, &min)))
}
