//! Intersections with a solid mesh of things that lie wholly inside it.
//!
//! If the surfaces are apart, a connected component of one mesh lies in one region of the
//! complement of the other surface. So one point of the component decides for all of it.
//!
//! Tests: `tests/it/solids`. Benchmark: `solids`.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::{Proximity, intersecting_pairs};
use crate::budget::Budget;
use crate::exact::{Placement, PosedPoint, Spot};
use crate::mesh::{Components, Containment, Mesh, PlacedMesh, PointClassifier};

/// Which mesh has a connected component inside the other one, without touching its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contained {
    /// Only the first mesh has a component inside the other.
    A,
    /// Only the second mesh has a component inside the other.
    B,
    /// Each mesh has a component inside the other.
    Both,
}

/// Report about the intersection of two meshes, of which one or both are solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidIntersection {
    /// Whether the meshes have a point in common, or may have one if [`undecided`](Self::undecided)
    /// is set.
    pub intersects: bool,
    /// Which mesh has a component inside the other, without touching its surface. Absent if no mesh
    /// has one.
    pub contained: Option<Contained>,
    /// Whether a component counts as inside an open mesh without proof, because the proved interval
    /// of its winding number contains one half.
    pub undecided: bool,
    /// Whether each mesh is open and was checked for components of the other inside it. The inside
    /// of an open mesh is the set of points whose generalized winding number is above one half.
    /// Only one point of each component was checked.
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

    /// Reports for the first and for the second mesh whether it has a component inside the other.
    #[must_use]
    pub fn sides(self) -> [bool; 2] {
        [self != Self::B, self != Self::A]
    }
}

/// Returns how two meshes intersect, of which one or both are solid, and which mesh has a component
/// inside the other.
///
/// The function never fails. If both meshes are surfaces, only their surfaces count and `contained`
/// is absent.
///
/// # Accuracy
/// Exact if the solid meshes are closed. If a solid mesh is open, the fields
/// [`undecided`](SolidIntersection::undecided) and [`open`](SolidIntersection::open) say which part
/// of the answer is not proved.
///
/// # Complexity
/// The time of [`intersecting_pairs`], and for each connected component of each mesh the time of
/// [`Mesh::contains`] for one point. The first such query of a mesh takes O(n log n).
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

/// Returns how two meshes intersect, as [`solid_intersection`] does, given the pairs of faces that
/// intersect. `pairs` must be all pairs that [`intersecting_pairs`] returned for the same meshes
/// and poses.
///
/// # Panics
/// If a face index of a pair is out of range.
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
                |[surely, maybe], at| [surely || at == Containment::Inside, maybe || at == Containment::Undecided],
            )
            .reduce(|| [false; 2], |x, y| [x[0] || y[0], x[1] || y[1]]);
        inside[inner] = found[0] || found[1];
        undecided |= found[1] && !found[0];
        open[outer] = !placed[outer].mesh.is_closed();
    }
    let contained = Contained::of(inside);
    SolidIntersection { intersects: !pairs.is_empty() || contained.is_some(), contained, undecided, open }
}

/// Returns whether a component of one mesh lies inside the other, a solid, if their surfaces are
/// apart. The answer is undecided if no component is certainly inside, and one may be inside an
/// open mesh or the budget is spent.
pub(super) fn nested(a: PlacedMesh<'_>, b: PlacedMesh<'_>, budget: &Budget<'_>) -> Proximity {
    let is_undecided = AtomicBool::new(false);
    let any = |inner: PlacedMesh<'_>, outer: PlacedMesh<'_>| {
        let nesting = Nesting::of(inner, outer);
        let containment = |corner| if budget.is_spent() { Containment::Undecided } else { nesting.containment(corner) };
        let is_inside = |corner| match containment(corner) {
            Containment::Inside | Containment::Surface => true,
            Containment::Outside => false,
            Containment::Undecided => {
                // The end of the parallel loop orders this store before the load below.
                is_undecided.store(true, Ordering::Relaxed);
                false
            }
        };
        match nesting.free(&[])[..] {
            // Handing one component to the pool takes longer than to decide about it.
            [corner] => is_inside(corner),
            ref corners => corners.par_iter().any(|&corner| is_inside(corner)),
        }
    };
    if (b.is_solid && any(a, b)) || (a.is_solid && any(b, a)) {
        Proximity::Intersects
    } else if is_undecided.into_inner() {
        Proximity::Undecided
    } else {
        Proximity::Apart
    }
}

/// Returns a point of a component of one mesh that lies in the other, a solid, or `None` if there
/// is no such component. The point is a corner of a face, in the world frame, rounded. Undecided
/// components count as inside.
///
/// The surfaces of the meshes must be apart.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let large = Mesh::new(Positions::F32(corners), faces)?;
/// let inside = large.at(Pose::new([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]], [1.0; 3])?);
/// assert_eq!(query::contained_point(large.solid(), inside), Some([1.0; 3]));
/// assert_eq!(query::contained_point(&large, inside), None);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Complexity
/// As for [`solid_intersection`], without the search for pairs of faces.
#[must_use]
pub fn contained_point<'a, 'b>(a: impl Into<PlacedMesh<'a>>, b: impl Into<PlacedMesh<'b>>) -> Option<[f64; 3]> {
    let (a, b) = (a.into(), b.into());
    let corner_in = |inner: PlacedMesh<'_>, outer: PlacedMesh<'_>| {
        let nesting = Nesting::of(inner, outer);
        let corner = nesting.free(&[]).into_iter().find(|&at| nesting.containment(at) != Containment::Outside)?;
        Some(inner.world_from_mesh.apply(corner))
    };
    let of_a = if b.is_solid { corner_in(a, b) } else { None };
    of_a.or_else(|| if a.is_solid { corner_in(b, a) } else { None })
}

/// Components of one mesh in the frame of another.
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

    /// Returns one corner of each component that contains none of the touched faces. It is the
    /// first corner or, if the outer mesh is open, the corner with the smallest coordinates: a
    /// component may then lie on both sides, and the order of the faces must not decide. A closed
    /// outer mesh has all of a component on one side.
    fn free(&self, touched: &[u32]) -> Vec<[f64; 3]> {
        // Built here, so that the threads of the caller do not wait for it.
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

    /// Returns whether a corner of the inner mesh is inside the outer one.
    fn containment(&self, corner: [f64; 3]) -> Containment {
        PointClassifier::new(self.outer).containment(&PosedPoint::new(&self.placement, Spot::At(corner)))
    }
}
