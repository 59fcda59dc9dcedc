//! What a search knows so far: the best pair of faces, and the distance beyond which nothing matters.

use std::ops::ControlFlow::{self, Break, Continue};

use super::scene::{Scene, Valued};
use crate::primitive::{separation, triangle_triangle};

/// How many pairs of faces get a value at most, before only such are looked for as are nearer by more than what values may
/// be off by. Only meshes of which millions of pairs are equally near reach it, such as flat ones far apart; the
/// interval stays proved. A value takes about a microsecond.
pub(super) const MAX_VALUES: usize = 1 << 24;

/// How many pairs of faces are put off at most; beyond that they get their values at once.
const MAX_DEFERRED: usize = 1 << 12;

/// After this many pairs of faces that bounds could not tell from the clearance, planes are tried on the whole meshes. That
/// reads every face once, and takes about as long as so many pairs of two meshes of a thousand faces.
const TIES: usize = 64;

/// What is known so far.
pub(super) struct Answer {
    pub(super) best: Option<Valued>,
    /// Whether faces that were met may have a common point, where that is asked.
    pub(super) may_intersect: Option<bool>,
    /// Faces that are within the clearance.
    pub(super) kept: Option<[u32; 2]>,
    /// What is farther than this, in metric units, does not matter; the same in single precision; and for nodes.
    pub(super) cut: f64,
    pub(super) limit: f32,
    pub(super) node_limit: f32,
    pub(super) values_left: usize,
    /// Pairs of faces that were found to be farther apart than the clearance.
    beyond: usize,
    /// Pairs that tie with the best at most, and a lower bound of each: neighbours share the edge or corner that is nearest,
    /// and of those that were the best for a while nobody has to know which was the first.
    deferred: Vec<([u32; 2], f32)>,
}

impl Answer {
    /// Nothing is known but that what is farther than this does not matter.
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

    /// Meets a pair, of which `lower` says how near it is at least; later, where that is hardly nearer than the best.
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

    /// Meets what was put off and still matters.
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

    /// Gives a pair its value, and keeps it where it is better; breaks off where there is nothing more to know.
    #[inline(never)]
    pub(super) fn process(&mut self, scene: &Scene<'_>, faces: [u32; 2]) -> ControlFlow<()> {
        let corners = scene.corners(faces);
        let error = scene.metric.error;
        let witness = triangle_triangle(&corners[0], &corners[1]);
        // Faces that do not meet are apart, though rounding may bring them together.
        let value = witness.squared.sqrt().max(f64::MIN_POSITIVE);
        let are_separated = || separation(&corners[0], &corners[1], &witness) > error;
        if let Some(may_intersect) = &mut self.may_intersect {
            *may_intersect |= !are_separated();
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
            self.beyond += 1;
            // Where many faces are hardly farther apart than the clearance, the meshes may face each other with flat sides.
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
