//! Cutting space by planes: across an axis while that makes rays cheaper, by faces' own planes where few are left.

use super::across::Region;
use super::plane::CutPlane;
use super::tree::{Cell, Child, Cut, SolidBsp};
use crate::exact::{WidePlane, collinear};
use crate::math::Sign;
use crate::mesh::Mesh;

/// Faces of a cell below which it is cut by their own planes.
const FEW: usize = 3;

/// Faces up to which a cell is cut by their own planes where no plane across an axis is worth it: those round a corner.
const MANY: usize = 64;

/// Faces whose planes are tried.
const TRIED: usize = 6;

/// How often planes may pass through faces, for each face.
const COPIES: usize = 8;

/// Planes across an axis on the way to a cell at most.
const DEEPEST: usize = 64;

impl SolidBsp {
    /// The tree of a mesh as it is now: what is done to the mesh later does not change it.
    ///
    /// # Complexity
    /// O(n log n), whatever the mesh is: planes pass through faces at most eight times as often as there are faces. What these do
    /// not suffice for stays in cells with faces, where each point is asked for by itself.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        Building::of(mesh)
    }
}

/// A tree in the making.
pub(super) struct Building<'m> {
    mesh: &'m Mesh,
    tree: SolidBsp,
    /// Where each face begins and ends along the axes.
    extents: Vec<[[f64; 3]; 2]>,
}

/// A plane, how it parts the faces of a cell, and the regions of both sides.
type Chosen = (CutPlane, Parted, [Region; 2]);

/// Faces by where they are to a plane; those that it passes through are on both sides.
#[derive(Default)]
struct Parted {
    below: Vec<u32>,
    within: Vec<u32>,
    above: Vec<u32>,
}

impl Parted {
    /// How many of so many faces are on both sides.
    fn copies(&self, faces: usize) -> usize {
        (self.below.len() + self.within.len() + self.above.len()).saturating_sub(faces)
    }
}

/// What becomes of a list of faces.
struct Task {
    faces: Vec<u32>,
    region: Region,
    depth: usize,
    /// The cut that it hangs on, and whether above it.
    parent: Option<(u32, bool)>,
    /// Whether it is below the plane of a face, where rays do not come.
    is_inner: bool,
    /// How many more of its faces may be put onto two lists in place of one.
    spare: usize,
}

impl<'m> Building<'m> {
    pub(super) fn of(mesh: &'m Mesh) -> SolidBsp {
        let all = mesh.faces().len();
        let extents = (0..all as u32).map(|face| {
            let corners = mesh.corners(face);
            let end = |of: fn(f64, f64) -> f64| [0, 1, 2].map(|k| of(of(corners[0][k], corners[1][k]), corners[2][k]));
            [end(f64::min), end(f64::max)]
        });
        let extents: Vec<_> = extents.collect();
        let tree = empty(mesh, &extents);
        let region = Region { low: tree.low, high: tree.high };
        let mut building = Self { mesh, tree, extents };
        let faces = (0..all as u32).collect();
        let mut pending = vec![Task { faces, region, depth: 0, parent: None, is_inner: false, spare: COPIES * all }];
        while let Some(task) = pending.pop() {
            building.take(task, &mut pending);
        }
        building.tree
    }

    fn take(&mut self, Task { faces, region, depth, parent, is_inner, spare }: Task, pending: &mut Vec<Task>) {
        let mut chosen =
            if faces.len() <= FEW || depth >= DEEPEST || is_inner { None } else { self.across(&faces, &region) };
        chosen = chosen.filter(|cut| cut.1.copies(faces.len()) <= spare);
        if chosen.is_none() && faces.len() <= MANY {
            chosen = self.by_face(&faces, &region).filter(|cut| cut.1.copies(faces.len()) <= spare);
        }
        let child = match chosen {
            None => {
                self.tree.cells.push(Cell { faces: listed(&mut self.tree.faces, &faces), label: Default::default() });
                self.tree.depth = self.tree.depth.max(depth);
                Child::Cell(self.tree.cells.len() as u32 - 1)
            }
            Some((plane, parted, regions)) => {
                let spare = spare - parted.copies(faces.len());
                let Parted { below, within, above } = parted;
                // To each side for its faces, so that what is cut first does not use up what others need.
                let below_spare = spare * below.len() / (below.len() + above.len()).max(1);
                let cut = self.tree.cuts.len() as u32;
                let is_of_face = matches!(plane, CutPlane::OfFace(_));
                let met = if is_inner {
                    &[]
                } else if is_of_face {
                    &faces[..]
                } else {
                    &within
                };
                let met = listed(&mut self.tree.faces, met);
                // Both children are told when they are taken.
                self.tree.cuts.push(Cut { plane, faces: met, below: Child::Cell(0), above: Child::Cell(0) });
                let (depth, is_inner, [low, high]) = (depth + 1, is_inner || is_of_face, regions);
                let parent = Some((cut, true));
                pending.push(Task { faces: above, region: high, depth, parent, is_inner, spare: spare - below_spare });
                let parent = Some((cut, false));
                pending.push(Task { faces: below, region: low, depth, parent, is_inner, spare: below_spare });
                Child::Cut(cut)
            }
        };
        if let Some((parent, is_above)) = parent {
            let cut = &mut self.tree.cuts[parent as usize];
            *(if is_above { &mut cut.above } else { &mut cut.below }) = child;
        }
    }

