//! The closest point of a mesh against all its faces in rationals.

use impinge::{InputErrorKind, Mesh, Positions};
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::{grid_soup, icosphere};

use crate::distance::meshes::images;
use crate::distance::oracle::{point, root_is_between, squared_distance};
use crate::distance::ways::engine_mesh;

#[test]
fn the_nearest_of_all_faces_is_found() {
    let mut touching = 0;
    for seed in 0..60 {
        let mut rng = Rng::new(3000 + seed);
        let count = rng.integer(1, 40) as usize;
        let scale = rng.choose(&[1e-6, 1.0, 1e6]);
        let offset = rng.choose(&[0.0, 1e7]) * scale;
        let mut soup = grid_soup(&mut rng, count, 5, 3).scaled(scale);
        soup.vertices.iter_mut().flatten().for_each(|x| *x += offset);
        let faces = images(&soup, &Affine::IDENTITY);
        let mesh = engine_mesh(&soup);
        for _ in 0..6 {
            let reach = rng.choose(&[1.0, 1.0, 1e3]);
            let corner = soup.vertices[rng.integer(0, soup.vertices.len() as i64 - 1) as usize];
            let anywhere = [0; 3].map(|_| rng.integer(-8, 14) as f64 * 0.5 * scale * reach + offset);
            let p = if rng.one_in(3) { corner } else { anywhere };
            let found = mesh.closest_point(p).expect("a legal point").expect("a face");
            let all: Vec<_> = faces.iter().map(|face| squared_distance(&[point(p)], face)).collect();
            let truth = all.iter().min().expect("a face");
            assert!(root_is_between(truth, found.lower, found.upper), "seed {seed}: {found:?}, not √{truth}");
            assert!(root_is_between(&all[found.face as usize], found.lower, found.upper), "seed {seed}: {found:?}");
            let off = squared_distance(&[point(found.point)], &faces[found.face as usize]);
            let allowed = found.upper - found.lower + 4.0 * f64::EPSILON * (offset + 20.0 * scale * reach);
            assert!(root_is_between(&off, 0.0, allowed), "seed {seed}: {found:?} is off its face");
            touching += usize::from(found.lower == 0.0);
        }
    }
    assert!((20..250).contains(&touching), "{touching} of 360 points touch");
}

#[test]
fn many_points_are_answered_as_one_by_one() {
    let mesh = engine_mesh(&icosphere(3));
    let mut rng = Rng::new(8);
    let points: Vec<[f64; 3]> = (0..500).map(|_| [0; 3].map(|_| rng.uniform(-2.0, 2.0))).collect();
    let found = mesh.closest_points(&points).expect("legal points");
    for (p, found) in points.iter().zip(found) {
        assert_eq!(mesh.closest_point(*p).expect("a legal point"), found);
        let radius = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((found.expect("a face").upper - (radius - 1.0).abs()).abs() < 0.02);
    }
}

#[test]
fn invalid_points_are_rejected_and_empty_meshes_have_no_closest_point() {
    let mesh = engine_mesh(&icosphere(1));
    let bad = mesh.closest_points(&[[0.0; 3], [0.0, f64::NAN, 0.0]]).expect_err("not a number");
    assert_eq!(*bad.kind(), InputErrorKind::NonFinite { what: "point", index: 1 });
    assert!(matches!(
        mesh.closest_point([1e100, 0.0, 0.0]).expect_err("too far").kind(),
        InputErrorKind::OutOfRange { what: "point", index: 0, .. }
    ));
    let far = mesh.closest_point([1e90, 0.0, 0.0]).expect("in range").expect("a face");
    assert!((far.upper / 1e90 - 1.0).abs() < 1e-12);
    let empty = Mesh::new(Positions::F64(Vec::new()), Vec::new()).expect("an empty mesh");
    assert_eq!(empty.closest_point([0.0; 3]).expect("a legal point"), None);
}
