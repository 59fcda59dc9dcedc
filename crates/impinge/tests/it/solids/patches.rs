//! Vertices inside the other mesh that contact patches list, against testing each vertex alone. On
//! grids, corners, edges and faces touch as often as they cross.

use std::collections::{BTreeSet, HashMap};

use impinge::Mesh;
use impinge::mesh::Containment;
use impinge::query;
use impinge_testkit::Affine;
use impinge_testkit::generate::{Rng, poses, solids};

use crate::solids::shapes::{engine, flipped, moved, pose, soup};

/// Returns for each vertex the first vertex at its position.
fn first_at(mesh: &impinge_testkit::Mesh) -> Vec<u32> {
    let mut first: HashMap<[u64; 3], u32> = HashMap::new();
    let of = |(number, v): (u32, &[f64; 3])| *first.entry(v.map(|x| (x + 0.0).to_bits())).or_insert(number);
    (0..).zip(&mesh.vertices).map(of).collect()
}

/// Returns the vertices of the touched faces of `mesh` that are inside `other`. Both meshes are in
/// one frame.
fn truth(mesh: &impinge_testkit::Mesh, other: &Mesh, touched: &BTreeSet<u32>) -> BTreeSet<u32> {
    let first_at = first_at(mesh);
    let corners = touched.iter().flat_map(|&face| mesh.faces[face as usize]);
    let vertices: BTreeSet<u32> = corners.map(|vertex| first_at[vertex as usize]).collect();
    let points: Vec<[f64; 3]> = vertices.iter().map(|&vertex| mesh.vertices[vertex as usize]).collect();
    let at = other.contains(&points).expect("in range");
    vertices.into_iter().zip(at).filter(|(_, at)| *at == Containment::Inside).map(|(vertex, _)| vertex).collect()
}

/// Returns a solid with corners on a grid: a box, two boxes, a shell or a rounded sphere. Some are
/// soups, and some have faces without area.
fn solid(rng: &mut Rng) -> impinge_testkit::Mesh {
    let cuboid = |rng: &mut Rng| {
        let low: [i64; 3] = std::array::from_fn(|_| rng.integer(-3, 1));
        let high: [f64; 3] = std::array::from_fn(|k| (low[k] + rng.integer(1, 4)) as f64);
        solids::cuboid(low.map(|x| x as f64), high)
    };
    let mut mesh = match rng.integer(0, 3) {
        0 => cuboid(rng),
        1 => cuboid(rng).joined(&cuboid(rng)),
        2 => solids::cuboid([-3.0; 3], [3.0; 3]).joined(&flipped(solids::cuboid([-2.0; 3], [2.0; 3]))),
        // The corners of a finely divided cube, moved to small integers.
        _ => {
            let mut ball = solids::cube_sphere(4);
            ball.vertices.iter_mut().for_each(|v| *v = v.map(|x| (3.0 * x).round()));
            moved(ball, std::array::from_fn(|_| rng.integer(-2, 2) as f64))
        }
    };
    if rng.one_in(3) {
        let [a, b, _] = mesh.faces[0];
        mesh.faces.extend([[a, b, b], [a, b, a]]);
    }
    if rng.one_in(4) { soup(&mesh) } else { mesh }
}

#[test]
fn patches_list_exactly_the_vertices_inside() {
    let mut rng = Rng::new(591);
    let (mut inside, mut outside, mut patches, mut deeper) = (0, 0, 0, 0);
    for case in 0..600 {
        let plain = [solid(&mut rng), solid(&mut rng)];
        let meshes = plain.each_ref().map(engine);
        // The same pose for both changes no answer.
        let place = if case % 2 == 0 { Affine::IDENTITY } else { poses::rotation(&mut rng) };
        let (a, b) = (meshes[0].at(pose(&place)), meshes[1].at(pose(&place)));
        let found = query::contact_patches(a, b);
        let pairs = query::intersecting_pairs(a, b);
        for side in 0..2 {
            let touched: BTreeSet<u32> = pairs.iter().map(|pair| pair[side]).collect();
            let truth = truth(&plain[side], &meshes[1 - side], &touched);
            let first_at = first_at(&plain[side]);
            let at_curves: BTreeSet<u32> = touched
                .iter()
                .flat_map(|&face| plain[side].faces[face as usize].map(|vertex| first_at[vertex as usize]))
                .collect();
            let listed: BTreeSet<u32> = found.iter().flat_map(|patch| &patch.inside[side]).copied().collect();
            let listed_at_curves: BTreeSet<u32> = listed.intersection(&at_curves).copied().collect();
            assert_eq!(listed_at_curves, truth, "{case} {side} {plain:?}");
            // Vertices connected with them are inside too.
            let points: Vec<[f64; 3]> = listed.iter().map(|&vertex| plain[side].vertices[vertex as usize]).collect();
            let all = meshes[1 - side].contains(&points).expect("in range");
            assert!(all.iter().all(|at| *at == Containment::Inside), "{case} {side} {plain:?}");
            inside += truth.len();
            outside += at_curves.len() - truth.len();
            deeper += listed.len() - truth.len();
        }
        patches += found.len();
    }
    assert!(inside > 1000 && outside > 5000 && patches > 500 && deeper > 20, "{inside} {outside} {patches} {deeper}");
}
