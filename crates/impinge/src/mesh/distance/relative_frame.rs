//! Where the guest is, seen from the host.

/// How the guest's packed frame lies in the host's.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeFrame {
    pub(super) linear: [[f64; 3]; 3],
    pub(super) translation: [f64; 3],
    /// How far the image of a packed point may be off on an axis.
    pub(super) error: f64,
    /// Metric units for one of the host's packed frame, at least and at most.
    pub(super) stretch: [f64; 2],
}
