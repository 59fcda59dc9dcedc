//! A mesh in gray with boxes over it, as PNG or SVG.

use std::io::{self, Write};

use impinge::Mesh;

use super::axes::{Axis, from_front_right};
use super::bounds::Bounds;
use super::box_edges;
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::MESH;
use super::lines::Stroke;
use super::svg;

/// Longer side of the picture, in pixels.
const LONGER_SIDE: u32 = 1400;

/// The mesh as pixels, and the edges of the boxes as lines over them.
pub struct HierarchyPicture {
    canvas: Canvas,
    strokes: Vec<Stroke>,
}

impl HierarchyPicture {
    /// Draws the mesh and boxes, given by their (minimum, maximum) corners in the mesh frame. `up`
    /// is the axis that points up in the picture.
    #[must_use]
    pub fn draw(mesh: &Mesh, boxes: &[[[f64; 3]; 2]], up: Axis) -> Self {
        let boxes: &[Bounds] = boxes;
        let camera = Camera::around(boxes, from_front_right(up), LONGER_SIDE);
        let mut canvas = Canvas::new(camera.size());
        canvas.draw(&camera, [0.0; 2], mesh.faces().len(), |face| (mesh.corners(face as u32), MESH));
        let strokes = box_edges::strokes(boxes, &camera, &canvas);
        Self { canvas, strokes }
    }

    /// Writes the picture as a PNG file.
    ///
    /// # Errors
    /// Returns the errors of the output.
    pub fn write_png(mut self, out: &mut dyn Write) -> io::Result<()> {
        self.strokes.iter().for_each(|stroke| self.canvas.line(stroke));
        out.write_all(&self.canvas.picture().png()?)
    }

    /// Writes the picture as an SVG file: the mesh as an image, the boxes as vectors over it.
    ///
    /// # Errors
    /// Returns the errors of the output.
    pub fn write_svg(&self, out: &mut dyn Write) -> io::Result<()> {
        svg::write(out, &self.canvas.picture(), &self.strokes)
    }
}
