//! The file `markup.bcf` of a topic.

use std::io;
use std::path::Path;

use impinge_files::SceneAbout;

use super::status::topic_status;
use super::topic::Topic;
use super::version::BcfVersion;
use super::xml::{Document, document, element, empty, text};

/// Author of topics and comments.
pub(super) const AUTHOR: &str = "impinge";

/// Name of the viewpoint in a topic's folder. Some programs accept no other.
pub(super) const VIEWPOINT: &str = "viewpoint.bcfv";
/// Name of the picture in a topic's folder. Some programs accept no other.
pub(super) const SNAPSHOT: &str = "snapshot.png";

/// Returns the file. `has_view` states whether there is a viewpoint.
pub(super) fn markup(
    topic: &Topic<'_>,
    scenes: &[SceneAbout],
    date: &str,
    version: BcfVersion,
    has_view: bool,
) -> io::Result<Vec<u8>> {
    document("Markup", &[], |markup| {
        header(markup, scenes, version)?;
        let guid = topic.guid.to_string();
        let attributes =
            [("Guid", guid.as_str()), ("TopicType", topic.kind), ("TopicStatus", topic_status(topic.status))];
        element(markup, "Topic", &attributes, |element| {
            fields(element, topic, date, version)?;
            if version == BcfVersion::V3 && has_view {
                list(element, "Comments", |list| comment(list, topic, date))?;
                list(element, "Viewpoints", |list| viewpoint(list, "ViewPoint", topic))?;
            }
            Ok(())
        })?;
        if version == BcfVersion::V2 && has_view {
            comment(markup, topic, date)?;
            viewpoint(markup, "Viewpoints", topic)?;
        }
        Ok(())
    })
}

/// Writes the names of the scenes' files.
fn header(markup: &mut Document, scenes: &[SceneAbout], version: BcfVersion) -> io::Result<()> {
    let name = |file: &str| Path::new(file).file_name().map(|name| name.to_string_lossy().into_owned());
    let names: Vec<String> = scenes.iter().filter_map(|scene| name(scene.file.as_ref()?)).collect();
    let is_external = match version {
        BcfVersion::V2 => "isExternal",
        BcfVersion::V3 => "IsExternal",
    };
    let files = |header: &mut Document| {
        names
            .iter()
            .try_for_each(|name| element(header, "File", &[(is_external, "true")], |file| text(file, "Filename", name)))
    };
    match (names.is_empty(), version) {
        (true, _) => Ok(()),
        (false, BcfVersion::V2) => list(markup, "Header", files),
        (false, BcfVersion::V3) => list(markup, "Header", |header| list(header, "Files", files)),
    }
}

fn fields(element: &mut Document, topic: &Topic<'_>, date: &str, version: BcfVersion) -> io::Result<()> {
    text(element, "Title", &topic.title)?;
    text(element, "Priority", &topic.priority)?;
    match version {
        BcfVersion::V2 => topic.labels.iter().try_for_each(|label| text(element, "Labels", label))?,
        BcfVersion::V3 => {
            list(element, "Labels", |list| topic.labels.iter().try_for_each(|label| text(list, "Label", label)))?;
        }
    }
    text(element, "CreationDate", date)?;
    text(element, "CreationAuthor", AUTHOR)?;
    text(element, "Description", &topic.description)
}

/// Writes the comment that names the viewpoint.
fn comment(parent: &mut Document, topic: &Topic<'_>, date: &str) -> io::Result<()> {
    let guid = topic.comment().to_string();
    element(parent, "Comment", &[("Guid", &guid)], |comment| {
        text(comment, "Date", date)?;
        text(comment, "Author", AUTHOR)?;
        text(comment, "Comment", &format!("The viewpoint shows it: {}.", topic.title))?;
        empty(comment, "Viewpoint", &[("Guid", &topic.viewpoint().to_string())])
    })
}

fn viewpoint(parent: &mut Document, name: &str, topic: &Topic<'_>) -> io::Result<()> {
    element(parent, name, &[("Guid", &topic.viewpoint().to_string())], |viewpoint| {
        text(viewpoint, "Viewpoint", VIEWPOINT)?;
        text(viewpoint, "Snapshot", SNAPSHOT)
    })
}

fn list(parent: &mut Document, name: &str, content: impl FnOnce(&mut Document) -> io::Result<()>) -> io::Result<()> {
    element(parent, name, &[], content)
}
