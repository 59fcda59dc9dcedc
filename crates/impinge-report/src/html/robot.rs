//! A page about a robot in several configurations, one at a time.

use std::io::{self, Write};

use impinge::robot::{Collision, ConfigurationError, Other, Robot};
use impinge::scene::Scene;
use impinge::{Mesh, Pose};
use serde::Serialize;

use super::about::{PageAbout, json};
use super::curves::Curves;
use super::integers::push_rounded;
use super::parts::Drawn;
use super::surface::surface;
use super::{MAX_TRIANGLES, geometry, write_page};

/// A configuration of a robot, which the page shows.
#[derive(Clone, Debug)]
pub struct RobotStep {
    /// Name of the step, such as `configuration 17`.
    pub name: String,
    /// The answer for this configuration, in one sentence.
    pub text: String,
    /// Verdict about the configuration.
    pub verdict: StepVerdict,
    /// A pair that collides.
    pub collision: Option<Collision>,
    /// One value for each coordinate of the robot.
    pub configuration: Vec<f64>,
}

/// Verdict about a configuration of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StepVerdict {
    /// The configuration is proved free, and on a motion also everything before it on its leg.
    Free,
    /// The configuration collides.
    Collides,
    /// Nothing is proved about the configuration.
    Open,
}

/// A robot with obstacles, and the configurations that a page shows.
#[derive(Clone, Debug)]
pub struct RobotPage<'p> {
    /// The robot.
    pub robot: &'p Robot,
    /// The obstacles.
    pub obstacles: Option<&'p Scene>,
    /// The configurations. There must be one.
    pub steps: &'p [RobotStep],
    /// Name of the slider, such as `Configuration` or `Motion`.
    pub slider: &'p str,
}

#[derive(Serialize)]
struct Content<'c> {
    kind: &'static str,
    slider: &'c str,
    /// Number of parts that move. They come first, and the block of poses has one of each for each
    /// step.
    moving: usize,
    steps: Vec<Step<'c>>,
}

#[derive(Serialize)]
struct Step<'c> {
    name: &'c str,
    text: &'c str,
    verdict: StepVerdict,
    /// Places of the parts that collide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pair: Option<[usize; 2]>,
}

/// Parts of a page: links and obstacles that have a surface.
struct Parts {
    names: Vec<[String; 2]>,
    things: Vec<(Mesh, Pose)>,
    /// Indices of the links that are drawn.
    links: Vec<usize>,
    /// Indices of the obstacles that are drawn.
    obstacles: Vec<usize>,
}

/// Writes a page that shows a robot in some configurations, with a slider.
///
/// The poses of links are rounded to single precision. Half-spaces are not drawn. The same input
/// gives the same bytes.
///
/// # Errors
/// Returns the errors of the output, and an error if a configuration is invalid.
pub fn write_robot_page(out: &mut dyn Write, page: &RobotPage<'_>, about: &PageAbout<'_>) -> io::Result<()> {
    let invalid = |error: ConfigurationError| io::Error::new(io::ErrorKind::InvalidInput, error);
    let poses: Vec<Vec<Pose>> = page
        .steps
        .iter()
        .map(|step| page.robot.poses(&step.configuration))
        .collect::<Result<_, _>>()
        .map_err(invalid)?;
    let parts = Parts::new(page, poses.first().map_or(&[], Vec::as_slice));
    let drawn = Drawn::of(&parts.things, MAX_TRIANGLES);
    let steps = page.steps.iter().map(|step| {
        let pair = step.collision.as_ref().and_then(|collision| parts.pair(collision));
        Step { name: &step.name, text: &step.text, verdict: step.verdict, pair }
    });
    let content = Content { kind: "robot", slider: page.slider, moving: parts.links.len(), steps: steps.collect() };
    let view = json(about, &parts.names, &drawn, content)?;
    let mut places = Vec::new();
    for row in &poses {
        for pose in parts.links.iter().map(|&link| &row[link]) {
            push_rounded(&mut places, pose.linear().iter().flatten().chain(pose.translation()));
        }
    }
    let geometry = geometry::bytes(&drawn, &Curves::none());
    write_page(out, &[("answer", &view), ("geometry", &geometry), ("poses", &places)])
}

impl Parts {
    fn new(page: &RobotPage<'_>, first: &[Pose]) -> Self {
        let mut parts = Self { names: Vec::new(), things: Vec::new(), links: Vec::new(), obstacles: Vec::new() };
        for (at, (link, pose)) in page.robot.links().iter().zip(first).enumerate() {
            if let Some(mesh) = link.shape.as_ref().and_then(surface) {
                parts.names.push([link.name.clone(), "link".to_owned()]);
                parts.things.push((mesh, *pose));
                parts.links.push(at);
            }
        }
        if let Some(scene) = page.obstacles {
            for part in scene.parts() {
                if let Some(mesh) = surface(scene.shape(part)) {
                    parts.names.push([scene.name(part).to_owned(), "obstacle".to_owned()]);
                    parts.things.push((mesh, *scene.pose(part)));
                    parts.obstacles.push(part.index());
                }
            }
        }
        parts
    }

    /// Returns the places of a link and of the link or obstacle that it collides with.
    fn pair(&self, collision: &Collision) -> Option<[usize; 2]> {
        let link = |index: usize| self.links.iter().position(|&known| known == index);
        let other = match collision.other {
            Other::Link(index) => link(index),
            Other::Obstacle(part) => {
                let place = self.obstacles.iter().position(|&known| known == part.index());
                place.map(|place| self.links.len() + place)
            }
        };
        Some([link(collision.link)?, other?])
    }
}
