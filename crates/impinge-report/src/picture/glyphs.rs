//! Letters of strokes, for lengths and axes.

use super::canvas::Canvas;
use super::color::Color;
use super::lines::Stroke;

/// A letter and its strokes. Each text is a polyline: pairs of digits, the column from the left and
/// the row above the baseline.
const GLYPHS: [(char, &[&str]); 25] = [
    ('0', &["103041453616050110"]),
    ('1', &["052620", "1030"]),
    ('2', &["05163645440040"]),
    ('3', &["05163645443313", "334241301001"]),
    ('4', &["30360242"]),
    ('5', &["460604344341301001"]),
    ('6', &["453616050110304142331302"]),
    ('7', &["064610"]),
    ('8', &["133344453616050413", "1302011030414233"]),
    ('9', &["011030414536160504133344"]),
    ('.', &["2021"]),
    ('-', &["0343"]),
    ('c', &["4334140301103041"]),
    ('e', &["024243341403011040"]),
    ('f', &["45362520", "0444"]),
    ('i', &["2024", "2526"]),
    ('m', &["0004", "03142320", "23344340"]),
    ('n', &["0004", "0314344340"]),
    ('t', &["26213040", "0444"]),
    ('u', &["0401103041", "4440"]),
    ('X', &["0046", "0640"]),
    ('Y', &["0623", "4623", "2320"]),
    ('Z', &["06460040"]),
    ('+', &["0343", "2125"]),
    (' ', &[]),
];

/// Height of a digit, in rows.
const HEIGHT: f64 = 6.0;
/// Distance of a letter from the next, in columns.
const ADVANCE: f64 = 6.0;
/// Width of a letter, in columns.
const WIDTH: f64 = 4.0;

/// Returns the width of a text in pixels, for letters of a height in pixels.
pub(super) fn text_width(text: &str, height: f64) -> f64 {
    ((text.chars().count() as f64) * ADVANCE - (ADVANCE - WIDTH)).max(0.0) * height / HEIGHT
}

impl Canvas {
    /// Draws a text whose baseline starts at a point, with letters of a height, in pixels. Letters
    /// without strokes are spaces.
    pub(super) fn text(&mut self, text: &str, [left, base]: [f64; 2], height: f64, width: f64, color: Color) {
        let row = height / HEIGHT;
        for (at, letter) in text.chars().enumerate() {
            let lines = GLYPHS.iter().find(|(known, _)| *known == letter).map_or(&[][..], |(_, lines)| lines);
            for line in lines {
                let points: Vec<[f64; 2]> = line
                    .as_bytes()
                    .chunks(2)
                    .map(|pair| pair.iter().map(|digit| f64::from(digit - b'0')).collect::<Vec<_>>())
                    .map(|pair| [left + (at as f64 * ADVANCE + pair[0]) * row, base - pair[1] * row])
                    .collect();
                for ends in points.windows(2) {
                    self.line(&Stroke { ends: [ends[0], ends[1]], color, opacity: 1.0, width });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_has_points_inside_its_box() {
        for (letter, lines) in GLYPHS {
            for line in lines {
                assert!(line.len() >= 4 && line.len() % 2 == 0, "{letter}");
                let is_inside = |pair: &[u8]| (b'0'..=b'4').contains(&pair[0]) && (b'0'..=b'6').contains(&pair[1]);
                assert!(line.as_bytes().chunks(2).all(is_inside), "{letter}");
            }
        }
    }

    #[test]
    fn every_length_can_be_written() {
        let known = |letter: char| GLYPHS.iter().any(|(glyph, _)| *glyph == letter);
        for unit in impinge_files::Unit::ALL.map(Some).into_iter().chain([None]) {
            for length in [1e-9, 0.002, 5.0, 1e7, 2e30] {
                let text = impinge_files::length_text(length, unit);
                assert!(text.chars().all(known), "{text}");
            }
        }
    }
}
