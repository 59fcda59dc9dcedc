//! The first face that a ray intersects. Cells are processed in the order in which the ray passes
//! them.

use super::plane::{self, CutPlane, Passage};
use super::tree::{Child, SolidBsp};
use crate::mesh::points::rays::{self, FaceCrossing, Ray, RayHit};
use crate::primitive::ray_triangle;

/// Number of most recently compared faces that a ray remembers. Neighboring cells have the same
/// faces.
const REMEMBERED_FACES: usize = 8;

/// The state of one ray cast.
struct Cast<'t> {
    tree: &'t SolidBsp,
    ray: &'t Ray,
    best: Option<FaceCrossing>,
    /// The faces that were compared last, in a ring.
    seen: [u32; REMEMBERED_FACES],
    compared: usize,
}

impl SolidBsp {
    /// Returns the first face that a ray intersects, in the mesh's own frame, or `None`. The ray's
    /// origin belongs to the ray. The result is the same as that of
    /// [`Mesh::ray_cast`](crate::Mesh::ray_cast).
    ///
    /// # Complexity
    /// Linear in the cells on the way to the face and in their faces.
    #[must_use]
    pub fn ray_cast(&self, ray: &Ray) -> Option<RayHit> {
        let mut cast = Cast { tree: self, ray, best: None, seen: [u32::MAX; REMEMBERED_FACES], compared: 0 };
        cast.run();
        cast.best.map(|(face, crossing)| RayHit { t: crossing.t, face, point: ray.at(crossing.t) })
    }

    /// Returns an interval of parameters that holds all points of the ray in the mesh's box. It is
    /// empty if the ray misses the box.
    fn within_bounds(&self, ray: &Ray) -> [f64; 2] {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin()[axis], ray.direction()[axis]);
            if direction == 0.0 {
                // The ray keeps this coordinate, between both planes or outside of one.
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
                        self.compare(tree.listed(&tree.cells[cell as usize].faces));
                        break;
                    }
                };
                let CutPlane::Across { axis, at: place } = cut.plane else {
                    // Comparing a few faces costs less than testing their planes.
                    self.compare(tree.listed(&cut.faces));
                    break;
                };
                let Passage { ascends, between: [least, most] } =
                    plane::across(place, self.ray.origin()[axis], self.ray.direction()[axis]);
                if least <= leave && enter <= most {
                    self.compare(tree.listed(&cut.faces));
                }
                let (near, far) = if ascends { (cut.below, cut.above) } else { (cut.above, cut.below) };
                // The part beyond the plane waits until the part before it was processed.
                if least <= leave {
                    pending.push((far, [enter.max(least), leave]));
                }
                (at, leave) = (near, leave.min(most));
            }
        }
    }

    /// Reports whether a hit from the parameter `enter` on may be the first one.
    fn reaches(&self, enter: f64) -> bool {
        self.best.is_none_or(|(_, crossing)| enter <= crossing.t + crossing.error)
    }

    fn compare(&mut self, faces: &[u32]) {
        let (mesh, ray) = (&self.tree.mesh, self.ray);
        for &face in faces {
            if self.seen.contains(&face) {
                continue;
            }
            self.seen[self.compared % REMEMBERED_FACES] = face;
            self.compared += 1;
            let Some(crossing) = ray_triangle(&ray.origin(), &ray.direction(), &mesh.corners(face)) else { continue };
            let hit = (face, crossing);
            if self.best.is_none_or(|best| rays::order(mesh, ray, hit, best).is_lt()) {
                self.best = Some(hit);
            }
        }
    }
}
