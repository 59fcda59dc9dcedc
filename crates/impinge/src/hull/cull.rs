//! Early culling of points that a partition of space shows to be inside the hull (*Notes on Real
//! Time Collision Detection*, 2.2).
//!
//! Space is partitioned into the cells of a cube map: the pyramids from a center through the
//! squares of a grid on each side of a cube. The outermost point of each cell is kept. The hull of
//! these points, the *inner hull*, holds most of the rest. With the center as origin, its gauge
//! `g(p)` is the factor by which it must grow to reach p, so a point with `g(p) < 1` is inside. A
//! gauge is convex and grows with p. So on each half of a square it is at most the linear function
//! with its values at the corners. A point is thus tested with three numbers of its cell, however
//! many faces the inner hull has.
//!
//! The gauge at a corner w is found by walking over the faces to the one that the ray to w passes
//! through. If `w = λ a + μ b + ν c` with no negative factor, for points a, b, c of the inner hull,
//! then `g(w) <= λ + μ + ν`. That holds for any three points, so neither the walk nor the faces
//! need to be right. The difference between the rounded sum and w is measured and added, so every
//! rounding is checked.
//!
//! Source: Akl and Toussaint, *A fast convex hull algorithm*, 1978, keep the extremes of a few
//! directions in this way; the cells and the gauge are ours. Culling affects only the time, never
//! the hull.
//!
//! # Accuracy
//! All computations are in doubles, in coordinates whose box is [-1, 1]³ and in which points are
//! wrong by 2^-52. A point is culled only if its gauge is below 1 - [`MARGIN`], and only if no unit
//! along an axis has a gauge above [`MAX_GAUGE`].
//!
//! The tests are below and in `tests/it/hull`.

use rayon::prelude::*;

use super::build::Surface;
use super::order::insertion_order;
use crate::math::vec3::{cross, dot};

/// Minimum number of points for culling. With fewer points, building the hull of all is faster.
const MIN_POINTS: usize = 1000;

/// Number of points that a thread processes at a time.
const CHUNK: usize = 1 << 14;

/// Minimum distance of a culled point inside the inner hull, relative to its distance from the
/// center. The rounding of points and sums is at most 1e-12 of that distance: [`MAX_GAUGE`] times
/// their error. A larger margin keeps more points.
const MARGIN: f64 = 1e-6;

/// Maximum gauge of a unit along an axis. With a larger gauge the center is so near the surface
/// that rounding matters, and nothing is culled.
const MAX_GAUGE: f64 = 1e3;

/// Maximum number of steps of a walk over faces: 20 times the usual number. After that the walk and
/// its corner are given up.
const MAX_STEPS: usize = 200;

/// Returns the points that may be on the hull, with their numbers in ascending order.
pub(super) fn may_be_on_hull<T: Copy + Into<f64> + Sync>(
    points: &[[T; 3]],
    bounds: [[f64; 3]; 2],
) -> Vec<([f64; 3], u32)> {
    let keep = |is_inside: &(dyn Fn(&[f64; 3]) -> bool + Sync)| {
        points
            .par_chunks(CHUNK)
            .enumerate()
            .flat_map_iter(|(chunk, points)| {
                let numbers = (CHUNK * chunk) as u32..;
                points.iter().map(|&point| stored(point)).zip(numbers).filter(|(point, _)| !is_inside(point))
            })
            .collect()
    };
    // A grid that is twice as fine keeps a shell of points a quarter as thick, but its inner hull
    // has four times as many points.
    if points.len() < MIN_POINTS {
        return keep(&|_| false);
    }
    let seeds = match points.len() / MIN_POINTS {
        ..20 => 8,
        20..500 => 16,
        _ => 32,
    };
    let Some(box_frame) = Frame::of_box(bounds) else { return keep(&|_| false) };
    let outermost = outermost(points, &box_frame, seeds);
    match Inner::hull(&outermost, box_frame.scale, 2 * seeds) {
        Some(inner) => keep(&|point| inner.holds(point)),
        None => keep(&|_| false),
    }
}

