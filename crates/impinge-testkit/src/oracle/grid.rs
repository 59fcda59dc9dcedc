//! All intersecting pairs of two large meshes: a hierarchical hash grid, then a proof in floats,
//! then exact integers.
//!
//! Each box is stored once: at the level whose cells have the smallest power of two that is at
//! least its size, in the cell of its smallest corner (Ericson, *Real-Time Collision Detection*,
//! 7.2). A box searches the boxes of its own and larger levels of the other mesh. A box that
//! overlaps it begins at most one cell before its own first cell. So slivers across the whole scene
//! cost no more than other triangles, and no pair is found twice.
//!
//! That no overlapping pair is missed depends on one property of [`cell`]: it never decreases with
//! the coordinate, however its multiplication rounds.

use super::boxes::WorldBox;
use super::certificate::Rounded;
use super::faces_intersect;
use crate::Posed;
use std::collections::BTreeMap;

/// Returns every intersecting pair (face of a, face of b), sorted.
/// [`brute_force`](super::brute_force) returns the same pairs.
///
/// Two meshes of 2,000,000 triangles take seconds to minutes on one core. It checks
/// `query::intersecting_pairs`.
///
/// # Panics
/// Panics if a world coordinate is not below 2^1000.
///
/// # Complexity
/// About linear in the number of faces and of pairs of overlapping boxes; 100 bytes per face.
pub fn grid(a: Posed, b: Posed) -> Vec<(u32, u32)> {
    let (boxes_a, boxes_b) = (WorldBox::of_faces(a), WorldBox::of_faces(b));
    let finest = finest_level(boxes_a.iter().chain(&boxes_b));
    let (levels_a, levels_b) = (levels(&boxes_a, finest), levels(&boxes_b, finest));
    let mut pairs = Vec::new();
    let mut test_pair = |i: u32, j: u32| {
        let (i_face, j_face) = (i as usize, j as usize);
        let rounded_a = Rounded::new(&a.triangle(i_face), &a.world_from_local);
        let rounded_b = Rounded::new(&b.triangle(j_face), &b.world_from_local);
        if !rounded_a.proved_apart(&rounded_b) && faces_intersect(a, i_face, b, j_face) {
            pairs.push((i, j));
        }
    };
    for (i, bounds) in boxes_a.iter().enumerate() {
        for level in levels_b.range(level_of(bounds, finest)..) {
            level.1.visit_overlapping(bounds, &boxes_b, |j| test_pair(i as u32, j));
        }
    }
    for (j, bounds) in boxes_b.iter().enumerate() {
        for level in levels_a.range(level_of(bounds, finest) + 1..) {
            level.1.visit_overlapping(bounds, &boxes_a, |i| test_pair(i, j as u32));
        }
    }
    pairs.sort_unstable();
    pairs
}

