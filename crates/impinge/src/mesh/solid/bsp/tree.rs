//! The planes and cells of a BSP tree, and the point queries.

use std::ops::Range;
use std::sync::OnceLock;

use super::plane::CutPlane;
use crate::exact::{PosedPoint, Spot, WidePlane};
use crate::input::InputError;
use crate::math::Sign;
use crate::mesh::Mesh;
use crate::mesh::solid::winding::{Containment, Judge};

/// Cells of space about a mesh, disjoint and convex, by a binary tree of planes.
///
/// For points and rays that are many and a mesh that stands still: a point costs a plane for each level, and an exact winding
/// number only where it is the first of its cell, on a plane, or in a cell that was not cut to the end.
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
    /// Corners of the box about all faces; of nothing where there are none.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Those of the faces.
    pub(super) planes: Vec<WidePlane>,
    /// The root first; none where there is one cell.
    pub(super) cuts: Vec<Cut>,
    pub(super) cells: Vec<Cell>,
    /// The lists of cuts and of cells.
    pub(super) faces: Vec<u32>,
    pub(super) depth: usize,
    /// Whether the mesh is, so that a cell without faces is inside or outside as a whole.
    pub(super) is_closed: bool,
}

/// A plane, and what rays are compared with there: of one across an axis the faces that lie in it as far as they come near, of the first
/// one of a face all faces that come near. Rays go no further than to that.
#[derive(Debug)]
pub(super) struct Cut {
    pub(super) plane: CutPlane,
    pub(super) faces: Range<u32>,
    pub(super) below: Child,
    pub(super) above: Child,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Child {
    Cut(u32),
    Cell(u32),
}

/// A cell that no plane cuts any more.
#[derive(Debug)]
pub(super) struct Cell {
    /// Those that may come into it.
    pub(super) faces: Range<u32>,
    /// Where all its points are, if no face comes into it.
    pub(super) label: OnceLock<Containment>,
}

impl SolidBsp {
    /// Where a point is to the mesh taken as a solid: the same as [`Mesh::contains`] says.
    ///
    /// # Errors
    /// A coordinate that is not finite, or not below 2^128 in magnitude.
    ///
    /// # Accuracy
    /// Exact for closed meshes (docs/proof.md, L32). Round an open mesh winding numbers are not constant in a cell, and every point
    /// is asked for by itself.
    pub fn contains(&self, point: [f64; 3]) -> Result<Containment, InputError> {
        InputError::judge_row(&point, "point", 0)?;
        let ask = || Judge::new(&self.mesh).containment(&PosedPoint::local(Spot::At(point)));
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

    /// How many cells there are.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// The most planes that a point is compared with.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Bytes that the tree takes, the mesh aside.
    #[must_use]
    pub fn memory(&self) -> usize {
        let lists = size_of_val(&self.cells[..]) + size_of_val(&self.faces[..]);
        size_of_val(&self.planes[..]) + size_of_val(&self.cuts[..]) + lists
    }

    pub(super) fn listed(&self, faces: &Range<u32>) -> &[u32] {
        &self.faces[faces.start as usize..faces.end as usize]
    }

    pub(super) fn root(&self) -> Child {
        if self.cuts.is_empty() { Child::Cell(0) } else { Child::Cut(0) }
    }
}
