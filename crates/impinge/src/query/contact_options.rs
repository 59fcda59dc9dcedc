//! Options of a contact query.

/// Options of a contact query ([`Query::with_contacts`](super::Query::with_contacts)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Maximum gap between two points that count as a contact, in world units. Zero, the default,
    /// finds only contacts of things that touch or overlap. Negative numbers and NaN count as zero.
    pub margin: f64,
    /// Maximum number of points of a manifold; zero counts as one. The deepest point is kept first,
    /// of equally deep ones the one farthest from their middle. Then come the point farthest from
    /// it, and each time the point that adds the most area. Four points, the default, hold a face
    /// as firmly as more points do.
    pub most_points: usize,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self { margin: 0.0, most_points: 4 }
    }
}
