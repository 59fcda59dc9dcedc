//! The state that a search keeps for the next search of the same two meshes.

use super::frontier::Frontier;
use super::relative_frame::RelativeFrame;

/// State that a search keeps for the next search of the same two meshes.
#[derive(Clone, Debug, Default)]
pub(crate) struct WarmStart {
    /// Faces that were nearest, which the next search tries first.
    pub(super) faces: Option<[u32; 2]>,
    /// Node pairs at which the search ended, if they were kept.
    pub(super) frontier: Option<Frontier>,
    /// Relative frame of the meshes, if the search was costly.
    pub(super) costly: Option<RelativeFrame>,
}
