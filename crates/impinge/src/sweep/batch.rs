//! Times of impact of many motions.

use super::ask::Sweep;
use super::impact::Impact;
use super::motion::Motion;
use crate::budget::Stopped;
use crate::input::InputError;
use crate::query::batch::{Broadcast, Execution};
use crate::shape::Shape;

/// Returns the [`time_of_impact`](super::time_of_impact()) of two things for each row of
/// `broadcast`. `motions` holds motions of the first and of the second thing, and `broadcast`
/// selects one of each for a row. A row holds an error if a motion is not valid for one of the two
/// things.
///
/// ```
/// use impinge::query::batch::{Broadcast, Execution};
/// use impinge::sweep::{Motion, times_of_impact};
/// use impinge::{InputError, Pose, Shape};
///
/// let (sphere, floor) = (Shape::sphere([0.0; 3], 0.5)?, Shape::half_space([0.0, 0.0, 1.0], 0.0)?);
/// let fall = |from: f64| {
///     Motion::between(Pose::from_translation([0.0, 0.0, from])?, Pose::from_translation([0.0, 0.0, from - 4.0])?)
/// };
/// let (falls, rest) = ([fall(2.5)?, fall(9.0)?], [Motion::default()]);
/// let broadcast = Broadcast::new(&[2], &[])?;
/// let found = times_of_impact(&sphere, &floor, [&falls, &rest], &broadcast, Execution::default())?;
/// let hits = found.into_iter().map(|impact| impact.map(|impact| impact.hit()));
/// assert_eq!(hits.collect::<Result<Vec<bool>, InputError>>()?, [true, false]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The errors of [`Execution::rows`].
///
/// # Panics
/// If `broadcast` selects a motion that does not exist.
pub fn times_of_impact(
    a: impl Into<Shape>,
    b: impl Into<Shape>,
    motions: [&[Motion]; 2],
    broadcast: &Broadcast,
    execution: Execution<'_>,
) -> Result<Vec<Result<Impact, InputError>>, Stopped> {
    Sweep::new().times_of_impact(a, b, motions, broadcast, execution)
}

impl Sweep<'_> {
    /// Returns the time of impact of two things for each row of `broadcast`, as
    /// [`times_of_impact`] does. The budget of `execution` takes the place of this sweep's.
    ///
    /// # Errors
    /// The errors of [`Execution::rows`].
    ///
    /// # Panics
    /// If `broadcast` selects a motion that does not exist.
    pub fn times_of_impact(
        self,
        a: impl Into<Shape>,
        b: impl Into<Shape>,
        motions: [&[Motion]; 2],
        broadcast: &Broadcast,
        execution: Execution<'_>,
    ) -> Result<Vec<Result<Impact, InputError>>, Stopped> {
        let (a, b) = (a.into(), b.into());
        let budget = execution.budget();
        execution.rows(
            broadcast.rows(),
            || (),
            |(), row| {
                let [at_a, at_b] = broadcast.sources(row);
                let motion = [&motions[0][at_a], &motions[1][at_b]];
                self.with_budget(budget).time_of_impact(&a, &b, motion[0], motion[1])
            },
        )
    }
}
