//! The text report.

use std::fmt::Write;

use anstyle::{AnsiColor, Style};
use impinge::clash::{DepthGap, Status};
use impinge_files::{Repaired, SceneAbout, escaped, length_text};

use super::{Outcome, Seconds};
use crate::numerals::{count, counted, length, time};

const STRONG: Style = Style::new().bold();
const FAINT: Style = Style::new().dimmed();
const CLEAR: Style = Style::new().bold().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Green)));
const COLLISION: Style = Style::new().bold().fg_color(Some(anstyle::Color::Ansi(AnsiColor::Red)));

/// Maximum number of groups, and of sets of duplicates, that the report shows.
const SHOWN: usize = 10;

/// Returns the report with ANSI styles; the output stream keeps or strips them.
pub(super) fn text(outcome: &Outcome<'_>) -> String {
    let mut text = scenes(outcome);
    text += &asked(outcome);
    text += &verdict(outcome);
    text += &kinds(outcome);
    text += &depths(outcome);
    text += &groups(outcome);
    text += &rules(outcome);
    text += &statuses(outcome);
    text += &files(outcome);
    let Seconds { load, search, draw } = outcome.seconds;
    let draw = draw.map_or(String::new(), |draw| format!(", draw {}", time(draw)));
    // Writing to a String cannot fail.
    let _ = writeln!(text, "\n{FAINT}time      {FAINT:#}load {}, search {}{draw}", time(load), time(search));
    text
}

/// Returns a line for each scene: unit, parts, extent and open parts. The columns are aligned.
fn scenes(outcome: &Outcome<'_>) -> String {
    let rows: Vec<[String; 6]> = outcome.scenes().iter().map(|scene| scene_row(outcome, scene)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        let [label, file, parts, triangles, extents, open] = row;
        let [label_width, file_width, parts_width, triangles_width, extents_width, _] = widths;
        let line = format!(
            "{STRONG}{label:<label_width$}{STRONG:#}  {file:<file_width$}  {parts:>parts_width$}  \
             {triangles:>triangles_width$}  {extents:<extents_width$}  {open}"
        );
        text += line.trim_end();
        text += "\n";
    }
    text += &repairs(outcome.scenes());
    if outcome.scenes().iter().any(|scene| scene.open > 0) {
        let _ = writeln!(
            text,
            "{FAINT}Depths of open parts are estimates: the inside of an open part is not certain.{FAINT:#}"
        );
    }
    let repairable: usize = outcome.scenes().iter().map(|scene| scene.repairable).sum();
    if repairable > 0 {
        let _ = writeln!(text, "{FAINT}--repair improves {} of them.{FAINT:#}", count(repairable));
    }
    text
}

/// Returns what `--repair` changed in each scene.
fn repairs(scenes: &[SceneAbout]) -> String {
    let line = |scene: &SceneAbout| {
        let Repaired { parts, closed, turned_faces, welded_vertices } = scene.repaired?;
        let welded = if welded_vertices == 1 { "vertex" } else { "vertices" };
        let changes = format!("{} turned, {} {welded} welded", counted(turned_faces, "face"), count(welded_vertices));
        let parts = counted(parts, "part");
        Some(format!(
            "{FAINT}repaired  {FAINT:#}{}  {parts}, {} closed now: {changes}\n",
            escaped(&scene.label),
            count(closed)
        ))
    };
    scenes.iter().filter_map(line).collect()
}

fn scene_row(outcome: &Outcome<'_>, scene: &SceneAbout) -> [String; 6] {
    let unit = outcome.about.unit.map_or("(no unit)", |unit| unit.symbol());
    let extents = match scene.bounds {
        Some([min, max]) => [0, 1, 2].map(|k| length(max[k] - min[k])).join(" x "),
        None => "empty".to_owned(),
    };
    [
        escaped(&scene.label),
        escaped(scene.file.as_deref().unwrap_or_default()),
        counted(scene.parts, "part"),
        counted(scene.triangles, "triangle"),
        format!("{extents} {unit}"),
        if scene.open == 0 { String::new() } else { counted(scene.open, "open part") },
    ]
}

