//! Batches: many poses in one call are answered as one by one.

use std::sync::atomic::{AtomicUsize, Ordering};

use impinge::budget::{Budget, Stopped};
use impinge::query::batch::{Batch, Broadcast, Execution, Poses, Status};
use impinge::query::{self, ContactOptions, Placed};
use impinge::{Mesh, Pose, Shape};
use impinge_testkit::cases::Precision;
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::cuboid;
use impinge_testkit::rounds;

use crate::engine::ways::engine_mesh;

/// Returns a mesh on the grid, and shapes: the mesh, its solid and others. On a grid of poses, many
/// of them touch.
fn things() -> (Mesh, Vec<Shape>) {
    let mesh = engine_mesh(&cuboid([-1.0; 3], [1.0; 3]), Precision::F64);
    let shapes = vec![
        Shape::from(&mesh),
        Shape::from(mesh.solid()),
        Shape::cuboid([1.0, 0.5, 0.5]).unwrap(),
        Shape::sphere([0.0; 3], 1.0).unwrap(),
        Shape::compound(&[(Shape::cuboid([0.5; 3]).unwrap(), Pose::IDENTITY)]).unwrap(),
    ];
    (mesh, shapes)
}

fn grid_pose(rng: &mut Rng) -> Pose {
    Pose::from_translation([0; 3].map(|_| 0.5 * rng.integer(-5, 5) as f64)).unwrap()
}

/// Returns the leading axes of two operands that broadcast. Some axes are 1 or missing.
fn leading_axes(rng: &mut Rng) -> [Vec<usize>; 2] {
    let full: Vec<usize> = (0..rng.integer(0, 3)).map(|_| rng.integer(1, 4) as usize).collect();
    [0, 1].map(|_| {
        let missing = rng.integer(0, full.len() as i64) as usize;
        full[missing..].iter().map(|&extent| if rng.one_in(3) { 1 } else { extent }).collect()
    })
}

fn poses(rng: &mut Rng, shape: &[usize]) -> Poses {
    let matrices: Vec<[[f64; 4]; 4]> = (0..shape.iter().product())
        .map(|_| {
            let t = *grid_pose(rng).translation();
            [[1.0, 0.0, 0.0, t[0]], [0.0, 1.0, 0.0, t[1]], [0.0, 0.0, 1.0, t[2]], [0.0, 0.0, 0.0, 1.0]]
        })
        .collect();
    Poses::from_matrices(shape, &matrices).unwrap()
}

/// Returns the row of an operand that belongs to a place of the result.
///
/// This is the broadcasting rule of NumPy's manual: axes are aligned at the last one, and axes of
/// length 1 are stretched.
fn source(place: &[usize], shape: &[usize]) -> usize {
    let own = &place[place.len() - shape.len()..];
    own.iter().zip(shape).fold(0, |row, (&at, &extent)| row * extent + if extent == 1 { 0 } else { at })
}

#[test]
fn rows_are_answered_as_one_by_one() {
    let mut rng = Rng::new(480);
    let (_, shapes) = things();
    let (mut hits, mut asked) = (0, 0);
    for _ in 0..rounds(300) {
        let (a, b) = (rng.choose(&[0, 1, 2, 3, 4]), rng.choose(&[0, 1, 2, 3, 4]));
        let (a, b) = (&shapes[a], &shapes[b]);
        let axes = leading_axes(&mut rng);
        let (poses_a, poses_b) = (poses(&mut rng, &axes[0]), poses(&mut rng, &axes[1]));
        let batch = Batch::new(a, b, poses_a.clone(), poses_b.clone()).unwrap();
        let intersects = batch.intersects().unwrap();
        let (distance, within) = (batch.distance().unwrap(), batch.within(0.5).unwrap());
        let penetrates = batch.penetrates().unwrap();
        let contacts = batch.contacts(ContactOptions::default()).unwrap();
        assert_eq!(intersects.values, batch.clone().with_execution(Execution::default().sequentially()).intersects().unwrap().values);
        for row in 0..batch.rows() {
            let place = Broadcast::place(&intersects.shape, row);
            let [pose_a, pose_b] =
                [(&poses_a, &axes[0]), (&poses_b, &axes[1])].map(|(poses, axes)| *poses.get(source(&place, axes)).unwrap());
            let (a, b) = (a.at(pose_a).unwrap(), b.at(pose_b).unwrap());
            assert_eq!(intersects.values[row], query::intersects(&a, &b));
            assert_eq!(distance.values[row], query::distance(&a, &b));
            assert_eq!(within.values[row], query::within(&a, &b, 0.5));
            assert_eq!(penetrates.values[row], query::penetrates(&a, &b));
            assert_eq!(contacts.values[row], query::contacts(&a, &b));
            hits += usize::from(intersects.values[row]);
            asked += 1;
        }
    }
    assert!(4 * hits > asked && 8 * hits < 7 * asked, "{hits} of {asked} intersect");
}

