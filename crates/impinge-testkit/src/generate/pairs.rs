//! Generators of pairs of triangles that touch, nearly touch, coincide or degenerate. Uniformly
//! random floats almost never do.

use super::{Rng, poses};
use crate::Affine;

/// Two triangles at their poses.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePair {
    /// Family of the pair.
    pub family: Family,
    /// Corners of the first triangle, in its local frame.
    pub a: [[f64; 3]; 3],
    /// Corners of the second triangle, in its local frame.
    pub b: [[f64; 3]; 3],
    /// Pose of the first triangle.
    pub world_from_a: Affine,
    /// Pose of the second triangle.
    pub world_from_b: Affine,
}

/// Family of pairs of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Six corners with integer coordinates from -2 to 2.
    Grid,
    /// Integer corners, one of them in common.
    SharedVertex,
    /// Integer corners, two of them in common.
    SharedEdge,
    /// A corner of b on an edge of a.
    VertexOnEdge,
    /// A corner of b inside a, with b on one side of a.
    VertexInFace,
    /// A touching corner with one coordinate moved to a neighboring float.
    NearMiss,
    /// Both in one plane: overlapping, contained, touching or apart.
    Coplanar,
    /// One or both triangles are segments or points.
    Degenerate,
    /// A needle a million times as long as it is wide, and a small triangle beside it.
    Needle,
    /// The same triangle twice, with its corners in another order.
    Duplicate,
    /// Grid or coplanar pairs scaled by a power of two from 2^-100 to 2^100.
    PowerOfTwo,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 11] = [
        Self::Grid,
        Self::SharedVertex,
        Self::SharedEdge,
        Self::VertexOnEdge,
        Self::VertexInFace,
        Self::NearMiss,
        Self::Coplanar,
        Self::Degenerate,
        Self::Needle,
        Self::Duplicate,
        Self::PowerOfTwo,
    ];

    /// Returns the minimum and maximum fraction of pairs that intersect. The tests of this crate
    /// check it.
    pub fn hit_rate(self) -> (f64, f64) {
        match self {
            Self::Grid | Self::PowerOfTwo | Self::Coplanar | Self::Degenerate | Self::Needle | Self::NearMiss => {
                (0.3, 0.7)
            }
            Self::SharedVertex | Self::SharedEdge | Self::VertexOnEdge | Self::VertexInFace | Self::Duplicate => {
                (1.0, 1.0)
            }
        }
    }
}

/// Returns `count` pairs, cycling through the families. Both poses are the identity.
pub fn tie_heavy(seed: u64, count: usize) -> impl Iterator<Item = TrianglePair> {
    let mut rng = Rng::new(seed);
    (0..count).map(move |i| {
        let family = Family::ALL[i % Family::ALL.len()];
        let (a, b) = corners(family, &mut rng);
        TrianglePair { family, a, b, world_from_a: Affine::IDENTITY, world_from_b: Affine::IDENTITY }
    })
}

/// Returns the pairs of [`tie_heavy`] under [`large_integer_map`](poses::large_integer_map)s.
///
/// Both triangles have the same map, so the answers are those of [`tie_heavy`] for the same seed.
/// Every second b is expressed in another frame, which its pose undoes.
pub fn under_large_integer_maps(seed: u64, count: usize) -> impl Iterator<Item = TrianglePair> {
    under(poses::large_integer_map, seed, count)
}

/// Returns the pairs of [`tie_heavy`] under [`rotation`](poses::rotation)s in the same way, with
/// the same answers.
pub fn under_rotations(seed: u64, count: usize) -> impl Iterator<Item = TrianglePair> {
    under(poses::rotation, seed, count)
}

fn under(map: fn(&mut Rng) -> Affine, seed: u64, count: usize) -> impl Iterator<Item = TrianglePair> {
    let mut rng = Rng::new(!seed);
    tie_heavy(seed, count).enumerate().map(move |(i, pair)| {
        let map = map(&mut rng);
        let posed = TrianglePair { world_from_a: map, world_from_b: map, ..pair };
        if i % 2 == 0 { posed } else { posed.with_b_reframed(poses::cube_symmetry(&mut rng)) }
    })
}

impl TrianglePair {
    /// Returns the same triangles in the world, with b's local coordinates permuted and flipped,
    /// and its pose's columns accordingly.
    fn with_b_reframed(mut self, symmetry: [[f64; 3]; 3]) -> Self {
        let undo = Affine::new(std::array::from_fn(|i| std::array::from_fn(|j| symmetry[j][i])), [0.0; 3]);
        self.b = self.b.map(|corner| undo.apply_rounded(corner));
        let pose = &mut self.world_from_b;
        pose.linear = pose.linear.map(|row| undo.apply_rounded(row));
        self
    }
}

