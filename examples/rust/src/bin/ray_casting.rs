//! Rays at a mesh: a picture of depths from many rays in one call, and all faces that one ray hits.
//!
//! No ray passes between two faces that share an edge.

use std::error::Error;

use impinge::Mesh;
use impinge::mesh::Ray;

const HUMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/human_makehuman_cc0.ply");
const WIDTH: usize = 40;
const HEIGHT: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let model = impinge_files::load(HUMAN)?;
    let human = Mesh::new(model.positions, model.faces)?;
    let ray = |at: usize| {
        let [column, row] = [at % WIDTH, at / WIDTH].map(|place| place as f64);
        Ray::new([(column - 19.5) / 32.0, (15.5 - row) / 16.0, 2.0], [0.0, 0.0, -1.0])
    };
    let rays = (0..WIDTH * HEIGHT).map(ray).collect::<Result<Vec<_>, _>>()?;
    let hits = human.ray_casts(&rays);

    // Five characters, the darkest for the nearest, draw depths from 1.6 to 2.1.
    for row in hits.chunks(WIDTH) {
        let shade = |t: f64| char::from(b"#*+-."[((t - 1.6) * 10.0) as usize]);
        let line: String = row.iter().map(|hit| hit.map_or(' ', |hit| shade(hit.t))).collect();
        println!("{}", line.trim_end());
    }

    let depths: Vec<f64> = hits.iter().flatten().map(|hit| hit.t).collect();
    let nearest = depths.iter().copied().fold(f64::INFINITY, f64::min);
    println!("{} of {} rays hit the human, at {nearest:.6} at the nearest", depths.len(), hits.len());

    let through = human.ray_cast_all(&Ray::new([2.0, 0.25, 0.0625], [-1.0, 0.0, 0.0])?);
    println!("a ray from the side hits {} faces", through.len());
    for hit in through {
        println!("face {} at {:.6}", hit.face, hit.t);
    }
    Ok(())
}
