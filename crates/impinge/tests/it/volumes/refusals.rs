//! Validation of the input of volumes: numbers that are not finite, empty sets, negative sizes, and
//! maps that are not rigid.

use impinge::volume::fit;
use impinge::volume::{BoundingSphere, BoundingVolume, Capsule, CenterRadius, Kdop14, Lozenge, MinMax, MinWidths, Obb};
use impinge::{InputErrorKind, Pose};

fn kind<T: std::fmt::Debug>(result: Result<T, impinge::InputError>) -> InputErrorKind {
    result.unwrap_err().kind().clone()
}

#[test]
fn empty_and_nonfinite_point_sets_are_rejected() {
    let empty = InputErrorKind::Empty { what: "points" };
    fn all(points: &[[f64; 3]]) -> Vec<InputErrorKind> {
        vec![
            kind(MinMax::of_points(points)),
            kind(MinWidths::of_points(points)),
            kind(CenterRadius::of_points(points)),
            kind(BoundingSphere::of_points(points)),
            kind(Capsule::of_points(points)),
            kind(Lozenge::of_points(points)),
            kind(Obb::of_points(points)),
            kind(Kdop14::of_points(points)),
            kind(fit::mean_sphere(points)),
            kind(fit::box_sphere(points)),
            kind(fit::ritter_sphere(points)),
            kind(fit::principal_sphere(points)),
            kind(fit::refined_sphere(points)),
            kind(fit::principal_obb(points)),
        ]
    }
    assert!(all(&[]).iter().all(|kind| *kind == empty));
    // At any index, among any other points.
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at in [0, 5, 8, 40] {
            let mut points = vec![[0.5; 3]; 41];
            points[at][at % 3] = bad;
            let expected = InputErrorKind::NonFinite { what: "vertex", index: at };
            assert!(all(&points).iter().all(|kind| *kind == expected), "{bad} at {at}");
        }
    }
    let far = InputErrorKind::OutOfRange { what: "vertex", index: 1, limit: "2^128" };
    assert!(all(&[[0.0; 3], [0.0, 1e39, 0.0]]).iter().all(|kind| *kind == far));
    assert_eq!(
        kind(fit::minimal_sphere(&[[0.0, f32::NAN, 0.0]])),
        InputErrorKind::NonFinite { what: "vertex", index: 0 }
    );
}

#[test]
fn negative_sizes_are_rejected_and_zero_is_valid() {
    let negative = |what| InputErrorKind::Negative { what, index: 0 };
    assert_eq!(kind(BoundingSphere::new([0.0; 3], -1.0)), negative("radius"));
    assert_eq!(kind(Capsule::new([0.0; 3], [1.0; 3], -f64::MIN_POSITIVE)), negative("radius"));
    assert_eq!(kind(Lozenge::new([0.0; 3], [[1.0; 3]; 2], -1.0)), negative("radius"));
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(kind(Obb::new([0.0; 3], axes, [-1.0, 0.0, 0.0])), negative("half-extent"));
    assert_eq!(kind(MinMax::new([1.0; 3], [0.0; 3])), negative("box extent"));
    assert_eq!(kind(BoundingSphere::new([0.0; 3], f64::NAN)), InputErrorKind::NonFinite { what: "radius", index: 0 });

    let dot = BoundingSphere::new([1.0; 3], 0.0).unwrap();
    let needle = Capsule::new([1.0; 3], [1.0; 3], 0.0).unwrap();
    let flat = Obb::new([1.0; 3], axes, [0.0; 3]).unwrap();
    let point = Lozenge::new([1.0; 3], [[0.0; 3]; 2], 0.0).unwrap();
    assert!(dot.overlaps(&dot) && needle.overlaps(&needle) && flat.overlaps(&flat) && point.overlaps(&point));
    assert!(dot.contains([1.0; 3]) && !dot.contains([1.0, 1.0, 1.0_f64.next_up()]));
    assert!(flat.contains([1.0; 3]) && !flat.contains([1.0, 1.0, 1.1]));
    assert!(needle.contains([1.0; 3]) && !needle.contains([1.0, 1.0, 1.1]));
    assert_eq!(dot.moved(&Pose::IDENTITY).unwrap(), dot);
}

#[test]
fn round_volumes_need_rigid_motions_and_boxes_accept_any_map() {
    let squash = Pose::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]], [0.0; 3]).unwrap();
    let points = [[0.0; 3], [1.0, 2.0, 3.0], [-1.0, 0.5, 0.0], [0.0, 0.0, 4.0]];
    let not_rigid = |kind| matches!(kind, InputErrorKind::NotRigid { deviation } if (0.75..0.751).contains(&deviation));
    assert!(not_rigid(kind(BoundingSphere::of_points(&points).unwrap().moved(&squash))));
    assert!(not_rigid(kind(Capsule::of_points(&points).unwrap().moved(&squash))));
    assert!(not_rigid(kind(Lozenge::of_points(&points).unwrap().moved(&squash))));
    let flat = points.map(|p| squash.apply(p)); // exact
    let obb = Obb::of_points(&points).unwrap().moved(&squash).unwrap();
    let kdop = Kdop14::of_points(&points).unwrap().moved(&squash).unwrap();
    let bounds = MinMax::of_points(&points).unwrap().moved(&squash).unwrap();
    assert!(flat.iter().all(|&p| obb.contains(p) && kdop.contains(p) && bounds.contains(p)));
    assert_eq!(bounds.max(), [1.0, 2.0, 2.0]);

    let slanted = [[1.0, 0.0, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert!(matches!(kind(Obb::new([0.0; 3], slanted, [1.0; 3])), InputErrorKind::NotRigid { .. }));
    let far = Pose::from_translation([1e90, 0.0, 0.0]).unwrap();
    let sphere = BoundingSphere::new([2.135_987e96, 0.0, 0.0], 1.0).unwrap();
    assert!(matches!(kind(sphere.moved(&far)), InputErrorKind::OutOfRange { .. }));
}
