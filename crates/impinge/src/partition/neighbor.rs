//! The result of a search for the nearest boxes.

/// A box near a point, with its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Key of the box.
    pub key: u32,
    /// Squared distance from the point to the nearest point of the box, in squared units of the
    /// boxes; zero if the point is inside.
    ///
    /// # Accuracy
    /// The relative error is at most 2^-51: the squares of three rounded differences are added.
    pub distance_squared: f64,
}
