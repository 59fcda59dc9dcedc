//! Straight motions in the space of configurations: proofs that nothing collides on the way, and
//! the time of the first contact.

use super::certificate::Certificate;
use super::check::{CheckError, CheckOptions, Collision};
use super::interval::{CertificateRow, Finding, Items, Scan, State, between};
use super::model::Robot;
use crate::budget::Budget;
use crate::query::batch::{Answers, Execution, Status};

/// Length of the shortest intervals of a motion that are examined, 2^-40 of the motion.
const MIN_LENGTH: f64 = 1.0 / (1_u64 << 40) as f64;

/// Length of an interval that is known to contain the first contact with which the search ends,
/// 2^-34 of the motion.
const MAX_CONTACT_LENGTH: f64 = 1.0 / (1_u64 << 34) as f64;

/// Length at which intervals are no longer halved if no bound on the motion of a link is known,
/// 2^-6. Nothing can be proved there, but collisions can be found.
const MIN_SAMPLED_LENGTH: f64 = 1.0 / 64.0;

/// Options of [`Robot::check_motions`].
#[derive(Clone, Debug)]
pub struct MotionOptions<'s> {
    /// Obstacles, clearances and ignored pairs. [`stop`](CheckOptions::stop) is not used.
    pub check: CheckOptions<'s>,
    /// Maximum number of configurations that are examined for a motion. Links that slide along
    /// each other with very little room need many of them.
    pub max_steps: usize,
    /// Whether the proof of a free motion is kept as a certificate.
    pub keeps_certificate: bool,
}

impl Default for MotionOptions<'_> {
    /// Returns the options of a check of all pairs of links, without obstacles, clearances and
    /// certificates, with at most 2^17 steps.
    fn default() -> Self {
        Self { check: CheckOptions::default(), max_steps: 1 << 17, keeps_certificate: false }
    }
}

/// The verdict about a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// It is proved that no configuration of the motion collides.
    Free,
    /// A configuration of the motion collides.
    Collides,
    /// Neither was proved: shapes touch to within rounding, or the steps were used up.
    Undecided,
}

/// Verdict about a motion, with its proof. Times are from 0 at its start to 1 at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionCheck {
    /// The verdict.
    pub verdict: Verdict,
    /// All configurations before this time are proved free; 1 if the motion is free.
    pub free_until: f64,
    /// Time of a configuration that collides. If nothing was left undecided before it, it is within
    /// 2^-34 of [`free_until`](Self::free_until), so that the first contact is between the two.
    pub hit_at: Option<f64>,
    /// A pair that collides at that time. Of several pairs it is any.
    pub collision: Option<Collision>,
    /// The configuration at that time.
    pub hit: Option<Vec<f64>>,
    /// The proof, if the motion is free and certificates are kept.
    pub certificate: Option<Certificate>,
}

impl Robot {
    /// Returns for each of many straight motions between two configurations whether it is free. The
    /// configuration at time t is `(1 - t) start + t end`, coordinate by coordinate; the quaternion
    /// of a floating joint is then normalized.
    ///
    /// The start and the end of each motion are rows of one value for each coordinate. A motion is
    /// free if no pair of links collides, as [`check`](Self::check) decides it, at any real time,
    /// and under the exact kinematics of the numbers of the joints as well as the rounded poses.
    ///
    /// # Accuracy
    /// No verdict is by sampling. Bounds on how far each link moves prove that intervals of the
    /// motion are free (lemma L43 of the proofs). A motion that touches, but does not penetrate, is
    /// found to collide only if it touches at a time that is examined, and is undecided otherwise.
    ///
    /// # Errors
    /// As for [`check`](Self::check). The two lists of configurations must have the same length.
    ///
    /// # Complexity
    /// Each step costs about one check of a configuration. The number of steps of a motion grows
    /// with its length over the smallest distance on the way.
    ///
    /// ```
    /// use impinge::query::batch::Execution;
    /// use impinge::robot::{CheckOptions, Joint, JointKind, Link, MotionOptions, Robot, Verdict};
    /// use impinge::scene::Scene;
    /// use impinge::{Pose, Shape};
    ///
    /// let links = vec![
    ///     Link { name: "rail".into(), shape: None },
    ///     Link { name: "tip".into(), shape: Some(Shape::sphere([0.0; 3], 0.005)?) },
    /// ];
    /// let slide = Joint::fixed("slide", "rail", "tip", Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0]);
    /// let robot = Robot::new(links, vec![slide])?;
    /// let mut scene = Scene::new();
    /// let plate = Shape::cuboid([0.0005, 1.0, 1.0])?;
    /// scene.add("plate", plate, Pose::from_translation([0.025, 0.0, 0.0])?)?;
    /// let check = CheckOptions { obstacles: Some(&scene), ..CheckOptions::default() };
    /// let options = MotionOptions { check, ..MotionOptions::default() };
    /// let found = robot.check_motions(&[-0.5], &[0.5], &options, Execution::default())?;
    /// assert_eq!(found.values[0].verdict, Verdict::Collides);
    /// assert!((found.values[0].free_until - 0.5195).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check_motions(
        &self,
        starts: &[f64],
        ends: &[f64],
        options: &MotionOptions<'_>,
        execution: Execution<'_>,
    ) -> Result<Answers<MotionCheck>, CheckError> {
        let rows = self.check_rows(starts).map_err(CheckError::Configuration)?;
        if self.check_rows(ends).map_err(CheckError::Configuration)? != rows {
            return Err(CheckError::Lengths { starts: starts.len(), ends: ends.len() });
        }
        options.check.validate()?;
        let columns = self.coordinates().len();
        let row = |values: &'_ [f64], row: usize| values[row * columns..(row + 1) * columns].to_vec();
        let scan = Scan::new(self, &options.check);
        let values = execution.rows(
            rows,
            || scan.state(),
            |state, at| {
                let mut search = Search::new(options, [row(starts, at), row(ends, at)]);
                search.run(&scan, state, execution.budget());
                search.answer()
            },
        );
        let values = values.map_err(CheckError::Stopped)?;
        let answers = Answers { shape: vec![rows], status: vec![Status::Ok; rows], values };
        Ok(answers.mark_undecided(|found| found.verdict == Verdict::Undecided))
    }
}

