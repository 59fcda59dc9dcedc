//! What a search for the nearest boxes finds.

/// A box that is near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Of the box.
    pub key: u32,
    /// From the point to the nearest point of the box, zero inside.
    ///
    /// # Accuracy
    /// Three squares of rounded differences and two sums: within 2^-51 of itself.
    pub distance_squared: f64,
}
