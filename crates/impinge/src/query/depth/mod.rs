//! How deep two solids share material, and whether deeper than a threshold.
//!
//! `answer` has the interval of a depth. `cell` has the convex cells into which the common part is
//! divided, `face` and `facet` the faces and flat parts of a solid near it, `side` the solid as a
//! cell sees it, `piece` a cell with its faces, `goal` the question, `divide` where
//! cells are cut, `border` how much winding
//! numbers vary near holes, and `search` the search. `nearest` finds the
//! nearest face to a point. `solids` prepares both solids. `shapes` has the depth of
//! things that are not meshes.

mod answer;
mod border;
mod cell;
mod divide;
mod face;
mod facet;
mod goal;
mod nearest;
mod piece;
mod search;
mod shapes;
mod side;
mod solids;
mod volume;

pub use answer::Depth;
pub(crate) use goal::Effort;
use goal::Goal;
pub(crate) use nearest::nearest_face;
use solids::Solids;
pub use volume::CommonVolume;

use super::Query;
use super::penetrates::Penetrates;
use super::penetration::solid;
use super::placed::{Placed, meshes};

/// Computes how much material two solids share: the greatest depth of a common point, which is its
/// distance from the surface of one of the two solids, whichever is farther.
///
/// The depth is zero if the solids only touch, and also if one fits exactly into an opening of the
/// other. [`penetration`](super::penetration()) answers another question, how far to move a solid
/// out: it is never less than the depth. A mesh is always taken as a solid here.
///
/// ```
/// use impinge::{Pose, query};
/// # use impinge::{Mesh, Positions, InputError};
/// # fn cuboid(low: [f64; 3], high: [f64; 3]) -> Result<Mesh, InputError> {
/// #     let corners = (0..8).map(|at| std::array::from_fn(|k| if at >> k & 1 == 0 { low[k] } else { high[k] }));
/// #     let faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
/// #         [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
/// #     Mesh::new(Positions::F64(corners.collect()), faces.to_vec())
/// # }
///
/// // Two walls in one line, 0.25 thick, that overlap by 0.125. A point in the middle is 0.0625
/// // from the end of each wall, and a point at the end of one wall is 0.125 from that of the other.
/// let (wall, next) = (cuboid([0.0; 3], [5.0, 0.25, 3.0])?, cuboid([4.875, 0.0, 0.0], [9.0, 0.25, 3.0])?);
/// let depth = query::depth(&wall, &next);
/// assert!(depth.lower <= 0.125 && 0.125 <= depth.upper && depth.upper < 0.126);
/// // They touch.
/// let touching = query::depth(&wall, next.at(Pose::from_translation([0.125, 0.0, 0.0])?));
/// assert!(touching.lower == 0.0 && touching.upper < 1e-10);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true depth lies in `[lower, upper]`, and `point` shows the lower bound (docs/notes/proof.md,
/// L42). The width is at most 1/1024 of the depth plus about 2^-28 of the size of the solids,
/// unless the number of cells limits it. If one thing is a shape other than a mesh, the upper bound
/// is that of [`penetration`](super::penetration()), and points near its witnesses show the lower
/// bound. The two may differ much.
///
/// # Complexity
/// Grows with the number of faces of both solids near their common part. At most 16,384 cells, each
/// compared with the faces near it.
#[must_use]
pub fn depth<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Depth {
    Query::new().depth(a, b)
}

/// Returns whether two solids share material deeper than a threshold: whether their [`depth`] is
/// above `threshold`, in world units. It costs much less than the depth.
///
/// # Accuracy
/// `Yes` and `No` are proved for closed meshes (docs/notes/proof.md, L42). For an open mesh they
/// follow from winding numbers at the corners of cells, as [`Depth::is_proved`] says. `Undecided`
/// is returned if the depth differs from the threshold by less than rounding, about 2^-39 of the
/// size of the solids, or if 16,384 cells do not suffice. With a threshold of zero the question is
/// that of [`penetrates`](super::penetrates()).
///
/// # Complexity
/// Grows with the number of faces of both solids near their common part. Parts with common flat
/// walls take a few cells for each face.
///
/// # Panics
/// If `threshold` is negative or NaN.
///
/// ```
/// use impinge::query::{self, Deeper};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // Its tip reaches the floor of a copy, and half a unit through it.
/// let above = part.at(Pose::from_translation([0.5, 0.5, -7.5])?);
/// assert_eq!(query::deeper(&part, above, 0.125), Deeper::Yes);
/// assert_eq!(query::deeper(&part, above, 0.5), Deeper::No);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn deeper<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, threshold: f64) -> Deeper {
    Query::new().deeper(a, b, threshold)
}

/// Computes the volume of the material that two solids share. A mesh is always taken as a solid
/// here. Returns `None` if one of the two things is a shape that is not a mesh.
///
/// # Accuracy
/// The true volume lies in the interval, up to the rounding of sums. Solids with some hundred flat
/// sides near each other have a narrow interval; with thousands of curved faces it is wide.
///
/// # Complexity
/// At most 8,192 cells, each compared with the faces near it.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // The tip of a copy reaches half a unit through the floor.
/// let above = part.at(Pose::from_translation([0.5, 0.5, -7.5])?);
/// let (volume, expected) = (query::common_volume(&part, above).unwrap(), 0.5_f64.powi(3) / 6.0);
/// assert!(volume.lower <= expected && expected <= volume.upper);
/// assert!(volume.upper - volume.lower < 1e-6);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn common_volume<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Option<CommonVolume> {
    Query::new().common_volume(a, b)
}

