//! Moves vertices to earlier ones within a tolerance.
//!
//! Space is divided into cells whose edge is the tolerance. Vertices that stay are farther apart
//! than that, so a cell and its neighbors contain a bounded number of them.

use std::collections::HashMap;

use crate::math::vec3::{length, scaled_length, sub};
use crate::mesh::Positions;

/// Positions after welding.
pub(super) struct Welded {
    pub(super) positions: Positions,
    /// The vertices that were moved, ascending.
    pub(super) moved: Vec<u32>,
    /// Maximum distance by which a vertex was moved, in the unit of the mesh.
    pub(super) greatest_move: f64,
}

/// Moves each vertex to the nearest earlier vertex that has stayed, if that is within the
/// tolerance.
pub(super) fn welded(positions: &Positions, tolerance: f64) -> Welded {
    let mut positions = positions.clone();
    let (mut moved, mut greatest_move) = (Vec::new(), 0.0_f64);
    let mut stayed = Stayed::new(tolerance);
    for vertex in 0..positions.len() as u32 {
        let at = positions.get(vertex as usize);
        let Some(target) = stayed.nearest_or_insert(vertex, at) else { continue };
        let move_by = scaled_length(&sub(&at, &positions.get(target as usize)));
        if move_by > 0.0 {
            match &mut positions {
                Positions::F32(vertices) => vertices[vertex as usize] = vertices[target as usize],
                Positions::F64(vertices) => vertices[vertex as usize] = vertices[target as usize],
            }
            moved.push(vertex);
            greatest_move = greatest_move.max(move_by);
        }
    }
    Welded { positions, moved, greatest_move }
}

/// Vertices that have stayed, by the cell that contains them.
pub(super) struct Stayed {
    tolerance: f64,
    cells: HashMap<[i64; 3], Vec<(u32, [f64; 3])>>,
}

impl Stayed {
    pub(super) fn new(tolerance: f64) -> Self {
        Self { tolerance, cells: HashMap::new() }
    }

    /// Returns the nearest vertex that has stayed, and the first of equally near ones. If none is
    /// within the tolerance, it adds this vertex to those that stay and returns `None`.
    pub(super) fn nearest_or_insert(&mut self, vertex: u32, at: [f64; 3]) -> Option<u32> {
        let places = at.map(|x| Place::of(x, self.tolerance));
        let mut nearest: Option<(f64, u32)> = None;
        for x in places[0].neighbors() {
            for y in places[1].neighbors() {
                for z in places[2].neighbors() {
                    for &(other, point) in self.cells.get(&[x, y, z]).into_iter().flatten() {
                        // The step is in units of the tolerance, so that no square underflows or
                        // overflows.
                        let step = [0, 1, 2].map(|k| (at[k] - point[k]) / self.tolerance);
                        let distance = length(&step);
                        if distance <= 1.0 && nearest.is_none_or(|found| (distance, other) < found) {
                            nearest = Some((distance, other));
                        }
                    }
                }
            }
        }
        if nearest.is_none() {
            self.cells.entry(places.map(Place::cell)).or_default().push((vertex, at));
        }
        nearest.map(|(_, other)| other)
    }
}

/// Position of a coordinate on the grid.
#[derive(Clone, Copy)]
enum Place {
    /// Number of the cell of the coordinate.
    Cell(i64),
    /// Bits of the coordinate, if neighboring floating-point numbers are farther apart than the
    /// tolerance.
    Alone(i64),
}

impl Place {
    /// Returns the position of a coordinate.
    fn of(x: f64, tolerance: f64) -> Self {
        /// Magnitude from which neighboring numbers differ by at least two cells.
        const SPARSE: f64 = (1_u64 << 54) as f64;
        let cell = (x / tolerance).floor();
        // Adding zero turns the negative zero into the positive one.
        if cell.abs() < SPARSE { Self::Cell(cell as i64) } else { Self::Alone((x + 0.0).to_bits().cast_signed()) }
    }

    /// Returns the cell as a key of the map.
    fn cell(self) -> i64 {
        match self {
            Self::Cell(cell) | Self::Alone(cell) => cell,
        }
    }

    /// Returns the cells that may contain a number within the tolerance.
    fn neighbors(self) -> std::ops::RangeInclusive<i64> {
        match self {
            Self::Cell(cell) => cell - 1..=cell + 1,
            Self::Alone(cell) => cell..=cell,
        }
    }
}
