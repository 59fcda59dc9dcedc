//! A mesh or a height field and a convex set: finds the faces near the set. Each face is a convex
//! set itself.
//!
//! The descent of the mesh's tree is pruned by proved bounds: the gap between a node's box and the
//! set's box, and the gap along the direction from the nearest face so far. Each face gets the
//! answer of `distance` for a triangle. So a boolean about a polytope is exact, and if a face is
//! undecided, the answer may be undecided.
//!
//! The proof is docs/notes/proof.md, L31, and the tests are in `tests/it/shapes/surfaces.rs`.

use std::cell::Cell;
use std::ops::ControlFlow::{self, Break, Continue};

use super::distance::{Coherence, nearness_from, separation_within};
use super::interval::{Separation, above, below};
use super::posed::{Core, Pair, Swept, to_unit_length};
use crate::exact::{Placement, PosedPoint, Spot};
use crate::math::Pose;
use crate::math::vec3::{dot, length, sub};
use crate::mesh::{Containment, FaceSearch, Faces, Mesh};
use crate::volume::Proximity;

/// A mesh or a height field in the world: its surface, or also the region that a mesh encloses.
#[derive(Debug)]
pub(crate) struct Surface<'a, F = Mesh> {
    pub(crate) mesh: &'a F,
    pub(crate) pose: &'a Pose,
    pub(crate) is_solid: bool,
}

impl<F> Clone for Surface<'_, F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F> Copy for Surface<'_, F> {}

impl<'a, F: Faces> Surface<'a, F> {
    /// Returns a face as a convex set. The caller keeps its corners.
    pub(super) fn face<'c>(&'c self, corners: &'c [[f64; 3]; 3]) -> Swept<'c> {
        Swept { core: Core::Points(corners), pose: self.pose, radius: [0.0; 2] }
    }

    /// Returns a box that holds the mesh, as least and greatest corner in the world frame. Returns
    /// `None` if the mesh has no faces.
    pub(crate) fn world_bounds(&self) -> Option<[[f64; 3]; 2]> {
        let corners = self.mesh.local_bounds().map(corners_of_box)?;
        Some(Swept { core: Core::Points(&corners), pose: self.pose, radius: [0.0; 2] }.world_bounds())
    }

    /// Reports whether the mesh and a convex set are within `clearance` of each other, in world
    /// units. The clearance must be finite and not negative. `Intersects` means that they are.
    pub(crate) fn nearness(&self, shape: &Swept<'_>, clearance: f64) -> Proximity {
        let mut search =
            Nearness { surface: self, shape, clearance, answer: Proximity::Apart, known: Coherence::default() };
        self.search(shape, &mut search);
        match search.answer {
            Proximity::Intersects => Proximity::Intersects,
            answer => match self.containment(shape) {
                Containment::Outside => answer,
                Containment::Undecided => Proximity::Undecided,
                Containment::Inside | Containment::Surface => Proximity::Intersects,
            },
        }
    }

    /// Returns the distance of a convex set, in world units. It is infinite if the mesh has no
    /// faces.
    pub(crate) fn separation(&self, shape: &Swept<'_>) -> Separation {
        let mut search = Separating {
            surface: self,
            shape,
            best: Separation {
                lower: f64::INFINITY,
                upper: f64::INFINITY,
                points: [[0.0; 3]; 2],
                proximity: Proximity::Apart,
            },
            face: u32::MAX,
            direction: None,
            known: Coherence::default(),
        };
        self.search(shape, &mut search);
        let mut best = search.best;
        if best.proximity != Proximity::Intersects {
            let contained = self.containment(shape);
            if contained.is_contained() {
                let point = self.inner_point(shape);
                (best.points, best.lower) = ([point; 2], 0.0);
                best.proximity =
                    if contained == Containment::Undecided { Proximity::Undecided } else { Proximity::Intersects };
                best.upper = if best.proximity == Proximity::Intersects { 0.0 } else { best.upper };
            }
        }
        best
    }

    /// Returns the position of a point of the set's core relative to the mesh, if the mesh is
    /// solid, otherwise `Outside`. If no face intersects the core, the answer holds for the whole
    /// core.
    pub(crate) fn containment(&self, shape: &Swept<'_>) -> Containment {
        if !self.is_solid {
            return Containment::Outside;
        }
        let local = shape.core.point();
        let placement = Placement::new(self.pose, shape.pose);
        self.mesh.containment(&PosedPoint::new(&placement, Spot::At(local)))
    }

    fn inner_point(&self, shape: &Swept<'_>) -> [f64; 3] {
        shape.pose.apply(shape.core.point())
    }

