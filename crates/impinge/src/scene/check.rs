//! Which pairs of parts intersect, penetrate or come near.

use std::borrow::Cow;
use std::collections::HashMap;

use super::configurations::Configurations;
use super::near::{Standing, pairs_near};
use super::parts::{PartId, Scene};
use crate::mesh::Interrupt;
use crate::query::batch::{Answers, Execution, Status, Stopped};
use crate::query::{Cache, Penetrates, Proximity, Query, penetrates};

/// What is asked about each pair of parts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Question {
    /// As [`intersects`](crate::query::intersects).
    Intersects,
    /// As [`penetrates`](crate::query::penetrates()): whether their interiors intersect. Meshes are taken as solids.
    Penetrates,
    /// As [`within`](crate::query::within()) this clearance, in world units.
    Within(f64),
}

/// When a configuration is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stop {
    /// At the first pair of which the answer is yes, in the order of the parts.
    First,
    /// Once all pairs were asked about.
    All,
}

/// A pair of parts of which the answer is yes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FoundPair {
    /// The parts, the lesser first.
    pub parts: [PartId; 2],
    /// Whether it is the safe answer: nothing was proved about the pair, or a pose is faulty.
    pub is_undecided: bool,
}

impl Scene {
    /// Returns the pairs of parts of which the answer is yes, as they stand in the scene, sorted. Undecided pairs are among them.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    ///
    /// # Complexity
    /// The broad phase takes about linear time, and each pair whose boxes are near what the verb takes.
    pub fn pairs(&self, question: Question) -> Result<Vec<[PartId; 2]>, Stopped> {
        let mut found = self.check(question, Stop::All, &self.configurations(), Execution::default())?;
        let pairs = found.values.pop().unwrap_or_default();
        Ok(pairs.into_iter().map(|pair| pair.parts).collect())
    }

    /// Returns for each configuration the pairs of parts of which the answer is yes, sorted; the first alone if the check stops there.
    ///
    /// A part with a faulty pose counts as near every other. The status of a configuration is that of its first part with a faulty
    /// pose, else whether one of the pairs found is undecided. Pairs of parts that stand still are asked about once. Consecutive
    /// configurations share a [`Cache`] for each pair.
    ///
    /// # Errors
    /// [`Stopped`] if the interrupt of `execution` asked for it, or if there is no memory for the answers.
    ///
    /// # Panics
    /// If the configurations are of another scene.
    ///
    /// # Complexity
    /// For each configuration the broad phase takes about linear time in the parts, and each pair whose boxes are near what the verb
    /// takes.
    pub fn check(
        &self,
        question: Question,
        stop: Stop,
        configurations: &Configurations<'_>,
        execution: Execution<'_>,
    ) -> Result<Answers<Vec<FoundPair>>, Stopped> {
        assert!(std::ptr::eq(self, configurations.scene()), "the configurations are of another scene");
        let rows = configurations.rows();
        let mut check = Check { scene: self, question, configurations, standing: Vec::new(), still: Vec::new() };
        if rows > 0 {
            check.standing = check.still_parts();
            check.still = check.still_pairs(execution)?;
        }
        let found = execution.rows(rows, HashMap::new, |caches, row, interrupt| {
            let found = check.row(row, stop, caches, interrupt);
            (found, check.status(row))
        })?;
        let (values, status): (Vec<Vec<FoundPair>>, Vec<Status>) = found.into_iter().unzip();
        let answers = Answers { shape: configurations.shape().to_vec(), values, status };
        Ok(answers.judged(|pairs| pairs.iter().any(|pair| pair.is_undecided)))
    }
}

struct Check<'c> {
    scene: &'c Scene,
    question: Question,
    configurations: &'c Configurations<'c>,
    /// Where the parts stand that have one pose in all configurations; the others are nowhere.
    standing: Vec<Standing>,
    /// The pairs of such parts of which the answer is yes, sorted.
    still: Vec<FoundPair>,
}

