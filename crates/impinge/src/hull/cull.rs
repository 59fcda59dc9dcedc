//! Points thrown out early, since a partition of space shows them to be inside (*Notes on Real Time Collision Detection*,
//! 2.2).
//!
//! Space is parted into the cells of a cube map: the pyramids from a centre through the squares of a grid on each side of a
//! cube. The outermost point of each cell is kept; the hull of these, the *inner hull*, holds most of the rest. Let its
//! gauge be `g(p) = max_f n_f · p / d_f` over its faces `n_f · p <= d_f`, the centre being the origin: p is inside
//! where `g(p) < 1`. A gauge is convex and grows with p, so on each half of a square it is at most the linear function that
//! has its values at the corners, and a point is judged by three numbers of its cell, however many faces the inner hull has.
//!
//! Source: Akl and Toussaint, *A fast convex hull algorithm*, 1978, keep the extremes of a few directions in this manner; the
//! cells and the gauge are ours. Nothing depends on what is thrown out but time.
//!
//! # Accuracy
//! All is done in coordinates whose box is [-1, 1]³, in doubles. A point goes only where its gauge is below 1 - [`MARGIN`].

use rayon::prelude::*;

use super::build::Surface;
use super::order::insertion_order;
use crate::exact::normal_rounded_once;

/// Fewer points than this are put on the hull sooner than judged.
const LEAST_POINTS: usize = 1000;

/// Points that threads take at a time.
const CHUNK: usize = 1 << 14;

/// How far inside a point must be, in units of its distance from the centre. Ten times what the roundings below add up
/// to; a larger margin keeps more points.
const MARGIN: f64 = 1e-6;

/// The least distance of a face of the inner hull from the centre, half the box being 1. Nearer, the relative error of
/// the distance would count; nothing is thrown out then.
const LEAST_DISTANCE: f64 = 1e-3;

/// How much larger than a normal the products may be that it is made of. Beyond, it is rounded from its exact value,
/// so that every normal is right to 1e-11 of its length.
const MOST_CANCELLATION: f64 = 1e4;

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
    // A grid twice as fine would make the inner hull four times as large and save few points more.
    let [seeds, cells] = if points.len() < 20 * LEAST_POINTS { [4, 8] } else { [8, 16] };
    if points.len() < LEAST_POINTS {
        return keep(&|_| false);
    }
    let Some(box_frame) = Frame::of_box(bounds) else { return keep(&|_| false) };
    let outermost = outermost(points, &box_frame, seeds);
    match Inner::hull(&outermost, box_frame.scale, cells) {
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
struct Place {
    /// The side: twice the axis, one more where it is the positive end.
    side: usize,
    /// The square of the side's grid, and the place within it, from 0 to 1.
    square: [usize; 2],
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
    fn of(p: &[f64; 3], cells: usize) -> Self {
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
            let squared = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
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
        let faces: Vec<[[f64; 3]; 3]> =
            surface.faces().flatten().map(|face| face.corners.map(|corner| ordered[corner as usize])).collect();
        // The mean of the corners of all faces is inside, whatever the rounding, or some face is not at its distance.
        let share = 1.0 / (3 * faces.len()) as f64;
        let centre = std::array::from_fn(|k| faces.as_flattened().iter().map(|corner| corner[k] * share).sum());
        let frame = Frame { centre, scale };
        let planes: Vec<[f64; 3]> = faces.iter().map(|face| frame.plane(face)).collect::<Option<_>>()?;
        let gauge = corners(cells)
            .map(|w| planes.iter().fold(0.0, |most: f64, n| most.max(n[0] * w[0] + n[1] * w[1] + n[2] * w[2])))
            .collect();
        Some(Self { frame, cells, gauge })
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

impl Frame {
    /// The plane of a face as `n / d`, where `n · p <= d` is its inner side; nothing where the centre is too near.
    ///
    /// # Accuracy
    /// Within 1e-8 of its length: 1e-11 of the normal, over the least distance.
    fn plane(&self, [p, q, r]: &[[f64; 3]; 3]) -> Option<[f64; 3]> {
        let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|k| q[k] - p[k]), std::array::from_fn(|k| r[k] - p[k]));
        let products: [[f64; 2]; 3] =
            std::array::from_fn(|k| [u[(k + 1) % 3] * v[(k + 2) % 3], u[(k + 2) % 3] * v[(k + 1) % 3]]);
        let mut normal = products.map(|[forward, backward]| forward - backward);
        // In the frame's units, in which the axes count alike.
        let scaled = |k: usize, x: f64| (x / self.scale[k]).abs();
        let length: f64 = (0..3).map(|k| scaled(k, normal[k])).sum();
        let size: f64 = (0..3).map(|k| scaled(k, products[k][0]) + scaled(k, products[k][1])).sum();
        if size > MOST_CANCELLATION * length {
            normal = normal_rounded_once(p, q, r);
        }
        let normal: [f64; 3] = std::array::from_fn(|k| normal[k] / self.scale[k]);
        let from_centre = self.apply(p);
        let distance: f64 = (0..3).map(|k| normal[k] * from_centre[k]).sum();
        let length: f64 = normal.iter().map(|x| x.abs()).sum();
        (distance >= LEAST_DISTANCE * length).then(|| normal.map(|x| x / distance))
    }
}

/// The corners of the squares of a cube map, at distance 1 along the axis of their side.
fn corners(cells: usize) -> impl Iterator<Item = [f64; 3]> {
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
