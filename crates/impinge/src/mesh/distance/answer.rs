//! What does not change during a search, and what is known so far.

use std::ops::ControlFlow::{self, Break, Continue};

use super::Nearest;
use super::bounds::Bounds;
use crate::exact::{NearParts, Placement, Supports, parts_within};
use crate::mesh::distance::metric::Metric;
use crate::mesh::{Mesh, Placed};
use crate::primitive::{
    ClosestPoints, Vector, Witness, closest_on_segments, closest_on_triangle, common_point, separation, sub,
    triangle_triangle,
};

/// How many pairs of faces get a value at most, before only such are looked for as are nearer by more than what values may
/// be off by. Only meshes of which millions of pairs are equally near reach it, such as flat ones far apart; the
/// interval stays proved. A value takes about a microsecond.
pub(super) const MOST_VALUES: usize = 1 << 24;

/// How many pairs of faces are put off at most; beyond that they get their values at once.
const MOST_PUT_OFF: usize = 1 << 12;

/// After this many pairs of faces that bounds could not tell from the clearance, planes are tried on the whole meshes. That
/// reads every face once, and takes about as long as so many pairs of two meshes of a thousand faces.
const TIES: usize = 64;

/// A pair of faces with its value, in metric units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Valued {
    pub(super) value: f64,
    pub(super) faces: [u32; 2],
    pub(super) witness: Witness,
}

impl Valued {
    pub(super) fn precedes(&self, other: &Self) -> bool {
        self.value < other.value || (self.value == other.value && self.faces < other.faces)
    }
}

/// What does not change during a search.
pub(super) struct Scene<'a> {
    pub(super) meshes: [&'a Mesh; 2],
    pub(super) metric: Metric,
    pub(super) placement: Placement,
    pub(super) bounds: Bounds,
    /// The clearance that is asked for, in world units; infinite where the nearest points are.
    pub(super) clearance: f64,
}

/// What is known so far.
pub(super) struct Answer {
    pub(super) best: Option<Valued>,
    /// Whether faces that were met may have a common point, where that is asked.
    pub(super) may_meet: Option<bool>,
    /// Faces that are within the clearance.
    pub(super) kept: Option<[u32; 2]>,
    /// What is farther than this, in metric units, does not matter; the same in single precision; and for nodes.
    pub(super) cut: f64,
    pub(super) limit: f32,
    pub(super) node_limit: f32,
    pub(super) values_left: usize,
    /// Pairs of faces that were found to be farther apart than the clearance.
    met: usize,
    /// Pairs that tie with the best at most, and a lower bound of each: neighbours share the edge or corner that is nearest,
    /// and of those that were the best for a while nobody has to know which was the first.
    put_off: Vec<([u32; 2], f32)>,
}

impl Answer {
    /// Nothing is known but that what is farther than this does not matter.
    pub(super) fn new(scene: &Scene<'_>, farthest: f64) -> Self {
        let mut answer = Self {
            best: None,
            may_meet: None,
            kept: None,
            cut: f64::INFINITY,
            limit: f32::INFINITY,
            node_limit: f32::INFINITY,
            values_left: MOST_VALUES,
            met: 0,
            put_off: Vec::new(),
        };
        answer.cut(scene, farthest);
        answer
    }

    /// Meets a pair, of which `lower` says how near it is at least; later, where that is hardly nearer than the best.
    #[inline(always)]
    pub(super) fn meet_or_put_off(
        &mut self,
        scene: &Scene<'_>,
        faces: [u32; 2],
        lower: f32,
        slack: f32,
    ) -> ControlFlow<()> {
        let hardly = |best: &Valued| f64::from(lower) + 2.0 * f64::from(slack) >= best.value;
        if scene.clearance == f64::INFINITY
            && self.put_off.len() < MOST_PUT_OFF
            && self.best.as_ref().is_some_and(hardly)
        {
            self.put_off.push((faces, lower));
            return Continue(());
        }
        self.meet(scene, faces)
    }

    /// Meets what was put off and still matters.
    pub(super) fn meet_put_off(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        for (faces, lower) in std::mem::take(&mut self.put_off) {
            if lower <= self.limit {
                self.meet(scene, faces)?;
            }
        }
        Continue(())
    }

    fn cut(&mut self, scene: &Scene<'_>, metric: f64) {
        self.cut = metric;
        self.limit = (metric as f32).next_up();
        self.node_limit = scene.bounds.limit(metric);
    }

