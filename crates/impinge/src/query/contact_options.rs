//! Which contacts are wanted.

/// Which contacts are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Points that are at most this far apart are contacts too, in world units. Zero, the default, asks for those that touch; so
    /// do negative numbers and NaN.
    pub margin: f64,
    /// How many points a manifold may have, at least one: the deepest, the farthest from it, and then each time the one that
    /// adds the most area. Four, the default, hold a face as firmly as more do.
    pub most_points: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self { margin: 0.0, most_points: 4 }
    }
}