/// Verdict whether two solids share material deeper than a threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Deeper {
    /// No common point is deeper.
    No,
    /// Undecided: the depth is about the threshold, or too many cells would be needed.
    Undecided,
    /// A common point is deeper.
    Yes,
}

impl Deeper {
    /// Returns `true` unless the answer is `No`, so `true` if it is undecided.
    #[must_use]
    pub fn possibly(self) -> bool {
        self != Self::No
    }
}

impl Query<'_> {
    /// Computes [`depth`]. If the budget ends the search, the interval is wider.
    #[must_use]
    pub fn depth<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Depth {
        self.depth_with(a, b, Effort::FULL)
    }

    /// Returns [`deeper`]. If the budget ends the search, the answer is `Undecided` unless a point
    /// that was found decides it.
    ///
    /// # Panics
    /// If `threshold` is negative or NaN.
    #[must_use]
    pub fn deeper<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, threshold: f64) -> Deeper {
        assert!(threshold >= 0.0, "the threshold must not be negative or NaN");
        let depth = self.material_beyond(a, b, threshold, Effort::FULL);
        if depth.lower > threshold {
            Deeper::Yes
        } else if depth.upper <= threshold {
            Deeper::No
        } else {
            Deeper::Undecided
        }
    }

    /// Computes [`common_volume`]. If the budget ends the search, the interval is wider.
    #[must_use]
    pub fn common_volume<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Option<CommonVolume> {
        let (a, b) = (a.into(), b.into());
        let [a, b] = meshes(&a, &b)?;
        let goal = Goal { threshold: None, outside_first: false, measured: [true; 2], effort: Effort::FULL };
        let Some(solids) = Solids::new(a, b, true) else { return Some(CommonVolume::NONE) };
        let [lower, upper] = solids.common_volume(&goal, self.options.budget);
        Some(CommonVolume { lower, upper, is_proved: solids.are_closed() })
    }

    /// Computes [`depth`] with some effort.
    pub(crate) fn depth_with<'a, 'b>(
        self,
        a: impl Into<Placed<'a>>,
        b: impl Into<Placed<'b>>,
        effort: Effort,
    ) -> Depth {
        self.shared_material(&a.into(), &b.into(), None, effort)
    }

    /// Returns an interval that holds the depth, as far as a comparison with the threshold needs
    /// it.
    pub(crate) fn material_beyond<'a, 'b>(
        self,
        a: impl Into<Placed<'a>>,
        b: impl Into<Placed<'b>>,
        threshold: f64,
        effort: Effort,
    ) -> Depth {
        let (a, b) = (a.into(), b.into());
        if threshold > 0.0 {
            return self.shared_material(&a, &b, Some(threshold), effort);
        }
        let budget = self.options.budget;
        match self.penetrates(&a, &b) {
            Penetrates::No => Depth::NONE,
            // The depth of an intersection that is proved may be below what the search resolves.
            Penetrates::Yes => {
                let depth = Query::new().with_budget(budget).depth(&a, &b);
                Depth { lower: depth.lower.max(f64::MIN_POSITIVE), upper: depth.upper.max(f64::MIN_POSITIVE), ..depth }
            }
            Penetrates::Undecided => Query::new().with_budget(budget).depth(&a, &b),
        }
    }

    /// Returns the depth, or as much as a comparison with the threshold needs.
    fn shared_material(self, a: &Placed<'_>, b: &Placed<'_>, threshold: Option<f64>, effort: Effort) -> Depth {
        let budget = self.options.budget;
        let Some([a, b]) = meshes(a, b) else {
            return shapes::depth_of_shapes(&solid(a), &solid(b), budget);
        };
        let goal = Goal { threshold, outside_first: false, measured: [true; 2], effort };
        let Some(solids) = Solids::new(a, b, true) else { return Depth::NONE };
        let found = if threshold.is_some() { solids.search(goal, budget) } else { solids.greatest(goal, budget) };
        let depth = Depth::new(found, solids.are_closed());
        if threshold.is_some() {
            return depth;
        }
        // The search does not tell a slight depth from none, and this question is exact.
        if depth.lower == 0.0 && self.penetrates(a, b) == Penetrates::No { Depth::NONE } else { depth }
    }

    /// Reports whether a solid is proved to lie inside another, up to a tolerance: no point of
    /// `inner` is farther than the tolerance outside of `outer`. Both must have common material.
    /// Only meshes are compared.
    pub(crate) fn is_inside(&self, inner: &Placed<'_>, outer: &Placed<'_>, tolerance: f64) -> bool {
        let Some([outer, inner]) = meshes(outer, inner) else { return false };
        let goal =
            Goal { threshold: Some(tolerance), outside_first: true, measured: [true, false], effort: Effort::FULL };
        let Some(solids) = Solids::new(outer, inner, false) else { return false };
        solids.first_box_holds_second(tolerance)
            && solids
                .convex_holds_second(tolerance, self.options.budget)
                .unwrap_or_else(|| solids.search(goal, self.options.budget).is_within(tolerance))
    }
}
