//! Recorded animations: the vertices of one mesh in consecutive frames, stored as NumPy's `.npz`.
//!
//! The recordings are not part of this repository. They are read from `animation` in the folder
//! that the environment variable `IMPINGE_DATA` names.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use zip::ZipArchive;

use crate::read_error::ReadError;

/// File names of the recordings.
pub const ANIMATIONS: [&str; 2] = ["anim_robot_cc0.npz", "anim_makehuman_morph.npz"];

/// Mesh that deforms.
#[derive(Clone, Debug)]
pub struct Animation {
    /// Vertices in each frame. Every frame has the same number.
    pub frames: Vec<Vec<[f32; 3]>>,
    /// Vertex indices of each triangle.
    pub faces: Vec<[u32; 3]>,
}

impl Animation {
    /// Reads a recording from the data folder.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or if its arrays are not `frames`, of shape (t,
    /// v, 3) and type `<f4`, and `faces`, of shape (m, 3) and type `<u4`.
    pub fn read(data: &Path, name: &str) -> Result<Self, ReadError> {
        let path = data.join("animation").join(name);
        let error = |message: &str| ReadError::new(&path, message);
        let file = File::open(&path).map_err(|e| ReadError::new(&path, e))?;
        let mut archive = ZipArchive::new(file).map_err(|e| ReadError::new(&path, e))?;
        let mut array = |name: &str, dtype: &str| {
            let mut bytes = Vec::new();
            let mut entry = archive.by_name(&format!("{name}.npy")).map_err(|e| ReadError::new(&path, e))?;
            entry.read_to_end(&mut bytes).map_err(|e| ReadError::new(&path, e))?;
            words(&bytes, dtype).ok_or_else(|| error(&format!("{name} is not an array of {dtype}")))
        };
        let (shape, coordinates) = array("frames", "<f4")?;
        let (_, faces) = array("faces", "<u4")?;
        let &[_, vertices, 3] = &shape[..] else { return Err(error("frames is not of shape (t, v, 3)")) };
        let coordinates: Vec<[f32; 3]> = rows(&coordinates).map(|row| row.map(f32::from_le_bytes)).collect();
        let faces = rows(&faces).map(|row| row.map(u32::from_le_bytes)).collect();
        Ok(Self { frames: coordinates.chunks(vertices.max(1)).map(<[_]>::to_vec).collect(), faces })
    }
}

/// Returns the shape and the 4-byte elements of an array in version 1 of NumPy's format, in
/// row-major order. Returns `None` if the format or the type differs.
fn words(bytes: &[u8], dtype: &str) -> Option<(Vec<usize>, Vec<[u8; 4]>)> {
    let length = u16::from_le_bytes(*bytes.get(8..)?.first_chunk()?) as usize;
    let header = std::str::from_utf8(bytes.get(10..10 + length)?).ok()?;
    let is_as_expected = bytes.starts_with(b"\x93NUMPY\x01\x00")
        && header.contains(&format!("'descr': '{dtype}'"))
        && header.contains("'fortran_order': False");
    let shape = header.split_once("'shape': (")?.1.split_once(')')?.0;
    let shape: Option<Vec<usize>> =
        shape.split(',').filter(|x| !x.trim().is_empty()).map(|x| x.trim().parse().ok()).collect();
    let (words, rest) = bytes[10 + length..].as_chunks();
    (is_as_expected && rest.is_empty()).then(|| Some((shape?, words.to_vec())))?
}

fn rows(words: &[[u8; 4]]) -> impl Iterator<Item = [[u8; 4]; 3]> {
    words.as_chunks().0.iter().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_read_as_numpy_writes_them() {
        let header = "{'descr': '<u4', 'fortran_order': False, 'shape': (1, 3), }\n";
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend([7_u32, 8, 9].iter().flat_map(|x| x.to_le_bytes()));
        let (shape, read) = words(&bytes, "<u4").expect("an array");
        assert_eq!((shape, rows(&read).next().map(|row| row.map(u32::from_le_bytes))), (vec![1, 3], Some([7, 8, 9])));
        assert!(words(&bytes, "<f4").is_none() && words(&bytes[..bytes.len() - 1], "<u4").is_none());
        assert!(words(b"", "<u4").is_none());
    }
}
