//! How a query of two meshes runs.

use std::fmt;

use crate::simd::{self, Level};

/// How a query runs. Level and host change no answer: they are for measuring and for tests that say so.
#[derive(Clone, Copy, Debug)]
pub struct Options<'i> {
    /// The vector unit to use.
    pub level: Level,
    /// In whose frame boxes and triangles are compared.
    pub host: HostChoice,
    /// What may end the query before its time.
    pub interrupt: Interrupt<'i>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { level: simd::best_level(), host: HostChoice::SmallerError, interrupt: Interrupt::NEVER }
    }
}

/// In whose frame two meshes are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostChoice {
    /// The one in which rounding costs less, relative to the mesh carried into it (*Notes on Real Time Collision
    /// Detection*, 2.2).
    SmallerError,
    /// Always the first mesh's.
    First,
    /// Always the second mesh's.
    Second,
}

/// A function that may end a long query early.
///
/// The query calls it about every 100 microseconds. Once it returns true the query ends soon, with a safe answer: the
/// surfaces intersect, they are within any clearance, and the lower bound of their distance is zero. A list of pairs has
/// the pairs found so far. The caller has to discard such an answer.
///
/// ```
/// use std::time::{Duration, Instant};
///
/// use impinge::mesh::Interrupt;
/// use impinge::query::Query;
/// use impinge::{Mesh, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]])?;
/// let begun = Instant::now();
/// let is_late = || begun.elapsed() > Duration::from_millis(20);
/// assert!(Query::new().with_interrupt(Interrupt::when(&is_late)).intersects(&mesh, &mesh));
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Clone, Copy)]
pub struct Interrupt<'i>(Option<&'i (dyn Fn() -> bool + Sync)>);

impl<'i> Interrupt<'i> {
    /// Lets the work go on to its end.
    pub const NEVER: Self = Self(None);

    /// Ends the work once `is_wanted` returns true. Several threads may call it at once.
    #[must_use]
    pub fn when(is_wanted: &'i (dyn Fn() -> bool + Sync)) -> Self {
        Self(Some(is_wanted))
    }

    /// Reports whether to give up.
    #[inline]
    pub(crate) fn is_wanted(self) -> bool {
        self.0.is_some_and(|is_wanted| is_wanted())
    }
}

impl fmt::Debug for Interrupt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Interrupt::when(..)" } else { "Interrupt::NEVER" })
    }
}
