//! Vertices of the real meshes, in single precision as in their files.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use flate2::read::MultiGzDecoder;
use impinge::Positions;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Reads the vertices of the human mesh of the repository, in the frame of its file.
///
/// # Errors
/// Returns an error if [`impinge_files::load`] does.
pub fn human() -> Result<Vec<[f32; 3]>> {
    points(&Path::new(ROOT).join("data/human_makehuman_cc0.ply"))
}

/// Reads the vertices of the ventilator, a CAD part of three million triangles, from the data
/// folder.
///
/// # Errors
/// Returns an error if the file cannot be unpacked or loaded.
pub fn ventilator(folder: &Path) -> Result<Vec<[f32; 3]>> {
    points(&unpacked(&folder.join("big/cad_ventilator.ply.gz"), "cad_ventilator.ply")?)
}

/// Reads the vertices of a file.
///
/// # Errors
/// Returns an error if [`impinge_files::load`] does, or if the vertices are in double precision.
pub fn points(path: &Path) -> Result<Vec<[f32; 3]>> {
    match impinge_files::load(path)?.positions {
        Positions::F32(points) => Ok(points),
        Positions::F64(_) => bail!("{} is in double precision", path.display()),
    }
}

/// Decompresses a .gz file to `name` in `target/bench`, unless it exists there, and returns the
/// path. The file is renamed at the end, so that an existing file is complete.
///
/// # Errors
/// Returns an error if a file cannot be read or written.
pub fn unpacked(packed: &Path, name: &str) -> Result<PathBuf> {
    let folder = Path::new(ROOT).join("target/bench");
    let path = folder.join(name);
    if !path.exists() {
        fs::create_dir_all(&folder)?;
        let partial = folder.join(format!("{name}.part"));
        let mut content = MultiGzDecoder::new(File::open(packed).with_context(|| packed.display().to_string())?);
        io::copy(&mut content, &mut File::create(&partial)?).with_context(|| packed.display().to_string())?;
        fs::rename(&partial, &path)?;
    }
    Ok(path)
}
