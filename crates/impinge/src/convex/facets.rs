//! The corners, edges and facets of a polytope, by which contacts are named.

use crate::hull::Hull;

/// Corners of a polytope with their numbers, the edges at each corner, and the facets as polygons.
///
/// A polytope without volume has the facets of its hull: a polygon has two, one for either side; a
/// segment or a point has none.
#[derive(Clone, Debug)]
pub(crate) struct Facets {
    /// Number of each corner among the points that the shape was made of, and its position in the
    /// shape's frame.
    pub(super) corners: Vec<(u32, [f64; 3])>,
    /// The other ends of the edges at each corner.
    pub(super) neighbors: Ragged,
    /// The corners of each facet, in counterclockwise order seen from outside.
    pub(super) outlines: Ragged,
    /// The facets at each corner.
    pub(super) facets_at: Ragged,
}

/// Lists of numbers, stored one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Ragged {
    ends: Vec<u32>,
    entries: Vec<u32>,
}

impl Ragged {
    fn with_capacity(lists: usize, entries: usize) -> Self {
        Self { ends: Vec::with_capacity(lists), entries: Vec::with_capacity(entries) }
    }

    fn close(&mut self) {
        self.ends.push(self.entries.len() as u32);
    }

    pub(super) fn list(&self, number: u32) -> &[u32] {
        let at = number as usize;
        let start = at.checked_sub(1).map_or(0, |before| self.ends[before] as usize);
        &self.entries[start..self.ends[at] as usize]
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns for each number below `count` the lists that contain it, in ascending order.
    fn lists_with(&self, count: usize) -> Self {
        let mut ends = vec![0; count];
        for &entry in &self.entries {
            ends[entry as usize] += 1;
        }
        // The end of each list is its start until its entries are written.
        let mut start = 0;
        for end in &mut ends {
            start += std::mem::replace(end, start);
        }
        let mut entries = vec![0; self.entries.len()];
        for list in 0..self.len() as u32 {
            for &entry in self.list(list) {
                let end = &mut ends[entry as usize];
                entries[*end as usize] = list;
                *end += 1;
            }
        }
        Self { ends, entries }
    }
}

impl Facets {
    /// Builds the facets of the hull of a few points. Corners have the numbers of the points.
    /// Returns `None` if the points have no hull.
    pub(crate) fn of_points(points: &[[f64; 3]]) -> Option<Self> {
        let hull = Hull::new(points).ok()?;
        let mut facets = Self::of_hull(&hull);
        for (corner, &number) in facets.corners.iter_mut().zip(hull.vertices()) {
            corner.0 = number;
        }
        Some(facets)
    }

    /// Builds the facets of a hull. Corners have the hull's own numbers.
    pub(crate) fn of_hull(hull: &Hull) -> Self {
        let corners: Vec<(u32, [f64; 3])> = (0..).zip(hull.positions().iter().copied()).collect();
        let mut neighbors = Ragged::with_capacity(corners.len(), 6 * corners.len());
        for &(corner, _) in &corners {
            neighbors.entries.extend(hull.neighbors(corner));
            neighbors.close();
        }
        let outlines = outlines(hull);
        let facets_at = outlines.lists_with(corners.len());
        Self { corners, neighbors, outlines, facets_at }
    }
}

/// Returns the outlines of a hull's facets: its fans of triangles, joined across the diagonals,
/// which are not edges of the hull.
fn outlines(hull: &Hull) -> Ragged {
    let is_edge = |from: u32, to: u32| hull.neighbors(from).binary_search(&to).is_ok();
    // Faces are sorted, and so are the fans by their first corner. The next face of a fan is found
    // by its first edge.
    let faces = hull.faces();
    let mut outlines = Ragged::with_capacity(faces.len(), 3 * faces.len());
    for face in faces.iter().filter(|face| is_edge(face[0], face[1])) {
        outlines.entries.extend(face);
        let [center, _, mut last] = *face;
        while !is_edge(center, last) {
            let Some(next) = faces.get(faces.partition_point(|other| other[..2] < [center, last][..])) else { break };
            last = next[2];
            outlines.entries.push(last);
        }
        outlines.close();
    }
    outlines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_six_facets_of_four_corners() {
        let corners: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let facets = Facets::of_points(&corners).expect("a hull");
        assert_eq!(facets.outlines.len(), 6);
        for facet in 0..6 {
            let outline = facets.outlines.list(facet);
            assert_eq!(outline.len(), 4);
            let same = |k: usize| outline.iter().all(|&i| corners[i as usize][k] == corners[outline[0] as usize][k]);
            assert_eq!((0..3).filter(|&k| same(k)).count(), 1);
        }
        assert!((0..8).all(|corner| facets.facets_at.list(corner).len() == 3));
        assert!((0..8).all(|corner| facets.neighbors.list(corner).len() == 3));
    }

    #[test]
    fn every_corner_lists_the_facets_that_contain_it() {
        let mut rng = impinge_testkit::generate::Rng::new(573);
        let mut listed = 0;
        for _ in 0..200 {
            // Points of a small grid have facets with many corners.
            let points: Vec<[f64; 3]> = (0..16).map(|_| [0; 3].map(|_: i32| rng.integer(-2, 2) as f64)).collect();
            let facets = Facets::of_points(&points).expect("a hull");
            for corner in 0..facets.corners.len() as u32 {
                let all = 0..facets.outlines.len() as u32;
                let found: Vec<u32> = all.filter(|&facet| facets.outlines.list(facet).contains(&corner)).collect();
                assert_eq!(facets.facets_at.list(corner), found);
                listed += found.len();
            }
        }
        assert!(listed > 5_000, "{listed}");
    }

    #[test]
    fn flat_polytopes_have_two_sides_or_none() {
        let square = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.5, 0.5, 1.0]];
        let facets = Facets::of_points(&square).expect("a hull");
        assert_eq!((facets.outlines.len(), facets.corners.len()), (2, 4));
        assert!((0..2).all(|side| facets.outlines.list(side).len() == 4));
        let doubled = Facets::of_points(&[[0.0; 3], [0.0; 3], [1.0; 3]]).expect("a hull");
        assert_eq!(doubled.outlines.len(), 0);
        assert_eq!(doubled.corners, [(0, [0.0; 3]), (2, [1.0; 3])]);
    }
}
