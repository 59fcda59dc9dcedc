//! The flat parts of a surface, and which of them support the solid.

use super::topology::Components;

/// The flat parts of a surface.
#[derive(Debug)]
pub(crate) struct Facets {
    /// The faces of each part. A face without area is a part of its own.
    pub(crate) parts: Components,
    /// For each part the plane that the part lies in.
    pub(crate) planes: Vec<FacetPlane>,
}

/// The plane of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FacetPlane {
    /// The largest face of the facet. Its corners define the plane.
    pub(crate) face: u32,
    /// How far the mesh reaches beyond the plane, in the frame of the mesh; infinite if it is more
    /// than rounding, or if it is not known. Otherwise the facet *supports* the mesh: the way from
    /// any point of the solid to the plane leaves the solid.
    pub(crate) overhang: f64,
}
