//! A canvas with a depth buffer: triangles are drawn only if nothing is nearer. Several canvases of
//! one size are layers that are blended.

use rayon::prelude::*;

use super::camera::{Camera, Seen};
use super::color::{Color, lit_triangle, mixed, mixer};
use super::pixels::Picture;
use super::vector::Vector;

/// Samples per pixel along each axis. A pixel shows their mean. More samples make edges smoother
/// and drawing slower.
pub(super) const SAMPLES: usize = 3;

/// Number of rows of samples that one thread fills at a time. Fewer make threads look at each
/// triangle more often.
const BAND: usize = 96;

/// Number of triangles that are projected at a time. They take 90 bytes of memory each.
const CHUNK: usize = 1 << 16;

/// A picture that is being drawn.
#[derive(Clone, Debug)]
pub(crate) struct Canvas {
    size: [u32; 2],
    /// Number of samples in a row.
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) colors: Vec<Color>,
    /// Depth of the nearest surface at each sample, in pixels.
    pub(super) depths: Vec<f32>,
}

/// A triangle in samples.
struct Facet {
    corners: [Seen; 3],
    color: Color,
}

impl Canvas {
    /// Returns an empty canvas on white paper.
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let [width, height] = size.map(|side| side as usize * SAMPLES);
        Self {
            size,
            width,
            height,
            colors: vec![[255; 3]; width * height],
            depths: vec![f32::INFINITY; width * height],
        }
    }

    /// Returns an empty canvas on paper whose color changes from the top to the bottom.
    pub(crate) fn on_paper(size: [u32; 2], [top, bottom]: [Color; 2]) -> Self {
        let mut canvas = Self::new(size);
        let rows = canvas.height;
        for (row, colors) in canvas.colors.chunks_mut(canvas.width.max(1)).enumerate() {
            colors.fill(mixed(top, bottom, row as f64 / rows as f64));
        }
        canvas
    }

    /// Returns width and height in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Draws `count` triangles of the world, each with a color. `offset` moves them on the canvas,
    /// in pixels.
    pub(crate) fn draw(
        &mut self,
        camera: &Camera,
        offset: [f64; 2],
        count: usize,
        triangle: impl Fn(usize) -> ([Vector; 3], Color) + Sync,
    ) {
        let starts: Vec<usize> = (0..count).step_by(CHUNK).collect();
        for start in starts {
            let project = |at: usize| {
                let (corners, color) = triangle(at);
                let mut pieces = Vec::new();
                camera.triangle(&corners, |seen| {
                    let color = lit_triangle(color, &seen);
                    let corners = seen.map(|[x, y, z]| [x + offset[0], y + offset[1], z]);
                    pieces.push(Facet { corners: corners.map(|[x, y, z]| [samples(x), samples(y), z]), color });
                });
                pieces
            };
            let range = start..(start + CHUNK).min(count);
            let facets: Vec<Facet> = range.into_par_iter().flat_map_iter(project).collect();
            self.fill(&facets);
        }
    }

    /// Fills triangles, on all threads. Of two triangles with equal depth, the first is seen.
    fn fill(&mut self, facets: &[Facet]) {
        let width = self.width;
        let size = BAND * width.max(1);
        let bands = self.colors.par_chunks_mut(size).zip(self.depths.par_chunks_mut(size));
        bands.enumerate().for_each(|(band, (colors, depths))| {
            let mut band = Band { first_row: band * BAND, width, colors, depths };
            facets.iter().for_each(|facet| band.fill(facet));
        });
    }

    /// Blends another canvas of the same size over this one, at the samples at which it is nearer.
    pub(crate) fn blend(&mut self, over: &Self, opacity: f64) {
        let mix = mixer(opacity);
        let own = self.colors.par_iter_mut().zip(&mut self.depths);
        own.zip(over.colors.par_iter().zip(&over.depths)).for_each(|((color, depth), (other, &other_depth))| {
            if other_depth < *depth {
                *color = mix(*color, *other);
                *depth = other_depth;
            }
        });
    }

    /// Blends all that is drawn on another canvas of the same size over this one, regardless of
    /// depth.
    pub(crate) fn overlay(&mut self, over: &Self, opacity: f64) {
        let mix = mixer(opacity);
        let own = self.colors.par_iter_mut();
        own.zip(over.colors.par_iter().zip(&over.depths)).for_each(|(color, (other, &depth))| {
            if depth < f32::INFINITY {
                *color = mix(*color, *other);
            }
        });
    }

    /// Reports whether nothing drawn is nearer than a point. A point that lies at most `tolerance`
    /// pixels behind a surface counts as visible, and so does a point outside the picture.
    pub(crate) fn sees(&self, [x, y, z]: Seen, tolerance: f64) -> bool {
        let [column, row] = [x, y].map(|at| samples(at) as usize);
        column >= self.width || row >= self.height || z - tolerance <= f64::from(self.depths[row * self.width + column])
    }

    /// Returns the picture: the color of each pixel is the mean of its samples.
    pub(crate) fn picture(&self) -> Picture {
        const COUNT: usize = SAMPLES * SAMPLES;
        let [width, height] = self.size.map(|side| side as usize);
        let mut pixels = vec![[0; 3]; width * height];
        pixels.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, pixels)| {
            let first = row * SAMPLES * self.width;
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let mut sums = [COUNT as u32 / 2; 3];
                for start in (0..SAMPLES).map(|below| first + below * self.width + column * SAMPLES) {
                    for sample in &self.colors[start..start + SAMPLES] {
                        (0..3).for_each(|k| sums[k] += u32::from(sample[k]));
                    }
                }
                *pixel = sums.map(|sum| (sum / COUNT as u32) as u8);
            }
        });
        Picture { size: self.size, pixels }
    }
}