    /// Returns the faces that may be within `reach` of a box of the world, given by its least and
    /// its greatest corner.
    pub(crate) fn faces_near_box(&self, bounds: [[f64; 3]; 2], reach: f64) -> Vec<u32> {
        let corners = corners_of_box(bounds);
        let shape = Swept { core: Core::Points(&corners), pose: &Pose::IDENTITY, radius: [0.0; 2] };
        let mut search = Collecting { reach, faces: Vec::new() };
        self.search(&shape, &mut search);
        search.faces
    }

    fn search(&self, shape: &Swept<'_>, search: &mut impl Search) {
        let Some(corners) = self.mesh.local_bounds().map(corners_of_box) else { return };
        let bounds = Swept { core: Core::Points(&corners), pose: self.pose, radius: [0.0; 2] };
        let pair = Pair::new(&bounds, shape);
        self.mesh.search(&mut Bounded { mesh: self.mesh, beside: Beside::new(&pair, shape.radius[1]), search });
    }
}

pub(super) fn corners_of_box(bounds: [[f64; 3]; 2]) -> [[f64; 3]; 8] {
    std::array::from_fn(|i| std::array::from_fn(|k| bounds[i >> k & 1][k]))
}

/// A convex set in the common frame of it and a mesh, prepared for bounds on the mesh's boxes.
pub(super) struct Beside<'p> {
    pair: &'p Pair<'p>,
    /// Least and greatest coordinate of the set's core on each axis, in the common frame.
    bounds: [[f64; 2]; 3],
    radius: f64,
    error: f64,
    /// A direction of length 1 from the mesh to the set, with the set's least height along it.
    plane: Cell<Option<([f64; 3], f64)>>,
}

impl<'p> Beside<'p> {
    pub(super) fn new(pair: &'p Pair<'p>, radius: f64) -> Self {
        let radius = above(radius / pair.unit);
        let error = pair.point_error();
        let bounds = std::array::from_fn(|k| {
            let end = |sign: f64| {
                let direction = std::array::from_fn(|j| if j == k { sign } else { 0.0 });
                sign * (pair.b.support(direction).point[k] * sign + pair.height_error(direction))
            };
            [end(-1.0), end(1.0)]
        });
        Self { pair, bounds, radius, error, plane: Cell::new(None) }
    }

    /// Adds the gap along a direction of the world, from the mesh to the set, to all later bounds.
    fn look_along(&self, direction: [f64; 3]) {
        let direction = to_unit_length(direction);
        let against = direction.map(|x| -x);
        let lowest = dot(&direction, &self.pair.b.support(against).point);
        self.plane.set(Some((direction, lowest - self.pair.height_error(against) - self.radius)));
    }

    /// Returns a lower bound on the distance, in world units, between the set and a box of the
    /// mesh's frame. It is negative if the two boxes overlap, and the more so the deeper they do: a
    /// face in the middle of the set is found before those at its border.
    pub(super) fn bound(&self, center: &[f64; 3], half_extents: &[f64; 3]) -> f64 {
        let at = self.pair.a.spot(*center).point;
        let linear = self.pair.a.pose().linear();
        let scale = 1.0 / self.pair.unit;
        let gaps: [f64; 3] = std::array::from_fn(|k| {
            let reach = (0..3).map(|j| linear[k][j].abs() * half_extents[j]).sum::<f64>() * scale;
            f64::max(self.bounds[k][0] - (at[k] + reach), at[k] - reach - self.bounds[k][1])
        });
        let mut gap = self.gap_of_boxes(&gaps);
        if let Some((direction, lowest)) = self.plane.get() {
            let reach: f64 = (0..3)
                .map(|j| (0..3).map(|k| linear[k][j] * direction[k]).sum::<f64>().abs() * half_extents[j])
                .sum::<f64>()
                * scale;
            gap = gap.max(lowest - (dot(&direction, &at) + reach));
        }
        (below(gap) - 8.0 * self.error) * self.pair.unit
    }

    /// Returns the distance of the set from a box that has these gaps to the core's box along the
    /// axes. It is negative if the boxes overlap.
    fn gap_of_boxes(&self, gaps: &[f64; 3]) -> f64 {
        let largest = gaps[0].max(gaps[1]).max(gaps[2]);
        let apart = if largest > 0.0 { length(&gaps.map(|gap| gap.max(0.0))) } else { largest };
        below(apart) - self.radius
    }

    /// Returns the center of the set's box, in the common frame.
    pub(super) fn center(&self) -> [f64; 3] {
        self.bounds.map(|[least, greatest]| 0.5 * least + 0.5 * greatest)
    }

    /// Returns the two sets in their common frame.
    pub(super) fn pair(&self) -> &'p Pair<'p> {
        self.pair
    }

