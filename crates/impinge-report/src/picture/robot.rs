//! A robot in a configuration: the links that collide in colors, everything else as ghosts.

use impinge::query::batch::Execution;
use impinge::robot::{CheckError, CheckOptions, Other, Robot};
use impinge::scene::{PartId, Scene, Stop};
use impinge::{Mesh, Pose, Shape};

use super::axes::{Axis, orbit};
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::{Color, DISTINCT, GHOST, MESH};
use super::pixels::Picture;
use super::vector::Vector;

/// Colors of the paper at the top and at the bottom.
const PAPER: [Color; 2] = [[253, 253, 253], [238, 240, 243]];
/// Opacity of links that do not collide.
const OPACITY: f64 = 0.45;
/// Opacity of obstacles that do not collide.
const FAINT: f64 = 0.2;
/// Number of points around a round shape.
const SEGMENTS: usize = 32;
/// Size of the picture, relative to its content.
const MARGIN: f64 = 1.08;

/// How to look at a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotView {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Azimuth and elevation of the camera in degrees.
    pub angles: [f64; 2],
    /// The axis of the world that points up.
    pub up: Axis,
}

/// Triangles of one color.
type Surface = (Vec<[Vector; 3]>, Color);

/// Draws a robot in a configuration, without perspective, in the middle of the picture. Links and
/// obstacles that collide are solid, and have different colors; all others are ghosts. If nothing
/// collides, the links are solid. Half-spaces are not drawn.
///
/// # Errors
/// As for [`Robot::check`].
///
/// ```
/// use impinge::robot::{CheckOptions, Joint, JointKind, Link, Robot};
/// use impinge::{Pose, Shape};
/// use impinge_report::picture::{Axis, RobotView, robot};
///
/// let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625)?;
/// let link = |name: &str| Link { name: name.into(), shape: Some(rod.clone()) };
/// let elbow = Joint::fixed("elbow", "upper", "fore", Pose::from_translation([1.0, 0.0, 0.0])?);
/// let elbow = elbow.moving(JointKind::Revolute, [0.0, 0.0, 1.0]);
/// let arm = Robot::new(vec![link("upper"), link("fore")], vec![elbow])?;
/// let view = RobotView { size: [160, 120], angles: [-35.0, 25.0], up: Axis::Z };
/// let picture = robot(&arm, &[0.5], &CheckOptions::default(), view)?;
/// assert_eq!(picture.size(), [160, 120]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn robot(
    robot: &Robot,
    configuration: &[f64],
    options: &CheckOptions<'_>,
    view: RobotView,
) -> Result<Picture, CheckError> {
    let poses = robot.poses(configuration).map_err(CheckError::Configuration)?;
    let options = CheckOptions { stop: Stop::All, ..options.clone() };
    let found = robot.check(configuration, &options, Execution::default().sequentially())?;
    let collisions = found.values.into_iter().flatten();
    let hits: Vec<Other> = collisions.flat_map(|hit| [Other::Link(hit.link), hit.other]).collect();
    let mut colliding = hits.clone();
    colliding.sort_by_key(|thing| hits.iter().position(|hit| hit == thing));
    colliding.dedup();
    let color = |thing: Other| {
        let place = colliding.iter().position(|hit| *hit == thing);
        place.map(|place| DISTINCT[place % DISTINCT.len()])
    };

    let (mut solids, mut ghosts, mut faint): (Vec<Surface>, Vec<Surface>, Vec<Surface>) = Default::default();
    for (at, (link, pose)) in robot.links().iter().zip(&poses).enumerate() {
        let Some(shape) = &link.shape else { continue };
        let triangles = triangles(shape, pose);
        match color(Other::Link(at)) {
            Some(color) => solids.push((triangles, color)),
            None if colliding.is_empty() => solids.push((triangles, MESH)),
            None => ghosts.push((triangles, GHOST)),
        }
    }
    let parts = options.obstacles.iter().flat_map(|scene| scene.parts().map(move |part| (*scene, part)));
    let mut of_obstacle = |(scene, part): (&Scene, PartId)| {
        let triangles = triangles(scene.shape(part), scene.pose(part));
        match color(Other::Obstacle(part)) {
            Some(color) => solids.push((triangles, color)),
            None => faint.push((triangles, GHOST)),
        }
    };
    parts.for_each(&mut of_obstacle);

    let content = solids.iter().chain(&ghosts).flat_map(|(triangles, _)| triangles.iter().flatten().copied());
    let camera = Camera::framing(content, orbit(view.angles, view.up), view.size, MARGIN);
    let mut canvas = Canvas::on_paper(view.size, PAPER);
    draw(&mut canvas, &camera, &solids);
    for (surfaces, opacity) in [(&ghosts, OPACITY), (&faint, FAINT)] {
        let mut layer = Canvas::new(view.size);
        draw(&mut layer, &camera, surfaces);
        canvas.blend(&layer, opacity);
    }
    Ok(canvas.picture())
}

/// Returns the triangles of a shape in the world.
fn triangles(shape: &Shape, world_from_shape: &Pose) -> Vec<[Vector; 3]> {
    let of_part = |(mesh, shape_from_mesh): &(Mesh, Pose)| -> Vec<[Vector; 3]> {
        let place = |corner: Vector| world_from_shape.apply(shape_from_mesh.apply(corner));
        (0..mesh.faces().len() as u32).map(|face| mesh.corners(face).map(place)).collect()
    };
    shape.to_meshes(SEGMENTS).iter().flat_map(of_part).collect()
}

fn draw(canvas: &mut Canvas, camera: &Camera, surfaces: &[Surface]) {
    for (triangles, color) in surfaces {
        canvas.draw(camera, [0.0; 2], triangles.len(), |at| (triangles[at], *color));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge::robot::{Joint, JointKind, Link};

    #[test]
    fn only_things_that_collide_have_colors() {
        let rod = Shape::capsule([0.0; 3], [1.0, 0.0, 0.0], 0.0625).expect("a capsule");
        let link = |name: &str| Link { name: name.to_owned(), shape: Some(rod.clone()) };
        let tip = Pose::from_translation([1.0, 0.0, 0.0]).expect("a pose");
        let joint = |name: &str, parent: &str, child: &str| {
            Joint::fixed(name, parent, child, tip).moving(JointKind::Revolute, [0.0, 0.0, 1.0])
        };
        let links = vec![link("a"), link("b"), link("c")];
        let arm = Robot::new(links, vec![joint("ab", "a", "b"), joint("bc", "b", "c")]).expect("a robot");
        let view = RobotView { size: [160, 120], angles: [0.0, 90.0], up: Axis::Z };
        let mut scene = Scene::new();
        let far = Pose::from_translation([0.5, 0.5, 0.0]).expect("a pose");
        scene.add("post", Shape::cuboid([0.1; 3]).expect("a box"), far).expect("a part");
        let options = CheckOptions { obstacles: Some(&scene), ..CheckOptions::default() };
        // Colors have a large range of red, green and blue; ghosts and paper are gray.
        let colored = |q: &[f64]| {
            let picture = robot(&arm, q, &options, view).expect("a picture");
            let range = |pixel: &&[u8; 3]| pixel.iter().max().unwrap_or(&0) - pixel.iter().min().unwrap_or(&0) > 60;
            picture.pixels().iter().filter(range).count()
        };
        assert_eq!(colored(&[0.0, 0.0]), 0);
        assert!(colored(&[2.2, 2.2]) > 300);
    }
}
