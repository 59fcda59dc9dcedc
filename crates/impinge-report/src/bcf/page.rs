//! The topics of a report as a page has them. The page adds the statuses that people edit, and
//! writes a BCF file (`viewer/src/bcf`) with the same identities and texts as
//! [`write_bcf`](super::write_bcf).

use impinge::clash::Report;
use impinge_files::{ReportAbout, Unit};
use serde::Serialize;

use super::archive::SIZE;
use super::markup::AUTHOR;
use super::project::project_of;
use super::topic::{Topic, topics};
use crate::picture::{COLOR_A, COLOR_B, FIELD_OF_VIEW};

/// Content of a BCF file that a page needs beside the report.
#[derive(Serialize)]
pub(crate) struct PageBcf {
    /// Identity and name of the project.
    project: [String; 2],
    author: &'static str,
    /// Colors of the two parts, each as six hexadecimal digits.
    colors: [String; 2],
    /// Vertical field of view in degrees.
    field_of_view: f64,
    /// Width and height of the pictures, in pixels.
    size: [u32; 2],
    topics: Vec<PageTopic>,
}

#[derive(Serialize)]
struct PageTopic {
    /// Identities of the topic, of its comment and of its viewpoint.
    guids: [String; 3],
    title: String,
    kind: &'static str,
    priority: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    labels: Vec<String>,
    /// Places of its clashes, or of its set of duplicates, in the list of the page.
    findings: Vec<usize>,
    /// Lines of the description about the parts of a set of duplicates.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    part_lines: Vec<String>,
}

impl PageBcf {
    /// Collects the topics of a report. `unit` is the unit of the scenes.
    pub(crate) fn new(report: &Report, about: &ReportAbout<'_>, unit: Unit) -> Self {
        let (id, name) = project_of(&about.scenes);
        Self {
            project: [id.to_string(), name],
            author: AUTHOR,
            colors: [COLOR_A, COLOR_B].map(|[r, g, b]| format!("{r:02X}{g:02X}{b:02X}")),
            field_of_view: FIELD_OF_VIEW,
            size: SIZE,
            topics: topics(report, about, unit).into_iter().map(PageTopic::new).collect(),
        }
    }
}

impl PageTopic {
    fn new(topic: Topic<'_>) -> Self {
        let guids = [topic.guid, topic.comment(), topic.viewpoint()];
        let Topic { title, kind, priority, labels, findings, part_lines, .. } = topic;
        Self { guids: guids.map(|guid| guid.to_string()), title, kind, priority, labels, findings, part_lines }
    }
}
