//! A moving body as a tree of convex pieces.
//!
//! The root is the whole body: a part, a mesh or a group of parts. The pieces below are made when a
//! search first divides them.
//!
//! The proof is docs/notes/proof.md, L34. The tests are in `tests/it/sweep`.

use super::motion::Motion;
use super::piece::{ABOVE, AxisReach, Content, Piece, SlabbedBox, Volume, image};
use crate::convex::{Core, Surface, Swept, to_unit_entries};
use crate::hierarchy::Child;
use crate::input::InputError;
use crate::math::Pose;
use crate::math::vec3::{Vector, dot, scaled_length};
use crate::mesh::{Faces, Mesh};
use crate::shape::{Form, PlacedShape, Shape};
use crate::volume::stretch;

/// Bound on a length whose square underflows; added so that computed lengths are never too small.
const VANISHING: f64 = 1e-150;

/// Maximum number of parts of a group that are its children. Larger groups are halved.
const GROUP_PARTS: usize = 8;

/// Returns a bound on the error of a height above a plane, at any time, of a body that moves by a
/// motion and reaches at most `reach` from the origin of its frame.
pub(super) fn height_error(motion: &Motion, reach: f64) -> f64 {
    let linear = scaled_length(&motion.at(0.0).linear().map(|row| scaled_length(&row)));
    // The roundings of heights are below 64 u of the sizes whose errors the motion bounds. Parts of
    // a compound are placed once more.
    3.0 * motion.error(reach) + 64.0 * f64::EPSILON * linear * reach
}

/// A shape, its motion, and the pieces made so far.
#[derive(Debug)]
pub(super) struct Body<'m> {
    pub(super) motion: &'m Motion,
    /// The shape in its own frame.
    still: PlacedShape,
    pub(super) pieces: Vec<Piece>,
    /// Pieces that hold the whole body together.
    pub(super) roots: Vec<u32>,
    /// Upper bound on the distance of a point of a bounded part from the origin of the body's
    /// frame, in the body's frame.
    pub(super) reach: f64,
    /// Bound on the error of a height of the body above a plane, at any time.
    pub(super) error: f64,
}

impl<'m> Body<'m> {
    /// Returns the body. Its half-spaces must not turn.
    ///
    /// # Errors
    /// As for [`Shape::at`].
    pub(super) fn new(shape: &Shape, motion: &'m Motion) -> Result<Self, InputError> {
        let (still, start) = (shape.at(Pose::IDENTITY)?, shape.at(motion.at(0.0))?);
        let mut body = Self { motion, still, pieces: vec![], roots: vec![], reach: VANISHING, error: 0.0 };
        let mut bounded = Vec::new();
        for (number, part) in (0..).zip(start.parts()) {
            match part.form() {
                Form::HalfSpace(plane) => {
                    let (direction, base, level) = plane.rounded();
                    let across = scaled_length(&direction);
                    let (normal, level) = (direction.map(|x| x / across), level / across);
                    body.reach = body.reach.max(level.abs() + scaled_length(&body.motion.arm([0.0; 3])));
                    body.roots.push(body.pieces.len() as u32);
                    body.push(number, Content::Whole, Volume::HalfSpace { normal, base, level }, AxisReach::default());
                }
                Form::Convex(_) | Form::Surface(_) | Form::Field(_) => bounded.push(number),
            }
        }
        bounded.retain(|&part| body.bounds(part).is_some());
        if !bounded.is_empty() {
            let root = body.group(&mut bounded);
            body.roots.push(root);
        }
        body.error = height_error(motion, body.reach);
        Ok(body)
    }

    /// Returns the box of a part in the body's frame, or `None` if the part is an empty mesh.
    fn bounds(&self, part: u32) -> Option<[Vector; 2]> {
        self.still.parts()[part as usize].bounds()
    }

