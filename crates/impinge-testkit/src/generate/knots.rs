//! Bumpy torus knot and the other meshes of the headline benchmark.
//!
//! A NumPy script makes the same meshes, so that other engines can be compared on them. Its tangent
//! is a difference over 2e-4, which magnifies the last bit of a cosine ten thousand times. So a
//! vertex here lies within 2e-12 of the script's, and is not equal to it. These bytes are the same
//! on every machine, and the script's are not.

use super::{Rng, cos, sin, solids::cube_sphere};
use crate::Mesh;
use std::f64::consts::TAU;

/// Shape of a tube around a torus knot.
#[derive(Clone, Copy, Debug)]
pub struct Knot {
    /// Number of turns around the axis.
    pub p: f64,
    /// Number of turns through the hole.
    pub q: f64,
    /// Radius of the tube. The knot's center line is between 1 and 3 from the axis.
    pub radius: f64,
    /// Height of the bumps as a fraction of the radius.
    pub bump: f64,
}

/// Knot of the benchmark.
pub const TREFOIL: Knot = Knot { p: 2.0, q: 3.0, radius: 0.4, bump: 0.03 };

/// Returns a closed bumpy tube around a torus knot: `along * around` vertices, and twice as many
/// faces.
pub fn torus_knot(along: u32, around: u32, knot: Knot) -> Mesh {
    let mut vertices = Vec::with_capacity(along as usize * around as usize);
    let circle: Vec<[f64; 3]> = (0..around)
        .map(|j| {
            let v = f64::from(j) * (TAU / f64::from(around));
            [cos(v), sin(v), sin(6.0 * v)]
        })
        .collect();
    for i in 0..along {
        let u = f64::from(i) * (TAU / f64::from(along));
        let frame = knot.frame(u);
        let wave = sin(40.0 * u);
        vertices.extend(circle.iter().map(|&[cosine, sine, bump]| {
            let radius = knot.radius * (1.0 + knot.bump * wave * bump);
            std::array::from_fn(|k| frame.center[k] + radius * (cosine * frame.normal[k] + sine * frame.binormal[k]))
        }));
    }
    let corners = |which: fn([u32; 4]) -> [u32; 3]| {
        (0..along).flat_map(move |i| (0..around).map(move |j| (i, j))).map(move |(i, j)| {
            let (next_i, next_j) = ((i + 1) % along, (j + 1) % around);
            which([i * around + j, next_i * around + j, next_i * around + next_j, i * around + next_j])
        })
    };
    let faces = corners(|[a, b, c, _]| [a, b, c]).chain(corners(|[a, _, c, d]| [a, c, d])).collect();
    Mesh { vertices, faces }
}

/// Returns the adversarial mesh: the knot shrunk to 0.001 at the middle of the unit box, and
/// `slivers` long thin triangles across it.
///
/// Against itself moved by (0.0006, 0.0004, 0.0005), every hierarchy of axis-aligned boxes prunes
/// almost nothing.
pub fn stadium(along: u32, around: u32, slivers: usize) -> Mesh {
    let mut mesh = torus_knot(along, around, TREFOIL);
    mesh.vertices.iter_mut().flatten().for_each(|x| *x = *x * 1e-3 + 0.5);
    // The state of NumPy's default_rng(7).
    let mut rng = Rng::from_state(
        208_745_520_555_909_116_978_795_849_195_383_758_904,
        261_136_684_632_268_670_825_940_853_076_396_136_793,
    );
    let mut points = || (0..slivers).map(|_| std::array::from_fn(|_| rng.unit())).collect::<Vec<[f64; 3]>>();
    let (starts, ends) = (points(), points());
    for (start, end) in starts.into_iter().zip(ends) {
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend([start, end, [end[0] + 0.003, end[1] + 0.002, end[2]]]);
        mesh.faces.push([first, first + 1, first + 2]);
    }
    mesh
}

/// Returns the near-coincident worst case: a bumpy sphere of `12 * n * n` faces, to be turned by
/// 0.01 rad against itself.
pub fn bumpy_sphere(n: u32) -> Mesh {
    let mut mesh = cube_sphere(n);
    for v in &mut mesh.vertices {
        let height = 1.0 + 0.05 * sin(7.0 * v[0]) * sin(9.0 * v[1]) * sin(8.0 * v[2]);
        *v = v.map(|x| x * height);
    }
    mesh
}

struct Frame {
    center: [f64; 3],
    normal: [f64; 3],
    binormal: [f64; 3],
}

impl Knot {
    fn center(self, u: f64) -> [f64; 3] {
        let k = 2.0 + cos(self.q * u);
        [k * cos(self.p * u), k * sin(self.p * u), sin(self.q * u)]
    }

