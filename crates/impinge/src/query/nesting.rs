//! What lies wholly inside a solid mesh intersects it too.
//!
//! If the surfaces are apart, a connected component of one lies in one region of what the other leaves of space, so one of its
//! points tells for all of it.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::{Proximity, intersecting_pairs};
use crate::exact::{Placement, PosedPoint, Spot};
use crate::mesh::{Components, Containment, Judge, Mesh, PlacedMesh};

/// Which mesh has a connected component inside the other one, apart from its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contained {
    /// The first mesh, in the second.
    A,
    /// The second mesh, in the first.
    B,
    /// Each has one in the other.
    Both,
}

/// How two meshes intersect, of which one or both are solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidIntersection {
    /// Whether they have a point in common.
    pub intersects: bool,
    /// Which of them has a component that lies inside the other, apart from its surface.
    pub contained: Option<Contained>,
    /// Whether a component counts as inside an open mesh without proof: the proved interval of the winding number held
    /// one half.
    pub undecided: bool,
    /// Whether each mesh is open and was asked for what is inside it: its inside is then where its generalised winding
    /// number is beyond one half, and of a component of the other one point was asked for.
    pub open: [bool; 2],
}

impl Contained {
    fn of([a, b]: [bool; 2]) -> Option<Self> {
        match (a, b) {
            (false, false) => None,
            (true, false) => Some(Self::A),
            (false, true) => Some(Self::B),
            (true, true) => Some(Self::Both),
        }
    }

    /// Whether each of the two has a component in the other.
    #[must_use]
    pub fn sides(self) -> [bool; 2] {
        [self != Self::B, self != Self::A]
    }
}

/// How two meshes intersect, of which one or both are solid, and which has a component inside the other.
///
/// # Accuracy
/// Exact if the solid meshes are closed. If one is open, the answer says what is not proved.
///
/// # Complexity
/// That of [`intersecting_pairs`], then for each connected component of either mesh that of [`Mesh::contains`] for one point;
/// O(n log n) the first time that a mesh is asked.
///
/// ```
/// use impinge::query::{self, Contained};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let large = Mesh::new(Positions::F32(corners), faces)?;
/// let inside = large.at(Pose::new([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]], [1.0; 3])?);
/// assert_eq!(query::solid_intersection(large.solid(), inside).contained, Some(Contained::B));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn solid_intersection<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> SolidIntersection {
    let (a, b) = (a.into(), b.into());
    solid_intersection_of_pairs(a, b, &intersecting_pairs(a, b))
}

/// [`solid_intersection`], for pairs that were computed before: all that [`intersecting_pairs`] returned.
///
/// # Panics
/// Where a pair names a face that a mesh does not have.
#[must_use]
pub fn solid_intersection_of_pairs<'a, 'b>(
    a: impl Into<PlacedMesh<'a>>,
    b: impl Into<PlacedMesh<'b>>,
    pairs: &[[u32; 2]],
) -> SolidIntersection {
    let placed = [a.into(), b.into()];
    let mut inside = [false; 2];
    let mut undecided = false;
    let mut open = [false; 2];
    for inner in 0..2 {
        let outer = 1 - inner;
        if !placed[outer].is_solid {
            continue;
        }
        let nesting = Nesting::of(placed[inner], placed[outer]);
        let touched: Vec<u32> = pairs.iter().map(|pair| pair[inner]).collect();
        let found = nesting
            .free(&touched)
            .into_par_iter()
            .map(|corner| nesting.containment(corner))
            .fold(
                || [false; 2],
                |[surely, perhaps], at| [surely || at == Containment::Inside, perhaps || at == Containment::Undecided],
            )
            .reduce(|| [false; 2], |x, y| [x[0] || y[0], x[1] || y[1]]);
        inside[inner] = found[0] || found[1];
        undecided |= found[1] && !found[0];
        open[outer] = !placed[outer].mesh.is_closed();
    }
    let contained = Contained::of(inside);
    SolidIntersection { intersects: !pairs.is_empty() || contained.is_some(), contained, undecided, open }
}

/// Whether a component of one of two meshes lies inside the other, a solid, if their surfaces are apart. Undecided if none does for
/// certain, and one may lie inside an open mesh.
pub(super) fn nested(a: PlacedMesh<'_>, b: PlacedMesh<'_>) -> Proximity {
    let is_open = AtomicBool::new(false);
    let any = |inner: PlacedMesh<'_>, outer: PlacedMesh<'_>| {
        let nesting = Nesting::of(inner, outer);
        nesting.free(&[]).into_par_iter().any(|corner| match nesting.containment(corner) {
            Containment::Inside | Containment::Surface => true,
            Containment::Outside => false,
            Containment::Undecided => {
                // Ordered by the end of the loop.
                is_open.store(true, Ordering::Relaxed);
                false
            }
        })
    };
    if (b.is_solid && any(a, b)) || (a.is_solid && any(b, a)) {
        Proximity::Meets
    } else if is_open.into_inner() {
        Proximity::Undecided
    } else {
        Proximity::Apart
    }
}

/// The components of one mesh beside another.
struct Nesting<'m> {
    inner: &'m Mesh,
    outer: &'m Mesh,
    placement: Placement,
}

impl<'m> Nesting<'m> {
    fn of(inner: PlacedMesh<'m>, outer: PlacedMesh<'m>) -> Self {
        let placement = Placement::new(&outer.world_from_mesh, &inner.world_from_mesh);
        Self { inner: inner.mesh, outer: outer.mesh, placement }
    }

    /// For each component that has none of these faces a corner of it: its first one, or, if the
    /// outer mesh is open, the one with the least coordinates. A closed mesh has all of a component
    /// on one side. An open one may not, and the order of the faces is not to decide.
    fn free(&self, touched: &[u32]) -> Vec<[f64; 3]> {
        // Built now, not by the threads that share the work.
        self.outer.topology();
        let Components { of_face, first_faces } = &self.inner.topology().components;
        let mut corners: Vec<[f64; 3]> = first_faces.iter().map(|&face| self.inner.corners(face)[0]).collect();
        if !self.outer.is_closed() {
            for (face, &component) in (0..).zip(of_face) {
                let least = &mut corners[component as usize];
                *least = self.inner.corners(face).into_iter().fold(*least, |x, y| if y < x { y } else { x });
            }
        }
        let mut is_free = vec![true; corners.len()];
        for &face in touched {
            is_free[of_face[face as usize] as usize] = false;
        }
        corners.into_iter().zip(is_free).filter_map(|(corner, is_free)| is_free.then_some(corner)).collect()
    }

    /// Where a corner of the inner mesh is to the outer one.
    fn containment(&self, corner: [f64; 3]) -> Containment {
        Judge::new(self.outer).containment(&PosedPoint::new(&self.placement, Spot::At(corner)))
    }
}
