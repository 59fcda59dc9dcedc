//! Two meshes, their intersecting faces, and the curves in which they intersect.

use impinge::query::Curves;
use impinge::{Mesh, Pose};

use super::axes::{Axis, orbit};
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::Color;
use super::pixels::Picture;
use super::vector::Vector;

/// Colors of `a`, opaque, and of `b`, transparent.
const COLORS: [Color; 2] = [[201, 185, 170], [92, 132, 176]];
/// Colors of the intersecting faces of both.
const HIT_COLORS: [Color; 2] = [[222, 92, 70], [196, 60, 120]];
/// Color of the intersection curves.
const CURVE_COLOR: Color = [255, 176, 0];
/// Colors of the paper at the top and at the bottom.
const PAPER: [Color; 2] = [[250, 250, 250], [226, 229, 233]];
/// Opacity of `b`.
const OPACITY: f64 = 0.5;
/// Size of the picture, relative to its content.
const MARGIN: f64 = 1.08;
/// Radius of a curve, in pixels.
const CURVE_RADIUS: f64 = 1.6;

/// Two placed meshes, and what is known about their intersection.
pub struct Pair<'p> {
    /// The meshes: `a` is opaque, and `b` is transparent.
    pub meshes: [&'p Mesh; 2],
    /// Poses of the meshes.
    pub world_from_mesh: [Pose; 2],
    /// Pairs of intersecting faces.
    pub pairs: &'p [[u32; 2]],
    /// The curves in which the meshes intersect.
    pub curves: &'p Curves,
}

/// How to look at a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairView {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Azimuth and elevation of the camera in degrees.
    pub angles: [f64; 2],
    /// The axis of the world that points up.
    pub up: Axis,
    /// Whether the picture shows only the surroundings of the intersection, if there is one.
    pub focus_on_contact: bool,
}

/// Draws two meshes without perspective. Intersecting faces are red, curves are yellow.
#[must_use]
pub fn pair(pair: &Pair<'_>, view: PairView) -> Picture {
    let hits = [0, 1].map(|side| {
        let mut is_hit = vec![false; pair.meshes[side].faces().len()];
        pair.pairs.iter().for_each(|faces| is_hit[faces[side] as usize] = true);
        is_hit
    });
    let is_close = view.focus_on_contact && !pair.pairs.is_empty();
    let points = [0, 1].into_iter().flat_map(|side| {
        let hits = &hits[side];
        let shown = (0..hits.len()).filter(move |&face| hits[face] || !is_close);
        shown.flat_map(move |face| pair.corners(side, face))
    });
    let margin = MARGIN * if view.focus_on_contact { 2.0 } else { 1.0 };
    let camera = Camera::framing(points, orbit(view.angles, view.up), view.size, margin);

    let mut canvas = Canvas::on_paper(view.size, PAPER);
    let mut transparent = Canvas::new(view.size);
    for (side, layer) in [(0, &mut canvas), (1, &mut transparent)] {
        let color = |face: usize| if hits[side][face] { HIT_COLORS[side] } else { COLORS[side] };
        layer.draw(&camera, [0.0; 2], hits[side].len(), |face| (pair.corners(side, face), color(face)));
    }
    // The curves behind b are visible through it.
    pair.draw_curves(&mut canvas, &camera);
    canvas.blend(&transparent, OPACITY);
    pair.draw_curves(&mut canvas, &camera);
    canvas.picture()
}

impl Pair<'_> {
    /// Returns the corners of a face in the world frame, rounded.
    fn corners(&self, side: usize, face: usize) -> [Vector; 3] {
        self.meshes[side].corners(face as u32).map(|corner| self.world_from_mesh[side].apply(corner))
    }

    fn draw_curves(&self, canvas: &mut Canvas, camera: &Camera) {
        for ends in self.curves.polylines.iter().flat_map(|line| line.windows(2)) {
            if let Some(seen) = camera.segment([ends[0], ends[1]]) {
                canvas.tube(seen, CURVE_RADIUS, CURVE_COLOR);
            }
        }
    }
}
