//! A mesh or a height field and a convex set: finds the faces near the set. Each face is a convex
//! set itself.
//!
//! The descent of the mesh's tree is pruned by proved bounds: the gap between a node's box and the
//! set's box, and the gap along the direction from the nearest face so far. Each face gets the
//! answer of `distance` for a triangle. So a boolean about a polytope is exact, and if a face is
//! undecided, the answer may be undecided.
//!
//! The proof is docs/notes/proof.md, L31, and the tests are in `tests/it/shapes/surfaces.rs`.

use std::ops::ControlFlow::{self, Break, Continue};

use super::beside::{Beside, ends_of};
use super::distance::{Coherence, nearness_from, separation_within};
use super::interval::Separation;
use super::posed::{Core, Pair, Swept};
use crate::exact::{Placement, PosedPoint, Spot};
use crate::math::Pose;
use crate::math::vec3::sub;
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
        self.separation_within(shape, f64::INFINITY)
    }

    /// Returns the distance of a convex set, in world units. It is infinite if all faces are proved
    /// to be farther away than `limit`.
    pub(crate) fn separation_within(&self, shape: &Swept<'_>, limit: f64) -> Separation {
        let mut search = Separating {
            surface: self,
            shape,
            limit,
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

    /// Returns a lower bound of the distance of a convex set, in world units. It is at least 7/8 of
    /// the distance, or of `within` if the set is farther away. It is zero if they intersect.
    pub(crate) fn least_distance(&self, shape: &Swept<'_>, within: f64) -> f64 {
        let mut search = Bounding { surface: self, shape, least: within, known: Coherence::default() };
        self.search(shape, &mut search);
        if search.least > 0.0 && self.containment(shape).is_contained() { 0.0 } else { search.least }
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
        self.beside.bound(center, half_extents, self.search.cut())
    }

    fn cut(&self) -> f64 {
        self.search.cut()
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let corners = self.mesh.corners(face);
        let points = corners.map(|corner| self.beside.pair().a.spot(corner).point);
        let cut = self.search.cut();
        if self.beside.gap_of_points(&points, &ends_of(&points), cut) > cut {
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
    limit: f64,
    best: Separation,
    face: u32,
    direction: Option<[f64; 3]>,
    known: Coherence,
}

impl<F: Faces> Search for Separating<'_, '_, F> {
    fn cut(&self) -> f64 {
        self.best.upper.min(self.limit)
    }

    fn visit(&mut self, face: u32, corners: &[[f64; 3]; 3]) -> ControlFlow<(), Option<[f64; 3]>> {
        let face_set = self.surface.face(corners);
        let Some(found) = separation_within(&face_set, self.shape, self.cut(), &mut self.known) else {
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

/// A search for a lower bound of the distance. Faces that are only a little nearer than others are
/// left out.
struct Bounding<'a, 'q, F> {
    surface: &'q Surface<'a, F>,
    shape: &'q Swept<'q>,
    least: f64,
    known: Coherence,
}

impl<F: Faces> Search for Bounding<'_, '_, F> {
    fn cut(&self) -> f64 {
        self.least
    }

    fn visit(&mut self, _: u32, corners: &[[f64; 3]; 3]) -> ControlFlow<(), Option<[f64; 3]>> {
        /// Part of a face's distance within which other faces are looked for.
        const SHARE: f64 = 7.0 / 8.0;
        let face = self.surface.face(corners);
        let Some(found) = separation_within(&face, self.shape, self.least, &mut self.known) else {
            return Continue(None);
        };
        self.least = self.least.min(SHARE * found.lower);
        let between = sub(&found.points[1], &found.points[0]);
        if self.least > 0.0 { Continue((between != [0.0; 3]).then_some(between)) } else { Break(()) }
    }
}
