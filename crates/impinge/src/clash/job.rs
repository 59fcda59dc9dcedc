//! The search: the broad phase, the kind of each candidate, and the report.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use super::decades::Decades;
use super::error::ClashError;
use super::groups::groups;
use super::kinds::{Asked, Finding, Kind, find_kind};
use super::matching::{Matching, Treatment};
use super::near::pairs_near;
use super::options::Options;
use super::report::{Clash, Counts, DuplicateSet, Report, duplicate_sets, identity_of, sort};
use super::rules::Rules;
use super::sides::{Member, Roster, Side, placed, rounding};
use super::status::{Current, Gone, Known, Settled, Status, Statuses};
use crate::budget::{Budget, Stopped};
use crate::query::Placed;
use crate::query::batch::Execution;
use crate::shape::PlacedShape;

/// A search for clashes after its broad phase: the candidates are known, and none is checked yet.
///
/// [`find`] does the whole search. A `Job` tells the number of candidates first, for a display of
/// progress, and can check them in several calls.
///
/// ```
/// use impinge::clash::{Job, Options, Side};
/// use impinge::query::batch::Execution;
/// use impinge::scene::Scene;
/// use impinge::{Budget, Pose, Shape};
///
/// let mut scene = Scene::new();
/// for (name, x) in [("wall", 0.0), ("duct", 0.9), ("desk", 9.0)] {
///     scene.add(name, Shape::cuboid([0.5; 3])?, Pose::from_translation([x, 0.0, 0.0])?)?;
/// }
/// let sides = [Side { label: "house".to_owned(), scene: &scene }];
/// let job = Job::new(&sides, Options::new(1e-3), Budget::unlimited())?;
/// assert_eq!(job.candidates(), 1);
/// let findings = job.classify(0..1, Execution::default())?;
/// assert_eq!(job.report(findings, None).clashes.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Job<'s> {
    options: Options<'s>,
    sides: Vec<Side<'s>>,
    roster: Roster,
    placed: Vec<PlacedShape>,
    candidates: Vec<Candidate>,
    /// Counts of the pairs that are not checked.
    counts: Counts,
    checked_by_rule: Vec<usize>,
    ignored_by_rule: Vec<usize>,
}

/// A pair of members that is checked.
#[derive(Clone, Copy)]
struct Candidate {
    pair: [u32; 2],
    rule: Option<u32>,
}

/// A pair of duplicates, with the index of its rule.
type Duplicate = ([u32; 2], Option<usize>);

/// Finds the clashes among the parts of some scenes.
///
/// Parts are solids. The answer does not depend on the number of threads, on the order of the parts
/// in a scene, or on the order of the scenes.
///
/// # Errors
/// Returns an error if a label, a length or a rule is invalid, if the search is canceled, or if
/// memory runs out. If another limit of the budget is reached, the pairs that are left are
/// [`Undecided`](Kind::Undecided), and [`Report::stopped`] says so.
///
/// # Complexity
/// The broad phase takes about linear time in the number of parts. Each pair whose boxes are nearer
/// than the largest clearance costs one query.
///
/// ```
/// use impinge::clash::{self, Options, Side};
/// use impinge::query::batch::Execution;
/// use impinge::scene::Scene;
/// use impinge::Pose;
/// # use impinge::{Mesh, Positions, InputError};
/// # fn cuboid(low: [f64; 3], high: [f64; 3]) -> Result<Mesh, InputError> {
/// #     let corners = (0..8).map(|at| std::array::from_fn(|k| if at >> k & 1 == 0 { low[k] } else { high[k] }));
/// #     let faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
/// #         [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
/// #     Mesh::new(Positions::F64(corners.collect()), faces.to_vec())
/// # }
///
/// let mut scene = Scene::new();
/// scene.add("wall", &cuboid([0.0; 3], [5.0, 0.25, 3.0])?, Pose::IDENTITY)?;
/// scene.add("duct", &cuboid([2.0, -1.0, 1.0], [2.5, 1.0, 1.5])?, Pose::IDENTITY)?;
/// let sides = [Side { label: "house".to_owned(), scene: &scene }];
/// let report = clash::find(&sides, Options::new(1e-3), Execution::default())?;
/// assert_eq!(report.counts.clash, 1);
/// assert!(report.clashes[0].sentence(&|x| format!("{x:.1} m")).starts_with("part 'duct' enters part 'wall'"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find<'s>(sides: &[Side<'s>], options: Options<'s>, execution: Execution<'_>) -> Result<Report, ClashError> {
    let job = Job::new(sides, options, execution.budget())?;
    let findings = job.classify(0..job.candidates(), execution)?;
    Ok(job.report(findings, execution.budget().stopped()))
}

