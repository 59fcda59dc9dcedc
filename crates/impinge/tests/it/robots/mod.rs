//! Robots against chains of poses, and checks against queries pair by pair.

mod audits;
mod checks;
mod clearances;
mod kinematics;
mod motions;
mod trees;

use impinge::robot::{Joint, JointKind, Link, Mimic, Robot};
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::solids::{cuboid, icosphere};

fn link(name: usize, shape: Option<Shape>) -> Link {
    Link { name: name.to_string(), shape }
}

fn mesh(plain: &impinge_testkit::Mesh) -> Mesh {
    Mesh::new(Positions::F64(plain.vertices.clone()), plain.faces.clone()).unwrap()
}

/// Returns a pose that is a quarter turn about an axis and a translation on a grid.
fn grid_pose(rng: &mut Rng, reach: i64) -> Pose {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let turns = [[1.0, 0.0, 0.0, 0.0], [half, half, 0.0, 0.0], [half, 0.0, half, 0.0], [half, 0.0, 0.0, -half]];
    let moved = [0; 3].map(|_| 0.5 * rng.integer(-reach, reach) as f64);
    Pose::from_quaternion_wxyz(moved, turns[rng.integer(0, 3) as usize]).unwrap()
}

/// Returns shapes of all kinds that touch each other on a grid.
fn shapes() -> Vec<Shape> {
    let (block, ball) = (mesh(&cuboid([-0.5; 3], [0.5; 3])), mesh(&icosphere(1)));
    let bar = Shape::cuboid([1.0, 0.25, 0.25]).unwrap();
    let parts = [(bar.clone(), Pose::IDENTITY), (Shape::sphere([0.0; 3], 0.5).unwrap(), Pose::IDENTITY)];
    vec![
        Shape::from(&block),
        Shape::from(block.solid()),
        Shape::from(ball.solid()),
        bar,
        Shape::sphere([0.0; 3], 0.5).unwrap(),
        Shape::capsule([0.0; 3], [0.0, 0.0, 1.0], 0.25).unwrap(),
        Shape::compound(&parts).unwrap(),
        Shape::from(&Mesh::new(Positions::F64(Vec::new()), Vec::new()).unwrap()),
    ]
}

const KINDS: [JointKind; 6] = [
    JointKind::Revolute,
    JointKind::Prismatic,
    JointKind::Continuous,
    JointKind::Fixed,
    JointKind::Planar,
    JointKind::Floating,
];

/// Returns a robot of a random tree, whose links and joints have a random order. Some joints follow
/// others.
fn robot(rng: &mut Rng, count: usize) -> Robot {
    let shapes = shapes();
    let mut joints = Vec::new();
    let axes = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 3.0], [0.25, 0.5, -0.125], [0.0, 0.0, -1.0]];
    for child in 1..count {
        let parent = rng.integer(0, child as i64 - 1);
        let kind = KINDS[rng.integer(0, 8).min(5) as usize % 6];
        let axis = axes[rng.integer(0, 4) as usize];
        let joint = Joint::fixed(format!("j{child}"), parent.to_string(), child.to_string(), grid_pose(rng, 3));
        joints.push(joint.moving(kind, axis).limited(-1.0, 1.0));
    }
    let single: Vec<usize> =
        (0..joints.len()).filter(|&at| matches!(joints[at].kind, JointKind::Revolute | JointKind::Prismatic)).collect();
    for pair in single.windows(2).filter(|_| rng.integer(0, 3) == 0).map(<[usize]>::to_vec).collect::<Vec<_>>() {
        let joint = joints[pair[0]].name.clone();
        joints[pair[1]].mimic = Some(Mimic { joint, multiplier: -0.5, offset: 0.25 });
    }
    let mut links: Vec<Link> = (0..count)
        .map(|name| link(name, (rng.integer(0, 5) > 0).then(|| shapes[rng.integer(0, 7) as usize].clone())))
        .collect();
    for at in (1..links.len()).rev() {
        links.swap(at, rng.integer(0, at as i64) as usize);
    }
    for at in (1..joints.len()).rev() {
        joints.swap(at, rng.integer(0, at as i64) as usize);
    }
    Robot::new(links, joints).unwrap()
}

/// Returns configurations whose values are multiples of a quarter, and angles that are multiples of
/// an eighth of a turn.
fn configurations(rng: &mut Rng, robot: &Robot, rows: usize) -> Vec<f64> {
    let mut values = Vec::new();
    for _ in 0..rows {
        for coordinate in robot.coordinates() {
            let is_angle = match robot.joints()[coordinate.joint].kind {
                JointKind::Revolute | JointKind::Continuous => true,
                _ => coordinate.name.ends_with("/theta"),
            };
            let steps = rng.integer(-4, 4) as f64;
            let zero_turn = if coordinate.name.ends_with("/qw") { 9.0 } else { 0.0 };
            values.push(if is_angle { steps * std::f64::consts::FRAC_PI_4 } else { 0.25 * (steps + zero_turn) });
        }
    }
    values
}
