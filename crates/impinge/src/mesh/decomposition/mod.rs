//! Divides the solid of a closed mesh into convex parts: hulls that together cover the solid, and
//! reach at most a given distance outside it.
//!
//! - `frame` has planes across three axes and the cells that they bound, `cut_point` the rounded
//!   points at which they cut faces.
//! - `piece` is the part of the solid in a cell, and `covering` the hull that is proved to contain
//!   it.
//! - `outside` proves how far a hull reaches outside the solid.
//! - `cut` chooses planes, and `merge` joins parts again.
//!
//! Source: Wei, Liu, Ling, Su, *Approximate convex decomposition for 3D meshes with collision-aware
//! concavity and tree search*, SIGGRAPH 2022: cut the worst part until all are good, then merge.
//! Ours departs in three ways. The concavity of a part is the largest distance of any point of its
//! hull from the solid, also inside, and it is a proved interval instead of an estimate from
//! samples. The hulls are proved to cover the solid. And the cut is the best of one step.
//!
//! Proofs: docs/notes/proof.md, L38 and L39. Guarded by `tests/it/solids/decomposition.rs`.

mod covering;
mod cut;
mod cut_point;
mod frame;
mod merge;
mod outside;
mod piece;

use std::sync::Arc;

use crate::budget::{Budget, Stopped};
use crate::hull::Hull;
use crate::input::{InputError, InputErrorKind};
use crate::math::vec3::Vector;
use crate::mesh::Mesh;
use crate::volume::fit;
use covering::covering_hull;
use frame::Frame;
use merge::{Part, merge};
use outside::{Goal, Outside, Work};
use piece::Piece;

/// Maximum of [`DecompositionOptions::max_parts`], which keeps time and memory bounded.
const MAX_PARTS: usize = 1 << 14;

/// Number of parts that cuts make for each part that the answer may have. Parts of one wall that
/// several cuts divided are merged again; a larger number finds more of them, and takes longer.
const CUTS_PER_PART: usize = 4;

/// Ratio of the bounds of a part that is cut next. Only the order of the cuts depends on it.
const ROUGH_RATIO: f64 = 2.0;

/// Ratio of the bounds of parts that are returned although they are not within the concavity.
const FINE_RATIO: f64 = 1.125;

/// Share of the volume of the axis-aligned box that the smallest box must have, so that planes are
/// across its axes instead of those of the mesh frame.
const TURNED_BOX: f64 = 0.9;

/// Options of [`Mesh::convex_parts`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecompositionOptions {
    /// Maximum distance that a hull may reach outside the solid, in the unit of the mesh. `None` is
    /// 1/40 of the largest extent of the mesh along an axis.
    pub concavity: Option<f64>,
    /// Maximum number of parts, from 1 to 2^14.
    pub max_parts: usize,
}

impl Default for DecompositionOptions {
    fn default() -> Self {
        Self { concavity: None, max_parts: 64 }
    }
}

/// Convex parts that cover a solid ([`Mesh::convex_parts`]).
#[derive(Clone, Debug)]
pub struct ConvexParts {
    parts: Vec<ConvexPart>,
    concavity: f64,
    stopped: Option<Stopped>,
}

/// A convex part of a solid.
#[derive(Clone, Debug)]
pub struct ConvexPart {
    /// The hull, in the frame of the mesh. Its vertices are numbered from zero.
    pub hull: Arc<Hull>,
    /// Lower bound of the largest distance of a point of the hull from the solid, in the unit of
    /// the mesh.
    pub concavity_lower: f64,
    /// Upper bound of the largest distance of a point of the hull from the solid, in the unit of
    /// the mesh.
    pub concavity_upper: f64,
}

impl ConvexParts {
    /// Returns the parts.
    #[must_use]
    pub fn parts(&self) -> &[ConvexPart] {
        &self.parts
    }

    /// Returns the proved bound: no point of a hull is farther than this from the solid, in the
    /// unit of the mesh.
    #[must_use]
    pub fn concavity(&self) -> f64 {
        self.parts.iter().map(|part| part.concavity_upper).fold(0.0, f64::max)
    }

    /// Reports whether the bound is at most the concavity that was asked for. If it is not, there
    /// were too few parts, the budget was spent, or the solid has too many details for the limit of
    /// the work.
    #[must_use]
    pub fn is_within(&self) -> bool {
        self.concavity() <= self.concavity
    }

    /// Returns the limit of the budget that was reached, if there was one.
    #[must_use]
    pub fn stopped(&self) -> Option<Stopped> {
        self.stopped
    }
}

