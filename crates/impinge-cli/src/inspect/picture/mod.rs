//! Draws a mesh in gray with boxes over it, with a small software renderer. PNG files hold pixels
//! only; SVG files hold the mesh as pixels and the boxes as vectors.

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

/// Longer side of the picture, in pixels.
const LONGER_SIDE: u32 = 1600;

/// Format of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureFormat {
    Png,
    Svg,
}

impl PictureFormat {
    /// Returns the format that the extension of a path names.
    ///
    /// # Errors
    /// Returns an error if the extension is neither `.png` nor `.svg`.
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
    /// Draws the mesh and boxes, given by their (minimum, maximum) corners in the mesh frame. `up`
    /// is the axis that points up in the picture.
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

    /// Writes the picture as a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
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
