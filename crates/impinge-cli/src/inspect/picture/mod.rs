//! A picture of a mesh in grey with boxes over it: a small software renderer, for PNG, and the same with the boxes as
//! vectors, for SVG.

pub(crate) mod camera;
pub(crate) mod canvas;
pub(crate) mod strokes;
mod svg;

use std::io::{self, Write};
use std::path::Path;

use impinge::Mesh;

use crate::failure::Failure;
use crate::output;
use camera::Camera;
use canvas::Canvas;
use strokes::Stroke;

/// The longer side of the picture, in pixels.
const LONGER_SIDE: u32 = 1600;

/// The forms of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureFormat {
    Png,
    Svg,
}

impl PictureFormat {
    /// What the extension asks for.
    ///
    /// # Errors
    /// Where it asks for neither.
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        match output::extension(path).as_str() {
            "png" => Ok(Self::Png),
            "svg" => Ok(Self::Svg),
            _ => Err(output::unknown_extension(path, ".png or .svg")),
        }
    }
}

/// The mesh as pixels, and the edges of the boxes as lines over them.
pub(super) struct Picture {
    canvas: Canvas,
    strokes: Vec<Stroke>,
}

impl Picture {
    /// Draws the mesh and the (least, greatest) corners of boxes, `up` being the axis that points up.
    pub(super) fn draw(mesh: &Mesh, boxes: &[[[f64; 3]; 2]], up: usize) -> Self {
        let camera = Camera::around(boxes, up, LONGER_SIDE);
        let mut canvas = Canvas::new(camera.size());
        for face in 0..mesh.faces().len() as u32 {
            let corners = mesh.corners(face);
            canvas.fill(corners.map(|corner| camera.project(corner)), camera.shade(&corners));
        }
        let strokes = strokes::of_boxes(boxes, &camera, &canvas);
        Self { canvas, strokes }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub(super) fn write(mut self, format: PictureFormat, out: &mut dyn Write) -> io::Result<()> {
        match format {
            PictureFormat::Png => {
                self.strokes.iter().for_each(|stroke| self.canvas.line(stroke));
                out.write_all(&self.canvas.png()?)
            }
            PictureFormat::Svg => svg::write(out, &self.canvas, &self.strokes),
        }
    }
}
