//! The scale bar and the axes in the lower corners of a picture.

use impinge_files::{Unit, length_text};

use super::camera::Camera;
use super::canvas::Canvas;
use super::color::{Color, INK};
use super::glyphs::text_width;
use super::lines::Stroke;
use super::vector::{Vector, dot};

/// Longest scale bar, as a share of the width of the picture.
const LONGEST: f64 = 0.22;

/// Names of the axes, and their colors: red, green and blue that people with every kind of color
/// vision tell apart.
const AXES: [(&str, Color); 3] = [("X", [213, 94, 0]), ("Y", [0, 158, 115]), ("Z", [0, 114, 178])];

/// Draws a bar whose length is 1, 2 or 5 times a power of ten, with its length above it. It is true
/// at the distance of the target.
pub(super) fn scale_bar(canvas: &mut Canvas, camera: &Camera, unit: Option<Unit>) {
    let [width, height] = canvas.size().map(f64::from);
    // Millimeters of a meter are decimal, too, so the length is a round number in each of them.
    let Some(length) = round_length(LONGEST * width / camera.scale()) else { return };
    let pixels = length * camera.scale();
    let size = letter_height(canvas);
    let (left, base) = (1.4 * size, height - 1.4 * size);
    let tick = 0.35 * size;
    let bar = [
        [[left, base], [left + pixels, base]],
        [[left, base - tick], [left, base + tick]],
        [[left + pixels, base - tick], [left + pixels, base + tick]],
    ];
    for ends in bar {
        canvas.line(&Stroke { ends, color: INK, opacity: 1.0, width: size / 8.0 });
    }
    let text = length_text(length, unit);
    let start = (left + 0.5 * (pixels - text_width(&text, size))).max(left);
    canvas.text(&text, [start, base - 0.75 * size], size, size / 9.0, INK);
}

/// Draws the directions of three axes of the world, each with its name.
pub(super) fn axes(canvas: &mut Canvas, camera: &Camera, directions: [Vector; 3]) {
    let [width, height] = canvas.size().map(f64::from);
    let size = letter_height(canvas);
    let reach = 2.6 * size;
    let middle = [width - 1.8 * size - reach, height - 1.8 * size - reach];
    let [right, down, away] = *camera.directions();
    let mut order = [0, 1, 2];
    // The nearest axis is drawn last.
    order.sort_by(|&a, &b| dot(away, directions[b]).total_cmp(&dot(away, directions[a])));
    for axis in order {
        let (name, color) = AXES[axis];
        let [x, y] = [right, down].map(|side| dot(side, directions[axis]));
        let at = |share: f64| [middle[0] + share * reach * x, middle[1] + share * reach * y];
        canvas.line(&Stroke { ends: [middle, at(1.0)], color, opacity: 1.0, width: size / 6.0 });
        let [column, row] = at(1.32);
        canvas.text(name, [column - 0.25 * size, row + 0.4 * size], 0.8 * size, size / 9.0, color);
    }
}

/// Returns the height of letters in pixels, which depends on the size of the picture.
fn letter_height(canvas: &Canvas) -> f64 {
    let [width, height] = canvas.size().map(f64::from);
    (width.min(height) / 44.0).max(7.0)
}

/// Returns the largest length that is at most `longest` and 1, 2 or 5 times a power of ten.
/// Returns `None` if there is no such number.
fn round_length(longest: f64) -> Option<f64> {
    if !(longest > 1e-300 && longest < 1e300) {
        return None;
    }
    let decade = longest.log10().floor() as i32;
    let candidates =
        [(1, decade - 1), (2, decade - 1), (5, decade - 1), (1, decade), (2, decade), (5, decade), (1, decade + 1)];
    // The shortest text of a number is the number itself, and powers of ten are not.
    let lengths = candidates.map(|(digit, exponent)| format!("{digit}e{exponent}").parse::<f64>());
    lengths.into_iter().flatten().rfind(|&length| length <= longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::axes::{Axis, from_front_right};

    #[test]
    fn bars_have_round_lengths() {
        for (longest, expected) in
            [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (0.0499, 0.02), (5e-7, 5e-7), (999.0, 500.0), (1000.0, 1000.0)]
        {
            assert_eq!(round_length(longest), Some(expected));
        }
        for invalid in [0.0, f64::INFINITY, f64::NAN] {
            assert_eq!(round_length(invalid), None);
        }
    }

    #[test]
    fn the_bar_is_as_long_as_it_says() {
        // 300 pixels show 3 units, so the longest bar of 66 pixels is half a unit: 50 pixels.
        let camera = Camera::at([0.0; 3], 1.5, from_front_right(Axis::Z), [300, 300], None);
        let mut canvas = Canvas::new([300, 300]);
        scale_bar(&mut canvas, &camera, None);
        let picture = canvas.picture();
        let rows = picture.pixels().chunks(300);
        let longest = rows.map(|row| row.iter().filter(|pixel| pixel[0] < 150).count()).max();
        assert!((50..=52).contains(&longest.unwrap()), "{longest:?}");
        axes(&mut canvas, &camera, [Axis::X, Axis::Y, Axis::Z].map(Axis::direction));
        let colored = |color: Color| canvas.picture().pixels().contains(&color);
        assert!(AXES.iter().all(|&(_, color)| colored(color)));
    }
}
