//! Cutting space by planes: across an axis while many faces are left, by faces' own planes where few are.

use super::{Cell, Child, Cut, CutPlane, SolidBsp};
use crate::exact::{Corners, Plane, collinear, orient3d};
use crate::math::Sign;
use crate::mesh::Mesh;

/// Faces of a cell below which it is cut by their own planes.
const FEW: usize = 8;

/// Faces up to which a cell is cut by their own planes where no plane across an axis parts them: those round a corner.
const MANY: usize = 64;

/// Faces whose planes are tried.
const TRIED: usize = 6;

/// How often planes may pass through faces, for each face.
const COPIES: usize = 8;

/// A tree in the making.
pub(super) struct Building<'m> {
    mesh: &'m Mesh,
    tree: SolidBsp,
    /// How many more faces may be put onto two lists in place of one.
    copies: usize,
}

/// Faces by where they are to a plane; those that it passes through are on both sides.
struct Parted {
    below: Vec<u32>,
    within: Vec<u32>,
    above: Vec<u32>,
}

impl Parted {
    /// How many of so many faces are on both sides.
    fn copies(&self, faces: usize) -> usize {
        self.below.len() + self.within.len() + self.above.len() - faces
    }
}

/// What becomes of a list of faces.
struct Task {
    faces: Vec<u32>,
    depth: usize,
    /// The cut that it hangs on, and whether above it.
    parent: Option<(u32, bool)>,
}

impl<'m> Building<'m> {
    pub(super) fn of(mesh: &'m Mesh) -> SolidBsp {
        let all = mesh.faces().len();
        let tree = SolidBsp { mesh: mesh.clone(), cuts: Vec::new(), cells: Vec::new(), faces: Vec::new(), depth: 0 };
        let mut building = Self { mesh, tree, copies: COPIES * all };
        let mut pending = vec![Task { faces: (0..all as u32).collect(), depth: 0, parent: None }];
        while let Some(task) = pending.pop() {
            building.take(task, &mut pending);
        }
        building.tree
    }

    fn take(&mut self, Task { faces, depth, parent }: Task, pending: &mut Vec<Task>) {
        let chosen = self.plane_for(&faces).filter(|(_, parted)| parted.copies(faces.len()) <= self.copies);
        let child = match chosen {
            None => {
                self.tree.cells.push(Cell { faces: listed(&mut self.tree.faces, &faces), label: Default::default() });
                self.tree.depth = self.tree.depth.max(depth);
                Child::Cell(self.tree.cells.len() as u32 - 1)
            }
            Some((plane, parted)) => {
                self.copies -= parted.copies(faces.len());
                let Parted { below, within, above } = parted;
                let cut = self.tree.cuts.len() as u32;
                let within = listed(&mut self.tree.faces, &within);
                // Both children are told when they are taken.
                self.tree.cuts.push(Cut { plane, within, below: Child::Cell(0), above: Child::Cell(0) });
                pending.push(Task { faces: above, depth: depth + 1, parent: Some((cut, true)) });
                pending.push(Task { faces: below, depth: depth + 1, parent: Some((cut, false)) });
                Child::Cut(cut)
            }
        };
        if let Some((parent, is_above)) = parent {
            let cut = &mut self.tree.cuts[parent as usize];
            *(if is_above { &mut cut.above } else { &mut cut.below }) = child;
        }
    }

    /// The plane to cut a cell by, and how it parts the faces; none where there are none, or none that has a plane.
    fn plane_for(&self, faces: &[u32]) -> Option<(CutPlane, Parted)> {
        if faces.is_empty() {
            return None;
        }
        let across = if faces.len() > FEW { self.plane_across(faces) } else { None };
        across.or_else(|| if faces.len() <= MANY { self.plane_of_face(faces) } else { None })
    }

    /// A plane across an axis through the median of the faces' middles, such that either side is left with three quarters at most.
    fn plane_across(&self, faces: &[u32]) -> Option<(CutPlane, Parted)> {
        let spread = |axis: usize| {
            let middles = || faces.iter().map(move |&face| self.middle(face, axis));
            middles().fold(f64::NEG_INFINITY, f64::max) - middles().fold(f64::INFINITY, f64::min)
        };
        let spreads = [0, 1, 2].map(spread);
        let mut axes = [0, 1, 2];
        axes.sort_by(|&i, &j| spreads[j].total_cmp(&spreads[i]));
        axes.into_iter().find_map(|axis| {
            let mut middles: Vec<f64> = faces.iter().map(|&face| self.middle(face, axis)).collect();
            let half = middles.len() / 2;
            let at = *middles.select_nth_unstable_by(half, f64::total_cmp).1;
            let plane = CutPlane::Across { axis, at };
            let parted = self.parted(faces, &plane);
            let most = faces.len() - faces.len() / 4;
            (parted.below.len() <= most && parted.above.len() <= most).then_some((plane, parted))
        })
    }

    /// The plane of a face, of a few the one that passes through the fewest others and leaves both sides most alike.
    fn plane_of_face(&self, faces: &[u32]) -> Option<(CutPlane, Parted)> {
        let has_plane = |face: &&u32| {
            let [a, b, c] = self.mesh.corners(**face);
            !collinear(&a, &b, &c)
        };
        let tried = faces.iter().filter(has_plane).take(TRIED).map(|&face| {
            let plane = CutPlane::OfFace(face);
            (plane, self.parted(faces, &plane))
        });
        tried.min_by_key(|(_, parted)| 4 * parted.copies(faces.len()) + parted.below.len().abs_diff(parted.above.len()))
    }

    fn parted(&self, faces: &[u32], plane: &CutPlane) -> Parted {
        let mut parted = Parted { below: Vec::new(), within: Vec::new(), above: Vec::new() };
        for &face in faces {
            let sides = self.mesh.corners(face).map(|corner| plane.side(self.mesh, &corner));
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

    /// Amid the corners of a face, along an axis.
    fn middle(&self, face: u32, axis: usize) -> f64 {
        let [a, b, c] = self.mesh.corners(face).map(|corner| corner[axis]);
        0.5 * a.min(b).min(c) + 0.5 * a.max(b).max(c)
    }
}

fn listed(all: &mut Vec<u32>, faces: &[u32]) -> std::ops::Range<u32> {
    let start = all.len() as u32;
    all.extend_from_slice(faces);
    start..all.len() as u32
}

/// On which side of the plane of a face a point is, exactly.
pub(super) fn side([p, q, r]: &Corners, point: &[f64; 3]) -> Sign {
    // Rounded up, so that the point is within it.
    let extent = [0, 1, 2].map(|k| (point[k] - p[k]).abs().next_up());
    Plane::new(p, q, r, &extent).side(point).unwrap_or_else(|| orient3d(p, q, r, point))
}