/// Converts a point to double precision, with zeros without a sign.
#[inline(always)]
pub(crate) fn stored<T: Copy + Into<f64>>(point: [T; 3]) -> [f64; 3] {
    point.map(|x| x.into() + 0.0)
}

/// Coordinates relative to a center, scaled by axis.
#[derive(Clone, Copy, Debug)]
struct Frame {
    center: [f64; 3],
    scale: [f64; 3],
}

/// A cell of a cube map, and the position of a point in it.
pub(super) struct Place {
    /// Side of the cube: twice the axis, plus 1 at the positive end.
    pub(super) side: usize,
    /// Square of the side's grid. `within` is the position in the square, from 0 to 1.
    pub(super) square: [usize; 2],
    within: [f64; 2],
    /// Distance from the center along the side's axis.
    distance: f64,
}

impl Frame {
    /// Returns the frame in which the box is [-1, 1]³, or `None` if the box is flat or its size is
    /// out of range.
    fn of_box([low, high]: [[f64; 3]; 2]) -> Option<Self> {
        let center = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let scale = std::array::from_fn(|k| 2.0 / (high[k] - low[k]));
        scale.iter().all(|x: &f64| x.is_finite()).then_some(Self { center, scale })
    }

    #[inline(always)]
    fn apply(&self, point: &[f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| (point[k] - self.center[k]) * self.scale[k])
    }
}

impl Place {
    /// Returns the place of a point on a cube map of `cells` squares along each edge.
    #[inline(always)]
    pub(super) fn of(p: &[f64; 3], cells: usize) -> Self {
        let size = p.map(f64::abs);
        let axis = if size[0] >= size[1] && size[0] >= size[2] { 0 } else { 1 + usize::from(size[2] > size[1]) };
        let distance = size[axis];
        let per_unit = 0.5 * cells as f64 / distance;
        let half = 0.5 * cells as f64;
        let along = |k: usize| {
            let x = p[k] * per_unit + half;
            // The center itself is in no cell. NaN becomes the first cell, and the distance of zero
            // is inside in any cell.
            let square = (x as usize).min(cells - 1);
            (square, x - square as f64)
        };
        let ((s, s_within), (t, t_within)) = (along((axis + 1) % 3), along((axis + 2) % 3));
        let side = 2 * axis + usize::from(p[axis] > 0.0);
        Self { side, square: [s, t], within: [s_within, t_within], distance }
    }
}

/// Returns the outermost point of each cell. Of equally distant points the first is kept.
fn outermost<T: Copy + Into<f64> + Sync>(points: &[[T; 3]], frame: &Frame, cells: usize) -> Vec<[f64; 3]> {
    const EMPTY_CELL: (f64, u32) = (-1.0, u32::MAX);
    let of_chunk = |(chunk, points): (usize, &[[T; 3]])| {
        let mut best = vec![EMPTY_CELL; 6 * cells * cells];
        for (number, &point) in ((CHUNK * chunk) as u32..).zip(points) {
            let p = frame.apply(&stored(point));
            let Place { side, square: [s, t], .. } = Place::of(&p, cells);
            let best = &mut best[(side * cells + s) * cells + t];
            let squared = dot(&p, &p);
            if squared > best.0 {
                *best = (squared, number);
            }
        }
        best
    };
    let further = |x: (f64, u32), y: (f64, u32)| if y.0 > x.0 || (y.0 == x.0 && y.1 < x.1) { y } else { x };
    let best = points.par_chunks(CHUNK).enumerate().map(of_chunk).reduce(
        || vec![EMPTY_CELL; 6 * cells * cells],
        |x, y| x.into_iter().zip(y).map(|(x, y)| further(x, y)).collect(),
    );
    best.into_iter().filter(|best| best.1 != EMPTY_CELL.1).map(|best| stored(points[best.1 as usize])).collect()
}

/// The hull of a few points, given by bounds on its gauge at the corners of a cube map about its
/// middle.
struct Inner {
    frame: Frame,
    cells: usize,
    /// Gauge at each corner of each side's grid, for the point there at distance 1 along the side's
    /// axis.
    gauge: Vec<f64>,
}

