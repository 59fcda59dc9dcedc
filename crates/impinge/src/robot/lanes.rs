//! The kinematics of four configurations at a time.
//!
//! Each lane has the numbers of [`Robot::place`], up to the signs of zeros. Guarded by the test
//! below.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use super::frame::Frame;
use super::joint::JointKind;
use super::model::Robot;
use super::tree::Step;
use crate::math::sine::sines_and_cosines;
use crate::simd::{Level, dispatch};

/// Number of configurations that are placed at a time: the lanes of one 256-bit vector of double
/// precision.
pub(super) const ROWS: usize = 4;

/// The frames of one link in four configurations: rows of a matrix with four lanes in each entry.
pub(super) type FrameLanes = [[[f64; ROWS]; 4]; 3];

/// A frame in each lane.
type Map<S> = [[f64x4<S>; 4]; 3];

/// Computes the frame of each link in four valid configurations.
pub(super) fn place(level: Level, robot: &Robot, rows: [&[f64]; ROWS], frames: &mut Vec<FrameLanes>) {
    let identity = Frame::IDENTITY.0.map(|row| row.map(|entry| [entry; ROWS]));
    frames.resize(robot.links().len(), identity);
    dispatch!(level, simd => {
        for step in robot.steps() {
            let parent = load(simd, &frames[step.parent]);
            let child = after(&parent, &parent_from_child(simd, step, rows));
            store(&child, &mut frames[step.child]);
        }
    });
}

/// Returns the frame of one configuration.
pub(super) fn frame_of(lanes: &FrameLanes, lane: usize) -> Frame {
    Frame(lanes.each_ref().map(|row| row.each_ref().map(|entry| entry[lane])))
}

#[inline(always)]
fn load<S: Simd>(simd: S, lanes: &FrameLanes) -> Map<S> {
    let [a, b, c] = lanes;
    [load_row(simd, a), load_row(simd, b), load_row(simd, c)]
}

#[inline(always)]
fn store<S: Simd>(map: &Map<S>, lanes: &mut FrameLanes) {
    for i in 0..3 {
        for j in 0..4 {
            map[i][j].store_slice(&mut lanes[i][j]);
        }
    }
}

#[inline(always)]
fn load_row<S: Simd>(simd: S, row: &[[f64; ROWS]; 4]) -> [f64x4<S>; 4] {
    let [x, y, z, t] = row;
    [f64x4::from_slice(simd, x), f64x4::from_slice(simd, y), f64x4::from_slice(simd, z), f64x4::from_slice(simd, t)]
}

/// Returns the map that applies `inner` first and then `outer`, with the roundings of
/// [`Frame::after`].
#[inline(always)]
fn after<S: Simd>(outer: &Map<S>, [a, b, c]: &Map<S>) -> Map<S> {
    let mut map = *outer;
    for row in &mut map {
        let [x, y, z, t] = *row;
        for k in 0..4 {
            row[k] = x * a[k] + y * b[k] + z * c[k];
        }
        row[3] += t;
    }
    map
}

/// Returns the map from the frame of the child to the frame of the parent in each lane, with the
/// roundings of [`Motion::parent_from_child`](super::joint::Motion::parent_from_child).
#[inline(always)]
fn parent_from_child<S: Simd>(simd: S, step: &Step, rows: [&[f64]; ROWS]) -> Map<S> {
    let motion = &step.motion;
    let mut map = [[f64x4::splat(simd, 0.0); 4]; 3];
    for (row, entries) in map.iter_mut().zip(&motion.parent_from_joint.0) {
        for (lanes, &entry) in row.iter_mut().zip(entries) {
            *lanes = f64x4::splat(simd, entry);
        }
    }
    match motion.kind {
        JointKind::Fixed => {}
        JointKind::Revolute | JointKind::Continuous => {
            let turn = sines_and_cosines(simd, value(simd, step, rows));
            match motion.coordinate_axis() {
                Some(axis) => turn_about_coordinate_axis(&mut map, axis, turn),
                None => turn_about(&mut map, motion.axis, turn),
            }
        }
        JointKind::Prismatic => {
            let length = value(simd, step, rows);
            let [x, y, z] = motion.axis;
            for [a, b, c, t] in &mut map {
                *t = *a * (length * x) + *b * (length * y) + *c * (length * z) + *t;
            }
        }
        JointKind::Planar | JointKind::Floating => {
            let frames = rows.map(|row| motion.parent_from_child(step.source.values(row, &mut 0.0)).0);
            for (i, row) in map.iter_mut().enumerate() {
                for (j, lanes) in row.iter_mut().enumerate() {
                    let [p, q, r, s] = &frames;
                    *lanes = f64x4::from_slice(simd, &[p[i][j], q[i][j], r[i][j], s[i][j]]);
                }
            }
        }
    }
    map
}

