//! All parts of a scene, each in one of a few colors.

use impinge::clash::Side;
use impinge::scene::Scene;
use impinge_files::Unit;

use super::axes::{Axis, orbit};
use super::bounds::{Bounds, corners};
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::{Color, DISTINCT, mixed, shaded};
use super::parts::{EdgeStroke, Parts};
use super::pixels::Picture;
use super::scale;

/// Colors of the paper at the top and at the bottom.
const PAPER: [Color; 2] = [[253, 253, 253], [238, 240, 243]];
/// Share of white in the colors of parts. Without it edges and shadows are hard to see.
const WHITE: f64 = 0.3;
/// Size of the picture, relative to its content.
const MARGIN: f64 = 1.12;
/// Width of edges in pixels, in a picture whose shorter side has [`USUAL_SIDE`] pixels.
const EDGE: f64 = 1.2;
const USUAL_SIDE: f64 = 960.0;
/// Brightness of an edge, relative to its part.
const EDGE_BRIGHTNESS: f64 = 0.45;

/// How to look at a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneView {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Azimuth and elevation of the camera in degrees.
    pub angles: [f64; 2],
    /// The axis of the world that points up.
    pub up: Axis,
    /// Unit of the scene, for the scale bar.
    pub unit: Option<Unit>,
}

/// Draws the bounded parts of a scene without perspective, with a scale bar and axes. Parts have
/// six colors in turn.
#[must_use]
pub fn scene(scene: &Scene, view: SceneView) -> Picture {
    let sides = [Side { label: String::new(), scene }];
    let parts = Parts::new(&sides);
    let boxes: Vec<Bounds> = parts.iter().map(|part| part.bounds).collect();
    let camera = Camera::framing(boxes.iter().flat_map(corners), orbit(view.angles, view.up), view.size, MARGIN);
    let mut canvas = Canvas::on_paper(view.size, PAPER);
    let colored = || parts.iter().zip(DISTINCT.iter().cycle().map(|&color| mixed(color, [255; 3], WHITE)));
    colored().for_each(|(part, color)| parts.draw(part, &mut canvas, &camera, color));
    let stretch = (f64::from(view.size[0].min(view.size[1])) / USUAL_SIDE).max(0.4);
    for (part, color) in colored() {
        let stroke = EdgeStroke { width: EDGE * stretch, color: shaded(color, EDGE_BRIGHTNESS), opacity: 1.0 };
        parts.draw_edges(part, &mut canvas, &camera, stroke);
    }
    scale::scale_bar(&mut canvas, &camera, view.unit);
    scale::axes(&mut canvas, &camera, [Axis::X, Axis::Y, Axis::Z].map(Axis::direction));
    canvas.picture()
}

#[cfg(test)]
mod tests {
    use impinge::{Pose, Shape};

    use super::*;

    #[test]
    fn each_part_has_its_color_and_a_sphere_is_round() {
        let mut both = Scene::new();
        let (ball, plane) = (Shape::sphere([0.0; 3], 1.0).unwrap(), Shape::half_space([0.0, 0.0, 1.0], 0.0).unwrap());
        both.add("left", &ball, Pose::from_translation([-1.5, 0.0, 0.0]).unwrap()).unwrap();
        both.add("ground", &plane, Pose::IDENTITY).unwrap();
        both.add("right", &ball, Pose::from_translation([1.5, 0.0, 0.0]).unwrap()).unwrap();
        let view = SceneView { size: [320, 160], angles: [0.0, 0.0], up: Axis::Z, unit: None };
        let picture = scene(&both, view);
        let is_blue = |pixel: &[u8; 3]| i32::from(pixel[2]) > i32::from(pixel[0]) + 20;
        let is_red = |pixel: &[u8; 3]| i32::from(pixel[0]) > i32::from(pixel[2]) + 20;
        let area = |is: &dyn Fn(&[u8; 3]) -> bool, half: usize| {
            picture.pixels().iter().enumerate().filter(|(at, pixel)| at % 320 / 160 == half && is(pixel)).count()
        };
        // Five units are 320 pixels with the margin, so a unit is 57.1 and a disc 10,258.
        let discs = [area(&is_blue, 0), area(&is_red, 1)];
        assert!(discs.iter().all(|&disc| (9900..10400).contains(&disc)), "{discs:?}");
    }
}
