//! Frames of a character side by side, with the mesh in gray and each volume as a tinted outline.

use impinge::character::{Character, Frame, HitPart, Posed, Rig, RigPose};

use super::axes::{Axis, from_front_right};
use super::bounds::Bounds;
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::{DISTINCT, MESH};
use super::lines::Stroke;
use super::pixels::Picture;
use super::vector::{add, times};

/// Number of frames in a row.
const COLUMNS: usize = 4;

/// Longer side of a frame, in pixels.
const SIDE: u32 = 480;

/// Number of corners of an outline. Fewer make round volumes look angular.
const OUTLINE: usize = 96;

/// Draws the mesh and the volumes of a character in each pose, row by row. Part k has the color
/// [`DISTINCT`](super::DISTINCT)`[k % 6]`.
#[must_use]
pub fn character(rig: &Rig, character: &Character, poses: &[RigPose]) -> Picture {
    let boxes: Vec<Bounds> = poses.iter().flat_map(|pose| boxes(character, pose)).collect();
    let camera = Camera::around(&boxes, from_front_right(Axis::Y), SIDE);
    let (columns, rows) = (poses.len().clamp(1, COLUMNS), poses.len().div_ceil(COLUMNS).max(1));
    let [width, height] = camera.size();
    let mut canvas = Canvas::new([width * columns as u32, height * rows as u32]);
    let mut vertices = Vec::new();
    for (at, pose) in poses.iter().enumerate() {
        let corner = [(at % columns) as f64 * f64::from(width), (at / columns) as f64 * f64::from(height)];
        rig.skin().skinned(pose, &mut vertices);
        let faces = rig.skin().faces();
        let triangle = |face: usize| (faces[face].map(|vertex| vertices[vertex as usize]), MESH);
        canvas.draw(&camera, corner, faces.len(), triangle);
        volumes(&mut canvas, &camera, corner, character, pose);
    }
    canvas.picture()
}

/// Returns the axis-aligned box of each volume in a pose, in the world frame.
fn boxes(character: &Character, pose: &RigPose) -> Vec<Bounds> {
    let of_part = |(part, frame): (&HitPart, Frame)| {
        let end = |axis: usize, sign: f64| {
            let direction = [0, 1, 2].map(|k| if k == axis { sign } else { 0.0 });
            farthest(part, &frame, direction)[axis]
        };
        [-1.0, 1.0].map(|sign| [0, 1, 2].map(|axis| end(axis, sign)))
    };
    character.parts().iter().zip(character.frames(pose)).map(of_part).collect()
}

/// Returns the point of a part's volume that is farthest along a direction, in the world frame.
fn farthest(part: &HitPart, frame: &Frame, direction: [f64; 3]) -> [f64; 3] {
    let origin = frame.apply([0.0; 3]);
    let local = frame.local([0, 1, 2].map(|k| origin[k] + direction[k]));
    frame.apply(part.volume().support(local))
}

/// Draws the volumes from back to front.
fn volumes(canvas: &mut Canvas, camera: &Camera, corner: [f64; 2], character: &Character, pose: &RigPose) {
    let posed = Posed::new(character, pose);
    let [right, down, _] = *camera.directions();
    let depth = |part: usize| {
        let (center, _) = character.parts()[part].volume().bounding_sphere();
        camera.project(posed.frames()[part].apply(center))[2]
    };
    let mut order: Vec<usize> = (0..character.parts().len()).collect();
    order.sort_by(|&a, &b| depth(b).total_cmp(&depth(a)));
    for part in order {
        let frame = &posed.frames()[part];
        let color = DISTINCT[part % DISTINCT.len()];
        let outline: Vec<[f64; 2]> = (0..OUTLINE)
            .map(|step| {
                let (sine, cosine) = (std::f64::consts::TAU * step as f64 / OUTLINE as f64).sin_cos();
                let direction = add(times(right, cosine), times(down, sine));
                let [x, y, _] = camera.project(farthest(&character.parts()[part], frame, direction));
                [x + corner[0], y + corner[1]]
            })
            .collect();
        canvas.tint(&outline, color, 0.28);
        for (at, &from) in outline.iter().enumerate() {
            canvas.line(&Stroke { ends: [from, outline[(at + 1) % OUTLINE]], color, opacity: 1.0, width: 2.0 });
        }
    }
}
