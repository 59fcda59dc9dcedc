//! Where the guest is, seen from the host.

/// Map from the guest's packed frame to the host's packed frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeFrame {
    pub(super) linear: [[f64; 3]; 3],
    pub(super) translation: [f64; 3],
    /// Error bound for the image of a packed point on an axis.
    pub(super) error: f64,
    /// Lower and upper bound of the length in metric units of one unit of the host's packed frame.
    pub(super) stretch: [f64; 2],
}