type Point = [i64; 3];
type Triangle = [[f64; 3]; 3];

fn corners(family: Family, rng: &mut Rng) -> (Triangle, Triangle) {
    match family {
        Family::Grid => in_floats(grid_pair(rng)),
        Family::SharedVertex => in_floats(shared(rng, 1)),
        Family::SharedEdge => in_floats(shared(rng, 2)),
        Family::VertexOnEdge => in_floats(touching(rng, [1, 1, 0])),
        Family::VertexInFace => in_floats(touching(rng, [2, 1, 1])),
        Family::NearMiss => near_miss(rng),
        Family::Coplanar => in_floats(coplanar(rng)),
        Family::Degenerate => in_floats(degenerate(rng)),
        Family::Needle => in_floats(needle(rng)),
        Family::Duplicate => in_floats(duplicate(rng)),
        Family::PowerOfTwo => {
            let factor = f64::from_bits(((1023 + rng.integer(-100, 100)) as u64) << 52);
            let (a, b) = in_floats(if rng.one_in(2) { grid_pair(rng) } else { coplanar(rng) });
            let scaled = |triangle: Triangle| triangle.map(|p| p.map(|x| x * factor));
            (scaled(a), scaled(b))
        }
    }
}

fn in_floats((a, b): ([Point; 3], [Point; 3])) -> (Triangle, Triangle) {
    let floats = |triangle: [Point; 3]| triangle.map(|p| p.map(|x| x as f64));
    (floats(a), floats(b))
}

fn grid_point(rng: &mut Rng) -> Point {
    std::array::from_fn(|_| rng.integer(-2, 2))
}

fn grid_triangle(rng: &mut Rng) -> [Point; 3] {
    std::array::from_fn(|_| grid_point(rng))
}

fn grid_pair(rng: &mut Rng) -> ([Point; 3], [Point; 3]) {
    (grid_triangle(rng), grid_triangle(rng))
}

fn shared(rng: &mut Rng, corners: usize) -> ([Point; 3], [Point; 3]) {
    let (a, mut b) = grid_pair(rng);
    b[..corners].copy_from_slice(&a[..corners]);
    (rotated(a, rng), rotated(b, rng))
}

/// Returns a pair with a corner of b at the weighted mean of a's corners, and the other two corners
/// not below a. The sum of the weights must divide 4.
fn touching(rng: &mut Rng, weights: [i64; 3]) -> ([Point; 3], [Point; 3]) {
    let a = grid_triangle(rng).map(|p| p.map(|x| 4 * x));
    let total: i64 = weights.iter().sum();
    let contact: Point = std::array::from_fn(|k| (0..3).map(|i| weights[i] * a[i][k]).sum::<i64>() / total);
    let normal = cross(subtract(a[1], a[0]), subtract(a[2], a[0]));
    let mut above = || {
        let offset = grid_point(rng);
        let up = dot(normal, offset) >= 0;
        std::array::from_fn(|k| contact[k] + if up { offset[k] } else { -offset[k] })
    };
    let b = [contact, above(), above()];
    (rotated(a, rng), b)
}

fn near_miss(rng: &mut Rng) -> (Triangle, Triangle) {
    let (a, mut b) = in_floats(match rng.integer(0, 2) {
        0 => touching(rng, [1, 0, 0]),
        1 => touching(rng, [1, 1, 0]),
        _ => touching(rng, [2, 1, 1]),
    });
    let coordinate = &mut b[0][rng.integer(0, 2) as usize];
    *coordinate = if rng.one_in(2) { coordinate.next_up() } else { coordinate.next_down() };
    (a, b)
}

/// Returns two triangles in the lattice plane of two random vectors.
fn coplanar(rng: &mut Rng) -> ([Point; 3], [Point; 3]) {
    let (p, q) = (grid_point(rng), grid_point(rng));
    let gap = rng.integer(1, 3);
    let mut triangle = |shift: i64| -> [Point; 3] {
        std::array::from_fn(|_| {
            let (x, y) = (rng.integer(-2, 2) + shift, rng.integer(-2, 2));
            std::array::from_fn(|k| x * p[k] + y * q[k])
        })
    };
    (triangle(0), triangle(gap))
}