impl Mesh {
    /// Divides the solid of this mesh into convex parts, for programs that need convex shapes.
    /// `Shape::from(&parts)` is their compound.
    ///
    /// - The hulls cover the solid: each of its points is in a hull. The solid is the surface and
    ///   all points whose winding number is above one half in magnitude.
    /// - No point of a hull is farther from the solid than
    ///   [`concavity`](ConvexParts::concavity) of the answer. That is at most the concavity that
    ///   was asked for, unless `max_parts` or the budget ended the work earlier
    ///   ([`is_within`](ConvexParts::is_within)).
    /// - A convex mesh is one part, which is its hull and has the concavity 0.
    ///
    /// Hulls may overlap. The same mesh gives the same parts on any number of threads.
    ///
    /// ```
    /// use impinge::mesh::DecompositionOptions;
    /// use impinge::{Budget, Mesh, Pose, Shape, query};
    ///
    /// // An L of two bars, each 3 long and 1 wide.
    /// let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    /// let corners = [0.0, 1.0].map(|z| outline.map(|[x, y]| [x, y, z])).concat();
    /// let top = [[6, 7, 9], [7, 8, 9], [6, 9, 11], [9, 10, 11]];
    /// let bottom = top.map(|[a, b, c]: [u32; 3]| [a - 6, c - 6, b - 6]);
    /// let sides = (0..6).flat_map(|k| [[k, (k + 1) % 6, k + 6], [(k + 1) % 6, (k + 1) % 6 + 6, k + 6]]);
    /// let faces: Vec<_> = top.into_iter().chain(bottom).chain(sides).collect();
    /// let mesh = Mesh::new(corners, faces)?;
    ///
    /// let options = DecompositionOptions { concavity: Some(0.1), ..Default::default() };
    /// let parts = mesh.convex_parts(options, Budget::unlimited())?;
    /// assert_eq!(parts.parts().len(), 2);
    /// assert!(parts.is_within() && parts.concavity() <= 0.1);
    ///
    /// let bars = Shape::from(&parts).at(Pose::IDENTITY)?;
    /// let corner = Shape::cuboid([0.5; 3])?.at(Pose::from_translation([2.0, 2.0, 0.5])?)?;
    /// assert!((query::distance(&bars, &corner).upper - 0.5).abs() < 0.1);
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Accuracy
    /// Both bounds of each part are proved. Where planes cut faces, hulls are enlarged by about
    /// 2^-44 of their size, so that they contain the exact cut; this is decided exactly. A solid
    /// whose cuts are exact, such as blocks along the axes, is not enlarged.
    ///
    /// # Errors
    /// - [`Empty`](InputErrorKind::Empty) if the mesh has no faces;
    /// - [`Open`](InputErrorKind::Open) if it is not [closed](Self::is_closed);
    /// - [`NonFinite`](InputErrorKind::NonFinite) or [`Negative`](InputErrorKind::Negative) if the
    ///   concavity is not a length;
    /// - [`OutOfRange`](InputErrorKind::OutOfRange) if `max_parts` is zero or above 2^14.
    ///
    /// # Complexity
    /// For each level of cuts, a few dozen hulls of the points of each piece. To prove a bound c on
    /// a hull takes about as many queries of points as boxes of radius c / 2 that cover its
    /// surface, at most 2^15. After 2^21 queries in all, a hull takes at most 2^8, and its bound is
    /// rougher until the end. The budget is checked between two hulls.
    pub fn convex_parts(&self, options: DecompositionOptions, budget: &Budget<'_>) -> Result<ConvexParts, InputError> {
        let concavity = self.validate_decomposition(options)?;
        let whole = Piece::whole(self);
        let corners: Vec<Vector> = whole.vertices(self).collect();
        let hull = Hull::new(&corners)?;
        let hull = Hull::new(hull.positions())?;
        let parts = if self.is_hull(&hull) {
            vec![Part { hull, outside: Outside { lower: 0.0, upper: 0.0 } }]
        } else {
            let (frame, work) = (frame_of(hull.positions()), Work::default());
            let decomposing = Decomposing { mesh: self, frame, concavity, work, budget };
            decomposing.parts(whole, hull, options.max_parts)
        };
        let of = |Part { hull, outside }| ConvexPart {
            hull: Arc::new(hull),
            concavity_lower: outside.lower,
            concavity_upper: outside.upper,
        };
        Ok(ConvexParts { parts: parts.into_iter().map(of).collect(), concavity, stopped: budget.stopped() })
    }

