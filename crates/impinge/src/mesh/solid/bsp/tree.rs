//! The planes and cells of a BSP tree, and the point queries.

use std::ops::Range;
use std::sync::OnceLock;

use super::plane::CutPlane;
use crate::exact::{PosedPoint, Spot, WidePlane};
use crate::input::InputError;
use crate::math::Sign;
use crate::mesh::Mesh;
use crate::mesh::solid::winding::{Containment, PointClassifier};

/// A binary tree of planes that divides space around a mesh into disjoint convex cells.
///
/// It answers [`contains`](Self::contains) and [`ray_cast`](Self::ray_cast) for many points and
/// rays against a mesh that does not change. A point costs a comparison with one plane for each
/// level. It costs an exact winding number only if it is the first point of its cell, on a plane,
/// or in a cell that still has faces.
///
/// ```
/// use impinge::mesh::{Containment, SolidBsp};
/// use impinge::{Mesh, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let tree = SolidBsp::build(&mesh);
/// assert_eq!(tree.contains([0.1; 3])?, Containment::Inside);
/// assert_eq!(tree.contains([0.5, 0.5, 0.0])?, Containment::Surface);
/// assert_eq!(tree.contains([0.5; 3])?, Containment::Outside);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Debug)]
pub struct SolidBsp {
    pub(super) mesh: Mesh,
    /// Minimum corner of the box of all faces. Infinity if there are no faces.
    pub(super) low: [f64; 3],
    /// Maximum corner of the box of all faces. Negative infinity if there are no faces.
    pub(super) high: [f64; 3],
    /// The planes of the faces.
    pub(super) planes: Vec<WidePlane>,
    /// The cuts, the root first. Empty if there is only one cell.
    pub(super) cuts: Vec<Cut>,
    pub(super) cells: Vec<Cell>,
    /// The faces of cuts and cells, list after list.
    pub(super) faces: Vec<u32>,
    /// Maximum number of cuts on the way to a cell.
    pub(super) depth: usize,
    /// Whether the mesh is closed. Then a cell without faces is inside or outside as a whole.
    pub(super) is_closed: bool,
}

/// A plane, and the faces that are compared with a ray there. At an axis-aligned plane these are
/// the faces of its cell that lie in the plane. At the first plane of a face these are all faces of
/// its cell, and rays do not descend further.
#[derive(Debug)]
pub(super) struct Cut {
    pub(super) plane: CutPlane,
    pub(super) faces: Range<u32>,
    pub(super) below: Child,
    pub(super) above: Child,
}

/// Index of a child: another cut or a cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Child {
    Cut(u32),
    Cell(u32),
}

/// A cell that no plane cuts.
#[derive(Debug)]
pub(super) struct Cell {
    /// The faces that may reach into the cell.
    pub(super) faces: Range<u32>,
    /// The containment of all points of the cell if it has no faces.
    pub(super) label: OnceLock<Containment>,
}

impl SolidBsp {
    /// Returns the position of a point, given in the mesh's own frame, relative to the mesh taken
    /// as a solid. The result is the same as that of [`Mesh::contains`].
    ///
    /// # Errors
    /// Returns an error if a coordinate is not finite, or above 2^300 in magnitude.
    ///
    /// # Accuracy
    /// Exact for closed meshes (docs/notes/proof.md, L32). Around an open mesh the winding number
    /// is not constant in a cell, so it is computed for each point.
    pub fn contains(&self, point: [f64; 3]) -> Result<Containment, InputError> {
        InputError::validate_row(&point, "point", 0)?;
        let ask = || PointClassifier::new(&self.mesh).containment(&PosedPoint::local(Spot::At(point)));
        if !self.is_closed {
            return Ok(ask());
        }
        if (0..3).any(|axis| point[axis] < self.low[axis] || self.high[axis] < point[axis]) {
            return Ok(Containment::Outside);
        }
        let mut at = self.root();
        let cell = loop {
            match at {
                Child::Cell(cell) => break &self.cells[cell as usize],
                Child::Cut(cut) => {
                    let Cut { plane, below, above, .. } = &self.cuts[cut as usize];
                    at = match plane.side(&self.mesh, &self.planes, &point) {
                        Sign::Negative => *below,
                        Sign::Positive => *above,
                        Sign::Zero => return Ok(ask()),
                    };
                }
            }
        };
        Ok(if cell.faces.is_empty() { *cell.label.get_or_init(ask) } else { ask() })
    }

    /// Returns the number of cells, the leaves of the tree.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// Returns the maximum number of planes that a point is compared with.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Returns the size of the tree in bytes, without the mesh.
    #[must_use]
    pub fn memory(&self) -> usize {
        let lists = size_of_val(&self.cells[..]) + size_of_val(&self.faces[..]);
        size_of_val(&self.planes[..]) + size_of_val(&self.cuts[..]) + lists
    }

    /// Returns the faces of a cut or a cell.
    pub(super) fn listed(&self, faces: &Range<u32>) -> &[u32] {
        &self.faces[faces.start as usize..faces.end as usize]
    }

    /// Returns the root of the tree.
    pub(super) fn root(&self) -> Child {
        if self.cuts.is_empty() { Child::Cell(0) } else { Child::Cut(0) }
    }
}