    /// Makes the piece of some parts, of which there is at least one. Returns its index.
    fn group(&mut self, parts: &mut [u32]) -> u32 {
        if let [part] = *parts {
            return self.whole(part);
        }
        let boxes: Vec<[Vector; 2]> = parts.iter().filter_map(|&part| self.bounds(part)).collect();
        let min = [0, 1, 2].map(|k| boxes.iter().map(|bounds| bounds[0][k]).fold(f64::INFINITY, f64::min));
        let max = [0, 1, 2].map(|k| boxes.iter().map(|bounds| bounds[1][k]).fold(f64::NEG_INFINITY, f64::max));
        let longest = (0..3).fold(0, |best, k| if max[k] - min[k] > max[best] - min[best] { k } else { best });
        let children: Vec<u32> = if parts.len() <= GROUP_PARTS {
            parts.iter().map(|&part| self.whole(part)).collect()
        } else {
            let middle = |part: &u32| self.bounds(*part).map_or(0.0, |[min, max]| min[longest] + max[longest]);
            parts.sort_by(|x, y| middle(x).total_cmp(&middle(y)));
            let (left, right) = parts.split_at_mut(parts.len() / 2);
            vec![self.group(left), self.group(right)]
        };
        // The boxes of round parts hold their radius, and so do the images of the boxes.
        let index = self.push_box(parts[0], Content::Group, box_between(min, max));
        let reaches = children.iter().map(|&child| &self.pieces[child as usize]);
        let reach = reaches.map(|piece| piece.reach.swept(piece.radius)).reduce(AxisReach::union);
        let group = &mut self.pieces[index as usize];
        (group.reach, group.children) = (reach.unwrap_or_default().intersection(group.reach), children);
        index
    }

    /// Makes the piece of a bounded part. Returns its index.
    fn whole(&mut self, part: u32) -> u32 {
        if let Some(bounds) = self.bounds(part) {
            let corners = (0..8).map(|i| [0, 1, 2].map(|k| bounds[i >> k & 1][k]));
            let farthest = corners.map(|corner| scaled_length(&corner)).fold(0.0, f64::max);
            self.reach = self.reach.max(farthest * ABOVE + VANISHING);
        }
        let still = self.still.clone();
        match still.parts()[part as usize].form() {
            Form::Surface(surface) => {
                let [min, max] = surface.mesh.local_bounds().unwrap_or_default();
                let mut volume = self.placed_box(part, &box_between(min, max));
                volume.slab = self.slab(part, surface.mesh, 0);
                let index = self.push_box(part, Content::Below(Child::Inner(0)), volume);
                let mesh = surface.mesh;
                let corners = mesh.faces().iter().flatten().map(|&vertex| mesh.positions().get(vertex as usize));
                let reach = AxisReach::of_points(self.motion, corners.map(|corner| surface.pose.apply(corner)));
                self.bound(index, reach);
                index
            }
            Form::Field(field) => {
                let [min, max] = field.mesh.local_bounds().unwrap_or_default();
                let volume = self.placed_box(part, &box_between(min, max));
                self.push_box(part, Content::Below(Child::Inner(0)), volume)
            }
            Form::Convex(swept) => {
                let place = |point: Vector| swept.pose.apply(point);
                let reach = match swept.core.corners() {
                    Some(corners) => AxisReach::of_points(self.motion, corners.iter().map(|&corner| place(corner))),
                    None => AxisReach::of_support(self.motion, |direction| {
                        place(farthest(&swept, &self.turned(direction, &self.motion.at(0.0))))
                    }),
                };
                let turn = self.motion.turn();
                let spread = stretch(&self.motion.at(0.0)).unwrap_or(f64::INFINITY) + turn.drift;
                let radius = if swept.radius[1] == 0.0 { 0.0 } else { swept.radius[1] * spread * ABOVE };
                let volume = Volume::Core(place(farthest(&swept, &[1.0, 0.0, 0.0])));
                let index = self.push(part, Content::Whole, volume, reach);
                self.pieces[index as usize].radius = radius;
                index
            }
            // Half-spaces are not bounded.
            Form::HalfSpace(_) => self.push(part, Content::Whole, Volume::Core([0.0; 3]), AxisReach::default()),
        }
    }

