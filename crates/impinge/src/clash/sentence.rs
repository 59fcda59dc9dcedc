//! Sentences about clashes and groups, for people.

use super::groups::{Group, Shared};
use super::kinds::{Inner, Kind};
use super::report::{Clash, DuplicateSet, Report};
use super::sides::Member;

/// Largest ratio of the bounds of a depth for which a sentence states one number.
const ONE_NUMBER: f64 = 1.02;

impl Member {
    /// Returns the part as a sentence names it, such as `wall 'W-3'`. The noun comes from the type:
    /// `IfcWallStandardCase` gives `wall`. A part without a type is a `part`.
    #[must_use]
    pub fn in_words(&self) -> String {
        let name = if self.name.is_empty() { &self.key } else { &self.name };
        format!("{} '{name}'", noun(&self.kind))
    }
}

impl Clash {
    /// Returns a sentence without a full stop, such as `pipe 'P-12' enters wall 'W-3' by 36 mm`.
    /// The smaller part is its subject, if the kind does not name one. `length` formats a length in
    /// world units.
    #[must_use]
    pub fn sentence(&self, length: &dyn Fn(f64) -> String) -> String {
        let [a, b] = [&self.a, &self.b].map(|member| member.in_words());
        let size = self.depth.map_or(String::new(), |depth| format!(" by {}", interval(depth, length)));
        match self.kind {
            Kind::Duplicate => format!("{a} is a duplicate of {b}"),
            Kind::Contained(Inner::A) => format!("{a} lies inside {b}"),
            Kind::Contained(Inner::B) => format!("{b} lies inside {a}"),
            Kind::Clash if self.subject_is_b => format!("{b} enters {a}{size}"),
            Kind::Clash => format!("{a} enters {b}{size}"),
            Kind::Undecided => format!("{a} may enter {b}{size}"),
            Kind::Contact => format!("{a} touches {b}"),
            Kind::Clearance | Kind::Clear => {
                let gap = self.gap.map_or_else(|| "too little".to_owned(), |gap| interval(gap, length));
                format!("{a} is {gap} away from {b}")
            }
        }
    }
}

impl DuplicateSet {
    /// Returns a sentence without a full stop, such as `bolt 'B-1' and 4 other parts are one shape
    /// in one place`.
    #[must_use]
    pub fn sentence(&self) -> String {
        let first = self.parts[0].in_words();
        match &self.parts[1..] {
            [other] => format!("{first} and {} are one shape in one place", other.in_words()),
            others => format!("{first} and {} other parts are one shape in one place", others.len()),
        }
    }
}

impl Group {
    /// Returns a sentence without a full stop about the group: about its only clash, or about the
    /// number of clashes and the worst. `length` formats a length in world units.
    #[must_use]
    pub fn sentence(&self, report: &Report, length: &dyn Fn(f64) -> String) -> String {
        let worst = report.clashes[self.clashes[0]].sentence(length);
        let count = self.clashes.len();
        match &self.by {
            Shared::Part(_) if count == 1 => worst,
            Shared::Part(part) => format!("{} meets {count} parts; the worst: {worst}", part.in_words()),
            Shared::Types(types) => {
                let [a, b] = types.each_ref().map(|kind| type_in_words(kind));
                format!("{a} against {b}: {}; the worst: {worst}", pairs(count))
            }
            Shared::Scenes([a, b]) if a == b => format!("inside {a}: {}; the worst: {worst}", pairs(count)),
            Shared::Scenes([a, b]) => format!("{a} against {b}: {}; the worst: {worst}", pairs(count)),
        }
    }
}

fn pairs(count: usize) -> String {
    format!("{count} {}", if count == 1 { "pair" } else { "pairs" })
}

fn interval([lower, upper]: [f64; 2], length: &dyn Fn(f64) -> String) -> String {
    if upper.is_infinite() {
        format!("at least {}", length(lower))
    } else if upper <= lower * ONE_NUMBER {
        length(upper)
    } else if lower == 0.0 {
        format!("at most {}", length(upper))
    } else {
        format!("{} to {}", length(lower), length(upper))
    }
}

/// Returns the noun for a type: the type in words, without the suffix of IFC.
fn noun(kind: &str) -> String {
    type_in_words(kind.strip_suffix("StandardCase").unwrap_or(kind))
}

/// Returns a type in lower case, with spaces between its words, without the prefix of IFC.
fn type_in_words(kind: &str) -> String {
    let bare = kind.strip_prefix("Ifc").unwrap_or(kind);
    let mut noun = String::new();
    let mut was_lower = false;
    for letter in bare.chars() {
        if letter.is_uppercase() && was_lower {
            noun.push(' ');
        }
        was_lower = letter.is_lowercase();
        noun.extend(letter.to_lowercase());
    }
    if noun.is_empty() { "part".to_owned() } else { noun }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nouns_come_from_types() {
        let cases = [
            ("IfcWall", "wall"),
            ("IfcWallStandardCase", "wall"),
            ("IfcPipeSegment", "pipe segment"),
            ("Ifc", "part"),
            ("", "part"),
            ("HVAC unit", "hvac unit"),
        ];
        for (kind, expected) in cases {
            assert_eq!(noun(kind), expected);
        }
        // Different types have different words.
        assert_eq!(type_in_words("IfcWallStandardCase"), "wall standard case");
    }

    #[test]
    fn an_interval_is_one_number_if_its_bounds_agree() {
        let length = |x: f64| format!("{x} mm");
        let cases = [
            ([36.0, 36.0], "36 mm"),
            ([36.0, f64::INFINITY], "at least 36 mm"),
            ([0.0, 2.0], "at most 2 mm"),
            ([30.0, 36.0], "30 mm to 36 mm"),
            ([0.0, 0.0], "0 mm"),
        ];
        for (bounds, expected) in cases {
            assert_eq!(interval(bounds, &length), expected);
        }
    }
}
