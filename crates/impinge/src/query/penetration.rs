//! How deep two things are in each other, and whether their interiors intersect.

use super::penetrates::{Penetrates, penetrates_of_pairs};
use super::placed::{Placed, meshes};
use super::shapes::{search, table};
use super::{Proximity, intersecting_pairs, proximity};
use crate::convex::Depth;

/// How deep two things are in each other, with what was proved about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// No translation shorter than this takes the interiors of the two apart, in world units.
    pub lower: f64,
    /// Moving the second by this along [`normal`](Self::normal) does; infinite where nothing does.
    pub upper: f64,
    /// A direction of length 1 from the first to the second, in the world frame. Where several are as good, one of them.
    pub normal: [f64; 3],
    /// The point of the first that is deepest in the second, against the normal; in the world frame, rounded.
    pub point_a: [f64; 3],
    /// The point of the second that is deepest in the first, in the world frame, rounded: from it to the other point it is about the
    /// depth, along the normal.
    pub point_b: [f64; 3],
}

impl Penetration {
    /// The penetration of two things about which nothing is proved: a depth between zero and infinity.
    pub const UNKNOWN: Self =
        Self { lower: 0.0, upper: f64::INFINITY, normal: [0.0; 3], point_a: [0.0; 3], point_b: [0.0; 3] };
}

/// How deep two things are in each other; none if they do not intersect. A mesh is taken as a solid here, whether
/// it is said to be one or not: a surface has no interior.
///
/// It is the length of a translation of the second that takes it out of the first, and no property of a pair of faces: smaller
/// triangles make it more accurate and not smaller.
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
/// The true depth lies in `[lower, upper]` (docs/proof.md, L22 and L30), and the upper end is valid for the normal whatever else
/// happened.
/// - Of polytopes, spheres and capsules the interval is about 2^-44 of the sizes wide. For cylinders, cones and ellipsoids it is
///   narrowed to 2^-40 of the sizes; if they are deep in each other, as in one place, it is what the work allows: the tests assert
///   1e-10 for those placed at random, and 1e-3 of the sizes in one place, 1e-2 for a cone (`tests/it/shapes`).
/// - Of compounds, and of meshes but with half-spaces, the upper end is what a search found: the second was moved by it and proved
///   to be apart; there may be shorter ways. The lower end comes from two balls about one point, one in each of the two, and so is near
///   the upper one if both are round there, and may be far below it if they are thin. Of spheres of 20,480 triangles that overlap by
///   a quarter of their size it is within 1 % (`tests/it/solids/depths.rs`). An open mesh has its inside where its winding number is
///   beyond one half. Closed meshes that only touch have a depth of zero, exactly. The surfaces in a compound hold no ball.
///
/// # Complexity
/// Some 10 to 30 supports and as many facets for boxes and small hulls, 30 to 60 for round ones and at most 320. A search takes some
/// hundred distances, each from the last witness, as many closest points, and of two meshes that of
/// [`intersection_curves`](super::intersection_curves).
///
/// # Source
/// The search: Je, Tang, Lee, Lee, Kim, *PolyDepth: real-time penetration depth computation using iterative contact-space
/// projection*, ACM Transactions on Graphics 31, 2012; ours advances by proved distances, so that what it returns parts the two.
#[must_use]
pub fn penetration<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Option<Penetration> {
    let (a, b) = (a.into(), b.into());
    let (a, b) = (solid(&a), solid(&b));
    if proximity(&a, &b) == Proximity::Apart {
        return None;
    }
    let (a, b) = (a.shape(), b.shape());
    Some(table::depth(&a, &b).unwrap_or_else(|| search::depth_by_search(&a, &b)).into())
}

/// A mesh as a solid; all else as it is.
pub(super) fn solid<'p>(placed: &'p Placed<'_>) -> Placed<'p> {
    match placed.mesh() {
        Some(mesh) => Placed::Mesh(mesh.mesh.solid().at(mesh.world_from_mesh)),
        None => placed.into(),
    }
}

/// Whether the interiors of two things intersect, which touching is not. A mesh is taken as a solid here.
///
/// # Accuracy
/// `Yes` and `No` are exact. Of two meshes `Undecided` is possible only if one mesh is open and its border is
/// near the other mesh, or if faces that intersect the other mesh or lie inside it also intersect
/// faces of their own mesh elsewhere than in common corners and edges. The answer does not depend on
/// the order of the faces. Other shapes are `Undecided` if their depth is zero to within its proved interval.
///
/// # Complexity
/// Of two meshes that of [`intersecting_pairs`](super::intersecting_pairs), linear in the pairs, and that of
/// [`Mesh::contains`](crate::Mesh::contains) for one point of each face that is in a pair or beside one, and of each connected part
/// that is in none. Of other shapes that of [`penetration`].
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
    let (a, b) = (a.into(), b.into());
    let (a, b) = (solid(&a), solid(&b));
    if let Some([a, b]) = meshes(&a, &b) {
        return penetrates_of_pairs(a, b, &intersecting_pairs(a, b));
    }
    match penetration(&a, &b) {
        Some(depth) if depth.lower > 0.0 => Penetrates::Yes,
        Some(depth) if depth.upper > 0.0 => Penetrates::Undecided,
        _ => Penetrates::No,
    }
}

impl From<Depth> for Penetration {
    fn from(depth: Depth) -> Self {
        let [point_a, point_b] = depth.points;
        Self { lower: depth.lower, upper: depth.upper, normal: depth.normal, point_a, point_b }
    }
}
