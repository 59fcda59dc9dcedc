//! Point sets with many degeneracies, and poses that force rounding.

use impinge::Pose;
use impinge_testkit::generate::{Rng, poses};

/// Offsets and sizes from which every generator chooses.
const OFFSETS: [f64; 4] = [0.0, 0.0, 1e7, -1e7 / 3.0];
const SIZES: [f64; 6] = [1.0, 1.0, 1e-6, 1e6, 0.125, 1024.0];

/// Kind of a set of points. Each kind has ties of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Generic,
    /// On a small grid: mostly coplanar, collinear and cospherical.
    Grid,
    /// Three different points, repeated.
    Duplicated,
    Collinear,
    Coplanar,
    /// Exactly on a sphere: permutations and signs of (1, 2, 2) and (0, 0, 3).
    Cospherical,
    /// Exactly on a circle: (3, 4), (0, 5) and their permutations and signs.
    Cocircular,
    /// One point far from all others.
    Outlier,
}

pub(crate) const KINDS: [Kind; 8] = [
    Kind::Generic,
    Kind::Grid,
    Kind::Duplicated,
    Kind::Collinear,
    Kind::Coplanar,
    Kind::Cospherical,
    Kind::Cocircular,
    Kind::Outlier,
];

/// Returns `count` points of a kind, at a random offset and scale.
pub(crate) fn cloud(rng: &mut Rng, kind: Kind, count: usize) -> Vec<[f64; 3]> {
    let offset: [f64; 3] = std::array::from_fn(|_| rng.choose(&OFFSETS));
    let size = rng.choose(&SIZES);
    local_cloud(rng, kind, count).into_iter().map(|p| std::array::from_fn(|k| offset[k] + size * p[k])).collect()
}

fn local_cloud(rng: &mut Rng, kind: Kind, count: usize) -> Vec<[f64; 3]> {
    let any = |rng: &mut Rng| -> [f64; 3] { std::array::from_fn(|_| rng.uniform(-1.0, 1.0)) };
    let grid = |rng: &mut Rng, side: i64| -> [f64; 3] { std::array::from_fn(|_| rng.integer(-side, side) as f64) };
    let (u, v) = (grid(rng, 2), grid(rng, 2));
    let few: Vec<[f64; 3]> = (0..3).map(|_| any(rng)).collect();
    let mut points: Vec<[f64; 3]> = (0..count)
        .map(|_| match kind {
            Kind::Generic | Kind::Outlier => any(rng),
            Kind::Grid => grid(rng, 2),
            Kind::Duplicated => rng.choose(&few),
            Kind::Collinear => {
                let t = rng.integer(-3, 3) as f64;
                u.map(|x| t * x)
            }
            Kind::Coplanar => {
                let (s, t) = (rng.integer(-2, 2) as f64, rng.integer(-2, 2) as f64);
                std::array::from_fn(|k| s * u[k] + t * v[k])
            }
            Kind::Cospherical => shuffled_and_signed(rng, &[[1.0, 2.0, 2.0], [0.0, 0.0, 3.0]]),
            Kind::Cocircular => {
                let [x, y, _] = shuffled_and_signed(rng, &[[3.0, 4.0, 0.0], [5.0, 0.0, 0.0]]);
                let (x, y) = if x * x + y * y == 25.0 { (x, y) } else { (0.0, 5.0) };
                [x, y, 1.0]
            }
        })
        .collect();
    if kind == Kind::Outlier {
        points[count - 1] = any(rng).map(|x| 1e4 * x);
    }
    points
}

fn shuffled_and_signed(rng: &mut Rng, shapes: &[[f64; 3]]) -> [f64; 3] {
    let shape = rng.choose(shapes);
    let order = rng.choose(&[[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]);
    std::array::from_fn(|k| shape[order[k]] * rng.choose(&[-1.0, 1.0]))
}

/// Returns a rigid motion: a translation, a symmetry of the cube, or a rotation, which rounds.
pub(crate) fn motion(rng: &mut Rng) -> Pose {
    let linear = match rng.integer(0, 3) {
        0 => *Pose::IDENTITY.linear(),
        1 => poses::cube_symmetry(rng),
        _ => poses::rotation(rng).linear,
    };
    let far = rng.choose(&[0.0, 1.0, 1e3, 1e7]);
    Pose::new(linear, std::array::from_fn(|_| far * rng.uniform(-1.0, 1.0))).expect("in range")
}
