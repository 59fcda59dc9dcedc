//! Triangulates polygons in space, convex or concave.
//!
//! The polygon is projected along the axis of the largest component of its Newell normal, which
//! drops a coordinate and rounds nothing. Its ears are clipped in order from the first corner
//! (Ericson, *Real-Time Collision Detection*, §12.5.2; Meisters 1975), with exact orientation tests
//! (Shewchuk 1997). So a convex polygon becomes the fan about its first corner. Every corner is
//! used, so that neighboring polygons keep common edges. Corners in the middle of a straight edge
//! are not ears. Corners at equal positions, as in a hole that a double edge ties to the outline,
//! do not block each other.
//!
//! If no ear is left (the polygon crosses itself, or is a segment or a point), the rest becomes a
//! fan about its first corner. So does a polygon that would take more than [`MAX_WORK`] tests.

use robust::{Coord, orient2d};

/// Maximum product of a polygon's number of corners and its number of corners that are not convex.
/// It allows 8,192 corners that are all reflex, or a million corners of which a few dozen are
/// reflex. Ear clipping takes about three tests per unit of the product. A larger value lets a
/// hostile file take hours; a smaller one turns more polygons into fans.
const MAX_WORK: usize = 1 << 26;

/// Whether the triangles are a triangulation of the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The triangles cover the polygon exactly, as seen along the axis of projection.
    Covered,
    /// Some triangles come from a fan, because the polygon is not simple, has no area, or is too
    /// large.
    Fanned,
}

/// Triangulates polygons one after another, reusing its memory.
#[derive(Default)]
pub(crate) struct Triangulator {
    /// The projected corners.
    flat: Vec<Coord<f64>>,
    /// The next corner on the remaining outline, or [`CLIPPED`] for a clipped corner.
    next: Vec<u32>,
    /// The previous corner on the remaining outline.
    prev: Vec<u32>,
    /// The corners that were not strictly convex at first. Only these can block an ear.
    blockers: Vec<u32>,
}

const CLIPPED: u32 = u32::MAX;

impl Triangulator {
    /// Calls `triangle` with `n - 2` triangles for a polygon of `n` ≥ 3 corners. Triangles are
    /// given by indices of corners in the polygon and have its winding.
    pub(crate) fn triangulate(
        &mut self,
        n: u32,
        corner: impl Fn(u32) -> [f64; 3],
        mut triangle: impl FnMut([u32; 3]),
    ) -> Outcome {
        if n == 3 {
            triangle([0, 1, 2]);
            return Outcome::Covered;
        }
        self.start(n, corner);
        let (first, left) = if (n as usize).saturating_mul(self.blockers.len()) <= MAX_WORK {
            self.clip_ears(n, &mut triangle)
        } else {
            (0, n)
        };
        // Triangles of positive area whose boundaries add up to the outline cover each point as
        // often as the outline winds around it. So their signs alone prove that they cover the
        // polygon. The last triangle may be a spike without area.
        let mut covered = true;
        let mut b = self.next[first as usize];
        for _ in 2..left {
            let c = self.next[b as usize];
            let turn = self.turn(first, b, c);
            covered &= turn > 0.0 || (left == 3 && turn == 0.0);
            triangle([first, b, c]);
            b = c;
        }
        if covered { Outcome::Covered } else { Outcome::Fanned }
    }

    /// Projects the corners, links them and lists the blockers.
    fn start(&mut self, n: u32, corner: impl Fn(u32) -> [f64; 3]) {
        let origin = corner(0);
        let from_origin = |i| {
            let p = corner(i);
            [0, 1, 2].map(|k| p[k] - origin[k])
        };
        let mut normal = [0.0; 3];
        let mut p = from_origin(n - 1);
        for i in 0..n {
            let q = from_origin(i);
            for k in 0..3 {
                let (u, v) = ((k + 1) % 3, (k + 2) % 3);
                normal[k] += (p[u] - q[u]) * (p[v] + q[v]);
            }
            p = q;
        }
        let axis = (1..3).fold(0, |best: usize, k| if normal[k].abs() > normal[best].abs() { k } else { best });
        // Seen against the normal, the outline turns left.
        let (u, v) = if normal[axis] > 0.0 { (1, 2) } else { (2, 1) };
        let (u, v) = ((axis + u) % 3, (axis + v) % 3);

        self.flat.clear();
        self.flat.extend((0..n).map(corner).map(|p| Coord { x: p[u], y: p[v] }));
        self.next.clear();
        self.next.extend((1..n).chain([0]));
        self.prev.clear();
        self.prev.extend([n - 1].into_iter().chain(0..n - 1));
        self.blockers.clear();
        for i in 0..n {
            let convex = self.turn(self.prev[i as usize], i, self.next[i as usize]) > 0.0;
            if !convex {
                self.blockers.push(i);
            }
        }
    }

