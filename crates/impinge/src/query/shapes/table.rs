//! The table of pairs: the kernel of each query for two parts, by their representations.
//!
//! A compound is compared part by part. Pairs of parts whose boxes are too far apart are skipped.
//! If there are many parts, a tree finds the other pairs.

use super::fields::{crop_near, crops_near, separation_of_field, separation_of_fields};
use super::surfaces::{mesh_of, nearness_of_surfaces, separation_of_surfaces};
use crate::budget::Budget;
use crate::convex::{self, Depth, Separation};
use crate::query::Proximity;
use crate::shape::{Form, PlacedShape};

/// Returns whether two shapes are at most `clearance` apart. `clearance` must be finite and not
/// negative. The answer is undecided if the budget ends the query.
pub(in crate::query) fn nearness(a: &PlacedShape, b: &PlacedShape, clearance: f64, budget: &Budget<'_>) -> Proximity {
    if let ([a], [b]) = (a.parts(), b.parts()) {
        let is_far = are_boxes_farther(a, b, clearance);
        return if is_far { Proximity::Apart } else { nearness_of_parts(a, b, clearance, budget) };
    }
    let mut answer = Proximity::Apart;
    for [number_a, number_b] in pairs_near(a, b, clearance) {
        if budget.is_spent() {
            return Proximity::Undecided;
        }
        match nearness_of_parts(&a.parts()[number_a as usize], &b.parts()[number_b as usize], clearance, budget) {
            Proximity::Intersects => return Proximity::Intersects,
            Proximity::Undecided => answer = Proximity::Undecided,
            Proximity::Apart => {}
        }
    }
    answer
}

/// Returns whether two parts are at most `clearance` apart.
pub(super) fn nearness_of_parts(a: &PlacedShape, b: &PlacedShape, clearance: f64, budget: &Budget<'_>) -> Proximity {
    match (a.form(), b.form()) {
        (Form::Convex(a), Form::Convex(b)) => convex::nearness(&a, &b, clearance),
        (Form::HalfSpace(plane), Form::Convex(shape)) | (Form::Convex(shape), Form::HalfSpace(plane)) => {
            plane.nearness(&shape, clearance)
        }
        (Form::HalfSpace(a), Form::HalfSpace(b)) => a.nearness_of_half_spaces(&b, clearance),
        (Form::Surface(surface), Form::Convex(shape)) | (Form::Convex(shape), Form::Surface(surface)) => {
            surface.nearness(&shape, clearance)
        }
        (Form::Surface(surface), Form::HalfSpace(plane)) | (Form::HalfSpace(plane), Form::Surface(surface)) => {
            plane.nearness_of_surface(&surface, clearance)
        }
        (Form::Surface(a), Form::Surface(b)) => nearness_of_surfaces(mesh_of(&a), mesh_of(&b), clearance, budget),
        (Form::Field(field), Form::Convex(shape)) | (Form::Convex(shape), Form::Field(field)) => {
            field.nearness(&shape, clearance)
        }
        (Form::Field(field), Form::HalfSpace(plane)) | (Form::HalfSpace(plane), Form::Field(field)) => {
            plane.nearness_of_surface(&field, clearance)
        }
        (Form::Field(field), Form::Surface(surface)) | (Form::Surface(surface), Form::Field(field)) => {
            match crop_near(&field, &surface, clearance) {
                Some(crop) => nearness_of_surfaces(crop.mesh.at(*field.pose), mesh_of(&surface), clearance, budget),
                None => Proximity::Apart,
            }
        }
        (Form::Field(a), Form::Field(b)) => match crops_near(&a, &b, clearance) {
            Some([crop_a, crop_b]) => {
                nearness_of_surfaces(crop_a.mesh.at(*a.pose), crop_b.mesh.at(*b.pose), clearance, budget)
            }
            None => Proximity::Apart,
        },
    }
}

