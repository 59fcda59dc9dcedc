//! The topics of a report: its groups of clashes, and its sets of duplicates.

use impinge::clash::{Clash, DuplicateSet, Group, Kind, Member, Report, Shared, Status};
use impinge_files::{ReportAbout, Unit, length_text};
use uuid::Uuid;

use super::description::{clash_line, duplicates_line};
use super::status::of_all;

/// The namespace of all identities in BCF files of impinge: version 5 of the address of the project
/// in the namespace of addresses.
const NAMESPACE: Uuid = Uuid::from_u128(0x6b0e_a3d1_3c5f_5b1e_9a57_1d2c_4f60_7e83);

/// Priority of a topic whose rule states no severity.
const USUAL_PRIORITY: &str = "normal";

/// A topic of a BCF file.
pub(super) struct Topic<'r> {
    pub(super) guid: Uuid,
    pub(super) title: String,
    /// `Clash`, `Duplicate`, `Contact` or `Clearance`.
    pub(super) kind: &'static str,
    pub(super) status: Status,
    pub(super) priority: String,
    pub(super) labels: Vec<String>,
    pub(super) description: String,
    /// Subject of the viewpoint.
    pub(super) shown: Shown<'r>,
    /// Two parts that the viewpoint shows.
    pub(super) parts: [&'r Member; 2],
    /// Places of the topic's findings in a list of all sets of duplicates, and then all clashes.
    pub(super) findings: Vec<usize>,
    /// A line of the description for each part of a set of duplicates.
    pub(super) part_lines: Vec<String>,
}

/// The subject of a viewpoint.
#[derive(Clone, Copy)]
pub(super) enum Shown<'r> {
    Clash(&'r Clash),
    Duplicates(&'r DuplicateSet),
}

impl Topic<'_> {
    /// Returns the identity of the comment.
    pub(super) fn comment(&self) -> Uuid {
        Uuid::new_v5(&self.guid, b"comment")
    }

    /// Returns the identity of the viewpoint.
    pub(super) fn viewpoint(&self) -> Uuid {
        Uuid::new_v5(&self.guid, b"viewpoint")
    }
}

/// Returns the identity of something that a text names.
pub(super) fn guid(name: &str) -> Uuid {
    Uuid::new_v5(&NAMESPACE, name.as_bytes())
}

/// Returns one topic for each group, or for each clash if there are no groups, and one for each set
/// of duplicates.
pub(super) fn topics<'r>(report: &'r Report, about: &ReportAbout<'_>, unit: Unit) -> Vec<Topic<'r>> {
    let length = |x: f64| length_text(x, Some(unit));
    let groups = report.groups.iter().map(|group| {
        let name = match &group.by {
            Shared::Part(part) => format!("part/{}", part.identity()),
            Shared::Types([a, b]) => format!("types/{a}/{b}"),
            Shared::Scenes([a, b]) => format!("scenes/{a}/{b}"),
        };
        (name, group.sentence(report, &length), group.clashes.clone())
    });
    let single = |at: usize| (report.clashes[at].id.clone(), report.clashes[at].sentence(&length), vec![at]);
    let all: Vec<(String, String, Vec<usize>)> = match report.groups[..] {
        [] => (0..report.clashes.len()).map(single).collect(),
        [Group { .. }, ..] => groups.collect(),
    };
    let sets = report.duplicates.len();
    let of_clashes = all.into_iter().map(|(name, title, places)| {
        let clashes: Vec<&Clash> = places.iter().map(|&at| &report.clashes[at]).collect();
        let findings = places.iter().map(|at| sets + at).collect();
        Topic { findings, ..of_clashes(&name, title, &clashes, about, unit) }
    });
    let of_sets =
        report.duplicates.iter().enumerate().map(|(at, set)| Topic { findings: vec![at], ..of_duplicates(set, about) });
    of_sets.chain(of_clashes).collect()
}

fn of_clashes<'r>(name: &str, title: String, clashes: &[&'r Clash], about: &ReportAbout<'_>, unit: Unit) -> Topic<'r> {
    let length = |x: f64| length_text(x, Some(unit));
    let worst = clashes[0];
    let mut lines = vec![format!("{title}.")];
    for clash in clashes {
        if let Some(why) = clash.why {
            lines.push(format!("{} is not proved: {why}.", clash.id));
        }
        if let Some(note) = &clash.note {
            lines.push(format!("{}: {note}", clash.id));
        }
    }
    lines.push(String::new());
    lines.extend(clashes.iter().map(|clash| clash_line(clash, unit, &clash.sentence(&length))));
    let severity = clashes.iter().find_map(|clash| clash.severity.clone());
    let scenes = clashes.iter().flat_map(|clash| [&clash.a.scene, &clash.b.scene]);
    let rules = clashes.iter().filter_map(|clash| clash.rule);
    Topic {
        guid: guid(name),
        title,
        kind: match worst.kind {
            Kind::Contact => "Contact",
            Kind::Clearance => "Clearance",
            _ => "Clash",
        },
        status: of_all(clashes.iter().map(|clash| clash.status)),
        priority: severity.unwrap_or_else(|| USUAL_PRIORITY.to_owned()),
        labels: labels(scenes, rules, about),
        description: lines.join("\n"),
        shown: Shown::Clash(worst),
        parts: [&worst.a, &worst.b],
        findings: Vec::new(),
        part_lines: Vec::new(),
    }
}

fn of_duplicates<'r>(set: &'r DuplicateSet, about: &ReportAbout<'_>) -> Topic<'r> {
    let title = set.sentence();
    let mut lines = vec![format!("{title}.")];
    lines.extend(set.note.iter().map(|note| format!("{}: {note}", set.id)));
    let part_lines: Vec<String> =
        set.parts.iter().map(|part| format!("- {} ({})", part.in_words(), part.identity())).collect();
    lines.extend_from_slice(&part_lines);
    lines.extend([String::new(), duplicates_line(set)]);
    Topic {
        guid: guid(&set.id),
        title,
        kind: "Duplicate",
        status: set.status,
        priority: set.severity.clone().unwrap_or_else(|| USUAL_PRIORITY.to_owned()),
        labels: labels(set.parts.iter().map(|part| &part.scene), set.rule.into_iter(), about),
        description: lines.join("\n"),
        shown: Shown::Duplicates(set),
        parts: [&set.parts[0], &set.parts[1]],
        findings: Vec::new(),
        part_lines,
    }
}

/// Returns the labels of the scenes and the names of the rules, each once, sorted.
fn labels<'l>(
    scenes: impl Iterator<Item = &'l String>,
    rules: impl Iterator<Item = usize>,
    about: &ReportAbout<'_>,
) -> Vec<String> {
    let known = about.rules.map_or(&[][..], |rules| &rules.rules);
    let names = rules.filter_map(|rule| known.get(rule)).map(|rule| rule.name.clone());
    let mut labels: Vec<String> = scenes.cloned().chain(names).filter(|label| !label.trim().is_empty()).collect();
    labels.sort_unstable();
    labels.dedup();
    labels
}
