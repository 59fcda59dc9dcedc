//! The map between the frames in which two meshes are stored, with its error. Distance bounds
//! compare boxes of the guest with boxes of the host in the host's packed frame
//! (`mesh/storage/frame.rs`).

/// Map from the guest's packed frame to the host's packed frame: `host = linear · guest +
/// translation`.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeFrame {
    pub(super) linear: [[f64; 3]; 3],
    pub(super) translation: [f64; 3],
    /// Error bound for the image of a packed point on each axis, in units of the host's packed
    /// frame.
    pub(super) error: f64,
    /// Lower and upper bound of the length in metric units of one unit of the host's packed frame.
    pub(super) stretch: [f64; 2],
}
