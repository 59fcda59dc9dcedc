//! The surface of the hull of points that span space, built by randomized incremental insertion
//! with conflict lists.
//!
//! Source: Clarkson and Shor, *Applications of random sampling in computational geometry, II*,
//! 1989, but each point remembers one face that it sees (the outside sets of Barber, Dobkin and
//! Huhdanpaa, *The Quickhull algorithm for convex hulls*, 1996) rather than all of them. Ours
//! departs in three ways:
//!
//! - *A point sees a face only from the strict outside of its plane*, which is decided exactly. The
//!   result is a closed surface of triangles whose edges are all convex or flat, for coplanar and
//!   cospherical points too. `facets` removes points on it that are not corners.
//! - If a point's face vanishes, the point sees only new faces, or is inside. Otherwise its visible
//!   region would have a path from the vanished faces to a face that stayed, and the point would
//!   also see the new face on the edge crossed between them. New faces form a cone around the new
//!   point, and bisection finds the one that a point sees.
//! - The caller chooses the order of insertion; see `order`.

use crate::exact::{Plane, collinear, orient3d};
use crate::math::Sign::{Negative, Positive, Zero};
use crate::math::vec3::{cross, dot, sub};

/// Marks that there is no face or no point.
const NONE: u32 = u32::MAX;

/// Maximum number of new faces that are tried one by one. With more faces, bisection is faster; at
/// 16 it costs the same.
const MAX_SCANNED_FACES: usize = 16;

/// A triangle of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Corners, in counterclockwise order seen from outside.
    pub(super) corners: [u32; 3],
    /// The face across the edge from each corner to the next.
    pub(super) across: [u32; 3],
    plane: Plane,
    /// The first of the points that remember this face.
    first: u32,
    /// The last insertion that visited this face, and whether its point sees the face.
    looked: u32,
    seen: bool,
}

/// An edge between a face that a new point sees and one that it does not see. Its direction is the
/// one in the seen face.
#[derive(Clone, Copy, Debug)]
struct Edge {
    corners: [u32; 2],
    beyond: u32,
}

/// A growing surface.
#[derive(Debug)]
pub(super) struct Surface<'p> {
    points: &'p [[f64; 3]],
    /// Upper bound on the difference of two points along each axis.
    extent: [f64; 3],
    faces: Vec<Face>,
    is_free: Vec<bool>,
    free: Vec<u32>,
    /// The face that each point remembers, and the next point that remembers the same face.
    remembered: Vec<u32>,
    next: Vec<u32>,
    insertion: u32,
    /// Buffers: the faces that the new point sees, the edges around them, and the edge that begins
    /// at each corner.
    seen: Vec<u32>,
    horizon: Vec<Edge>,
    edge_from: Vec<u32>,
    cone: Vec<u32>,
}

impl<'p> Surface<'p> {
    /// Builds the surface of the hull of all points, inserted in their order. Returns `None` if
    /// they lie in a plane.
    ///
    /// # Complexity
    /// O(n log n) expected comparisons for points in general position in a random order, and at
    /// most O(n² log n) for any input. Of points with equal coordinates the first becomes a corner.
    pub(super) fn of(points: &'p [[f64; 3]]) -> Option<Self> {
        let start = simplex(points)?;
        let mut surface = Self {
            points,
            extent: extent(points),
            faces: Vec::new(),
            is_free: Vec::new(),
            free: Vec::new(),
            remembered: vec![NONE; points.len()],
            next: vec![NONE; points.len()],
            insertion: 0,
            seen: Vec::new(),
            horizon: Vec::new(),
            edge_from: vec![NONE; points.len()],
            cone: Vec::new(),
        };
        surface.begin(start);
        for point in 0..points.len() as u32 {
            if surface.remembered[point as usize] != NONE {
                surface.insert(point);
            }
        }
        Some(surface)
    }

    /// Iterates over the faces, numbered as in [`Face::across`]. Items that are not part of the
    /// surface are `None`.
    pub(super) fn faces(&self) -> impl Iterator<Item = Option<&Face>> {
        self.faces.iter().zip(&self.is_free).map(|(face, is_free)| (!is_free).then_some(face))
    }

    /// Returns the face with this number.
    pub(super) fn face(&self, face: u32) -> &Face {
        &self.faces[face as usize]
    }

    /// Reports whether two faces with a common edge lie in one plane. `edge` is the edge's number
    /// in the first face.
    pub(super) fn is_flat(&self, face: u32, edge: usize) -> bool {
        let face = self.face(face);
        let start = face.corners[edge];
        let neighbor = self.face(face.across[edge]);
        // The neighbor has the edge in the opposite direction, and its third corner comes after the
        // edge.
        let Some(at) = neighbor.corners.iter().position(|&corner| corner == start) else { return false };
        !self.sees_other_side(face, neighbor.corners[(at + 1) % 3])
    }

