//! The pair of faces that intersected in the last query of two meshes.

/// Pair of faces that intersected in the last query of two meshes. The next query tests it first.
///
/// Each time the pair no longer intersects, the number of queries until it is tested again doubles,
/// up to 64. So the test costs almost nothing if consecutive poses are unrelated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LastHit {
    faces: Option<[u32; 2]>,
    /// Number of failed tries since the last successful one.
    failures: u32,
    /// Number of queries to skip before the faces are tried again.
    queries_to_skip: u32,
}

impl LastHit {
    /// Maximum number of failures that count. Six lead to a try in every 2^6 queries; a larger
    /// number would find a pair that intersects again later, and a smaller one would try useless
    /// pairs more often.
    const MAX_FAILURES: u32 = 6;

    /// Returns the faces to try now, or `None` if this query skips the try.
    pub(super) fn faces_to_try(&mut self) -> Option<[u32; 2]> {
        if self.queries_to_skip > 0 {
            self.queries_to_skip -= 1;
            return None;
        }
        self.faces
    }

    /// Records whether the faces that were tried intersect.
    pub(super) fn record_try(&mut self, is_hit: bool) {
        self.failures = if is_hit { 0 } else { (self.failures + 1).min(Self::MAX_FAILURES) };
        self.queries_to_skip = (1 << self.failures) - 1;
    }

    /// Keeps the pair of faces that a search found, if it found one.
    pub(super) fn remember(&mut self, hit: Option<[u32; 2]>) {
        self.faces = hit.or(self.faces);
    }
}
