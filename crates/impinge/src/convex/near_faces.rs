//! The faces of a mesh that a convex set may touch, and their order by the distance from its
//! center.
//!
//! Pieces of the surface start with the nearest faces and soon hold all others. So the distance of
//! a face is computed only if no piece has the face by then. Until then the box of the face bounds
//! it.
//!
//! The tests are at the end, and in `tests/it/shapes/mesh_contacts.rs`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow::{self, Continue};

use super::beside::{Beside, ends_of};
use super::interval::below;
use super::piece::{OrientedFace, Seeds};
use super::posed::{Pair, to_unit_length};
use super::surface::Surface;
use crate::math::vec3::{Vector, cross, dot, length, sub};
use crate::mesh::FaceSearch;
use crate::primitive::closest_on_triangle;

/// Difference of two distances, in the common unit, that count as equal: 2^-36.
const SAME_DISTANCE: f64 = 1.0 / (1_u64 << 36) as f64;

/// Bound on the rounding of two distances, in the common unit: 2^-40.
const ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

/// A face near a set.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearFace {
    pub(super) face: u32,
    /// Lower bound of the distance of the face from the center of the set, in the common unit.
    least: f64,
}

impl Beside<'_> {
    /// Returns all faces that are within `margin` of the set, in world units, and maybe others that
    /// are near.
    pub(super) fn near_faces(&self, surface: &Surface<'_>, margin: f64) -> Vec<NearFace> {
        let heights = ([0.0; 3], Heights::default());
        let mut search = Touching { surface, beside: self, center: self.center(), margin, heights, found: Vec::new() };
        surface.mesh.search(&mut search);
        search.found
    }
}

/// Search for the faces that may touch a set.
struct Touching<'q> {
    surface: &'q Surface<'q>,
    beside: &'q Beside<'q>,
    center: Vector,
    margin: f64,
    /// A direction, and the heights of the set along it.
    heights: (Vector, Heights),
    found: Vec<NearFace>,
}

impl FaceSearch for Touching<'_> {
    fn bound(&self, center: &Vector, half_extents: &Vector) -> f64 {
        self.beside.bound(center, half_extents, self.margin)
    }

    fn cut(&self) -> f64 {
        self.margin
    }

    fn visit(&mut self, face: u32) -> ControlFlow<()> {
        let pair = self.beside.pair();
        let corners = corners_of(self.surface, pair, face);
        let ends = ends_of(&corners);
        if self.beside.gap_of_points(&corners, &ends, self.margin) > self.margin {
            return Continue(());
        }
        if let Some(normal) = normal_of(self.surface, &corners) {
            let Heights { least, greatest, error } = self.set_along(normal);
            let level = dot(&normal, &corners[0]);
            let less = (greatest - level).min(level - least);
            if (below(less) + 16.0 * error) * pair.unit < -self.margin {
                return Continue(());
            }
        }
        let beyond = |k: usize| (ends[k][0] - self.center[k]).max(self.center[k] - ends[k][1]).max(0.0);
        let least = length(&[beyond(0), beyond(1), beyond(2)]) * (1.0 - ROUNDING) - ROUNDING;
        self.found.push(NearFace { face, least });
        Continue(())
    }
}

impl Touching<'_> {
    /// Returns the heights of the set along a direction. Neighboring faces often have the same
    /// normal.
    #[inline]
    fn set_along(&mut self, direction: Vector) -> Heights {
        if self.heights.0 != direction {
            self.heights = (direction, Heights::of(self.beside, direction));
        }
        self.heights.1
    }
}

/// Heights of a set along a direction.
#[derive(Clone, Copy, Default)]
struct Heights {
    least: f64,
    greatest: f64,
    /// Bound on the error of a height.
    error: f64,
}

impl Heights {
    fn of(beside: &Beside<'_>, direction: Vector) -> Self {
        let (pair, radius) = (beside.pair(), beside.radius());
        let height = |direction: Vector| dot(&direction, &pair.b.support(direction).point) + radius;
        let [least, greatest] = [-height(direction.map(|x| -x)), height(direction)];
        Self { least, greatest, error: pair.height_error(direction) }
    }
}

/// Returns the corners of a face in the common frame.
#[inline]
fn corners_of(surface: &Surface<'_>, pair: &Pair<'_>, face: u32) -> [Vector; 3] {
    let [p, q, r] = surface.mesh.corners(face);
    [pair.a.spot(p).point, pair.a.spot(q).point, pair.a.spot(r).point]
}