impl Inner {
    /// Builds the inner hull. Returns `None` if the points lie in a plane, or nearly.
    fn hull(points: &[[f64; 3]], scale: [f64; 3], cells: usize) -> Option<Self> {
        let numbered: Vec<_> = points.iter().copied().zip(0..).collect();
        let ordered: Vec<_> = insertion_order(&numbered).into_iter().map(|at| points[at as usize]).collect();
        let surface = Surface::of(&ordered)?;
        let corners: Vec<u32> = surface.faces().flatten().flat_map(|face| face.corners).collect();
        let share = 1.0 / corners.len() as f64;
        let center = std::array::from_fn(|k| corners.iter().map(|&corner| ordered[corner as usize][k] * share).sum());
        let frame = Frame { center, scale };
        let placed: Vec<[f64; 3]> = ordered.iter().map(|point| frame.apply(point)).collect();
        let start = surface.faces().position(|face| face.is_some())? as u32;
        let mut walk = Walk { surface: &surface, points: &placed, at: start };
        // Let G be the greatest gauge along the axes, so that `g(r) <= G Σ|r_k|` for any r. Then G
        // is at most the greatest sum there, plus G times the missed part.
        let mut most = 0.0_f64;
        for axis in 0..3 {
            for unit in [-1.0, 1.0] {
                let mut w = [0.0; 3];
                w[axis] = unit;
                let Combination { sum, missed } = walk.combine(&w)?;
                most = most.max(sum / (1.0 - missed));
            }
        }
        if !(0.0..MAX_GAUGE).contains(&most) {
            return None;
        }
        let at_corner = |w: [f64; 3]| match walk.combine(&w) {
            Some(Combination { sum, missed }) => sum + missed * most,
            None => f64::INFINITY,
        };
        Some(Self { frame, cells, gauge: corners_of_squares(cells).map(at_corner).collect() })
    }

    /// Reports whether a point is certainly inside.
    #[inline(always)]
    fn holds(&self, point: &[f64; 3]) -> bool {
        let p = self.frame.apply(point);
        let Place { side, square: [s, t], within: [x, y], distance } = Place::of(&p, self.cells);
        let row = self.cells + 1;
        let corner = (side * row + s) * row + t;
        let (g00, g01, g10, g11) =
            (self.gauge[corner], self.gauge[corner + 1], self.gauge[corner + row], self.gauge[corner + row + 1]);
        let gauge = if x + y <= 1.0 {
            g00 + x * (g10 - g00) + y * (g01 - g00)
        } else {
            g11 + (1.0 - x) * (g01 - g11) + (1.0 - y) * (g10 - g11)
        };
        distance * gauge < 1.0 - MARGIN
    }
}

/// A point as a sum of three points of the inner hull with factors that are not negative.
struct Combination {
    /// Sum of the factors.
    sum: f64,
    /// Difference between the sum of points and the point: magnitudes added up over the axes.
    missed: f64,
}

/// A face of a surface around the origin, from which the next target is not far.
struct Walk<'s> {
    surface: &'s Surface<'s>,
    points: &'s [[f64; 3]],
    at: u32,
}

impl Walk<'_> {
    /// Walks to the face that the ray to `w` passes through. Returns `None` if the walk does not
    /// arrive, or the face is too thin.
    ///
    /// Source: Devillers, Pion and Teillaud, *Walking in a triangulation*, 2002, the visibility
    /// walk. Here each triangle stands for the cone over it.
    fn combine(&mut self, w: &[f64; 3]) -> Option<Combination> {
        for step in 0..MAX_STEPS {
            let face = self.surface.face(self.at);
            let corners = face.corners.map(|corner| &self.points[corner as usize]);
            // The edge beyond which w is, seen from the center. The first edge to be tried changes
            // from step to step, so that the walk does not run in circles.
            let factor = |edge: usize| determinant(corners[edge], corners[(edge + 1) % 3], w);
            let beyond = (0..3).map(|turn| (step + turn) % 3).find(|&edge| factor(edge) < 0.0);
            match beyond {
                Some(edge) => self.at = face.across[edge],
                None => {
                    let whole = determinant(corners[0], corners[1], corners[2]);
                    let factors = [1, 2, 0].map(|edge| factor(edge) / whole);
                    let miss = |k: usize| {
                        w[k] - (factors[0] * corners[0][k] + factors[1] * corners[1][k] + factors[2] * corners[2][k])
                    };
                    let missed = miss(0).abs() + miss(1).abs() + miss(2).abs();
                    // The factors mean nothing if the face is very thin or very near the center.
                    let is_sound = missed < MARGIN / MAX_GAUGE && factors.iter().all(|&factor| factor >= 0.0);
                    return is_sound.then(|| Combination { sum: factors.iter().sum(), missed });
                }
            }
        }
        None
    }
}

