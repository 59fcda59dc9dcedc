//! How deep two things are in each other, and whether their interiors intersect.

use super::penetrates::{Penetrates, decide};
use super::placed::{Placed, meshes};
use super::shapes::{search, table};
use super::{Proximity, Query};
use crate::convex::Depth;

/// Penetration depth of two things, as an interval that is proved to hold the true depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Lower bound of the depth, in world units: no shorter translation separates the interiors of
    /// the two things.
    pub lower: f64,
    /// Upper bound of the depth, in world units: moving the second thing by this length along
    /// [`normal`](Self::normal) separates the interiors. Infinite if no such translation is known.
    pub upper: f64,
    /// Direction of length 1 from the first thing to the second, in the world frame, rounded. If
    /// several directions are equally good, it is one of them.
    pub normal: [f64; 3],
    /// Point of the first thing that is deepest in the second along the normal, in the world frame,
    /// each coordinate rounded.
    pub point_a: [f64; 3],
    /// Point of the second thing that is deepest in the first, in the world frame, each coordinate
    /// rounded. Along the normal, `point_a` is ahead of it by about the depth.
    pub point_b: [f64; 3],
}

impl Penetration {
    /// Penetration about which nothing is proved: a depth between zero and infinity. Its normal and
    /// its points are zero.
    pub const UNKNOWN: Self =
        Self { lower: 0.0, upper: f64::INFINITY, normal: [0.0; 3], point_a: [0.0; 3], point_b: [0.0; 3] };
}

/// Computes how deep two things are in each other, as a proved interval in world units. Returns
/// `None` if they do not intersect.
///
/// The depth is the length of the shortest translation of the second thing that moves it out of the
/// first. A mesh is always taken as a solid here, because a surface has no interior. The depth
/// belongs to the two things, not to a pair of faces: with smaller triangles it becomes more
/// accurate, not smaller. The function never fails. The interval contains zero if the things only
/// touch, or if it is undecided whether they intersect.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, Shape, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // Its tip, one unit deep in the floor of a copy.
/// let above = mesh.at(Pose::from_translation([0.5, 0.5, -7.0])?);
/// let depth = query::penetration(&mesh, above).expect("they intersect");
/// assert!(depth.lower <= depth.upper && depth.upper < 1.01);
/// assert!(query::penetration(&mesh, mesh.at(Pose::from_translation([9.0, 0.0, 0.0])?)).is_none());
///
/// let (a, b) = (Shape::cuboid([1.0; 3])?, Shape::sphere([0.0; 3], 1.0)?);
/// let pose = Pose::from_translation([1.5, 0.0, 0.0])?;
/// let depth = query::penetration(a.at(Pose::IDENTITY)?, b.at(pose)?).expect("they intersect");
/// assert!(depth.lower <= 0.5 && 0.5 <= depth.upper && depth.upper - depth.lower < 1e-12);
/// assert_eq!(depth.normal, [1.0, 0.0, 0.0]);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true depth lies in `[lower, upper]` (docs/notes/proof.md, L22 and L30). The upper bound
/// always holds for the returned normal.
/// - For polytopes, spheres and capsules the width is about 2^-44 of their sizes.
/// - For cylinders, cones and ellipsoids the width is narrowed to 2^-40 of their sizes. If they are
///   deep in each other, for example in one place, the number of iterations limits the width. The
///   tests assert 1e-10 for random poses, 1e-3 of the sizes for shapes in one place, and 1e-2 for
///   cones there (`tests/it/shapes`).
/// - For compounds, and for meshes with anything but half-spaces, a search finds the upper bound.
///   The second thing was moved by that translation and proved to be apart; a shorter translation
///   may exist. The lower bound comes from two spheres about one point, one inside each thing. It
///   is near the upper bound if both things are round there, and may be far below it if they are
///   thin. For two spheres of 20,480 triangles that overlap by a quarter of their size it is within
///   1 % (`tests/it/solids/depths.rs`). Surfaces in a compound hold no sphere.
/// - The inside of an open mesh is the set of points whose winding number is above one half. Closed
///   meshes that only touch have a depth of exactly zero.
///
/// # Complexity
/// Boxes and small hulls take 10 to 30 support calls and as many facets; round shapes take 30 to
/// 60, and at most 320. A search takes a few hundred distances, each with a warm start, as many
/// closest-point queries, and for two meshes one
/// [`intersection_curves`](super::intersection_curves()) query.
///
/// # Source
/// The search: Je, Tang, Lee, Lee, Kim, *PolyDepth: real-time penetration depth computation using
/// iterative contact-space projection*, ACM Transactions on Graphics 31, 2012. Ours advances by
/// proved distances, so that the returned translation separates the two things.
#[must_use]
pub fn penetration<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Option<Penetration> {
    Query::new().penetration(a, b)
}

