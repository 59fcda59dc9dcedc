//! Options of a query of two meshes.

use crate::budget::Budget;
use crate::simd::{self, Level};

/// Options of a query. `level` and `host` change no answer: they exist for measurements and for
/// tests that compare all of them.
#[derive(Clone, Copy, Debug)]
pub struct Options<'i> {
    /// The vector unit that the query runs on.
    pub level: Level,
    /// Which mesh is the host, in whose frame boxes and triangles are compared.
    pub host: HostChoice,
    /// Limits on the work of the query.
    pub budget: &'i Budget<'i>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { level: simd::best_level(), host: HostChoice::SmallerError, budget: Budget::unlimited() }
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