/// The search for the first contact of a motion.
struct Search {
    ends: [Vec<f64>; 2],
    max_steps: usize,
    free_until: f64,
    /// Whether an interval was left undecided.
    has_gap: bool,
    hit: Option<(f64, Collision)>,
    rows: Option<Vec<CertificateRow>>,
}

impl Search {
    fn new(options: &MotionOptions<'_>, ends: [Vec<f64>; 2]) -> Self {
        let rows = options.keeps_certificate.then(Vec::new);
        Self { ends, max_steps: options.max_steps, free_until: 0.0, has_gap: false, hit: None, rows }
    }

    /// Examines intervals from the start of the motion to its end, and halves those that are not
    /// proved free.
    fn run(&mut self, scan: &Scan<'_>, state: &mut State, budget: &Budget<'_>) {
        scan.begin(state, &self.ends);
        let mut stack: Vec<([f64; 2], Items)> = vec![([0.0, 1.0], scan.items())];
        // The start itself, which no interval has as its middle.
        if let Some(collision) = scan.collision_at_start(state, budget) {
            self.hit = Some((0.0, collision));
            return;
        }
        let mut steps = 0;
        while let Some(([low, high], items)) = stack.pop() {
            let hit_at = self.hit.as_ref().map_or(f64::INFINITY, |(time, _)| *time);
            if !self.has_gap {
                self.free_until = low;
            }
            if low >= hit_at || hit_at - low <= MAX_CONTACT_LENGTH || (self.has_gap && self.hit.is_some()) {
                return;
            }
            steps += 1;
            if steps > self.max_steps || budget.is_spent() {
                self.has_gap = true;
                return;
            }
            let middle = 0.5 * (low + high);
            let open = match scan.examine(state, [low, middle, high], &items, self.rows.as_mut(), budget) {
                Finding::Open(open) => open,
                Finding::Hit(collision, open) => {
                    self.hit = Some((middle, collision));
                    stack.push(([low, middle], open));
                    continue;
                }
            };
            if open.is_empty() {
                continue;
            }
            let length = high - low;
            if length <= MIN_LENGTH || (length <= MIN_SAMPLED_LENGTH && scan.are_boundless(&open)) {
                self.has_gap = true;
                continue;
            }
            stack.push(([middle, high], open.clone()));
            stack.push(([low, middle], open));
        }
        if !self.has_gap && self.hit.is_none() {
            self.free_until = 1.0;
        }
    }

    fn answer(self) -> MotionCheck {
        let verdict = match (&self.hit, self.has_gap) {
            (Some(_), _) => Verdict::Collides,
            (None, true) => Verdict::Undecided,
            (None, false) => Verdict::Free,
        };
        let [start, end] = self.ends;
        let hit = self.hit.as_ref().map(|(time, _)| between(&start, &end, *time));
        let rows = self.rows.filter(|_| verdict == Verdict::Free);
        MotionCheck {
            verdict,
            free_until: self.free_until,
            hit_at: self.hit.as_ref().map(|(time, _)| *time),
            collision: self.hit.map(|(_, collision)| collision),
            hit,
            certificate: rows.map(|rows| Certificate { start, end, rows }),
        }
    }
}