/// Returns the question in words.
fn asked(outcome: &Outcome<'_>) -> String {
    let asked = &outcome.about.asked;
    let length = |x: f64| length_text(x, outcome.about.unit);
    let rules = outcome.about.rules.map_or(&[][..], |rules| &rules.rules);
    let pairs = match (rules.is_empty(), asked.between) {
        (true, false) => "all pairs of parts",
        (true, true) => "parts of different scenes",
        (false, false) => "pairs of parts that a rule names",
        (false, true) => "parts of different scenes that a rule names",
    };
    let mut parts = vec![pairs.to_owned()];
    let default = match (asked.default_tolerance, rules.iter().any(|rule| rule.tolerance.is_some())) {
        (true, false) => " (the default)",
        (true, true) => " (the default), or than the tolerance of the rule",
        (false, true) => ", or than the tolerance of the rule",
        (false, false) => "",
    };
    let sag = asked.sag.map_or(String::new(), |sag| format!(" plus twice the sag of {}", length(sag)));
    parts.push(format!("common material deeper than {}{default}{sag}", length(asked.tolerance)));
    parts.extend(asked.clearance.map(|clearance| format!("gaps of at most {}", length(clearance))));
    if asked.contacts {
        parts.push("contacts".to_owned());
    }
    let mut text = format!("\n{FAINT}asked     {FAINT:#}{}\n", parts.join("; "));
    let files = [("rules", &asked.rules), ("accepted", &asked.accept), ("previous", &asked.previous)];
    for (label, file) in files {
        if let Some(file) = file {
            let _ = writeln!(text, "{FAINT}{label:<10}{FAINT:#}{}", escaped(file));
        }
    }
    text
}

/// Returns the headline, which agrees with the exit code.
fn verdict(outcome: &Outcome<'_>) -> String {
    let report = &outcome.report;
    let listed = report.counts.contained + report.counts.clash + report.counts.undecided;
    let mut parts = Vec::new();
    if listed > 0 {
        parts.push(format!("{} {}", count(listed), if listed == 1 { "clash" } else { "clashes" }));
    }
    if !report.duplicates.is_empty() {
        parts.push(counted(report.duplicates.len(), "duplicate set"));
    }
    if report.counts.clearance > 0 {
        parts.push(counted(report.counts.clearance, "narrow gap"));
    }
    let (style, headline) = match (report.is_clear(), parts.is_empty()) {
        (true, true) => (CLEAR, "No clashes".to_owned()),
        (true, false) => (CLEAR, format!("{}, all approved", parts.join(", "))),
        (false, _) => (COLLISION, parts.join(", ")),
    };
    format!("\n{style}{headline}{style:#}\n")
}

/// Returns the number of pairs of each kind.
fn kinds(outcome: &Outcome<'_>) -> String {
    let counts = &outcome.report.counts;
    let asked = &outcome.about.asked;
    let has_clearance = asked.clearance.is_some() || counts.clearance > 0;
    let rows = [
        ("duplicate", counts.duplicate, "same shape in the same place", true),
        ("contained", counts.contained, "one part lies inside the other", true),
        ("clash", counts.clash, "common material deeper than the tolerance", true),
        ("undecided", counts.undecided, "not decided, so they count as clashes", counts.undecided > 0),
        ("contact", counts.contact, "they touch", asked.contacts),
        ("clearance", counts.clearance, "the gap is too small", has_clearance),
    ];
    let mut text = String::new();
    for (kind, pairs, meaning, is_shown) in rows {
        if is_shown {
            let _ = writeln!(text, "  {kind:<10}{:>11}  {FAINT}{meaning}{FAINT:#}", count(pairs));
        }
    }
    let _ = writeln!(
        text,
        "  {:<10}{:>11}  {FAINT}pairs whose boxes are near{FAINT:#}",
        "compared",
        count(compared(outcome))
    );
    text
}

fn compared(outcome: &Outcome<'_>) -> usize {
    let counts = &outcome.report.counts;
    counts.candidates - counts.unchecked - counts.ignored
}

/// Returns the number of pairs in each decade of depth, and the widest gap.
fn depths(outcome: &Outcome<'_>) -> String {
    let decades = &outcome.report.decades;
    if decades.decades.is_empty() {
        return String::new();
    }
    let length = |x: f64| length_text(x, outcome.about.unit);
    let mut text = format!("\n{FAINT}depth{FAINT:#}\n");
    for decade in &decades.decades {
        let range = match decade.from {
            0.0 => format!("below {}", length(decade.to)),
            from => format!("{} to {}", length(from), length(decade.to)),
        };
        let _ = writeln!(text, "  {range:<24} {:>11}", counted(decade.count, "pair"));
    }
    if let Some(gap) = &decades.gap {
        let _ = writeln!(text, "  {}", gap_sentence(gap, outcome.about.asked.tolerance, &length));
    }
    text
}

