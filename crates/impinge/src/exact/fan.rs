//! The faces of both meshes that meet in a line, seen along it, and whether some direction across it is inside both solids.

use super::corners::PairCorners;
use super::exact_points::Corners;
use super::placement::Placement;
use crate::math::Pose;
use crate::math::Sign::{self, Negative, Positive, Zero};

/// A line along an edge of one of the meshes, in the frame of that mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeLine {
    /// Of B; else of A.
    pub(crate) of_b: bool,
    pub(crate) ends: [[f64; 3]; 2],
}

/// What a face is on one side of a line in its plane.
#[derive(Clone, Copy, Debug)]
struct HalfPlane {
    of_b: bool,
    /// A point of it off the line, in the frame of its mesh.
    reach: [f64; 3],
    /// Whether its own solid is just after it, turning about the line counterclockwise.
    solid_after: bool,
}

/// The faces of both meshes that meet in a line, seen along it.
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

    /// Whether right hands of B's frame are left ones of A's. Turning is meant in A's frame.
    fn turns_b(&self) -> bool {
        self.placement.world_from_a().mirrors() != self.placement.world_from_b().mirrors()
    }

    /// Adds what a face with area, whose plane holds the line, is on either side of it. `front` and `back` say whether its
    /// solid is there, the front being where the corners are counterclockwise in the frame of their mesh.
    pub(crate) fn add(&mut self, of_b: bool, face: &Corners, front: bool, back: bool) {
        let [front, back] = if of_b && self.turns_b() { [back, front] } else { [front, back] };
        for (turn, reach) in self.turns_about_line(of_b, face).into_iter().zip(*face) {
            let solid_after = match turn {
                Zero => continue,
                Positive => front,
                Negative => back,
            };
            // Two corners on one side are one half plane, and add nothing twice.
            self.half_planes.push(HalfPlane { of_b, reach, solid_after });
        }
    }

    /// For each corner whether it turns about the line as the face does about itself.
    fn turns_about_line(&self, of_b: bool, face: &Corners) -> [Sign; 3] {
        let [p, q] = self.line.ends;
        let own = of_b == self.line.of_b;
        let (a, b) = match (own, of_b) {
            // All of one mesh; in its own frame.
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

    /// Whether some direction across the line is inside both solids.
    ///
    /// Such directions form open arcs; each begins, turning, at a half plane of one of the meshes, and just after it the
    /// other mesh is what it is after its own half plane that comes last before.
    pub(crate) fn interiors_meet(&self) -> bool {
        self.half_planes.iter().filter(|start| start.solid_after).any(|start| {
            let others = self.half_planes.iter().filter(|other| other.of_b != start.of_b);
            let last = others.reduce(|best, other| if self.is_nearer_back(start, other, best) { other } else { best });
            last.is_some_and(|last| last.solid_after)
        })
    }

    /// Whether `x` is met before `y` when turning back from `start`.
    fn is_nearer_back(&self, start: &HalfPlane, x: &HalfPlane, y: &HalfPlane) -> bool {
        let (back_to_x, back_to_y) = (self.turned_back(start, x), self.turned_back(start, y));
        // Within one open half turn, x is nearer where y is further back from it.
        back_to_x < back_to_y || (back_to_x == back_to_y && back_to_x % 2 == 1 && self.orientation(x, y) == Negative)
    }

    /// How far back from `start` a half plane is: 0 for none, 1 for less than half a turn, 2 for half a turn, 3 for more.
    fn turned_back(&self, start: &HalfPlane, other: &HalfPlane) -> u8 {
        match self.orientation(start, other) {
            Negative => 1,
            Positive => 3,
            Zero if self.on_one_side(start, other) => 0,
            Zero => 2,
        }
    }

    /// The sign in A's frame of the determinant of the line and the reaches of two half planes: positive where the second
    /// follows less than half a turn after the first.
    fn orientation(&self, r: &HalfPlane, s: &HalfPlane) -> Sign {
        let (mut corners, [p, q, r, s], own) = self.corners(r, s);
        corners.exact_orient3d(p, q, r, s).negated_if(own && self.line.of_b && self.turns_b())
    }

    /// For two half planes in one plane.
    fn on_one_side(&self, r: &HalfPlane, s: &HalfPlane) -> bool {
        let (mut corners, [p, q, r, s], _) = self.corners(r, s);
        (0..3).any(|axis| {
            let turn = corners.orient2d(axis, p, q, r);
            turn != Zero && turn == corners.orient2d(axis, p, q, s)
        })
    }

    /// The ends of the line and both reaches as corners, and whether all are of one mesh and in its own frame.
    fn corners(&self, r: &HalfPlane, s: &HalfPlane) -> (FourPoints<'_>, [usize; 4], bool) {
        let mut sets = [[[0.0; 3]; 3]; 2];
        let mut used = [0; 2];
        let [p, q] = self.line.ends;
        let own = r.of_b == self.line.of_b && s.of_b == self.line.of_b;
        let points = [(self.line.of_b, p), (self.line.of_b, q), (r.of_b, r.reach), (s.of_b, s.reach)];
        let numbers = std::array::from_fn(|i| {
            let (of_b, point) = points[i];
            // Four of one mesh do not fit three corners; they have one frame, where the last may stand for another's.
            let set = if own { usize::from(i == 3) } else { usize::from(of_b) };
            sets[set][used[set]] = point;
            used[set] += 1;
            3 * set + used[set] - 1
        });
        (FourPoints { sets, placement: if own { &self.one_place } else { self.placement } }, numbers, own)
    }
}

/// Six corners and where they are.
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
