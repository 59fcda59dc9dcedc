//! Cells of space that divide a crowd: faces whose boxes nearly all overlap, although few of the
//! faces intersect. Long needles through one place are such a crowd.
//!
//! A hierarchy over boxes cannot separate the faces of a crowd, but space can: two needles are
//! rarely near each other in the same small cell. A cell that many faces reach is divided into
//! eight, and each part lists the faces that reach into it. Two faces that intersect have a common
//! point, so both are listed in a cell that holds it.
//!
//! Source: the spatial subdivision of Ericson, *Real-Time Collision Detection*, 7.3, and the test
//! of a triangle and a box of Akenine-Möller, *Fast 3D triangle-box overlap testing*, JGT 2001.
//! Ours bounds the work of the division by that of comparing all faces.
//!
//! Guarded by the tests below and by `solids/self_intersection.rs`.

use rayon::prelude::*;

use crate::budget::Budget;
use crate::math::vec3::{Vector, cross, dot, sub};
use crate::mesh::Mesh;
use crate::mesh::storage::frame::REACH;

/// Number of faces up to which a cell is not divided. Comparing this number of faces with each
/// other takes about as long as dividing the cell.
const MAX_CELL_FACES: usize = 24;

/// Number of pairs of faces that take as long to compare as a face and eight cells. The division of
/// a cell costs at most a small multiple of comparing all of its faces, even if it divides nothing.
const PAIRS_PER_DIVIDED_FACE: usize = 8;

/// Half of the edge of the smallest cell, in the packed frame: 2^-30. It is far above the margin.
const MIN_HALF_EDGE: f64 = 1.0 / (1_u64 << 30) as f64;

/// Margin by which a cell is enlarged when a face is tested against it: 2^-40.
///
/// # Accuracy
/// Packing moves a corner by at most 2^-51, and its difference from the center of a cell is rounded
/// by at most 2^-51. A product of an axis with a corner of magnitude at most 4 is off by at most
/// 2^-49 of the sum of the axis' components. The margin is above the sum of these. An axis that is
/// rounded itself separates as well as any other.
const MARGIN: f64 = 1.0 / (1_u64 << 40) as f64;

/// A cube of the packed frame.
#[derive(Clone, Copy)]
struct Cell {
    center: Vector,
    half_edge: f64,
}

/// Returns lists of faces, such that two faces that intersect are both in at least one list. If the
/// budget ends the search, lists are missing.
///
/// # Complexity
/// Never more than a small multiple of n². For needles through one place the lists have about
/// n^1.5 faces together.
pub(super) fn cells(mesh: &Mesh, budget: &Budget<'_>) -> Vec<Vec<u32>> {
    let frame = &mesh.0.frame;
    let corners: Vec<[Vector; 3]> =
        (0..mesh.faces().len() as u32).map(|face| mesh.corners(face).map(|corner| frame.pack(corner))).collect();
    let faces: Vec<u32> = (0..corners.len() as u32).collect();
    let division = Division { corners, budget };
    let root = Cell { center: [0.0; 3], half_edge: REACH };
    let Some(parts) = division.parts(root, &faces) else { return vec![faces] };
    let lists = parts.into_par_iter().map(|(cell, faces)| {
        let (mut lists, mut work_left) = (Vec::new(), usize::MAX);
        division.divide(cell, faces, &mut work_left, &mut lists);
        lists
    });
    let lists: Vec<Vec<u32>> = lists.flatten().collect();
    // A division that leaves as many pairs is worth nothing.
    if squares(&lists) < faces.len() * faces.len() { lists } else { vec![faces] }
}

/// Returns about twice the number of pairs in all lists.
fn squares(lists: &[Vec<u32>]) -> usize {
    lists.iter().map(|list| list.len() * list.len()).sum()
}

/// The faces that are divided, in the packed frame.
struct Division<'i> {
    corners: Vec<[Vector; 3]>,
    budget: &'i Budget<'i>,
}