fn gap_sentence(gap: &DepthGap, tolerance: f64, length: &dyn Fn(f64) -> String) -> String {
    let between = match gap.inside {
        0 => "none between".to_owned(),
        few => format!("{} between", count(few)),
    };
    let place = if (gap.from..gap.to).contains(&tolerance) {
        format!("{} lies in the gap", length(tolerance))
    } else {
        format!("the tolerance of {} is outside this gap", length(tolerance))
    };
    let overlap = if gap.below == 1 { "overlaps" } else { "overlap" };
    format!(
        "{} {overlap} by about {} or less, {} by about {} or more, {between}: {place}",
        counted(gap.below, "pair"),
        length(gap.from),
        count(gap.above),
        length(gap.to)
    )
}

/// Returns the largest groups and the first sets of duplicates.
fn groups(outcome: &Outcome<'_>) -> String {
    let report = &outcome.report;
    let length = |x: f64| length_text(x, outcome.about.unit);
    let mut text = String::new();
    let mut section = |title: &str, total: usize, lines: Vec<String>| {
        if total > 0 {
            let of_all =
                if total > lines.len() { format!(", {} of {}", lines.len(), count(total)) } else { String::new() };
            let _ = writeln!(text, "\n{FAINT}{title}{of_all}{FAINT:#}");
            lines.iter().for_each(|line| text += &format!("  {}\n", escaped(line)));
        }
    };
    let line = |id: &str, sentence: String| format!("{id}  {sentence}");
    let groups = report.groups.iter().take(SHOWN);
    let groups =
        groups.map(|group| line(&report.clashes[group.clashes[0]].id, group.sentence(report, &length))).collect();
    section("groups, the largest first, each with its worst clash", report.groups.len(), groups);
    if report.groups.is_empty() {
        let clashes = report.clashes.iter().take(SHOWN);
        let clashes = clashes.map(|clash| line(&clash.id, clash.sentence(&length))).collect();
        section("worst clashes", report.clashes.len(), clashes);
    }
    let sets = report.duplicates.iter().take(SHOWN).map(|set| line(&set.id, set.sentence())).collect();
    section("duplicates", report.duplicates.len(), sets);
    text
}

/// Returns the number of pairs that each rule and each ignore named.
fn rules(outcome: &Outcome<'_>) -> String {
    let Some(rules) = outcome.about.rules else { return String::new() };
    let report = &outcome.report;
    let mut text = String::new();
    if !rules.rules.is_empty() {
        let _ = writeln!(text, "\n{FAINT}pairs by rule{FAINT:#}");
        for (rule, &pairs) in rules.rules.iter().zip(&report.checked_by_rule) {
            let _ = writeln!(text, "  {:>9}  {}", count(pairs), escaped(&rule.name));
        }
        let _ = writeln!(text, "  {:>9}  {FAINT}named by no rule{FAINT:#}", count(report.counts.unchecked));
    }
    if !rules.ignores.is_empty() {
        let _ = writeln!(text, "\n{FAINT}ignored pairs{FAINT:#}");
        for (ignore, &pairs) in rules.ignores.iter().zip(&report.ignored_by_rule) {
            let _ = writeln!(text, "  {:>9}  {}", count(pairs), escaped(&ignore.why));
        }
    }
    text
}

/// Returns how the clashes compare with the previous report, if there is one or some are accepted.
fn statuses(outcome: &Outcome<'_>) -> String {
    let report = &outcome.report;
    let is_new = |status: &Status| *status == Status::New;
    let counts = Status::ALL.map(|status| (status, report.count_of(status)));
    if report.gone.is_none() && counts.iter().all(|(status, count)| is_new(status) || *count == 0) {
        return String::new();
    }
    let mut parts: Vec<String> = counts
        .iter()
        .filter(|(status, found)| *found > 0 || is_new(status))
        .map(|(status, found)| format!("{} {status}", count(*found)))
        .collect();
    if let Some(gone) = &report.gone {
        let removed = gone.iter().filter(|gone| !gone.removed.is_empty()).count();
        let because =
            if removed > 0 { format!(" ({} because a part was removed)", count(removed)) } else { String::new() };
        parts.push(format!("{} gone{because}", count(gone.len())));
    }
    format!("\n{FAINT}status    {FAINT:#}{}\n", parts.join(", "))
}

/// Returns the numbers of pictures and topics that were written.
fn files(outcome: &Outcome<'_>) -> String {
    let mut text = String::new();
    if let Some([written, all]) = outcome.handed_over.pictures {
        let of_all = if written < all { format!(" of {} groups", count(all)) } else { String::new() };
        let _ = writeln!(text, "\n{FAINT}pictures  {FAINT:#}{}{of_all}", count(written));
    }
    if let Some(topics) = outcome.handed_over.topics {
        let _ = writeln!(text, "\n{FAINT}BCF       {FAINT:#}{}", counted(topics, "topic"));
    }
    text
}