    fn frame(self, u: f64) -> Frame {
        let center = self.center(u);
        let (after, before) = (self.center(u + 1e-4), self.center(u - 1e-4));
        let tangent = unit(std::array::from_fn(|k| after[k] - before[k]));
        let outward = unit([center[0], center[1], 0.0]);
        let lean = outward[0] * tangent[0] + outward[1] * tangent[1] + outward[2] * tangent[2];
        let normal = unit(std::array::from_fn(|k| outward[k] - lean * tangent[k]));
        let binormal = std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            tangent[i] * normal[j] - tangent[j] * normal[i]
        });
        Frame { center, normal, binormal }
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks vertices against those of the NumPy script's meshes.
    fn assert_near(mesh: &Mesh, expected: &[(usize, [f64; 3])], tolerance: f64) {
        for &(i, p) in expected {
            for k in 0..3 {
                let off = (mesh.vertices[i][k] - p[k]).abs();
                assert!(off <= tolerance, "vertex {i}: {:?} is off by {off:e}", mesh.vertices[i]);
            }
        }
    }

    #[test]
    fn the_knot_agrees_with_the_script() {
        let mesh = torus_knot(20, 20, TREFOIL);
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (400, 800));
        let faces = [0, 19, 399, 400, 799].map(|i| mesh.faces[i]);
        assert_eq!(faces, [[0, 20, 21], [19, 39, 20], [399, 19, 0], [0, 21, 1], [399, 0, 380]]);
        let expected = [
            (0, [3.4, 0.0, 0.0]),
            (1, [3.3804226065180614, 0.055278640744823616, -0.1105572807525987]),
            (57, [0.36143463405185366, 1.8523275439171256, 1.2239227206802805]),
            (210, [0.6, -2.178614786215117e-16, 3.8543929484523203e-16]),
            (399, [2.2655585498667627, -1.8758829257032528, -0.7417906029981958]),
        ];
        assert_near(&mesh, &expected, 2e-12);
    }

    #[test]
    fn the_large_knot_agrees_with_the_script() {
        let mesh = torus_knot(2000, 500, TREFOIL);
        assert_eq!(mesh.faces.len(), 2_000_000);
        assert_eq!(mesh.faces[1_999_999], [999_999, 0, 999_500]);
        let expected = [
            (0, [3.4, 0.0, 0.0]),
            (123_456, [-0.23562681626090806, 1.6099434013633267, 0.7847942706701209]),
            (999_999, [3.3999430155877626, -0.02511956916366541, -0.005681691512788755]),
        ];
        assert_near(&mesh, &expected, 2e-12);
    }

    #[test]
    fn the_stadium_agrees_with_the_script() {
        let mesh = stadium(20, 20, 300);
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (1300, 1100));
        assert_eq!([mesh.faces[800], mesh.faces[1099]], [[400, 401, 402], [1297, 1298, 1299]]);
        assert_near(&mesh, &[(399, [0.5022655585498668, 0.49812411707429677, 0.49925820939700183])], 1e-14);
        let slivers = [
            (400, [0.625095466604667, 0.8972138009695755, 0.7756856902451935]),
            (401, [0.26030606683003477, 0.5836415158658145, 0.9522319384229335]),
            (402, [0.26330606683003477, 0.5856415158658145, 0.9522319384229335]),
            (1299, [0.9312961266331786, 0.8365574368742619, 0.14305165833239908]),
        ];
        assert_near(&mesh, &slivers, 0.0);
    }

    #[test]
    fn the_bumpy_sphere_agrees_with_the_script() {
        let mesh = bumpy_sphere(8);
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (486, 768));
        let faces = [0, 63, 64, 767].map(|i| mesh.faces[i]);
        assert_eq!(faces, [[0, 9, 10], [70, 79, 80], [0, 10, 1], [475, 485, 476]]);
        let expected = [
            (0, [-0.5574221850705778, -0.5574221850705778, 0.5574221850705778]),
            (1, [-0.6208501769458549, -0.41483882558363705, 0.6208501769458549]),
            (100, [-0.5253061941524078, -0.3256448764870592, -0.7861762773323695]),
            (250, [-0.6208501769458549, 0.41483882558363705, -0.6208501769458549]),
            (485, [0.5972783533086738, -0.5972783533086738, 0.5972783533086738]),
        ];
        assert_near(&mesh, &expected, 1e-15);
    }

    #[test]
    fn bytes_are_the_same_everywhere() {
        assert_eq!(torus_knot(20, 20, TREFOIL).fingerprint(), 0x2418_b89a_4c79_ee83);
        assert_eq!(stadium(20, 20, 300).fingerprint(), 0xb3f0_7885_b1f6_200b);
        assert_eq!(bumpy_sphere(8).fingerprint(), 0x43de_faf3_64b0_7f82);
    }
}
