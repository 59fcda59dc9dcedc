//! Builds the BSP tree. Axis-aligned planes cut space as long as that lowers the expected cost of a
//! ray. Cells with few faces are then cut by the planes of their faces.

use super::across::Region;
use super::plane::CutPlane;
use super::tree::{Cell, Child, Cut, SolidBsp};
use crate::exact::{WidePlane, collinear};
use crate::math::Sign;
use crate::mesh::Mesh;

/// Maximum number of faces of a cell that is cut only by the planes of its faces, never by
/// axis-aligned planes.
const MAX_FACES_WITHOUT_AXIS_PLANE: usize = 3;

/// Maximum number of faces of a cell that is cut by the planes of its faces if no axis-aligned
/// plane is worth its cost, as around a corner. A larger number finishes more cells and costs more
/// cuts.
const MAX_FACES_FOR_FACE_PLANE: usize = 64;

/// Maximum number of faces whose planes are compared for one cut.
const MAX_PLANES_TRIED: usize = 6;

/// Maximum number of copies of faces in the tree, for each face of the mesh. A plane that cuts a
/// face makes a copy. A larger number finishes more cells and takes more time and memory.
const COPIES_PER_FACE: usize = 8;

/// Maximum number of axis-aligned planes on the way to a cell.
const MAX_AXIS_DEPTH: usize = 64;

impl SolidBsp {
    /// Builds the tree of a mesh in its current state. Later changes of the mesh do not change the
    /// tree.
    ///
    /// # Complexity
    /// O(n log n) for any mesh, because planes cut faces at most eight times as often as there are
    /// faces. Beyond that, cells keep their faces, and each point in them costs an exact winding
    /// number.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        Building::of(mesh)
    }
}

/// A tree that is being built.
pub(super) struct Building<'m> {
    mesh: &'m Mesh,
    tree: SolidBsp,
    /// Minimum and maximum corner of each face's box.
    extents: Vec<[[f64; 3]; 2]>,
}

/// A plane, the faces on its sides, and the regions of both sides.
type Chosen = (CutPlane, Parted, [Region; 2]);

/// Faces by their side of a plane. Faces that the plane cuts are on both sides.
#[derive(Default)]
struct Parted {
    below: Vec<u32>,
    within: Vec<u32>,
    above: Vec<u32>,
}

impl Parted {
    /// Returns the number of faces that are on both sides, given the number of all faces.
    fn copies(&self, faces: usize) -> usize {
        (self.below.len() + self.within.len() + self.above.len()).saturating_sub(faces)
    }
}

/// A list of faces from which a cut or a cell is made.
struct Task {
    faces: Vec<u32>,
    region: Region,
    depth: usize,
    /// The parent cut, and whether the list belongs above it. `None` for the root.
    parent: Option<(u32, bool)>,
    /// Whether an ancestor in the tree is the plane of a face. Rays stop at the first such
    /// ancestor.
    is_inner: bool,
    /// Maximum number of copies of faces that cuts of this list, and all cuts below, may still
    /// make.
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
        let mut pending =
            vec![Task { faces, region, depth: 0, parent: None, is_inner: false, spare: COPIES_PER_FACE * all }];
        while let Some(task) = pending.pop() {
            building.process(task, &mut pending);
        }
        building.tree
    }

    fn process(&mut self, Task { faces, region, depth, parent, is_inner, spare }: Task, pending: &mut Vec<Task>) {
        let mut chosen = if faces.len() <= MAX_FACES_WITHOUT_AXIS_PLANE || depth >= MAX_AXIS_DEPTH || is_inner {
            None
        } else {
            self.across(&faces, &region)
        };
        chosen = chosen.filter(|cut| cut.1.copies(faces.len()) <= spare);
        if chosen.is_none() && faces.len() <= MAX_FACES_FOR_FACE_PLANE {
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
                // Each side gets a share in proportion to its faces, so that the first cuts do not
                // use up what other cuts need.
                let below_spare = spare * below.len() / (below.len() + above.len()).max(1);
                let cut = self.tree.cuts.len() as u32;
                let is_of_face = matches!(plane, CutPlane::OfFace(_));
                let compared = if is_inner {
                    &[]
                } else if is_of_face {
                    &faces[..]
                } else {
                    &within
                };
                let compared = listed(&mut self.tree.faces, compared);
                // Both children are set when their tasks are processed.
                self.tree.cuts.push(Cut { plane, faces: compared, below: Child::Cell(0), above: Child::Cell(0) });
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

    /// Returns the axis-aligned plane with the least cost by the surface area heuristic, or `None`
    /// if no plane lowers the cost. A face that it cuts is left out of a side if the plane of the
    /// face does not reach into that side's region.
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

    /// Reports whether the plane of a face certainly does not reach into a region.
    fn is_beside(&self, face: u32, region: &Region) -> bool {
        let plane = &self.tree.planes[face as usize];
        let corners = region.corners();
        let first = plane.side(&corners[0]);
        first.is_some() && corners[1..].iter().all(|corner| plane.side(corner) == first)
    }

    /// Returns the plane of one of a few faces: the plane that cuts the fewest other faces and best
    /// balances both sides. Returns `None` if no face has a plane.
    fn by_face(&self, faces: &[u32], region: &Region) -> Option<Chosen> {
        let has_plane = |face: &&u32| {
            let [a, b, c] = self.mesh.corners(**face);
            !collinear(&a, &b, &c)
        };
        let tried = faces.iter().filter(has_plane).take(MAX_PLANES_TRIED).map(|&face| {
            let plane = CutPlane::OfFace(face);
            (plane, self.parted(faces, &plane))
        });
        let worst = |parted: &Parted| 4 * parted.copies(faces.len()) + parted.below.len().abs_diff(parted.above.len());
        let (plane, parted) = tried.min_by_key(|(_, parted)| worst(parted))?;
        Some((plane, parted, [*region; 2]))
    }

    /// Returns the faces by their side of a plane, exactly.
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

/// Returns the tree of a mesh without cuts and cells.
fn empty(mesh: &Mesh, extents: &[[[f64; 3]; 2]]) -> SolidBsp {
    let planes = (0..extents.len() as u32).map(|face| WidePlane::new(&mesh.corners(face))).collect();
    let end = |of: fn(f64, f64) -> f64, end: usize, none: f64| {
        [0, 1, 2].map(|axis| extents.iter().map(|extent| extent[end][axis]).fold(none, of))
    };
    let (low, high) = (end(f64::min, 0, f64::INFINITY), end(f64::max, 1, f64::NEG_INFINITY));
    let (mesh, is_closed) = (mesh.clone(), mesh.is_closed());
    SolidBsp { mesh, low, high, planes, cuts: Vec::new(), cells: Vec::new(), faces: Vec::new(), depth: 0, is_closed }
}

/// Appends faces to the list of all faces, and returns their range.
fn listed(all: &mut Vec<u32>, faces: &[u32]) -> std::ops::Range<u32> {
    let start = all.len() as u32;
    all.extend_from_slice(faces);
    start..all.len() as u32
}