#[test]
fn faulty_poses_get_the_safe_answer_and_a_status() {
    let (mesh, shapes) = things();
    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let far = [[1.0, 0.0, 0.0, 9.0], identity[1], identity[2], identity[3]];
    let sheared = [[1.0, 1.0, 0.0, 9.0], identity[1], identity[2], identity[3]];
    let nan = [[f64::NAN, 0.0, 0.0, 0.0], identity[1], identity[2], identity[3]];
    let large = [[1e300, 0.0, 0.0, 0.0], identity[1], identity[2], identity[3]];
    let projective = [identity[0], identity[1], identity[2], [0.0, 0.0, 1.0, 1.0]];
    let flat = [identity[0], identity[1], [0.0; 4], identity[3]];
    let matrices = [far, nan, large, projective, flat, sheared];
    let poses = Poses::from_matrices(&[6], &matrices).unwrap();
    let batch = Batch::new(&mesh, &mesh, Pose::IDENTITY, poses.clone()).unwrap();
    let found = batch.intersects().unwrap();
    let faults = [Status::Ok, Status::NonFinite, Status::OutOfRange, Status::NotAffine, Status::Singular, Status::Ok];
    assert_eq!((found.values, found.status), (vec![false, true, true, true, true, false], faults.to_vec()));
    assert_eq!(batch.poses()[1].first_fault().unwrap().0, 1);
    // A sphere does not permit a shear.
    let batch = Batch::new(&mesh, &shapes[3], Pose::IDENTITY, poses).unwrap();
    let found = batch.distance().unwrap();
    assert_eq!((found.status[5], found.values[5].distance()), (Status::NotRigid, 0.0));
    assert_eq!(found.status[..5], faults[..5]);
    assert_eq!(found.values[0].proximity, query::Proximity::Apart);
    assert!(Poses::from_matrices(&[5], &matrices).is_err());
    assert!(Batch::new(&mesh, &mesh, vec![Pose::IDENTITY; 2], vec![Pose::IDENTITY; 3]).is_err());
}

#[test]
fn batches_report_progress_and_stop_once_canceled() {
    let (mesh, _) = things();
    let mut rng = Rng::new(481);
    let many: Vec<Pose> = (0..1000).map(|_| grid_pose(&mut rng)).collect();
    let (done, asked) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let count = |rows: usize| _ = done.fetch_add(rows, Ordering::Relaxed);
    let batch = Batch::new(&mesh, &mesh, Pose::IDENTITY, many.clone()).unwrap();
    batch.clone().with_execution(Execution::default().with_progress(&count)).intersects().unwrap();
    assert_eq!(done.swap(0, Ordering::Relaxed), 1000);
    let is_late = || asked.fetch_add(1, Ordering::Relaxed) > 100;
    for is_sequential in [false, true] {
        asked.store(0, Ordering::Relaxed);
        let budget = Budget::new().with_cancel(&is_late);
        let execution = Execution::default().with_budget(&budget).with_progress(&count);
        let execution = if is_sequential { execution.sequentially() } else { execution };
        let stopped = batch.clone().with_execution(execution).intersects();
        assert_eq!(stopped, Err(Stopped::Canceled));
        assert!(done.swap(0, Ordering::Relaxed) < 1000);
    }
    // A verb of the caller's own gets the cache of the row before, as the built-in verbs do.
    let found = batch.each(false, |query, a: Placed<'_>, b: Placed<'_>| query.intersects(a, b)).unwrap();
    assert_eq!(found.values, batch.intersects().unwrap().values);
}

#[test]
fn leading_axes_that_do_not_broadcast_are_rejected() {
    for (a, b) in [(vec![3], vec![2]), (vec![2, 3], vec![3, 2]), (vec![usize::MAX, 2], vec![1])] {
        let error = Broadcast::new(&a, &b).unwrap_err();
        assert_eq!(error.shapes, [a, b]);
    }
    let empty = Broadcast::new(&[0, 3], &[usize::MAX, 1, 1]).unwrap();
    assert_eq!((empty.rows(), empty.shape().len()), (0, 3));
}
