//! Welds corners with bitwise equal positions, for STL, which has no vertices of its own.

use std::collections::HashMap;

use foldhash::fast::RandomState;

/// A coordinate whose bits are a hash key.
pub(crate) trait Coordinate: Copy {
    type Bits: Copy + Eq + std::hash::Hash;

    /// Returns the bits; -0.0 has the bits of 0.0.
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

/// The vertices so far, numbered in the order in which they were first added.
///
/// The hash is seeded at random, so that no file can be made to cause collisions. The numbering
/// does not depend on the seed.
pub(crate) struct Weld<T: Coordinate> {
    index: HashMap<[T::Bits; 3], u32, RandomState>,
    positions: Vec<[T; 3]>,
}

impl<T: Coordinate> Weld<T> {
    /// Reserves memory for `vertices` vertices.
    pub(crate) fn with_capacity(vertices: usize) -> Self {
        Self {
            index: HashMap::with_capacity_and_hasher(vertices, RandomState::default()),
            positions: Vec::with_capacity(vertices),
        }
    }

    /// Returns the vertex at this position, and adds it if it is new. Returns `None` if there are
    /// more vertices than 32-bit indices can address.
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
    fn zeros_are_welded_and_adjacent_floats_are_not() {
        let mut weld = Weld::with_capacity(0);
        let vertices = [[0.0_f32, 1.0, 2.0], [-0.0, 1.0, 2.0], [f32::from_bits(1), 1.0, 2.0], [0.0, 1.0, 2.0]]
            .map(|p| weld.vertex(p).unwrap());
        assert_eq!(vertices, [0, 0, 1, 0]);
        assert_eq!(weld.into_positions().len(), 2);
    }
}