    /// Returns the radius of the set, in the common unit.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns a lower bound on the distance, in world units, between the set and the hull of some
    /// points of the common frame. `ends` are their least and greatest coordinates on each axis.
    pub(super) fn gap_of_points(&self, points: &[[f64; 3]], ends: &[[f64; 2]; 3]) -> f64 {
        let gap = |k: usize| f64::max(self.bounds[k][0] - ends[k][1], ends[k][0] - self.bounds[k][1]);
        let mut gap = self.gap_of_boxes(&[gap(0), gap(1), gap(2)]);
        if let Some((direction, lowest)) = self.plane.get() {
            let height = points.iter().fold(f64::NEG_INFINITY, |height, point| height.max(dot(&direction, point)));
            gap = gap.max(lowest - height);
        }
        (below(gap) - 8.0 * self.error) * self.pair.unit
    }
}

/// Returns the least and the greatest coordinate of three points on each axis.
#[inline]
pub(super) fn ends_of([p, q, r]: &[[f64; 3]; 3]) -> [[f64; 2]; 3] {
    let ends = |k: usize| [p[k].min(q[k]).min(r[k]), p[k].max(q[k]).max(r[k])];
    [ends(0), ends(1), ends(2)]
}

/// A query about the faces near a set.
trait Search {
    fn cut(&self) -> f64;

    /// Processes a face. May return a direction from the mesh to the set along which other faces
    /// may be proved far.
    fn visit(&mut self, face: u32, corners: &[[f64; 3]; 3]) -> ControlFlow<(), Option<[f64; 3]>>;
}

struct Bounded<'p, 's, S, F> {
    mesh: &'p F,
    beside: Beside<'p>,
    search: &'s mut S,
}

impl<S: Search, F: Faces> FaceSearch for Bounded<'_, '_, S, F> {
    fn bound(&self, center: &[f64; 3], half_extents: &[f64; 3]) -> f64 {
        self.beside.bound(center, half_extents)
    }

    fn cut(&self) -> f64 {
        self.search.cut()
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let corners = self.mesh.corners(face);
        let points = corners.map(|corner| self.beside.pair.a.spot(corner).point);
        if self.beside.gap_of_points(&points, &ends_of(&points)) > self.search.cut() {
            return Continue(());
        }
        match self.search.visit(face, &corners) {
            Break(()) => Break(()),
            Continue(None) => Continue(()),
            Continue(Some(direction)) => {
                self.beside.look_along(direction);
                Continue(())
            }
        }
    }
}

/// A search that keeps all faces of boxes within a reach.
struct Collecting {
    reach: f64,
    faces: Vec<u32>,
}

impl Search for Collecting {
    fn cut(&self) -> f64 {
        self.reach
    }

    fn visit(&mut self, face: u32, _: &[[f64; 3]; 3]) -> ControlFlow<(), Option<[f64; 3]>> {
        self.faces.push(face);
        Continue(None)
    }
}

struct Nearness<'a, 'q, F> {
    surface: &'q Surface<'a, F>,
    shape: &'q Swept<'q>,
    clearance: f64,
    answer: Proximity,
    known: Coherence,
}

impl<F: Faces> Search for Nearness<'_, '_, F> {
    fn cut(&self) -> f64 {
        self.clearance
    }

    fn visit(&mut self, _: u32, corners: &[[f64; 3]; 3]) -> ControlFlow<(), Option<[f64; 3]>> {
        match nearness_from(&self.surface.face(corners), self.shape, self.clearance, &mut self.known) {
            Proximity::Intersects => {
                self.answer = Proximity::Intersects;
                return Break(());
            }
            Proximity::Undecided => self.answer = Proximity::Undecided,
            Proximity::Apart => {}
        }
        Continue(None)
    }
}

struct Separating<'a, 'q, F> {
    surface: &'q Surface<'a, F>,
    shape: &'q Swept<'q>,
    best: Separation,
    face: u32,
    direction: Option<[f64; 3]>,
    known: Coherence,
}

impl<F: Faces> Search for Separating<'_, '_, F> {
    fn cut(&self) -> f64 {
        self.best.upper
    }

    fn visit(&mut self, face: u32, corners: &[[f64; 3]; 3]) -> ControlFlow<(), Option<[f64; 3]>> {
        let face_set = self.surface.face(corners);
        let Some(found) = separation_within(&face_set, self.shape, self.best.upper, &mut self.known) else {
            return Continue(None);
        };
        if found.proximity == Proximity::Intersects {
            // No face is nearer than one with a common point.
            self.best = found;
            return Break(());
        }
        let lower = self.best.lower.min(found.lower);
        let is_better = found.upper < self.best.upper || (found.upper == self.best.upper && face < self.face);
        let was_undecided = self.best.proximity == Proximity::Undecided || found.proximity == Proximity::Undecided;
        if is_better {
            (self.best, self.face) = (found, face);
            let between = sub(&found.points[1], &found.points[0]);
            self.direction = (between != [0.0; 3]).then_some(between);
        }
        self.best.lower = lower;
        if was_undecided && self.best.proximity == Proximity::Apart {
            self.best.proximity = Proximity::Undecided;
        }
        Continue(self.direction.filter(|_| is_better))
    }
}