/// Returns a mesh as a solid, and any other thing as it is.
pub(super) fn solid<'p>(placed: &'p Placed<'_>) -> Placed<'p> {
    match placed.mesh() {
        Some(mesh) => Placed::Mesh(mesh.mesh.solid().at(mesh.world_from_mesh)),
        None => placed.into(),
    }
}

/// Returns whether the interiors of two things intersect, or that this is undecided. Touching does
/// not count. A mesh is always taken as a solid here.
///
/// The function never fails. [`Penetrates::possibly`] turns the answer into a `bool`, which is
/// `true` if the answer is undecided.
///
/// # Accuracy
/// `Yes` and `No` are exact. For two meshes the answer is `Undecided` only in two cases: a mesh is
/// open and its border is near the other mesh; or faces that intersect the other mesh or lie inside
/// it also intersect faces of their own mesh outside of common corners and edges. The answer does
/// not depend on the order of the faces. For other shapes the answer is `Undecided` if zero lies in
/// the proved interval of the depth.
///
/// # Complexity
/// For two meshes it takes the time of [`intersecting_pairs`](super::intersecting_pairs()) and
/// linear time in the number of pairs. It also takes the time of
/// [`Mesh::contains`](crate::Mesh::contains) for one point of each face that is in a pair or beside
/// one, and of each connected part that is in no pair. For other shapes it takes the time of
/// [`penetration`].
///
/// ```
/// use impinge::query::{self, Penetrates};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]];
/// let part = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // The same part on its other side, turned by half about the x axis: two edges in common.
/// let turned = part.at(Pose::new([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]], [0.0; 3])?);
/// assert!(query::intersects(&part, turned));
/// assert_eq!(query::penetrates(&part, turned), Penetrates::No);
/// assert_eq!(query::penetrates(&part, part.at(Pose::from_translation([1.0, 0.0, 0.0])?)), Penetrates::Yes);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn penetrates<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Penetrates {
    Query::new().penetrates(a, b)
}

impl Query<'_> {
    /// Computes how deep two things are in each other, as [`penetration`] does. If the budget ends
    /// the search, the bounds are wider.
    #[must_use]
    pub fn penetration<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Option<Penetration> {
        let a = a.into();
        let b = b.into();
        let (a, b) = (solid(&a), solid(&b));
        let budget = self.options.budget;
        if Query::new().with_budget(budget).proximity(&a, &b) == Proximity::Apart {
            return None;
        }
        let a = a.shape();
        let b = b.shape();
        Some(table::depth(&a, &b).unwrap_or_else(|| search::depth_by_search(&a, &b, budget)).into())
    }

    /// Returns [`penetrates`] of two things. If the budget ends the search, the answer is
    /// `Undecided` unless an intersection of the interiors is proved.
    #[must_use]
    pub fn penetrates<'a, 'b>(self, a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Penetrates {
        let a = a.into();
        let b = b.into();
        let (a, b) = (solid(&a), solid(&b));
        if let Some([a, b]) = meshes(&a, &b) {
            let budget = self.options.budget;
            return decide(a, b, &self.intersecting_pairs(a, b), budget);
        }
        match self.penetration(&a, &b) {
            Some(depth) if depth.lower > 0.0 => Penetrates::Yes,
            Some(depth) if depth.upper > 0.0 => Penetrates::Undecided,
            _ => Penetrates::No,
        }
    }
}

impl From<Depth> for Penetration {
    fn from(depth: Depth) -> Self {
        let [point_a, point_b] = depth.points;
        Self { lower: depth.lower, upper: depth.upper, normal: depth.normal, point_a, point_b }
    }
}
