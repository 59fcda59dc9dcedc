//! Repairs a mesh on request: welds vertices within a tolerance, and turns faces so that neighbors
//! agree on their orientation.
//!
//! Nothing is removed and nothing is renumbered, so answers about the repaired mesh use the face
//! and vertex indices of the input.

mod closing;
mod orient;
mod weld;

use crate::input::{InputError, InputErrorKind};
use crate::mesh::Mesh;
use crate::mesh::derived::topology::Topology;
use crate::mesh::report::health::{degenerate_faces, duplicate_faces};
use orient::{Orientation, orientation};

/// Options of [`Mesh::repaired`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RepairOptions {
    /// Maximum distance by which a vertex may be moved to an earlier vertex, in the unit of the
    /// mesh. If it is zero, no vertex is moved.
    pub weld: f64,
    /// Whether faces are turned so that neighbors agree on their orientation.
    pub orient: bool,
}

/// Maximum distance by which vertices are welded to close a mesh, relative to its size. It is more
/// than the rounding of files with seven digits, and less than any detail that was modeled.
const MAX_CLOSING_WELD: f64 = 1e-6;

impl RepairOptions {
    /// Returns the options that close a mesh whose faces are only turned or cracked, or that leave
    /// fewer open edges: faces are turned, and vertices are welded by the
    /// [closing tolerance](Mesh::closing_tolerance) if that is at most 10^-6 of the largest extent
    /// of the mesh. No hole is filled.
    ///
    /// ```
    /// use impinge::mesh::RepairOptions;
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 2e-8, 1.0]];
    /// // One corner is not quite the same point in all of its faces, and the third face is turned.
    /// let mesh = Mesh::new(Positions::F64(corners), vec![[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 2, 4]])?;
    /// let options = RepairOptions::closing(&mesh);
    /// assert_eq!(options, RepairOptions { weld: 1e-7, orient: true });
    /// assert!(mesh.repaired(options)?.0.is_closed());
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    #[must_use]
    pub fn closing(mesh: &Mesh) -> Self {
        let [low, high] = mesh.local_bounds().unwrap_or_default();
        let size = (0..3).fold(0.0_f64, |size, axis| size.max(high[axis] - low[axis]));
        let weld = mesh.closing_tolerance().filter(|&tolerance| tolerance <= MAX_CLOSING_WELD * size);
        Self { weld: weld.unwrap_or(0.0), orient: true }
    }
}

/// The changes that [`Mesh::repaired`] made, and the defects that it left. All lists are ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repair {
    /// Indices of vertices that were moved to the position of an earlier vertex.
    pub welded_vertices: Vec<u32>,
    /// Maximum distance by which a vertex was moved, in the unit of the mesh, rounded. Zero if none
    /// was moved.
    pub greatest_move: f64,
    /// Indices of faces whose second and third corner were swapped.
    pub turned_faces: Vec<u32>,
    /// Indices of faces of sheets that cannot be oriented, such as a Möbius strip. The faces are
    /// unchanged.
    pub one_sided_faces: Vec<u32>,
    /// Indices of faces without area after the repair. The faces are not removed.
    pub degenerate_faces: Vec<u32>,
    /// Indices of faces with the same three points as an earlier face after the repair. The faces
    /// are not removed.
    pub duplicate_faces: Vec<u32>,
}

