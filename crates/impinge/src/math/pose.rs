//! An affine map from a mesh's own frame to the world.

/// The affine map `x = linear · v + translation`, whose entries are the real numbers that the floats are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Pose {
    /// The map that moves nothing.
    pub const IDENTITY: Self =
        Self { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// The linear part, rows first: column vectors are multiplied from the left.
    #[must_use]
    pub fn linear(&self) -> &[[f64; 3]; 3] {
        &self.linear
    }

    /// The translation, in world units.
    #[must_use]
    pub fn translation(&self) -> &[f64; 3] {
        &self.translation
    }
}
