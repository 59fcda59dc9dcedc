//! The results of a search so far: the best pair of faces, and the distance beyond which pairs are
//! skipped.

use std::ops::ControlFlow::{self, Break, Continue};

use super::scene::{Nearest, Scene, Valued};
use crate::primitive::{separation, triangle_triangle};

/// Maximum number of pairs of faces whose value is computed. After that, a pair counts only if it
/// is nearer than the best pair by more than the error of values. The returned interval is still
/// proved, but it is wider. Only meshes with millions of equally near pairs reach this limit, such
/// as flat meshes far apart. A larger limit costs more time on such meshes: a value takes about a
/// quarter of a microsecond.
pub(super) const MAX_VALUES: usize = 1 << 24;

/// Maximum number of deferred pairs of faces. Further pairs get their values at once. A larger
/// number takes more memory, and a smaller one computes more values.
const MAX_DEFERRED: usize = 1 << 12;

/// Number of vertices that the test by planes reads in the time of one value, about a quarter of a
/// microsecond. Planes are tried once the pairs that tie have cost as much time as reading all
/// vertices.
const VERTICES_PER_VALUE: usize = 64;

/// Number of pairs that are deferred in the time of one value.
const DEFERRED_PER_VALUE: usize = 4;

/// Minimum number of ties before planes are tried. The neighbors of the two nearest vertices tie as
/// well, so a smaller number would try planes without success on ordinary meshes.
const MIN_TIES: usize = 256;

/// Number of ties per face of both meshes from which copies of faces are skipped. Finding them
/// takes about as long as two values per face.
const TIES_PER_FACE: usize = 4;

/// Maximum ratio of the diagonal of the whole scene to the extent of the smaller mesh for which
/// planes are tried in a query for the distance. Beyond it the error of values is so large that
/// many faces of the smaller mesh seem to tie.
const MAX_SCENE_RATIO: f64 = 64.0;

/// The results of a search so far.
pub(super) struct Answer {
    /// The best pair so far.
    pub(super) best: Option<Valued>,
    /// Whether any two processed faces may have a common point. `None` if the query does not need
    /// to know.
    pub(super) may_intersect: Option<bool>,
    /// A pair of faces that is proved to be within the clearance, if one was found.
    pub(super) kept: Option<[u32; 2]>,
    /// Distance in metric units beyond which pairs of faces are skipped.
    pub(super) cut: f64,
    /// `cut` in single precision, rounded up.
    pub(super) limit: f32,
    /// `cut` as the number that bounds of nodes are compared with (see
    /// [`Bounds::limit`](super::bounds::Bounds::limit)).
    pub(super) node_limit: f32,
    /// Number of values that may still be computed, out of [`MAX_VALUES`].
    pub(super) values_left: usize,
    /// Number of processed pairs of faces that tie with the best pair. In a query with a clearance,
    /// number of processed pairs that are farther apart than the clearance.
    ties: usize,
    /// Whether copies of a face are skipped, all but the first. Each tie then counts for all
    /// copies.
    pub(super) skips_copies: bool,
    /// Number of ties from which copies are skipped.
    many_ties: usize,
    /// Number of ties at which planes are tried for the first time.
    first_trial: usize,
    /// Number of ties at which planes are tried next.
    next_trial: usize,
    /// Interval of the distance of the meshes in world units, if planes prove it.
    pub(super) proved: Option<[f64; 2]>,
    /// Deferred pairs, each with a lower bound of its distance in metric units. They can hardly be
    /// nearer than the best pair. Neighboring faces share the nearest edge or corner, so most
    /// deferred pairs never need a value.
    deferred: Vec<([u32; 2], f32)>,
}

impl Answer {
    /// Creates an answer without a pair. Pairs farther apart than `farthest`, in metric units, are
    /// skipped.
    pub(super) fn new(scene: &Scene<'_>, farthest: f64) -> Self {
        let first_trial = if scene.clearance < f64::INFINITY
            || scene.metric.diagonal <= MAX_SCENE_RATIO * scene.metric.smaller_extent
        {
            MIN_TIES.max(scene.vertex_count() / VERTICES_PER_VALUE)
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
            skips_copies: false,
            many_ties: TIES_PER_FACE * scene.face_count(),
            first_trial,
            next_trial: first_trial,
            proved: None,
            deferred: Vec::new(),
        };
        answer.cut(scene, farthest);
        answer
    }

    /// Processes a pair of faces whose distance is at least `lower`, or defers it if it can hardly
    /// be nearer than the best pair. `slack` is the error bound of `lower`. Both are in metric
    /// units.
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

