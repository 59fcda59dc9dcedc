//! Chooses the direction from which a clash is visible.

use super::axes::{Axis, Directions, looking};
use super::bounds::{Bounds, center, corners, grown, overlap, radius};
use super::camera::Camera;
use super::canvas::Canvas;
use super::parts::Parts;
use super::subject::Subject;
use super::vector::{Vector, add, length, minus, times};

/// Ratio of the radius of a picture to that of the contact: the least, and the most. Between them,
/// the smaller part fits into the picture. More than the most makes the contact too small to see.
const AROUND: [f64; 2] = [1.7, 6.0];

/// Radius of a contact relative to the smaller part, at least. Parts that touch in a point have a
/// contact without extent.
const LEAST_CONTACT: f64 = 0.05;

/// Size of the pictures in which views are compared, in pixels.
const TRIAL: [u32; 2] = [192, 144];

/// Number of points along the curves whose visibility is checked.
const POINTS: usize = 600;

/// Depth tolerance in pixels of a trial, so that a point on the surface of a part is visible.
const TOLERANCE: f64 = 2.0;

/// Size of a cell in pixels of a trial. Visible points count once a cell, so that views count that
/// show the contact large.
const CELL: f64 = 2.0;

/// Share of the best view that is good enough. The first of the good views is taken, so that most
/// pictures have the same direction.
const GOOD: f64 = 0.85;

/// Directions of the viewer: two horizontal components and the vertical one. The usual view comes
/// first.
const VIEWS: [Vector; 24] = {
    const LEVELS: [f64; 3] = [-0.42, -1.3, 0.42];
    const AROUND: [[f64; 2]; 8] = [
        [-0.5, 0.88],
        [0.5, 0.88],
        [-0.88, -0.5],
        [0.88, 0.5],
        [0.88, -0.5],
        [-0.88, 0.5],
        [0.5, -0.88],
        [-0.5, -0.88],
    ];
    let mut views = [[0.0; 3]; 24];
    let mut at = 0;
    while at < 24 {
        let [x, y] = AROUND[at % 8];
        views[at] = [x, y, LEVELS[at / 8]];
        at += 1;
    }
    views
};

/// A view of a clash.
pub(super) struct ChosenView {
    pub(super) directions: Directions,
    /// The middle of the picture, and the radius of the sphere that it shows.
    pub(super) target: Vector,
    pub(super) radius: f64,
    /// Share of the contact that is visible.
    pub(super) visible: f64,
}

/// Returns the view in which most of the contact is visible among some directions.
pub(super) fn choose(parts: &Parts<'_>, subject: &Subject, up: Axis) -> ChosenView {
    let target = center(subject.contact);
    let smaller = subject.parts.map(|part| radius(parts.get(part).bounds)).into_iter().fold(f64::INFINITY, f64::min);
    let contact = radius(subject.contact).max(LEAST_CONTACT * smaller).max(f64::MIN_POSITIVE);
    let radius = smaller.clamp(AROUND[0] * contact, AROUND[1] * contact);
    let points = points(subject);
    // Only faces near the contact can hide it.
    let near = grown([target, target], 2.0 * radius);
    let faces: Vec<[Vector; 3]> = subject.parts.iter().flat_map(|&part| faces_in(parts, part, &near)).collect();
    let trials: Vec<(Directions, usize, usize)> = VIEWS
        .iter()
        .map(|&view| {
            let directions = looking(along(view, up), up);
            let camera = Camera::at(target, radius, directions, TRIAL, None);
            let mut canvas = Canvas::new(TRIAL);
            canvas.draw(&camera, [0.0; 2], faces.len(), |face| (faces[face], [0; 3]));
            let seen = points.iter().map(|&point| camera.project(point));
            let mut cells: Vec<[i64; 2]> = seen
                .filter(|&point| canvas.sees(point, TOLERANCE))
                .map(|[x, y, _]| [x, y].map(|at| (at / CELL) as i64))
                .collect();
            let visible = cells.len();
            cells.sort_unstable();
            cells.dedup();
            (directions, cells.len(), visible)
        })
        .collect();
    let best = trials.iter().map(|trial| trial.1).max().unwrap_or(0);
    let is_good = |trial: &&(Directions, usize, usize)| trial.1 as f64 >= GOOD * best as f64;
    let &(directions, _, visible) = trials.iter().find(is_good).unwrap_or(&trials[0]);
    ChosenView { directions, target, radius, visible: visible as f64 / points.len().max(1) as f64 }
}

/// Returns a direction whose last component is along the axis that points up.
fn along([x, y, z]: Vector, up: Axis) -> Vector {
    match up {
        Axis::X => [z, x, y],
        Axis::Y => [x, z, -y],
        Axis::Z => [x, y, z],
    }
}

/// Returns points on the contact: along the curves, or on the edges and faces of its box.
fn points(subject: &Subject) -> Vec<Vector> {
    let segments: Vec<[Vector; 2]> =
        subject.curves.iter().flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]])).collect();
    let total: f64 = segments.iter().map(|[from, to]| length(minus(*to, *from))).sum();
    if total > 0.0 {
        let step = total / POINTS as f64;
        let mut points = Vec::with_capacity(POINTS + 1);
        let mut left = 0.0;
        for [from, to] in segments {
            let size = length(minus(to, from));
            let mut at = left;
            while at < size {
                points.push(add(from, times(minus(to, from), at / size)));
                at += step;
            }
            left = at - size;
        }
        return points;
    }
    box_points(subject.contact)
}

/// Returns a grid of points on the surface of a box.
fn box_points([min, max]: Bounds) -> Vec<Vector> {
    const STEPS: usize = 8;
    let at = |k: usize, step: usize| min[k] + (max[k] - min[k]) * step as f64 / STEPS as f64;
    let mut points = corners(&[min, max]).to_vec();
    for (axis, end) in [(0, 0), (0, STEPS), (1, 0), (1, STEPS), (2, 0), (2, STEPS)] {
        for first in 0..=STEPS {
            for second in 0..=STEPS {
                let mut steps = [first; 3];
                (steps[axis], steps[(axis + 2) % 3]) = (end, second);
                points.push([0, 1, 2].map(|k| at(k, steps[k])));
            }
        }
    }
    points
}

fn faces_in<'p>(parts: &'p Parts<'_>, part: usize, near: &'p Bounds) -> impl Iterator<Item = [Vector; 3]> + 'p {
    parts.get(part).triangles().filter(|corners| {
        let low = [0, 1, 2].map(|k| corners[0][k].min(corners[1][k]).min(corners[2][k]));
        let high = [0, 1, 2].map(|k| corners[0][k].max(corners[1][k]).max(corners[2][k]));
        overlap(&[low, high], near)
    })
}