    fn push(&mut self, part: u32, content: Content, volume: Volume, reach: AxisReach) -> u32 {
        self.pieces.push(Piece { part, content, volume, radius: 0.0, reach, diameter: 0.0, children: vec![] });
        self.pieces.len() as u32 - 1
    }

    /// Adds a bound on the reach of a piece.
    fn bound(&mut self, piece: u32, reach: AxisReach) {
        let piece = &mut self.pieces[piece as usize];
        piece.reach = piece.reach.intersection(reach);
    }

    fn push_box(&mut self, part: u32, content: Content, volume: SlabbedBox) -> u32 {
        let reach = AxisReach::of_box(self.motion, &volume);
        let diameter = 2.0 * volume.half_axes.iter().map(|axis| scaled_length(&image(self.motion, axis))).sum::<f64>();
        let index = self.push(part, content, Volume::Box(volume), reach);
        self.pieces[index as usize].diameter = diameter;
        index
    }

    /// Converts a box of a part's frame to the body's frame.
    fn placed_box(&self, part: u32, volume: &SlabbedBox) -> SlabbedBox {
        let pose = self.still.parts()[part as usize].world_from_local();
        let turn = |axis: Vector| pose.linear().map(|row| dot(&row, &axis));
        SlabbedBox { center: pose.apply(volume.center), half_axes: volume.half_axes.map(turn), slab: None }
    }

    /// Returns the slab of a node of a mesh in the body's frame, if the part has the same frame.
    fn slab(&self, part: u32, mesh: &Mesh, node: u32) -> Option<(Vector, [f64; 2])> {
        let pose = self.still.parts()[part as usize].world_from_local();
        if *pose == Pose::IDENTITY { mesh.slab(node) } else { None }
    }

    /// Reports whether a piece can be divided.
    pub(super) fn is_divisible(&self, piece: u32) -> bool {
        matches!(self.pieces[piece as usize].content, Content::Group | Content::Below(_))
    }

    /// Returns the pieces that a divisible piece is divided into.
    pub(super) fn divide(&mut self, piece: u32) -> Vec<u32> {
        let Piece { part, content, children, reach, .. } = &self.pieces[piece as usize];
        let (part, content, all) = (*part, *content, *reach);
        if !children.is_empty() {
            return children.clone();
        }
        let still = self.still.clone();
        let made = match still.parts()[part as usize].form() {
            Form::Surface(surface) => {
                self.below(part, content, &surface, |body, node| body.slab(part, surface.mesh, node))
            }
            Form::Field(field) => self.below(part, content, &field, |_, _| None),
            Form::Convex(_) | Form::HalfSpace(_) => vec![],
        };
        made.iter().for_each(|&child| self.bound(child, all));
        self.pieces[piece as usize].children.clone_from(&made);
        made
    }

    /// Makes the pieces below a node or a leaf of a mesh or a height field. `slab` returns the slab
    /// of a node.
    fn below<F: Faces>(
        &mut self,
        part: u32,
        content: Content,
        surface: &Surface<'_, F>,
        slab: impl Fn(&Self, u32) -> Option<(Vector, [f64; 2])>,
    ) -> Vec<u32> {
        match content {
            Content::Below(Child::Inner(node)) => surface
                .mesh
                .children(node)
                .into_iter()
                .map(|(child, [center, half])| {
                    let half_axes = [0, 1, 2].map(|k| [0, 1, 2].map(|j| if j == k { half[k] } else { 0.0 }));
                    let mut volume = self.placed_box(part, &SlabbedBox { center, half_axes, slab: None });
                    if let Child::Inner(node) = child {
                        volume.slab = slab(self, node);
                    }
                    self.push_box(part, Content::Below(child), volume)
                })
                .collect(),
            Content::Below(Child::Leaf(leaf)) => surface
                .mesh
                .faces_of(leaf)
                .into_iter()
                .map(|face| {
                    let corners = surface.mesh.corners(face).map(|corner| surface.pose.apply(corner));
                    let reach = AxisReach::of_points(self.motion, corners.into_iter());
                    self.push(part, Content::Face(face), Volume::Triangle(corners), reach)
                })
                .collect(),
            Content::Group | Content::Face(_) | Content::Whole => vec![],
        }
    }

