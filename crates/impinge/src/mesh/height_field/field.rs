//! A height field, and the triangles of its cells.

use std::sync::Arc;

use super::blocks::{Block, Blocks};
use crate::hierarchy::Child;
use crate::input::{InputError, InputErrorKind};
use crate::mesh::Mesh;

/// Maximum number of cells: 2^30, so that faces have numbers below 2^31.
const MAX_CELLS: usize = 1 << 30;

/// Coordinates must be below this magnitude, 2^128, as in a mesh.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// A grid of heights with the two triangles of each cell, in the frame of the field. Cloning it is
/// fast, because copies share their memory.
///
/// The point of row r and column c has x = c · `spacing[0]`, y = r · `spacing[1]`, each product
/// rounded, and its height as z. The cell of row r and column c lies between that point and the
/// one of row r + 1 and column c + 1. Its number is n = r · (`columns` - 1) + c. A diagonal from
/// the first of these points to the other divides it into face 2 n, on the side of larger x, and
/// face 2 n + 1. Both have their corners in counterclockwise order seen from above. Points are
/// numbered row by row.
///
/// The field is the surface of its faces. It has no inside: what is below it does not intersect it.
///
/// # Complexity
/// A field takes 4 bytes for each point, and the tree over the cells 0.15 bytes for each cell. If
/// there are holes, they take 1 bit for each cell.
///
/// ```
/// use impinge::{HeightField, Pose, Shape, query};
///
/// let hill = HeightField::new(3, 3, [1.0, 1.0], vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])?;
/// let terrain = Shape::height_field(&hill).at(Pose::IDENTITY)?;
/// let sphere = Shape::sphere([1.0, 1.0, 2.0], 1.0)?;
/// assert!(query::intersects(&terrain, sphere.at(Pose::IDENTITY)?)); // it touches the top
/// assert!(!query::intersects(&terrain, sphere.at(Pose::from_translation([0.0, 0.0, 0.25])?)?));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Debug)]
pub struct HeightField(Arc<Data>);

#[derive(Debug)]
struct Data {
    rows: u32,
    columns: u32,
    spacing: [f64; 2],
    heights: Vec<f32>,
    /// One bit for each cell, set for holes. Empty for a field without holes.
    holes: Vec<u64>,
    blocks: Blocks,
}

impl HeightField {
    /// Returns the field of some heights, row by row.
    ///
    /// # Errors
    /// [`Empty`](InputErrorKind::Empty) for fewer than two rows or columns,
    /// [`TooMany`](InputErrorKind::TooMany) for more than 2^30 cells,
    /// [`OtherCount`](InputErrorKind::OtherCount) if there is not one height for each point,
    /// [`NonFinite`](InputErrorKind::NonFinite) for a height or a spacing that is NaN or infinite,
    /// and [`OutOfRange`](InputErrorKind::OutOfRange) if a spacing is not above zero, or the field
    /// reaches 2^128.
    pub fn new(
        rows: usize,
        columns: usize,
        spacing: [f64; 2],
        heights: impl Into<Vec<f32>>,
    ) -> Result<Self, InputError> {
        Self::with_holes(rows, columns, spacing, heights, |_, _| false)
    }

    /// Returns the field of some heights, without the cells for which `is_hole` returns `true`,
    /// given their row and column. The faces of the other cells keep their numbers.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn with_holes(
        rows: usize,
        columns: usize,
        spacing: [f64; 2],
        heights: impl Into<Vec<f32>>,
        is_hole: impl Fn(usize, usize) -> bool,
    ) -> Result<Self, InputError> {
        let heights = heights.into();
        if rows < 2 || columns < 2 {
            return Err(InputError::new(InputErrorKind::Empty { what: "cells" }));
        }
        let cells = (rows - 1).saturating_mul(columns - 1);
        if cells > MAX_CELLS || rows.saturating_mul(columns) > 4 * MAX_CELLS {
            return Err(InputError::new(InputErrorKind::TooMany { what: "cells", count: cells, limit: MAX_CELLS }));
        }
        if heights.len() != rows * columns {
            let kind = InputErrorKind::OtherCount { what: "heights", count: heights.len(), expected: rows * columns };
            return Err(InputError::new(kind));
        }
        if let Some(index) = heights.iter().position(|height| !height.is_finite()) {
            return Err(InputError::new(InputErrorKind::NonFinite { what: "height", index }));
        }
        for (index, (step, count)) in spacing.into_iter().zip([columns, rows]).enumerate() {
            if !step.is_finite() {
                return Err(InputError::new(InputErrorKind::NonFinite { what: "spacing", index }));
            }
            if step <= 0.0 || step * (count - 1) as f64 >= LIMIT {
                let kind = InputErrorKind::OutOfRange { what: "spacing", index, limit: "2^128, and above zero" };
                return Err(InputError::new(kind));
            }
        }
        let mut holes = Vec::new();
        for cell in (0..cells).filter(|cell| is_hole(cell / (columns - 1), cell % (columns - 1))) {
            if holes.is_empty() {
                holes = vec![0; cells.div_ceil(64)];
            }
            holes[cell / 64] |= 1 << (cell % 64);
        }
        let (rows, columns) = (rows as u32, columns as u32);
        let mut data = Data { rows, columns, spacing, heights, holes, blocks: Blocks::default() };
        data.blocks = Blocks::over([rows - 1, columns - 1], |row, column| data.span(row, column));
        Ok(Self(Arc::new(data)))
    }

    /// Returns the number of rows of points.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.0.rows as usize
    }

    /// Returns the number of columns of points.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.0.columns as usize
    }

    /// Returns the distances of neighboring points along x and along y.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        self.0.spacing
    }

    /// Returns the heights, row by row.
    #[must_use]
    pub fn heights(&self) -> &[f32] {
        &self.0.heights
    }

    /// Returns the number of bytes of memory that the field takes. Copies share them.
    #[must_use]
    pub fn memory(&self) -> usize {
        size_of::<Data>() + size_of_val(&*self.0.heights) + size_of_val(&*self.0.holes) + self.0.blocks.memory()
    }

    /// Returns the corners of a face, or `None` if there is no such face or its cell is a hole.
    #[must_use]
    pub fn face(&self, face: u32) -> Option<[[f64; 3]; 3]> {
        let cell = face / 2;
        (cell < self.cells() && !self.0.is_hole(cell)).then(|| self.corners(face))
    }

    fn cells(&self) -> u32 {
        (self.0.rows - 1) * (self.0.columns - 1)
    }

    /// Returns the corners of a face, which must exist.
    pub(in crate::mesh) fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.vertices(face).map(|vertex| self.position(vertex))
    }

    /// Returns the numbers of the points at the corners of a face, which must exist.
    pub(in crate::mesh) fn vertices(&self, face: u32) -> [u32; 3] {
        let columns = self.0.columns;
        let (row, column) = (face / 2 / (columns - 1), face / 2 % (columns - 1));
        let first = row * columns + column;
        let last = first + columns + 1;
        if face.is_multiple_of(2) { [first, first + 1, last] } else { [first, last, last - 1] }
    }

    /// Returns a point by its number.
    pub(in crate::mesh) fn position(&self, vertex: u32) -> [f64; 3] {
        let (row, column) = (vertex / self.0.columns, vertex % self.0.columns);
        let [x, y] = self.0.spacing;
        [f64::from(column) * x, f64::from(row) * y, f64::from(self.0.heights[vertex as usize])]
    }
}

