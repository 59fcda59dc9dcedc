//! Oracles of intersection, boxes, spheres, distance and time of contact: slow, exact, and
//! independent of the library.
//!
//! A triangle is the closed convex hull of the images of its three corners under an affine map
//! whose entries are exact real numbers. It may have no area. Touching counts as intersecting. All
//! coordinates must be finite.
//!
//! - [`triangles_meet`]: whether two triangles intersect, by linear programming. It is the
//!   reference.
//! - [`triangles_meet_by_clipping`]: the same by clipping edges against triangles, as an
//!   independent check of the reference.
//! - [`tight_box`]: the box of the exact images of points.
//! - [`brute_force`] and [`grid`]: all intersecting pairs of two meshes, by trying each pair, and
//!   for millions of triangles.
//! - [`minimal_sphere`]: the smallest sphere that contains some points.
//! - [`squared_distance_of_hulls`]: the squared distance of two convex hulls.
//! - [`first_contact`]: the first time of contact of moving vertices, edges and faces.

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

/// Returns every intersecting pair (face of a, face of b), sorted. It tests each pair of triangles
/// whose [`WorldBox`]es overlap.
///
/// # Complexity
/// The product of the numbers of faces.
pub fn brute_force(a: Posed, b: Posed) -> Vec<(u32, u32)> {
    let boxes_b: Vec<WorldBox> = WorldBox::of_faces(b);
    let mut pairs = Vec::new();
    for (i, box_a) in WorldBox::of_faces(a).iter().enumerate() {
        for (j, box_b) in boxes_b.iter().enumerate() {
            if box_a.overlaps(box_b) && faces_intersect(a, i, b, j) {
                pairs.push((i as u32, j as u32));
            }
        }
    }
    pairs
}

/// Reports whether two faces intersect, by [`triangles_meet`].
fn faces_intersect(a: Posed, i: usize, b: Posed, j: usize) -> bool {
    triangles_meet(&a.triangle(i), &a.world_from_local, &b.triangle(j), &b.world_from_local)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Rng, poses, solids};

    #[test]
    fn boxes_reject_no_intersecting_pair() {
        let mut rng = Rng::new(8);
        for _ in 0..4 {
            let (a, b) = (solids::grid_soup(&mut rng, 60, 5, 2), solids::grid_soup(&mut rng, 60, 5, 2));
            let pose = poses::rotation(&mut rng);
            let (a, b) = (a.at(pose), b.at(pose));
            let every = (0..60u32).flat_map(|i| (0..60u32).map(move |j| (i, j)));
            let meeting: Vec<(u32, u32)> =
                every.filter(|&(i, j)| faces_intersect(a, i as usize, b, j as usize)).collect();
            assert_eq!(brute_force(a, b), meeting);
            assert!((100..1_000).contains(&meeting.len()), "{}", meeting.len());
        }
    }
}