    /// Converts a direction of the world to the body's frame at a pose.
    pub(super) fn turned(&self, direction: &Vector, pose: &Pose) -> Vector {
        let linear = pose.linear();
        [0, 1, 2].map(|j| linear[0][j] * direction[0] + linear[1][j] * direction[1] + linear[2][j] * direction[2])
    }

    /// Returns an upper bound on the product of `along` with any point of a bounded piece without
    /// its radius, both in the body's frame, up to rounding.
    pub(super) fn height(&self, piece: &Piece, along: &Vector) -> f64 {
        match &piece.volume {
            Volume::Box(volume) => volume.height(along),
            Volume::Triangle(corners) => {
                let [p, q, r] = corners.each_ref().map(|corner| dot(along, corner));
                p.max(q).max(r)
            }
            Volume::Core(_) => match self.still.parts()[piece.part as usize].form() {
                Form::Convex(swept) => dot(along, &swept.pose.apply(farthest(&swept, along))),
                Form::HalfSpace(_) | Form::Surface(_) | Form::Field(_) => f64::INFINITY,
            },
            Volume::HalfSpace { .. } => f64::INFINITY,
        }
    }

    /// Returns the result of `ask` for a bounded piece at a pose of the body. Returns `None` for a
    /// half-space.
    pub(super) fn at<R>(&self, piece: &Piece, pose: &Pose, ask: impl FnOnce(&Swept<'_>) -> R) -> Option<R> {
        match &piece.volume {
            Volume::Triangle(corners) => Some(ask(&Swept { core: Core::Points(corners), pose, radius: [0.0; 2] })),
            Volume::Box(SlabbedBox { center, half_axes, .. }) => {
                let corners: [Vector; 8] = std::array::from_fn(|i| {
                    [0, 1, 2].map(|k| {
                        (0..3).fold(
                            center[k],
                            |x, j| if i >> j & 1 == 0 { x - half_axes[j][k] } else { x + half_axes[j][k] },
                        )
                    })
                });
                Some(ask(&Swept { core: Core::Points(&corners), pose, radius: [0.0, piece.radius] }))
            }
            Volume::Core(_) => {
                let part = &self.still.parts()[piece.part as usize];
                let Form::Convex(swept) = part.form() else { return None };
                let radius = [swept.radius[0].min(piece.radius), piece.radius];
                if *swept.pose == Pose::IDENTITY {
                    return Some(ask(&Swept { core: swept.core, pose, radius }));
                }
                let pose = pose.compose(swept.pose).ok()?;
                Some(ask(&Swept { core: swept.core, pose: &pose, radius }))
            }
            Volume::HalfSpace { .. } => None,
        }
    }
}

/// Returns the farthest point of a core along a direction of the frame that its pose maps to, in
/// its own frame.
fn farthest(swept: &Swept<'_>, along: &Vector) -> Vector {
    let linear = swept.pose.linear();
    let turned = [0, 1, 2].map(|j| (0..3).map(|k| linear[k][j] * along[k]).sum::<f64>());
    swept.core.farthest(to_unit_entries(turned), 0).0
}

/// Returns a box by its corners. It is enlarged by the rounding.
fn box_between(min: Vector, max: Vector) -> SlabbedBox {
    let center = [0, 1, 2].map(|k| 0.5 * min[k] + 0.5 * max[k]);
    let half_axes = [0, 1, 2].map(|k| {
        let mut axis = [0.0; 3];
        axis[k] = (0.5 * max[k] - 0.5 * min[k]) * ABOVE + 4.0 * f64::EPSILON * center[k].abs();
        axis
    });
    SlabbedBox { center, half_axes, slab: None }
}