    /// A plane across an axis that makes rays cheaper. Of the faces that it passes through those are left out of a side whose planes
    /// pass that by.
    fn across(&self, faces: &[u32], region: &Region) -> Option<Chosen> {
        let extents: Vec<_> = faces.iter().map(|&face| self.extents[face as usize]).collect();
        let (axis, at) = region.best_plane(&extents)?;
        let regions = region.cut(axis, at);
        let mut parted = Parted::default();
        for (&face, [min, max]) in faces.iter().zip(&extents) {
            let (is_below, is_above) = (min[axis] < at, max[axis] > at);
            let passes = is_below && is_above;
            if is_below && !(passes && self.is_beside(face, &regions[0])) {
                parted.below.push(face);
            }
            if is_above && !(passes && self.is_beside(face, &regions[1])) {
                parted.above.push(face);
            }
            if !is_below && !is_above {
                parted.within.push(face);
            }
        }
        Some((CutPlane::Across { axis, at }, parted, regions))
    }

    /// Whether the plane of a face certainly does not come into a region.
    fn is_beside(&self, face: u32, region: &Region) -> bool {
        let plane = &self.tree.planes[face as usize];
        let corners = region.corners();
        let first = plane.side(&corners[0]);
        first.is_some() && corners[1..].iter().all(|corner| plane.side(corner) == first)
    }

    /// The plane of a face, of a few the one that passes through the fewest others and leaves both sides most alike.
    fn by_face(&self, faces: &[u32], region: &Region) -> Option<Chosen> {
        let has_plane = |face: &&u32| {
            let [a, b, c] = self.mesh.corners(**face);
            !collinear(&a, &b, &c)
        };
        let tried = faces.iter().filter(has_plane).take(TRIED).map(|&face| {
            let plane = CutPlane::OfFace(face);
            (plane, self.parted(faces, &plane))
        });
        let worst = |parted: &Parted| 4 * parted.copies(faces.len()) + parted.below.len().abs_diff(parted.above.len());
        let (plane, parted) = tried.min_by_key(|(_, parted)| worst(parted))?;
        Some((plane, parted, [*region; 2]))
    }

    fn parted(&self, faces: &[u32], plane: &CutPlane) -> Parted {
        let mut parted = Parted::default();
        for &face in faces {
            let sides = self.mesh.corners(face).map(|corner| plane.side(self.mesh, &self.tree.planes, &corner));
            let (is_below, is_above) = (sides.contains(&Sign::Negative), sides.contains(&Sign::Positive));
            if is_below {
                parted.below.push(face);
            }
            if is_above {
                parted.above.push(face);
            }
            if !is_below && !is_above {
                parted.within.push(face);
            }
        }
        parted
    }
}

/// The tree of a mesh without cuts and cells.
fn empty(mesh: &Mesh, extents: &[[[f64; 3]; 2]]) -> SolidBsp {
    let planes = (0..extents.len() as u32).map(|face| WidePlane::new(&mesh.corners(face))).collect();
    let end = |of: fn(f64, f64) -> f64, end: usize, none: f64| {
        [0, 1, 2].map(|axis| extents.iter().map(|extent| extent[end][axis]).fold(none, of))
    };
    let (low, high) = (end(f64::min, 0, f64::INFINITY), end(f64::max, 1, f64::NEG_INFINITY));
    let (mesh, is_closed) = (mesh.clone(), mesh.is_closed());
    SolidBsp { mesh, low, high, planes, cuts: Vec::new(), cells: Vec::new(), faces: Vec::new(), depth: 0, is_closed }
}

fn listed(all: &mut Vec<u32>, faces: &[u32]) -> std::ops::Range<u32> {
    let start = all.len() as u32;
    all.extend_from_slice(faces);
    start..all.len() as u32
}
