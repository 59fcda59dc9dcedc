//! Queries of points and rays against a mesh.
//!
//! `nearest` finds the closest point of a mesh, and `point_packet` culls the triangles of a packet
//! for it. `face_search` finds the faces for which a caller's bound is small. `rays` finds the
//! faces that a ray intersects. `ray_packet` looks along a line at the triangles of a packet, for
//! rays and for the crossings of [`solid`](super::solid).

pub(super) mod face_search;
pub(super) mod nearest;
mod point_packet;
pub(super) mod ray_packet;
pub(super) mod rays;
#[cfg(test)]
mod small_triangles;
