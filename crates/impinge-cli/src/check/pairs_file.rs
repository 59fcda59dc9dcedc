//! Writes pairs of intersecting faces: as CSV with their provenance, or as a NumPy array of face
//! indices.

use std::io::{self, Write};
use std::path::Path;

use super::Outcome;
use crate::failure::Failure;
use crate::output;

/// Format of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairsFormat {
    /// A header, then one row per pair: faces, polygons of the files, names of parts.
    Csv,
    /// An array of shape (k, 2) and type uint32: face of A, face of B.
    Npy,
}

impl PairsFormat {
    /// Returns the format that the extension of a path names.
    ///
    /// # Errors
    /// Returns an error if the extension is neither `.csv` nor `.npy`.
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        match output::extension(path).as_str() {
            "csv" => Ok(Self::Csv),
            "npy" => Ok(Self::Npy),
            _ => Err(output::unknown_extension(path, ".csv or .npy")),
        }
    }

    /// Writes the pairs in the order in which the query returned them.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub(super) fn write(self, path: &Path, outcome: &Outcome) -> Result<(), Failure> {
        output::write(path, |out| match self {
            Self::Csv => write_csv(out, outcome),
            Self::Npy => write_npy(out, &outcome.pairs),
        })
    }
}

fn write_csv(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let [a, b] = [&outcome.bodies[0].about, &outcome.bodies[1].about];
    let mut rows = csv::Writer::from_writer(out);
    rows.write_record(["face_a", "face_b", "source_a", "source_b", "part_a", "part_b"])?;
    for &[face_a, face_b] in &outcome.pairs {
        let (source_a, source_b) = (a.sources[face_a as usize], b.sources[face_b as usize]);
        let numbers = [face_a, face_b, source_a, source_b].map(|number| number.to_string());
        rows.write_record(numbers.iter().map(String::as_str).chain([a.part(face_a), b.part(face_b)]))?;
    }
    rows.flush()
}

/// Writes version 1.0 of the NPY format (numpy.lib.format): a magic number, the length of the
/// header, the header as a Python dictionary, and the data. The header is padded so that the data
/// starts at a multiple of 64 bytes.
fn write_npy(out: &mut dyn Write, pairs: &[[u32; 2]]) -> io::Result<()> {
    const BEFORE_HEADER: usize = 10;
    let shape = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 2), }}", pairs.len());
    let length = (BEFORE_HEADER + shape.len() + 1).next_multiple_of(64) - BEFORE_HEADER;
    let header = format!("{shape:width$}\n", width = length - 1);
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&u16::try_from(length).map_err(io::Error::other)?.to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    pairs.as_flattened().iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn npy_file_equals_the_file_that_numpy_writes() {
        let mut bytes = Vec::new();
        write_npy(&mut bytes, &[[1, 2], [3, u32::MAX]]).unwrap();
        // Output of `numpy.save` of the same array, NumPy 2.
        let mut expected =
            b"\x93NUMPY\x01\x00v\x00{'descr': '<u4', 'fortran_order': False, 'shape': (2, 2), }".to_vec();
        expected.resize(127, b' ');
        expected.push(b'\n');
        expected.extend([1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 255, 255, 255, 255]);
        assert_eq!(bytes, expected);
    }
}