/// Returns the normal of a face with these corners, of length 1, or `None` if the face has no area.
#[inline]
fn normal_of(surface: &Surface<'_>, corners: &[Vector; 3]) -> Option<Vector> {
    let area = cross(&sub(&corners[1], &corners[0]), &sub(&corners[2], &corners[0]));
    let turn = if surface.pose.mirrors() { -1.0 } else { 1.0 };
    (area != [0.0; 3]).then(|| to_unit_length([turn * area[0], turn * area[1], turn * area[2]]))
}

/// Faces near a set, the nearest to the center of the set first.
///
/// Of faces at one distance, such as those around the nearest corner or edge, the one whose plane
/// is farthest from the center tells its side (Ericson, *Real-Time Collision Detection*, 5.1.5),
/// and comes first. Each face is oriented as its corners are ordered if the mesh is solid, or else
/// so that the center is outside. That is right for the nearest face, and `pieces` carries it over
/// to the neighbors.
pub(super) struct NearestFirst<'q> {
    surface: &'q Surface<'q>,
    pair: &'q Pair<'q>,
    center: Vector,
    queue: BinaryHeap<Queued>,
    measured: Vec<Measured>,
    /// Faces at one distance; the last is next.
    run: Vec<Measured>,
}

/// A face in the queue. The least one compares greatest.
struct Queued {
    /// The distance, or a lower bound of it if the face is not measured.
    least: f64,
    face: u32,
    /// Place in the list of measured faces.
    measured: Option<u32>,
}

#[derive(Clone, Copy)]
struct Measured {
    face: OrientedFace,
    /// Distance of the face from the center of the set, in the common unit.
    away: f64,
    /// Distance of the face's plane from the center.
    height: f64,
}

impl<'q> NearestFirst<'q> {
    pub(super) fn new(surface: &'q Surface<'q>, beside: &'q Beside<'q>, faces: Vec<NearFace>) -> Self {
        let queued = |NearFace { face, least }| Queued { least, face, measured: None };
        let queue = BinaryHeap::from(faces.into_iter().map(queued).collect::<Vec<_>>());
        Self { surface, pair: beside.pair(), center: beside.center(), queue, measured: Vec::new(), run: Vec::new() }
    }

    fn measure(&self, face: u32) -> Measured {
        let corners = corners_of(self.surface, self.pair, face);
        let normal = normal_of(self.surface, &corners).unwrap_or_else(|| to_unit_length([0.0; 3]));
        let height = dot(&normal, &sub(&self.center, &corners[0]));
        let face = OrientedFace { face, is_flipped: !self.surface.is_solid && height < 0.0 };
        Measured { face, away: closest_on_triangle(&self.center, &corners).distance, height: height.abs() }
    }

    /// Collects the nearest faces of the queue that are not taken.
    fn collect_run(&mut self, is_taken: &dyn Fn(u32) -> bool) {
        let mut end = f64::INFINITY;
        while let Some(queued) = self.queue.peek()
            && (queued.least <= end || queued.least.is_nan())
            && let Some(Queued { face, measured, .. }) = self.queue.pop()
        {
            if is_taken(face) {
                continue;
            }
            if let Some(at) = measured {
                let found = self.measured[at as usize];
                end = end.min(found.away + SAME_DISTANCE);
                self.run.push(found);
            } else {
                let found = self.measure(face);
                self.queue.push(Queued { least: found.away, face, measured: Some(self.measured.len() as u32) });
                self.measured.push(found);
            }
        }
        let order = |x: &Measured, y: &Measured| x.away.total_cmp(&y.away).then(x.face.face.cmp(&y.face.face));
        self.run.sort_unstable_by(|x, y| x.height.total_cmp(&y.height).then_with(|| order(y, x)));
    }
}

impl Seeds for NearestFirst<'_> {
    fn next(&mut self, is_taken: &dyn Fn(u32) -> bool) -> Option<OrientedFace> {
        loop {
            while let Some(Measured { face, .. }) = self.run.pop() {
                if !is_taken(face.face) {
                    return Some(face);
                }
            }
            self.collect_run(is_taken);
            if self.run.is_empty() {
                return None;
            }
        }
    }
}

