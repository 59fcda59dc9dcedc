//! Two meshes at two poses: whether they intersect, in which faces, and along which curves.
//!
//! The answers are exact, and touching counts as intersecting.

use std::error::Error;

use impinge::query::{self, Penetrates};
use impinge::{Mesh, Pose};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let human = Mesh::new(model.positions, model.faces)?;
    let beside = human.at(Pose::from_translation([0.5, 0.0, 0.125])?);

    if query::intersects(&human, beside) {
        println!("the surfaces intersect");
    }
    if query::penetrates(&human, beside) != Penetrates::No {
        println!("the interiors intersect");
    }

    let pairs = query::intersecting_pairs(&human, beside);
    println!("{} pairs of faces, the first {} with {}", pairs.len(), pairs[0][0], pairs[0][1]);

    for curve in query::intersection_curves(&human, beside).polylines {
        let length: f64 = curve.windows(2).map(|ends| distance(ends[0], ends[1])).sum();
        let [x, y, z] = [0, 1, 2].map(|k| curve.iter().map(|point| point[k]).sum::<f64>() / curve.len() as f64);
        println!("a curve of {} points, {length:.6} long, about ({x:.6}, {y:.6}, {z:.6})", curve.len());
    }
    Ok(())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
