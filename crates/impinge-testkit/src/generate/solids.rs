//! Generators of spheres, boxes, grids, fans, rods and soups.

use super::{Rng, cos, sin};
use crate::Mesh;
use std::collections::BTreeMap;

/// Returns the unit icosphere of `20 * 4^subdivisions` faces.
///
/// Each subdivision cuts every face of an icosahedron into four and moves the vertices to the
/// sphere. Vertices and faces are numbered as in trimesh's `icosphere`.
pub fn icosphere(subdivisions: u32) -> Mesh {
    const FACES: [[u32; 3]; 20] = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    let (s, l) = (0.525_731_112_119_133_6, 0.850_650_808_352_04);
    let vertices = vec![
        [-s, l, 0.0],
        [s, l, 0.0],
        [-s, -l, 0.0],
        [s, -l, 0.0],
        [0.0, -s, l],
        [0.0, s, l],
        [0.0, -s, -l],
        [0.0, s, -l],
        [l, 0.0, -s],
        [l, 0.0, s],
        [-l, 0.0, -s],
        [-l, 0.0, s],
    ];
    let mut mesh = Mesh { vertices, faces: FACES.to_vec() };
    for _ in 0..subdivisions {
        mesh = cut_in_four(&mesh);
        for v in &mut mesh.vertices {
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            *v = v.map(|x| x + x / length * (1.0 - length));
        }
    }
    mesh
}

/// Returns the cube sphere of `12 * n * n` faces: six grids of equal angles, whose seams do not
/// share vertices.
pub fn cube_sphere(n: u32) -> Mesh {
    let tangent = |i: u32| {
        let x = if i == n { 1.0 } else { f64::from(i) * (2.0 / f64::from(n)) - 1.0 };
        let angle = std::f64::consts::FRAC_PI_4 * x;
        sin(angle) / cos(angle)
    };
    let one = tangent(n);
    let mut mesh = Mesh::default();
    for side in 0..6 {
        let mut points = Vec::new();
        for i in 0..=n {
            for j in 0..=n {
                let (x, y, o) = (tangent(i), tangent(j), one);
                let p = [[x, y, o], [y, x, -o], [o, x, y], [-o, y, x], [y, o, x], [x, -o, y]][side];
                let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
                points.push(p.map(|c| c / length));
            }
        }
        let offset = mesh.vertices.len() as u32;
        mesh.vertices.extend(points);
        let corners = |shift: fn(u32, u32) -> [u32; 3]| {
            (0..n * n).map(move |c| shift(offset + c / n * (n + 1) + c % n, n)).collect::<Vec<_>>()
        };
        mesh.faces.extend(corners(|a, n| [a, a + n + 1, a + n + 2]));
        mesh.faces.extend(corners(|a, n| [a, a + n + 2, a + 1]));
    }
    mesh
}

/// Returns the box between two corners: eight vertices, and twelve faces oriented outward.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { low[k] } else { high[k] });
    let faces = vec![
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    Mesh { vertices: (0..8).map(corner).collect(), faces }
}

/// Returns the tetrahedron of the origin and the three unit points, oriented outward.
pub fn tetrahedron() -> Mesh {
    let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Mesh { vertices, faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }
}

/// Returns the flat grid of `2 * nx * ny` halves of unit squares in z = 0, starting at the origin.
/// All coordinates are integers.
pub fn plane_grid(nx: u32, ny: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=ny {
        for i in 0..=nx {
            mesh.vertices.push([f64::from(i), f64::from(j), 0.0]);
        }
    }
    for j in 0..ny {
        for i in 0..nx {
            let a = j * (nx + 1) + i;
            mesh.faces.extend([[a, a + 1, a + nx + 2], [a, a + nx + 2, a + nx + 1]]);
        }
    }
    mesh
}

/// Returns `n` slender triangles around the origin in z = 0, with corners on the unit circle. All
/// share vertex 0.
pub fn fan(n: u32) -> Mesh {
    let mut mesh = Mesh { vertices: vec![[0.0; 3]], faces: Vec::new() };
    for i in 0..n {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        mesh.vertices.push([cos(angle), sin(angle), 0.0]);
        mesh.faces.push([0, 1 + i, 1 + (i + 1) % n]);
    }
    mesh
}

/// Returns a rod along x from -10 to 10, of radius 1: `2 * facets` slivers, each as long as the
/// rod. Its ends are open.
pub fn rod(facets: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..facets {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(facets);
        mesh.vertices.extend([-10.0, 10.0].map(|x| [x, cos(angle), sin(angle)]));
        let (a, b) = (2 * i, 2 * ((i + 1) % facets));
        mesh.faces.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    }
    mesh
}

