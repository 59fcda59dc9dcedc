//! Straight motions in the space of configurations: proofs that nothing collides on the way, and
//! the time of the first contact.

use super::certificate::Certificate;
use super::check::{CheckError, CheckOptions, Collision};
use super::interval::{Answer, CertificateRow, Scan, State, Subject, Wish, between};
use super::model::Robot;
use super::reach::QUANTUM;
use crate::budget::Budget;
use crate::query::batch::{Answers, Execution, Status};

/// Length of the shortest intervals of a motion that are examined, 2^-40 of the motion.
const MIN_LENGTH: f64 = 1.0 / (1_u64 << 40) as f64;

/// Length of an interval that is known to contain the first contact with which the search ends,
/// 2^-34 of the motion.
const MAX_CONTACT_LENGTH: f64 = 1.0 / (1_u64 << 34) as f64;

/// Length of the shortest step from the end of what is proved free, 2^-36 of the motion. Links that
/// approach each other are free for less and less; this step leads beyond their first contact.
const MIN_STEP: f64 = 1.0 / (1_u64 << 36) as f64;

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

/// A subject of a proof, and where it is not yet proved free.
#[derive(Clone, Debug)]
struct Track {
    subject: Subject,
    /// Intervals that are not proved free, the last one first.
    open: Vec<[f64; 2]>,
    /// How long the subject was free before and after the last time that was chosen for it, and how
    /// that changed.
    half: f64,
    trend: f64,
}

impl Track {
    /// Returns the first interval that is not proved free.
    fn first(&self) -> Option<[f64; 2]> {
        self.open.last().copied()
    }

    /// Returns the interval that contains a time and is not proved free.
    fn around(&self, time: f64) -> Option<[f64; 2]> {
        self.open.iter().copied().find(|[low, high]| (*low..=*high).contains(&time))
    }

    /// Removes what an interval covers from those that are open.
    fn free(&mut self, [low, high]: [f64; 2]) {
        if !self.open.iter().any(|open| low <= open[1] && open[0] <= high) {
            return;
        }
        let rest = |&[first, last]: &[f64; 2]| {
            let parts = if high < first || last < low {
                [None, Some([first, last])]
            } else {
                [(high < last).then_some([high, last]), (first < low).then_some([first, low])]
            };
            parts.into_iter().flatten()
        };
        self.open = self.open.iter().flat_map(rest).collect();
    }

    /// Removes all after a time.
    fn end_at(&mut self, time: f64) {
        self.open.retain(|open| open[0] <= time);
        self.open.iter_mut().for_each(|open| open[1] = open[1].min(time));
    }

    /// Returns the time to examine in the first open interval: in its middle, or, if the subject is
    /// free for much less, about as far from its start as that.
    fn next_time(&self, [low, high]: [f64; 2]) -> f64 {
        let length = high - low;
        let step = (self.half * self.trend).max(MIN_STEP);
        if self.half > 0.0 && 8.0 * step < length {
            simplest_between([low + 0.5 * step, low + 0.875 * step])
        } else {
            simplest_between([low + 0.25 * length, high - 0.25 * length])
        }
    }

    /// Records how long the subject is free about a time that was chosen for it.
    fn record(&mut self, half: f64) {
        self.trend = if self.half > 0.0 { (half / self.half).clamp(0.25, 1.0) } else { 1.0 };
        self.half = half;
    }
}

/// Returns the number in an interval that is a multiple of the largest power of two. Intervals of
/// several subjects often have the same.
fn simplest_between([low, high]: [f64; 2]) -> f64 {
    let mut scale = 1.0;
    loop {
        let found = (low * scale).ceil() / scale;
        if found <= high || scale * QUANTUM >= 1.0 {
            return found;
        }
        scale *= 2.0;
    }
}

/// The subjects whose distances are computed at a time, wherever that leads.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Exact {
    All,
    One(usize),
}

/// The search for the first contact of a motion.
struct Search {
    ends: [Vec<f64>; 2],
    max_steps: usize,
    tracks: Vec<Track>,
    /// Start of the first interval that is left undecided.
    gap: Option<f64>,
    hit: Option<(f64, Collision)>,
    rows: Option<Vec<CertificateRow>>,
}

impl Search {
    fn new(options: &MotionOptions<'_>, ends: [Vec<f64>; 2]) -> Self {
        let rows = options.keeps_certificate.then(Vec::new);
        Self { ends, max_steps: options.max_steps, tracks: Vec::new(), gap: None, hit: None, rows }
    }

