//! A canvas with a depth buffer: triangles are drawn only if nothing is nearer, and lines are drawn
//! over everything.

use std::io;

use super::camera::Seen;
use super::strokes::Stroke;

/// Samples per pixel along each axis. A pixel shows their mean. More samples make edges smoother
/// and drawing slower.
const SAMPLES: usize = 2;

/// Colors of the mesh at brightness 0 and 1.
const MESH: [[f64; 3]; 2] = [[96.0, 102.0, 112.0], [226.0, 229.0, 233.0]];

/// A picture that is being drawn.
pub(crate) struct Canvas {
    size: [u32; 2],
    /// Number of samples in a row.
    width: usize,
    height: usize,
    colors: Vec<[u8; 3]>,
    /// Depth of the nearest surface at each sample, in pixels.
    depths: Vec<f32>,
}

impl Canvas {
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let [width, height] = size.map(|side| side as usize * SAMPLES);
        let colors = vec![[255; 3]; width * height];
        Self { size, width, height, colors, depths: vec![f32::INFINITY; width * height] }
    }

    /// Returns width and height in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Fills a triangle, given by its projected corners, if nothing drawn before is nearer.
    pub(crate) fn fill(&mut self, corners: [Seen; 3], brightness: f64) {
        let [a, b, c] = corners.map(|[x, y, z]| [x * SAMPLES as f64, y * SAMPLES as f64, z]);
        let area = signed_area(a, b, c);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let color = [0, 1, 2].map(|k| (MESH[0][k] + brightness * (MESH[1][k] - MESH[0][k])) as u8);
        let range = |k: usize, limit: usize| {
            let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            // The casts saturate.
            ((low - 0.5).ceil().max(0.0) as usize, ((high - 0.5).floor() + 1.0).max(0.0) as usize).min((limit, limit))
        };
        let ((left, right), (top, bottom)) = (range(0, self.width), range(1, self.height));
        for row in top..bottom.min(self.height) {
            for column in left..right.min(self.width) {
                let p = [column as f64 + 0.5, row as f64 + 0.5, 0.0];
                let weights = [signed_area(b, c, p) / area, signed_area(c, a, p) / area, signed_area(a, b, p) / area];
                if weights.iter().all(|&w| w >= 0.0) {
                    let depth = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) as f32;
                    let at = row * self.width + column;
                    if depth < self.depths[at] {
                        self.depths[at] = depth;
                        self.colors[at] = color;
                    }
                }
            }
        }
    }

    /// Tints the inside of a convex polygon, given by its corners in pixels, regardless of depth.
    pub(crate) fn tint(&mut self, corners: &[[f64; 2]], color: [u8; 3], opacity: f64) {
        let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.map(|x| x * SAMPLES as f64)).collect();
        let top = corners.iter().fold(f64::INFINITY, |top, corner| top.min(corner[1])).max(0.0);
        let bottom = corners.iter().fold(0.0_f64, |bottom, corner| bottom.max(corner[1])).min(self.height as f64);
        // The casts saturate.
        for row in top.ceil() as usize..bottom as usize {
            let y = row as f64 + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (at, a) in corners.iter().enumerate() {
                let b = corners[(at + 1) % corners.len()];
                if (a[1] <= y) != (b[1] <= y) {
                    let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let stroke = Stroke { ends: [[0.0; 2]; 2], color, opacity, width: 0.0 };
            for column in left.max(0.0).ceil() as usize..right.clamp(0.0, self.width as f64) as usize {
                self.blend(column as i64, row as i64, &stroke);
            }
        }
    }

    /// Reports whether a point is not hidden by the mesh. A point that lies at most `tolerance`
    /// pixels behind the mesh counts as visible, and so does a point outside the picture.
    pub(crate) fn sees(&self, [x, y, z]: Seen, tolerance: f64) -> bool {
        let [column, row] = [x, y].map(|at| (at * SAMPLES as f64) as usize);
        column >= self.width || row >= self.height || z - tolerance <= f64::from(self.depths[row * self.width + column])
    }

    /// Draws a line over the picture.
    pub(crate) fn line(&mut self, stroke: &Stroke) {
        let [from, to] = stroke.ends.map(|end| end.map(|x| x * SAMPLES as f64));
        let along = usize::from((to[1] - from[1]).abs() > (to[0] - from[0]).abs());
        let length = to[along] - from[along];
        let width = (stroke.width * SAMPLES as f64).round().max(1.0) as i64;
        let (first, last) = (from[along].min(to[along]).round() as i64, from[along].max(to[along]).round() as i64);
        for step in first..=last {
            let share = if length == 0.0 { 0.0 } else { ((step as f64 - from[along]) / length).clamp(0.0, 1.0) };
            let middle = from[1 - along] + share * (to[1 - along] - from[1 - along]);
            let start = (middle - 0.5 * width as f64).round() as i64;
            for across in start..start + width {
                let (column, row) = if along == 0 { (step, across) } else { (across, step) };
                self.blend(column, row, stroke);
            }
        }
    }

    fn blend(&mut self, column: i64, row: i64, stroke: &Stroke) {
        let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else { return };
        if column < self.width && row < self.height {
            let sample = &mut self.colors[row * self.width + column];
            for k in 0..3 {
                let mixed = f64::from(sample[k]) * (1.0 - stroke.opacity) + f64::from(stroke.color[k]) * stroke.opacity;
                sample[k] = mixed.round() as u8;
            }
        }
    }

    /// Returns the picture as a PNG file.
    ///
    /// # Errors
    /// Returns an error if a side is zero pixels long.
    pub(crate) fn png(&self) -> io::Result<Vec<u8>> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        writer.write_image_data(self.pixels().as_flattened()).map_err(io::Error::other)?;
        writer.finish().map_err(io::Error::other)?;
        Ok(file)
    }

    /// Returns the color of each pixel: the mean of its samples.
    fn pixels(&self) -> Vec<[u8; 3]> {
        let [width, height] = self.size.map(|side| side as usize);
        let mean = |pixel: usize| {
            let (column, row) = (pixel % width * SAMPLES, pixel / width * SAMPLES);
            let sample = |i: usize| self.colors[(row + i / SAMPLES) * self.width + column + i % SAMPLES];
            let count = SAMPLES * SAMPLES;
            [0, 1, 2].map(|k| ((0..count).map(|i| usize::from(sample(i)[k])).sum::<usize>() / count) as u8)
        };
        (0..width * height).map(mean).collect()
    }
}

