//! The volume of the material that two solids share.
//!
//! The common part of both boxes is cut by the planes of faces, until no face divides a cell. Then
//! the cell lies wholly in or out of each solid, up to the rounding of its sides, and the center
//! tells which. The largest cells are cut first, and those that are left widen the interval. For
//! solids with flat sides that is a binary space partition (Thibault and Naylor, *Set Operations on
//! Polyhedra Using Binary Space Partitioning Trees*, SIGGRAPH 1987), limited to the common box.
//!
//! Guarded by `tests/it/clash/volumes.rs`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::cell::Cell;
use super::divide::middle;
use super::face::{gap, largest_in};
use super::side::Side;
use crate::budget::Budget;
use crate::math::vec3::Vector;
use crate::mesh::Containment;

/// Maximum number of cells.
const MAX_CELLS: usize = 1 << 13;

/// Volume of the material that two solids share, as an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonVolume {
    /// Lower bound of the volume, in cubed world units.
    pub lower: f64,
    /// Upper bound of the volume.
    pub upper: f64,
    /// Whether the bounds are proved, up to the rounding of volumes. They are not if a solid is
    /// open.
    pub is_proved: bool,
}

impl CommonVolume {
    /// The volume of two solids without common material.
    pub(super) const NONE: Self = Self { lower: 0.0, upper: 0.0, is_proved: true };
}

/// A cell that faces may divide.
struct Part {
    volume: f64,
    number: usize,
    cell: Cell,
    /// The faces of each solid that reach the cell.
    touching: [Vec<u32>; 2],
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    /// Compares by volume. Of equal volumes, that of the cell that was added first is greater.
    fn cmp(&self, other: &Self) -> Ordering {
        self.volume.total_cmp(&other.volume).then(other.number.cmp(&self.number))
    }
}

/// Returns bounds of the volume of the points of a box that are in both solids. `slack` bounds the
/// rounding errors of coordinates.
pub(super) fn common_volume(sides: &[Side<'_>; 2], bounds: &[Vector; 2], slack: f64, budget: &Budget<'_>) -> [f64; 2] {
    let cell = Cell::cuboid(bounds);
    let touching = [0, 1].map(|side: usize| (0..sides[side].faces.len() as u32).collect());
    let mut heap = BinaryHeap::from([Part { volume: cell.volume(), number: 0, cell, touching }]);
    let (mut inside, mut error, mut count) = (0.0, 0.0, 1);
    while let Some(part) = heap.pop() {
        if count > MAX_CELLS || budget.is_spent() {
            heap.push(part);
            break;
        }
        let dividing = [0, 1].map(|side| {
            let faces = part.touching[side].iter().map(|&face| &sides[side].faces[face as usize]);
            faces.filter(|face| face.divides(&part.cell, slack)).collect::<Vec<_>>()
        });
        let Some(side) = (0..2).filter(|&side| !dividing[side].is_empty()).min_by_key(|&side| dividing[side].len())
        else {
            let center = part.cell.center();
            let places = sides.each_ref().map(|side| side.containment(&center));
            if places.contains(&Containment::Undecided) {
                error += part.volume;
            } else if !places.contains(&Containment::Outside) {
                inside += part.volume;
            }
            // Faces within rounding of the sides of the cell do not divide it.
            error += 8.0 * slack * part.cell.surface();
            continue;
        };
        // Outside of one solid, faces of the other do not matter.
        let other = 1 - side;
        if dividing[other].is_empty() && sides[other].containment(&part.cell.center()) == Containment::Outside {
            error += 8.0 * slack * part.cell.surface();
            continue;
        }
        let faces = dividing[side].iter().map(|face| (*face, *face));
        let plane = largest_in(&part.cell, faces, slack).and_then(|(face, _)| face.plane());
        let plane = plane.unwrap_or_else(|| middle(&part.cell));
        let halves = part.cell.cut(&plane, slack).or_else(|| part.cell.cut(&middle(&part.cell), slack));
        let Some([Some(below), Some(above)]) = halves else {
            error += part.volume;
            continue;
        };
        for cell in [below, above] {
            count += 1;
            let grown = cell.bounds_grown(slack);
            let touching = [0, 1].map(|side: usize| {
                let reaches = |&&face: &&u32| {
                    let face = &sides[side].faces[face as usize];
                    gap(&face.bounds, &grown) <= 0.0 && face.reaches(&cell, slack)
                };
                part.touching[side].iter().filter(reaches).copied().collect()
            });
            heap.push(Part { volume: cell.volume(), number: count, cell, touching });
        }
    }
    let left: f64 = heap.iter().map(|part| part.volume).sum();
    [(inside - error).max(0.0), inside + left + error]
}
