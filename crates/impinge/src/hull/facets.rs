//! Converts a surface of triangles, some in one plane, to the facets of the hull: polygons whose
//! corners are all extreme.
//!
//! A corner of the surface is an extreme point if and only if facets of three or more planes share
//! it. With two planes it is inside an edge of the hull, with one plane inside a facet. So no angle
//! is measured; planes are counted.

use super::build::Surface;

/// Convex facets as lists of points by number, in counterclockwise order seen from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Facets {
    corners: Vec<u32>,
    ends: Vec<u32>,
}

impl Facets {
    /// Returns the facets of a surface over `points` points.
    pub(super) fn of(surface: &Surface<'_>, points: usize) -> Self {
        let planes = planes(surface);
        let is_extreme = extreme(surface, &planes, points);
        let mut facets = Self::default();
        let mut outline = Outline { after: vec![u32::MAX; points], starts: Vec::new() };
        for faces in planes.groups() {
            outline.starts.clear();
            for &face in faces {
                let data = surface.face(face);
                for edge in 0..3 {
                    if planes.plane_of[data.across[edge] as usize] != planes.plane_of[face as usize] {
                        outline.add(data.corners[edge], data.corners[(edge + 1) % 3]);
                    }
                }
            }
            facets.push(outline.walk().filter(|&corner| is_extreme[corner as usize]));
        }
        facets
    }

    /// Returns both sides of one polygon.
    pub(super) fn of_both_sides(polygon: &[u32]) -> Self {
        let mut facets = Self::default();
        facets.push(polygon.iter().copied());
        facets.push(polygon.iter().rev().copied());
        facets
    }

    /// Iterates over the facets, each as a list of corners.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let polygon = &self.corners[start as usize..end as usize];
            start = end;
            polygon
        })
    }

    fn push(&mut self, polygon: impl Iterator<Item = u32>) {
        self.corners.extend(polygon);
        self.ends.push(self.corners.len() as u32);
    }
}

/// The plane of each face, given by the number of one of its faces.
struct Planes {
    plane_of: Vec<u32>,
    /// All faces. The faces of one plane follow each other.
    faces: Vec<u32>,
    ends: Vec<u32>,
}

impl Planes {
    fn groups(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.faces[start as usize..end as usize])
    }
}

/// Groups the faces by plane. A facet is convex, so its faces are connected: they are found by
/// walking over flat edges.
fn planes(surface: &Surface<'_>) -> Planes {
    const NONE: u32 = u32::MAX;
    let mut planes = Planes { plane_of: Vec::new(), faces: Vec::new(), ends: Vec::new() };
    let alive: Vec<bool> = surface.faces().map(|face| face.is_some()).collect();
    planes.plane_of.resize(alive.len(), NONE);
    for first in (0..alive.len() as u32).filter(|&face| alive[face as usize]) {
        if planes.plane_of[first as usize] != NONE {
            continue;
        }
        let mut next = planes.faces.len();
        planes.plane_of[first as usize] = first;
        planes.faces.push(first);
        while let Some(&face) = planes.faces.get(next) {
            next += 1;
            for edge in 0..3 {
                let beyond = surface.face(face).across[edge];
                if planes.plane_of[beyond as usize] == NONE && surface.is_flat(face, edge) {
                    planes.plane_of[beyond as usize] = first;
                    planes.faces.push(beyond);
                }
            }
        }
        planes.ends.push(next as u32);
    }
    planes
}

/// Reports for each point whether faces of three or more planes share it.
fn extreme(surface: &Surface<'_>, planes: &Planes, points: usize) -> Vec<bool> {
    // The first two planes found at each corner. A third plane makes the corner extreme.
    let mut known_planes = vec![[u32::MAX; 2]; points];
    let mut is_extreme = vec![false; points];
    for &face in &planes.faces {
        let plane = planes.plane_of[face as usize];
        for corner in surface.face(face).corners {
            let known_planes = &mut known_planes[corner as usize];
            if known_planes.contains(&plane) {
                continue;
            }
            match known_planes.iter_mut().find(|plane| **plane == u32::MAX) {
                Some(free) => *free = plane,
                None => is_extreme[corner as usize] = true,
            }
        }
    }
    is_extreme
}

/// The outline of a facet, which is one cycle.
struct Outline {
    after: Vec<u32>,
    starts: Vec<u32>,
}

impl Outline {
    fn add(&mut self, from: u32, to: u32) {
        self.after[from as usize] = to;
        self.starts.push(from);
    }

    fn walk(&self) -> impl Iterator<Item = u32> {
        let mut at = self.starts.first().copied().unwrap_or_default();
        self.starts.iter().map(move |_| {
            let here = at;
            at = self.after[here as usize];
            here
        })
    }
}
