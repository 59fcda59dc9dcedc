//! One page of HTML that shows an answer, for people who have nothing installed: a report of
//! clashes, two meshes, the hierarchy of a mesh, or a robot.
//!
//! The page is a template (`assets/viewer.html`, which `viewer/` builds) with blocks of data. The
//! names of the blocks tell the page what it shows. Each block is deflated and in base64. The page
//! makes no request, so that it can be opened from a disk or sent by mail.
//!
//! A report of clashes has the report as JSON, and `facts`: sentences and names. `pair`,
//! `hierarchy` and `robot` write the other pages, with their facts in `about`. `parts` chooses the
//! parts that are drawn in full, and `surface` has the triangles of shapes. `quantized` and
//! `integers` write meshes in few bytes, `curves` the intersection curves, `geometry` the block of
//! both, and `block` any block. The reader is `viewer/src/data`. Guarded by `tests/html.rs` and
//! `viewer/test`.

mod about;
mod block;
mod curves;
mod facts;
mod geometry;
mod hierarchy;
mod integers;
mod pair;
mod parts;
mod quantized;
mod robot;
mod surface;

use std::io::{self, Write};

use impinge::clash::{Report, Side};
use impinge_files::{ReportAbout, write_clash_json};

use crate::picture::Axis;
use block::write_block;
use curves::Curves;
use parts::Drawn;

pub use about::PageAbout;
pub use hierarchy::write_hierarchy_page;
pub use pair::{PairPage, write_pair_page};
pub use robot::{RobotPage, RobotStep, StepVerdict, write_robot_page};

/// The page without data.
const TEMPLATE: &str = include_str!("../../assets/viewer.html");

/// The place of the data in the template.
const MARK: &str = "<!--data-->";

/// Maximum number of triangles in a page; instances of one mesh count once. A triangle takes about
/// 5 bytes, so a page has at most about 5 MB of geometry.
const MAX_TRIANGLES: usize = 1_000_000;

/// Maximum number of clashes whose intersection curves are in a page: the worst ones. Each takes
/// about 0.2 ms of time and 200 bytes.
const MAX_CURVES: usize = 2000;

/// Writes a page that shows a report of clashes. `sides` are the scenes of the report, in the order
/// of `about.scenes`, `up` is the axis that points up, and `version` the version of the program.
///
/// All parts are drawn in full, if they have no more triangles than the page holds. Otherwise parts
/// of clashes come first, then their neighbors, and the rest are boxes. The page states how many.
/// Positions are rounded to 16 bits in the box of the part, and the page states the largest error.
///
/// The same input gives the same bytes. Curves are computed on the threads of the current rayon
/// pool.
///
/// # Errors
/// Returns the errors of the output.
///
/// ```
/// use impinge::clash::{self, Options, Side};
/// use impinge::query::batch::Execution;
/// use impinge::scene::Scene;
/// use impinge::{Mesh, Pose, Positions};
/// use impinge_files::{ReportAbout, SceneAbout};
/// use impinge_report::picture::Axis;
///
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let mesh = Mesh::new(Positions::F64(corners), faces)?;
/// let mut scene = Scene::new();
/// scene.add("left", &mesh, Pose::IDENTITY)?;
/// scene.add("right", &mesh, Pose::from_translation([0.25, 0.0, 0.0])?)?;
///
/// let sides = [Side { label: "model".to_owned(), scene: &scene }];
/// let report = clash::find(&sides, Options::new(1e-6), Execution::default())?;
/// let about = ReportAbout { scenes: vec![SceneAbout::new("model", &scene)], ..ReportAbout::default() };
/// let mut page = Vec::new();
/// impinge_report::html::write_clash_page(&mut page, &sides, &report, &about, Axis::Z, "0.1.0")?;
/// assert!(page.starts_with(b"<!doctype html>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_clash_page(
    out: &mut dyn Write,
    sides: &[Side<'_>],
    report: &Report,
    about: &ReportAbout<'_>,
    up: Axis,
    version: &str,
) -> io::Result<()> {
    let mut json = Vec::new();
    write_clash_json(&mut json, report, about, version)?;
    let drawn = Drawn::choose(sides, report, MAX_TRIANGLES);
    let curves = Curves::of(sides, report, MAX_CURVES);
    let geometry = geometry::bytes(&drawn, &curves);
    let facts = facts::json(sides, report, about, up, &drawn, &curves)?;

    write_page(out, &[("report", &json), ("facts", &facts), ("geometry", &geometry)])
}

/// Writes the template with blocks of data, each with a name.
fn write_page(out: &mut dyn Write, blocks: &[(&str, &[u8])]) -> io::Result<()> {
    let (head, tail) = TEMPLATE.split_once(MARK).unwrap_or((TEMPLATE, ""));
    out.write_all(head.as_bytes())?;
    blocks.iter().try_for_each(|(name, bytes)| write_block(out, name, bytes))?;
    out.write_all(tail.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_has_one_place_for_data_and_asks_for_nothing_else() {
        assert_eq!(TEMPLATE.matches(MARK).count(), 1);
        let head = TEMPLATE.split("<script").next().unwrap();
        assert!(head.contains("default-src 'none'"), "the page could make requests");
    }
}