    /// Starts with the tetrahedron of four points that span space, and finds a face that each other
    /// point sees.
    fn begin(&mut self, [a, b, c, d]: [u32; 4]) {
        // Each face has three of the corners, and the fourth is on its inner side.
        for (corners, across) in
            [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        {
            self.push(corners, across);
        }
        for point in (0..self.points.len() as u32).rev() {
            if let Some(face) = (0..4).find(|&face| self.sees(point, face)) {
                self.remember(point, face);
            }
        }
    }

    fn push(&mut self, corners: [u32; 3], across: [u32; 3]) -> u32 {
        let [p, q, r] = corners.map(|corner| &self.points[corner as usize]);
        let plane = Plane::new(p, q, r, &self.extent);
        let face = Face { corners, across, plane, first: NONE, looked: 0, seen: false };
        match self.free.pop() {
            Some(number) => {
                self.faces[number as usize] = face;
                self.is_free[number as usize] = false;
                number
            }
            None => {
                self.faces.push(face);
                self.is_free.push(false);
                self.faces.len() as u32 - 1
            }
        }
    }

    fn remember(&mut self, point: u32, face: u32) {
        let face_data = &mut self.faces[face as usize];
        self.next[point as usize] = face_data.first;
        self.remembered[point as usize] = face;
        face_data.first = point;
    }

    /// Reports whether a point is strictly outside a face's plane.
    #[inline]
    fn sees(&self, point: u32, face: u32) -> bool {
        let face = &self.faces[face as usize];
        let s = &self.points[point as usize];
        match face.plane.side(s) {
            Some(sign) => sign == Positive,
            None => !face.corners.contains(&point) && self.side_exactly(&face.corners, s) == Positive,
        }
    }

    /// Reports whether a corner of the surface is strictly inside a face's plane.
    fn sees_other_side(&self, face: &Face, corner: u32) -> bool {
        let s = &self.points[corner as usize];
        face.plane.side(s).unwrap_or_else(|| self.side_exactly(&face.corners, s)) == Negative
    }

    #[cold]
    fn side_exactly(&self, corners: &[u32; 3], s: &[f64; 3]) -> crate::math::Sign {
        let [p, q, r] = corners.map(|corner| &self.points[corner as usize]);
        orient3d(p, q, r, s)
    }

    /// Adds a point to the surface. The point must see the face that it remembers.
    fn insert(&mut self, point: u32) {
        self.insertion += 1;
        self.look_around(point, self.remembered[point as usize]);
        self.order_horizon();
        // The lists of the vanished faces are processed after the new faces have been added. The
        // faces themselves are freed at once.
        let mut orphans = NONE;
        for index in 0..self.seen.len() {
            let face = self.seen[index];
            let mut orphan = self.faces[face as usize].first;
            while orphan != NONE {
                let after = self.next[orphan as usize];
                self.remembered[orphan as usize] = NONE;
                if orphan != point {
                    self.next[orphan as usize] = orphans;
                    orphans = orphan;
                }
                orphan = after;
            }
            self.is_free[face as usize] = true;
            self.free.push(face);
        }
        self.raise_cone(point);
        while orphans != NONE {
            let after = self.next[orphans as usize];
            if let Some(face) = self.find_in_cone(point, orphans) {
                self.remember(orphans, face);
            }
            orphans = after;
        }
    }

    /// Finds the faces that a point sees, which are connected, and the edges around them.
    fn look_around(&mut self, point: u32, first: u32) {
        self.seen.clear();
        self.horizon.clear();
        self.seen.push(first);
        (self.faces[first as usize].looked, self.faces[first as usize].seen) = (self.insertion, true);
        let mut next = 0;
        while let Some(&face) = self.seen.get(next) {
            next += 1;
            let Face { corners, across, .. } = self.faces[face as usize];
            for edge in 0..3 {
                let beyond = across[edge];
                if self.faces[beyond as usize].looked != self.insertion {
                    let seen = self.sees(point, beyond);
                    (self.faces[beyond as usize].looked, self.faces[beyond as usize].seen) = (self.insertion, seen);
                    if seen {
                        self.seen.push(beyond);
                    }
                }
                if !self.faces[beyond as usize].seen {
                    self.horizon.push(Edge { corners: [corners[edge], corners[(edge + 1) % 3]], beyond });
                }
            }
        }
    }

    /// Sorts the edges of the horizon, which is one cycle, into their order around it.
    fn order_horizon(&mut self) {
        for (index, edge) in self.horizon.iter().enumerate() {
            self.edge_from[edge.corners[0] as usize] = index as u32;
        }
        for index in 1..self.horizon.len() {
            let from = self.horizon[index - 1].corners[1];
            let found = self.edge_from[from as usize] as usize;
            self.horizon.swap(index, found);
            self.edge_from[self.horizon[found].corners[0] as usize] = found as u32;
        }
    }

    /// Adds a face from each edge of the horizon to the new point.
    fn raise_cone(&mut self, point: u32) {
        self.cone.clear();
        for index in 0..self.horizon.len() {
            let Edge { corners: [from, to], beyond } = self.horizon[index];
            let face = self.push([from, to, point], [beyond, NONE, NONE]);
            let outer = &mut self.faces[beyond as usize];
            if let Some(edge) = (0..3).find(|&edge| outer.corners[edge] == to && outer.corners[(edge + 1) % 3] == from)
            {
                outer.across[edge] = face;
            }
            self.cone.push(face);
        }
        let len = self.cone.len();
        for index in 0..len {
            let (before, after) = (self.cone[(index + len - 1) % len], self.cone[(index + 1) % len]);
            let face = &mut self.faces[self.cone[index] as usize];
            (face.across[1], face.across[2]) = (after, before);
        }
    }

    /// Returns a face of the cone around `apex` that a point sees, or `None`.
    ///
    /// Seen from the apex the cone is a convex polygon `v_0 v_1 ...`. The plane through apex, `v_0`
    /// and `v_i` decides on which side of a chord the point is. The side changes at most once along
    /// the polygon, because a plane through one edge of a convex cone intersects it in at most one
    /// other edge. So bisection finds the wedge that holds the point, and only the face of that
    /// wedge needs to be tested. A point exactly on such a plane may be behind the apex; then all
    /// faces are tried.
    fn find_in_cone(&self, apex: u32, point: u32) -> Option<u32> {
        let each = || self.cone.iter().copied().find(|&face| self.sees(point, face));
        let len = self.cone.len();
        if len <= MAX_SCANNED_FACES {
            return each();
        }
        for face in [self.cone[0], self.cone[len - 1]] {
            if self.sees(point, face) {
                return Some(face);
            }
        }
        let corner = |index: usize| &self.points[self.horizon[index].corners[0] as usize];
        let (q, s) = (&self.points[apex as usize], &self.points[point as usize]);
        let (mut low, mut high) = (1, len - 1);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            let chord = Plane::new(q, corner(0), corner(middle), &self.extent);
            match chord.side(s).unwrap_or_else(|| orient3d(q, corner(0), corner(middle), s)) {
                Negative => low = middle,
                Positive => high = middle,
                Zero => return each(),
            }
        }
        let face = self.cone[low];
        self.sees(point, face).then_some(face)
    }
}