impl Ord for Queued {
    fn cmp(&self, other: &Self) -> Ordering {
        other.least.total_cmp(&self.least).then(other.face.cmp(&self.face))
    }
}

impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Queued {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Queued {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::posed::{Core, Swept};
    use crate::convex::surface::corners_of_box;
    use crate::math::Pose;
    use crate::mesh::Mesh;
    use impinge_testkit::generate::{Rng, solids};

    /// Returns all faces in order: sorted by distance, and runs of equal distances by the height of
    /// their planes.
    fn sorted(nearest: &NearestFirst<'_>, faces: &[u32]) -> Vec<OrientedFace> {
        let mut all: Vec<Measured> = faces.iter().map(|&face| nearest.measure(face)).collect();
        all.sort_by(|x, y| x.away.total_cmp(&y.away).then(x.face.face.cmp(&y.face.face)));
        let mut start = 0;
        while start < all.len() {
            let run = all[start..].iter().take_while(|near| near.away <= all[start].away + SAME_DISTANCE).count();
            all[start..start + run].sort_by(|x, y| y.height.total_cmp(&x.height));
            start += run;
        }
        all.into_iter().map(|near| near.face).collect()
    }

    /// Triangles with corners on a small grid share planes, edges and corners, and many are at one
    /// distance from the set.
    #[test]
    fn faces_come_in_the_order_of_sorting_all() {
        let mut rng = Rng::new(63);
        let (mut ties, mut flipped) = (0, 0);
        for round in 0..200 {
            let soup = solids::grid_soup(&mut rng, 60, 3, 4);
            let mesh = Mesh::new(soup.vertices, soup.faces).expect("a mesh");
            let pose = Pose::from_translation([0.0, 0.0, f64::from(round % 3)]).expect("a pose");
            let surface = Surface { mesh: &mesh, pose: &pose, is_solid: round % 5 == 0 };
            let bounds = mesh.local_bounds().map(corners_of_box).expect("faces");
            let center = [0; 3].map(|_| rng.integer(-2, 5) as f64);
            let corners = corners_of_box([center.map(|x| x - 1.0), center.map(|x| x + 1.0)]);
            let swept = |corners, pose| Swept { core: Core::Points(corners), pose, radius: [0.0; 2] };
            let (all, set) = (swept(&bounds, &pose), swept(&corners, &Pose::IDENTITY));
            let pair = Pair::new(&all, &set);
            let beside = Beside::new(&pair, 0.0);
            let near = beside.near_faces(&surface, 1.0);
            let faces: Vec<u32> = near.iter().map(|near| near.face).collect();
            let mut nearest = NearestFirst::new(&surface, &beside, near.clone());
            for NearFace { face, least } in near {
                let away = nearest.measure(face).away;
                assert!(least <= away, "{least} {away}");
                ties += faces.iter().filter(|&&other| other < face && nearest.measure(other).away == away).count();
            }
            let expected = sorted(&nearest, &faces);
            let found: Vec<OrientedFace> = std::iter::from_fn(|| nearest.next(&|_| false)).collect();
            flipped += found.iter().filter(|face| face.is_flipped).count();
            assert_eq!(found, expected);
        }
        assert!(ties > 100 && flipped > 100, "{ties} {flipped}");
    }

    #[test]
    fn taken_faces_do_not_come() {
        let grid = solids::plane_grid(4, 4);
        let mesh = Mesh::new(grid.vertices, grid.faces).expect("a mesh");
        let surface = Surface { mesh: &mesh, pose: &Pose::IDENTITY, is_solid: false };
        let bounds = mesh.local_bounds().map(corners_of_box).expect("faces");
        let all = Swept { core: Core::Points(&bounds), pose: &Pose::IDENTITY, radius: [0.0; 2] };
        let pair = Pair::new(&all, &all);
        let beside = Beside::new(&pair, 0.0);
        let mut nearest = NearestFirst::new(&surface, &beside, beside.near_faces(&surface, 0.0));
        let found: Vec<u32> =
            std::iter::from_fn(|| nearest.next(&|face| face % 2 == 0)).map(|seed| seed.face).collect();
        assert!(found.len() == 16 && found.iter().all(|face| face % 2 == 1), "{found:?}");
        assert!(nearest.measured.len() == 16, "only faces that come are measured");
    }
}
