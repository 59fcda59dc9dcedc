//! A solid-leaf BSP tree over the faces of a mesh: space cut by planes until no face is left in a cell, so that one answer tells
//! for all points of it.
//!
//! Source: Thibault, Naylor, *Set operations on polyhedra using binary space partitioning trees*, SIGGRAPH 1987 (Ericson, 8.2 to 8.4). Ours
//! departs in three ways. Faces that a plane passes through go to both sides whole, as pieces of them would be rounded. Planes across an axis come
//! first and those of faces last, so that round solids, of which no face's plane halves the others, get trees of small depth too. And what a cell
//! is is asked, exactly, when a point first falls into it.

mod build;

use std::ops::Range;
use std::sync::OnceLock;

use super::Mesh;
use super::rays::{self, FaceCrossing, Ray, RayHit};
use super::winding::{Containment, Judge};
use crate::exact::{PosedPoint, Spot};
use crate::input::InputError;
use crate::math::Sign;
use crate::primitive::ray_triangle;

/// Cells of space about a mesh, disjoint and convex, by a binary tree of planes.
///
/// For points and rays that are many and a mesh that stands still: a point costs a plane for each level, and an exact winding number only where it
/// is the first of its cell, on a plane, or in a cell that was not cut to the end.
///
/// ```
/// use impinge::mesh::{Containment, SolidBsp};
/// use impinge::{Mesh, Positions};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mesh = Mesh::new(Positions::F32(corners), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let tree = SolidBsp::build(&mesh);
/// assert_eq!(tree.contains([0.1; 3])?, Containment::Inside);
/// assert_eq!(tree.contains([0.5, 0.5, 0.0])?, Containment::Surface);
/// assert_eq!(tree.contains([0.5; 3])?, Containment::Outside);
/// # Ok::<(), impinge::InputError>(())
/// ```
#[derive(Debug)]
pub struct SolidBsp {
    mesh: Mesh,
    /// The root first; none where there is one cell.
    cuts: Vec<Cut>,
    cells: Vec<Cell>,
    /// The lists of cuts and of cells.
    faces: Vec<u32>,
    depth: usize,
}

/// A plane, and the faces that lie in it as far as they come near.
#[derive(Debug)]
struct Cut {
    plane: CutPlane,
    within: Range<u32>,
    below: Child,
    above: Child,
}

#[derive(Clone, Copy, Debug)]
enum CutPlane {
    /// Points whose coordinate along an axis is this number.
    Across { axis: usize, at: f64 },
    /// The plane of a face, above it being where its corners turn left.
    OfFace(u32),
}

#[derive(Clone, Copy, Debug)]
enum Child {
    Cut(u32),
    Cell(u32),
}

/// A cell that no plane cuts any more.
#[derive(Debug)]
struct Cell {
    /// Those that may come into it.
    faces: Range<u32>,
    /// Where all its points are, if no face comes into it.
    label: OnceLock<Containment>,
}

