//! Open solids against sampled points: the winding numbers of points in the common box tell which
//! lie in both solids, and those of points around them how far from the outside they are.

use impinge::mesh::Containment;
use impinge::query::{self, Deeper};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::cuboid;

/// Number of points along each side of the common box.
const GRID: usize = 12;

/// Returns a box without the faces at the end `at` of an axis, turned inside out if `is_reversed`.
fn open_box(low: [f64; 3], high: [f64; 3], (axis, at): (usize, f64), is_reversed: bool) -> Mesh {
    let mesh = cuboid(low, high);
    let is_at_end = |face: &[u32; 3]| face.iter().all(|&vertex| mesh.vertices[vertex as usize][axis] == at);
    let mut faces: Vec<[u32; 3]> = mesh.faces.iter().copied().filter(|face| !is_at_end(face)).collect();
    if is_reversed {
        faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    Mesh::new(Positions::F64(mesh.vertices), faces).unwrap()
}

/// Returns whether some point of a grid in a box lies in both solids, and no point around it at the
/// distance is outside of one of them.
fn is_sampled_deeper(solids: [&Mesh; 2], [low, high]: [[f64; 3]; 2], distance: f64) -> bool {
    let is_in = |mesh: &Mesh, points: &[[f64; 3]]| -> Vec<bool> {
        mesh.contains(points).unwrap().iter().map(|place| *place == Containment::Inside).collect()
    };
    let share = |index: usize| (index as f64 + 0.5) / GRID as f64;
    let grid: Vec<[f64; 3]> = (0..GRID.pow(3))
        .map(|at| [at % GRID, at / GRID % GRID, at / (GRID * GRID)])
        .map(|at| std::array::from_fn(|k| low[k] + (high[k] - low[k]) * share(at[k])))
        .collect();
    let [in_a, in_b] = solids.map(|mesh| is_in(mesh, &grid));
    let around: Vec<[f64; 3]> =
        (0..27).filter(|&at| at != 13).map(|at| [at % 3, at / 3 % 3, at / 9].map(|x| f64::from(x) - 1.0)).collect();
    let is_deep = |point: &[f64; 3], mesh: &Mesh| {
        let to_faces = mesh.closest_point(*point).unwrap().unwrap().lower;
        let ring: Vec<[f64; 3]> = around
            .iter()
            .map(|way| {
                let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
                std::array::from_fn(|k| point[k] + distance * way[k] / length)
            })
            .collect();
        to_faces > distance && is_in(mesh, &ring).iter().all(|&inside| inside)
    };
    let common = grid.iter().enumerate().filter(|(at, _)| in_a[*at] && in_b[*at]);
    common.into_iter().any(|(_, point)| solids.iter().any(|mesh| is_deep(point, mesh)))
}

#[test]
fn open_boxes_are_as_deep_as_their_sampled_points() {
    let mut count = [0; 3];
    // Boxes along the axes would be told apart by their extents alone.
    let turned = Pose::from_axis_angle([1.0, 2.0, 3.0], 0.7, [4.0, -2.0, 1.0]).unwrap();
    for axis in 0..3 {
        for (at, is_reversed) in [(0.0, false), (1.0, false), (1.0, true)] {
            let open = open_box([0.0; 3], [1.0; 3], (axis, at), is_reversed);
            for step in 0..6 {
                // A block of 1/2 that comes through each side in turn, by 1/16 more at each step.
                for side in 0..6 {
                    let (along, depth) = (side / 2, 0.0625 * f64::from(step));
                    let mut low = [0.25; 3];
                    low[along as usize] = if side % 2 == 0 { depth - 0.5 } else { 1.0 - depth };
                    let block = cuboid(low, low.map(|x| x + 0.5));
                    let block = Mesh::new(Positions::F64(block.vertices), block.faces).unwrap();
                    let common = [low.map(|x| x.max(0.0)), low.map(|x| (x + 0.5).min(1.0))];
                    // The depth is at most half of the width of the block, which is 1/4.
                    let [slight, large] =
                        [0.03125, 0.15625].map(|t| query::deeper(open.at(turned), block.at(turned), t));
                    if step == 0 {
                        // At a hole, the solid ends about where the block begins.
                        assert_ne!(slight, Deeper::Yes, "axis {axis} end {at} side {side}");
                        count[0] += usize::from(slight == Deeper::No);
                    } else if is_sampled_deeper([&open, &block], common, 0.04) {
                        assert_ne!(slight, Deeper::No, "axis {axis} end {at} side {side} step {step}");
                        count[1] += usize::from(slight == Deeper::Yes);
                    }
                    if step == 1 {
                        assert_ne!(large, Deeper::Yes, "axis {axis} end {at} side {side}");
                        count[2] += usize::from(large == Deeper::No);
                    }
                }
            }
        }
    }
    // Three axes, three boxes, six sides, five steps for the deep ones.
    assert!(count[0] >= 45 && count[1] > 180 && count[2] >= 45, "{count:?} of [54, 270, 54] are decided");
}
