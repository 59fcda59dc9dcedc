//! The corners, edges and facets of a polytope: what contacts are named by.

use crate::hull::Hull;

/// A polytope's corners with their numbers, the edges at each, and its facets as polygons.
///
/// A polytope without volume has the facets that its hull has: a polygon two, one for either side, a segment or a point none.
#[derive(Clone, Debug)]
pub(crate) struct Facets {
    /// Of each corner, its number among the points that the shape was made of, and where it is.
    pub(super) corners: Vec<(u32, [f64; 3])>,
    /// The other ends of the edges at each corner.
    pub(super) neighbours: Ragged,
    /// The corners of each facet, turning left seen from outside.
    pub(super) outlines: Ragged,
    /// The facets at each corner.
    pub(super) facets_at: Ragged,
}

/// Lists of numbers, one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Ragged {
    ends: Vec<u32>,
    entries: Vec<u32>,
}

impl Ragged {
    fn close(&mut self) {
        self.ends.push(self.entries.len() as u32);
    }

    pub(super) fn list(&self, number: u32) -> &[u32] {
        let at = number as usize;
        let start = at.checked_sub(1).map_or(0, |before| self.ends[before] as usize);
        &self.entries[start..self.ends[at] as usize]
    }

    fn len(&self) -> usize {
        self.ends.len()
    }
}

impl Facets {
    /// The facets of the hull of a few points, whose corners are numbered as the points are.
    pub(crate) fn of_points(points: &[[f64; 3]]) -> Option<Self> {
        let hull = Hull::new(points).ok()?;
        let mut facets = Self::of_hull(&hull);
        for (corner, &number) in facets.corners.iter_mut().zip(hull.vertices()) {
            corner.0 = number;
        }
        Some(facets)
    }

    /// The facets of a hull, whose corners have the hull's own numbers.
    pub(crate) fn of_hull(hull: &Hull) -> Self {
        let corners: Vec<(u32, [f64; 3])> = (0..).zip(hull.positions().iter().copied()).collect();
        let mut neighbours = Ragged::default();
        for &(corner, _) in &corners {
            neighbours.entries.extend(hull.neighbours(corner));
            neighbours.close();
        }
        let outlines = outlines(hull);
        let mut found: Vec<Vec<u32>> = vec![Vec::new(); corners.len()];
        for facet in 0..outlines.len() as u32 {
            for &corner in outlines.list(facet) {
                found[corner as usize].push(facet);
            }
        }
        let mut facets_at = Ragged::default();
        for facets in found {
            facets_at.entries.extend(facets);
            facets_at.close();
        }
        Self { corners, neighbours, outlines, facets_at }
    }
}

/// The outlines of a hull's facets: its fans, put together across the edges that are none of the hull's.
fn outlines(hull: &Hull) -> Ragged {
    let is_edge = |from: u32, to: u32| hull.neighbours(from).binary_search(&to).is_ok();
    // Faces are sorted, and a fan's start with its centre: the next one of a fan is found by its first edge.
    let faces = hull.faces();
    let mut outlines = Ragged::default();
    for face in faces.iter().filter(|face| is_edge(face[0], face[1])) {
        outlines.entries.extend(face);
        let [centre, _, mut last] = *face;
        while !is_edge(centre, last) {
            let Some(next) = faces.get(faces.partition_point(|other| other[..2] < [centre, last][..])) else { break };
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
        assert!((0..8).all(|corner| facets.neighbours.list(corner).len() == 3));
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
