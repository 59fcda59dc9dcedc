//! Two meshes at many poses: one call answers for every row of an array of poses, on all
//! processors.
//!
//! Rows that follow each other along a motion take less time than shuffled rows. The answers are
//! the same.

use std::error::Error;

use impinge::query::batch::{Batch, Poses};
use impinge::{Mesh, Pose};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");
const ROWS: u32 = 256;

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let human = Mesh::new(model.positions, model.faces)?;
    // One of two humans passes by the other from left to right.
    let poses = (0..ROWS).map(|row| Pose::from_translation([f64::from(row) / 64.0 - 2.0, 0.0, 0.125]));
    let poses = poses.collect::<Result<Vec<_>, _>>()?;
    let batch = Batch::new(&human, &human, Poses::default(), poses)?;

    let hits = batch.intersects()?.values;
    let count = hits.iter().filter(|hit| **hit).count();
    let first = hits.iter().position(|hit| *hit).unwrap_or(0);
    println!("{count} of {ROWS} poses intersect, the first is {first}");

    let near = batch.within(0.25)?.values;
    println!("{} of {ROWS} poses come within 0.25", near.iter().filter(|near| **near).count());

    let distances = batch.distance()?.values;
    for row in (0..distances.len()).step_by(32) {
        println!("pose {row}: distance {:.6}", distances[row].distance());
    }

    let pairs = batch.intersecting_pairs()?.values;
    let counts: Vec<usize> = pairs.iter().map(Vec::len).collect();
    let most = counts.iter().max().unwrap_or(&0);
    println!("{} pairs of faces in all, at most {most} at one pose", counts.iter().sum::<usize>());
    Ok(())
}