/// Converts pixels to samples.
pub(super) fn samples(pixels: f64) -> f64 {
    pixels * SAMPLES as f64
}

/// Some rows of a canvas.
struct Band<'c> {
    first_row: usize,
    width: usize,
    colors: &'c mut [Color],
    depths: &'c mut [f32],
}

impl Band<'_> {
    fn fill(&mut self, Facet { corners: [a, b, c], color }: &Facet) {
        let area = signed_area(a, b, c);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let rows = self.depths.len() / self.width;
        let range = |k: usize, first: usize, end: usize| {
            let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            // The casts saturate.
            ((low - 0.5).ceil().max(0.0) as usize).max(first)..((high + 0.5).floor().max(0.0) as usize).min(end)
        };
        let columns = range(0, 0, self.width);
        if columns.is_empty() {
            return;
        }
        for row in range(1, self.first_row, self.first_row + rows) {
            let y = row as f64 + 0.5;
            let start = (row - self.first_row) * self.width;
            let depth = |column: usize| {
                let p = [column as f64 + 0.5, y, 0.0];
                let weights =
                    [signed_area(b, c, &p) / area, signed_area(c, a, &p) / area, signed_area(a, b, &p) / area];
                let is_inside = weights.iter().all(|&weight| weight >= 0.0);
                is_inside.then(|| weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2])
            };
            // The samples inside follow each other, and their depths are linear.
            let mut columns = span(&[*a, *b, *c], y, columns.clone());
            let Some((first, left)) = columns.by_ref().find_map(|column| Some((column, depth(column)?))) else {
                continue;
            };
            let (last, right) =
                columns.rev().find_map(|column| Some((column, depth(column)?))).unwrap_or((first, left));
            let slope = if last > first { (right - left) / (last - first) as f64 } else { 0.0 };
            let range = start + first..=start + last;
            let samples = self.depths[range.clone()].iter_mut().zip(&mut self.colors[range]);
            for (at, (nearest, own)) in samples.enumerate() {
                let depth = (left + slope * at as f64) as f32;
                if depth < *nearest {
                    *nearest = depth;
                    *own = *color;
                }
            }
        }
    }
}

/// Returns the columns of a row in which a triangle may be, at most one too many on each side.
fn span(corners: &[Seen; 3], y: f64, columns: std::ops::Range<usize>) -> std::ops::Range<usize> {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, from) in corners.iter().enumerate() {
        let to = corners[(k + 1) % 3];
        let [low, high] = [from[1].min(to[1]), from[1].max(to[1])];
        if low <= y && y <= high {
            let share = if high > low { (y - from[1]) / (to[1] - from[1]) } else { 0.0 };
            let x = from[0] + share * (to[0] - from[0]);
            let end = if high > low { x } else { to[0] };
            left = left.min(x).min(end);
            right = right.max(x).max(end);
        }
    }
    // The casts saturate.
    let (first, end) = ((left - 1.5).max(0.0) as usize, (right + 1.5).max(0.0) as usize);
    first.max(columns.start)..end.min(columns.end)
}