impl Data {
    fn is_hole(&self, cell: u32) -> bool {
        self.holes.get(cell as usize / 64).is_some_and(|word| word >> (cell % 64) & 1 == 1)
    }

    /// Returns the least and the greatest height of a cell, or `None` for a hole.
    fn span(&self, row: u32, column: u32) -> Option<[f32; 2]> {
        if self.is_hole(row * (self.columns - 1) + column) {
            return None;
        }
        let first = (row * self.columns + column) as usize;
        let next = first + self.columns as usize;
        let heights = [first, first + 1, next, next + 1].map(|vertex| self.heights[vertex]);
        let least = heights.into_iter().fold(f32::INFINITY, f32::min);
        Some([least, heights.into_iter().fold(f32::NEG_INFINITY, f32::max)])
    }
}

impl HeightField {
    /// Returns the mesh of the same triangles in the same frame, for queries that only meshes
    /// answer. It has the points of all rows, and the faces of all cells that are not holes.
    ///
    /// # Errors
    /// [`OutOfMemory`](InputErrorKind::OutOfMemory) if the mesh is too large.
    pub fn to_mesh(&self) -> Result<Mesh, InputError> {
        let positions: Vec<[f64; 3]> = (0..self.0.heights.len() as u32).map(|vertex| self.position(vertex)).collect();
        let cells = (0..self.cells()).filter(|&cell| !self.0.is_hole(cell));
        let faces: Vec<[u32; 3]> =
            cells.flat_map(|cell| [2 * cell, 2 * cell + 1]).map(|face| self.vertices(face)).collect();
        Mesh::new(positions, faces)
    }
}

/// The tree of blocks over the cells.
impl HeightField {
    /// Returns the least and the greatest corner of a box that holds the field, or `None` if all
    /// cells are holes.
    pub(crate) fn local_bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.corners_of_box(self.0.blocks.whole())
    }

    /// Returns the children of a block, each with the least and the greatest corner of its box:
    /// blocks, or cells as leaves. Block 0 is the whole field. Children without faces are left out.
    pub(in crate::mesh) fn boxes(&self, block: u32) -> Vec<(Child, [[f64; 3]; 2])> {
        let columns = self.0.columns - 1;
        let boxed = |(child, block): (Child, Block)| Some((child, self.corners_of_box(block)?));
        if let Some(children) = self.0.blocks.children(block) {
            return children.into_iter().filter_map(boxed).collect();
        }
        let [rows, across] = self.0.blocks.cells(block);
        let cells = rows.flat_map(|row| across.clone().map(move |column| [row, column]));
        let cell = |place: [u32; 2]| {
            let span = self.0.span(place[0], place[1])?;
            boxed((Child::Leaf(place[0] * columns + place[1]), Block { place, side: 0, span }))
        };
        cells.filter_map(cell).collect()
    }

    /// Returns the corners of the box of a block. They are the coordinates of points, without
    /// rounding.
    fn corners_of_box(&self, Block { place, side, span }: Block) -> Option<[[f64; 3]; 2]> {
        if span[0] > span[1] {
            return None;
        }
        let counts = [self.0.rows - 1, self.0.columns - 1];
        let end = |axis: usize, after: u32| f64::from(((place[axis] + after) << side).min(counts[axis]));
        let corner = |after: u32, height: f32| {
            [end(1, after) * self.0.spacing[0], end(0, after) * self.0.spacing[1], f64::from(height)]
        };
        Some([corner(0, span[0]), corner(1, span[1])])
    }
}
