//! Writes the torus knot of 2,000,000 triangles of the headline benchmark as a PLY file in single
//! precision.
//!
//! Run with `cargo run --release -p impinge-testkit --example torus_knot -- OUT.ply`.

use std::error::Error;
use std::fs::{self, File};
use std::path::PathBuf;

use impinge::Positions;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};

fn main() -> Result<(), Box<dyn Error>> {
    let path = PathBuf::from(std::env::args_os().nth(1).ok_or("name the file to write")?);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let knot = torus_knot(2000, 500, TREFOIL);
    let single = knot.vertices.iter().map(|vertex| vertex.map(|x| x as f32)).collect();
    // The file is renamed when it is complete, so that an interrupted run leaves no partial knot.
    let unfinished = path.with_extension("unfinished");
    impinge_files::write_ply(File::create(&unfinished)?, &Positions::F32(single), &knot.faces)?;
    fs::rename(&unfinished, &path)?;
    Ok(())
}
