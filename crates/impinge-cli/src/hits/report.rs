//! The text report: a table of volumes.

use std::fmt::Write;

use anstyle::Style;

use super::{Fitting, Outcome};
use crate::numerals::{counted, length, time};
use impinge_report::picture::DISTINCT_NAMES as NAMES;

const STRONG: Style = Style::new().bold();
const FAINT: Style = Style::new().dimmed();

/// Returns the report with ANSI styles; the output stream keeps or strips them.
pub(super) fn text(outcome: &Outcome<'_>) -> String {
    let Outcome { arguments, rig, character, leaks, frames, seconds } = outcome;
    let mut text = format!("{STRONG}{}{STRONG:#}\n", arguments.character.display());
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "  {}  {}  {}  {}\n",
        counted(rig.skeleton().bones().len(), "bone"),
        counted(rig.animations().len(), "animation"),
        counted(rig.skin().faces().len(), "triangle"),
        counted(character.parts().len(), "volume"),
    );
    let header = ["part", "volume", "size", "loose", "leak", "by", "bytes", "fixed to"].map(str::to_owned);
    let mut cells = Vec::new();
    for (part, leak) in character.parts().iter().zip(leaks) {
        cells.push([
            part.name.clone(),
            part.volume().kind().name().to_owned(),
            length(2.0 * part.volume().bounding_sphere().1),
            format!("{:.2}", part.looseness),
            if leak.share == 0.0 { "none".to_owned() } else { format!("{:.2} %", 100.0 * leak.share) },
            if leak.share == 0.0 { String::new() } else { length(leak.farthest) },
            part.volume().bytes().to_string(),
            rig.skeleton().bones()[part.anchor as usize].name.clone(),
        ]);
    }
    let widths: [usize; 8] = std::array::from_fn(|column| {
        cells.iter().chain([&header]).map(|row| row[column].chars().count()).max().unwrap_or(0)
    });
    let line = |row: &[String; 8]| {
        let cell = |column: usize| match column {
            0 | 1 | 7 => format!("{:<1$}", row[column], widths[column]),
            _ => format!("{:>1$}", row[column], widths[column]),
        };
        (0..8).map(cell).collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    let _ = writeln!(text, "{FAINT}{}{FAINT:#}", line(&header));
    for row in &cells {
        let _ = writeln!(text, "{}", line(row));
    }
    let promise = match arguments.mode {
        Fitting::Conservative => "no vertex is outside at any time of any animation",
        Fitting::Snug => "the outermost vertices may be outside: their share, and how far",
    };
    let _ = writeln!(text, "\n{FAINT}size is across; loose is the area over that of a convex hull; {promise}{FAINT:#}");
    if let (Some(frames), Some(picture)) = (frames, &arguments.picture) {
        let colours = character.parts().iter().enumerate();
        let colours = colours.map(|(at, part)| format!("{} {}", part.name, NAMES[at % NAMES.len()]));
        let colours = colours.collect::<Vec<_>>().join(", ");
        let _ = writeln!(
            text,
            "{FAINT}picture{FAINT:#}  {} in {}: {colours}",
            counted(*frames, "frame"),
            picture.display()
        );
    }
    let phases = [("load", seconds.load), ("fit", seconds.fit), ("measure", seconds.measure)];
    let phases = phases.map(|(phase, seconds)| format!("{phase} {}", time(seconds))).join(", ");
    let _ = writeln!(text, "{FAINT}time{FAINT:#}     {phases}");
    text
}
