//! Maps cells to places in memory.

/// Binary logarithm of the number of hashed cells along each edge of a page. The cells of a page
/// are contiguous in memory and fill one page of memory, so that a moving box touches one or two
/// pages.
const PAGE_EDGE_BITS: u32 = 2;

/// Minimum number of places for hashed cells: one page.
pub(super) const MIN_PLACES: usize = 1 << (3 * PAGE_EDGE_BITS);

/// Large odd numbers without a pattern, one per axis (Teschner et al., 2003).
const FACTORS: [u64; 3] = [0x9e37_79b9_7f4a_7c15, 0xc2b2_ae3d_27d4_eb4f, 0x1656_67b1_9e37_79f9];

/// Factor that carries all bits of a number into the upper bits of the product.
const SPREAD: u64 = 0xff51_afd7_ed55_8ccd;

/// Number of low bits of a mixed page number that do not contribute to its place.
const DROPPED_BITS: u32 = 26;

/// A map from cells to places: either one place for each cell of a block, or a power of two of
/// places, each shared by any number of cells. Both kinds use the same formula with different
/// constants, so that no code branches on the kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    factors: [u64; 3],
    /// Mask of the bits of a cell's number along an axis that give its position within its page.
    near: i64,
    strides: [u64; 3],
    last: u64,
    places: usize,
}

/// Contribution of a cell's number along one axis to its place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Along {
    page: u64,
    within: u64,
}

impl Layout {
    /// Returns a layout with one place for each cell of a block, with `counts` cells along each
    /// axis, numbered from zero.
    pub(super) fn block(counts: [usize; 3]) -> Self {
        let [x, y, z] = counts.map(|count| count as u64);
        Self { factors: [0; 3], near: -1, strides: [1, x, x * y], last: u64::MAX, places: (x * y * z) as usize }
    }

    /// Returns a layout with shared places. Their number must be a power of two and at least
    /// [`MIN_PLACES`].
    pub(super) fn hashed(places: usize) -> Self {
        let strides = [1, 1 << PAGE_EDGE_BITS, 1 << (2 * PAGE_EDGE_BITS)];
        Self { factors: FACTORS, near: (1 << PAGE_EDGE_BITS) - 1, strides, last: places as u64 - 1, places }
    }

    /// Returns the number of places.
    pub(super) fn len(&self) -> usize {
        self.places
    }

    #[inline]
    pub(super) fn along(&self, axis: usize, cell: i64) -> Along {
        let page = ((cell >> PAGE_EDGE_BITS) as u64).wrapping_mul(self.factors[axis]);
        Along { page, within: ((cell & self.near) as u64).wrapping_mul(self.strides[axis]) }
    }

    /// Returns the place of a cell, given the contributions of its three numbers. If a page has few
    /// cells in use, their places within the page differ from page to page.
    #[inline]
    pub(super) fn place(&self, [x, y, z]: [Along; 3]) -> usize {
        let mixed = (x.page ^ y.page ^ z.page).wrapping_mul(SPREAD) >> DROPPED_BITS;
        ((mixed ^ (x.within + y.within + z.within)) & self.last) as usize
    }

    #[inline]
    pub(super) fn of(&self, cell: [i64; 3]) -> usize {
        self.place([0, 1, 2].map(|axis| self.along(axis, cell[axis])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_cell_of_a_block_has_its_own_place() {
        let layout = Layout::block([3, 5, 7]);
        let mut places = BTreeSet::new();
        for cell in (0..3).flat_map(|x| (0..5).flat_map(move |y| (0..7).map(move |z| [x, y, z]))) {
            assert!(places.insert(layout.of(cell)));
        }
        assert_eq!((places.len(), places.last()), (layout.len(), Some(&(layout.len() - 1))));
    }

    #[test]
    fn hashed_cells_of_a_page_are_contiguous_and_pages_spread() {
        let layout = Layout::hashed(1 << 12);
        let mut pages = BTreeSet::new();
        for page in -20..20 {
            let low = [4 * page, -12, 4 * (page % 3)];
            let places: BTreeSet<usize> = (0..64)
                .map(|at: i64| layout.of([low[0] + (at & 3), low[1] + (at >> 2 & 3), low[2] + (at >> 4)]))
                .collect();
            assert_eq!(places.len(), 64);
            assert!(places.last().unwrap() - places.first().unwrap() == 63 && *places.last().unwrap() < layout.len());
            pages.insert(places.first().copied());
        }
        assert!(pages.len() > 20, "{} of 64 pages for 40", pages.len());
    }
}
