//! Slabs: what lies between two parallel planes, as a second bound of what a node holds. A patch of a surface is thin
//! along its normal whichever way it faces, where its box is as thick as it is wide.
//!
//! Source: Kay, Kajiya, *Ray tracing complex scenes*, SIGGRAPH 1986 (Ericson, 4.4.6 and 4.6); ours is one slab a node,
//! whose direction is the node's own.

/// The points x with `min ≤ normal · x ≤ max`. The normal is whatever its numbers say, of any length.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub struct Slab {
    /// Across the planes; no component is larger than one in magnitude.
    pub normal: [f32; 3],
    /// The least height that is inside.
    pub min: f32,
    /// The greatest height that is inside.
    pub max: f32,
}

impl Slab {
    /// All of space: what is known of a node before anything is.
    pub const ALL: Self = Self { normal: [0.0; 3], min: f32::NEG_INFINITY, max: f32::INFINITY };
}