    /// Tries planes if the ties have cost enough time. Breaks if the planes answer the query.
    #[inline(always)]
    fn try_planes_in_time(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        if self.ties + self.deferred.len() / DEFERRED_PER_VALUE < self.next_trial {
            return Continue(());
        }
        self.next_trial = self.next_trial.saturating_mul(8);
        self.try_planes(scene)
    }

    /// Tries to prove the answer by the planes on which the best pair rests. Breaks if they answer
    /// the query.
    #[cold]
    fn try_planes(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        let Some(best) = &self.best else { return Continue(()) };
        if scene.clearance < f64::INFINITY {
            return if scene.are_farther_by_planes(best) { Break(()) } else { Continue(()) };
        }
        self.proved = scene.distance_by_planes(best);
        if self.proved.is_some() { Break(()) } else { Continue(()) }
    }

    /// Processes the deferred pairs whose bounds are still within the limit.
    pub(super) fn process_deferred(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        for (faces, lower) in std::mem::take(&mut self.deferred) {
            if lower <= self.limit {
                self.process(scene, faces)?;
            }
        }
        // The best pair is tried at the end, whichever pairs came first, so the result does not
        // depend on the order of the pairs.
        let have_tied = self.ties >= self.first_trial && scene.clearance == f64::INFINITY;
        if have_tied { self.try_planes(scene) } else { Continue(()) }
    }

    /// Returns the nearest points so far, in the world frame, or `None` if no pair was processed.
    /// If the search was stopped early, the lower bound is zero.
    pub(super) fn nearest(&mut self, scene: &Scene<'_>, is_stopped: bool) -> Option<Nearest> {
        if is_stopped {
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

    /// Counts a pair that ties, together with all copies that are skipped.
    fn count_tie(&mut self, scene: &Scene<'_>, [a, b]: [u32; 2]) {
        let copies = || scene.meshes[0].copies().count(a).max(1) * scene.meshes[1].copies().count(b).max(1);
        self.ties += if self.skips_copies { copies() } else { 1 };
        self.skips_copies |= self.ties >= self.many_ties;
    }

    /// Sets the distance beyond which pairs are skipped, in metric units.
    fn cut(&mut self, scene: &Scene<'_>, metric: f64) {
        self.cut = metric;
        self.limit = (metric as f32).next_up();
        self.node_limit = scene.bounds.limit(metric);
    }

    /// Computes the value of a pair of faces, and keeps the pair if it is the best so far. Breaks
    /// if the query is answered.
    #[inline(never)]
    pub(super) fn process(&mut self, scene: &Scene<'_>, faces: [u32; 2]) -> ControlFlow<()> {
        let corners = scene.corners(faces);
        let error = scene.metric.error;
        let witness = triangle_triangle(&corners[0], &corners[1]);
        // Faces that do not intersect have a positive distance, even if rounding makes it zero.
        let value = witness.squared.sqrt().max(f64::MIN_POSITIVE);
        let are_separated = || separation(&corners[0], &corners[1], &witness) > error;
        if let Some(may_intersect) = &mut self.may_intersect {
            *may_intersect |= !are_separated();
        }
        if scene.clearance < f64::INFINITY {
            let valued = Valued { value, faces, witness };
            self.best = Some(self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued));
            // If the value does not decide, or if the triangles may cross, the pair is compared
            // exactly.
            let is_undecided = !(are_separated() && scene.lower(value) > scene.clearance);
            if is_undecided && (scene.upper(value) <= scene.clearance || scene.within(faces, &witness)) {
                self.kept = Some(faces);
                return Break(());
            }
            self.count_tie(scene, faces);
            return self.try_planes_in_time(scene);
        }
        let valued = Valued { value, faces, witness };
        self.values_left = self.values_left.saturating_sub(1);
        let is_far_better = self.best.is_none_or(|best| value < best.value - 2.0 * error);
        let is_tie = self.best.is_some_and(|best| value <= best.value + 2.0 * error);
        if is_far_better {
            self.ties = 0;
        }
        if is_tie || is_far_better {
            self.count_tie(scene, faces);
        }
        if self.best.is_none_or(|best| valued.precedes(&best)) || self.values_left == 0 {
            let best = self.best.filter(|best| best.precedes(&valued)).unwrap_or(valued);
            self.best = Some(best);
            let doubt = if self.values_left == 0 { -4.0 } else { 2.0 };
            self.cut(scene, (best.value + doubt * error).max(2.0 * error));
        }
        self.try_planes_in_time(scene)
    }
}
