//! Finds the rule of each pair of parts.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::error::ClashError;
use super::rules::{ALL, Matcher, Rules};
use super::sides::Roster;

/// Treatment of a pair of parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Treatment {
    /// No rule names the pair.
    Unchecked,
    /// The ignore with this index names the pair.
    Ignored(u32),
    /// The pair is checked: by the rule with this index, or without a rule.
    Checked(Option<u32>),
}

/// Treatments of all pairs. Parts that belong to the same sets have the same profile, and the
/// treatment depends on the two profiles alone.
pub(super) struct Matching {
    /// Index of the profile of each member.
    profiles: Vec<u32>,
    /// For each profile, whether it belongs to each set. The first set is that of all parts.
    sets: Vec<Vec<bool>>,
    /// Sets of each rule.
    checks: Vec<[usize; 2]>,
    /// Sets of each ignore.
    ignores: Vec<[usize; 2]>,
}

impl Matching {
    pub(super) fn new(roster: &Roster, rules: &Rules) -> Result<Self, ClashError> {
        let mut names = vec![ALL];
        names.extend(rules.sets.iter().map(|set| set.name.as_str()));
        let number = |set: &str, rule: &str| {
            names.iter().position(|&name| name == set).ok_or_else(|| ClashError::UnknownSet {
                set: set.to_owned(),
                rule: rule.to_owned(),
                known: names.iter().map(|&name| name.to_owned()).collect(),
            })
        };
        let pairs = |a: &str, b: &str, rule: &str| Ok::<_, ClashError>([number(a, rule)?, number(b, rule)?]);
        let checks: Vec<[usize; 2]> =
            rules.rules.iter().map(|rule| pairs(&rule.a, &rule.b, &rule.name)).collect::<Result<_, _>>()?;
        let ignores: Vec<[usize; 2]> =
            rules.ignores.iter().map(|rule| pairs(&rule.a, &rule.b, &rule.why)).collect::<Result<_, _>>()?;

        let matchers: Vec<Vec<Matcher>> =
            rules.sets.iter().map(|set| set.any.iter().map(Matcher::new).collect()).collect();
        let mut known: HashMap<Vec<bool>, u32> = HashMap::new();
        let mut profiles = Vec::with_capacity(roster.members.len());
        for member in &roster.members {
            let of_set = |any: &Vec<Matcher>| any.iter().any(|selector| selector.selects(member));
            let sets: Vec<bool> = std::iter::once(true).chain(matchers.iter().map(of_set)).collect();
            let next = known.len() as u32;
            profiles.push(*known.entry(sets).or_insert(next));
        }
        for (rule, sets) in rules.rules.iter().zip(&checks) {
            if let Some(&empty) = sets.iter().find(|&&set| set > 0 && !known.keys().any(|sets| sets[set])) {
                let (set, rule) = (names[empty].to_owned(), rule.name.clone());
                return Err(ClashError::EmptySet { set, rule, types: types(roster) });
            }
        }
        let sets = known.into_iter().map(|(sets, profile)| (profile, sets)).collect::<BTreeMap<_, _>>();
        Ok(Self { profiles, sets: sets.into_values().collect(), checks, ignores })
    }

    /// Returns the treatment of the pair of two members. It takes linear time in the number of
    /// rules.
    pub(super) fn of(&self, a: u32, b: u32) -> Treatment {
        let [a, b] = [a, b].map(|member| &self.sets[self.profiles[member as usize] as usize]);
        let names = |pair: &[usize; 2]| (a[pair[0]] && b[pair[1]]) || (b[pair[0]] && a[pair[1]]);
        let first = |list: &[[usize; 2]]| list.iter().position(names).map(|at| at as u32);
        match (first(&self.ignores), first(&self.checks)) {
            (Some(ignore), _) => Treatment::Ignored(ignore),
            (None, Some(rule)) => Treatment::Checked(Some(rule)),
            (None, None) if self.checks.is_empty() => Treatment::Checked(None),
            (None, None) => Treatment::Unchecked,
        }
    }
}

fn types(roster: &Roster) -> Vec<String> {
    let types: BTreeSet<&str> = roster.members.iter().map(|member| member.kind.as_str()).collect();
    types.into_iter().filter(|kind| !kind.is_empty()).map(str::to_owned).collect()
}
