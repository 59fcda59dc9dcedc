//! How far a hull reaches outside a solid: a proved interval of the largest distance of a point of
//! the hull from the solid.
//!
//! Boxes cover the hull, and the box with the largest upper bound is halved first. Boxes beyond a
//! plane of the hull are dropped. The distance from the solid changes by at most the way that a
//! point moves, and the signed distance does so too. Both give bounds on a box from its center. The
//! distance from one face of the mesh is a convex function, so it is largest at a corner of the
//! box; that gives a third.
//!
//! Proof: docs/notes/proof.md, L39. Guarded by `tests/it/solids/decomposition.rs`.

use std::cell::Cell;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::budget::Budget;
use crate::exact::{PosedPoint, Spot};
use crate::hull::Hull;
use crate::math::vec3::{Vector, cross, dot, length, sub, unit};
use crate::mesh::Mesh;
use crate::mesh::solid::winding::{Containment, PointClassifier};
use crate::mesh::storage::frame::reciprocal_power_of_two;
use crate::primitive::point_triangle;

/// Share of the largest coordinate that is added to bounds. It covers the rounding of the closed
/// forms, 2^-44, and of the corners of [`MAX_DEPTH`] nested boxes, 2^-53 each.
const SLACK: f64 = 1.0 / (1_u64 << 41) as f64;

/// Maximum number of times that a box is halved. After 200 times it has no size left.
const MAX_DEPTH: u32 = 1 << 10;

/// Maximum number of boxes of one search. A larger number proves more hulls whose largest distance
/// is close to the goal, and takes time in proportion, a few microseconds for each box. A hull that
/// is not proved is cut again.
const MAX_BOXES: usize = 1 << 15;

/// Minimum ratio by which a point must improve the lower bound, so that it is worth a query.
const MIN_GAIN: f64 = 1.0 + 1.0 / 32.0;

/// Number of boxes of all searches of a decomposition after which each search has few boxes. It
/// bounds the time of meshes with many details near the goal to some ten seconds.
const MAX_BOXES_IN_ALL: usize = 1 << 21;

/// Maximum number of boxes of a search after the others took [`MAX_BOXES_IN_ALL`]. The bounds are
/// then rough: fewer parts are merged, and parts are cut more often than needed.
const FEW_BOXES: usize = 1 << 8;

/// Number of boxes between two checks of the budget.
const BOXES_PER_STEP: usize = 32;

/// The work of the searches of one decomposition.
#[derive(Debug, Default)]
pub(super) struct Work {
    /// Number of boxes so far.
    boxes: Cell<usize>,
}

/// Bounds on the largest distance of a point of a hull from a solid, in the unit of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outside {
    pub(super) lower: f64,
    pub(super) upper: f64,
}

/// When a search may end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// Upper bound that is small enough.
    pub(super) enough: f64,
    /// Ratio of the upper to the lower bound that is small enough if the lower bound is larger than
    /// `enough`. Infinity ends the search at the first point that is farther.
    pub(super) ratio: f64,
}

/// A box that may hold points of the hull.
struct Task {
    /// Upper bound on the distance of its points in the hull from the solid.
    upper: f64,
    center: Vector,
    half_extents: Vector,
    /// Numbers of the planes that are not proved to have the whole box on their inner side.
    planes: Vec<u32>,
    depth: u32,
    number: usize,
}

/// A plane with the hull on its inner side: normal · x ≤ offset.
struct OuterPlane {
    normal: Vector,
    offset: f64,
}

