//! Writes what an audit found as an SRDF file.

use std::fmt::Write;

use impinge::robot::{AuditedPair, PairFinding};

use super::LoadedRobot;

impl LoadedRobot {
    /// Returns an SRDF file that disables the pairs of links that an audit of the robot found
    /// adjacent, proved to collide never, or colliding in every sample. The reasons are those of
    /// MoveIt: `Adjacent`, `Never` and `Always`.
    ///
    /// The file has no groups and states. Pairs about which nothing is proved stay enabled.
    #[must_use]
    pub fn srdf(&self, audit: &[AuditedPair]) -> String {
        let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", escaped(&self.name));
        for pair in audit {
            let reason = match pair.finding {
                PairFinding::Adjacent => "Adjacent",
                PairFinding::ProvedNever => "Never",
                PairFinding::Always(_) => "Always",
                PairFinding::Witness(_) | PairFinding::Open => continue,
            };
            let [a, b] = pair.links.map(|link| escaped(&self.robot.links()[link].name));
            // Writing to a String cannot fail.
            let _ = writeln!(text, "  <disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"{reason}\"/>");
        }
        text + "</robot>\n"
    }
}

/// Returns a value of an attribute of an XML file.
fn escaped(value: &str) -> String {
    let mut text = String::new();
    for character in value.chars() {
        match character {
            '&' => text += "&amp;",
            '<' => text += "&lt;",
            '"' => text += "&quot;",
            '\t' | '\n' | '\r' => {
                let _ = write!(text, "&#{};", u32::from(character));
            }
            _ => text.push(character),
        }
    }
    text
}
