//! Lines, polygons and curves on a canvas.

use super::camera::Seen;
use super::canvas::{Canvas, SAMPLES, samples};
use super::color::{Color, lit, mixed};

/// A line in the picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) ends: [[f64; 2]; 2],
    pub(crate) color: Color,
    pub(crate) opacity: f64,
    pub(crate) width: f64,
}

/// Distance in pixels by which thin lines and curves are in front of the surfaces that they lie on.
const RISE: f64 = 1.2;

/// Ambient light on curves. They are brighter than surfaces, so that they stand out.
const CURVE_AMBIENT: f64 = 0.62;

impl Canvas {
    /// Draws a line over the picture, regardless of depth.
    pub(crate) fn line(&mut self, stroke: &Stroke) {
        let [from, to] = stroke.ends.map(|end| end.map(samples));
        self.step(from, to, stroke.width, |canvas, at, _| {
            canvas.colors[at] = mixed(canvas.colors[at], stroke.color, stroke.opacity);
        });
    }

    /// Draws a line on the surfaces on which it lies, where nothing is nearer.
    pub(crate) fn edge(&mut self, [from, to]: [Seen; 2], width: f64, color: Color, opacity: f64) {
        let depth = |share: f64| from[2] + share * (to[2] - from[2]);
        self.step(
            [samples(from[0]), samples(from[1])],
            [samples(to[0]), samples(to[1])],
            width,
            |canvas, at, share| {
                if depth(share) - RISE <= f64::from(canvas.depths[at]) && canvas.depths[at] < f32::INFINITY {
                    canvas.colors[at] = mixed(canvas.colors[at], color, opacity);
                }
            },
        );
    }

    /// Draws a round tube along a curve where nothing is nearer. The radius is in pixels.
    pub(crate) fn tube(&mut self, [from, to]: [Seen; 2], radius: f64, color: Color) {
        let radius = samples(radius);
        let (start, end) = ([samples(from[0]), samples(from[1])], [samples(to[0]), samples(to[1])]);
        let Some([first, last]) = clipped([start, end], radius, [self.width, self.height]) else { return };
        let length = (end[0] - start[0]).hypot(end[1] - start[1]);
        let steps = (0.75 * length * (last - first)).ceil().max(1.0) as usize;
        let reach = radius.ceil() as i64;
        for step in 0..=steps {
            let share = first + (last - first) * step as f64 / steps as f64;
            let at = [0, 1].map(|k| (start[k] + share * (end[k] - start[k])).floor() as i64);
            let depth = from[2] + share * (to[2] - from[2]) - RISE;
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let rise = radius * radius - (dx * dx + dy * dy) as f64;
                    let (Some(place), true) = (self.place(at[0] + dx, at[1] + dy), rise >= 0.0) else { continue };
                    let rise = rise.sqrt();
                    let depth = (depth - rise / SAMPLES as f64) as f32;
                    if depth < self.depths[place] {
                        self.depths[place] = depth;
                        self.colors[place] = lit(color, [dx as f64, dy as f64, -rise], CURVE_AMBIENT);
                    }
                }
            }
        }
    }

    /// Tints the inside of a convex polygon, given by its corners in pixels, regardless of depth.
    pub(crate) fn tint(&mut self, corners: &[[f64; 2]], color: Color, opacity: f64) {
        let corners: Vec<[f64; 2]> = corners.iter().map(|corner| corner.map(samples)).collect();
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
            for column in left.max(0.0).ceil() as usize..right.clamp(0.0, self.width as f64) as usize {
                let at = row * self.width + column;
                self.colors[at] = mixed(self.colors[at], color, opacity);
            }
        }
    }

    /// Calls `mark` for each sample of a line, once, with the place of the sample and its share of
    /// the way from the first end to the second. The ends are in samples, the width in pixels.
    fn step(&mut self, from: [f64; 2], to: [f64; 2], width: f64, mark: impl Fn(&mut Self, usize, f64)) {
        let width = samples(width).round().max(1.0);
        let Some(shares) = clipped([from, to], width, [self.width, self.height]) else { return };
        let along = usize::from((to[1] - from[1]).abs() > (to[0] - from[0]).abs());
        let length = to[along] - from[along];
        let [first, last] = shares.map(|share| (from[along] + share * length).round() as i64);
        for step in first.min(last)..=first.max(last) {
            let share = if length == 0.0 { 0.0 } else { ((step as f64 - from[along]) / length).clamp(0.0, 1.0) };
            let middle = from[1 - along] + share * (to[1 - along] - from[1 - along]);
            let start = (middle - 0.5 * width).round() as i64;
            for across in start..start + width as i64 {
                let (column, row) = if along == 0 { (step, across) } else { (across, step) };
                if let Some(at) = self.place(column, row) {
                    mark(self, at, share);
                }
            }
        }
    }

    fn place(&self, column: i64, row: i64) -> Option<usize> {
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        (column < self.width && row < self.height).then_some(row * self.width + column)
    }
}