    /// Gives a pair its value, and keeps it where it is better; breaks off where there is nothing more to know.
    #[inline(never)]
    pub(super) fn meet(&mut self, scene: &Scene<'_>, faces: [u32; 2]) -> ControlFlow<()> {
        let corners = scene.corners(faces);
        let error = scene.metric.error;
        let witness = triangle_triangle(&corners[0], &corners[1]);
        // Faces that do not meet are apart, though rounding may bring them together.
        let value = witness.squared.sqrt().max(f64::MIN_POSITIVE);
        let are_separated = || separation(&corners[0], &corners[1], &witness) > error;
        if let Some(may_meet) = &mut self.may_meet {
            *may_meet |= !are_separated();
        }
        if scene.clearance < f64::INFINITY {
            let valued = Valued { value, faces, witness };
            self.best = Some(self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued));
            // What the value leaves open is decided exactly, and so is everything about triangles that may cross.
            let is_open = !(are_separated() && scene.lower(value) > scene.clearance);
            if is_open && (scene.upper(value) <= scene.clearance || scene.within(faces, &witness)) {
                self.kept = Some(faces);
                return Break(());
            }
            self.met += 1;
            // Where many faces are hardly farther apart than the clearance, the meshes may face each other with flat sides.
            let proves_all = self.met == TIES
                && self.best.is_some_and(|best| scene.are_farther_by_planes(best.faces, &best.witness));
            return if proves_all { Break(()) } else { Continue(()) };
        }
        let valued = Valued { value, faces, witness };
        self.values_left = self.values_left.saturating_sub(1);
        if self.best.is_none_or(|best| valued.precedes(&best)) || self.values_left == 0 {
            let best = self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued);
            self.best = Some(best);
            let doubt = if self.values_left == 0 { -4.0 } else { 2.0 };
            self.cut(scene, (best.value + doubt * error).max(2.0 * error));
        }
        Continue(())
    }
}

impl Scene<'_> {
    /// Which mesh is the host, and which the guest.
    #[inline(always)]
    pub(super) fn sides(&self) -> [usize; 2] {
        self.bounds.sides.host_guest([0, 1])
    }

    pub(super) fn corners(&self, faces: [u32; 2]) -> [[Vector; 3]; 2] {
        [0, 1].map(|m| self.meshes[m].corners(faces[m]).map(|corner| self.metric.maps[m].apply(corner)))
    }

    /// Reports whether two faces are within the clearance, exactly. Only parts of them whose computed
    /// distance does not settle it are compared exactly.
    fn within(&self, faces: [u32; 2], witness: &Witness) -> bool {
        if self.supports(faces, witness).are_farther_than(
            &self.placement,
            self.meshes[0].corners(faces[0]).into_iter(),
            self.meshes[1].corners(faces[1]).into_iter(),
            self.clearance,
        ) {
            return false;
        }
        let metric = self.corners(faces);
        let may_be_near = |found: ClosestPoints| self.lower(found.distance) <= self.clearance;
        let edge = |m: usize, i: usize| [metric[m][i], metric[m][(i + 1) % 3]];
        let parts = NearParts {
            edges: [0, 1, 2].map(|i| [0, 1, 2].map(|j| may_be_near(closest_on_segments(&edge(0, i), &edge(1, j))))),
            feet: [0, 1].map(|m| metric[m].map(|corner| may_be_near(closest_on_triangle(&corner, &metric[1 - m])))),
        };
        let [a, b] = [0, 1].map(|m| self.meshes[m].corners(faces[m]));
        parts_within(&self.placement, &a, &b, self.clearance, &parts)
    }

    /// Whether planes that two faces rest on, across the line between their nearest points, prove that the whole meshes are
    /// farther apart than the clearance.
    fn are_farther_by_planes(&self, faces: [u32; 2], witness: &Witness) -> bool {
        let corners = |m: usize| {
            let mesh = self.meshes[m];
            (0..mesh.faces().len() as u32).flat_map(move |face| mesh.corners(face))
        };
        self.supports(faces, witness).are_farther_than(&self.placement, corners(0), corners(1), self.clearance)
    }

    fn supports(&self, [a, b]: [u32; 2], witness: &Witness) -> Supports {
        let corners = [self.meshes[0].corners(a), self.meshes[1].corners(b)];
        Supports::of_triangles(&self.placement, &corners[0], &corners[1], sub(&witness.on_b, &witness.on_a))
    }

    /// No less than the distance of triangles of this value, in world units.
    pub(super) fn upper(&self, value: f64) -> f64 {
        ((value * (1.0 + 4.0 * f64::EPSILON) + self.metric.error) / self.metric.scale).next_up()
    }

    /// No more than the distance of any two triangles where none has a smaller value.
    pub(super) fn lower(&self, value: f64) -> f64 {
        ((value * (1.0 - 4.0 * f64::EPSILON) - self.metric.error) / self.metric.scale).next_down().max(0.0)
    }

    /// The answer, of a value that may be above the least one by `doubt`.
    pub(super) fn finish(&self, best: &Valued, doubt: f64) -> Nearest {
        let faces = best.faces;
        let Witness { on_a, on_b, .. } = best.witness;
        let lower = self.lower(best.value - doubt);
        let points = [on_a, on_b].map(|point| self.metric.to_world(point));
        Nearest { lower, upper: self.upper(best.value), points, faces }
    }
}

/// The answer where these faces meet.
pub(super) fn meeting(a: Placed<'_>, b: Placed<'_>, faces: [u32; 2]) -> Nearest {
    let placement = Placement::new(&a.world_from_mesh, &b.world_from_mesh);
    let corners = [a.mesh.corners(faces[0]), b.mesh.corners(faces[1])];
    let common = common_point(&placement, &corners[0], &corners[1]).unwrap_or_else(|| {
        // Parts of one plane: the closed form finds a common point.
        let metric = Metric::new(a, b);
        let [a, b] = [0, 1].map(|m| corners[m].map(|corner| metric.maps[m].apply(corner)));
        metric.to_world(triangle_triangle(&a, &b).on_a)
    });
    Nearest { lower: 0.0, upper: 0.0, points: [common; 2], faces }
}
