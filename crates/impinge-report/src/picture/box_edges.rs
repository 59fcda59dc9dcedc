//! The edges of boxes as lines: strong if visible, faint if hidden by the mesh.

use super::bounds::{Bounds, corners};
use super::camera::{Camera, Seen};
use super::canvas::Canvas;
use super::color::DISTINCT;
use super::lines::Stroke;

/// Distance between two visibility checks along an edge, in pixels. A larger value cuts edges less
/// precisely.
const STEP: f64 = 1.5;

/// Depth tolerance in pixels, so that an edge on the surface of the mesh counts as visible.
const TOLERANCE: f64 = 1.5;

/// Returns the edges of all boxes, hidden parts first, so that visible parts are drawn over them.
pub(super) fn strokes(boxes: &[Bounds], camera: &Camera, canvas: &Canvas) -> Vec<Stroke> {
    let width = if boxes.len() > 40 { 1.5 } else { 2.0 };
    let mut strokes = Vec::new();
    for (number, bounds) in boxes.iter().enumerate() {
        let seen = corners(bounds).map(|corner| camera.project(corner));
        let color = DISTINCT[number % DISTINCT.len()];
        for from in 0..8_usize {
            for axis in 0..3 {
                let to = from | 1 << axis;
                if to != from {
                    runs(seen[from], seen[to], canvas, |ends, is_seen| {
                        let opacity = if is_seen { 0.95 } else { 0.22 };
                        strokes.push(Stroke { ends, color, opacity, width });
                    });
                }
            }
        }
    }
    strokes.sort_by(|a, b| a.opacity.total_cmp(&b.opacity));
    strokes
}

/// Cuts an edge into visible and hidden runs and calls `run` with each run's ends and whether it is
/// visible.
fn runs(from: Seen, to: Seen, canvas: &Canvas, mut run: impl FnMut([[f64; 2]; 2], bool)) {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let steps = (length / STEP).ceil().max(1.0) as usize;
    let at = |step: usize| -> Seen {
        let share = step as f64 / steps as f64;
        [0, 1, 2].map(|axis| from[axis] + share * (to[axis] - from[axis]))
    };
    let on_picture = |step: usize| [at(step)[0], at(step)[1]];
    let mut start = 0;
    let mut is_seen = canvas.sees(at(0), TOLERANCE);
    for step in 1..=steps {
        let now = canvas.sees(at(step), TOLERANCE);
        if now != is_seen || step == steps {
            run([on_picture(start), on_picture(step)], is_seen);
            (start, is_seen) = (step, now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::axes::{Axis, from_front_right};
    use crate::picture::canvas::SAMPLES;

    #[test]
    fn an_edge_is_cut_where_it_is_hidden() {
        let mut canvas = Canvas::new([100, 100]);
        // A surface covers the right half at depth 10.
        for row in canvas.depths.chunks_mut(100 * SAMPLES) {
            row[50 * SAMPLES..].fill(10.0);
        }
        let mut found = Vec::new();
        runs([10.0, 50.0, 20.0], [90.0, 50.0, 20.0], &canvas, |ends, is_seen| found.push((ends, is_seen)));
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].1 && !found[1].1 && (found[0].0[1][0] - 50.0).abs() < 3.0, "{found:?}");
        assert_eq!(found[1].0[1], [90.0, 50.0]);
        found.clear();
        runs([10.0, 50.0, 5.0], [90.0, 50.0, 5.0], &canvas, |ends, is_seen| found.push((ends, is_seen)));
        assert_eq!(found, [([[10.0, 50.0], [90.0, 50.0]], true)]);
    }

    #[test]
    fn a_box_has_twelve_edges() {
        let boxes = [[[0.0; 3], [1.0; 3]]];
        let camera = Camera::around(&boxes, from_front_right(Axis::Y), 300);
        assert_eq!(strokes(&boxes, &camera, &Canvas::new(camera.size())).len(), 12);
    }
}
