//! Which triangles meet, and what box points fill: slow, exact, and by methods of its own.
//!
//! A triangle is the closed convex hull of the images of its three corners, zero area included, under an affine map whose
//! entries are the real numbers given. Touching counts. All coordinates must be finite.
//!
//! - [`triangles_meet`]: linear programming, the reference.
//! - [`triangles_meet_by_clipping`]: edges clipped against triangles, an independent second opinion.
//! - [`tight_box`]: the box of the exact images of points.
//! - [`brute_force`] and [`grid`]: all meeting pairs of two meshes, by trying each, and for millions of triangles.
//!
//! Beside them, and in the same manner, [`minimal_sphere`], [`squared_distance_of_hulls`] and [`first_contact`].

mod boxes;
mod certificate;
mod clipping;
mod extremes;
mod first_contact;
mod grid;
mod integers;
mod minimal_sphere;
mod minimum_norm;
mod polynomial;
mod simplex;

pub use boxes::WorldBox;
pub use clipping::triangles_meet_by_clipping;
pub use extremes::tight_box;
pub use first_contact::{Root, first_contact};
pub use grid::grid;
pub use minimal_sphere::{LeastSphere, minimal_sphere};
pub use minimum_norm::squared_distance_of_hulls;
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

/// [`triangles_meet`] for two faces.
fn faces_meet(a: Posed, i: usize, b: Posed, j: usize) -> bool {
    triangles_meet(&a.triangle(i), &a.world_from_local, &b.triangle(j), &b.world_from_local)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Rng, poses, solids};

    #[test]
    fn boxes_reject_no_pair_that_meets() {
        let mut rng = Rng::new(8);
        for _ in 0..4 {
            let (a, b) = (solids::grid_soup(&mut rng, 60, 5, 2), solids::grid_soup(&mut rng, 60, 5, 2));
            let pose = poses::rotation(&mut rng);
            let (a, b) = (a.at(pose), b.at(pose));
            let every = (0..60u32).flat_map(|i| (0..60u32).map(move |j| (i, j)));
            let meeting: Vec<(u32, u32)> = every.filter(|&(i, j)| faces_meet(a, i as usize, b, j as usize)).collect();
            assert_eq!(brute_force(a, b), meeting);
            assert!((100..1_000).contains(&meeting.len()), "{}", meeting.len());
        }
    }
}