/// Returns `n` upright strips along x from -4n to 4n, at y = 0, 1, 2 and so on, from z = 0 to 1.
/// All coordinates are integers.
pub fn strips(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let end = 4.0 * f64::from(n);
    for i in 0..n {
        let (y, first) = (f64::from(i), 4 * i);
        mesh.vertices.extend([[-end, y, 0.0], [end, y, 0.0], [end, y, 1.0], [-end, y, 1.0]]);
        mesh.faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

/// Returns `count` triangles with corners on the integer grid of the cube from 0 to `side`.
///
/// The corners of a triangle differ from its first corner by at most `reach` along each axis. Some
/// triangles are segments or points. Equal corners share a vertex.
pub fn grid_soup(rng: &mut Rng, count: usize, side: i64, reach: i64) -> Mesh {
    let mut mesh = Mesh::default();
    let mut numbers: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    for _ in 0..count {
        let first: [i64; 3] = std::array::from_fn(|_| rng.integer(0, side));
        let face = std::array::from_fn(|corner| {
            let p = first.map(|x| if corner == 0 { x } else { (x + rng.integer(-reach, reach)).clamp(0, side) });
            *numbers.entry(p).or_insert_with(|| {
                mesh.vertices.push(p.map(|x| x as f64));
                mesh.vertices.len() as u32 - 1
            })
        });
        mesh.faces.push(face);
    }
    mesh
}

/// Returns the mesh with each face cut at the midpoints of its edges. New vertices follow the old
/// ones in the order of their edges (larger end, smaller end).
fn cut_in_four(mesh: &Mesh) -> Mesh {
    let edge = |a: u32, b: u32| (a.max(b), a.min(b));
    let mut middles: BTreeMap<(u32, u32), u32> = mesh
        .faces
        .iter()
        .flat_map(|f| [edge(f[0], f[1]), edge(f[1], f[2]), edge(f[2], f[0])])
        .map(|e| (e, 0))
        .collect();
    let mut vertices = mesh.vertices.clone();
    for (&(a, b), number) in &mut middles {
        *number = vertices.len() as u32;
        let (p, q) = (mesh.vertices[a as usize], mesh.vertices[b as usize]);
        vertices.push(std::array::from_fn(|k| (p[k] + q[k]) / 2.0));
    }
    let faces = mesh
        .faces
        .iter()
        .flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middles[&edge(a, b)], middles[&edge(b, c)], middles[&edge(c, a)]);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        })
        .collect();
    Mesh { vertices, faces }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Checks that the half-edges of a closed mesh come in opposite pairs, and that its enclosed
    /// volume is positive.
    fn assert_closed_and_outward(mesh: &Mesh) {
        let half_edges: BTreeSet<(u32, u32)> =
            mesh.faces.iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]).collect();
        assert_eq!(half_edges.len(), 3 * mesh.faces.len());
        assert!(half_edges.iter().all(|&(i, j)| half_edges.contains(&(j, i))));
        let volume: f64 = mesh
            .faces
            .iter()
            .map(|face| {
                let [a, b, c] = face.map(|i| mesh.vertices[i as usize]);
                (0..3).map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3])).sum::<f64>()
            })
            .sum();
        assert!(volume > 0.0);
    }

    #[test]
    fn icospheres_equal_those_of_trimesh() {
        let mesh = icosphere(4);
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (2562, 5120));
        let faces = [0, 777, 5119].map(|i| mesh.faces[i]);
        assert_eq!(faces, [[0, 2102, 758], [1826, 464, 1824], [1774, 1787, 1785]]);
        let expected = [
            (12, [0.0, 1.0, 0.0]),
            (700, [0.2737066791071817, -0.7857149756240464, 0.5547401471790395]),
            (2561, [-0.9416180563510771, -0.33414006364372756, 0.04130198326697533]),
        ];
        for (i, p) in expected {
            assert!((0..3).all(|k| (mesh.vertices[i][k] - p[k]).abs() <= 3e-16), "{:?}", mesh.vertices[i]);
        }
        assert_closed_and_outward(&mesh);
    }

    #[test]
    fn solids_are_closed() {
        assert_closed_and_outward(&cuboid([-1.0, 2.0, 3.0], [0.0, 4.0, 7.0]));
        assert_closed_and_outward(&tetrahedron());
        assert_closed_and_outward(&icosphere(0));
    }

    #[test]
    fn grids_fans_and_soups_have_their_documented_faces() {
        let grid = plane_grid(3, 2);
        assert_eq!((grid.vertices.len(), grid.faces.len()), (12, 12));
        assert_eq!(grid.faces[..2], [[0, 1, 5], [0, 5, 4]]);
        assert_eq!(fan(5).faces[4], [0, 5, 1]);
        let soup = grid_soup(&mut Rng::new(3), 500, 8, 3);
        let degenerate = soup.faces.iter().filter(|f| f[0] == f[1] || f[1] == f[2] || f[2] == f[0]).count();
        assert_eq!(soup.faces.len(), 500);
        assert!(soup.vertices.len() < 729 && degenerate > 0 && degenerate < 50, "{degenerate}");
    }
}
