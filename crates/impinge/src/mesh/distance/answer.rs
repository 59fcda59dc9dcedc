//! What a search knows so far: the best pair of faces, and the distance beyond which nothing matters.

use std::ops::ControlFlow::{self, Break, Continue};

use super::scene::{Nearest, Scene, Valued};
use crate::primitive::{separation, triangle_triangle};

/// Maximum number of pairs of faces that get a value. After that only pairs count that are nearer by more than the error of
/// values. Only meshes with millions of equally near pairs reach it, such as flat ones far apart. The interval stays proved. A
/// value takes about a microsecond.
pub(super) const MAX_VALUES: usize = 1 << 24;

/// Maximum number of deferred pairs of faces. Further pairs get their values at once.
const MAX_DEFERRED: usize = 1 << 12;

/// Number of vertices that the planes read in the time of one value, which is about a quarter of a microsecond. Planes are tried once
/// ties have taken as long as reading all vertices takes.
const VERTICES_PER_VALUE: usize = 64;

/// Number of pairs that are deferred in the time of one value.
const DEFERRED_PER_VALUE: usize = 4;

/// Number of ties below which planes are not tried: neighbors of the two nearest vertices tie too.
const LEAST_TIES: usize = 256;

/// Maximum ratio of the size of the whole scene to the smaller mesh for which planes are tried on the distance. Beyond it the error of
/// values is so large that many faces of the smaller mesh seem to tie.
const FARTHEST: f64 = 64.0;

/// Results of a search so far.
pub(super) struct Answer {
    pub(super) best: Option<Valued>,
    /// Whether faces that were processed may have a common point; `None` if the query does not ask it.
    pub(super) may_intersect: Option<bool>,
    /// A pair of faces within the clearance.
    pub(super) kept: Option<[u32; 2]>,
    /// Distance in metric units beyond which nothing matters; the same in single precision, and for nodes.
    pub(super) cut: f64,
    pub(super) limit: f32,
    pub(super) node_limit: f32,
    pub(super) values_left: usize,
    /// Number of processed pairs of faces that tie with the best pair, or that are farther apart than the clearance.
    ties: usize,
    /// Number of ties at which planes are tried for the first time, and next.
    first_trial: usize,
    next_trial: usize,
    /// The distance of the meshes in world units, if planes prove it.
    pub(super) proved: Option<[f64; 2]>,
    /// Deferred pairs, each with a lower bound: they can hardly be nearer than the best pair. Neighbors share the edge or corner
    /// that is nearest, and most of them never need a value.
    deferred: Vec<([u32; 2], f32)>,
}

impl Answer {
    /// Creates an answer without a pair, for which nothing farther than `farthest` matters.
    pub(super) fn new(scene: &Scene<'_>, farthest: f64) -> Self {
        let first_trial =
            if scene.clearance < f64::INFINITY || scene.metric.diagonal <= FARTHEST * scene.metric.smaller_extent {
                LEAST_TIES.max(scene.vertex_count() / VERTICES_PER_VALUE)
            } else {
                usize::MAX
            };
        let mut answer = Self {
            best: None,
            may_intersect: None,
            kept: None,
            cut: f64::INFINITY,
            limit: f32::INFINITY,
            node_limit: f32::INFINITY,
            values_left: MAX_VALUES,
            ties: 0,
            first_trial,
            next_trial: first_trial,
            proved: None,
            deferred: Vec::new(),
        };
        answer.cut(scene, farthest);
        answer
    }

    /// Processes a pair with the lower bound `lower`, or defers it if it can hardly be nearer than the best pair.
    #[inline(always)]
    pub(super) fn process_or_defer(
        &mut self,
        scene: &Scene<'_>,
        faces: [u32; 2],
        lower: f32,
        slack: f32,
    ) -> ControlFlow<()> {
        let hardly = |best: &Valued| f64::from(lower) + 2.0 * f64::from(slack) >= best.value;
        if scene.clearance == f64::INFINITY
            && self.deferred.len() < MAX_DEFERRED
            && self.best.as_ref().is_some_and(hardly)
        {
            self.deferred.push((faces, lower));
            return self.try_planes_in_time(scene);
        }
        self.process(scene, faces)
    }

