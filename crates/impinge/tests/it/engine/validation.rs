//! Validation of meshes: invalid arrays are rejected with the index, and unusual but valid arrays
//! are accepted.

use impinge::{InputErrorKind, Mesh, Positions, query};

fn kind(positions: Positions, faces: Vec<[u32; 3]>) -> InputErrorKind {
    Mesh::new(positions, faces).expect_err("a bad mesh").kind().clone()
}

const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn nonfinite_coordinates_are_rejected_by_vertex() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut vertices = TRIANGLE.to_vec();
        vertices[2][1] = bad;
        let narrow = Positions::F32(vertices.iter().map(|v| v.map(|x| x as f32)).collect());
        let expected = InputErrorKind::NonFinite { what: "vertex", index: 2 };
        assert_eq!(kind(Positions::F64(vertices), vec![[0, 1, 2]]), expected);
        assert_eq!(kind(narrow, vec![[0, 1, 2]]), expected);
    }
}

#[test]
fn coordinates_beyond_the_limit_are_rejected() {
    let mut vertices = TRIANGLE.to_vec();
    vertices[1][0] = 2.0_f64.powi(128);
    assert!(matches!(
        kind(Positions::F64(vertices.clone()), vec![[0, 1, 2]]),
        InputErrorKind::OutOfRange { what: "vertex", index: 1, .. }
    ));
    vertices[1][0] = 2.0_f64.powi(128).next_down();
    assert!(Mesh::new(Positions::F64(vertices), vec![[0, 1, 2]]).is_ok());
}

#[test]
fn an_index_out_of_bounds_is_rejected_by_face() {
    let faces = vec![[0, 1, 2], [0, 3, 1]];
    let expected = InputErrorKind::IndexOutOfBounds { face: 1, index: 3, len: 3 };
    assert_eq!(kind(Positions::F64(TRIANGLE.to_vec()), faces), expected);
}

#[test]
fn an_empty_mesh_is_valid_and_intersects_nothing() {
    let triangle = Mesh::new(Positions::F64(TRIANGLE.to_vec()), vec![[0, 1, 2]]).expect("a triangle");
    for positions in [Vec::new(), TRIANGLE.to_vec()] {
        let empty = Mesh::new(Positions::F64(positions), Vec::new()).expect("an empty mesh");
        assert!(!query::intersects(&empty, &triangle));
        assert!(!query::intersects(&triangle, &empty));
        assert!(query::intersecting_pairs(&empty, &empty).is_empty());
    }
}

#[test]
fn doubles_that_single_precision_holds_are_stored_in_single_precision() {
    let mesh = |x: f64| {
        let mut vertices = TRIANGLE.to_vec();
        vertices[1][0] = x;
        Mesh::new(Positions::F64(vertices), vec![[0, 1, 2]]).expect("a mesh")
    };
    assert!(matches!(mesh(0.5).positions(), Positions::F32(_)));
    assert!(matches!(mesh(0.1).positions(), Positions::F64(_)));
}

#[test]
fn many_equal_triangles_build_and_intersect() {
    const COPIES: usize = 20_000;
    let faces = vec![[0, 1, 2]; COPIES];
    let many = Mesh::new(Positions::F64(TRIANGLE.to_vec()), faces).expect("a mesh");
    let one = Mesh::new(Positions::F64(TRIANGLE.to_vec()), vec![[0, 1, 2]]).expect("a mesh");
    assert_eq!(query::intersecting_pairs(&many, &one).len(), COPIES);
}