impl Outside {
    /// Returns bounds for the hull. They are proved, but wider than the goal if the budget or the
    /// number of boxes is used up.
    pub(super) fn of(mesh: &Mesh, hull: &Hull, goal: Goal, work: &Work, budget: &Budget<'_>) -> Self {
        let max_boxes = if work.boxes.get() < MAX_BOXES_IN_ALL { MAX_BOXES } else { FEW_BOXES };
        let (origin, half_extents) = (mesh.0.frame.origin, mesh.0.half_extents);
        let reach = (0..3).map(|k| hull.reach()[k].max(origin[k].abs() + half_extents[k])).fold(0.0, f64::max);
        let planes = outer_planes(hull);
        let mut search = Search {
            mesh,
            hull,
            planes: &planes,
            classifier: PointClassifier::new(mesh),
            scale: reciprocal_power_of_two(reach),
            slack: SLACK * reach,
            goal,
            lower: 0.0,
            settled: 0.0,
            tasks: BinaryHeap::new(),
            count: 0,
        };
        let [low, high] = bounds(hull);
        let root = Task {
            upper: f64::INFINITY,
            center: std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]),
            half_extents: std::array::from_fn(|k| 0.5 * high[k] - 0.5 * low[k]),
            planes: (0..planes.len() as u32).collect(),
            depth: 0,
            number: 0,
        };
        search.add(root);
        while let Some(task) = search.tasks.pop() {
            let is_done = task.upper <= search.target() || search.count >= max_boxes;
            if is_done || (search.count % BOXES_PER_STEP < 2 && budget.is_spent()) {
                search.settled = search.settled.max(task.upper);
                break;
            }
            for half in task.halves() {
                if let Some(half) = half.within(&planes, search.slack) {
                    search.add(half);
                }
            }
        }
        work.boxes.set(work.boxes.get() + search.count);
        Self { lower: search.lower, upper: search.settled.max(search.lower) }
    }
}

struct Search<'m> {
    mesh: &'m Mesh,
    hull: &'m Hull,
    planes: &'m [OuterPlane],
    classifier: PointClassifier<'m>,
    /// Factor that makes coordinates at most about one, so that their powers are in range.
    scale: f64,
    /// Bound on all rounding, in the unit of the mesh.
    slack: f64,
    goal: Goal,
    /// Largest distance of a point of the hull so far, less the rounding.
    lower: f64,
    /// Upper bound for the boxes that need no more work.
    settled: f64,
    tasks: BinaryHeap<Task>,
    /// Number of boxes so far.
    count: usize,
}

impl Search<'_> {
    /// Returns the upper bound below which a box needs no more work.
    fn target(&self) -> f64 {
        let Goal { enough, ratio } = self.goal;
        if self.lower > enough { ratio * self.lower } else { enough }
    }

    /// Adds a box, whose upper bound is the bound of the box around it.
    fn add(&mut self, mut task: Task) {
        self.count += 1;
        task.number = self.count;
        task.upper = task.upper.min(self.upper_bound(&task));
        if task.upper <= self.target() || task.depth == MAX_DEPTH {
            self.settled = self.settled.max(task.upper);
        } else {
            self.tasks.push(task);
        }
    }

    /// Returns an upper bound on the distance of the points of a box from the solid, and records
    /// the distance of its center if that is in the hull.
    fn upper_bound(&mut self, task: &Task) -> f64 {
        let radius = length(&task.half_extents.map(|x| x * self.scale)) / self.scale;
        let Ok(Some(nearest)) = self.mesh.closest_point(task.center) else { return f64::INFINITY };
        let by_distance = nearest.upper + radius + self.slack;
        if by_distance <= self.target() {
            return by_distance;
        }
        if self.classifier.containment(&PosedPoint::local(Spot::At(task.center))) != Containment::Outside {
            // Every way out of the solid first passes the surface.
            return (radius - nearest.lower + self.slack).max(0.0);
        }
        self.try_point(&task.center, nearest.lower);
        self.climb(&task.center, &nearest.point);
        by_distance.min(self.farthest_from_face(task, nearest.face) + self.slack)
    }

    /// Records the distance of a point outside the solid, if the point is in the hull.
    fn try_point(&mut self, point: &Vector, away: f64) {
        if away - self.slack > self.lower && self.hull.contains(*point) {
            self.lower = away - self.slack;
        }
    }

    /// Moves a point outside the solid away from the nearest point of the surface, up to the border
    /// of the hull, and records the distance there. So the distance above the floor of a recess is
    /// known long before boxes are small.
    fn climb(&mut self, center: &Vector, nearest: &Vector) {
        let from = sub(center, nearest);
        let Some(direction) = unit(&from.map(|x| x * self.scale)) else { return };
        let (mut low, mut high) = (-length(&from), f64::INFINITY);
        for OuterPlane { normal, offset } in self.planes {
            let (slope, gap) = (dot(normal, &direction), offset - dot(normal, center));
            if slope > 0.0 {
                high = high.min(gap / slope);
            } else if slope < 0.0 {
                low = low.max(gap / slope);
            }
        }
        // The border itself may be outside of the hull by rounding.
        let way = high - 2.0 * self.slack;
        let enough = self.goal.enough;
        let wanted = if self.lower > enough { MIN_GAIN * self.lower } else { enough };
        // The distance grows by at most the way.
        if way < low || !way.is_finite() || length(&from) + way <= wanted {
            return;
        }
        let point = std::array::from_fn(|k| center[k] + way * direction[k]);
        let Ok(Some(found)) = self.mesh.closest_point(point) else { return };
        if found.lower - self.slack > self.lower
            && self.classifier.containment(&PosedPoint::local(Spot::At(point))) == Containment::Outside
        {
            self.try_point(&point, found.lower);
        }
    }

    /// Returns the largest distance of a point of a box from a face of the mesh.
    fn farthest_from_face(&self, task: &Task, face: u32) -> f64 {
        let local = |point: &Vector| sub(point, &task.center).map(|x| x * self.scale);
        let triangle = self.mesh.corners(face).each_ref().map(local);
        let half = task.half_extents.map(|x| x * self.scale);
        let corners = (0..8).map(|at| std::array::from_fn(|k| if at >> k & 1 == 0 { half[k] } else { -half[k] }));
        let squared = corners.map(|corner: Vector| point_triangle(&corner, &triangle).0);
        squared.fold(0.0, f64::max).sqrt() / self.scale
    }
}

