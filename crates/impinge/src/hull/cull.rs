//! Points thrown out early, since a partition of space shows them to be inside (*Notes on Real Time Collision Detection*,
//! 2.2).
//!
//! Space is parted into the cells of a cube map: the pyramids from a centre through the squares of a grid on each side of a
//! cube. The outermost point of each cell is kept; the hull of these, the *inner hull*, holds most of the rest. Its gauge
//! `g(p)`, the centre being the origin, is the factor by which it must grow to reach p: what has `g(p) < 1` is inside. A
//! gauge is convex and grows with p, so on each half of a square it is at most the linear function that has its values at
//! the corners, and a point is judged by three numbers of its cell, however many faces the inner hull has.
//!
//! The gauge at a corner w is found by walking over the faces to the one that the ray to w goes through: where
//! `w = λ a + μ b + ν c` with no negative factor, a, b, c being points of the inner hull, `g(w) <= λ + μ + ν`. That holds
//! for any three points, so neither the walk nor the faces need be right for it, and what the rounded sum misses of w is
//! measured and added: nothing is believed of the arithmetic that is not checked.
//!
//! Source: Akl and Toussaint, *A fast convex hull algorithm*, 1978, keep the extremes of a few directions in this manner; the
//! cells and the gauge are ours. Nothing depends on what is thrown out but time.
//!
//! # Accuracy
//! All is done in doubles, in coordinates whose box is [-1, 1]³, where points are off by 2^-52. A point goes only where its gauge
//! is below 1 - [`MARGIN`], and only where no unit along an axis has a gauge above [`MOST_GAUGE`].

use rayon::prelude::*;

use super::build::Surface;
use super::order::insertion_order;
use crate::math::vec3::{cross, dot};

/// Fewer points than this are put on the hull sooner than judged.
const LEAST_POINTS: usize = 1000;

/// Points that threads take at a time.
const CHUNK: usize = 1 << 14;

/// How far inside a point must be, in units of its distance from the centre. Rounded points and sums count for 1e-12 of it,
/// [`MOST_GAUGE`] times their rounding; a larger margin keeps more points.
const MARGIN: f64 = 1e-6;

/// The greatest gauge of a unit along an axis. Beyond, the centre is too near the surface for rounding not to count, and nothing
/// is thrown out.
const MOST_GAUGE: f64 = 1e3;

/// Steps of a walk over faces before it is given up, and with it the corner: twenty times what walks take.
const MOST_STEPS: usize = 200;

/// The points that may be on the hull, with their numbers in ascending order.
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
    // A grid twice as fine keeps a shell of points a quarter as thick, for an inner hull of four times as many.
    if points.len() < LEAST_POINTS {
        return keep(&|_| false);
    }
    let seeds = match points.len() / LEAST_POINTS {
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

/// The point in double precision, zeros without a sign.
#[inline(always)]
pub(crate) fn stored<T: Copy + Into<f64>>(point: [T; 3]) -> [f64; 3] {
    point.map(|x| x.into() + 0.0)
}

/// Coordinates about a centre, scaled by axis.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: [f64; 3],
    scale: [f64; 3],
}

/// A cell of a cube map, and where in it a point is.
pub(super) struct Place {
    /// The side: twice the axis, one more where it is the positive end.
    pub(super) side: usize,
    /// The square of the side's grid, and the place within it, from 0 to 1.
    pub(super) square: [usize; 2],
    within: [f64; 2],
    /// The distance from the centre along the side's axis.
    distance: f64,
}

impl Frame {
    /// The frame in which the box is [-1, 1]³; nothing where it is flat or its size is out of range.
    fn of_box([low, high]: [[f64; 3]; 2]) -> Option<Self> {
        let centre = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        let scale = std::array::from_fn(|k| 2.0 / (high[k] - low[k]));
        scale.iter().all(|x: &f64| x.is_finite()).then_some(Self { centre, scale })
    }

    #[inline(always)]
    fn apply(&self, point: &[f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| (point[k] - self.centre[k]) * self.scale[k])
    }
}

impl Place {
    /// Where a point is on a cube map of `cells` squares along each edge.
    #[inline(always)]
    pub(super) fn of(p: &[f64; 3], cells: usize) -> Self {
        let size = p.map(f64::abs);
        let axis = if size[0] >= size[1] && size[0] >= size[2] { 0 } else { 1 + usize::from(size[2] > size[1]) };
        let distance = size[axis];
        let per_unit = 0.5 * cells as f64 / distance;
        let half = 0.5 * cells as f64;
        let along = |k: usize| {
            let x = p[k] * per_unit + half;
            // The centre itself is in no cell: NaN becomes the first one, and its distance of zero is inside anywhere.
            let square = (x as usize).min(cells - 1);
            (square, x - square as f64)
        };
        let ((s, s_within), (t, t_within)) = (along((axis + 1) % 3), along((axis + 2) % 3));
        let side = 2 * axis + usize::from(p[axis] > 0.0);
        Self { side, square: [s, t], within: [s_within, t_within], distance }
    }
}

