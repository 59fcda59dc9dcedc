//! Small meshes full of ties under integer maps: the pairs must be those of the exact oracle.

#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use impinge::{Mesh, Pose, Positions, query};
use impinge_testkit::oracle::brute_force;
use impinge_testkit::{Affine, Mesh as Plain};
use libfuzzer_sys::fuzz_target;

#[derive(Debug)]
struct Scene {
    meshes: [Plain; 2],
    poses: [Affine; 2],
}

impl<'a> Arbitrary<'a> for Scene {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        Ok(Self { meshes: [mesh(bytes)?, mesh(bytes)?], poses: [pose(bytes)?, pose(bytes)?] })
    }
}

/// Returns a mesh of up to eight vertices on a grid, or one float beside it, and up to twelve
/// faces.
fn mesh(bytes: &mut Unstructured<'_>) -> arbitrary::Result<Plain> {
    let mut vertices = Vec::new();
    for _ in 0..bytes.int_in_range(1..=8)? {
        let mut vertex = [0.0; 3];
        for x in &mut vertex {
            let on_grid = 0.5 * f64::from(bytes.int_in_range(-4..=4_i8)?);
            *x = match bytes.int_in_range(0..=15_u8)? {
                0 => on_grid.next_up(),
                1 => on_grid.next_down(),
                _ => on_grid,
            };
        }
        vertices.push(vertex);
    }
    let last = vertices.len() as u32 - 1;
    let mut faces = Vec::new();
    for _ in 0..bytes.int_in_range(0..=12)? {
        faces.push([bytes.int_in_range(0..=last)?, bytes.int_in_range(0..=last)?, bytes.int_in_range(0..=last)?]);
    }
    Ok(Plain { vertices, faces })
}

fn pose(bytes: &mut Unstructured<'_>) -> arbitrary::Result<Affine> {
    let mut linear = [[0.0; 3]; 3];
    for x in linear.as_flattened_mut() {
        *x = f64::from(bytes.int_in_range(-2..=2_i8)?);
    }
    let mut translation = [0.0; 3];
    for x in &mut translation {
        *x = 0.25 * f64::from(bytes.int_in_range(-8..=8_i8)?);
    }
    Ok(Affine { linear, translation })
}

fuzz_target!(|scene: Scene| {
    let Scene { meshes: [a, b], poses } = scene;
    let Ok(place_a) = Pose::new(poses[0].linear, poses[0].translation) else { return };
    let Ok(place_b) = Pose::new(poses[1].linear, poses[1].translation) else { return };
    let engine_mesh =
        |mesh: &Plain| Mesh::new(Positions::F64(mesh.vertices.clone()), mesh.faces.clone()).expect("legal");
    let (mesh_a, mesh_b) = (engine_mesh(&a), engine_mesh(&b));
    let (at_a, at_b) = (mesh_a.at(place_a), mesh_b.at(place_b));
    let expected = brute_force(a.at(poses[0]), b.at(poses[1]));
    let found: Vec<(u32, u32)> = query::intersecting_pairs(at_a, at_b).iter().map(|&[a, b]| (a, b)).collect();
    assert_eq!(found, expected);
    assert_eq!(query::intersects(at_a, at_b), !expected.is_empty());
    let distance = query::distance(at_a, at_b);
    assert_eq!(distance.upper == 0.0, !expected.is_empty());
    assert!(distance.lower <= distance.upper);
    assert!(distance.witness.is_none() || query::within(at_a, at_b, distance.upper));
    assert!(distance.lower == 0.0 || !query::within(at_a, at_b, distance.lower.next_down()));
});
