//! The arrays of a mesh and the forms in which queries read them.
//!
//! `positions` and `faces` hold the input as given. `frame` maps positions to the packed frame, in
//! which a mesh is near the origin and about one unit large. `leaf` names the faces of each leaf.
//! `eight_triangles` and `stored_corners` gather the corners of a leaf's faces, `triangles` lays
//! them out side by side, and `packet` makes such packets when a query first needs them and caches
//! them. `stamp` tells states of meshes apart.

pub(super) mod eight_triangles;
pub(super) mod faces;
pub(super) mod frame;
pub(super) mod leaf;
pub(super) mod packet;
pub(super) mod positions;
pub(super) mod stamp;
pub(super) mod stored_corners;
pub(super) mod triangles;
