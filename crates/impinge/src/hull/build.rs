//! The surface of the hull of points that span space, by randomised incremental insertion with conflict lists.
//!
//! Source: Clarkson and Shor, *Applications of random sampling in computational geometry, II*, 1989, each point remembering
//! one face that it sees (the outside sets of Barber, Dobkin and Huhdanpaa, *The Quickhull algorithm for convex hulls*, 1996)
//! rather than all of them. Ours departs in three ways:
//!
//! - *A face is seen from the strict outside of its plane only*, which is decided exactly. What comes out is then a closed
//!   surface of triangles whose every edge is convex or flat, for coplanar and cospherical points too; points on it
//!   that are no corners are taken out by `facets`.
//! - A point whose face vanishes can only see new faces, or is inside: were there a way in its visible region from the faces
//!   that vanished to one that stayed, the face that was put on the edge crossed between them would be seen too. New
//!   faces stand around the new point like a cone, and the one that a point sees is found by halving them.
//! - The order of insertion is the caller's, see `order`.

use crate::exact::{Plane, collinear, orient3d};
use crate::math::Sign::{Negative, Positive, Zero};
use crate::math::vec3::{cross, dot, sub};

/// No face, no point.
const NONE: u32 = u32::MAX;

/// With at most so many new faces each is tried in turn; halving takes as long from here on.
const FEW: usize = 16;

/// A triangle of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Its corners, turning left seen from outside.
    pub(super) corners: [u32; 3],
    /// The face across the edge from each corner to the next.
    pub(super) across: [u32; 3],
    plane: Plane,
    /// The first of the points that remember this face.
    first: u32,
    /// The insertion that last looked at this face, and what it saw.
    looked: u32,
    seen: bool,
}

/// An edge between the faces that a new point sees and those that it does not, in the direction in which a face that is
/// seen has it.
#[derive(Clone, Copy, Debug)]
struct Edge {
    corners: [u32; 2],
    beyond: u32,
}

/// A surface that grows.
#[derive(Debug)]
pub(super) struct Surface<'p> {
    points: &'p [[f64; 3]],
    /// At least how far two points differ along each axis.
    extent: [f64; 3],
    faces: Vec<Face>,
    is_free: Vec<bool>,
    free: Vec<u32>,
    /// The face that each point remembers, and the next point that remembers the same.
    remembered: Vec<u32>,
    next: Vec<u32>,
    insertion: u32,
    /// Scratch: the faces that the new point sees, the edges around them, and which edge begins at a corner.
    seen: Vec<u32>,
    horizon: Vec<Edge>,
    edge_from: Vec<u32>,
    cone: Vec<u32>,
}

impl<'p> Surface<'p> {
    /// The surface of the hull of all points, which are inserted in their order; nothing where they lie in a plane.
    ///
    /// # Complexity
    /// O(n log n) expected comparisons for points in general position in an order that is random, and at most
    /// O(n² log n) for any. Among points of equal coordinates the first one becomes a corner.
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

    /// The faces, by numbers that [`Face::across`] uses; those that are not part of the surface are nothing.
    pub(super) fn faces(&self) -> impl Iterator<Item = Option<&Face>> {
        self.faces.iter().zip(&self.is_free).map(|(face, is_free)| (!is_free).then_some(face))
    }

    /// The face of this number.
    pub(super) fn face(&self, face: u32) -> &Face {
        &self.faces[face as usize]
    }

    /// Whether two faces with a common edge lie in one plane; `edge` is that of the first.
    pub(super) fn is_flat(&self, face: u32, edge: usize) -> bool {
        let face = self.face(face);
        let start = face.corners[edge];
        let neighbour = self.face(face.across[edge]);
        // The neighbour has the edge the other way round, and its third corner before its end there.
        let Some(at) = neighbour.corners.iter().position(|&corner| corner == start) else { return false };
        !self.sees_other_side(face, neighbour.corners[(at + 1) % 3])
    }

