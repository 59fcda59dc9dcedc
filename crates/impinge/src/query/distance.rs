//! How far apart two meshes are, and whether they keep a clearance.

use crate::mesh::{Options, Placed, WarmStart, nearest, within as near_faces};

/// How far apart two surfaces are, with what was proved about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// No two points of the surfaces are nearer to each other than this, in world units.
    pub lower: f64,
    /// Some two points are no farther apart than this: zero exactly where the surfaces intersect, infinite where one of
    /// them is empty.
    pub upper: f64,
    /// Where they are nearest; absent where one of them is empty.
    pub witness: Option<Witness>,
}

/// Nearest points of two surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// A point of the first mesh, in the world frame, rounded.
    pub point_a: [f64; 3],
    /// A point of the second mesh, in the world frame, rounded.
    pub point_b: [f64; 3],
    /// The face of the first mesh that the point is on.
    pub face_a: u32,
    /// The face of the second mesh that the point is on.
    pub face_b: u32,
}

impl Distance {
    /// The distance: [`upper`](Self::upper).
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.upper
    }
}

/// What the last question about two meshes found out; the caller keeps one for each two meshes.
///
/// It makes the next answer faster where they have moved little, and never another; where millions of pairs of faces are equally near,
/// perhaps another of the proved intervals. Mostly that is the two faces that were nearest.
/// Where a search takes milliseconds, as many places are as near as the nearest, such as where one mesh lies in the other, and they
/// move by less than a sixteenth of their distance from one question to the next, it is also where the search ended (some
/// megabytes, 17 at most), and what follows takes a thirtieth of the time. Other meshes, or one that was refitted, are no harm.
#[derive(Clone, Debug, Default)]
pub struct WitnessCache(WarmStart);

/// The distance of the surfaces of two meshes.
///
/// The nearest faces are those with the least distance by the closed form and, among equals, the least face of the first
/// mesh, then of the second. Where hundreds of faces tie on flat sides that face each other, they are two of those that tie. Where the
/// meshes intersect they are two faces that do, with a common point: those that
/// [`intersects`](super::intersects) comes to first, which how the hierarchies were built decides: to find the least of all
/// that do takes a thousand times as long.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let above = Pose::from_translation([0.0, 0.0, 2.0])?;
/// let distance = query::distance(&mesh, mesh.at(above));
/// assert!(distance.lower <= 2.0 && 2.0 <= distance.upper && distance.upper - distance.lower < 1e-12);
/// assert_eq!(query::distance(&mesh, &mesh).upper, 0.0);
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Accuracy
/// The true distance lies in `[lower, upper]`, whose width is at most 2^-44 of the diagonal of the box that holds both
/// meshes, most often 2^-45: how far they are from the origins of their frames and of the world does not count. For flat sides
/// that face each other it is a few units of the last place wide. The witnesses' coordinates are rounded once more, to the world's. Tested against rationals in `tests/it/distance`.
///
/// # Complexity
/// Logarithmic for meshes apart, and grows with the faces that are as near as the nearest. Flat sides that face each other take
/// one pass over the vertices instead. Meshes that intersect take as long as [`intersects`](super::intersects) does.
///
/// # Source
/// Larsen, Gottschalk, Lin, Manocha, *Fast proximity queries with swept sphere volumes*, ICRA 2000; ours differs in its
/// bounds, on boxes eight at a time and along the direction between the nearest points so far, and in that they are proved.
#[must_use]
pub fn distance<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> Distance {
    distance_with(a, b, &mut WitnessCache::default(), &Options::default())
}

/// [`distance`], run in a stated way, from where the meshes were nearest last.
#[must_use]
pub fn distance_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    cache: &mut WitnessCache,
    options: &Options<'_>,
) -> Distance {
    let Some(nearest) = nearest(a.into(), b.into(), &mut cache.0, options) else {
        return Distance { lower: f64::INFINITY, upper: f64::INFINITY, witness: None };
    };
    let ([point_a, point_b], [face_a, face_b]) = (nearest.points, nearest.faces);
    let witness = Some(Witness { point_a, point_b, face_a, face_b });
    Distance { lower: nearest.lower, upper: nearest.upper, witness }
}

/// Whether the surfaces of two meshes come within `clearance` of each other, in world units: closer than it or equal to it.
///
/// The answer is the truth about the real images of the triangles under the given maps, decided exactly. Nothing is within a
/// negative clearance, or one that is not a number, and an empty mesh is within none.
///
/// ```
/// use impinge::{Mesh, Pose, Positions, query};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let above = mesh.at(Pose::from_translation([0.0, 0.0, 0.1])?);
/// assert!(query::within(&mesh, above, 0.1));
/// assert!(!query::within(&mesh, above, 0.1_f64.next_down()));
/// # Ok::<(), impinge::InputError>(())
/// ```
///
/// # Complexity
/// Stops at the first pair of faces that is within the clearance. Where none is, pairs of faces whose distance is the clearance to the
/// last digits take about a microsecond each, and flat sides that face each other take one pass over the faces.
#[must_use]
pub fn within<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>, clearance: f64) -> bool {
    within_with(a, b, clearance, &mut WitnessCache::default(), &Options::default())
}

/// [`within`], run in a stated way, from where the meshes were near last.
#[must_use]
pub fn within_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    clearance: f64,
    cache: &mut WitnessCache,
    options: &Options<'_>,
) -> bool {
    near_faces(a.into(), b.into(), clearance, &mut cache.0, options).is_some()
}