    /// Tries planes if ties have taken long. Breaks if they answer the query.
    #[inline(always)]
    fn try_planes_in_time(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        if self.ties + self.deferred.len() / DEFERRED_PER_VALUE < self.next_trial {
            return Continue(());
        }
        self.next_trial = self.next_trial.saturating_mul(8);
        self.try_planes(scene)
    }

    /// Tries planes on which the best pair rests.
    #[cold]
    fn try_planes(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        let Some(best) = &self.best else { return Continue(()) };
        if scene.clearance < f64::INFINITY {
            return if scene.are_farther_by_planes(best) { Break(()) } else { Continue(()) };
        }
        self.proved = scene.distance_by_planes(best);
        if self.proved.is_some() { Break(()) } else { Continue(()) }
    }

    /// Processes the deferred pairs that still matter.
    pub(super) fn process_deferred(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        for (faces, lower) in std::mem::take(&mut self.deferred) {
            if lower <= self.limit {
                self.process(scene, faces)?;
            }
        }
        // Whichever pairs came first, the best one is tried: so the result does not depend on their order.
        let have_tied = self.ties >= self.first_trial && scene.clearance == f64::INFINITY;
        if have_tied { self.try_planes(scene) } else { Continue(()) }
    }

    /// Returns the nearest points so far. Nothing is proved of them if the search was interrupted.
    pub(super) fn nearest(&mut self, scene: &Scene<'_>, is_interrupted: bool) -> Option<Nearest> {
        if is_interrupted {
            let _ = self.process(scene, [0, 0]);
            return self.best.map(|best| Nearest { lower: 0.0, ..scene.finish(&best, 0.0) });
        }
        let best = self.best?;
        if let Some([lower, upper]) = self.proved {
            return Some(Nearest { lower, upper, ..scene.finish(&best, 0.0) });
        }
        let doubt = if self.values_left == 0 { 6.0 * scene.metric.error } else { 0.0 };
        Some(scene.finish(&best, doubt))
    }

    fn cut(&mut self, scene: &Scene<'_>, metric: f64) {
        self.cut = metric;
        self.limit = (metric as f32).next_up();
        self.node_limit = scene.bounds.limit(metric);
    }

    /// Computes the value of a pair, and keeps the pair if it is better. Breaks if the query is answered.
    #[inline(never)]
    pub(super) fn process(&mut self, scene: &Scene<'_>, faces: [u32; 2]) -> ControlFlow<()> {
        let corners = scene.corners(faces);
        let error = scene.metric.error;
        let witness = triangle_triangle(&corners[0], &corners[1]);
        // Faces that do not intersect are apart, though rounding may bring them together.
        let value = witness.squared.sqrt().max(f64::MIN_POSITIVE);
        let are_separated = || separation(&corners[0], &corners[1], &witness) > error;
        if let Some(may_intersect) = &mut self.may_intersect {
            *may_intersect |= !are_separated();
        }
        if scene.clearance < f64::INFINITY {
            let valued = Valued { value, faces, witness };
            self.best = Some(self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued));
            // Undecided values are compared exactly, and so are triangles that may cross.
            let is_open = !(are_separated() && scene.lower(value) > scene.clearance);
            if is_open && (scene.upper(value) <= scene.clearance || scene.within(faces, &witness)) {
                self.kept = Some(faces);
                return Break(());
            }
            self.ties += 1;
            return self.try_planes_in_time(scene);
        }
        let valued = Valued { value, faces, witness };
        self.values_left = self.values_left.saturating_sub(1);
        let is_far_better = self.best.is_none_or(|best| value < best.value - 2.0 * error);
        let is_tie = self.best.is_some_and(|best| value <= best.value + 2.0 * error);
        self.ties = if is_far_better { 1 } else { self.ties + usize::from(is_tie) };
        if self.best.is_none_or(|best| valued.precedes(&best)) || self.values_left == 0 {
            let best = self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued);
            self.best = Some(best);
            let doubt = if self.values_left == 0 { -4.0 } else { 2.0 };
            self.cut(scene, (best.value + doubt * error).max(2.0 * error));
        }
        self.try_planes_in_time(scene)
    }
}