/// Boxes of one size, by the cell of their smallest corner.
struct Level {
    exponent: i32,
    /// Start of each bucket in `faces`, and one more entry for the end.
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Level {
    /// Stores faces by a counting sort. The number of buckets is the number of faces, rounded up to
    /// a power of two.
    fn new(exponent: i32, members: &[u32], boxes: &[WorldBox]) -> Self {
        let mut starts = vec![0; members.len().next_power_of_two() + 1];
        let bucket = |face: u32| bucket(cells(boxes[face as usize].low, exponent), members.len().next_power_of_two());
        for &face in members {
            starts[bucket(face) + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut faces = vec![0; members.len()];
        for &face in members {
            let slot = &mut next[bucket(face)];
            faces[*slot as usize] = face;
            *slot += 1;
        }
        Self { exponent, starts, faces }
    }

    fn visit_overlapping(&self, bounds: &WorldBox, boxes: &[WorldBox], mut visit: impl FnMut(u32)) {
        // A box of this level that reaches `bounds.low` begins at most one cell size before it.
        let size = power_of_two(self.exponent);
        let first = cells(bounds.low.map(|x| (x - size).next_down()), self.exponent);
        let last = cells(bounds.high, self.exponent);
        for x in first[0]..=last[0] {
            for y in first[1]..=last[1] {
                for z in first[2]..=last[2] {
                    let here = [x, y, z];
                    let bucket = bucket(here, self.starts.len() - 1);
                    for &face in &self.faces[self.starts[bucket] as usize..self.starts[bucket + 1] as usize] {
                        let other = &boxes[face as usize];
                        if bounds.overlaps(other) && cells(other.low, self.exponent) == here {
                            visit(face);
                        }
                    }
                }
            }
        }
    }
}

fn levels(boxes: &[WorldBox], finest: i32) -> BTreeMap<i32, Level> {
    let mut members: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    for (face, bounds) in boxes.iter().enumerate() {
        members.entry(level_of(bounds, finest)).or_default().push(face as u32);
    }
    members.into_iter().map(|(exponent, faces)| (exponent, Level::new(exponent, &faces, boxes))).collect()
}

/// Returns the smallest e, at least `finest`, for which 2^e is at least the largest extent of the
/// box.
fn level_of(bounds: &WorldBox, finest: i32) -> i32 {
    let extent = (0..3).map(|k| (bounds.high[k] - bounds.low[k]).next_up()).fold(0.0, f64::max);
    (exponent_above(extent)).max(finest)
}

/// Returns the finest level whose cell numbers still fit an integer with room to spare: 2^-50 of
/// the farthest coordinate.
fn finest_level<'a>(boxes: impl Iterator<Item = &'a WorldBox>) -> i32 {
    let farthest = boxes.flat_map(|b| b.low.into_iter().chain(b.high)).map(f64::abs).fold(0.0, f64::max);
    assert!(farthest < power_of_two(1000), "the grid needs world coordinates below 2^1000, not {farthest}");
    // At -1000 the reciprocal of a cell size is still a finite number. Smaller sizes are treated as
    // equal.
    (exponent_above(farthest) - 50).max(-1000)
}

/// Returns an e with |x| ≤ 2^e, at most one more than necessary.
fn exponent_above(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1022
}

/// Returns 2^exponent, for the exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

fn cells(point: [f64; 3], exponent: i32) -> [i64; 3] {
    point.map(|x| cell(x, exponent))
}

/// Returns the number of the cell of size 2^exponent that contains x.
fn cell(x: f64, exponent: i32) -> i64 {
    (x * power_of_two(-exponent)).floor() as i64
}

fn bucket(cell: [i64; 3], buckets: usize) -> usize {
    let hash = cell.iter().fold(0u64, |hash, &x| (hash.rotate_left(21) ^ x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    (hash >> 32) as usize & (buckets - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::knots::{TREFOIL, bumpy_sphere, stadium, torus_knot};
    use crate::generate::{Rng, poses, solids};
    use crate::oracle::brute_force;
    use crate::{Affine, Mesh};

    fn assert_same_as_brute_force(a: Posed, b: Posed) -> usize {
        let expected = brute_force(a, b);
        assert_eq!(grid(a, b), expected);
        assert_eq!(grid(b, a).len(), expected.len());
        expected.len()
    }

    #[test]
    fn soups_with_ties_agree_with_brute_force() {
        let mut rng = Rng::new(9);
        for round in 0..12 {
            let mut soup = || solids::grid_soup(&mut rng, 150, 12, 2);
            let (a, b) = (soup(), soup());
            let pose = if round % 2 == 0 { Affine::IDENTITY } else { poses::large_integer_map(&mut rng) };
            let found = assert_same_as_brute_force(a.at(pose), b.at(pose));
            assert!((100..3_000).contains(&found), "{found}");
        }
    }

    #[test]
    fn triangles_and_coordinates_of_every_size_agree_with_brute_force() {
        let mut rng = Rng::new(10);
        for exponent in [0, 90, -90, -1060] {
            let mut soup = || {
                let sizes = [0, -10, -30, -60];
                sizes.iter().fold(Mesh::default(), |mesh, size| {
                    let part = solids::grid_soup(&mut rng, 60, 6, 2).scaled(2f64.powi(exponent + size));
                    mesh.joined(&part)
                })
            };
            let (a, b) = (soup(), soup());
            let found = assert_same_as_brute_force(a.at(Affine::IDENTITY), b.at(Affine::IDENTITY));
            assert!(found > 500, "{found}");
        }
        let far = Affine::translation([1e7, -3e7, 1e9]);
        let (a, b) = (solids::icosphere(2), solids::cuboid([-0.5; 3], [2.0; 3]));
        assert!(assert_same_as_brute_force(a.at(far), b.at(far)) > 50);
    }

    #[test]
    fn knots_and_slivers_agree_with_brute_force() {
        let knot = torus_knot(60, 12, TREFOIL);
        let turned = poses::rotation(&mut Rng::new(2));
        let turned = Affine::new(turned.linear, [0.3, 0.1, 0.2]);
        assert!(assert_same_as_brute_force(knot.at(Affine::IDENTITY), knot.at(turned)) > 100);
        let slivers = stadium(40, 10, 100);
        let moved = Affine::translation([0.0006, 0.0004, 0.0005]);
        assert!(assert_same_as_brute_force(slivers.at(Affine::IDENTITY), slivers.at(moved)) > 100);
    }

    #[test]
    fn empty_meshes_have_no_pairs() {
        let (empty, sphere) = (Mesh::default(), solids::icosphere(0));
        for (a, b) in [(&empty, &sphere), (&sphere, &empty), (&empty, &empty)] {
            assert_eq!(assert_same_as_brute_force(a.at(Affine::IDENTITY), b.at(Affine::IDENTITY)), 0);
        }
    }

    /// Checks the recorded counts for 2,000,000 triangles against 2,000,000: the knot turned, the
    /// stadium of slivers moved, and the bumpy sphere turned by nearly 0.01 rad within itself. This
    /// takes seconds to minutes on one core.
    ///
    /// Run with `cargo test --release -p impinge-testkit two_million -- --ignored`.
    #[test]
    #[ignore = "long, for a release build"]
    fn two_million_triangles_against_two_million_have_their_counts() {
        let knot = torus_knot(2000, 500, TREFOIL);
        let turn = poses::rotation(&mut Rng::new(2)).linear;
        let count = |mesh: &Mesh, pose| grid(mesh.at(Affine::IDENTITY), mesh.at(pose)).len();
        assert_eq!(count(&knot, Affine::new(turn, [0.3, 0.1, 0.2])), 22_118);
        assert_eq!(count(&stadium(2000, 500, 300), Affine::translation([0.0006, 0.0004, 0.0005])), 16_561);
        let slightly = [[0.99995, -0.0099998, 0.0], [0.0099998, 0.99995, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(count(&bumpy_sphere(408), Affine::new(slightly, [0.0; 3])), 109_836);
    }
}