/// The outermost point of each cell, the first one among those as far out.
fn outermost<T: Copy + Into<f64> + Sync>(points: &[[T; 3]], frame: &Frame, cells: usize) -> Vec<[f64; 3]> {
    const NOBODY: (f64, u32) = (-1.0, u32::MAX);
    let of_chunk = |(chunk, points): (usize, &[[T; 3]])| {
        let mut best = vec![NOBODY; 6 * cells * cells];
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
    let best = points
        .par_chunks(CHUNK)
        .enumerate()
        .map(of_chunk)
        .reduce(|| vec![NOBODY; 6 * cells * cells], |x, y| x.into_iter().zip(y).map(|(x, y)| further(x, y)).collect());
    best.into_iter().filter(|best| best.1 != NOBODY.1).map(|best| stored(points[best.1 as usize])).collect()
}

/// The hull of a few points, as bounds of its gauge on the corners of a cube map about its middle.
struct Inner {
    frame: Frame,
    cells: usize,
    /// For each side and each corner of its grid the gauge of the point there, at distance 1 along the side's axis.
    gauge: Vec<f64>,
}

impl Inner {
    /// Nothing where the points lie in a plane, or nearly.
    fn hull(points: &[[f64; 3]], scale: [f64; 3], cells: usize) -> Option<Self> {
        let numbered: Vec<_> = points.iter().copied().zip(0..).collect();
        let ordered: Vec<_> = insertion_order(&numbered).into_iter().map(|at| points[at as usize]).collect();
        let surface = Surface::of(&ordered)?;
        let corners: Vec<u32> = surface.faces().flatten().flat_map(|face| face.corners).collect();
        let share = 1.0 / corners.len() as f64;
        let centre = std::array::from_fn(|k| corners.iter().map(|&corner| ordered[corner as usize][k] * share).sum());
        let frame = Frame { centre, scale };
        let placed: Vec<[f64; 3]> = ordered.iter().map(|point| frame.apply(point)).collect();
        let start = surface.faces().position(|face| face.is_some())? as u32;
        let mut walk = Walk { surface: &surface, points: &placed, at: start };
        // With `g(r) <= G Σ|r_k|` for any r, the greatest gauge along the axes, G, is at most the greatest sum there, and G times
        // what that misses.
        let mut most = 0.0_f64;
        for axis in 0..3 {
            for unit in [-1.0, 1.0] {
                let mut w = [0.0; 3];
                w[axis] = unit;
                let Combination { sum, missed } = walk.combine(&w)?;
                most = most.max(sum / (1.0 - missed));
            }
        }
        if !(0.0..MOST_GAUGE).contains(&most) {
            return None;
        }
        let at_corner = |w: [f64; 3]| match walk.combine(&w) {
            Some(Combination { sum, missed }) => sum + missed * most,
            None => f64::INFINITY,
        };
        Some(Self { frame, cells, gauge: corners_of_squares(cells).map(at_corner).collect() })
    }

    /// Whether a point is certainly inside.
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

/// A point as a sum of three of the inner hull with factors that are not negative.
struct Combination {
    /// The sum of the factors.
    sum: f64,
    /// The magnitudes of what the sum of points misses, added up over the axes.
    missed: f64,
}

/// A place on a surface around the origin, from which the next is not far.
struct Walk<'s> {
    surface: &'s Surface<'s>,
    points: &'s [[f64; 3]],
    at: u32,
}

impl Walk<'_> {
    /// Walks to the face that the ray to `w` goes through; nothing where it does not arrive.
    ///
    /// Source: Devillers, Pion and Teillaud, *Walking in a triangulation*, 2002, the visibility walk; here each triangle is the
    /// cone over it.
    fn combine(&mut self, w: &[f64; 3]) -> Option<Combination> {
        for step in 0..MOST_STEPS {
            let face = self.surface.face(self.at);
            let corners = face.corners.map(|corner| &self.points[corner as usize]);
            // Where w is beyond the plane through an edge and the centre; the first edge differs from step to step, lest
            // the walk go round in circles.
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
                    // Not where the face is so thin, or so near the centre, that the factors mean nothing.
                    let is_sound = missed < MARGIN / MOST_GAUGE && factors.iter().all(|&factor| factor >= 0.0);
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

/// The corners of the squares of a cube map, at distance 1 along the axis of their side.
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
        let bounds = crate::hull::judge(points).expect("legal");
        may_be_on_hull(points, bounds).into_iter().map(|(_, number)| number).collect()
    }

    /// Most of a ball is thrown out, all that is kept is near its surface, and what is on it is kept.
    #[test]
    fn the_inside_of_a_ball_goes() {
        let mut random = Random(1);
        for (count, least_radius) in [(5000, 0.8), (100_000, 0.93)] {
            let ball: Vec<[f64; 3]> = std::iter::from_fn(|| Some([(); 3].map(|()| random.unit())))
                .filter(|p| p.iter().map(|x| x * x).sum::<f64>() < 1.0)
                .take(count)
                .collect();
            let kept = kept(&ball);
            assert!(kept.len() < count / 4, "{} of {count}", kept.len());
            let radius = |&number: &u32| ball[number as usize].iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(kept.iter().map(radius).fold(1.0, f64::min) > least_radius);
            let sphere: Vec<[f64; 3]> =
                ball.iter().map(|p| p.map(|x| x / p.iter().map(|x| x * x).sum::<f64>().sqrt())).collect();
            assert_eq!(may_be_on_hull(&sphere, crate::hull::judge(&sphere).expect("legal")).len(), count);
        }
    }

    /// Squeezed, stretched and far away, no vertex of the hull of all is thrown out.
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