impl<'s> Job<'s> {
    /// Does the broad phase of a search.
    ///
    /// # Errors
    /// Returns the errors of [`find`], and any limit of the budget that was reached.
    pub fn new(sides: &[Side<'s>], options: Options<'s>, budget: &Budget<'_>) -> Result<Self, ClashError> {
        let reach = options.validated_reach()?;
        let roster = Roster::new(sides)?;
        let no_rules = Rules::default();
        let rules = options.rules.unwrap_or(&no_rules);
        let matching = Matching::new(&roster, rules)?;
        let place = |(member, &side): (&Arc<Member>, &usize)| placed(sides[side].scene, member.part);
        let placed = roster.members.iter().zip(&roster.sides).map(place).collect::<Result<Vec<_>, _>>()?;
        let is_wanted = |a: u32, b: u32| {
            let [side_a, side_b] = [a, b].map(|member| roster.sides[member as usize]);
            let [part_a, part_b] = [a, b].map(|member| roster.members[member as usize].part);
            if side_a == side_b { !options.between && sides[side_a].scene.admits(part_a, part_b) } else { true }
        };
        let pairs = pairs_near(&placed, reach, budget, is_wanted)?;
        let mut counts = Counts { candidates: pairs.len(), ..Counts::default() };
        let mut checked_by_rule = vec![0; rules.rules.len()];
        let mut ignored_by_rule = vec![0; rules.ignores.len()];
        let mut candidates = Vec::new();
        for pair in pairs {
            match matching.of(pair[0], pair[1]) {
                Treatment::Unchecked => counts.unchecked += 1,
                Treatment::Ignored(ignore) => {
                    counts.ignored += 1;
                    ignored_by_rule[ignore as usize] += 1;
                }
                Treatment::Checked(rule) => {
                    rule.into_iter().for_each(|rule| checked_by_rule[rule as usize] += 1);
                    candidates.push(Candidate { pair, rule });
                }
            }
        }
        let sides = sides.to_vec();
        Ok(Self { options, sides, roster, placed, candidates, counts, checked_by_rule, ignored_by_rule })
    }

    /// Returns the number of pairs to check.
    #[must_use]
    pub fn candidates(&self) -> usize {
        self.candidates.len()
    }

    /// Returns the parts of a pair to check, and the question about it, so that
    /// [`classify`](super::classify()) can answer it in another process.
    ///
    /// # Panics
    /// Panics if the number of the pair is not in `0..self.candidates()`.
    #[must_use]
    pub fn question(&self, candidate: usize) -> ([&Member; 2], Asked) {
        let candidate = &self.candidates[candidate];
        (candidate.pair.map(|member| &*self.roster.members[member as usize]), self.asked(candidate))
    }

    /// Returns the box where the boxes of the parts of a pair overlap, or the box between them, in
    /// the world frame. Returns `None` if a part is unbounded.
    ///
    /// # Panics
    /// Panics if the number of the pair is not in `0..self.candidates()`.
    #[must_use]
    pub fn bounds(&self, candidate: usize) -> Option<[[f64; 3]; 2]> {
        common_box(self.boxes(&self.candidates[candidate]))
    }

    fn boxes(&self, candidate: &Candidate) -> [Option<[[f64; 3]; 2]>; 2] {
        candidate.pair.map(|member| self.placed[member as usize].bounds())
    }

    /// Returns the kind of each candidate in a range, in order; `None` for a clear pair without a
    /// depth.
    ///
    /// # Errors
    /// Returns an error if the work was canceled, or memory ran out. Once another limit of the
    /// budget is reached, the pairs that are left are undecided.
    ///
    /// # Panics
    /// Panics if the range is not in `0..self.candidates()`.
    pub fn classify(
        &self,
        range: Range<usize>,
        execution: Execution<'_>,
    ) -> Result<Vec<Option<Box<Finding>>>, Stopped> {
        let rows = &self.candidates[range];
        let place = |member: u32| Placed::from(&self.placed[member as usize]);
        execution.single_rows(rows.len(), |row| {
            let Candidate { pair: [a, b], .. } = rows[row];
            let finding = find_kind(&place(a), &place(b), &self.asked(&rows[row]), execution.budget());
            (finding.kind != Kind::Clear).then(|| Box::new(finding))
        })
    }

    fn asked(&self, candidate: &Candidate) -> Asked {
        let Options { tolerance, clearance, contacts, volume, rules, .. } = self.options;
        let rule = rules.zip(candidate.rule).map(|(rules, rule)| &rules.rules[rule as usize]);
        Asked {
            tolerance: rule.and_then(|rule| rule.tolerance).unwrap_or(tolerance),
            clearance: rule.and_then(|rule| rule.clearance).or(clearance),
            contacts,
            volume,
        }
    }

    /// Returns the report about all candidates. `findings` has the answers of
    /// [`classify`](Self::classify) for all candidates, in order. `stopped` is the limit that the
    /// work reached.
    #[must_use]
    pub fn report(&self, findings: Vec<Option<Box<Finding>>>, stopped: Option<Stopped>) -> Report {
        let no_rules = Rules::default();
        let accepts = &self.options.rules.unwrap_or(&no_rules).accepts;
        let statuses = Statuses::new(self.options.previous, accepts);
        let mut counts = self.counts;
        let (mut depths, mut clashes, mut duplicates) = (Vec::new(), Vec::new(), Vec::new());
        for (candidate, finding) in self.candidates.iter().zip(findings) {
            let kind = finding.as_ref().map_or(Kind::Clear, |finding| finding.kind);
            *counts.of(kind) += 1;
            let Some(finding) = finding else { continue };
            // An upper bound may be infinite, and a lower bound of 0 says nothing.
            depths.extend(finding.depth.map(|[lower, upper]| if lower > 0.0 { lower } else { upper }));
            match kind {
                Kind::Duplicate => duplicates.push((candidate.pair, candidate.rule.map(|rule| rule as usize))),
                Kind::Contact if !self.options.contacts => {}
                _ => clashes.push(self.clash(candidate, &finding, &statuses)),
            }
        }
        sort(&mut clashes);
        let duplicates = self.duplicate_sets(&duplicates, &statuses);
        let pairs: Vec<_> = clashes.iter().map(|clash| [&clash.a, &clash.b]).collect();
        Report {
            counts,
            decades: Decades::new(depths, rounding(&self.sides)),
            groups: groups(&pairs, self.options.grouping),
            gone: self.gone(&clashes, &duplicates),
            duplicates,
            clashes,
            checked_by_rule: self.checked_by_rule.clone(),
            ignored_by_rule: self.ignored_by_rule.clone(),
            stopped,
        }
    }

    fn clash(&self, candidate: &Candidate, finding: &Finding, statuses: &Statuses<'_>) -> Clash {
        let [a, b] = candidate.pair.map(|member| Arc::clone(&self.roster.members[member as usize]));
        let id = identity_of([&a, &b]);
        let depth = finding.depth;
        let gap = finding.gap.filter(|_| finding.kind == Kind::Clearance);
        let tolerance = self.asked(candidate).tolerance;
        let Settled { status, accepted, note } =
            statuses.of(&Current { id: &id, kind: finding.kind, depth, gap, tolerance });
        let boxes = self.boxes(candidate);
        let rule = candidate.rule.map(|rule| rule as usize);
        Clash {
            id,
            kind: finding.kind,
            a,
            b,
            rule,
            severity: self.severity(rule),
            status,
            accepted,
            note,
            depth,
            gap,
            volume: finding.volume,
            curves: None,
            point: finding.point,
            faces: finding.faces,
            normal: finding.normal,
            bounds: common_box(boxes),
            proved: finding.proved,
            why: finding.why,
            subject_is_b: boxes[1].zip(boxes[0]).is_some_and(|(b, a)| volume(b) < volume(a)),
        }
    }

    fn severity(&self, rule: Option<usize>) -> Option<String> {
        let (rules, rule) = self.options.rules.zip(rule)?;
        rules.rules[rule].severity.clone()
    }

    fn duplicate_sets(&self, pairs: &[Duplicate], statuses: &Statuses<'_>) -> Vec<DuplicateSet> {
        let set = |(members, rule): (Vec<u32>, Option<usize>)| {
            let parts: Vec<Arc<_>> =
                members.iter().map(|&member| Arc::clone(&self.roster.members[member as usize])).collect();
            let id = identity_of(&parts);
            let current = Current { id: &id, kind: Kind::Duplicate, depth: None, gap: None, tolerance: 0.0 };
            let Settled { status, note, .. } = statuses.of(&current);
            DuplicateSet { id, parts, rule, severity: self.severity(rule), status, note }
        };
        duplicate_sets(pairs).into_iter().map(set).collect()
    }

    /// Returns the clashes of the previous report that no longer exist, in its order.
    fn gone(&self, clashes: &[Clash], duplicates: &[DuplicateSet]) -> Option<Vec<Gone>> {
        let previous = self.options.previous?;
        let ids = clashes.iter().map(|clash| &clash.id).chain(duplicates.iter().map(|set| &set.id));
        let present: HashSet<&String> = ids.collect();
        let parts: HashSet<String> = self.roster.members.iter().map(|member| member.identity()).collect();
        let gone = previous.clashes.iter().filter(|known| !present.contains(&known.id)).map(|known| Gone {
            clash: Known { status: Status::Resolved, ..known.clone() },
            removed: known.parts.iter().filter(|&part| !parts.contains(part)).cloned().collect(),
        });
        Some(gone.collect())
    }
}

/// Returns the box where two boxes overlap, or the box between them.
fn common_box([a, b]: [Option<[[f64; 3]; 2]>; 2]) -> Option<[[f64; 3]; 2]> {
    let ([min_a, max_a], [min_b, max_b]) = (a?, b?);
    let ends: [[f64; 2]; 3] = [0, 1, 2].map(|k| [min_a[k].max(min_b[k]), max_a[k].min(max_b[k])]);
    Some([ends.map(|[x, y]| x.min(y)), ends.map(|[x, y]| x.max(y))])
}

fn volume([min, max]: [[f64; 3]; 2]) -> f64 {
    (0..3).map(|k| max[k] - min[k]).product()
}