impl Division<'_> {
    /// Appends lists of these faces. Each tested face takes one from `work_left`; if nothing is
    /// left, cells are no longer divided.
    fn divide(&self, cell: Cell, faces: Vec<u32>, work_left: &mut usize, lists: &mut Vec<Vec<u32>>) {
        if self.budget.is_spent() {
            return;
        }
        let own = faces.len() * faces.len() / PAIRS_PER_DIVIDED_FACE;
        let mut left = own.min(*work_left);
        let given = left;
        let is_small = faces.len() <= MAX_CELL_FACES || cell.half_edge < MIN_HALF_EDGE || left < faces.len();
        let parts = if is_small { None } else { self.parts(cell, &faces) };
        let Some(parts) = parts else {
            lists.push(faces);
            return;
        };
        left -= faces.len();
        let first = lists.len();
        for (cell, faces) in parts {
            self.divide(cell, faces, &mut left, lists);
        }
        *work_left -= given - left;
        if squares(&lists[first..]) >= faces.len() * faces.len() {
            lists.truncate(first);
            lists.push(faces);
        }
    }

    /// Returns the eight parts of a cell with the faces that reach into each. Returns `None` if
    /// every face reaches into every part.
    fn parts(&self, cell: Cell, faces: &[u32]) -> Option<Vec<(Cell, Vec<u32>)>> {
        let half_edge = 0.5 * cell.half_edge;
        let part = |number: usize| {
            let towards = |k: usize| if number >> k & 1 == 1 { half_edge } else { -half_edge };
            let part = Cell { center: [0, 1, 2].map(|k| cell.center[k] + towards(k)), half_edge };
            let reaches = |face: &u32| part.may_overlap(&self.corners[*face as usize]);
            (part, faces.iter().copied().filter(reaches).collect::<Vec<u32>>())
        };
        let parts: Vec<(Cell, Vec<u32>)> = (0..8).map(part).collect();
        let divides = parts.iter().any(|(_, part)| part.len() < faces.len());
        divides.then_some(parts)
    }
}

impl Cell {
    /// Reports whether a triangle is not proved apart from this cell.
    fn may_overlap(&self, corners: &[Vector; 3]) -> bool {
        let half = self.half_edge + MARGIN;
        let corners = corners.each_ref().map(|corner| sub(corner, &self.center));
        let is_apart_on_box = (0..3).any(|k| {
            let [p, q, r] = corners.each_ref().map(|corner| corner[k]);
            p.min(q).min(r) > half || p.max(q).max(r) < -half
        });
        if is_apart_on_box {
            return false;
        }
        let separates = |axis: &Vector| {
            let reach = half * (axis[0].abs() + axis[1].abs() + axis[2].abs());
            let [p, q, r] = corners.each_ref().map(|corner| dot(axis, corner));
            p.min(q).min(r) > reach || p.max(q).max(r) < -reach
        };
        let edges = [[0, 1], [1, 2], [2, 0]].map(|[from, to]: [usize; 2]| sub(&corners[to], &corners[from]));
        !edges.iter().any(|&[x, y, z]| separates(&[0.0, z, -y]) || separates(&[-z, 0.0, x]) || separates(&[y, -x, 0.0]))
            && !separates(&cross(&edges[0], &edges[1]))
    }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::exact::{Placement, intersect_beyond_shared};
    use crate::math::Pose;
    use crate::mesh::pairs::self_descent::{WantedFaces, collect_self_intersecting};
    use crate::mesh::storage::positions::Positions;