/// Returns twice the signed area of a projected triangle.
fn signed_area(a: &Seen, b: &Seen, c: &Seen) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::axes::{Axis, looking};

    const CORNERS: [Vector; 3] = [[1.0, 5.0, 9.0], [9.0, 5.0, 9.0], [1.0, 5.0, 1.0]];
    const GREEN: Color = [0, 255, 0];
    const RED: Color = [255, 0, 0];

    /// Returns a camera that sees X to the right and Z up, ten pixels of one unit each.
    pub(in crate::picture) fn front() -> Camera {
        Camera::at([5.0, 5.0, 5.0], 5.0, looking([0.0, 1.0, 0.0], Axis::Z), [10, 10], None)
    }

    fn draw(canvas: &mut Canvas, corners: [Vector; 3], color: Color) {
        canvas.draw(&front(), [0.0; 2], 1, |_| (corners, color));
    }

    #[test]
    fn the_nearest_triangle_is_visible() {
        let mut canvas = Canvas::new([10, 10]);
        draw(&mut canvas, CORNERS, GREEN);
        draw(&mut canvas, CORNERS.map(|[x, _, z]| [x, 7.0, z]), RED);
        let pixels = canvas.picture().pixels;
        assert_eq!(pixels[0], [255; 3], "outside");
        assert!(pixels[2 * 10 + 2][1] > 200 && pixels[2 * 10 + 2][0] == 0);
        draw(&mut canvas, CORNERS.map(|[x, _, z]| [x, 3.0, z]), RED);
        assert!(canvas.picture().pixels[2 * 10 + 2][0] > 200);
        // The surface is two units in front of the target.
        assert!(canvas.sees([2.5, 2.5, -2.5], 0.0) && !canvas.sees([2.5, 2.5, -1.0], 0.0));
        assert!(canvas.sees([2.5, 2.5, -1.0], 1.0) && canvas.sees([8.5, 8.5, 99.0], 0.0));
    }

    #[test]
    fn triangles_with_a_common_edge_leave_no_gap_and_slivers_are_whole() {
        // A fan of slivers over the whole picture, from a point outside.
        let mut canvas = Canvas::new([10, 10]);
        let spoke = |k: usize| [-3.0 + 20.0 * k as f64 / 997.0, 5.0, 11.0];
        canvas.draw(&front(), [0.0; 2], 997, |k| ([[5.3, 5.0, -90.0], spoke(k), spoke(k + 1)], RED));
        assert!(canvas.depths.iter().all(|depth| depth.is_finite()));
        assert!(canvas.picture().pixels.iter().all(|pixel| pixel[1] == 0));
    }

    #[test]
    fn the_picture_does_not_depend_on_the_number_of_threads() {
        let draw = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut canvas = Canvas::new([10, 200]);
                let triangle = |k: usize| {
                    let at = |m: usize| ((k * m) % 101) as f64 / 10.0;
                    ([[at(7), at(3), at(5)], [at(11), at(13), at(17)], [at(19), at(23), at(29)]], [k as u8, 90, 200])
                };
                canvas.draw(&front(), [0.0, 50.0], 200, triangle);
                canvas.picture()
            })
        };
        assert_eq!(draw(1), draw(3));
    }

    #[test]
    fn a_layer_is_blended_where_it_is_nearer() {
        let mut canvas = Canvas::new([10, 10]);
        draw(&mut canvas, CORNERS, [0, 0, 0]);
        let mut layer = Canvas::new([10, 10]);
        draw(&mut layer, CORNERS.map(|[x, _, z]| [x, 8.0, z]), [0, 0, 0]);
        let before = canvas.picture();
        canvas.blend(&layer, 0.5);
        assert_eq!(canvas.picture(), before, "a layer behind is hidden");
        canvas.overlay(&Canvas::on_paper([10, 10], [[9; 3]; 2]), 1.0);
        assert_eq!(canvas.picture(), before, "nothing is drawn on an empty layer");
        let mut front = Canvas::new([10, 10]);
        draw(&mut front, CORNERS.map(|[x, _, z]| [x, 2.0, z]), [255, 255, 255]);
        canvas.blend(&front, 0.5);
        assert!(canvas.picture().pixels[2 * 10 + 2][0] > 90);
        canvas.draw(&self::front(), [0.0; 2], 1, |_| ([[f64::NAN; 3]; 3], RED));
    }
}
