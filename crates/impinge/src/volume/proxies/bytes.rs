//! Proxies as bytes: little-endian numbers, the same on every machine.
//!
//! | bytes | content |
//! |---|---|
//! | 0 .. 16 | kind of the hull (1 point to 4 solid); its number of vertices, faces and neighbors |
//! | 16 .. 816 | 100 doubles: box, sphere, capsule, lozenge, oriented box, 14-, 18- and 26-DOP |
//! | from 816 | vertices; three corners per face; neighbor starts per vertex, and the end; neighbors |
//!
//! Tests: `tests/it/hull/proxies.rs`.

use std::sync::Arc;

use super::{Proxies, ProxyFlaw, Volumes};
use crate::hull::{Hull, HullKind, HullParts};
use crate::volume::{BoundingSphere, Capsule, Kdop, Lozenge, MinMax, Obb};

/// Kinds of hulls by their number in the bytes, starting at 1.
const KINDS: [HullKind; 4] = [HullKind::Point, HullKind::Segment, HullKind::Polygon, HullKind::Solid];

/// Number of doubles of all volumes.
const NUMBERS: usize = 6 + 4 + 7 + 10 + 15 + 14 + 18 + 26;

impl Proxies {
    /// Returns everything as bytes, which
    /// [`Mesh::proxies_from_bytes`](crate::Mesh::proxies_from_bytes) reads back. The numbers are
    /// little-endian and the same on every machine. The positions of the hull's vertices are not
    /// included, because the mesh has them.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let HullParts { kind, vertices, faces, first, neighbors } = self.hull.parts();
        let kind = KINDS.iter().position(|&one| one == kind).map_or(0, |at| at as u32 + 1);
        let counts = [kind, vertices.len() as u32, faces.len() as u32, neighbors.len() as u32];
        let mut bytes: Vec<u8> = counts.into_iter().flat_map(u32::to_le_bytes).collect();
        // Adding zero makes negative zeros positive.
        bytes.extend(self.volumes.numbers().into_iter().flat_map(|x| (x + 0.0).to_le_bytes()));
        for array in [vertices, faces.as_flattened(), first, neighbors] {
            bytes.extend(array.iter().flat_map(|x| x.to_le_bytes()));
        }
        bytes
    }

    /// Reads the bytes of [`to_bytes`](Self::to_bytes). `position` returns the position of each
    /// vertex of the hull. Only properties that could make a query panic are checked.
    ///
    /// # Errors
    /// Returns [`ProxyFlaw::Shape`] if the bytes cannot be proxies of any points.
    pub(crate) fn from_bytes(bytes: &[u8], position: impl Fn(u32) -> Option<[f64; 3]>) -> Result<Self, ProxyFlaw> {
        Self::read(bytes, position).ok_or(ProxyFlaw::Shape)
    }

    fn read(mut bytes: &[u8], position: impl Fn(u32) -> Option<[f64; 3]>) -> Option<Self> {
        let [kind, vertices, faces, neighbors] = *words(&mut bytes, 4)?.first_chunk()?;
        let kind = *KINDS.get((kind as usize).checked_sub(1)?)?;
        let numbers: Vec<f64> = take(&mut bytes, NUMBERS)?.iter().map(|&x| f64::from_le_bytes(x)).collect();
        let volumes = Volumes::of_numbers(&numbers)?;
        let [vertices, faces, neighbors] = [vertices, faces, neighbors].map(|count| count as usize);
        let vertices = words(&mut bytes, vertices)?;
        let faces = words(&mut bytes, faces.checked_mul(3)?)?;
        let first = words(&mut bytes, vertices.len() + 1)?;
        let neighbors = words(&mut bytes, neighbors)?;
        let faces = faces.as_chunks().0;
        let parts = HullParts { kind, vertices: &vertices, faces, first: &first, neighbors: &neighbors };
        let hull = Hull::from_parts(&parts, position)?;
        bytes.is_empty().then(|| Self { hull: Arc::new(hull), volumes })
    }
}

impl Volumes {
    fn numbers(&self) -> Vec<f64> {
        let Self { bounds, sphere, capsule, lozenge, obb, kdop14, kdop18, kdop26 } = self;
        let mut numbers = Vec::with_capacity(NUMBERS);
        numbers.extend([bounds.min(), bounds.max(), sphere.center()].as_flattened());
        numbers.push(sphere.radius());
        numbers.extend(capsule.ends().as_flattened());
        numbers.push(capsule.radius());
        numbers.extend(lozenge.corner().iter().chain(lozenge.edges().as_flattened()));
        numbers.push(lozenge.radius());
        numbers.extend(obb.center().iter().chain(obb.axes().as_flattened()).chain(&obb.half_extents()));
        numbers.extend(kdop14.low().iter().chain(&kdop14.high()));
        numbers.extend(kdop18.low().iter().chain(&kdop18.high()));
        numbers.extend(kdop26.low().iter().chain(&kdop26.high()));
        numbers
    }

    /// Builds the volumes from their numbers. Returns `None` if there are too few numbers or a
    /// volume is invalid.
    fn of_numbers(numbers: &[f64]) -> Option<Self> {
        let mut rest = numbers;
        Some(Self {
            bounds: MinMax::new(next(&mut rest)?, next(&mut rest)?).ok()?,
            sphere: BoundingSphere::new(next(&mut rest)?, one(&mut rest)?).ok()?,
            capsule: Capsule::new(next(&mut rest)?, next(&mut rest)?, one(&mut rest)?).ok()?,
            lozenge: Lozenge::new(next(&mut rest)?, rows(&mut rest)?, one(&mut rest)?).ok()?,
            obb: Obb::new(next(&mut rest)?, rows(&mut rest)?, next(&mut rest)?).ok()?,
            kdop14: Kdop::new(next(&mut rest)?, next(&mut rest)?).ok()?,
            kdop18: Kdop::new(next(&mut rest)?, next(&mut rest)?).ok()?,
            kdop26: Kdop::new(next(&mut rest)?, next(&mut rest)?).ok()?,
        })
    }
}

/// Removes `count` words from the start of the bytes. Returns `None` if there are fewer.
fn words(bytes: &mut &[u8], count: usize) -> Option<Vec<u32>> {
    Some(take(bytes, count)?.iter().map(|&word| u32::from_le_bytes(word)).collect())
}

fn take<'b, const N: usize>(bytes: &mut &'b [u8], count: usize) -> Option<&'b [[u8; N]]> {
    let (taken, rest) = bytes.split_at_checked(count.checked_mul(N)?)?;
    *bytes = rest;
    Some(taken.as_chunks().0)
}

fn next<const N: usize>(numbers: &mut &[f64]) -> Option<[f64; N]> {
    let (taken, rest) = numbers.split_first_chunk()?;
    *numbers = rest;
    Some(*taken)
}

fn one(numbers: &mut &[f64]) -> Option<f64> {
    next::<1>(numbers).map(|[number]| number)
}

fn rows<const N: usize>(numbers: &mut &[f64]) -> Option<[[f64; 3]; N]> {
    let mut rows = [[0.0; 3]; N];
    for row in &mut rows {
        *row = next(numbers)?;
    }
    Some(rows)
}
