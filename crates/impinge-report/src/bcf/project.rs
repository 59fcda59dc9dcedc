//! The files of an archive beside its topics: `bcf.version`, `project.bcfp` and `extensions.xml`.

use std::collections::BTreeSet;
use std::io;

use impinge::clash::Status;
use impinge_files::SceneAbout;
use uuid::Uuid;

use super::markup::AUTHOR;
use super::status::topic_status;
use super::topic::{Topic, guid};
use super::version::BcfVersion;
use super::xml::{Document, document, element, empty_document, text};

/// Returns the files with their names.
pub(super) fn files(
    topics: &[Topic<'_>],
    scenes: &[SceneAbout],
    version: BcfVersion,
) -> io::Result<Vec<(&'static str, Vec<u8>)>> {
    let stated = [("VersionId", version.name())];
    let id = match version {
        BcfVersion::V2 => document("Version", &stated, |element| text(element, "DetailedVersion", version.name())),
        BcfVersion::V3 => empty_document("Version", &stated),
    }?;
    let mut files = vec![("bcf.version", id), ("project.bcfp", project(scenes, version)?)];
    if version == BcfVersion::V3 {
        files.push(("extensions.xml", extensions(topics)?));
    }
    Ok(files)
}

/// Returns the identity and the name of the project of some scenes.
pub(super) fn project_of(scenes: &[SceneAbout]) -> (Uuid, String) {
    let labels: Vec<&str> = scenes.iter().map(|scene| scene.label.as_str()).collect();
    (guid(&format!("project/{}", labels.join("/"))), labels.join(" + "))
}

fn project(scenes: &[SceneAbout], version: BcfVersion) -> io::Result<Vec<u8>> {
    let (id, name) = project_of(scenes);
    let id = id.to_string();
    let project = |root: &mut Document| element(root, "Project", &[("ProjectId", &id)], |it| text(it, "Name", &name));
    match version {
        BcfVersion::V2 => document("ProjectExtension", &[], |root| {
            project(root)?;
            text(root, "ExtensionSchema", "")
        }),
        BcfVersion::V3 => document("ProjectInfo", &[], project),
    }
}

/// Lists the values that topics have.
fn extensions(topics: &[Topic<'_>]) -> io::Result<Vec<u8>> {
    let sorted = |values: Vec<&str>| values.into_iter().map(str::to_owned).collect::<BTreeSet<String>>();
    let priorities = sorted(topics.iter().map(|topic| topic.priority.as_str()).collect());
    let labels = sorted(topics.iter().flat_map(|topic| topic.labels.iter().map(String::as_str)).collect());
    let kinds = sorted(vec!["Clash", "Duplicate", "Contact", "Clearance"]);
    document("Extensions", &[], |root| {
        list(root, ["TopicTypes", "TopicType"], kinds)?;
        list(root, ["TopicStatuses", "TopicStatus"], Status::ALL.map(|status| topic_status(status).to_owned()))?;
        list(root, ["Priorities", "Priority"], priorities)?;
        list(root, ["TopicLabels", "TopicLabel"], labels)?;
        list(root, ["Users", "User"], [AUTHOR.to_owned()])
    })
}

fn list(root: &mut Document, [many, one]: [&str; 2], values: impl IntoIterator<Item = String>) -> io::Result<()> {
    element(root, many, &[], |list| values.into_iter().try_for_each(|value| text(list, one, &value)))
}