impl Task {
    /// Returns the two halves of the box, divided across its longest axis.
    fn halves(self) -> [Self; 2] {
        let axis = (1..3).fold(0, |a, b| if self.half_extents[b] > self.half_extents[a] { b } else { a });
        let mut half_extents = self.half_extents;
        half_extents[axis] *= 0.5;
        [-1.0, 1.0].map(|sign| {
            let mut center = self.center;
            center[axis] += sign * half_extents[axis];
            Self { center, half_extents, planes: self.planes.clone(), depth: self.depth + 1, ..self }
        })
    }

    /// Returns the box with the planes that still cross it, or `None` if it is beyond a plane.
    fn within(mut self, planes: &[OuterPlane], slack: f64) -> Option<Self> {
        let mut is_beyond = false;
        self.planes.retain(|&at| {
            let OuterPlane { normal, offset } = &planes[at as usize];
            let gap = dot(normal, &self.center) - offset;
            let reach: f64 = (0..3).map(|k| normal[k].abs() * self.half_extents[k]).sum();
            is_beyond |= gap > reach + slack;
            gap > -reach - slack
        });
        (!is_beyond).then_some(self)
    }
}

/// Returns a plane along each face of the hull. The offset is that of the farthest vertex, so the
/// plane has the hull on one side even if its normal is rounded.
fn outer_planes(hull: &Hull) -> Vec<OuterPlane> {
    let positions = hull.positions();
    let normal = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        unit(&cross(&sub(&b, &a), &sub(&c, &a)))
    };
    let of_normal = |normal| OuterPlane { normal, offset: dot(&normal, &positions[hull.support(normal) as usize]) };
    hull.faces().iter().filter_map(normal).map(of_normal).collect()
}

/// Returns the lower and the upper corner of the box of a hull.
pub(super) fn bounds(hull: &Hull) -> [Vector; 2] {
    let fold = |start: f64, of: fn(f64, f64) -> f64| {
        std::array::from_fn(|k| hull.positions().iter().fold(start, |bound, at| of(bound, at[k])))
    };
    [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
}

impl PartialEq for Task {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Task {}

impl PartialOrd for Task {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Task {
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper).then(other.number.cmp(&self.number))
    }
}
