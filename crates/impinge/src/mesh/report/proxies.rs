//! The volumes that may replace a mesh: the convex hull and the bounding volumes of its surface,
//! made, stored and proved.
//!
//! Proof: docs/notes/proof.md, L27a. Guarded by `tests/it/hull/proxies.rs`.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::hull::Hull;
use crate::mesh::Mesh;
use crate::mesh::storage::leaf::CHUNK;
use crate::volume::{Proxies, ProxyFlaw};

impl Mesh {
    /// Returns the convex hull of the surface and the volumes fitted to it, in the mesh's own
    /// frame, or `None` for a mesh without faces. The [`vertices`](Hull::vertices) of the hull are
    /// indices of vertices of the mesh. Vertices that no face uses are ignored.
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
        // The only possible error is that there are no points: a mesh's coordinates are in range.
        let hull = Hull::new(&points).ok()?.renumbered(|at| numbers[at as usize]);
        Proxies::about(hull).ok()
    }

    /// Restores the proxies from the bytes of [`Proxies::to_bytes`].
    ///
    /// The bytes are trusted. If they are not the bytes of this mesh's proxies, queries of the hull
    /// and the volumes return wrong answers. The bytes are only checked so far that no query reads
    /// memory that is not theirs. [`validate_proxies`](Self::validate_proxies) checks the rest.
    ///
    /// # Errors
    /// Returns [`ProxyFlaw::Shape`] if the bytes do not fit together.
    ///
    /// # Complexity
    /// Linear in the bytes.
    pub fn proxies_from_bytes(&self, bytes: &[u8]) -> Result<Proxies, ProxyFlaw> {
        let vertices = &self.0.vertices;
        let count = vertices.slice().len();
        Proxies::from_bytes(bytes, |vertex| ((vertex as usize) < count).then(|| vertices.get(vertex as usize)))
    }

    /// Checks that the hull is the convex hull of this mesh's surface, exactly, and that each
    /// volume holds it. Not checked are the triangulation of facets, the choice among several
    /// vertices at a corner, and how tight the volumes are.
    ///
    /// # Errors
    /// Returns the first flaw that is found.
    ///
    /// # Complexity
    /// O(n log n), nearly linear in practice, on all cores of the current rayon pool. It takes
    /// about as long as making the proxies.
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

    /// Returns the indices of the vertices that faces use, in ascending order, and their positions.
    fn surface_points(&self) -> (Vec<u32>, Vec<[f64; 3]>) {
        let vertices = &self.0.vertices;
        let is_used: Vec<AtomicBool> = (0..vertices.slice().len()).map(|_| AtomicBool::new(false)).collect();
        self.faces().par_iter().with_min_len(CHUNK).flatten_iter().for_each(|&vertex| {
            // The end of the loop orders the stores.
            is_used[vertex as usize].store(true, Ordering::Relaxed);
        });
        let used = (0..is_used.len() as u32).filter(|&vertex| is_used[vertex as usize].load(Ordering::Relaxed));
        let numbers: Vec<u32> = used.collect();
        let points = numbers.par_iter().map(|&vertex| vertices.get(vertex as usize).map(|x| x + 0.0)).collect();
        (numbers, points)
    }
}
