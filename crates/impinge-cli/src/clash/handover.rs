//! What people hand on: pictures and BCF files. BCF files are also read back.

use std::collections::HashSet;
use std::path::Path;
use std::time::UNIX_EPOCH;

use impinge::clash::{Previous, Report, Side};
use impinge_files::{Limits, ReportAbout, Unit, load_previous};
use impinge_report::bcf::{BcfOptions, BcfVersion, is_bcf, load_previous_bcf, write_bcf};
use impinge_report::picture::{self, Gallery, View};

use super::scenes::Loaded;
use super::{Arguments, BcfVersionArgument};
use crate::check::timed;
use crate::failure::Failure;
use crate::numerals::counted;
use crate::progress::Bar;
use crate::{console, output};

/// Maximum number of pictures. More take minutes, and nobody looks at them.
const MAX_PICTURES: usize = 100;

/// Width and height of a picture, in pixels.
const SIZE: [u32; 2] = [1280, 960];

/// Numbers of the files that were written.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HandedOver {
    /// Number of pictures, and of groups and duplicate sets that might have one.
    pub(super) pictures: Option<[usize; 2]>,
    /// Number of topics in the BCF file.
    pub(super) topics: Option<usize>,
}

impl HandedOver {
    /// Reports whether a file with pictures was written.
    pub(super) fn is_any(self) -> bool {
        self.pictures.is_some() || self.topics.is_some()
    }
}

/// Validates the folder of the pictures: it exists, or its parent does.
pub(super) fn validate_folder(path: &Path) -> Result<(), Failure> {
    if path.exists() && !path.is_dir() {
        let failure = Failure::new("output", "the pictures need a folder, and this is a file").in_file(path);
        return Err(failure.hint("choose another name"));
    }
    if path.is_dir() { Ok(()) } else { output::validate(path, &[]) }
}

/// Loads a report that was written before, as JSON or as BCF.
pub(super) fn previous(path: &Path, unit: Option<Unit>, limits: &Limits) -> Result<Previous, Failure> {
    if !is_bcf(path) {
        return Ok(load_previous(path, unit, limits)?);
    }
    let unit = unit.ok_or_else(|| no_unit("--previous"))?;
    load_previous_bcf(path, unit).map_err(|error| Failure::new("bcf", error.to_string()).in_file(path))
}

/// Returns the axis that points up: the one that was asked for, or that of the format.
pub(super) fn up(arguments: &Arguments, loaded: &[Loaded]) -> picture::Axis {
    match arguments.up {
        Some(axis) => axis.into(),
        None if loaded.iter().any(|scene| scene.is_gltf) => picture::Axis::Y,
        None => picture::Axis::Z,
    }
}

/// Writes the requested pictures and the BCF file.
pub(super) fn write(
    arguments: &Arguments,
    loaded: &[Loaded],
    sides: &[Side<'_>],
    report: &Report,
    about: &ReportAbout<'_>,
) -> Result<HandedOver, Failure> {
    let up = up(arguments, loaded);
    let mut written = HandedOver::default();
    if let Some(folder) = &arguments.pictures {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::from_io(&error, "cannot be created").in_file(folder))?;
        written.pictures = Some(write_pictures(folder, &Gallery::new(sides, about.unit, up, SIZE), report)?);
    }
    if let Some(path) = &arguments.bcf {
        let version = match arguments.bcf_version {
            BcfVersionArgument::V2 => BcfVersion::V2,
            BcfVersionArgument::V3 => BcfVersion::V3,
        };
        let unit = about.unit.ok_or_else(|| no_unit("--bcf"))?;
        let options = BcfOptions { version, unit, up, date: date(loaded) };
        let (bytes, _) = timed("drawing", || {
            let mut bytes = Vec::new();
            write_bcf(&mut bytes, report, about, sides, &options).map(|topics| (bytes, topics))
        });
        let (bytes, topics) = bytes.map_err(|error| Failure::from_io(&error, "cannot be made").in_file(path))?;
        output::write(path, |out| out.write_all(&bytes))?;
        written.topics = Some(topics);
    }
    Ok(written)
}

/// Draws the worst clash of each group, or each clash without groups, and the sets of duplicates.
fn write_pictures(folder: &Path, gallery: &Gallery<'_>, report: &Report) -> Result<[usize; 2], Failure> {
    let worst: Vec<usize> = match report.groups[..] {
        [] => (0..report.clashes.len()).collect(),
        _ => report.groups.iter().map(|group| group.clashes[0]).collect(),
    };
    let clashes = worst.iter().map(|&at| &report.clashes[at]).map(|clash| (&clash.id, gallery.clash(clash)));
    let sets = report.duplicates.iter().map(|set| (&set.id, gallery.duplicates(set)));
    let all = worst.len() + report.duplicates.len();
    let bar = Bar::begin("drawing", all.min(MAX_PICTURES) as u64);
    let mut written = HashSet::new();
    let views: &mut dyn Iterator<Item = (&String, Option<View<'_>>)> = &mut clashes.chain(sets);
    for (id, view) in views.take(MAX_PICTURES) {
        if let Some(view) = view {
            let picture = view.draw();
            let name = format!("{id}.png");
            output::write(&folder.join(&name), |out| out.write_all(&picture.png()?))?;
            written.insert(name);
        }
        bar.advance_by(1);
    }
    let others = other_pictures(folder, &written);
    if others > 0 {
        let folder = folder.display();
        console::note(&format!("{folder} has {} that this report did not write", counted(others, "other picture")));
    }
    Ok([written.len(), all])
}

/// Returns the number of pictures in a folder that do not have one of the names.
fn other_pictures(folder: &Path, names: &HashSet<String>) -> usize {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names_of_files = files.map(|file| file.file_name().to_string_lossy().into_owned());
    names_of_files.filter(|name| name.ends_with(".png") && !names.contains(name)).count()
}

/// Returns the date of a report: that of the newest scene, so that the same files give the same
/// bytes. The variable `SOURCE_DATE_EPOCH` replaces it.
fn date(loaded: &[Loaded]) -> i64 {
    let stated = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.parse().ok());
    let of_scene = |scene: &Loaded| {
        let age = scene.path.metadata().ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        i64::try_from(age.as_secs()).ok()
    };
    stated.unwrap_or_else(|| loaded.iter().filter_map(of_scene).max().unwrap_or(0))
}

fn no_unit(option: &str) -> Failure {
    Failure::new("unit", "BCF is in meters, and the scenes state no unit")
        .at(option)
        .hint("state the unit of the scenes with --unit")
}
