//! A page about the hierarchy of a mesh: the boxes of each level.

use std::io::{self, Write};

use impinge::hierarchy::MAX_DEPTH;
use impinge::{Mesh, Pose};
use serde::Serialize;

use super::about::{PageAbout, json};
use super::curves::Curves;
use super::integers::push_integer;
use super::parts::Drawn;
use super::quantized::{Frame, push_points};
use super::{MAX_TRIANGLES, geometry, write_page};

/// Maximum number of boxes of a level. More hide each other, and take about 8 bytes each.
const MAX_BOXES: usize = 20_000;

#[derive(Serialize)]
struct Content {
    kind: &'static str,
    /// Number of levels of the hierarchy. The page has the first of them.
    levels: usize,
    max_boxes: usize,
}

/// Writes a page that shows a mesh and the boxes of its hierarchy, level by level.
///
/// Levels with more than 20,000 boxes are left out, and the page states how many. The same input
/// gives the same bytes.
///
/// # Errors
/// Returns the errors of the output.
pub fn write_hierarchy_page(out: &mut dyn Write, name: &str, mesh: &Mesh, about: &PageAbout<'_>) -> io::Result<()> {
    let drawn = Drawn::of(&[(mesh.clone(), Pose::IDENTITY)], MAX_TRIANGLES);
    // All levels below the deepest leaf are equal.
    let levels = mesh.tree_statistics().depth.min(MAX_DEPTH) + 1;
    let boxes: Vec<Vec<[[f64; 3]; 2]>> =
        (0..levels).map(|level| mesh.tree_level(level)).take_while(|boxes| boxes.len() <= MAX_BOXES).collect();
    let content = Content { kind: "hierarchy", levels, max_boxes: MAX_BOXES };
    let view = json(about, &[[name.to_owned(), String::new()]], &drawn, content)?;
    let geometry = geometry::bytes(&drawn, &Curves::none());
    write_page(out, &[("answer", &view), ("geometry", &geometry), ("levels", &bytes(&boxes))])
}

/// Returns the number of levels; then, if there are boxes, the box around all of them, and for each
/// level the number of its boxes and their corners.
fn bytes(levels: &[Vec<[[f64; 3]; 2]>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let Some(frame) = Frame::around(levels.iter().flatten().flatten().copied()) else {
        push_integer(&mut bytes, 0);
        return bytes;
    };
    push_integer(&mut bytes, levels.len() as u64);
    frame.push(&mut bytes);
    for boxes in levels {
        push_integer(&mut bytes, boxes.len() as u64);
        push_points(&mut bytes, &boxes.iter().flatten().map(|&corner| frame.steps(corner)).collect::<Vec<_>>());
    }
    bytes
}
