//! The result of a search for the nearest boxes.

/// A box near a point, with its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Key of the box.
    pub key: u32,
    /// Squared distance from the point to the nearest point of the box; zero if the point is
    /// inside.
    ///
    /// # Accuracy
    /// It is computed from three squares of rounded differences and two sums: the relative error is
    /// at most 2^-51.
    pub distance_squared: f64,
}