    fn soup(faces: Vec<[Vector; 3]>) -> Mesh {
        let numbers: Vec<[u32; 3]> =
            (0..faces.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        Mesh::new(Positions::F64(faces.concat()), numbers).expect("a mesh")
    }

    /// Needles through the middle, from and to points of a coarse grid, so that many touch cells
    /// and each other.
    fn needles(rng: &mut Rng, count: usize, width: f64) -> Mesh {
        soup(
            (0..count)
                .map(|_| {
                    let end = [0; 3].map(|_: i32| rng.integer(-8, 9) as f64);
                    let middle = [0; 3].map(|_: i32| rng.integer(-4, 5) as f64 / 64.0);
                    let other = [0, 1, 2].map(|k| 2.0 * middle[k] - end[k]);
                    let wide = [0, 1, 2].map(|k| end[k] + width * rng.integer(-1, 2) as f64);
                    [end, other, wide]
                })
                .collect(),
        )
    }

    fn listed_pairs(mesh: &Mesh) -> (Vec<[u32; 2]>, usize) {
        let lists = cells(mesh, Budget::unlimited());
        let work = lists.iter().map(|list| list.len() * list.len() / 2).sum();
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for list in &lists {
            pairs.extend((0..list.len()).flat_map(|i| list[i + 1..].iter().map(move |&other| [list[i], other])));
            pairs.sort_unstable();
            pairs.dedup();
        }
        (pairs, work)
    }

    /// Every pair that intersects is in a list, and the lists have no more pairs than there are.
    #[test]
    fn pairs_that_intersect_are_in_a_common_list() {
        let mut rng = Rng::new(77);
        let one_place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let mut hits = 0;
        for width in [0.0, 1.0 / 64.0] {
            let mesh = needles(&mut rng, 600, width);
            let (listed, work) = listed_pairs(&mesh);
            for one in 0..600 {
                for other in one + 1..600 {
                    if intersect_beyond_shared(&one_place, &mesh.corners(one), &mesh.corners(other)) {
                        assert!(listed.binary_search(&[one, other]).is_ok(), "{one} {other}");
                        hits += 1;
                    }
                }
            }
            assert!(work <= 600 * 600 / 2, "{work}");
        }
        assert!(hits > 200, "{hits}");
    }

    /// The pairs of needles are those of all pairs, and enough are missed for the cells to be used.
    #[test]
    fn needles_have_the_pairs_of_brute_force() {
        let mut rng = Rng::new(79);
        let one_place = Placement::new(&Pose::IDENTITY, &Pose::IDENTITY);
        let count = 900;
        let mesh = needles(&mut rng, count, 1.0 / 64.0);
        let marks: Vec<bool> = (0..count).map(|face| face % 5 != 0).collect();
        let pairs = (0..count as u32).flat_map(|one| (one + 1..count as u32).map(move |other| [one, other]));
        let all: Vec<[u32; 2]> = pairs
            .filter(|&[one, other]| intersect_beyond_shared(&one_place, &mesh.corners(one), &mesh.corners(other)))
            .collect();
        assert!((200..count * count / 8).contains(&all.len()), "{}", all.len());
        for (wanted, marked) in [(WantedFaces::All, None), (WantedFaces::WithMarked(&marks), Some(&marks))] {
            let is_wanted = |pair: &[u32; 2]| marked.is_none_or(|marks| pair.iter().any(|&face| marks[face as usize]));
            let mut found = collect_self_intersecting(&mesh, wanted, Budget::unlimited());
            found.sort_unstable();
            assert_eq!(found, all.iter().copied().filter(is_wanted).collect::<Vec<_>>());
        }
    }

    /// The number of listed pairs of needles grows like n^1.5, not like n².
    #[test]
    fn needles_are_divided() {
        let mut rng = Rng::new(78);
        let work = [1000, 4000].map(|count| {
            let mut direction = || [0; 3].map(|_: i32| rng.uniform(-1.0, 1.0));
            let faces = (0..count).map(|_| {
                let (end, near) = (direction(), direction().map(|x| 0.05 * x));
                [[0, 1, 2].map(|k| near[k] - end[k]), [0, 1, 2].map(|k| near[k] + end[k]), end.map(|x| x + 1e-6)]
            });
            let faces = faces.map(|[a, b, _]| [a, b, [a[0] + 1e-6, a[1], a[2]]]).collect();
            squares(&cells(&soup(faces), Budget::unlimited()))
        });
        assert!(work[1] < 10 * work[0] && work[1] < 4000 * 4000 / 2, "{work:?}");
    }

    /// Faces that no cell separates are in one list.
    #[test]
    fn copies_are_not_divided() {
        let mesh = soup(vec![[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; 500]);
        let lists = cells(&mesh, Budget::unlimited());
        assert_eq!(squares(&lists), 500 * 500);
    }
}
