//! Solids of many bodies on a lattice. The bodies of one mesh share walls, edges and corners,
//! overlap, or lie in hollows.
//!
//! A brick is a box between two points of the integer lattice. It winds around each of its cells
//! once, or once in the opposite sense if it is turned inside out. So the winding number of each
//! cell is a sum of integers, and whether the interiors of two sets of bricks intersect is decided
//! by comparing cells. It checks `query::penetrates`, in `tests/it/solids/bricks.rs` and
//! `fuzz/targets/bricks.rs`.

use std::collections::BTreeMap;

use super::Rng;
use crate::Mesh;

/// Box on the integer lattice. A brick without thickness is a membrane: it has both sides and no
/// interior.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brick {
    /// Smallest coordinates.
    pub low: [i64; 3],
    /// Largest coordinates.
    pub high: [i64; 3],
    /// Whether the corners of its faces are clockwise as seen from outside.
    pub inside_out: bool,
}

/// Way to cut the sides of bricks into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Unit squares, each with the same diagonal for every brick of the lattice. Faces of one mesh
    /// have only corners, edges or whole faces in common.
    AsLattice,
    /// Unit squares, each with a random diagonal, so that a shared wall may be cut in two ways.
    ByChance,
    /// Two triangles for each side, which may overlap parts of other sides.
    Whole,
}

/// Two sets of bricks.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The bricks of either mesh, each set in its own frame.
    pub bricks: [Vec<Brick>; 2],
    /// Translation of the second set, in half units.
    pub half_steps: [i64; 3],
}

impl Brick {
    /// Returns the brick between two corners.
    pub fn new(low: [i64; 3], high: [i64; 3]) -> Self {
        Self { low, high, inside_out: false }
    }

    /// Returns the unit cube whose smallest corner is `low`.
    pub fn unit(low: [i64; 3]) -> Self {
        Self::new(low, low.map(|x| x + 1))
    }

    /// Returns this brick, turned inside out.
    pub fn turned(self) -> Self {
        Self { inside_out: !self.inside_out, ..self }
    }
}

/// Returns the surfaces of all bricks as one mesh. Each square has vertices of its own.
pub fn mesh(rng: &mut Rng, bricks: &[Brick], cut: Cut) -> Mesh {
    let mut mesh = Mesh::default();
    for brick in bricks {
        for axis in 0..3 {
            for upper in [false, true] {
                add_side(rng, &mut mesh, brick, axis, upper, cut);
            }
        }
    }
    mesh
}

fn add_side(rng: &mut Rng, mesh: &mut Mesh, brick: &Brick, axis: usize, upper: bool, cut: Cut) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let extent = |k: usize| brick.high[k] - brick.low[k];
    let step = if cut == Cut::Whole { [extent(u).max(1), extent(v).max(1)] } else { [1, 1] };
    for i in 0..extent(u) / step[0] {
        for j in 0..extent(v) / step[1] {
            let mut low = brick.low;
            low[axis] = if upper { brick.high[axis] } else { brick.low[axis] };
            low[u] += i;
            low[v] += j;
            let first = mesh.vertices.len() as u32;
            for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                let mut corner = low;
                corner[u] += x * step[0];
                corner[v] += y * step[1];
                mesh.vertices.push(corner.map(|x| x as f64));
            }
            let rises = match cut {
                Cut::AsLattice => (low[0] + low[1] + low[2] + axis as i64) % 2 == 0,
                Cut::ByChance | Cut::Whole => rng.one_in(2),
            };
            let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + corner);
            let halves = if rises { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            let outward = upper != brick.inside_out;
            mesh.faces.extend(halves.map(|[p, q, r]| if outward { [p, q, r] } else { [p, r, q] }));
        }
    }
}

/// Returns the winding number of each cell of the lattice, by its smallest corner. Cells with zero
/// are omitted.
pub fn windings(bricks: &[Brick]) -> BTreeMap<[i64; 3], i64> {
    let mut windings = BTreeMap::new();
    for brick in bricks {
        for x in brick.low[0]..brick.high[0] {
            for y in brick.low[1]..brick.high[1] {
                for z in brick.low[2]..brick.high[2] {
                    *windings.entry([x, y, z]).or_insert(0) += if brick.inside_out { -1 } else { 1 };
                }
            }
        }
    }
    windings.retain(|_, times| *times != 0);
    windings
}

impl Scene {
    /// Reports whether the interiors of the two sets intersect.
    pub fn penetrates(&self) -> bool {
        self.cells_are_nearer_than(2)
    }

    /// Reports whether a cell inside the first set has a point in common with one inside the
    /// second.
    pub fn touches(&self) -> bool {
        self.cells_are_nearer_than(3)
    }

    /// Reports whether a cell of one set is less than `half_units` from a cell of the other along
    /// every axis.
    fn cells_are_nearer_than(&self, half_units: i64) -> bool {
        let [a, b] = [0, 1].map(|side| windings(&self.bricks[side]));
        a.keys()
            .any(|p| b.keys().any(|q| (0..3).all(|k| (2 * p[k] - 2 * q[k] - self.half_steps[k]).abs() < half_units)))
    }

