//! A mesh that deforms: its vertices move every frame, and its hierarchy is refitted instead of
//! rebuilt.
//!
//! A sheet sinks onto a human and its rim hangs down. `aging` tells how much slower the hierarchy
//! has become.

use std::error::Error;

use impinge::hierarchy::Builder;
use impinge::{Mesh, query};

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");
/// Number of vertices along each side.
const SIDE: u32 = 33;

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let human = Mesh::new(model.positions, model.faces)?;
    let corners = (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).map(move |column| row * SIDE + column));
    let squares = corners.map(|at| [[at, at + 1, at + SIDE], [at + 1, at + SIDE + 1, at + SIDE]]);
    let faces: Vec<[u32; 3]> = squares.flatten().collect();

    let mut sheet = Mesh::new(vertices(0), faces)?;
    for frame in 0..8 {
        sheet.refit(vertices(frame))?;
        let pairs = query::intersecting_pairs(&sheet, &human);
        if pairs.is_empty() {
            println!("frame {frame}: {:.6} apart", query::distance(&sheet, &human).distance());
        } else {
            println!("frame {frame}: {} pairs of faces intersect", pairs.len());
        }
    }

    if sheet.aging().is_worth_rebuilding() {
        sheet.rebuild(Builder::default());
        println!("the hierarchy was built anew");
    } else {
        println!("the hierarchy is as good as new");
    }
    Ok(())
}

/// Returns the vertices of the sheet in a frame.
fn vertices(frame: u32) -> Vec<[f64; 3]> {
    let frame = f64::from(frame);
    let vertex = |at: u32| {
        let [x, z] = [at % SIDE, at / SIDE].map(|place| f64::from(place) / 16.0 - 1.0);
        [x, 1.25 - frame / 16.0 - (x * x + z * z) * (frame / 8.0), z]
    };
    (0..SIDE * SIDE).map(vertex).collect()
}