/// Returns the value of a joint with one coordinate in each lane.
#[inline(always)]
fn value<S: Simd>(simd: S, step: &Step, [p, q, r, s]: [&[f64]; ROWS]) -> f64x4<S> {
    let at = step.source.first;
    let values = f64x4::from_slice(simd, &[p[at], q[at], r[at], s[at]]);
    match step.source.rule {
        Some([multiplier, offset]) => values * multiplier + offset,
        None => values,
    }
}

/// Appends a rotation about a coordinate axis, given by its index and its sign. The products that
/// are left out are with 0 and 1.
#[inline(always)]
fn turn_about_coordinate_axis<S: Simd>(map: &mut Map<S>, (k, sign): (usize, f64), [sine, cosine]: [f64x4<S>; 2]) {
    let (i, j, sine) = ((k + 1) % 3, (k + 2) % 3, sine * sign);
    for row in map {
        (row[i], row[j]) = (row[i] * cosine + row[j] * sine, row[j] * cosine - row[i] * sine);
    }
}

/// Appends a rotation about an axis of length 1, as [`rotation`](super::frame::rotation) computes
/// it.
#[inline(always)]
fn turn_about<S: Simd>(map: &mut Map<S>, axis: [f64; 3], [sine, cosine]: [f64x4<S>; 2]) {
    let squares = axis.map(|x| x * x);
    let mut turned = [[cosine; 3]; 3];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        turned[i][i] = squares[i] + cosine * (squares[j] + squares[k]);
        let (both, across) = (axis[i] * axis[j] * (1.0 - cosine), axis[k] * sine);
        turned[i][j] = both - across;
        turned[j][i] = both + across;
    }
    let [a, b, c] = turned;
    for row in map {
        let [x, y, z, t] = *row;
        for k in 0..3 {
            row[k] = x * a[k] + y * b[k] + z * c[k];
        }
        row[3] = t;
    }
}

#[cfg(test)]
mod tests {
    use impinge_testkit::generate::Rng;

    use super::*;
    use crate::math::Pose;
    use crate::robot::{Joint, Link, Mimic};
    use crate::simd::levels;

    const KINDS: [JointKind; 6] = [
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Continuous,
        JointKind::Fixed,
        JointKind::Planar,
        JointKind::Floating,
    ];

    /// Returns a tree of all kinds of joints, with axes along coordinate axes and others.
    fn robot(rng: &mut Rng) -> Robot {
        let axes = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 3.0], [0.25, 0.5, -0.125], [1.0, 1e-20, 0.0]];
        let links = (0..9).map(|name| Link { name: name.to_string(), shape: None }).collect();
        let joint = |child: i64| {
            let at = [0; 3].map(|_| 0.5 * rng.integer(-3, 3) as f64);
            let axis = [0; 3].map(|_| rng.integer(-2, 3) as f64 + 0.25);
            let angle = 0.125 * std::f64::consts::PI * rng.integer(-8, 8) as f64;
            let origin = Pose::from_axis_angle(axis, angle, at).expect("a pose");
            let parent = rng.integer(0, child - 1).to_string();
            let joint = Joint::fixed(format!("j{child}"), parent, child.to_string(), origin);
            joint.moving(KINDS[rng.integer(0, 5) as usize], axes[rng.integer(0, 4) as usize])
        };
        let mut joints: Vec<Joint> = (1..9).map(joint).collect();
        let single = |joint: &&mut Joint| matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic);
        let mut single: Vec<&mut Joint> = joints.iter_mut().filter(single).collect();
        if let [first, second, ..] = &mut single[..] {
            second.mimic = Some(Mimic { joint: first.name.clone(), multiplier: -0.5, offset: 0.25 });
        }
        Robot::new(links, joints).expect("a robot")
    }

    #[test]
    fn four_rows_are_placed_as_single_rows_are() {
        let mut rng = Rng::new(11);
        let (mut frames, mut alone) = (Vec::new(), Vec::new());
        let (mut turned, mut all) = (0, 0);
        for _ in 0..200 {
            let robot = robot(&mut rng);
            let columns = robot.coordinates().len();
            // Angles are multiples of an eighth of a turn or any others.
            let value = |rng: &mut Rng| match rng.integer(0, 2) {
                0 => std::f64::consts::FRAC_PI_4 * rng.integer(-9, 9) as f64,
                1 => 0.25 * rng.integer(1, 9) as f64,
                _ => rng.integer(-1000, 1000) as f64 / 77.0 + 1e-9,
            };
            let values: Vec<f64> = (0..ROWS * columns).map(|_| value(&mut rng)).collect();
            let row = |lane: usize| &values[lane * columns..(lane + 1) * columns];
            for (name, level) in levels() {
                place(level, &robot, std::array::from_fn(row), &mut frames);
                for lane in 0..ROWS {
                    robot.place(row(lane), &mut alone);
                    let found: Vec<Frame> = frames.iter().map(|frame| frame_of(frame, lane)).collect();
                    assert_eq!(found, alone, "{name}");
                    all += found.len();
                    turned += found.iter().filter(|frame| frame.0[0][0].abs() != 1.0).count();
                }
            }
        }
        assert!(turned * 2 > all, "{turned} of {all}");
    }
}
