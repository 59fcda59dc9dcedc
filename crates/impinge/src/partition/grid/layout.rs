//! Where in memory cells are.

/// Hashed cells that are neighbours in memory are so many along each axis, as a power of two: a page of memory. A box that
/// moves touches one or two of them.
const NEAR: u32 = 2;

/// Hashed cells at least.
pub(super) const FEWEST: usize = 1 << (3 * NEAR);

/// Large odd numbers without pattern, one for each axis (Teschner et al., 2003).
const FACTORS: [u64; 3] = [0x9e37_79b9_7f4a_7c15, 0xc2b2_ae3d_27d4_eb4f, 0x1656_67b1_9e37_79f9];

/// Spreads all bits of what it multiplies to the upper ones.
const SPREAD: u64 = 0xff51_afd7_ed55_8ccd;

/// Bits of a mixed page number that its place does not come from.
const BELOW: u32 = 26;

/// A place for each cell of a block, or as many places as a power of two, each of which any number of cells share. One is
/// computed as the other, with other numbers, so that nothing has to ask which it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    factors: [u64; 3],
    /// The bits of a cell's number along an axis that tell where it is in its page.
    near: i64,
    strides: [u64; 3],
    last: u64,
    places: usize,
}

/// What the number of a cell along one axis says of its place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Along {
    page: u64,
    within: u64,
}

impl Layout {
    /// One place for each of so many cells along each axis, counted from zero.
    pub(super) fn block(counts: [usize; 3]) -> Self {
        let [x, y, z] = counts.map(|count| count as u64);
        Self { factors: [0; 3], near: -1, strides: [1, x, x * y], last: u64::MAX, places: (x * y * z) as usize }
    }

    /// So many places, a power of two and [`FEWEST`] at least.
    pub(super) fn hashed(places: usize) -> Self {
        let strides = [1, 1 << NEAR, 1 << (2 * NEAR)];
        Self { factors: FACTORS, near: (1 << NEAR) - 1, strides, last: places as u64 - 1, places }
    }

    /// How many places there are.
    pub(super) fn len(&self) -> usize {
        self.places
    }

    #[inline]
    pub(super) fn along(&self, axis: usize, cell: i64) -> Along {
        let page = ((cell >> NEAR) as u64).wrapping_mul(self.factors[axis]);
        Along { page, within: ((cell & self.near) as u64).wrapping_mul(self.strides[axis]) }
    }

    /// Where a cell is that is told by its three numbers. Where a page has few cells in use they differ from page to page.
    #[inline]
    pub(super) fn place(&self, [x, y, z]: [Along; 3]) -> usize {
        let mixed = (x.page ^ y.page ^ z.page).wrapping_mul(SPREAD) >> BELOW;
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
    fn cells_of_a_block_have_places_of_their_own() {
        let layout = Layout::block([3, 5, 7]);
        let mut places = BTreeSet::new();
        for cell in (0..3).flat_map(|x| (0..5).flat_map(move |y| (0..7).map(move |z| [x, y, z]))) {
            assert!(places.insert(layout.of(cell)));
        }
        assert_eq!((places.len(), places.last()), (layout.len(), Some(&(layout.len() - 1))));
    }

    #[test]
    fn hashed_cells_of_a_page_are_neighbours_and_pages_spread() {
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
