//! Reads the values of a binary PLY file: one by one, and in bulk for the layouts that nearly all
//! files have.

use impinge::Positions;

use crate::error::{LoadError, Place};

use super::{
    Values,
    header::{Element, Scalar},
};

pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a, const BIG_ENDIAN: bool> Binary<'a, BIG_ENDIAN> {
    /// Builds a reader of the values from byte `at` on.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    fn take(&mut self, len: u64) -> Result<&'a [u8], LoadError> {
        if len > self.remaining() {
            return Err(LoadError::truncated("bytes", len, self.remaining()).at(self.place(self.at)));
        }
        let start = self.at;
        self.at += len as usize;
        Ok(&self.bytes[start..self.at])
    }

    /// Returns the coordinates of rows of fixed size, with three coordinates of one type at fixed
    /// offsets.
    fn coordinates<const N: usize, T>(
        &self,
        rows: &[u8],
        row: usize,
        at: [usize; 3],
        value: fn([u8; N]) -> T,
    ) -> Vec<[T; 3]> {
        let coordinate = |row: &[u8], at: usize| {
            let mut bytes = [0; N];
            bytes.copy_from_slice(&row[at..at + N]);
            value(bytes)
        };
        rows.chunks_exact(row).map(|row| at.map(|at| coordinate(row, at))).collect()
    }
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, LoadError> {
        let bytes = self.take(scalar.size() as u64)?;
        // Little-endian, padded with zeros.
        let mut le = [0; 8];
        le[..bytes.len()].copy_from_slice(bytes);
        if BIG_ENDIAN {
            le[..bytes.len()].reverse();
        }
        let [b0, b1, b2, b3, ..] = le;
        Ok(match scalar {
            Scalar::Char => f64::from(b0.cast_signed()),
            Scalar::UChar => f64::from(b0),
            Scalar::Short => f64::from(i16::from_le_bytes([b0, b1])),
            Scalar::UShort => f64::from(u16::from_le_bytes([b0, b1])),
            Scalar::Int => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
            Scalar::UInt => f64::from(u32::from_le_bytes([b0, b1, b2, b3])),
            Scalar::Long => i64::from_le_bytes(le) as f64,
            Scalar::ULong => u64::from_le_bytes(le) as f64,
            Scalar::Float => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
            Scalar::Double => f64::from_le_bytes(le),
        })
    }

    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<(), LoadError> {
        self.take(count.saturating_mul(scalar.size() as u64)).map(|_| ())
    }

    fn min_size(&self, scalar: Scalar) -> u64 {
        scalar.size() as u64
    }

    fn offset(&self) -> usize {
        self.at
    }

    fn seek(&mut self, offset: usize) {
        self.at = offset;
    }

    fn place(&self, offset: usize) -> Place {
        Place::Byte(offset as u64)
    }

    fn remaining(&self) -> u64 {
        (self.bytes.len() - self.at) as u64
    }

    fn vertices_at_once(&mut self, element: &Element, xyz: [usize; 3]) -> Option<Positions> {
        let scalar = element.properties[xyz[0]].scalar;
        if xyz.iter().any(|&i| element.properties[i].scalar != scalar) {
            return None;
        }
        let mut offsets = Vec::new();
        let mut row = 0;
        for property in &element.properties {
            if property.list.is_some() {
                return None;
            }
            offsets.push(row);
            row += property.scalar.size();
        }
        let at = xyz.map(|i| offsets[i]);
        if !matches!(scalar, Scalar::Float | Scalar::Double) {
            return None;
        }
        let rows = self.take(element.count.checked_mul(row as u64)?).ok()?;
        let f32_value = if BIG_ENDIAN { f32::from_be_bytes } else { f32::from_le_bytes };
        let f64_value = if BIG_ENDIAN { f64::from_be_bytes } else { f64::from_le_bytes };
        Some(match scalar {
            Scalar::Float => Positions::F32(self.coordinates(rows, row, at, f32_value)),
            _ => Positions::F64(self.coordinates(rows, row, at, f64_value)),
        })
    }

    fn faces_at_once(
        &mut self,
        element: &Element,
        list: usize,
        mut face: impl FnMut(&[u32], usize) -> Result<(), LoadError>,
    ) -> Option<Result<(), LoadError>> {
        let property = &element.properties[list];
        if property.list != Some(Scalar::UChar) || !matches!(property.scalar, Scalar::Int | Scalar::UInt) {
            return None;
        }
        let (before, after) = (&element.properties[..list], &element.properties[list + 1..]);
        let size = |properties: &[super::Property]| {
            let fixed = |p: &super::Property| p.list.is_none().then(|| p.scalar.size() as u64);
            properties.iter().map(fixed).sum::<Option<u64>>()
        };
        let (before, after) = (size(before)?, size(after)?);
        Some((0..element.count).try_for_each(|_| {
            let at = self.at;
            let head = self.take(before + 1)?;
            let count = head[head.len() - 1];
            let items = self.take(4 * u64::from(count))?.as_chunks::<4>().0;
            self.take(after)?;
            let index = if BIG_ENDIAN { u32::from_be_bytes } else { u32::from_le_bytes };
            if let &[a, b, c] = items {
                return face(&[index(a), index(b), index(c)], at);
            }
            let mut corners = [0; u8::MAX as usize];
            for (corner, &item) in corners.iter_mut().zip(items) {
                *corner = index(item);
            }
            face(&corners[..items.len()], at)
        }))
    }
}