impl Check<'_> {
    /// Returns where the parts stand that have one pose in all configurations.
    fn still_parts(&self) -> Vec<Standing> {
        let of = |part: PartId| {
            if self.configurations.is_still(part) { self.placed(part, 0) } else { Standing::Nowhere }
        };
        self.scene.parts().map(of).collect()
    }

    /// Answers for the pairs of these parts.
    fn still_pairs(&self, execution: Execution<'_>) -> Result<Vec<FoundPair>, Stopped> {
        let standing: Vec<Cow<'_, Standing>> = self.standing.iter().map(Cow::Borrowed).collect();
        let pairs = pairs_near(self.scene, &standing, |_, _| true);
        let quiet = execution.without_progress();
        let found = quiet.rows(pairs.len(), Cache::default, |cache, at, interrupt| {
            self.pair(pairs[at], &standing, cache, interrupt)
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    /// Returns where all parts stand in a row.
    fn standing(&self, row: usize) -> Vec<Cow<'_, Standing>> {
        let of = |part: PartId| {
            if self.configurations.is_still(part) {
                Cow::Borrowed(&self.standing[part.index()])
            } else {
                Cow::Owned(self.placed(part, row))
            }
        };
        self.scene.parts().map(of).collect()
    }

    /// Returns where a part stands in a row.
    fn placed(&self, part: PartId, row: usize) -> Standing {
        let clearance = if let Question::Within(clearance) = self.question { clearance } else { 0.0 };
        let pose = self.configurations.pose(part, row);
        let placed = pose.ok().and_then(|pose| self.scene.shape(part).at(*pose).ok());
        placed.map_or(Standing::Anywhere, |placed| Standing::new(placed, clearance))
    }

    /// Returns the pairs of a row of which the answer is yes.
    fn row(
        &self,
        row: usize,
        stop: Stop,
        caches: &mut HashMap<[PartId; 2], Cache>,
        interrupt: Interrupt<'_>,
    ) -> Vec<FoundPair> {
        let standing = self.standing(row);
        let moves = |part: PartId| !self.configurations.is_still(part);
        let pairs = pairs_near(self.scene, &standing, |a, b| moves(a) || moves(b));
        let first_still = self.still.first();
        let mut found = Vec::new();
        for pair in pairs {
            // Whatever was found until then is discarded.
            if interrupt.is_wanted() {
                break;
            }
            if stop == Stop::First && first_still.is_some_and(|still| still.parts < pair) {
                break;
            }
            found.extend(self.pair(pair, &standing, caches.entry(pair).or_default(), interrupt));
            if stop == Stop::First && !found.is_empty() {
                return found;
            }
        }
        match stop {
            Stop::First => found.extend(first_still),
            Stop::All => {
                found.extend(&self.still);
                found.sort_unstable_by_key(|pair| pair.parts);
            }
        }
        found
    }

    /// Returns the pair if the answer is yes.
    fn pair(
        &self,
        parts: [PartId; 2],
        standing: &[Cow<'_, Standing>],
        cache: &mut Cache,
        interrupt: Interrupt<'_>,
    ) -> Option<FoundPair> {
        let [Some(a), Some(b)] = parts.map(|part| standing[part.index()].placed()) else {
            return Some(FoundPair { parts, is_undecided: true });
        };
        let query = Query::new().with_cache(cache).with_interrupt(interrupt);
        let proximity = match self.question {
            Question::Intersects => query.proximity(a, b),
            Question::Within(clearance) => query.nearness(a, b, clearance),
            Question::Penetrates => match penetrates(a, b) {
                Penetrates::No => Proximity::Apart,
                Penetrates::Undecided => Proximity::Undecided,
                Penetrates::Yes => Proximity::Meets,
            },
        };
        let is_undecided = proximity == Proximity::Undecided;
        (proximity != Proximity::Apart).then_some(FoundPair { parts, is_undecided })
    }

    /// Returns the status of a row by its poses.
    fn status(&self, row: usize) -> Status {
        let fault = self.scene.parts().find_map(|part| self.configurations.pose(part, row).err());
        fault.map_or(Status::Ok, Status::of)
    }
}
