//! Closest points: of a mesh to given points, and of two meshes to each other.
//!
//! Each distance is an interval that provably contains the true distance.

use std::error::Error;

use impinge::mesh::Containment;
use impinge::{Mesh, Pose, query};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let human = Mesh::new(model.positions, model.faces)?;
    let points = [[0.0, 0.25, 0.0625], [0.0, 1.0, 0.0], [0.5, 0.5, 0.5], [2.0, 0.0, 0.0]];

    let found = human.closest_points(&points)?;
    let inside = human.contains(&points)?;
    for (found, inside) in found.into_iter().zip(inside) {
        let found = found.ok_or("the mesh has no faces")?;
        let side = if inside == Containment::Outside { "outside" } else { "inside" };
        let [x, y, z] = found.point;
        println!("{side}, {:.6} from face {} at ({x:.6}, {y:.6}, {z:.6})", found.upper, found.face);
    }

    let beside = human.at(Pose::from_translation([1.5, 0.0, 0.125])?);
    let nearest = query::distance(&human, beside);
    let witness = nearest.witness.ok_or("a mesh has no faces")?;
    let [face_a, face_b] = witness.faces.ok_or("both are meshes")?;
    println!("two humans are {:.6} apart, at faces {face_a} and {face_b}", nearest.distance());
    for [x, y, z] in [witness.point_a, witness.point_b] {
        println!("({x:.6}, {y:.6}, {z:.6})");
    }
    println!("the bounds are {}", if nearest.upper - nearest.lower < 1e-12 { "tight" } else { "loose" });
    Ok(())
}
