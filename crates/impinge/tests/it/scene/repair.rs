//! Repairs of open parts against the meshes that they were made from.

use std::sync::Arc;

use impinge::mesh::RepairOptions;
use impinge::query;
use impinge::scene::{PartId, Scene};
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::{cuboid, icosphere};

use super::mesh;

/// Returns a solid with some turned faces, with corners that are not quite the same in each face,
/// or without a face.
fn damaged(rng: &mut Rng, plain: &impinge_testkit::Mesh, damage: usize) -> Mesh {
    let mut plain = plain.clone();
    match damage {
        0 => plain.faces.iter_mut().filter(|_| rng.one_in(3)).for_each(|face| face.swap(0, 1)),
        1 => {
            let corners: Vec<[f64; 3]> =
                plain.faces.as_flattened().iter().map(|&vertex| plain.vertices[vertex as usize]).collect();
            plain.vertices = corners.iter().map(|corner| corner.map(|x| x + 1e-9 * rng.uniform(-1.0, 1.0))).collect();
            plain.faces = (0..plain.faces.len() as u32).map(|face| [0, 1, 2].map(|k| 3 * face + k)).collect();
        }
        _ => _ = plain.faces.pop(),
    }
    mesh(&plain)
}

#[test]
fn parts_without_holes_are_closed_and_keep_their_shape() {
    let mut rng = Rng::new(83);
    let (mut seen, mut compared) = ([0; 3], 0);
    for round in 0..60 {
        let plain = if round % 2 == 0 { cuboid([0.0; 3], [1.0, 2.0, 3.0]) } else { icosphere(2) };
        let damage = round / 2 % 3;
        let (whole, open) = (mesh(&plain), damaged(&mut rng, &plain, damage));
        if open.is_closed() {
            continue; // no face was turned
        }
        seen[damage] += 1;
        let (repaired, repair) = open.repaired(RepairOptions::closing(&open)).unwrap();
        assert_eq!(repaired.is_closed(), damage != 2);
        assert_eq!((repair.turned_faces.is_empty(), repair.welded_vertices.is_empty()), (damage != 0, damage != 1));
        assert!(repair.greatest_move <= 3e-6);
        // Points that are not at the surface are on the same side as before.
        for _ in 0..20 {
            let point = [0; 3].map(|_| rng.uniform(-1.5, 3.5));
            let ball = Shape::sphere(point, 1e-3).unwrap().at(Pose::IDENTITY).unwrap();
            if damage != 2 && query::distance(&whole, &ball).lower > 1e-3 {
                let [now, before] = [&repaired, &whole].map(|mesh| query::intersects(mesh.solid(), &ball));
                assert_eq!(now, before, "{point:?}");
                compared += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count >= 18) && compared > 600, "{seen:?} {compared}");
}

#[test]
fn a_scene_is_repaired_once_for_each_mesh() {
    let mut rng = Rng::new(84);
    let (turned, holed) = (damaged(&mut rng, &icosphere(1), 0), damaged(&mut rng, &icosphere(1), 2));
    let mut both = icosphere(1);
    both.faces.pop();
    let both = damaged(&mut rng, &both, 0);
    let shapes: [Shape; 7] = [
        turned.solid().into(),
        holed.solid().into(),
        (&turned).into(),
        mesh(&icosphere(1)).solid().into(),
        Shape::sphere([0.0; 3], 1.0).unwrap(),
        Shape::from(&Mesh::new(Positions::F64(Vec::new()), Vec::new()).unwrap()),
        both.solid().into(),
    ];
    let mut scene = Scene::new();
    let mut add = |(number, shape)| scene.add(format!("part {number}"), shape, Pose::IDENTITY).unwrap();
    let parts: Vec<PartId> = shapes.iter().enumerate().map(&mut add).collect();
    scene.ignore(parts[0], parts[1]);
    let repaired = scene.repair();
    let found: Vec<(PartId, bool)> = repaired.iter().map(|found| (found.part, found.is_closed)).collect();
    assert_eq!(found, [(parts[0], true), (parts[2], true), (parts[6], false)]);
    assert!(Arc::ptr_eq(&repaired[0].repair, &repaired[1].repair) && !repaired[2].repair.turned_faces.is_empty());
    let of = |part: usize| scene.shape(parts[part]).as_mesh().unwrap();
    assert!(of(0).1 && !of(2).1, "a solid stays a solid");
    assert!(std::ptr::eq(of(0).0.faces(), of(2).0.faces()), "one mesh is shared");
    assert!(!scene.admits(parts[0], parts[1]));
    assert!(scene.repair().is_empty());
}