impl SolidBsp {
    /// The tree of a mesh as it is now: what is done to the mesh later does not change it.
    ///
    /// # Complexity
    /// O(n log n), whatever the mesh is: planes pass through faces at most eight times as often as there are faces. What these do not suffice
    /// for stays in cells with faces, where each point is asked for by itself.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        build::Building::of(mesh)
    }

    /// Where a point is to the mesh taken as a solid: the same as [`Mesh::contains`] says.
    ///
    /// # Errors
    /// A coordinate that is not finite, or not below 2^128 in magnitude.
    ///
    /// # Accuracy
    /// Exact for closed meshes (docs/proof.md, L32). Round an open mesh winding numbers are not constant in a cell, and every point is asked for by itself.
    pub fn contains(&self, point: [f64; 3]) -> Result<Containment, InputError> {
        InputError::judge_row(&point, "point", 0)?;
        let ask = || Judge::new(&self.mesh).containment(&PosedPoint::local(Spot::At(point)));
        if !self.mesh.is_closed() {
            return Ok(ask());
        }
        let mut at = self.root();
        let cell = loop {
            match at {
                Child::Cell(cell) => break &self.cells[cell as usize],
                Child::Cut(cut) => {
                    let Cut { plane, below, above, .. } = &self.cuts[cut as usize];
                    at = match plane.side(&self.mesh, &point) {
                        Sign::Negative => *below,
                        Sign::Positive => *above,
                        Sign::Zero => return Ok(ask()),
                    };
                }
            }
        };
        Ok(if cell.faces.is_empty() { *cell.label.get_or_init(ask) } else { ask() })
    }

    /// The first face that a ray meets, the ray's origin included: the same as [`Mesh::ray_cast`] says.
    ///
    /// # Complexity
    /// The cells on the way to the face, and the faces by them.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<RayHit> {
        let (origin, direction) = (ray.origin(), ray.direction());
        let mut best: Option<FaceCrossing> = None;
        let mut pending = vec![(self.root(), [0.0, f64::INFINITY])];
        while let Some((at, [enter, leave])) = pending.pop() {
            if best.is_some_and(|(_, crossing)| enter > crossing.t + crossing.error) {
                continue;
            }
            let list = match at {
                Child::Cell(cell) => &self.cells[cell as usize].faces,
                Child::Cut(cut) => {
                    let Cut { plane, within, below, above } = &self.cuts[cut as usize];
                    match *plane {
                        CutPlane::Across { axis, at } => {
                            let ascends = direction[axis] > 0.0;
                            let (near, far) = if ascends { (*below, *above) } else { (*above, *below) };
                            let [least, most] = passing(at, origin[axis], direction[axis]);
                            // The nearer one last, so that it is taken up first.
                            if leave >= least {
                                pending.push((far, [enter.max(least), leave]));
                            }
                            if enter <= most {
                                pending.push((near, [enter, leave.min(most)]));
                            }
                        }
                        CutPlane::OfFace(_) => {
                            let starts_above = plane.side(&self.mesh, &origin) == Sign::Positive;
                            let (near, far) = if starts_above { (*above, *below) } else { (*below, *above) };
                            pending.push((far, [enter, leave]));
                            pending.push((near, [enter, leave]));
                        }
                    }
                    within
                }
            };
            for &face in &self.faces[list.start as usize..list.end as usize] {
                let Some(crossing) = ray_triangle(&origin, &direction, &self.mesh.corners(face)) else { continue };
                let met = (face, crossing);
                if best.is_none_or(|best| rays::order(&self.mesh, ray, met, best).is_lt()) {
                    best = Some(met);
                }
            }
        }
        best.map(|(face, crossing)| RayHit { t: crossing.t, face, point: ray.at(crossing.t) })
    }

    /// How many cells there are.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// The most planes that a point is compared with.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Bytes that the tree takes, the mesh aside.
    #[must_use]
    pub fn memory(&self) -> usize {
        size_of_val(&self.cuts[..]) + size_of_val(&self.cells[..]) + size_of_val(&self.faces[..])
    }

    fn root(&self) -> Child {
        if self.cuts.is_empty() { Child::Cell(0) } else { Child::Cut(0) }
    }
}

impl CutPlane {
    /// On which side of the plane a point is.
    fn side(&self, mesh: &Mesh, point: &[f64; 3]) -> Sign {
        match *self {
            Self::Across { axis, at } if point[axis] < at => Sign::Negative,
            Self::Across { axis, at } if point[axis] > at => Sign::Positive,
            Self::Across { .. } => Sign::Zero,
            Self::OfFace(face) => build::side(&mesh.corners(face), point),
        }
    }
}

/// Between which parameters a ray passes a plane across an axis: zero and all where it runs along it.
///
/// The difference and the quotient are rounded once each, and what vanishes is below the least normal number.
fn passing(at: f64, origin: f64, direction: f64) -> [f64; 2] {
    if direction == 0.0 {
        return [0.0, f64::INFINITY];
    }
    let t = (at - origin) / direction;
    let doubt = 4.0 * f64::EPSILON * t.abs() + f64::MIN_POSITIVE;
    if t.is_finite() { [t - doubt, t + doubt] } else { [f64::NEG_INFINITY, f64::INFINITY] }
}
