//! Corners with bitwise equal positions made one vertex, for STL, which has no vertices of its own.

use std::collections::HashMap;

use foldhash::fast::RandomState;

/// A coordinate with its bits as a key.
pub(crate) trait Coordinate: Copy {
    type Bits: Copy + Eq + std::hash::Hash;

    /// The bits, those of 0.0 for -0.0.
    fn bits(self) -> Self::Bits;
}

impl Coordinate for f32 {
    type Bits = u32;

    fn bits(self) -> u32 {
        (self + 0.0).to_bits()
    }
}

impl Coordinate for f64 {
    type Bits = u64;

    fn bits(self) -> u64 {
        (self + 0.0).to_bits()
    }
}

/// The vertices so far, numbered in the order in which they first came.
///
/// The hash is seeded at random, so that no file can be made to collide; the numbering does not depend on it.
pub(crate) struct Weld<T: Coordinate> {
    index: HashMap<[T::Bits; 3], u32, RandomState>,
    positions: Vec<[T; 3]>,
}

impl<T: Coordinate> Weld<T> {
    /// Expects about this many vertices.
    pub(crate) fn with_capacity(vertices: usize) -> Self {
        Self {
            index: HashMap::with_capacity_and_hasher(vertices, RandomState::default()),
            positions: Vec::with_capacity(vertices),
        }
    }

    /// The vertex at this position; none where there are more than 32 bits can number.
    pub(crate) fn vertex(&mut self, position: [T; 3]) -> Option<u32> {
        let next = u32::try_from(self.positions.len()).ok()?;
        let vertex = *self.index.entry(position.map(T::bits)).or_insert(next);
        if vertex == next {
            self.positions.push(position);
        }
        Some(vertex)
    }

    /// Returns the position of a vertex.
    pub(crate) fn position(&self, vertex: u32) -> [T; 3] {
        self.positions[vertex as usize]
    }

    pub(crate) fn into_positions(self) -> Vec<[T; 3]> {
        self.positions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_equal_and_neighbours_are_not() {
        let mut weld = Weld::with_capacity(0);
        let vertices = [[0.0_f32, 1.0, 2.0], [-0.0, 1.0, 2.0], [f32::from_bits(1), 1.0, 2.0], [0.0, 1.0, 2.0]]
            .map(|p| weld.vertex(p).unwrap());
        assert_eq!(vertices, [0, 0, 1, 0]);
        assert_eq!(weld.into_positions().len(), 2);
    }
}
