//! Groups of clashes: by the part that most of them share, by types, or by scenes.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, HashMap};
use std::sync::Arc;

use super::sides::Member;

/// How clashes are grouped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Grouping {
    /// By a part. The part with the most clashes takes all of its clashes, then the part with the
    /// most of the clashes that are left, and so on.
    #[default]
    Part,
    /// By the types of both parts.
    Type,
    /// By the scenes of both parts.
    Scene,
    /// There are no groups.
    None,
}

/// Clashes that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Property that all clashes share.
    pub by: Shared,
    /// Indices of the clashes in the report, sorted, so that the first is the worst. Not empty.
    pub clashes: Vec<usize>,
}

/// Property that all clashes of a group share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shared {
    /// One part.
    Part(Arc<Member>),
    /// The types of both parts, sorted.
    Types([String; 2]),
    /// The labels of both scenes, sorted.
    Scenes([String; 2]),
}

/// Groups pairs of parts. The largest group comes first; among groups of one size the one with the
/// worst clash.
pub(super) fn groups(pairs: &[[&Arc<Member>; 2]], grouping: Grouping) -> Vec<Group> {
    let mut groups = match grouping {
        Grouping::None => Vec::new(),
        Grouping::Part => by_part(pairs),
        Grouping::Type => by_texts(pairs, |member| &member.kind, Shared::Types),
        Grouping::Scene => by_texts(pairs, |member| &member.scene, Shared::Scenes),
    };
    groups.sort_by_key(|group| (Reverse(group.clashes.len()), group.clashes[0]));
    groups
}

fn by_texts(
    pairs: &[[&Arc<Member>; 2]],
    text: impl Fn(&Member) -> &String,
    shared: impl Fn([String; 2]) -> Shared,
) -> Vec<Group> {
    let mut found: BTreeMap<[&String; 2], Vec<usize>> = BTreeMap::new();
    for (at, pair) in pairs.iter().enumerate() {
        let mut texts = pair.map(|member| text(member));
        texts.sort_unstable();
        found.entry(texts).or_default().push(at);
    }
    found.into_iter().map(|(texts, clashes)| Group { by: shared(texts.map(String::clone)), clashes }).collect()
}

fn by_part(pairs: &[[&Arc<Member>; 2]]) -> Vec<Group> {
    // Members are numbered by their first clash, so that the worst clash decides a tie.
    let mut numbers: HashMap<*const Member, usize> = HashMap::new();
    let mut members: Vec<(&Arc<Member>, Vec<usize>)> = Vec::new();
    let mut sides = Vec::with_capacity(pairs.len());
    for (at, pair) in pairs.iter().enumerate() {
        sides.push(pair.map(|member| {
            let number = *numbers.entry(Arc::as_ptr(member)).or_insert(members.len());
            if number == members.len() {
                members.push((member, Vec::new()));
            }
            members[number].1.push(at);
            number
        }));
    }
    let mut left: Vec<usize> = members.iter().map(|(_, clashes)| clashes.len()).collect();
    let mut is_taken = vec![false; pairs.len()];
    let mut heap: BinaryHeap<(usize, Reverse<usize>)> = (0..members.len()).map(|n| (left[n], Reverse(n))).collect();
    let mut groups = Vec::new();
    while let Some((count, Reverse(number))) = heap.pop() {
        if left[number] == 0 {
            continue;
        }
        if count > left[number] {
            heap.push((left[number], Reverse(number)));
            continue;
        }
        let clashes: Vec<usize> = members[number].1.iter().copied().filter(|&at| !is_taken[at]).collect();
        for &at in &clashes {
            is_taken[at] = true;
            sides[at].iter().for_each(|&side| left[side] -= 1);
        }
        groups.push(Group { by: Shared::Part(Arc::clone(members[number].0)), clashes });
    }
    groups
}
