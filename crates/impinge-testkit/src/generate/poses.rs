//! Affine maps that are hard for floats but keep answers.
//!
//! An invertible map applied to both triangles of a pair does not change whether they intersect. So
//! answers known in small integers stay known, although the images need hundreds of bits.

use super::Rng;
use crate::Affine;

/// Returns an invertible map with integer entries up to 2^20, which may mirror and shear, and a
/// translation of integers up to 2^20.
pub fn large_integer_map(rng: &mut Rng) -> Affine {
    const LARGEST: i64 = 1 << 20;
    loop {
        let m: [[i64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| rng.integer(-LARGEST, LARGEST)));
        let translation = std::array::from_fn(|_| rng.integer(-LARGEST, LARGEST) as f64);
        if determinant(m) != 0 {
            return Affine::new(m.map(|row| row.map(|x| x as f64)), translation);
        }
    }
}

/// Returns a rotation and a translation.
///
/// The rotation is that of a quaternion of integers up to 1000, with each entry rounded once from
/// its rational value. The coordinates of the translation are f64 numbers between -10 and 10.
pub fn rotation(rng: &mut Rng) -> Affine {
    loop {
        let [w, x, y, z]: [i64; 4] = std::array::from_fn(|_| rng.integer(-1000, 1000));
        let norm = w * w + x * x + y * y + z * z;
        if norm == 0 {
            continue;
        }
        let linear = [
            [norm - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), norm - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), norm - 2 * (x * x + y * y)],
        ];
        let translation = std::array::from_fn(|_| rng.uniform(-10.0, 10.0));
        return Affine::new(linear.map(|row| row.map(|entry| entry as f64 / norm as f64)), translation);
    }
}

/// Returns a symmetry of the cube, possibly a mirror: it permutes coordinates and flips their
/// signs. Its inverse is its transpose.
pub fn cube_symmetry(rng: &mut Rng) -> [[f64; 3]; 3] {
    let order = rng.choose(&[[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]);
    let mut rows = [[0.0; 3]; 3];
    for k in 0..3 {
        rows[k][order[k]] = rng.choose(&[-1.0, 1.0]);
    }
    rows
}

fn determinant(m: [[i64; 3]; 3]) -> i128 {
    let [a, b, c] = m.map(|row| row.map(i128::from));
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_their_documented_entries() {
        let mut rng = Rng::new(4);
        for _ in 0..200 {
            let map = large_integer_map(&mut rng);
            let entries = map.linear.as_flattened().iter().chain(&map.translation);
            assert!(entries.clone().all(|x| x.fract() == 0.0 && x.abs() <= f64::from(1 << 20)));
            let r = rotation(&mut rng).linear;
            for i in 0..3 {
                for j in 0..3 {
                    let product: f64 = (0..3).map(|k| r[i][k] * r[j][k]).sum();
                    assert!((product - f64::from(i == j)).abs() < 1e-15);
                }
            }
            let s = cube_symmetry(&mut rng);
            assert!((0..3).all(|k| s[k].map(f64::abs).iter().sum::<f64>() == 1.0));
        }
    }
}
