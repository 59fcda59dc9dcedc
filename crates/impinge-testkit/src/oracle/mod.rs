//! Which triangles meet: slow, exact, and by methods of its own.
//!
//! A triangle is the closed convex hull of the images of its three corners, zero area included, under an affine map whose
//! entries are the real numbers given. Touching counts. All coordinates must be finite.
//!
//! - [`triangles_meet`]: linear programming, the reference.
//! - [`triangles_meet_by_clipping`]: edges clipped against triangles, an independent second opinion.
//! - [`brute_force`] and [`grid`]: all meeting pairs of two meshes, by trying each, and for millions of triangles.

mod boxes;
mod certificate;
mod clipping;
mod grid;
mod integers;
mod simplex;

pub use boxes::WorldBox;
pub use clipping::triangles_meet_by_clipping;
pub use grid::grid;
pub use simplex::triangles_meet;

use crate::Posed;

/// Every meeting pair (face of a, face of b), sorted: each pair of triangles whose [`WorldBox`]es overlap is asked.
///
/// # Complexity
/// The product of the numbers of faces.
pub fn brute_force(a: Posed, b: Posed) -> Vec<(u32, u32)> {
    let boxes_b: Vec<WorldBox> = WorldBox::of_faces(b);
    let mut pairs = Vec::new();
    for (i, box_a) in WorldBox::of_faces(a).iter().enumerate() {
        for (j, box_b) in boxes_b.iter().enumerate() {
            if box_a.overlaps(box_b) && faces_meet(a, i, b, j) {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs
}

fn faces_meet(a: Posed, i: usize, b: Posed, j: usize) -> bool {
    triangles_meet(&a.triangle(i), &a.world_from_local, &b.triangle(j), &b.world_from_local)
}