    /// Clips ears until three corners or no ears are left. Returns one of the remaining corners and
    /// their number.
    ///
    /// Clipping `b` between `a` and `c` can make ears only of `a` and `c`, so no corner needs more
    /// than a few tests. The search continues at `c`, and before it leaves `a` behind, tests `a`
    /// again.
    fn clip_ears(&mut self, n: u32, triangle: &mut impl FnMut([u32; 3])) -> (u32, u32) {
        let (mut a, mut left, mut changed) = (0, n, false);
        let mut steps = 0..u64::from(n) * 2;
        while left > 3 {
            let mut b = self.next[a as usize];
            if !self.is_ear(b) {
                if changed && self.is_ear(a) {
                    b = a;
                    a = self.prev[a as usize];
                } else if steps.next().is_some() {
                    a = b;
                    changed = false;
                    continue;
                } else {
                    break;
                }
            }
            let c = self.next[b as usize];
            triangle([a, b, c]);
            self.next[a as usize] = c;
            self.prev[c as usize] = a;
            self.next[b as usize] = CLIPPED;
            left -= 1;
            changed = true;
        }
        (a, left)
    }

    /// Reports whether corner `b` turns left and its triangle contains no other corner, except
    /// corners at the positions of its own three corners.
    fn is_ear(&self, b: u32) -> bool {
        let (a, c) = (self.prev[b as usize], self.next[b as usize]);
        if self.turn(a, b, c) <= 0.0 {
            return false;
        }
        let [pa, pb, pc] = [a, b, c].map(|i| self.flat[i as usize]);
        let (low_x, high_x) = (pa.x.min(pb.x).min(pc.x), pa.x.max(pb.x).max(pc.x));
        let (low_y, high_y) = (pa.y.min(pb.y).min(pc.y), pa.y.max(pb.y).max(pc.y));
        !self.blockers.iter().any(|&i| {
            let p = self.flat[i as usize];
            let in_box = low_x <= p.x && p.x <= high_x && low_y <= p.y && p.y <= high_y;
            in_box
                && self.next[i as usize] != CLIPPED
                && p != pa
                && p != pb
                && p != pc
                && orient2d(pa, pb, p) >= 0.0
                && orient2d(pb, pc, p) >= 0.0
                && orient2d(pc, pa, p) >= 0.0
        })
    }