    /// The tetrahedron of four points that span space, and what each other point sees of it.
    fn begin(&mut self, [a, b, c, d]: [u32; 4]) {
        // Each face has the other three corners, and is to the left of what is left.
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

    /// Whether a point is strictly outside of a face's plane.
    #[inline]
    fn sees(&self, point: u32, face: u32) -> bool {
        let face = &self.faces[face as usize];
        let s = &self.points[point as usize];
        match face.plane.side(s) {
            Some(sign) => sign == Positive,
            None => self.side_exactly(&face.corners, s) == Positive,
        }
    }

    /// Whether a corner of the surface is strictly inside of a face's plane.
    fn sees_other_side(&self, face: &Face, corner: u32) -> bool {
        let s = &self.points[corner as usize];
        face.plane.side(s).unwrap_or_else(|| self.side_exactly(&face.corners, s)) == Negative
    }

    #[cold]
    fn side_exactly(&self, corners: &[u32; 3], s: &[f64; 3]) -> crate::math::Sign {
        let [p, q, r] = corners.map(|corner| &self.points[corner as usize]);
        orient3d(p, q, r, s)
    }

    /// Puts a point that sees the face it remembers onto the surface.
    fn insert(&mut self, point: u32) {
        self.insertion += 1;
        self.look_around(point, self.remembered[point as usize]);
        self.order_horizon();
        // The lists of what vanishes are walked once the new faces stand; the faces themselves make room at once.
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

    /// Brings the edges of the horizon, which is one cycle, into their order around it.
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

    /// A face from each edge of the horizon to the new point.
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

    /// A face of the cone around `apex` that a point sees, if any.
    ///
    /// Seen from the apex the cone is a convex polygon `v_0 v_1 ...`, and the plane through apex, `v_0` and `v_i` tells on which
    /// side of a chord the point is. The sides along the polygon change once at most, as a plane through one edge of
    /// a convex cone meets it in one other edge at most, so halving finds the wedge that the point is in, and the face there
    /// is the only one left to ask. A point on such a plane exactly may be behind the apex; then each face is tried.
    fn find_in_cone(&self, apex: u32, point: u32) -> Option<u32> {
        let each = || self.cone.iter().copied().find(|&face| self.sees(point, face));
        let len = self.cone.len();
        if len <= FEW {
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

/// Four points that span space, the last on the inner side of the first three; nothing where all lie in a plane.
///
/// Large ones keep faces from being slivers, so each is as far from those before as floats can tell.
fn simplex(points: &[[f64; 3]]) -> Option<[u32; 4]> {
    let [a, b] = line(points)?;
    let c = off_line(points, a, b)?;
    let (p, q, r) = (&points[a], &points[b], &points[c]);
    let plane = Plane::new(p, q, r, &extent(points));
    let height = |s: &[f64; 3]| plane.height(s).abs();
    let is_off = |s: &[f64; 3]| plane.side(s).unwrap_or_else(|| orient3d(p, q, r, s)) != Zero;
    let d = farthest(points, height, is_off)?;
    let numbers = [a, b, c, d].map(|index| index as u32);
    let [a, b, c, d] = numbers;
    Some(if orient3d(p, q, r, &points[d as usize]) == Negative { [a, b, c, d] } else { [a, c, b, d] })
}

/// The first and the last point in the lexicographic order of coordinates; nothing where all points are equal.
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

/// A point off the line through two different points; nothing where there is none.
pub(super) fn off_line(points: &[[f64; 3]], a: usize, b: usize) -> Option<usize> {
    let (p, q) = (&points[a], &points[b]);
    let area = |s: &[f64; 3]| {
        let normal = cross(&sub(q, p), &sub(s, p));
        dot(&normal, &normal)
    };
    farthest(points, area, |s| !collinear(p, q, s))
}

/// The first point of the greatest measure, provided that it passes the exact test; else the first that passes.
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

/// How far the points spread along each axis, rounded up.
pub(super) fn extent(points: &[[f64; 3]]) -> [f64; 3] {
    let [low, high] = bounds(points);
    std::array::from_fn(|k| (high[k] - low[k]).next_up())
}

/// The corners of the box of the points.
pub(super) fn bounds(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let folded = |start: f64, pick: fn(f64, f64) -> f64| {
        std::array::from_fn(|k| points.iter().fold(start, |best, point| pick(best, point[k])))
    };
    [folded(f64::INFINITY, f64::min), folded(f64::NEG_INFINITY, f64::max)]
}
