//! Whether two meshes intersect, with what was learnt of them last.

use super::Placed;
use crate::mesh::{self, Options};

/// Two faces that met when two meshes were last asked about; the caller keeps one for each two meshes.
///
/// They are asked first, which makes the next answer faster where meshes in contact have moved little, and never another. Each
/// time that they no longer meet it is twice as long until faces are tried again, up to 64 questions, so that poses that have
/// nothing to do with each other pay next to nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HitCache {
    faces: Option<[u32; 2]>,
    /// Tries in vain since the last that was not.
    failures: u32,
    /// Questions until the next try.
    rest: u32,
}

impl HitCache {
    /// The most failures that count: 2^6 questions.
    const MOST_FAILURES: u32 = 6;

    /// The faces to try now.
    fn faces_to_try(&mut self) -> Option<[u32; 2]> {
        if self.rest > 0 {
            self.rest -= 1;
            return None;
        }
        self.faces
    }

    fn learn(&mut self, tried_well: bool) {
        self.failures = if tried_well { 0 } else { (self.failures + 1).min(Self::MOST_FAILURES) };
        self.rest = (1 << self.failures) - 1;
    }
}

/// Whether the surfaces of two meshes have a point in common; touching counts.
///
/// The answer is the truth about the real images of the closed triangles under the given maps: no tolerance, no scale.
///
/// # Complexity
/// Stops at the first pair found: logarithmic where the meshes are deep in each other or well apart.
#[must_use]
pub fn intersects<'a, 'b>(a: impl Into<Placed<'a>>, b: impl Into<Placed<'b>>) -> bool {
    intersects_with(a, b, &mut HitCache::default(), &Options::default())
}

/// [`intersects`], run in a stated way, with the faces that met last.
///
/// ```
/// use impinge::mesh::Options;
/// use impinge::query::{HitCache, intersects_with};
/// use impinge::{Mesh, Pose, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let mut cache = HitCache::default();
/// for step in 0..8 {
///     let slid = mesh.at(Pose::from_translation([0.25 * f64::from(step), 0.0, 0.0])?);
///     assert_eq!(intersects_with(&mesh, slid, &mut cache, &Options::default()), step <= 4);
/// }
/// # Ok::<(), impinge::InputError>(())
/// ```
#[must_use]
pub fn intersects_with<'a, 'b>(
    a: impl Into<Placed<'a>>,
    b: impl Into<Placed<'b>>,
    cache: &mut HitCache,
    options: &Options<'_>,
) -> bool {
    let (a, b) = (a.into(), b.into());
    if let Some(faces) = cache.faces_to_try() {
        let is_hit = mesh::faces_meet(a, b, faces);
        cache.learn(is_hit);
        if is_hit {
            return true;
        }
    }
    let hit = mesh::any_hit(a, b, options);
    cache.faces = hit.or(cache.faces);
    hit.is_some()
}
