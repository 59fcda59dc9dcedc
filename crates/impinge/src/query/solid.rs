//! Meshes taken as solids: what lies wholly inside meets too.
//!
//! Where the surfaces are apart, a connected component of one lies in one region of what the other leaves of space, so
//! one of its points tells for all of it.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::distance::{Distance, WitnessCache, distance_with, within_with};
use super::shapes::Proximity;
use super::{HitCache, intersecting_pairs, intersects_with};
use crate::exact::{Placement, PosedPoint, Spot};
use crate::mesh::{Components, Containment, Judge, Mesh, Options, Placed};

/// Which of two meshes are solid: not their surface alone, but all about which they wind more than half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Solid {
    /// Both are surfaces.
    #[default]
    Neither,
    /// The first mesh.
    A,
    /// The second mesh.
    B,
    /// Each of them.
    Both,
}

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

/// How two meshes meet, one or both of them solid.
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

impl Solid {
    /// Whether each of the two is solid.
    #[must_use]
    pub fn sides(self) -> [bool; 2] {
        [matches!(self, Self::A | Self::Both), matches!(self, Self::B | Self::Both)]
    }
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

/// Whether two meshes, one or both of them solid, have a point in common; touching counts.
///
/// # Accuracy
/// Exact where the solid meshes are closed; where one is open, as sure as [`SolidIntersection`] says.
///
/// # Complexity
/// That of [`intersects`](super::intersects), then for each connected component of either mesh that of
/// [`Mesh::contains`] for one point; O(n log n) the first time that a mesh is asked.
///
/// ```
/// use impinge::query::{self, Solid};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let large = Mesh::new(Positions::F32(corners), faces)?;
/// let inside = large.at(Pose::new([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]], [1.0; 3])?);
/// assert!(!query::intersects(&large, inside));
/// assert!(query::intersects_solid(&large, inside, Solid::A));
/// assert!(!query::intersects_solid(&large, inside, Solid::B));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn intersects_solid<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, solid: Solid) -> bool {
    intersects_solid_with(a, b, solid, &mut HitCache::default(), &Options::default())
}

/// [`intersects_solid`], run in a stated way, with the faces that met last.
#[must_use]
pub fn intersects_solid_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    solid: Solid,
    cache: &mut HitCache,
    options: &Options<'_>,
) -> bool {
    let (a, b) = (a.into(), b.into());
    intersects_with(a, b, cache, options) || nested(a, b, solid) != Proximity::Apart
}

/// How two meshes, one or both of them solid, meet, and which has a component inside the other.
///
/// # Accuracy
/// As [`intersects_solid`].
///
/// # Complexity
/// That of [`intersecting_pairs`], and as [`intersects_solid`].
#[must_use]
pub fn solid_intersection<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    solid: Solid,
) -> SolidIntersection {
    let (a, b) = (a.into(), b.into());
    solid_intersection_of_pairs(a, b, solid, &intersecting_pairs(a, b))
}

/// [`solid_intersection`], for pairs that are at hand already: all that [`intersecting_pairs`] returned.
///
/// # Panics
/// Where a pair names a face that a mesh does not have.
#[must_use]
pub fn solid_intersection_of_pairs<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    solid: Solid,
    pairs: &[[u32; 2]],
) -> SolidIntersection {
    let placed = [a.into(), b.into()];
    let outer_is_solid = solid.sides();
    let mut inside = [false; 2];
    let mut undecided = false;
    let mut open = [false; 2];
    for inner in 0..2 {
        let outer = 1 - inner;
        if !outer_is_solid[outer] {
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

/// The distance of two meshes, one or both of them solid: zero exactly where [`intersects_solid`] is true, else that of the surfaces.
///
/// Where one is inside the other there is no witness. So it is where that is not proved but counts as so, for an open mesh.
///
/// # Accuracy
/// As [`distance`](super::distance()), and as [`intersects_solid`].
///
/// # Complexity
/// That of [`distance`](super::distance()), and as [`intersects_solid`].
///
/// ```
/// use impinge::query::{self, Solid};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let large = Mesh::new(Positions::F32(corners), faces)?;
/// let inside = large.at(Pose::new([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]], [1.0; 3])?);
/// assert_eq!(query::distance_of_solids(&large, inside, Solid::A).upper, 0.0);
/// assert_eq!(query::distance_of_solids(&large, inside, Solid::B), query::distance(&large, inside));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn distance_of_solids<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, solid: Solid) -> Distance {
    distance_of_solids_with(a, b, solid, &mut WitnessCache::default(), &Options::default())
}

/// [`distance_of_solids`], run in a stated way, from where the surfaces were nearest last.
#[must_use]
pub fn distance_of_solids_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    solid: Solid,
    cache: &mut WitnessCache,
    options: &Options<'_>,
) -> Distance {
    let (a, b) = (a.into(), b.into());
    let of_surfaces = distance_with(a, b, cache, options);
    if of_surfaces.upper > 0.0 && nested(a, b, solid) != Proximity::Apart {
        return Distance { lower: 0.0, upper: 0.0, witness: None };
    }
    of_surfaces
}

/// Whether two meshes, one or both of them solid, come within `clearance` of each other: what is inside a solid is within any that
/// is not negative.
///
/// # Accuracy
/// As [`within`](super::within), and as [`intersects_solid`].
///
/// # Complexity
/// That of [`within`](super::within), and as [`intersects_solid`] where the surfaces keep the clearance.
///
/// ```
/// use impinge::query::{self, Solid};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let large = Mesh::new(Positions::F32(corners), faces)?;
/// let inside = large.at(Pose::new([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]], [1.0; 3])?);
/// assert!(query::within_of_solids(&large, inside, 0.5, Solid::A));
/// assert!(!query::within_of_solids(&large, inside, 0.5, Solid::B));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn within_of_solids<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    clearance: f64,
    solid: Solid,
) -> bool {
    within_of_solids_with(a, b, clearance, solid, &mut WitnessCache::default(), &Options::default())
}

/// [`within_of_solids`], run in a stated way, from where the surfaces were near last.
#[must_use]
pub fn within_of_solids_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    clearance: f64,
    solid: Solid,
    cache: &mut WitnessCache,
    options: &Options<'_>,
) -> bool {
    let (a, b) = (a.into(), b.into());
    within_with(a, b, clearance, cache, options) || (clearance >= 0.0 && nested(a, b, solid) != Proximity::Apart)
}

/// Whether a component of one of two meshes lies inside the other, a solid, where their surfaces are apart: what
/// [`intersects_solid`], [`distance_of_solids`] and [`within_of_solids`] ask then. Undecided where none does for certain, and one
/// may lie inside an open mesh.
///
/// # Accuracy
/// As [`intersects_solid`].
#[must_use]
pub fn nested<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, solid: Solid) -> Proximity {
    let (a, b) = (a.into(), b.into());
    let [solid_a, solid_b] = solid.sides();
    let is_open = AtomicBool::new(false);
    let any = |inner: Placed<'_>, outer: Placed<'_>| {
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
    if (solid_b && any(a, b)) || (solid_a && any(b, a)) {
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
    fn of(inner: Placed<'m>, outer: Placed<'m>) -> Self {
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