/// Computes the distance of two shapes: the minimum over their parts. If the budget ends the query,
/// the lower bound is zero and the answer undecided.
pub(in crate::query) fn separation(a: &PlacedShape, b: &PlacedShape, budget: &Budget<'_>) -> Separation {
    if let ([a], [b]) = (a.parts(), b.parts()) {
        return separation_of_parts(a, b, f64::INFINITY, budget);
    }
    let of_parts = |[i, j]: [u32; 2], limit: f64| {
        separation_of_parts(&a.parts()[i as usize], &b.parts()[j as usize], limit, budget)
    };
    let first = near_pair(a, b).map(|numbers| (numbers, of_parts(numbers, f64::INFINITY)));
    let reach = first.map_or(f64::INFINITY, |(_, found)| found.upper);
    let mut near: Vec<(f64, [u32; 2])> = pairs_near(a, b, reach)
        .into_iter()
        .map(|[i, j]| (gap_of_boxes(&a.parts()[i as usize], &b.parts()[j as usize]), [i, j]))
        .collect();
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    let mut best =
        Separation { lower: f64::INFINITY, upper: f64::INFINITY, points: [[0.0; 3]; 2], proximity: Proximity::Apart };
    for (gap, [i, j]) in near {
        if gap > best.upper {
            break;
        }
        if best.upper < f64::INFINITY && budget.is_spent() {
            return Separation { lower: 0.0, proximity: Proximity::Undecided, ..best };
        }
        let known = first.filter(|(numbers, _)| *numbers == [i, j]);
        let found = known.map_or_else(|| of_parts([i, j], reach.min(best.upper)), |(_, found)| found);
        let lower = best.lower.min(found.lower);
        let is_undecided = best.proximity == Proximity::Undecided || found.proximity == Proximity::Undecided;
        if found.proximity == Proximity::Intersects {
            return found;
        }
        if found.upper < best.upper {
            best = found;
        }
        best.lower = lower;
        if is_undecided {
            best.proximity = Proximity::Undecided;
        }
    }
    best
}

/// Computes the distance of two parts. It may be infinite if they are farther apart than `limit`.
fn separation_of_parts(a: &PlacedShape, b: &PlacedShape, limit: f64, budget: &Budget<'_>) -> Separation {
    match (a.form(), b.form()) {
        (Form::Convex(a), Form::Convex(b)) => convex::separation(&a, &b),
        (Form::HalfSpace(plane), Form::Convex(shape)) => plane.separation(&shape),
        (Form::Convex(shape), Form::HalfSpace(plane)) => swapped(plane.separation(&shape)),
        (Form::HalfSpace(a), Form::HalfSpace(b)) => a.separation_of_half_spaces(&b),
        (Form::Surface(surface), Form::Convex(shape)) => surface.separation_within(&shape, limit),
        (Form::Convex(shape), Form::Surface(surface)) => swapped(surface.separation_within(&shape, limit)),
        (Form::HalfSpace(plane), Form::Surface(surface)) => plane.separation_of_surface(&surface),
        (Form::Surface(surface), Form::HalfSpace(plane)) => swapped(plane.separation_of_surface(&surface)),
        (Form::Surface(a), Form::Surface(b)) => separation_of_surfaces(mesh_of(&a), mesh_of(&b), budget),
        (Form::Field(field), Form::Convex(shape)) => field.separation_within(&shape, limit),
        (Form::Convex(shape), Form::Field(field)) => swapped(field.separation_within(&shape, limit)),
        (Form::Field(field), Form::HalfSpace(plane)) => swapped(plane.separation_of_surface(&field)),
        (Form::HalfSpace(plane), Form::Field(field)) => plane.separation_of_surface(&field),
        (Form::Field(field), Form::Surface(surface)) => separation_of_field(&field, &surface, budget),
        (Form::Surface(surface), Form::Field(field)) => swapped(separation_of_field(&field, &surface, budget)),
        (Form::Field(a), Form::Field(b)) => separation_of_fields(&a, &b, budget),
    }
}