fn determinant(u: &[f64; 3], v: &[f64; 3], w: &[f64; 3]) -> f64 {
    dot(&cross(u, v), w)
}

/// Iterates over the corners of the squares of a cube map, at distance 1 along the axis of their
/// side.
fn corners_of_squares(cells: usize) -> impl Iterator<Item = [f64; 3]> {
    let step = 2.0 / cells as f64;
    (0..6).flat_map(move |side| {
        (0..=cells).flat_map(move |s| {
            (0..=cells).map(move |t| {
                let axis = side / 2;
                let mut corner = [0.0; 3];
                corner[axis] = if side % 2 == 1 { 1.0 } else { -1.0 };
                corner[(axis + 1) % 3] = s as f64 * step - 1.0;
                corner[(axis + 2) % 3] = t as f64 * step - 1.0;
                corner
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    fn kept(points: &[[f64; 3]]) -> Vec<u32> {
        let bounds = crate::hull::validate_points(points).expect("legal");
        may_be_on_hull(points, bounds).into_iter().map(|(_, number)| number).collect()
    }

    /// Most points inside a sphere are culled. All kept points are near its surface, and all points
    /// on the surface are kept.
    #[test]
    fn the_inside_of_a_sphere_is_culled() {
        let mut random = Random(1);
        for (count, least_radius) in [(5000, 0.8), (100_000, 0.93)] {
            let inside: Vec<[f64; 3]> = std::iter::from_fn(|| Some([(); 3].map(|()| random.unit())))
                .filter(|p| p.iter().map(|x| x * x).sum::<f64>() < 1.0)
                .take(count)
                .collect();
            let kept = kept(&inside);
            assert!(kept.len() < count / 4, "{} of {count}", kept.len());
            let radius = |&number: &u32| inside[number as usize].iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(kept.iter().map(radius).fold(1.0, f64::min) > least_radius);
            let on_sphere: Vec<[f64; 3]> =
                inside.iter().map(|p| p.map(|x| x / p.iter().map(|x| x * x).sum::<f64>().sqrt())).collect();
            assert_eq!(
                may_be_on_hull(&on_sphere, crate::hull::validate_points(&on_sphere).expect("legal")).len(),
                count
            );
        }
    }

    /// No vertex of the hull is culled, for points that are squeezed, stretched and far away.
    #[test]
    fn no_vertex_goes() {
        let mut random = Random(2);
        let mut thrown = 0;
        for case in 0..60 {
            let scale = [[1.0, 1.0, 1.0], [1.0, 1e-9, 1e6], [1e-150, 1e20, 1.0]][case % 3];
            let power = [1, 3, 9][case / 3 % 3];
            let offset = [0.0, 1e3][case / 9 % 2];
            let points: Vec<[f64; 3]> = (0..3000)
                .map(|_| [0, 1, 2].map(|k| scale[k] * (offset + random.unit().powi(power) + 0.2 * random.unit())))
                .collect();
            let numbered: Vec<_> = points.iter().copied().zip(0..).collect();
            let order = insertion_order(&numbered);
            let ordered: Vec<_> = order.iter().map(|&at| points[at as usize]).collect();
            let surface = Surface::of(&ordered).expect("a solid");
            let kept = kept(&points);
            for face in surface.faces().flatten() {
                assert!(face.corners.iter().all(|&corner| kept.binary_search(&order[corner as usize]).is_ok()));
            }
            thrown += points.len() - kept.len();
        }
        assert!(thrown > 30_000, "{thrown}");
    }
}
