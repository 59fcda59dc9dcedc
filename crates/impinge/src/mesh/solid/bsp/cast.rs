//! The first face that a ray meets: cells in the order in which it comes through them.

use super::plane::{self, CutPlane, Passage};
use super::tree::{Child, SolidBsp};
use crate::mesh::points::rays::{self, FaceCrossing, Ray, RayHit};
use crate::primitive::ray_triangle;

/// Faces that a ray remembers to have been compared with: the same ones are in cells side by side.
const REMEMBERED: usize = 8;

/// A ray on its way.
struct Cast<'t> {
    tree: &'t SolidBsp,
    ray: &'t Ray,
    best: Option<FaceCrossing>,
    seen: [u32; REMEMBERED],
    compared: usize,
}

impl SolidBsp {
    /// The first face that a ray meets, the ray's origin included: the same as [`Mesh::ray_cast`](crate::Mesh::ray_cast) says.
    ///
    /// # Complexity
    /// The cells on the way to the face, and the faces by them.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<RayHit> {
        let mut cast = Cast { tree: self, ray, best: None, seen: [u32::MAX; REMEMBERED], compared: 0 };
        cast.run();
        cast.best.map(|(face, crossing)| RayHit { t: crossing.t, face, point: ray.at(crossing.t) })
    }

    /// Between which parameters the ray is in the box of the mesh, at least.
    fn within_bounds(&self, ray: &Ray) -> [f64; 2] {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin()[axis], ray.direction()[axis]);
            if direction == 0.0 {
                // It stays where it is, inside of both planes or outside of one.
                if origin < self.low[axis] || self.high[axis] < origin {
                    return [f64::INFINITY, f64::NEG_INFINITY];
                }
                continue;
            }
            let [low, high] =
                [self.low, self.high].map(|corner| plane::across(corner[axis], origin, direction).between);
            let (first, last) = if direction > 0.0 { (low, high) } else { (high, low) };
            (enter, leave) = (enter.max(first[0]), leave.min(last[1]));
        }
        [enter, leave]
    }
}

impl Cast<'_> {
    fn run(&mut self) {
        let tree = self.tree;
        let mut pending = Vec::with_capacity(tree.depth + 1);
        pending.push((tree.root(), tree.within_bounds(self.ray)));
        while let Some((mut at, [enter, mut leave])) = pending.pop() {
            while enter <= leave && self.reaches(enter) {
                let cut = match at {
                    Child::Cut(cut) => &tree.cuts[cut as usize],
                    Child::Cell(cell) => {
                        self.meet(tree.listed(&tree.cells[cell as usize].faces));
                        break;
                    }
                };
                let CutPlane::Across { axis, at: place } = cut.plane else {
                    // Few faces are quicker asked than their planes.
                    self.meet(tree.listed(&cut.faces));
                    break;
                };
                let Passage { ascends, between: [least, most] } =
                    plane::across(place, self.ray.origin()[axis], self.ray.direction()[axis]);
                if least <= leave && enter <= most {
                    self.meet(tree.listed(&cut.faces));
                }
                let (near, far) = if ascends { (cut.below, cut.above) } else { (cut.above, cut.below) };
                // What is beyond the plane waits until what is before it has been seen.
                if least <= leave {
                    pending.push((far, [enter.max(least), leave]));
                }
                (at, leave) = (near, leave.min(most));
            }
        }
    }

    /// Whether what is met from there on may be the first.
    fn reaches(&self, enter: f64) -> bool {
        self.best.is_none_or(|(_, crossing)| enter <= crossing.t + crossing.error)
    }

    fn meet(&mut self, faces: &[u32]) {
        let (mesh, ray) = (&self.tree.mesh, self.ray);
        for &face in faces {
            if self.seen.contains(&face) {
                continue;
            }
            self.seen[self.compared % REMEMBERED] = face;
            self.compared += 1;
            let Some(crossing) = ray_triangle(&ray.origin(), &ray.direction(), &mesh.corners(face)) else { continue };
            let met = (face, crossing);
            if self.best.is_none_or(|best| rays::order(mesh, ray, met, best).is_lt()) {
                self.best = Some(met);
            }
        }
    }
}
