//! What a search keeps for the next search of the same two meshes.

use super::frontier::Frontier;
use super::relative_frame::RelativeFrame;

/// What a search leaves for the next one of the same two meshes.
#[derive(Clone, Debug, Default)]
pub(crate) struct WarmStart {
    /// The faces that were nearest.
    pub(super) faces: Option<[u32; 2]>,
    /// Where it ended, if that was kept.
    pub(super) frontier: Option<Frontier>,
    /// How the meshes stood, if it was costly.
    pub(super) costly: Option<RelativeFrame>,
}