/// Returns twice the signed area of a projected triangle.
fn signed_area(a: Seen, b: Seen, c: Seen) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Seen; 3] = [[1.0, 1.0, 5.0], [9.0, 1.0, 5.0], [1.0, 9.0, 5.0]];

    #[test]
    fn the_nearest_triangle_is_visible() {
        let mut canvas = Canvas::new([10, 10]);
        canvas.fill(CORNERS, 1.0);
        canvas.fill(CORNERS.map(|[x, y, _]| [x, y, 7.0]), 0.0);
        let pixels = canvas.pixels();
        assert_eq!(pixels[0], [255; 3], "outside");
        assert_eq!(pixels[2 * 10 + 2], [226, 229, 233]);
        canvas.fill(CORNERS.map(|[x, y, _]| [x, y, 3.0]), 0.0);
        assert_eq!(canvas.pixels()[2 * 10 + 2], [96, 102, 112]);
        assert!(canvas.sees([2.5, 2.5, 2.0], 0.0) && !canvas.sees([2.5, 2.5, 4.0], 0.0));
        assert!(canvas.sees([2.5, 2.5, 3.5], 1.0) && canvas.sees([8.5, 8.5, 99.0], 0.0));
    }

    #[test]
    fn exactly_the_inside_of_a_polygon_is_tinted() {
        let mut canvas = Canvas::new([10, 10]);
        canvas.tint(&[[2.0, 2.0], [8.0, 2.0], [8.0, 8.0], [2.0, 8.0]], [0, 0, 255], 0.5);
        let pixels = canvas.pixels();
        assert_eq!(pixels.iter().filter(|pixel| **pixel == [128, 128, 255]).count(), 36);
        assert_eq!((pixels[5 * 10 + 5], pixels[9 * 10 + 9]), ([128, 128, 255], [255; 3]));
    }

    #[test]
    fn lines_cover_pixels_and_are_clipped_to_the_picture() {
        let mut canvas = Canvas::new([10, 10]);
        canvas.line(&Stroke { ends: [[0.0, 5.0], [10.0, 5.0]], color: [0; 3], opacity: 1.0, width: 1.0 });
        let dark = canvas.pixels().iter().filter(|pixel| pixel[0] < 200).count();
        assert!((10..=20).contains(&dark), "{dark}");
        // Drawing outside of the picture, or with NaN, changes nothing.
        canvas.line(&Stroke { ends: [[-50.0, -5.0], [-10.0, -5.0]], color: [0; 3], opacity: 1.0, width: 1.0 });
        canvas.fill([[f64::NAN; 3]; 3], 1.0);
        canvas.tint(&[[f64::NAN; 2]; 3], [0; 3], 1.0);
        assert_eq!(canvas.pixels().iter().filter(|pixel| pixel[0] < 200).count(), dark);
    }
}