    /// Returns a positive number if the path over three corners turns left, zero if it is straight,
    /// and a negative number if it turns right. The sign is exact.
    fn turn(&self, a: u32, b: u32, c: u32) -> f64 {
        orient2d(self.flat[a as usize], self.flat[b as usize], self.flat[c as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(points: &[[f64; 3]]) -> (Vec<[u32; 3]>, Outcome) {
        let mut triangles = Vec::new();
        let n = points.len() as u32;
        let outcome = Triangulator::default().triangulate(n, |i| points[i as usize], |t| triangles.push(t));
        assert_eq!(triangles.len(), points.len() - 2);
        assert!(triangles.iter().flatten().all(|&i| i < n));
        (triangles, outcome)
    }

    /// Asserts that the triangles have positive area in the plane z = 0 and use every corner.
    fn assert_covers(points: &[[f64; 2]]) {
        let points: Vec<_> = points.iter().map(|p| [p[0], p[1], 0.0]).collect();
        let (triangles, outcome) = triangulate(&points);
        assert_eq!(outcome, Outcome::Covered);
        let area =
            |t: [[f64; 3]; 3]| (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0]);
        let areas: Vec<_> = triangles.iter().map(|t| area(t.map(|i| points[i as usize]))).collect();
        assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
        for i in 0..points.len() as u32 {
            assert!(triangles.iter().any(|t| t.contains(&i)));
        }
    }

    #[test]
    fn a_convex_polygon_becomes_the_fan_about_its_first_corner() {
        let hexagon = [[2., 0.], [1., 2.], [-1., 2.], [-2., 0.], [-1., -2.], [1., -2.]];
        for flip in [1.0, -1.0] {
            let points: Vec<_> = hexagon.iter().map(|p| [p[0], 7.0, flip * p[1]]).collect();
            let (triangles, outcome) = triangulate(&points);
            assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
            assert_eq!(outcome, Outcome::Covered);
        }
    }

    #[test]
    fn concave_polygons_with_straight_corners_and_a_hole_are_covered() {
        assert_covers(&[[0., 0.], [4., 0.], [4., 4.], [2., 1.]]);
        assert_covers(&[[2., 1.], [0., 0.], [4., 0.], [4., 4.]]);
        assert_covers(&[[0., 0.], [1., 0.], [2., 0.], [3., 0.], [0., 3.], [0., 2.], [0., 1.]]);
        assert_covers(&[[0., 0.], [6., 0.], [6., 6.], [4., 6.], [4., 2.], [2., 2.], [2., 6.], [0., 6.]]);
        // A square with a square hole, tied together by the double edge from (0, 0) to (1, 1).
        assert_covers(&[
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ]);
    }

    /// Returns an outline of `2 teeth + 3` corners. All corners between two teeth are reflex.
    fn comb(teeth: i32) -> Vec<[f64; 2]> {
        let tooth = |i: i32| [[f64::from(2 * i + 2), 0.0], [f64::from(2 * i + 1), 5.0]];
        let base = [[0.0, -1.0], [f64::from(2 * teeth), -1.0]];
        base.into_iter().chain((0..teeth).rev().flat_map(tooth)).chain([[0.0, 0.0]]).collect()
    }

    #[test]
    fn combs_and_spirals_of_any_size_are_covered() {
        let mut tried = 0;
        for teeth in [1, 2, 7, 100, 1000] {
            let mut comb = comb(teeth);
            for turn in 0..comb.len().min(20) {
                comb.rotate_left(turn);
                assert_covers(&comb);
                tried += 1;
            }
        }
        let at = |r: f64, k: i32| [r * (f64::from(k) * 0.1).cos(), r * (f64::from(k) * 0.1).sin()];
        let out: Vec<_> = (0..1000).map(|k| at(1.0 + f64::from(k) * 0.01, k)).collect();
        let back: Vec<_> = (0..1000).rev().map(|k| at(1.3 + f64::from(k) * 0.01, k)).collect();
        assert_covers(&back.iter().chain(&out).rev().copied().collect::<Vec<_>>());
        assert!(tried > 40);
    }

    #[test]
    fn polygons_that_are_not_simple_become_fans() {
        let bow_tie = [[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]];
        let (triangles, outcome) = triangulate(&bow_tie);
        assert_eq!((triangles.len(), outcome), (2, Outcome::Fanned));
        let (triangles, _) = triangulate(&[[1., 2., 3.]; 5]);
        assert_eq!(triangles.len(), 3);
        triangulate(&[[1e308; 3], [-1e308, 1e308, 0.0], [f64::MAX; 3], [0.0; 3], [5.0, -1e308, 1e300]]);
    }

    #[test]
    fn polygons_with_too_many_reflex_corners_become_fans() {
        // Half of the corners are reflex: the product is within the limit for 8,192 corners, and
        // exceeds it for 32,768.
        for (teeth, outcome) in [(4_096, Outcome::Covered), (16_384, Outcome::Fanned)] {
            let comb: Vec<_> = comb(teeth).into_iter().map(|[x, y]| [x, y, 0.0]).collect();
            assert_eq!(triangulate(&comb).1, outcome);
        }
        // A zigzag without area: every corner blocks, and no corner is an ear.
        let zigzag: Vec<_> = (0..300_000).map(|i| [f64::from(i % 2), 0.0, 0.0]).collect();
        assert_eq!(triangulate(&zigzag).1, Outcome::Fanned);
    }
}