    /// Examines times until all subjects are proved free before the first contact.
    fn run(&mut self, scan: &Scan<'_>, state: &mut State, budget: &Budget<'_>) {
        scan.begin(state, &self.ends);
        let track = |subject| Track { subject, open: vec![[0.0, 1.0]], half: 0.0, trend: 1.0 };
        self.tracks = scan.subjects().into_iter().map(track).collect();
        if !self.tracks.is_empty() {
            self.examine(scan, state, 0.0, Exact::All, budget);
        }
        let mut steps = 0;
        while let Some((chosen, [low, high])) = self.first_open() {
            let is_near_hit = self.hit.as_ref().is_some_and(|(time, _)| time - low <= MAX_CONTACT_LENGTH);
            if is_near_hit {
                return;
            }
            if let (Some(gap), Some(_)) = (self.gap, &self.hit) {
                self.approach_contact(scan, state, gap, budget);
                return;
            }
            steps += 1;
            if steps > self.max_steps || budget.is_spent() {
                self.gap.get_or_insert(low);
                return;
            }
            let track = &mut self.tracks[chosen];
            let min_length = if scan.is_boundless(track.subject) { MIN_SAMPLED_LENGTH } else { MIN_LENGTH };
            if high - low <= min_length {
                self.gap.get_or_insert(low);
                track.free([low, high]);
                continue;
            }
            let time = track.next_time([low, high]);
            self.examine(scan, state, time, Exact::One(chosen), budget);
        }
    }

    /// Looks for an earlier contact than the one that was found, by halving the time since `gap`,
    /// where nothing could be proved.
    fn approach_contact(&mut self, scan: &Scan<'_>, state: &mut State, gap: f64, budget: &Budget<'_>) {
        let mut low = gap;
        while let Some((hit, _)) = self.hit
            && hit - low > MAX_CONTACT_LENGTH
            && !budget.is_spent()
        {
            let middle = 0.5 * (low + hit);
            self.examine(scan, state, middle, Exact::All, budget);
            if self.hit.as_ref().is_some_and(|(time, _)| *time == hit) {
                low = middle;
            }
        }
    }

    /// Returns the number of the subject whose open interval is the first, and the interval.
    fn first_open(&self) -> Option<(usize, [f64; 2])> {
        let open = self.tracks.iter().enumerate().filter_map(|(at, track)| Some((at, track.first()?)));
        open.min_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]))
    }

    /// Examines a time for all subjects that are open there. Distances of shapes are computed for
    /// `exact`, and for those that are open on both sides for a while.
    fn examine(&mut self, scan: &Scan<'_>, state: &mut State, time: f64, exact: Exact, budget: &Budget<'_>) {
        scan.move_to(state, time);
        for (at, track) in self.tracks.iter_mut().enumerate() {
            let Some([low, high]) = track.around(time) else { continue };
            let (before, after) = (time - low, high - time);
            let is_exact = exact == Exact::All || exact == Exact::One(at) || 4.0 * before.min(after) >= high - low;
            let wish = Wish { half: before.max(after), is_exact };
            match scan.examine(state, track.subject, wish, budget) {
                Answer::Free(half) => {
                    if half > 0.0 {
                        if let Some(rows) = &mut self.rows {
                            let Subject { link, pair } = track.subject;
                            rows.push(CertificateRow { link, other: pair.map(|(_, other)| other), time, half });
                        }
                        track.free([time - half, time + half]);
                    } else if exact == Exact::One(at) {
                        // Nothing is known: both sides are examined.
                        track.free([time, time]);
                    }
                    if is_exact {
                        track.record(half);
                    }
                }
                Answer::Hit(collision) => {
                    self.hit = Some((time, collision));
                    self.tracks.iter_mut().for_each(|track| track.end_at(time));
                    return;
                }
            }
        }
    }

    /// Returns the time until which all subjects are proved free.
    fn free_until(&self) -> f64 {
        let open = self.first_open().map(|(_, [low, _])| low);
        let hit = self.hit.as_ref().map(|(time, _)| *time);
        [open, self.gap, hit].into_iter().flatten().fold(1.0, f64::min)
    }

    fn answer(self) -> MotionCheck {
        let free_until = self.free_until();
        let verdict = match (&self.hit, self.gap) {
            (Some(_), _) => Verdict::Collides,
            (None, Some(_)) => Verdict::Undecided,
            (None, None) => Verdict::Free,
        };
        let [start, end] = self.ends;
        let hit = self.hit.as_ref().map(|(time, _)| between(&start, &end, *time));
        let rows = self.rows.filter(|_| verdict == Verdict::Free);
        MotionCheck {
            verdict,
            free_until,
            hit_at: self.hit.as_ref().map(|(time, _)| *time),
            collision: self.hit.map(|(_, collision)| collision),
            hit,
            certificate: rows.map(|rows| Certificate { start, end, rows }),
        }
    }
}
