//! Whether a solid is its convex hull, exactly.
//!
//! Tests: `tests/it/solids/convexity.rs`. Benchmark: `bench/doors.py`.

use std::collections::{HashMap, HashSet};

use super::winding::Containment;
use crate::exact::orient3d;
use crate::hull::{Hull, HullKind};
use crate::math::Sign;
use crate::mesh::Mesh;

/// Maximum number of comparisons of a face with a facet of the hull. They take up to 10
/// milliseconds. With fewer, meshes with many coplanar faces would not be recognized.
const MAX_COMPARISONS: usize = 1 << 18;

impl Mesh {
    /// Reports whether the solid of this mesh is a hull, exactly: the mesh is closed, its faces lie
    /// on the boundary of the hull, and its inside is that of the hull.
    ///
    /// `hull` must be the convex hull of the corners of the faces, in the mesh frame. Returns
    /// `false` if this would take long to decide, because thousands of faces are coplanar with
    /// others.
    ///
    /// ```
    /// use impinge::hull::Hull;
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
    /// let hull = Hull::new(&corners)?;
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// assert!(Mesh::new(Positions::F64(corners.clone()), faces.clone())?.is_hull(&hull));
    /// assert!(!Mesh::new(Positions::F64(corners), faces[1..].to_vec())?.is_hull(&hull));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Complexity
    /// The time of [`contains`](Self::contains) for one point, and O(n) if each face is a triangle of
    /// the hull. Each other face is compared with all triangles of the hull.
    #[must_use]
    pub fn is_hull(&self, hull: &Hull) -> bool {
        hull.kind() == HullKind::Solid && self.is_closed() && self.lies_on(hull) && self.encloses_middle_of(hull)
    }

    /// Reports whether all faces lie on the boundary of their hull.
    fn lies_on(&self, hull: &Hull) -> bool {
        // Adding zero turns -0 into 0.
        let name = |corner: &[f64; 3]| corner.map(|x| (x + 0.0).to_bits());
        let vertices: HashMap<[u64; 3], u32> = hull.positions().iter().map(name).zip(0..).collect();
        let sorted = |mut corners: [u32; 3]| {
            corners.sort_unstable();
            corners
        };
        let triangles: HashSet<[u32; 3]> = hull.faces().iter().copied().map(sorted).collect();
        let mut comparisons = 0;
        (0..self.faces().len() as u32).all(|face| {
            let corners = self.corners(face);
            let [a, b, c] = corners.each_ref().map(|corner| vertices.get(&name(corner)).copied());
            if let (Some(a), Some(b), Some(c)) = (a, b, c)
                && triangles.contains(&sorted([a, b, c]))
            {
                return true;
            }
            comparisons += hull.faces().len();
            comparisons <= MAX_COMPARISONS
                && hull.faces().iter().any(|triangle| {
                    let [p, q, r] = triangle.map(|vertex| &hull.positions()[vertex as usize]);
                    corners.iter().all(|corner| orient3d(p, q, r, corner) == Sign::Zero)
                })
        })
    }

    /// Reports whether a point inside the hull is inside this mesh. If all faces lie on the
    /// boundary of the hull, then all such points are.
    fn encloses_middle_of(&self, hull: &Hull) -> bool {
        let count = hull.positions().len() as f64;
        let middle = |k: usize| hull.positions().iter().map(|position| position[k] / count).sum();
        let at: [f64; 3] = std::array::from_fn(middle);
        self.contains(&[at]).is_ok_and(|found| found == [Containment::Inside])
    }
}
