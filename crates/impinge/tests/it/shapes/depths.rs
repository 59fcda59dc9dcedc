//! Penetration depths of meshes, and their contact patches.

use impinge::Pose;
use impinge::query::{self, contact_patches, intersecting_pairs};
use impinge::shape::Shape;
use impinge_testkit::generate::solids::{cuboid, icosphere};
use impinge_testkit::generate::{Rng, poses};

use crate::shapes::hulls::pose;
use crate::shapes::support::{IDENTITY, at, dot, engine};

/// Checks two spheres that overlap by 0.5, with finer and finer triangles: the depth converges to
/// 0.5.
#[test]
fn depths_of_refined_spheres_converge() {
    let mut widths = Vec::new();
    for (subdivisions, wanted) in [(1, 0.2), (2, 0.05), (3, 0.0125)] {
        let sphere = Shape::solid(&engine(&icosphere(subdivisions)));
        let [a, b] = [[0.0; 3], [1.5, 0.0, 0.0]].map(|place| sphere.at(at(place)).unwrap());
        let depth = query::penetration(&a, &b).expect("they overlap");
        assert!(depth.lower <= depth.upper, "{depth:?}");
        assert!((depth.lower - 0.5).abs() < wanted && (depth.upper - 0.5).abs() < wanted, "{subdivisions} {depth:?}");
        assert!(depth.normal[0] > 1.0 - wanted, "{depth:?}");
        let moved = |by: f64| sphere.at(at([1.5 + depth.normal[0] * by, depth.normal[1] * by, depth.normal[2] * by]));
        assert!(!query::intersects(&a, moved(depth.upper * (1.0 + 1e-9)).unwrap()), "{depth:?}");
        assert!(query::intersects(&a, moved(depth.lower * (1.0 - 1e-9)).unwrap()), "{depth:?}");
        widths.push(depth.upper - depth.lower);
    }
    assert!(widths.iter().all(|&width| width < 1e-3), "{widths:?}");
}

/// Checks that two boxes as meshes have the depth that they have as boxes, and one patch for each
/// place in which they overlap.
#[test]
fn boxes_as_meshes_have_the_depth_of_boxes() {
    let mesh = engine(&cuboid([-0.5; 3], [0.5; 3]));
    let (solid, plain) = (Shape::solid(&mesh), Shape::cuboid([0.5; 3]).unwrap());
    let mut rng = Rng::new(576);
    for case in 0..8 {
        let mut place = if case % 2 == 0 { IDENTITY } else { poses::rotation(&mut rng) };
        place.translation = [0.25 + 0.5 * rng.unit(), 0.25 * rng.uniform(-1.0, 1.0), 0.25 * rng.uniform(-1.0, 1.0)];
        let here = |shape: &Shape| shape.at(Pose::IDENTITY).unwrap();
        let there = |shape: &Shape| shape.at(pose(&place)).unwrap();
        let truth = query::penetration(here(&plain), there(&plain)).expect("they overlap");
        for (a, b) in [(&solid, &solid), (&solid, &plain), (&plain, &solid)] {
            let depth = query::penetration(here(a), there(b)).expect("they overlap");
            assert!(depth.lower <= truth.upper && truth.lower <= depth.upper, "{depth:?} {truth:?}");
            // The direction for the convex hulls, which is exact for convex shapes, is among those
            // tried.
            assert!(depth.upper <= truth.upper * (1.0 + 1e-6) + 1e-6, "{case} {depth:?} {truth:?}");
        }
    }
    // On a plate, slightly sunk in: one patch, whose normal, area and depth are those of the common
    // box.
    let plate = engine(&cuboid([-2.0, -2.0, -0.5], [2.0, 2.0, 0.5]));
    let on_top = mesh.at(at([0.25, 0.25, 0.875]));
    let patches = contact_patches(&plate, on_top);
    assert_eq!(patches.len(), 1);
    let patch = &patches[0];
    assert!(patch.normal[2] > 1.0 - 1e-12 && (patch.area - 1.0).abs() < 1e-12, "{patch:?}");
    assert!((patch.depth - 0.125).abs() < 1e-12, "{patch:?}");
    assert_eq!(patch.pairs, intersecting_pairs(&plate, on_top));
}

/// Checks that two spheres have one round patch, and that two pairs of spheres have two.
#[test]
fn contact_patches_of_spheres_are_discs() {
    let sphere = icosphere(3);
    let far = {
        let mut far = sphere.clone();
        far.vertices.iter_mut().for_each(|v| v[1] += 4.0);
        far
    };
    let (one, two) = (engine(&sphere), engine(&sphere.clone().joined(&far)));
    for (mesh, count) in [(&one, 1), (&two, 2)] {
        let patches = contact_patches(mesh, mesh.at(at([0.125, 0.0, 1.5])));
        assert_eq!(patches.len(), count);
        let direction = [0.125, 0.0, 1.5];
        let apart = dot(&direction, &direction).sqrt();
        for patch in &patches {
            assert!(dot(&patch.normal, &direction) / apart > 0.999, "{patch:?}");
            let radius_squared = 1.0 - apart * apart / 4.0;
            assert!((patch.area / (std::f64::consts::PI * radius_squared) - 1.0).abs() < 0.05, "{}", patch.area);
            assert!((patch.depth - (2.0 - apart)).abs() < 0.03, "{}", patch.depth);
            assert_eq!(patch.curves.closed(), 1);
            assert!(patch.inside.iter().all(|inside| inside.len() > 8), "{:?}", patch.inside);
        }
        let solid = Shape::solid(mesh);
        let contacts = query::contacts(solid.at(Pose::IDENTITY).unwrap(), solid.at(at([0.125, 0.0, 1.5])).unwrap());
        assert_eq!(contacts.len(), count);
        for manifold in &contacts {
            assert_eq!(manifold.points.len(), 4);
            let deepest = manifold.points.iter().map(|point| point.upper).fold(0.0, f64::max);
            assert!((deepest - (2.0 - apart)).abs() < 0.03, "{manifold:?}");
        }
    }
}
