//! Self-intersections of meshes, against linear programming on each pair of faces.

use impinge::query;
use impinge_testkit::generate::{Rng, knots, solids};
use impinge_testkit::oracle::triangles_meet;
use impinge_testkit::{Affine, Mesh};

use crate::solids::shapes::{engine, moved, soup, sphere};

type Triangle = [[f64; 3]; 3];

fn intersect(a: Triangle, b: Triangle) -> bool {
    triangles_meet(&a, &Affine::IDENTITY, &b, &Affine::IDENTITY)
}

/// Returns `p + t (q - p)`.
fn between(p: [f64; 3], q: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|k| p[k] + t * (q[k] - p[k]))
}

/// Reports whether two triangles with small integer coordinates intersect beyond the hull of their
/// common corners, by tests of other triangles.
fn intersect_beyond_shared(a: Triangle, b: Triangle) -> bool {
    let mut shared: Vec<[f64; 3]> = a.iter().copied().filter(|corner| b.contains(corner)).collect();
    shared.sort_by(|x, y| x.partial_cmp(y).expect("finite"));
    shared.dedup();
    let others = |own: Triangle| own.into_iter().filter(|corner| !shared.contains(corner)).collect::<Vec<_>>();
    match shared[..] {
        [] => intersect(a, b),
        [v] => {
            // A ray from the corner within both triangles leaves `a` through an edge or point
            // opposite. The cone of `b` is `b` scaled up.
            let cone = |own: Triangle| own.map(|corner| between(v, corner, 4096.0));
            let through = |own: Triangle, other: Triangle| match others(own)[..] {
                [p, q] if !intersect([p, q, q], [v; 3]) => intersect([p, q, q], cone(other)),
                ref points => points.iter().any(|&p| intersect([p; 3], cone(other))),
            };
            through(a, b) || through(b, a)
        }
        [v, w] => others(a).into_iter().any(|r| {
            [v, w, between(v, w, 0.5)].into_iter().any(|from| {
                let near = between(from, r, 2.0_f64.powi(-16));
                intersect([near; 3], b) && !intersect([near; 3], [v, w, w])
            })
        }),
        _ => false,
    }
}

fn brute_force(mesh: &Mesh) -> Vec<[u32; 2]> {
    let triangle = |face: u32| mesh.at(Affine::IDENTITY).triangle(face as usize);
    let count = mesh.faces.len() as u32;
    let apart = |a: &Triangle, b: &Triangle| {
        (0..3)
            .any(|k| a.iter().all(|p| b.iter().all(|q| p[k] < q[k])) || a.iter().all(|p| b.iter().all(|q| p[k] > q[k])))
    };
    (0..count)
        .flat_map(|i| (i + 1..count).map(move |j| [i, j]))
        .filter(|&[i, j]| {
            let (a, b) = (triangle(i), triangle(j));
            !apart(&a, &b) && intersect_beyond_shared(a, b)
        })
        .collect()
}

#[test]
fn soups_on_the_grid_have_the_self_intersections_of_brute_force() {
    let mut rng = Rng::new(21);
    let (mut reported, mut neighbors) = (0, 0);
    for side in [2, 3, 4, 6, 9] {
        let mesh = solids::grid_soup(&mut rng, 50, side, 2);
        let expected = brute_force(&mesh);
        assert_eq!(query::self_intersecting_pairs(&engine(&mesh)), expected);
        assert_eq!(query::self_intersecting_pairs(&engine(&soup(&mesh))), expected, "each face with its own vertices");
        let touching = query::intersecting_pairs(&engine(&mesh), &engine(&mesh));
        neighbors += touching.iter().filter(|[i, j]| i < j).count() - expected.len();
        reported += expected.len();
    }
    assert!(reported > 300 && neighbors > 300, "{reported} reported, {neighbors} not");
}

#[test]
fn clean_meshes_do_not_intersect_themselves() {
    let knot = knots::torus_knot(200, 24, knots::TREFOIL);
    for mesh in [sphere(), knot, solids::cuboid([0.0; 3], [1.0; 3]), solids::plane_grid(20, 20), solids::fan(200)] {
        assert_eq!(query::self_intersecting_pairs(&engine(&mesh)), Vec::<[u32; 2]>::new());
        assert_eq!(query::self_intersecting_pairs(&engine(&soup(&mesh))), Vec::<[u32; 2]>::new());
    }
}

#[test]
fn two_parts_intersect_in_the_pairs_of_two_meshes() {
    let (one, other) = (sphere(), moved(sphere(), [0.7, 0.3, 0.1]));
    let offset = one.faces.len() as u32;
    let expected: Vec<[u32; 2]> =
        query::intersecting_pairs(&engine(&one), &engine(&other)).into_iter().map(|[a, b]| [a, b + offset]).collect();
    assert!(expected.len() > 30, "{}", expected.len());
    assert_eq!(query::self_intersecting_pairs(&engine(&one.joined(&other))), expected);
}

#[test]
fn copies_of_a_face_are_no_self_intersection() {
    let cube = solids::cuboid([0.0; 3], [1.0; 3]);
    assert_eq!(query::self_intersecting_pairs(&engine(&cube.clone().joined(&cube))), Vec::<[u32; 2]>::new());
}

#[test]
fn an_empty_mesh_does_not_intersect_itself() {
    assert_eq!(query::self_intersecting_pairs(&engine(&Mesh::default())), Vec::<[u32; 2]>::new());
}

#[test]
fn threads_change_no_self_intersection() {
    let mesh = engine(&solids::grid_soup(&mut Rng::new(4), 3000, 20, 3));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| query::self_intersecting_pairs(&mesh))
    };
    let pairs = on(1);
    assert!(pairs.len() > 1000 && pairs == on(2) && pairs.is_sorted());
}
