//! Vertices with a coordinate that is NaN or infinite. A file may have them as long as no face uses
//! them: organized scans keep a row for each pixel without a depth.

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    model::{Faces, WarningKind},
};

/// The non-finite vertices of a file in ascending order, each with its line or byte offset.
#[derive(Default)]
pub(crate) struct NonFinite {
    found: Vec<(usize, u64)>,
}

impl NonFinite {
    /// Adds a vertex, whose index must exceed those added before; `at` is its line or its byte
    /// offset.
    #[cold]
    pub(crate) fn add(&mut self, vertex: usize, at: u64) {
        self.found.push((vertex, at));
    }

    /// Moves the non-finite vertices to the position of the first finite vertex, so that the bounds
    /// of the mesh do not change. If no vertex is finite, moves them to the origin.
    pub(crate) fn replace<T: Copy + Default>(&self, positions: &mut [[T; 3]]) {
        let finite =
            self.found.iter().enumerate().position(|(i, &(vertex, _))| i != vertex).unwrap_or(self.found.len());
        let stand_in = positions.get(finite).copied().unwrap_or_default();
        for &(vertex, _) in &self.found {
            positions[vertex] = stand_in;
        }
    }

    /// Adds the warning about non-finite vertices, if there are any. `place` converts a line or
    /// byte offset into a place.
    ///
    /// # Errors
    /// Returns an error if a face uses a non-finite vertex. The error names the first such vertex.
    pub(crate) fn check_unused(&self, faces: &mut Faces, place: impl Fn(u64) -> Place) -> Result<(), LoadError> {
        let (Some(&(_, first)), Some(&(last, _))) = (self.found.first(), self.found.last()) else { return Ok(()) };
        let mut is_non_finite = vec![false; last + 1];
        for &(vertex, _) in &self.found {
            is_non_finite[vertex] = true;
        }
        let corners = faces.faces.as_flattened().iter().map(|&i| i as usize);
        if let Some(used) = corners.filter(|&i| is_non_finite.get(i) == Some(&true)).min() {
            let at = self.found.partition_point(|&(vertex, _)| vertex < used);
            let error = LoadError::new(LoadErrorKind::NonFinite { vertex: used as u64 });
            return Err(error.at(place(self.found[at].1)));
        }
        faces.warnings.add(WarningKind::UnusedNonFinite, self.found.len() as u64, || Some(place(first)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn non_finite(vertices: &[usize]) -> NonFinite {
        let mut found = NonFinite::default();
        for &vertex in vertices {
            found.add(vertex, 10 + vertex as u64);
        }
        found
    }

    #[test]
    fn unused_vertices_take_the_position_of_the_first_finite_one() {
        for (vertices, expected) in [
            (&[][..], [1.0, 2.0, 3.0]),
            (&[0], [2.0, 2.0, 3.0]),
            (&[0, 1], [3.0, 3.0, 3.0]),
            (&[1], [1.0, 1.0, 3.0]),
            (&[0, 1, 2], [0.0; 3]),
        ] {
            let mut positions = [1.0, 2.0, 3.0].map(|x| [x; 3]);
            non_finite(vertices).replace(&mut positions);
            assert_eq!(positions, expected.map(|x| [x; 3]), "{vertices:?}");
        }
    }

    #[test]
    fn non_finite_vertices_that_faces_use_are_errors() {
        let faces = || {
            let mut faces = Faces::default();
            faces.triangle([4, 7, 5], 0).unwrap();
            faces
        };
        let mut unused = faces();
        non_finite(&[3, 6, 9]).check_unused(&mut unused, Place::Line).unwrap();
        let warning = &unused.warnings.into_vec()[0];
        assert_eq!((warning.kind, warning.count), (WarningKind::UnusedNonFinite, 3));
        assert_eq!(warning.first, Some(Place::Line(13)));
        let error = non_finite(&[0, 5, 7]).check_unused(&mut faces(), Place::Line).unwrap_err();
        assert_eq!(error.to_string(), "line 15: vertex 5 has a coordinate that is NaN, infinite or too large");
        let mut none = faces();
        non_finite(&[]).check_unused(&mut none, Place::Line).unwrap();
        assert!(none.warnings.into_vec().is_empty());
    }
}