    /// Returns the concavity that is asked for.
    fn validate_decomposition(&self, options: DecompositionOptions) -> Result<f64, InputError> {
        let DecompositionOptions { concavity, max_parts } = options;
        if self.faces().is_empty() {
            return Err(InputError::new(InputErrorKind::Empty { what: "faces" }));
        }
        if let Some(concavity) = concavity {
            if !concavity.is_finite() {
                return Err(InputError::new(InputErrorKind::NonFinite { what: "concavity", index: 0 }));
            }
            if concavity < 0.0 {
                return Err(InputError::new(InputErrorKind::Negative { what: "concavity", index: 0 }));
            }
        }
        if !(1..=MAX_PARTS).contains(&max_parts) {
            let kind = InputErrorKind::OutOfRange { what: "max_parts", index: 0, limit: "2^14, and at least 1" };
            return Err(InputError::new(kind));
        }
        if !self.is_closed() {
            let edges = self.topology().border.len();
            let hint = "a convex part is a part of a solid: close the mesh, or weld it by Mesh::repaired";
            return Err(InputError::new(InputErrorKind::Open { edges }).with_hint(hint));
        }
        let extent = self.0.half_extents.into_iter().fold(0.0, f64::max);
        Ok(concavity.unwrap_or(extent / 20.0))
    }
}

/// Returns the frame of the smallest box of some points, if that is much smaller than the
/// axis-aligned box.
fn frame_of(points: &[Vector]) -> Frame {
    let turned = || {
        let obb = fit::obb(points).ok()?.obb;
        let volume = |half: [f64; 3]| half.into_iter().product::<f64>();
        let extent = |k: usize| {
            let along = points.iter().map(|point| point[k]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) / 2.0 - along.fold(f64::INFINITY, f64::min) / 2.0
        };
        let upright = volume([0, 1, 2].map(extent));
        (volume(obb.half_extents()) < TURNED_BOX * upright).then(|| Frame::new(obb.axes())).flatten()
    };
    turned().unwrap_or(Frame::STANDARD)
}

struct Decomposing<'d, 'b> {
    mesh: &'d Mesh,
    frame: Frame,
    concavity: f64,
    work: Work,
    budget: &'d Budget<'b>,
}

impl Decomposing<'_, '_> {
    /// Returns the parts: cuts the part with the largest concavity until all are within the goal or
    /// there are enough, and merges them.
    fn parts(&self, whole: Piece, hull: Hull, max_parts: usize) -> Vec<Part> {
        let outside = self.outside(&hull, ROUGH_RATIO);
        let whole_part = Part { hull, outside };
        let mut done: Vec<Part> = Vec::new();
        let mut open = vec![(whole, whole_part.clone())];
        let limit = if max_parts == 1 { 1 } else { CUTS_PER_PART * max_parts };
        while done.len() + open.len() < limit && !self.budget.is_spent() {
            let worst = (0..open.len()).max_by(|&a, &b| open[a].1.outside.upper.total_cmp(&open[b].1.outside.upper));
            let Some((piece, part)) = worst.map(|worst| open.swap_remove(worst)) else { break };
            match self.halved(&piece, &part) {
                Some(halves) => {
                    let (near, far): (Vec<_>, Vec<_>) =
                        halves.into_iter().partition(|(_, part)| part.outside.upper <= self.concavity);
                    done.extend(near.into_iter().map(|(_, part)| part));
                    open.extend(far);
                }
                None => done.push(part),
            }
        }
        done.extend(open.into_iter().map(|(_, part)| part));
        let merged = merge(self.mesh, done, (self.concavity, max_parts), &self.work, self.budget);
        // A budget may end the work before there are few enough parts.
        let mut parts = if merged.len() > max_parts { vec![whole_part] } else { merged };
        for part in parts.iter_mut().filter(|part| part.outside.upper > self.concavity) {
            let goal = Goal { enough: self.concavity, ratio: FINE_RATIO };
            let outside = Outside::of(self.mesh, &part.hull, goal, &Work::default(), self.budget);
            if outside.upper < part.outside.upper {
                part.outside = outside;
            }
        }
        parts
    }

    /// Returns the parts on both sides of the best plane, without empty ones. Returns `None` if no
    /// plane divides the piece, or if it cannot be cut in the range of doubles.
    fn halved(&self, piece: &Piece, part: &Part) -> Option<Vec<(Piece, Part)>> {
        if part.outside.upper <= self.concavity {
            return None;
        }
        let plane = cut::best_plane(self.mesh, &self.frame, (piece, &part.hull), self.budget)?;
        let mut parts = Vec::new();
        for half in piece.halves(self.mesh, &self.frame, plane) {
            let points = half.points(self.mesh, &self.frame);
            if !points.is_empty() {
                let hull = covering_hull(&points).ok()?;
                let outside = self.outside(&hull, ROUGH_RATIO);
                parts.push((half, Part { hull, outside }));
            }
        }
        Some(parts)
    }

    fn outside(&self, hull: &Hull, ratio: f64) -> Outside {
        Outside::of(self.mesh, hull, Goal { enough: self.concavity, ratio }, &self.work, self.budget)
    }
}
