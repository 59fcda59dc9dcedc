//! Writes SVG: a picture as an embedded PNG image, and strokes as vectors over it.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::lines::Stroke;
use super::pixels::Picture;

/// Writes the file.
///
/// # Errors
/// Returns the errors of the output.
pub(super) fn write(out: &mut dyn Write, picture: &Picture, strokes: &[Stroke]) -> io::Result<()> {
    let [width, height] = picture.size();
    writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">"#
    )?;
    let image = STANDARD.encode(picture.png()?);
    writeln!(out, r#"<image width="{width}" height="{height}" href="data:image/png;base64,{image}"/>"#)?;
    writeln!(out, r#"<g fill="none" stroke-linecap="round">"#)?;
    // Consecutive strokes of the same style form one path.
    for alike in strokes.chunk_by(|a, b| (a.color, a.opacity, a.width) == (b.color, b.opacity, b.width)) {
        let [Stroke { color: [r, g, b], opacity, width, .. }, ..] = alike else { continue };
        write!(
            out,
            r##"<path stroke="#{r:02x}{g:02x}{b:02x}" stroke-opacity="{opacity}" stroke-width="{width}" d=""##
        )?;
        for Stroke { ends: [from, to], .. } in alike {
            write!(out, "M{:.1} {:.1}L{:.1} {:.1}", from[0], from[1], to[0], to[1])?;
        }
        writeln!(out, r#""/>"#)?;
    }
    writeln!(out, "</g>\n</svg>")
}
