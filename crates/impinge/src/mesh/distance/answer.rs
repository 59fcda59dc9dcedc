//! What a search knows so far: the best pair of faces, and the distance beyond which nothing matters.

use std::ops::ControlFlow::{self, Break, Continue};

use super::scene::{Scene, Valued};
use crate::primitive::{separation, triangle_triangle};

/// Maximum number of pairs of faces that get a value. After that only pairs count that are nearer by more than the error of
/// values. Only meshes with millions of equally near pairs reach it, such as flat ones far apart. The interval stays proved. A
/// value takes about a microsecond.
pub(super) const MAX_VALUES: usize = 1 << 24;

/// Maximum number of deferred pairs of faces. Further pairs get their values at once.
const MAX_DEFERRED: usize = 1 << 12;

/// Number of pairs of faces that bounds could not tell from the clearance after which planes are tried on the whole meshes. That
/// reads every face once, and takes about as long as this many pairs of two meshes of a thousand faces.
const TIES: usize = 64;

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
    /// Number of processed pairs of faces that are farther apart than the clearance.
    beyond: usize,
    /// Deferred pairs, each with a lower bound: they can hardly be nearer than the best pair. Neighbors share the edge or corner
    /// that is nearest, and most of them never need a value.
    deferred: Vec<([u32; 2], f32)>,
}

impl Answer {
    /// Creates an answer without a pair, for which nothing farther than `farthest` matters.
    pub(super) fn new(scene: &Scene<'_>, farthest: f64) -> Self {
        let mut answer = Self {
            best: None,
            may_intersect: None,
            kept: None,
            cut: f64::INFINITY,
            limit: f32::INFINITY,
            node_limit: f32::INFINITY,
            values_left: MAX_VALUES,
            beyond: 0,
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
            return Continue(());
        }
        self.process(scene, faces)
    }

    /// Processes the deferred pairs that still matter.
    pub(super) fn process_deferred(&mut self, scene: &Scene<'_>) -> ControlFlow<()> {
        for (faces, lower) in std::mem::take(&mut self.deferred) {
            if lower <= self.limit {
                self.process(scene, faces)?;
            }
        }
        Continue(())
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
            self.beyond += 1;
            // If many faces are hardly farther apart than the clearance, the meshes may have flat sides that face each other.
            let proves_all = self.beyond == TIES
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