/// Computes how deep two shapes are in each other, in closed form or with an expanding polytope.
/// Returns `None` if that takes a search: for compounds, and for meshes with anything but
/// half-spaces.
pub(in crate::query) fn depth(a: &PlacedShape, b: &PlacedShape) -> Option<Depth> {
    let ([a], [b]) = (a.parts(), b.parts()) else { return None };
    match (a.form(), b.form()) {
        (Form::Convex(a), Form::Convex(b)) => Some(convex::depth(&a, &b)),
        (Form::HalfSpace(plane), Form::Convex(shape)) => Some(plane.depth(&shape)),
        (Form::Convex(shape), Form::HalfSpace(plane)) => Some(turned(plane.depth(&shape))),
        (Form::HalfSpace(a), Form::HalfSpace(b)) => Some(a.depth_of_half_spaces(&b)),
        (Form::HalfSpace(plane), Form::Surface(surface)) => plane.depth_of_surface(&surface),
        (Form::Surface(surface), Form::HalfSpace(plane)) => plane.depth_of_surface(&surface).map(turned),
        (Form::HalfSpace(plane), Form::Field(field)) => plane.depth_of_surface(&field),
        (Form::Field(field), Form::HalfSpace(plane)) => plane.depth_of_surface(&field).map(turned),
        (Form::Surface(_) | Form::Field(_), _) | (_, Form::Surface(_) | Form::Field(_)) => None,
    }
}

/// Returns the pairs of parts whose boxes are at most `reach` apart, sorted.
pub(super) fn pairs_near(a: &PlacedShape, b: &PlacedShape, reach: f64) -> Vec<[u32; 2]> {
    // The parts of the shape with fewer parts are looked up in the tree of the other shape.
    let is_turned = a.parts().len() > b.parts().len();
    let (few, many) = if is_turned { (b, a) } else { (a, b) };
    let mut found = Vec::new();
    for number in few.parts_near(many.bounds(), reach) {
        let part = &few.parts()[number as usize];
        for other in many.parts_near(part.bounds(), reach) {
            if gap_of_boxes(part, &many.parts()[other as usize]) <= reach {
                found.push(if is_turned { [other, number] } else { [number, other] });
            }
        }
    }
    if is_turned {
        found.sort_unstable();
    }
    found
}

/// Returns a pair of parts that are near each other, to start a search with. Returns `None` if the
/// second shape has no box, or the chosen part has none.
fn near_pair(a: &PlacedShape, b: &PlacedShape) -> Option<[u32; 2]> {
    let middle = |[min, max]: [[f64; 3]; 2]| std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]);
    let number_a = match b.bounds().map(middle) {
        Some(point) => a.part_nearest(point).unwrap_or(0),
        None => return None,
    };
    let point = a.parts()[number_a as usize].bounds().map(middle)?;
    Some([number_a, b.part_nearest(point).unwrap_or(0)])
}

/// Reports whether the gap between the boxes of two parts proves them farther apart than
/// `clearance`, which must not be negative.
#[inline]
pub(super) fn are_boxes_farther(a: &PlacedShape, b: &PlacedShape, clearance: f64) -> bool {
    let (Some([min_a, max_a]), Some([min_b, max_b])) = (a.bounds(), b.bounds()) else { return false };
    // The differences are rounded.
    let least = clearance.next_up();
    (0..3).any(|k| min_b[k] - max_a[k] > least || min_a[k] - max_b[k] > least)
}

/// Returns a lower bound of the gap between the boxes of two parts; zero if one has no box.
pub(super) fn gap_of_boxes(a: &PlacedShape, b: &PlacedShape) -> f64 {
    let (Some([min_a, max_a]), Some([min_b, max_b])) = (a.bounds(), b.bounds()) else { return 0.0 };
    let gap = |k: usize| f64::max(min_b[k] - max_a[k], min_a[k] - max_b[k]);
    gap(0).max(gap(1)).max(gap(2)).next_down().max(0.0)
}

fn swapped(mut found: Separation) -> Separation {
    found.points.swap(0, 1);
    found
}

fn turned(mut found: Depth) -> Depth {
    found.points.swap(0, 1);
    found.normal = found.normal.map(|x| 0.0 - x);
    found
}
