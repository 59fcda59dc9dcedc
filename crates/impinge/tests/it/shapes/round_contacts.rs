//! The normals and depths of contacts of round shapes, against the bounds of the penetration.

use impinge::Pose;
use impinge::query;
use impinge::shape::{PlacedShape, Shape};
use impinge_testkit::generate::{Rng, poses};

/// Returns a round shape, whose sizes are powers of two if it is on the grid.
fn round_shape(rng: &mut Rng, on_grid: bool) -> Shape {
    let kind = rng.integer(0, 3);
    let mut size = || if on_grid { rng.choose(&[0.25, 0.5, 1.0]) } else { rng.uniform(0.25, 1.0) };
    let shape = match kind {
        0 => Shape::ellipsoid([size(), size(), size()]),
        1 => Shape::cylinder(size(), size()),
        2 => Shape::cone(size(), size()),
        _ => Shape::cuboid([size(), size(), size()]),
    };
    shape.expect("positive sizes")
}

/// Returns a pose in which axes and points of shapes on the grid coincide, or any pose.
fn place(rng: &mut Rng, on_grid: bool) -> Pose {
    let (linear, translation) = if on_grid {
        (poses::cube_symmetry(rng), [0; 3].map(|_: i32| 0.25 * rng.integer(-4, 4) as f64))
    } else {
        (poses::rotation(rng).linear, [0; 3].map(|_: i32| rng.uniform(-0.75, 0.75)))
    };
    Pose::new(linear, translation).expect("in range")
}

/// Checks that the contacts are as deep as the penetration, and that a shift along the normal by
/// little more than that moves the shapes apart.
#[test]
fn contacts_of_round_shapes_have_the_normal_and_the_depth_of_the_penetration() {
    /// Maximum excess of the depth along the normal over the penetration. The smallest shapes have
    /// a size of 0.25.
    const MAX_EXCESS: f64 = 0.25 / 8192.0;
    let mut rng = Rng::new(571);
    let (mut deep, mut close) = ([0; 2], [0; 2]);
    for round in 0..4_000 {
        let on_grid = round % 2 == 0;
        let (first, second) = (round_shape(&mut rng, on_grid), round_shape(&mut rng, on_grid));
        let a = first.at(place(&mut rng, on_grid)).expect("a rigid pose");
        let there = place(&mut rng, on_grid);
        let b = second.at(there).expect("a rigid pose");
        let Some(depth) = query::penetration(&a, &b).filter(|depth| depth.lower > 0.0) else { continue };
        let manifolds = query::contacts(&a, &b);
        let normal = manifolds[0].normal;
        let deepest = manifolds[0].points.iter().map(|point| point.upper).fold(f64::NEG_INFINITY, f64::max);
        let context = || format!("{first:?} {a:?} {second:?} {b:?}: {manifolds:?} {depth:?}");
        assert!((depth.lower - 1e-4..=depth.upper + MAX_EXCESS).contains(&deepest), "{}", context());
        let shifted = |excess: f64| -> PlacedShape {
            let at = there.translation();
            let to = std::array::from_fn(|k| at[k] + normal[k] * (depth.upper + excess));
            second.at(Pose::new(*there.linear(), to).expect("in range")).expect("a rigid pose")
        };
        assert!(!query::intersects(&a, shifted(MAX_EXCESS)), "{}", context());
        deep[usize::from(on_grid)] += 1;
        close[usize::from(on_grid)] += usize::from(!query::intersects(&a, shifted(1e-6)));
    }
    let share = |at: usize| f64::from(close[at] as u32) / f64::from(deep[at] as u32);
    assert!(deep[0] > 1_000 && deep[1] > 400, "{deep:?}");
    assert!(share(0) > 0.9 && share(1) > 0.9, "{close:?} of {deep:?}");
}