/// Returns degenerate triangles with integer coordinates from -1 to 1.
///
/// Half of them lie in z = 0, because a point or a segment in space seldom intersects anything.
fn degenerate(rng: &mut Rng) -> ([Point; 3], [Point; 3]) {
    let depth = rng.integer(0, 1);
    let small = |rng: &mut Rng| -> Point { [rng.integer(-1, 1), rng.integer(-1, 1), rng.integer(-depth, depth)] };
    let mut one = |kind: i64| -> [Point; 3] {
        match kind {
            0 => [small(rng); 3],
            1 => {
                let (p, along) = (small(rng), small(rng));
                [0, rng.integer(1, 2), rng.integer(-2, -1)].map(|s| std::array::from_fn(|k| p[k] + s * along[k]))
            }
            _ => std::array::from_fn(|_| small(rng)),
        }
    };
    let (a, b) = (one(1), [one(0), one(1), one(2), one(2)]);
    let b = rng.choose(&b);
    if rng.one_in(2) { (a, b) } else { (b, a) }
}

/// Returns a needle about a million long and one wide, and a triangle with a corner on or near its
/// length.
fn needle(rng: &mut Rng) -> ([Point; 3], [Point; 3]) {
    const STEPS: i64 = 1 << 20;
    let along = loop {
        let along = grid_point(rng);
        if along != [0; 3] {
            break along;
        }
    };
    let start = grid_point(rng);
    let tip: Point = std::array::from_fn(|k| start[k] + STEPS * along[k]);
    let width = grid_point(rng);
    let a = [start, tip, std::array::from_fn(|k| tip[k] + width[k])];
    let at = rng.integer(0, STEPS);
    let b = std::array::from_fn(|_| {
        let beside = grid_point(rng);
        std::array::from_fn(|k| start[k] + at * along[k] + beside[k])
    });
    (rotated(a, rng), b)
}

fn duplicate(rng: &mut Rng) -> ([Point; 3], [Point; 3]) {
    let a = grid_triangle(rng);
    let mut b = rotated(a, rng);
    if rng.one_in(2) {
        b.swap(0, 1);
    }
    (a, b)
}

fn rotated(mut triangle: [Point; 3], rng: &mut Rng) -> [Point; 3] {
    triangle.rotate_left(rng.integer(0, 2) as usize);
    triangle
}

fn subtract(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> i64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::{triangles_meet, triangles_meet_by_clipping};

    fn meets(pair: &TrianglePair) -> bool {
        triangles_meet(&pair.a, &pair.world_from_a, &pair.b, &pair.world_from_b)
    }

    #[test]
    fn two_methods_agree_and_each_family_has_its_hit_rate() {
        let mut hits = [0; Family::ALL.len()];
        let rounds = 500;
        for (i, pair) in tie_heavy(1, rounds * hits.len()).enumerate() {
            let answer = meets(&pair);
            let other = triangles_meet_by_clipping(&pair.a, &pair.world_from_a, &pair.b, &pair.world_from_b);
            assert_eq!(answer, other, "{pair:?}");
            hits[i % Family::ALL.len()] += usize::from(answer);
        }
        let rates = hits.map(|n| n as f64 / rounds as f64);
        for (family, rate) in Family::ALL.into_iter().zip(rates) {
            let (least, most) = family.hit_rate();
            assert!((least..=most).contains(&rate), "{family:?} of {rates:?}");
        }
    }

    #[test]
    fn maps_keep_the_answers_of_sixty_thousand_pairs() {
        let count = 60_000;
        let mut hits = 0;
        let mapped = under_large_integer_maps(2, count).zip(under_rotations(2, count));
        for (pair, (mapped, turned)) in tie_heavy(2, count).zip(mapped) {
            let truth = meets(&pair);
            assert_eq!(meets(&mapped), truth, "{mapped:?}");
            assert_eq!(meets(&turned), truth, "{turned:?}");
            hits += usize::from(truth);
        }
        assert!((0.5..0.8).contains(&(hits as f64 / count as f64)), "{hits}");
    }

    #[test]
    fn two_methods_agree_under_maps_of_their_own() {
        let mut rng = Rng::new(6);
        let mut hits = 0;
        for pair in under_large_integer_maps(3, 2_000) {
            // The same large map for both, except for a rotation with rounded entries: neither tied
            // nor far apart.
            let turn = poses::rotation(&mut rng).linear;
            let b = pair.b.map(|corner| Affine::new(turn, [0.0; 3]).apply_rounded(corner));
            let first = triangles_meet(&pair.a, &pair.world_from_a, &b, &pair.world_from_b);
            let second = triangles_meet_by_clipping(&pair.a, &pair.world_from_a, &b, &pair.world_from_b);
            assert_eq!(first, second, "{pair:?} {turn:?}");
            hits += usize::from(first);
        }
        assert!((300..1_700).contains(&hits), "{hits}");
    }
}
