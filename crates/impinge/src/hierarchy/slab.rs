//! Slabs: the space between two parallel planes, as a second bound of the content of a node. A
//! region of a surface is thin along its normal whatever the direction of the normal, but its box
//! may be as thick as it is wide.
//!
//! Source: Kay, Kajiya, *Ray tracing complex scenes*, SIGGRAPH 1986 (Ericson, 4.4.6 and 4.6). Ours
//! has one slab per node, in a direction of the node's own.

/// The points x with `min ≤ normal · x ≤ max`, in the frame of the boxes of its tree. The normal is
/// used exactly as stored and may have any length.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Zeroable, bytemuck::Pod)]
#[repr(C)]
pub struct Slab {
    /// Normal of the planes. No component is larger than 1 in magnitude.
    pub normal: [f32; 3],
    /// Minimum of `normal · x` inside the slab.
    pub min: f32,
    /// Maximum of `normal · x` inside the slab.
    pub max: f32,
}

impl Slab {
    /// All of space: the slab of a node about which nothing is known.
    pub const ALL: Self = Self { normal: [0.0; 3], min: f32::NEG_INFINITY, max: f32::INFINITY };
}
