//! Proxies as bytes: little-endian numbers, the same on every machine.
//!
//! | bytes | what |
//! |---|---|
//! | 0 .. 16 | kind of the hull (1 a point to 4 a solid); how many vertices, faces and neighbours it has |
//! | 16 .. 816 | a hundred doubles: box, sphere, capsule, lozenge, oriented box, 14-, 18- and 26-DOP |
//! | from 816 | vertices; three corners a face; where the neighbours of each vertex begin, and the end; neighbours |

use std::sync::Arc;

use super::{Proxies, ProxyFlaw, Volumes};
use crate::hull::{Hull, HullKind, HullParts};
use crate::volume::{BoundingSphere, Capsule, Kdop, Lozenge, MinMax, Obb};

/// Kinds by their numbers among the bytes, from one on.
const KINDS: [HullKind; 4] = [HullKind::Point, HullKind::Segment, HullKind::Polygon, HullKind::Solid];

/// Doubles of all volumes.
const NUMBERS: usize = 6 + 4 + 7 + 10 + 15 + 14 + 18 + 26;

impl Proxies {
    /// All of it as bytes, which [`Mesh::proxies_from_bytes`](crate::Mesh::proxies_from_bytes) reads: little-endian numbers, the
    /// same on every machine. Where the hull's vertices are is not among them: the mesh has that.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let HullParts { kind, vertices, faces, first, neighbours } = self.hull.parts();
        let kind = KINDS.iter().position(|&one| one == kind).map_or(0, |at| at as u32 + 1);
        let counts = [kind, vertices.len() as u32, faces.len() as u32, neighbours.len() as u32];
        let mut bytes: Vec<u8> = counts.into_iter().flat_map(u32::to_le_bytes).collect();
        // Zeros have no sign.
        bytes.extend(self.volumes.numbers().into_iter().flat_map(|x| (x + 0.0).to_le_bytes()));
        for array in [vertices, faces.as_flattened(), first, neighbours] {
            bytes.extend(array.iter().flat_map(|x| x.to_le_bytes()));
        }
        bytes
    }

    /// What [`to_bytes`](Self::to_bytes) made bytes of, believed but for what would make a question panic; `position` is asked for
    /// each vertex of the hull.
    ///
    /// # Errors
    /// [`ProxyFlaw::Shape`] where the bytes are not of proxies of any points.
    pub(crate) fn from_bytes(bytes: &[u8], position: impl Fn(u32) -> Option<[f64; 3]>) -> Result<Self, ProxyFlaw> {
        Self::read(bytes, position).ok_or(ProxyFlaw::Shape)
    }

    fn read(mut bytes: &[u8], position: impl Fn(u32) -> Option<[f64; 3]>) -> Option<Self> {
        let [kind, vertices, faces, neighbours] = *words(&mut bytes, 4)?.first_chunk()?;
        let kind = *KINDS.get((kind as usize).checked_sub(1)?)?;
        let numbers: Vec<f64> = take(&mut bytes, NUMBERS)?.iter().map(|&x| f64::from_le_bytes(x)).collect();
        let volumes = Volumes::of_numbers(&numbers)?;
        let [vertices, faces, neighbours] = [vertices, faces, neighbours].map(|count| count as usize);
        let vertices = words(&mut bytes, vertices)?;
        let faces = words(&mut bytes, faces.checked_mul(3)?)?;
        let first = words(&mut bytes, vertices.len() + 1)?;
        let neighbours = words(&mut bytes, neighbours)?;
        let faces = faces.as_chunks().0;
        let parts = HullParts { kind, vertices: &vertices, faces, first: &first, neighbours: &neighbours };
        let hull = Hull::from_parts(&parts, position)?;
        bytes.is_empty().then(|| Self { hull: Arc::new(hull), volumes })
    }
}

impl Volumes {
    fn numbers(&self) -> Vec<f64> {
        let Self { bounds, sphere, capsule, lozenge, obb, kdop14, kdop18, kdop26 } = self;
        let mut numbers = Vec::with_capacity(NUMBERS);
        numbers.extend([bounds.min(), bounds.max(), sphere.centre()].as_flattened());
        numbers.push(sphere.radius());
        numbers.extend(capsule.ends().as_flattened());
        numbers.push(capsule.radius());
        numbers.extend(lozenge.corner().iter().chain(lozenge.edges().as_flattened()));
        numbers.push(lozenge.radius());
        numbers.extend(obb.centre().iter().chain(obb.axes().as_flattened()).chain(&obb.half_extents()));
        numbers.extend(kdop14.low().iter().chain(&kdop14.high()));
        numbers.extend(kdop18.low().iter().chain(&kdop18.high()));
        numbers.extend(kdop26.low().iter().chain(&kdop26.high()));
        numbers
    }

    /// Nothing where the numbers are too few, or not those of volumes.
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

/// Takes words off the front of bytes; nothing where there are not as many.
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
