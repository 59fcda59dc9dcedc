//! What may stand for a mesh: the convex hull and the bounding volumes of its surface, made, stored and proved.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::hull::Hull;
use crate::mesh::Mesh;
use crate::mesh::storage::leaf::CHUNK;
use crate::volume::{Proxies, ProxyFlaw};

impl Mesh {
    /// The convex hull of the surface, whose vertices have the numbers of the mesh's, and the volumes fitted to it; none for
    /// a mesh without faces. Vertices that no face has do not count.
    ///
    /// ```
    /// use impinge::{Mesh, Positions, hull::HullKind};
    ///
    /// let corners = vec![[9.0, 9.0, 9.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let proxies = Mesh::new(Positions::F32(corners), vec![[1, 2, 3]])?.proxies().expect("a face");
    /// assert_eq!((proxies.hull().kind(), proxies.hull().vertices()), (HullKind::Polygon, &[1, 2, 3][..]));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Complexity
    /// As [`Proxies::of_points`].
    #[must_use]
    pub fn proxies(&self) -> Option<Proxies> {
        let (numbers, points) = self.surface_points();
        // There is no error but that of no points: a mesh is in range.
        let hull = Hull::new(&points).ok()?.renumbered(|at| numbers[at as usize]);
        Proxies::about(hull).ok()
    }

    /// The proxies that [`Proxies::to_bytes`] made bytes of.
    ///
    /// The bytes are believed: where they are not those of this mesh's proxies, what the hull and the volumes answer is wrong.
    /// They are looked at as far as no question needs memory that is not theirs. [`validate_proxies`](Self::validate_proxies)
    /// removes all doubt.
    ///
    /// # Errors
    /// [`ProxyFlaw::Shape`].
    ///
    /// # Complexity
    /// Linear in the bytes.
    pub fn proxies_from_bytes(&self, bytes: &[u8]) -> Result<Proxies, ProxyFlaw> {
        let vertices = &self.0.vertices;
        let count = vertices.slice().len();
        Proxies::from_bytes(bytes, |vertex| ((vertex as usize) < count).then(|| vertices.get(vertex as usize)))
    }

    /// Whether the hull is the convex hull of this mesh's surface, exactly, and each volume holds it. How facets are cut into
    /// triangles, which of several vertices at a corner is named and how tight the volumes are is not proved.
    ///
    /// # Errors
    /// What is wrong first.
    ///
    /// # Complexity
    /// O(n log n), nearly linear in effect, on all cores of the current rayon pool; about what making them takes.
    pub fn validate_proxies(&self, proxies: &Proxies) -> Result<(), ProxyFlaw> {
        let (numbers, points) = self.surface_points();
        let hull = proxies.hull();
        let mut is_corner = vec![false; numbers.len()];
        for (vertex, own) in hull.vertices().iter().zip(hull.positions()) {
            match numbers.binary_search(vertex) {
                Ok(at) if points[at] == *own => is_corner[at] = true,
                _ => return Err(ProxyFlaw::Shape),
            }
        }
        let others: Vec<[f64; 3]> =
            points.iter().zip(&is_corner).filter(|(_, is)| !**is).map(|(&point, _)| point).collect();
        proxies.validate(&others)
    }

    /// The vertices that faces have, with their numbers, ascending.
    fn surface_points(&self) -> (Vec<u32>, Vec<[f64; 3]>) {
        let vertices = &self.0.vertices;
        let is_used: Vec<AtomicBool> = (0..vertices.slice().len()).map(|_| AtomicBool::new(false)).collect();
        self.faces().par_iter().with_min_len(CHUNK).flatten_iter().for_each(|&vertex| {
            // Ordered by the end of the loop.
            is_used[vertex as usize].store(true, Ordering::Relaxed);
        });
        let used = (0..is_used.len() as u32).filter(|&vertex| is_used[vertex as usize].load(Ordering::Relaxed));
        let numbers: Vec<u32> = used.collect();
        let points = numbers.par_iter().map(|&vertex| vertices.get(vertex as usize).map(|x| x + 0.0)).collect();
        (numbers, points)
    }
}
