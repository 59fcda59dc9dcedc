//! The lines of a topic's description, one a clash, which people read and the next report reads
//! back.
//!
//! ```text
//! c-abcd2345 clash new, depth 0.0359 to 0.0361 m: pipe 'P-12' enters wall 'W-3' by 36 mm
//! ```

use impinge::clash::{Clash, DuplicateSet, Kind, Known, Status};
use impinge_files::Unit;

/// Returns the line of a clash.
pub(super) fn clash_line(clash: &Clash, unit: Unit, sentence: &str) -> String {
    let bounds = |name: &str, [lower, upper]: [f64; 2]| match upper.is_finite() {
        true => format!(", {name} {} to {} m", lower * unit.meters(), upper * unit.meters()),
        false => format!(", {name} at least {} m", lower * unit.meters()),
    };
    let depth = clash.depth.map_or(String::new(), |depth| bounds("depth", depth));
    let gap = clash.gap.map_or(String::new(), |gap| bounds("gap", gap));
    let accepted = clash.accepted.map_or(String::new(), |size| format!(", accepted at {} m", size * unit.meters()));
    format!("{} {} {}{depth}{gap}{accepted}: {sentence}", clash.id, clash.kind.name(), clash.status)
}

/// Returns the line of a set of duplicates.
pub(super) fn duplicates_line(set: &DuplicateSet) -> String {
    format!("{} {} {}: {}", set.id, Kind::Duplicate.name(), set.status, set.sentence())
}

/// Reads a line back, or returns `None` for other lines. Lengths are converted to `unit`.
pub(super) fn parse(line: &str, unit: Unit) -> Option<Known> {
    let (head, _) = line.trim().split_once(':')?;
    let mut parts = head.split(", ");
    let mut words = parts.next()?.split(' ');
    let (id, kind, status) = (words.next()?, words.next()?, words.next()?.parse::<Status>().ok()?);
    let is_digit = |digit: char| digit.is_ascii_lowercase() || ('2'..='7').contains(&digit);
    if !id.strip_prefix("c-").is_some_and(|digits| digits.len() == 8 && digits.chars().all(is_digit)) {
        return None;
    }
    let mut known = Known { id: id.to_owned(), kind: kind.to_owned(), status, ..Known::default() };
    let length = |text: &str| {
        let meters = text.strip_suffix(" m").unwrap_or(text).parse::<f64>().ok()?;
        Some(meters / unit.meters()).filter(|length| length.is_finite())
    };
    let bounds = |text: &str| match (text.strip_prefix("at least "), text.split_once(" to ")) {
        (Some(lower), _) => Some([length(lower)?, f64::INFINITY]),
        (None, Some((lower, upper))) => Some([length(lower)?, length(upper)?]),
        (None, None) => None,
    };
    for part in parts {
        if let Some(text) = part.strip_prefix("depth ") {
            known.depth = bounds(text);
        } else if let Some(text) = part.strip_prefix("gap ") {
            known.gap = bounds(text);
        } else if let Some(text) = part.strip_prefix("accepted at ") {
            known.accepted = length(text);
        }
    }
    Some(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_back() {
        let line = "c-abcd2345 clash approved, depth 0.0359 to 0.0361 m, accepted at 0.04 m: pipe 'c-: , x' enters";
        let known = parse(line, Unit::Millimeter).unwrap();
        assert_eq!((known.id.as_str(), known.kind.as_str(), known.status), ("c-abcd2345", "clash", Status::Approved));
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let [lower, upper] = known.depth.unwrap();
        assert!(near(lower, 35.9) && near(upper, 36.1) && near(known.accepted.unwrap(), 40.0) && known.gap.is_none());
        let open = parse("  c-abcd2345 undecided new, depth at least 2 m: x", Unit::Meter).unwrap();
        assert_eq!(open.depth, Some([2.0, f64::INFINITY]));
        assert_eq!(parse("c-abcd2345 clearance active, gap 0 to 1 m: x", Unit::Meter).unwrap().gap, Some([0.0, 1.0]));
        for other in ["", "part 'wall' meets 2 parts; the worst: x", "c-abcd2345 clash", "c-ABCD2345 clash new: x"] {
            assert_eq!(parse(other, Unit::Meter), None, "{other}");
        }
    }
}
