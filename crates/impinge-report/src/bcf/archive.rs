//! The archive: a ZIP file of all topics.

use std::io::{self, Cursor, Write};

use impinge::clash::{Report, Side};
use impinge_files::{ReportAbout, Unit};
use rayon::prelude::*;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::date::date_time;
use super::frame::Frame;
use super::markup::{SNAPSHOT, VIEWPOINT, markup};
use super::project;
use super::topic::{Shown, Topic, topics};
use super::version::BcfVersion;
use super::viewpoint::viewpoint;
use crate::picture::{Axis, Gallery};

/// Width and height of the pictures, in pixels.
pub(super) const SIZE: [u32; 2] = [800, 600];

/// How to write a BCF file.
#[derive(Clone, Copy, Debug)]
pub struct BcfOptions {
    /// Version of the file.
    pub version: BcfVersion,
    /// Unit of the scenes. BCF is in meters.
    pub unit: Unit,
    /// The axis of the scenes that points up: Y for glTF. In BCF it is Z.
    pub up: Axis,
    /// Date of the topics, in seconds since the start of 1970. No clock is read, so that the same
    /// report gives the same bytes.
    pub date: i64,
}

/// A topic with the content of its files.
struct Files {
    folder: String,
    markup: Vec<u8>,
    /// The viewpoint and the picture; `None` if a part is unbounded.
    view: Option<[Vec<u8>; 2]>,
}

/// Writes a report as BCF: one topic for each group of clashes, or for each clash without groups,
/// and one for each set of duplicates. Returns the number of topics.
///
/// Each topic has a viewpoint on its worst clash, and a picture of it. Identities are UUIDs of
/// version 5 of what the clashes of a group share, so that a later report updates the topics.
/// Coordinates are in meters, with Z up, and with the origin of the scenes added.
///
/// ```
/// use impinge::clash::{self, Options, Side};
/// use impinge::query::batch::Execution;
/// use impinge::scene::Scene;
/// use impinge::{Pose, Shape};
/// use impinge_files::{ReportAbout, Unit};
/// use impinge_report::bcf::{BcfOptions, BcfVersion, parse_previous_bcf, write_bcf};
/// use impinge_report::picture::Axis;
///
/// let cube = Shape::cuboid([0.5; 3])?;
/// let mut scene = Scene::new();
/// scene.add("a", &cube, Pose::IDENTITY)?;
/// scene.add("b", &cube, Pose::from_translation([0.75, 0.25, 0.25])?)?;
/// let sides = [Side { label: "cubes".to_owned(), scene: &scene }];
/// let report = clash::find(&sides, Options::new(0.001), Execution::default())?;
/// let options = BcfOptions { version: BcfVersion::V3, unit: Unit::Meter, up: Axis::Z, date: 0 };
/// let mut file = Vec::new();
/// assert_eq!(write_bcf(&mut file, &report, &ReportAbout::default(), &sides, &options)?, 1);
/// let previous = parse_previous_bcf(&file, Unit::Meter)?;
/// assert_eq!(previous.clashes[0].id, report.clashes[0].id);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns the errors of the output.
pub fn write_bcf(
    out: &mut dyn Write,
    report: &Report,
    about: &ReportAbout<'_>,
    sides: &[Side<'_>],
    options: &BcfOptions,
) -> io::Result<usize> {
    let &BcfOptions { version, unit, up, date } = options;
    let topics = topics(report, about, unit);
    let origin = about.scenes.iter().find_map(|scene| scene.origin).unwrap_or_default();
    let frame = Frame { unit, up, origin };
    let gallery = Gallery::new(sides, Some(unit), up, SIZE).with_perspective().with_axes(frame.axes());
    let date = date_time(date);
    let files = |topic: &Topic<'_>| -> io::Result<Files> {
        let view = match topic.shown {
            Shown::Clash(clash) => gallery.clash(clash),
            Shown::Duplicates(set) => gallery.duplicates(set),
        };
        let markup = markup(topic, &about.scenes, &date, version, view.is_some())?;
        let view = match view {
            Some(view) => Some([viewpoint(topic, &view, &frame, version, SIZE)?, view.draw().png()?]),
            None => None,
        };
        Ok(Files { folder: topic.guid.to_string(), markup, view })
    };
    let all: Vec<Files> = topics.par_iter().map(files).collect::<io::Result<_>>()?;

    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in project::files(&topics, &about.scenes, version)? {
        add(&mut archive, name, &content)?;
    }
    for Files { folder, markup, view } in &all {
        add(&mut archive, &format!("{folder}/markup.bcf"), markup)?;
        for (name, content) in [VIEWPOINT, SNAPSHOT].iter().zip(view.iter().flatten()) {
            add(&mut archive, &format!("{folder}/{name}"), content)?;
        }
    }
    out.write_all(archive.finish().map_err(io::Error::other)?.get_ref())?;
    Ok(topics.len())
}

fn add(archive: &mut ZipWriter<Cursor<Vec<u8>>>, name: &str, content: &[u8]) -> io::Result<()> {
    // The default date of a file in an archive is fixed.
    archive.start_file(name, SimpleFileOptions::DEFAULT).map_err(io::Error::other)?;
    archive.write_all(content)
}