/// Returns four points that span space, the last on the inner side of the first three. Returns
/// `None` if all points lie in a plane.
///
/// A large tetrahedron avoids thin faces, so each point is as far from the points before it as
/// floats can tell.
fn simplex(points: &[[f64; 3]]) -> Option<[u32; 4]> {
    let [a, b] = line(points)?;
    let c = off_line(points, a, b)?;
    let (p, q, r) = (&points[a], &points[b], &points[c]);
    let plane = Plane::new(p, q, r, &extent(points));
    let height = |s: &[f64; 3]| plane.height(s).abs();
    let is_off = |s: &[f64; 3]| plane.side(s).unwrap_or_else(|| orient3d(p, q, r, s)) != Zero;
    let d = farthest(points, height, is_off)?;
    let is_below = plane.side(&points[d]).unwrap_or_else(|| orient3d(p, q, r, &points[d])) == Negative;
    let [a, b, c, d] = [a, b, c, d].map(|index| index as u32);
    Some(if is_below { [a, b, c, d] } else { [a, c, b, d] })
}

/// Returns the first and the last point in the lexicographic order of coordinates, or `None` if all
/// points are equal.
pub(super) fn line(points: &[[f64; 3]]) -> Option<[usize; 2]> {
    let (mut low, mut high) = (0, 0);
    for (index, point) in points.iter().enumerate() {
        if point < &points[low] {
            low = index;
        }
        if point > &points[high] {
            high = index;
        }
    }
    (!points.is_empty() && points[low] != points[high]).then_some([low, high])
}

/// Returns a point off the line through two different points, or `None` if there is none.
pub(super) fn off_line(points: &[[f64; 3]], a: usize, b: usize) -> Option<usize> {
    let (p, q) = (&points[a], &points[b]);
    let area = |s: &[f64; 3]| {
        let normal = cross(&sub(q, p), &sub(s, p));
        dot(&normal, &normal)
    };
    farthest(points, area, |s| !collinear(p, q, s))
}

/// Returns the first point with the greatest measure if it passes the exact test. Otherwise returns
/// the first point that passes, or `None`.
fn farthest(
    points: &[[f64; 3]],
    measure: impl Fn(&[f64; 3]) -> f64,
    passes: impl Fn(&[f64; 3]) -> bool,
) -> Option<usize> {
    let mut best = (0, f64::NEG_INFINITY);
    for (index, point) in points.iter().enumerate() {
        let measured = measure(point);
        if measured > best.1 {
            best = (index, measured);
        }
    }
    if points.get(best.0).is_some_and(&passes) { Some(best.0) } else { points.iter().position(passes) }
}

/// Returns the extent of the points along each axis, rounded up.
pub(super) fn extent(points: &[[f64; 3]]) -> [f64; 3] {
    let [low, high] = bounds(points);
    std::array::from_fn(|k| (high[k] - low[k]).next_up())
}

/// Returns the corners of the bounding box of the points.
pub(super) fn bounds(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let folded = |start: f64, pick: fn(f64, f64) -> f64| {
        std::array::from_fn(|k| points.iter().fold(start, |best, point| pick(best, point[k])))
    };
    [folded(f64::INFINITY, f64::min), folded(f64::NEG_INFINITY, f64::max)]
}
