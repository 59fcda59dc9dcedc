//! Triangles of a polygon in space, concave or not.
//!
//! The polygon is projected along the axis of the largest component of its Newell normal, which drops a coordinate and
//! rounds nothing, and its ears are clipped in order from the first corner (Ericson, *Real-Time Collision Detection*,
//! §12.5.2; Meisters 1975), with exact orientation tests (Shewchuk 1997). A convex polygon thus becomes the fan about
//! its first corner. Every corner is used, so that neighbouring polygons keep whole edges in common; corners that lie
//! straight on an edge are no ears, and repeated positions, as in a hole tied to the outline by a double edge, do not
//! block one another.
//!
//! Where no ear is left (a polygon that crosses itself, or is a segment or a point), the rest becomes a fan about its
//! first corner. So does a polygon that would take more than [`MAX_WORK`] tests.

use robust::{Coord, orient2d};

/// The largest product of the corners of one polygon and those that are not convex: 8,192 corners that are all reflex, or
/// a million with a few dozen. Ear clipping takes some three tests for each, and a hostile file must not buy hours.
const MAX_WORK: usize = 1 << 26;

/// Whether the triangles are a triangulation of the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// They cover it exactly, as seen along the axis of projection.
    Covered,
    /// Some of them come from a fan, because the polygon is not simple, has no area, or is too large.
    Fanned,
}

/// Triangulates one polygon after another, keeping its memory.
#[derive(Default)]
pub(crate) struct Triangulator {
    /// The projected corners.
    flat: Vec<Coord<f64>>,
    /// The outline that is left, as links in both directions; a clipped corner's `next` is [`CLIPPED`].
    next: Vec<u32>,
    prev: Vec<u32>,
    /// The corners that were not strictly convex at first: only they can block an ear.
    blockers: Vec<u32>,
}

const CLIPPED: u32 = u32::MAX;

impl Triangulator {
    /// Gives `n - 2` triangles for a polygon of `n` ≥ 3 corners, named by their place in the polygon, winding as it does.
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
        // Triangles of positive area whose boundaries add up to the outline cover each point as often as the outline
        // winds around it, so that signs alone prove the cover. What is left last may be a spike without area.
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
        // Seen against the normal the outline turns left.
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

    /// Clips ears until three corners or no ear are left; returns one of the corners left and their number.
    ///
    /// Clipping `b` between `a` and `c` can make ears of `a` and `c` alone, so that no corner needs to be tried more
    /// than a few times: the search goes on at `c`, and before it leaves `a` behind, tries `a` again.
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

    /// Whether corner `b` turns left and its triangle holds no other corner, save those at its corners' positions.
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

    /// Positive where the path over three corners turns left.
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

    /// Triangles of positive area, within the plane z = 0, that use every corner.
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
    fn convex_is_the_fan_about_the_first_corner() {
        let hexagon = [[2., 0.], [1., 2.], [-1., 2.], [-2., 0.], [-1., -2.], [1., -2.]];
        for flip in [1.0, -1.0] {
            let points: Vec<_> = hexagon.iter().map(|p| [p[0], 7.0, flip * p[1]]).collect();
            let (triangles, outcome) = triangulate(&points);
            assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
            assert_eq!(outcome, Outcome::Covered);
        }
    }

    #[test]
    fn concave_with_straight_corners_and_a_hole() {
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

    /// An outline of `2 teeth + 3` corners, of which all between two teeth are reflex.
    fn comb(teeth: i32) -> Vec<[f64; 2]> {
        let tooth = |i: i32| [[f64::from(2 * i + 2), 0.0], [f64::from(2 * i + 1), 5.0]];
        let base = [[0.0, -1.0], [f64::from(2 * teeth), -1.0]];
        base.into_iter().chain((0..teeth).rev().flat_map(tooth)).chain([[0.0, 0.0]]).collect()
    }

    #[test]
    fn combs_and_spirals_of_any_size() {
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
    fn what_is_not_simple_becomes_a_fan() {
        let bow_tie = [[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]];
        let (triangles, outcome) = triangulate(&bow_tie);
        assert_eq!((triangles.len(), outcome), (2, Outcome::Fanned));
        let (triangles, _) = triangulate(&[[1., 2., 3.]; 5]);
        assert_eq!(triangles.len(), 3);
        triangulate(&[[1e308; 3], [-1e308, 1e308, 0.0], [f64::MAX; 3], [0.0; 3], [5.0, -1e308, 1e300]]);
    }

    #[test]
    fn work_is_bounded() {
        // Half of the corners block: within the bound for 8,192 corners, beyond it for 32,768.
        for (teeth, outcome) in [(4_096, Outcome::Covered), (16_384, Outcome::Fanned)] {
            let comb: Vec<_> = comb(teeth).into_iter().map(|[x, y]| [x, y, 0.0]).collect();
            assert_eq!(triangulate(&comb).1, outcome);
        }
        // A zigzag without area: every corner blocks, none is an ear.
        let zigzag: Vec<_> = (0..300_000).map(|i| [f64::from(i % 2), 0.0, 0.0]).collect();
        assert_eq!(triangulate(&zigzag).1, Outcome::Fanned);
    }
}
