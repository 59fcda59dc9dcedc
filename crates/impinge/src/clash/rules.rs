//! Rules: which pairs of parts are checked, with which tolerance and clearance, and which clashes
//! are accepted.

use wildmatch::WildMatch;

use super::sides::Member;

/// Name of the set of all parts, which every list of rules has.
pub const ALL: &str = "*";

/// Rules of a search. Without rules, all pairs are checked.
///
/// A pair is skipped if an [`Ignore`] names it. Otherwise the first [`Rule`] that names it applies.
/// If there are rules, and none names the pair, the pair is not checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rules {
    /// Sets of parts.
    pub sets: Vec<Set>,
    /// Pairs of sets that are checked.
    pub rules: Vec<Rule>,
    /// Pairs of sets that are not checked.
    pub ignores: Vec<Ignore>,
    /// Clashes that are accepted.
    pub accepts: Vec<Accept>,
}

/// A named set of parts: all parts that one of its selectors selects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Set {
    /// Name of the set.
    pub name: String,
    /// The selectors.
    pub any: Vec<Selector>,
}

/// Patterns for parts. A part is selected if each list that is not empty has a pattern that matches
/// it, and none of `except` selects it.
///
/// In a pattern, `*` stands for any text and `?` for any character. Upper and lower case differ.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selector {
    /// Patterns for the type of the part.
    pub kind: Vec<String>,
    /// Patterns for the name of the part.
    pub name: Vec<String>,
    /// Patterns for the path of the part: the names of the groups that contain it, with slashes
    /// between them.
    pub path: Vec<String>,
    /// Patterns for the label of the scene.
    pub scene: Vec<String>,
    /// Selectors of parts that are not selected.
    pub except: Vec<Selector>,
}

/// Check of the parts of one set against the parts of another, or of the same set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rule {
    /// Name of the rule in reports.
    pub name: String,
    /// Name of the first set, or [`ALL`].
    pub a: String,
    /// Name of the second set, or [`ALL`].
    pub b: String,
    /// Tolerance in world units, or `None` for that of the search.
    pub tolerance: Option<f64>,
    /// Clearance in world units, or `None` for that of the search.
    pub clearance: Option<f64>,
    /// Severity of clashes in reports.
    pub severity: Option<String>,
}

/// Exclusion of the pairs of two sets from the search.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ignore {
    /// Reason in reports.
    pub why: String,
    /// Name of the first set, or [`ALL`].
    pub a: String,
    /// Name of the second set, or [`ALL`].
    pub b: String,
}

/// Acceptance of a clash: its status is `approved`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accept {
    /// Identity of the clash.
    pub id: String,
    /// Depth up to which the clash is accepted, in world units, or `None` for any depth.
    pub depth: Option<f64>,
    /// Remark in reports.
    pub note: Option<String>,
}

/// A selector whose patterns are ready for matching.
pub(super) struct Matcher {
    kind: Vec<WildMatch>,
    name: Vec<WildMatch>,
    path: Vec<WildMatch>,
    scene: Vec<WildMatch>,
    except: Vec<Matcher>,
}

impl Matcher {
    pub(super) fn new(selector: &Selector) -> Self {
        let globs = |patterns: &[String]| patterns.iter().map(|pattern| WildMatch::new(pattern)).collect();
        Self {
            kind: globs(&selector.kind),
            name: globs(&selector.name),
            path: globs(&selector.path),
            scene: globs(&selector.scene),
            except: selector.except.iter().map(Self::new).collect(),
        }
    }

    pub(super) fn selects(&self, member: &Member) -> bool {
        let holds = |globs: &[WildMatch], text: &str| globs.is_empty() || globs.iter().any(|glob| glob.matches(text));
        holds(&self.kind, &member.kind)
            && holds(&self.name, &member.name)
            && holds(&self.scene, &member.scene)
            && (self.path.is_empty() || holds(&self.path, &member.path.join("/")))
            && !self.except.iter().any(|except| except.selects(member))
    }
}