impl Mesh {
    /// Returns this mesh repaired, and a report of the changes.
    ///
    /// **Welding.** In ascending order each vertex is moved to the nearest earlier vertex that has
    /// stayed, if that is within the tolerance. So no vertex is moved farther than the tolerance,
    /// and vertices that have stayed are farther apart. Distances are rounded. Faces that become
    /// segments or points are reported and kept.
    ///
    /// **Orienting.** Two faces are linked if an edge belongs to exactly these two. Edges are
    /// matched by vertex indices first, and those left over by vertex positions. Linked faces form
    /// a sheet. All faces of a sheet get one orientation:
    /// 1. the orientation that at least three quarters of its area have already;
    /// 2. or else, if the sheet is closed, the orientation with which it encloses a positive
    ///    volume;
    /// 3. or else the orientation that most of its area has.
    ///
    /// If all closed sheets together then enclose a negative volume, all of them are turned. So
    /// cavities stay cavities, and a mesh that was inside out is corrected. Areas and volumes are
    /// rounded.
    ///
    /// ```
    /// use impinge::mesh::RepairOptions;
    /// use impinge::{Mesh, Positions};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 2, 3], [1, 2, 3]]; // the third is turned
    /// let mesh = Mesh::new(Positions::F32(corners), faces)?;
    /// let (repaired, repair) = mesh.repaired(RepairOptions { weld: 0.0, orient: true })?;
    /// assert_eq!(repair.turned_faces, [2]);
    /// assert!(repaired.is_closed() && !mesh.is_closed());
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Errors
    /// If the tolerance is negative, NaN or infinite.
    ///
    /// # Complexity
    /// O(n log n), and a build if something was changed.
    pub fn repaired(&self, options: RepairOptions) -> Result<(Self, Repair), InputError> {
        let RepairOptions { weld, orient } = options;
        if !weld.is_finite() {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "tolerance", index: 0 }));
        }
        if weld < 0.0 {
            return Err(InputError::new(InputErrorKind::Negative { what: "tolerance", index: 0 }));
        }
        let mut repair = Repair::default();
        let (mut positions, mut faces) = (None, None);
        if weld > 0.0 {
            let welded = weld::welded(self.positions(), weld);
            positions = (!welded.moved.is_empty()).then_some(welded.positions);
            (repair.welded_vertices, repair.greatest_move) = (welded.moved, welded.greatest_move);
        }
        if orient {
            let Orientation { turned, one_sided } = match &positions {
                Some(welded) => orientation(welded, self.faces(), &Topology::of(welded, self.faces()).first_at),
                None => orientation(self.positions(), self.faces(), &self.topology().first_at),
            };
            if !turned.is_empty() {
                let faces = faces.insert(self.faces().to_vec());
                turned.iter().for_each(|&face| faces[face as usize].swap(1, 2));
            }
            (repair.turned_faces, repair.one_sided_faces) = (turned, one_sided);
        }
        let mesh = if positions.is_none() && faces.is_none() {
            self.clone()
        } else {
            let positions = positions.unwrap_or_else(|| self.positions().clone());
            Self::new(positions, faces.unwrap_or_else(|| self.faces().to_vec()))?
        };
        repair.degenerate_faces = degenerate_faces(&mesh);
        repair.duplicate_faces = duplicate_faces(&mesh);
        Ok((mesh, repair))
    }

    /// Returns the smallest tolerance, in the unit of the mesh, at which [welding](Self::repaired)
    /// closes every open edge. The candidates are 10^-16, 10^-15, up to 10^-4 of the size of the
    /// mesh, where the size is its largest extent, rounded up to a power of ten. Returns `None` if
    /// no candidate closes all edges, if no edge is open, or if more than 131,072 edges are open.
    ///
    /// An edge is open if an odd number of faces have it.
    ///
    /// ```
    /// use impinge::{Mesh, Positions};
    ///
    /// // A tetrahedron, one corner of which is not quite the same point in all of its faces.
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 2e-7, 1.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4]];
    /// let mesh = Mesh::new(Positions::F64(corners), faces)?;
    /// assert_eq!(mesh.closing_tolerance(), Some(1e-6));
    /// # Ok::<(), impinge::InputError>(())
    /// ```
    ///
    /// # Complexity
    /// O(n log n).
    #[must_use]
    pub fn closing_tolerance(&self) -> Option<f64> {
        closing::closing_tolerance(self)
    }
}

#[cfg(test)]
mod tests;