    /// Returns a random scene: floors of bricks, heaps of boxes and membranes, unit cubes that
    /// share edges and corners, or hollow boxes. A few are large.
    pub fn random(rng: &mut Rng) -> Self {
        let large = rng.one_in(80);
        let mut step = |sparse: u64| if rng.one_in(sparse) { rng.integer(-3, 3) } else { 2 * rng.integer(-2, 2) };
        let half_steps = [step(6), step(6), step(6)];
        let bricks = match rng.integer(0, 3) {
            0 => return Self::floors(rng, large),
            1 => [0, 1].map(|_| heap(rng)),
            2 => [0, 1].map(|_| scattered(rng, large)),
            _ => [hollow(rng), heap(rng)],
        };
        Self { bricks, half_steps }
    }

    /// Returns two floors of unit bricks, the second one beside, on or in the first.
    fn floors(rng: &mut Rng, large: bool) -> Self {
        let mut floor = || {
            let [length, width] = [0, 1].map(|_| if large { rng.integer(3, 4) } else { rng.integer(1, 2) });
            (0..length * width).map(|i| Brick::unit([i / width, i % width, 0])).collect()
        };
        let bricks = [floor(), floor()];
        let half_steps = [rng.integer(-1, 2), rng.integer(-1, 2), rng.choose(&[0, 1, 2, 2, 2, 2, -2, -2])];
        Self { bricks, half_steps }
    }
}

/// Returns boxes at random places, which may overlap and be nested. Some are inside out, some are
/// membranes.
fn heap(rng: &mut Rng) -> Vec<Brick> {
    (0..rng.integer(1, 3))
        .map(|_| {
            let low: [i64; 3] = std::array::from_fn(|_| rng.integer(0, 2));
            let mut high = low.map(|x| x + length(rng));
            if rng.one_in(8) {
                let axis = rng.integer(0, 2) as usize;
                high[axis] = low[axis];
            }
            Brick { low, high, inside_out: rng.one_in(6) }
        })
        .collect()
}

/// Returns the length of a brick along an axis. Most are short, so that scenes take little time.
fn length(rng: &mut Rng) -> i64 {
    if rng.one_in(4) { 2 } else { 1 }
}

/// Returns unit cubes in different places.
fn scattered(rng: &mut Rng, large: bool) -> Vec<Brick> {
    let sparse = if large { 2 } else { 9 };
    let cells = (0..27).map(|i| [i / 9, i / 3 % 3, i % 3]);
    cells.filter(|_| rng.one_in(sparse)).map(Brick::unit).collect()
}

/// Returns a box with a hollow, which may contain a unit cube.
fn hollow(rng: &mut Rng) -> Vec<Brick> {
    let low: [i64; 3] = std::array::from_fn(|_| rng.integer(0, 1));
    let hole = Brick::new(low, low.map(|x| x + length(rng))).turned();
    let margin = |rng: &mut Rng| -> [i64; 3] { std::array::from_fn(|_| i64::from(!rng.one_in(4))) };
    let (below, above) = (margin(rng), margin(rng));
    let wall =
        Brick::new(std::array::from_fn(|k| hole.low[k] - below[k]), std::array::from_fn(|k| hole.high[k] + above[k]));
    let mut bricks = vec![wall, hole];
    if rng.one_in(3) {
        bricks.push(Brick::unit(low));
    }
    bricks
}

/// Returns the same surface with its faces in a random order, each beginning with a random corner.
pub fn reordered(rng: &mut Rng, mut mesh: Mesh) -> Mesh {
    for last in (1..mesh.faces.len()).rev() {
        let other = rng.integer(0, last as i64) as usize;
        mesh.faces.swap(last, other);
        mesh.faces[last].rotate_left(rng.integer(0, 2) as usize);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windings_of_overlapping_bricks_add_up() {
        let shell = [Brick::new([0; 3], [3; 3]), Brick::unit([1; 3]).turned(), Brick::new([0; 3], [2, 2, 0])];
        let windings = windings(&shell);
        assert_eq!((windings.len(), windings.get(&[1; 3])), (26, None));
        assert!(windings.values().all(|&times| times == 1));
    }

    #[test]
    fn cells_distinguish_touching_from_penetrating() {
        let scene = |half_steps| Scene { bricks: [vec![Brick::unit([0; 3])], vec![Brick::unit([0; 3])]], half_steps };
        let answers = |half_steps| (scene(half_steps).penetrates(), scene(half_steps).touches());
        assert_eq!(answers([1, 1, -1]), (true, true));
        assert_eq!(answers([2, 2, -2]), (false, true));
        assert_eq!(answers([3, 0, 0]), (false, false));
    }

    #[test]
    fn each_cut_has_its_number_of_faces() {
        let brick = [Brick::new([0; 3], [2, 1, 1])];
        let faces = |cut| mesh(&mut Rng::new(1), &brick, cut).faces.len();
        assert_eq!([Cut::AsLattice, Cut::ByChance, Cut::Whole].map(faces), [20, 20, 12]);
    }
}
