//! Options of a query of two meshes.

use std::fmt;

use crate::simd::{self, Level};

/// Options of a query. `level` and `host` change no answer: they exist for measurements and for
/// tests that compare all of them.
#[derive(Clone, Copy, Debug)]
pub struct Options<'i> {
    /// The vector unit that the query runs on.
    pub level: Level,
    /// Which mesh is the host, in whose frame boxes and triangles are compared.
    pub host: HostChoice,
    /// A function that can end the query early.
    pub interrupt: Interrupt<'i>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { level: simd::best_level(), host: HostChoice::SmallerError, interrupt: Interrupt::NEVER }
    }
}

/// Which of two meshes is the host, in whose frame both are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostChoice {
    /// The mesh in whose frame the rounding error is smaller, relative to the size of the mesh that
    /// is carried into it (*Notes on Real Time Collision Detection*, 2.2).
    SmallerError,
    /// Always the first mesh.
    First,
    /// Always the second mesh.
    Second,
}

/// A function that can end a long query early.
///
/// The query calls it about every 100 microseconds. If it returns `true`, the query ends soon with
/// a conservative answer: the surfaces intersect, they are within any clearance, and the lower
/// bound of their distance is zero. A list of pairs holds the pairs found so far. The caller must
/// discard such an answer.
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
    /// Never ends a query early.
    pub const NEVER: Self = Self(None);

    /// Returns an interrupt that ends a query once `is_wanted` returns `true`. Several threads may
    /// call it at once.
    #[must_use]
    pub fn when(is_wanted: &'i (dyn Fn() -> bool + Sync)) -> Self {
        Self(Some(is_wanted))
    }

    /// Reports whether the query must end now.
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
