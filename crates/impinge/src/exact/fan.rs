//! The faces of both meshes that share a line, viewed along it. A fan decides whether some
//! direction across the line is inside both solids.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::placement::Placement;
use crate::math::Pose;
use crate::math::Sign::{self, Negative, Positive, Zero};

/// A line along an edge of one of the meshes, in the frame of that mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeLine {
    /// Whether the edge belongs to B. Otherwise it belongs to A.
    pub(crate) of_b: bool,
    pub(crate) ends: [[f64; 3]; 2],
}

/// One half of a face's plane, bounded by the line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HalfPlane {
    of_b: bool,
    /// A point of the half plane off the line, in the frame of its mesh.
    reach: [f64; 3],
    /// Whether the solid of its mesh is directly after it, turning counterclockwise about the line.
    solid_after: bool,
}

/// The faces of both meshes that share a line, viewed along it.
pub(crate) struct Fan<'p> {
    placement: &'p Placement,
    one_place: Placement,
    line: EdgeLine,
    half_planes: Vec<HalfPlane>,
}

impl<'p> Fan<'p> {
    pub(crate) fn about(placement: &'p Placement, line: EdgeLine) -> Self {
        let one_place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        Self { placement, one_place, line, half_planes: Vec::new() }
    }

    /// Reports whether the frames of A and B have opposite handedness. Turning directions are meant
    /// in A's frame.
    fn turns_b(&self) -> bool {
        self.placement.world_from_a().mirrors() != self.placement.world_from_b().mirrors()
    }

    /// Adds the half planes of a face with area whose plane holds the line. `front` and `back` tell
    /// whether the face's solid is on that side. The corners appear counterclockwise from the
    /// front, in the frame of their mesh.
    pub(crate) fn add(&mut self, of_b: bool, face: &Corners, front: bool, back: bool) {
        let [front, back] = if of_b && self.turns_b() { [back, front] } else { [front, back] };
        for (turn, reach) in self.turns_about_line(of_b, face).into_iter().zip(*face) {
            let solid_after = match turn {
                Zero => continue,
                Positive => front,
                Negative => back,
            };
            // Faces with equal corners add the same half plane again, which changes no answer.
            let half_plane = HalfPlane { of_b, reach, solid_after };
            if !self.half_planes.contains(&half_plane) {
                self.half_planes.push(half_plane);
            }
        }
    }

    /// Returns for each corner of the face on which side of the line it lies, in the face's plane.
    /// Positive means that the line and the corner turn the same way as the face's own corners.
    fn turns_about_line(&self, of_b: bool, face: &Corners) -> [Sign; 3] {
        let [p, q] = self.line.ends;
        let own = of_b == self.line.of_b;
        let (a, b) = match (own, of_b) {
            // All points belong to one mesh and are used in its own frame.
            (true, _) => ([p, q, q], *face),
            (false, true) => ([p, q, q], *face),
            (false, false) => (*face, [p, q, q]),
        };
        let mut corners = PairCorners::new(if own { &self.one_place } else { self.placement }, &a, &b);
        let (line, face) = if !own && !of_b { ([3, 4], [0, 1, 2]) } else { ([0, 1], [3, 4, 5]) };
        for axis in 0..3 {
            let turn = corners.orient2d(axis, face[0], face[1], face[2]);
            if turn != Zero {
                return face
                    .map(|corner| corners.orient2d(axis, line[0], line[1], corner).negated_if(turn == Negative));
            }
        }
        [Zero; 3]
    }

    /// Reports whether some direction across the line is inside both solids.
    ///
    /// Such directions form open arcs. Counterclockwise, each arc begins at a half plane of one
    /// mesh with the mesh's solid directly after it. There, the other solid is present if and only
    /// if it is directly after the last half plane of the other mesh before this one.
    pub(crate) fn interiors_intersect(&self) -> bool {
        self.half_planes.iter().filter(|start| start.solid_after).any(|start| {
            let others = self.half_planes.iter().filter(|other| other.of_b != start.of_b);
            let last = others.reduce(|best, other| if self.is_nearer_back(start, other, best) { other } else { best });
            last.is_some_and(|last| last.solid_after)
        })
    }

    /// Reports whether `x` comes before `y` when turning back (clockwise) from `start`.
    fn is_nearer_back(&self, start: &HalfPlane, x: &HalfPlane, y: &HalfPlane) -> bool {
        let (back_to_x, back_to_y) = (self.turned_back(start, x), self.turned_back(start, y));
        // Within one open half turn, x is nearer if y is further back than x.
        back_to_x < back_to_y || (back_to_x == back_to_y && back_to_x % 2 == 1 && self.orientation(x, y) == Negative)
    }

    /// Returns how far back from `start` a half plane is: 0 for the same direction, 1 for less than
    /// half a turn, 2 for half a turn, 3 for more.
    fn turned_back(&self, start: &HalfPlane, other: &HalfPlane) -> u8 {
        match self.orientation(start, other) {
            Negative => 1,
            Positive => 3,
            Zero if self.on_one_side(start, other) => 0,
            Zero => 2,
        }
    }

    /// Returns the sign in A's frame of the determinant of the line and the points of two half
    /// planes. It is positive if the second follows less than half a turn after the first.
    fn orientation(&self, r: &HalfPlane, s: &HalfPlane) -> Sign {
        let (mut corners, [p, q, r, s], own) = self.corners(r, s);
        corners.exact_orient3d(p, q, r, s).negated_if(own && self.line.of_b && self.turns_b())
    }

    /// Reports whether two half planes of one plane are on the same side of the line.
    fn on_one_side(&self, r: &HalfPlane, s: &HalfPlane) -> bool {
        let (mut corners, [p, q, r, s], _) = self.corners(r, s);
        (0..3).any(|axis| {
            let turn = corners.orient2d(axis, p, q, r);
            turn != Zero && turn == corners.orient2d(axis, p, q, s)
        })
    }

    /// Returns the ends of the line and the points of both half planes as corners, and whether all
    /// belong to one mesh and are in its frame.
    fn corners(&self, r: &HalfPlane, s: &HalfPlane) -> (FourPoints<'_>, [usize; 4], bool) {
        let mut sets = [[[0.0; 3]; 3]; 2];
        let mut used = [0; 2];
        let [p, q] = self.line.ends;
        let own = r.of_b == self.line.of_b && s.of_b == self.line.of_b;
        let points = [(self.line.of_b, p), (self.line.of_b, q), (r.of_b, r.reach), (s.of_b, s.reach)];
        let numbers = std::array::from_fn(|i| {
            let (of_b, point) = points[i];
            // Three corners cannot hold four points of one mesh. The meshes then share one frame,
            // so the fourth point takes a corner of the other triangle.
            let set = if own { usize::from(i == 3) } else { usize::from(of_b) };
            sets[set][used[set]] = point;
            used[set] += 1;
            3 * set + used[set] - 1
        });
        (FourPoints { sets, placement: if own { &self.one_place } else { self.placement } }, numbers, own)
    }
}

/// Six corners and the placement of their meshes.
struct FourPoints<'p> {
    sets: [Corners; 2],
    placement: &'p Placement,
}

impl FourPoints<'_> {
    fn exact_orient3d(&mut self, p: usize, q: usize, r: usize, s: usize) -> Sign {
        PairCorners::new(self.placement, &self.sets[0], &self.sets[1]).exact_orient3d(p, q, r, s)
    }

    fn orient2d(&mut self, axis: usize, p: usize, q: usize, r: usize) -> Sign {
        PairCorners::new(self.placement, &self.sets[0], &self.sets[1]).orient2d(axis, p, q, r)
    }
}
