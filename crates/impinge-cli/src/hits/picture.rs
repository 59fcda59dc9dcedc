//! Draws frames of a character side by side, with the mesh in gray and each volume as a tinted
//! outline.

use std::io;
use std::path::Path;

use impinge::character::{Character, Frame, HitPart, Posed, Rig, RigPose};

use crate::failure::Failure;
use crate::inspect::picture::camera::Camera;
use crate::inspect::picture::canvas::Canvas;
use crate::inspect::picture::strokes::{COLORS, Stroke};

/// Number of frames of one animation, and maximum number of frames if several animations are shown.
const FRAMES: usize = 8;

/// Number of frames in a row.
const COLUMNS: usize = 4;

/// Longer side of a frame, in pixels.
const SIDE: u32 = 480;

/// Number of corners of an outline. Fewer make round volumes look angular.
const OUTLINE: usize = 96;

/// Names of the colors in the report, in the order in which parts get them. They name the entries
/// of [`COLORS`].
pub(super) const NAMES: [&str; 6] = ["blue", "red", "green", "pink", "sky", "orange"];

/// Returns the poses to draw: evenly spaced times of one animation, or the rest pose and the middle
/// of each of the first seven animations.
///
/// # Errors
/// Returns an error if the animation does not exist, or a pose is out of range.
pub(super) fn poses(rig: &Rig, animation: Option<&str>, path: &Path) -> Result<Vec<RigPose>, Failure> {
    let broken = |error: impinge::character::RigError| Failure::new("rig", error.to_string()).in_file(path);
    let at = |animation: usize, share: f64| {
        let [start, end] = rig.animations()[animation].span();
        rig.pose_at(animation, start + share * (end - start)).map_err(broken)
    };
    let Some(name) = animation else {
        let mut poses = vec![rig.rest_pose().map_err(broken)?];
        for animation in 0..rig.animations().len().min(FRAMES - 1) {
            poses.push(at(animation, 0.5)?);
        }
        return Ok(poses);
    };
    let Some(found) = rig.animations().iter().position(|animation| animation.name() == name) else {
        let known: Vec<&str> = rig.animations().iter().map(|animation| animation.name()).collect();
        let failure = Failure::new("no-animation", format!("there is no animation {name:?}")).in_file(path);
        return Err(failure.hint(format!("its animations are {}", known.join(", "))));
    };
    (0..FRAMES).map(|frame| at(found, frame as f64 / (FRAMES - 1) as f64)).collect()
}

/// Picture of a character in several poses.
pub(super) struct Sheet(Canvas);

impl Sheet {
    /// Draws the mesh and the volumes in each pose, row by row.
    pub(super) fn draw(rig: &Rig, character: &Character, poses: &[RigPose]) -> Self {
        let boxes: Vec<[[f64; 3]; 2]> = poses.iter().flat_map(|pose| boxes(character, pose)).collect();
        let camera = Camera::around(&boxes, 1, SIDE);
        let (columns, rows) = (poses.len().clamp(1, COLUMNS), poses.len().div_ceil(COLUMNS).max(1));
        let [width, height] = camera.size();
        let mut canvas = Canvas::new([width * columns as u32, height * rows as u32]);
        let mut vertices = Vec::new();
        for (at, pose) in poses.iter().enumerate() {
            let corner = [(at % columns) as f64 * f64::from(width), (at / columns) as f64 * f64::from(height)];
            rig.skin().skinned(pose, &mut vertices);
            for face in rig.skin().faces() {
                let corners = face.map(|vertex| vertices[vertex as usize]);
                let seen = corners.map(|point| {
                    let [x, y, z] = camera.project(point);
                    [x + corner[0], y + corner[1], z]
                });
                canvas.fill(seen, camera.shade(&corners));
            }
            volumes(&mut canvas, &camera, corner, character, pose);
        }
        Self(canvas)
    }

    /// Returns the picture as a PNG file.
    ///
    /// # Errors
    /// Returns an error if a side of the picture is zero pixels long.
    pub(super) fn png(&self) -> io::Result<Vec<u8>> {
        self.0.png()
    }
}

/// Returns the axis-aligned box of each volume in a pose, in the world frame.
fn boxes(character: &Character, pose: &RigPose) -> Vec<[[f64; 3]; 2]> {
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
    let [right, down] = camera.right_and_down();
    let depth = |part: usize| {
        let (center, _) = character.parts()[part].volume().bounding_sphere();
        camera.project(posed.frames()[part].apply(center))[2]
    };
    let mut order: Vec<usize> = (0..character.parts().len()).collect();
    order.sort_by(|&a, &b| depth(b).total_cmp(&depth(a)));
    for part in order {
        let frame = &posed.frames()[part];
        let color = COLORS[part % COLORS.len()];
        let outline: Vec<[f64; 2]> = (0..OUTLINE)
            .map(|step| {
                let (sine, cosine) = (std::f64::consts::TAU * step as f64 / OUTLINE as f64).sin_cos();
                let direction = [0, 1, 2].map(|k| cosine * right[k] + sine * down[k]);
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
