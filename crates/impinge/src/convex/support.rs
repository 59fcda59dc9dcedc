//! Convex sets that are defined by their support functions.

use std::fmt;

/// A convex set in its own frame, defined by its support function.
///
/// A returned coordinate outside [`reach`](Self::reach) is clamped to it, and NaN becomes zero. So
/// a wrong function gives wrong answers, but never a NaN, a panic or an endless loop.
pub trait Support: fmt::Debug + Send + Sync {
    /// Returns a point of the set that is farthest along `direction`, both in the set's own frame.
    /// The direction is finite, and its entry of greatest magnitude is ±1, or it is zero. For zero,
    /// any point of the set will do.
    ///
    /// # Accuracy
    /// Answers are proved for functions whose point is wrong by at most 2^-50 of
    /// [`reach`](Self::reach) on each axis, and whose product with the direction is as close to the
    /// greatest one.
    fn support(&self, direction: [f64; 3]) -> [f64; 3];

    /// Returns an upper bound on the magnitude of the set's coordinates on each axis, in the set's
    /// own frame.
    fn reach(&self) -> [f64; 3];
}