/// Returns the shares of a segment between which it may be on the canvas, which is a margin larger
/// here. Returns `None` if the segment is outside, or not finite.
fn clipped([from, to]: [[f64; 2]; 2], margin: f64, size: [usize; 2]) -> Option<[f64; 2]> {
    if !from.iter().chain(&to).all(|x| x.is_finite()) {
        return None;
    }
    let [mut first, mut last] = [0.0_f64, 1.0_f64];
    for k in 0..2 {
        let (low, high) = (-margin - 1.0, size[k] as f64 + margin + 1.0);
        let length = to[k] - from[k];
        if length == 0.0 {
            if from[k] < low || from[k] > high {
                return None;
            }
            continue;
        }
        let [a, b] = [low, high].map(|side| (side - from[k]) / length);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    (first <= last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(ends: [[f64; 2]; 2]) -> Stroke {
        Stroke { ends, color: [0; 3], opacity: 1.0, width: 1.0 }
    }

    fn dark(canvas: &Canvas) -> usize {
        canvas.picture().pixels().iter().filter(|pixel| pixel[0] < 200).count()
    }

    #[test]
    fn exactly_the_inside_of_a_polygon_is_tinted() {
        let mut canvas = Canvas::new([10, 10]);
        canvas.tint(&[[2.0, 2.0], [8.0, 2.0], [8.0, 8.0], [2.0, 8.0]], [0, 0, 255], 0.5);
        let picture = canvas.picture();
        let pixels = picture.pixels();
        assert_eq!(pixels.iter().filter(|pixel| **pixel == [128, 128, 255]).count(), 36);
        assert_eq!((pixels[5 * 10 + 5], pixels[9 * 10 + 9]), ([128, 128, 255], [255; 3]));
    }

    #[test]
    fn lines_cover_pixels_and_are_clipped_to_the_picture() {
        let mut canvas = Canvas::new([10, 10]);
        canvas.line(&stroke([[0.0, 5.5], [10.0, 5.5]]));
        assert!((10..=20).contains(&dark(&canvas)), "{}", dark(&canvas));
        let before = dark(&canvas);
        // Drawing outside of the picture, or with NaN, changes nothing.
        canvas.line(&stroke([[-50.0, -5.0], [-10.0, -5.0]]));
        canvas.line(&stroke([[f64::NAN; 2]; 2]));
        canvas.tint(&[[f64::NAN; 2]; 3], [0; 3], 1.0);
        assert_eq!(dark(&canvas), before);
        // A line of a million kilometers takes no longer than one across the picture.
        canvas.line(&stroke([[5.5, -1e15], [5.5, 1e15]]));
        assert!(dark(&canvas) >= before + 9);
    }

    #[test]
    fn curves_are_hidden_behind_surfaces_and_drawn_on_them() {
        let mut canvas = Canvas::new([20, 10]);
        canvas.depths.fill(5.0);
        canvas.tube([[2.0, 5.0, 9.0], [18.0, 5.0, 9.0]], 1.5, [0; 3]);
        assert_eq!(dark(&canvas), 0);
        canvas.tube([[2.0, 5.0, 5.0], [18.0, 5.0, 5.0]], 1.5, [0; 3]);
        assert!(dark(&canvas) > 40);
        let mut canvas = Canvas::new([20, 10]);
        canvas.edge([[2.0, 5.0, 9.0], [18.0, 5.0, 9.0]], 1.0, [0; 3], 1.0);
        assert_eq!(dark(&canvas), 0, "an edge needs a surface");
        canvas.depths.fill(9.0);
        canvas.edge([[2.0, 5.5, 9.0], [18.0, 5.5, 9.0]], 1.0, [0; 3], 1.0);
        assert!(dark(&canvas) > 10);
    }
}
