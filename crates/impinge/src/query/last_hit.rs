//! The faces that met when two meshes were last asked about.

/// Two faces that met when two meshes were last asked about.
///
/// They are asked first. Each time that they no longer meet it is twice as long until faces are tried again, up to 64 questions, so
/// that poses that have nothing to do with each other pay next to nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LastHit {
    faces: Option<[u32; 2]>,
    /// Number of failed tries since the last successful one.
    failures: u32,
    /// Number of queries to skip before the faces are tried again.
    rest: u32,
}

impl LastHit {
    /// The most failures that count: 2^6 questions.
    const MOST_FAILURES: u32 = 6;

    /// Returns the faces to try now.
    pub(super) fn faces_to_try(&mut self) -> Option<[u32; 2]> {
        if self.rest > 0 {
            self.rest -= 1;
            return None;
        }
        self.faces
    }

    /// Remembers whether the faces that were tried met.
    pub(super) fn learn(&mut self, tried_well: bool) {
        self.failures = if tried_well { 0 } else { (self.failures + 1).min(Self::MOST_FAILURES) };
        self.rest = (1 << self.failures) - 1;
    }

    /// Remembers two faces that met, if there are any.
    pub(super) fn remember(&mut self, hit: Option<[u32; 2]>) {
        self.faces = hit.or(self.faces);
    }
}
