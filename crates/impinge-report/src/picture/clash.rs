//! Pictures of clashes: two parts in two colors, everything near them as ghosts, and where they
//! meet.

use impinge::clash::{Clash, DuplicateSet, Side};
use impinge_files::Unit;

use super::axes::{Axis, Directions};
use super::bounds::{grown, overlap};
use super::camera::Camera;
use super::canvas::Canvas;
use super::color::{CURVE, Color, FIRST, GHOST, INK, SECOND, shaded};
use super::lines::Stroke;
use super::parts::{EdgeStroke, Part, Parts};
use super::pixels::Picture;
use super::scale;
use super::subject::Subject;
use super::vector::{Vector, times};
use super::view::choose;

/// Colors of the paper at the top and at the bottom.
const PAPER: [Color; 2] = [[253, 253, 253], [238, 240, 243]];
/// Opacity of the surfaces of parts near a clash. More of it hides the clash.
const GHOST_OPACITY: f64 = 0.1;
/// Opacity of the edges of parts near a clash.
const GHOST_EDGES: f64 = 0.3;
/// Opacity of a part that would hide the clash.
const TRANSPARENT: f64 = 0.42;
/// Opacity of curves that are hidden.
const HIDDEN: f64 = 0.5;
/// Share of the contact below which the larger part is transparent.
const LEAST_VISIBLE: f64 = 0.12;
/// Distance from the contact up to which other parts are drawn, in radii of the picture.
const NEARBY: f64 = 2.5;
/// Radius of a curve and of the mark of the point, in pixels of a picture whose shorter side has
/// [`USUAL_SIDE`] pixels.
const CURVE_RADIUS: f64 = 2.0;
const MARK_RADIUS: f64 = 7.0;
const USUAL_SIDE: f64 = 960.0;

/// Tangent of half the vertical field of view of pictures with perspective, which is 50 degrees.
const HALF_VIEW: f64 = 0.466_307_658_154_998_6;

/// Vertical field of view of pictures with perspective, in degrees.
pub const FIELD_OF_VIEW: f64 = 50.0;

/// Color of the first part of a clash.
pub const COLOR_A: [u8; 3] = FIRST;
/// Color of the second part of a clash.
pub const COLOR_B: [u8; 3] = SECOND;

/// Scenes whose clashes are drawn.
///
/// ```
/// use impinge::clash::{self, Options, Side};
/// use impinge::query::batch::Execution;
/// use impinge::scene::Scene;
/// use impinge::{Pose, Shape};
/// use impinge_report::picture::{Axis, Gallery};
///
/// let cube = Shape::cuboid([0.5; 3])?;
/// let mut scene = Scene::new();
/// scene.add("a", &cube, Pose::IDENTITY)?;
/// scene.add("b", &cube, Pose::from_translation([0.75, 0.25, 0.25])?)?;
/// let sides = [Side { label: "cubes".to_owned(), scene: &scene }];
/// let report = clash::find(&sides, Options::new(0.001), Execution::default())?;
/// let gallery = Gallery::new(&sides, None, Axis::Z, [160, 120]);
/// let view = gallery.clash(&report.clashes[0]).ok_or("the cubes are bounded")?;
/// assert_eq!(view.draw().size(), [160, 120]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Gallery<'s> {
    parts: Parts<'s>,
    unit: Option<Unit>,
    up: Axis,
    size: [u32; 2],
    has_perspective: bool,
    axes: [Vector; 3],
}

/// A view of a clash, which can be drawn.
pub struct View<'g> {
    gallery: &'g Gallery<'g>,
    subject: Subject,
    camera: Camera,
    /// Index of the part in the subject that is transparent.
    transparent: Option<usize>,
    radius: f64,
    target: Vector,
}

impl<'s> Gallery<'s> {
    /// Prepares pictures of the clashes of some scenes, without perspective. `unit` is the unit of
    /// the scenes, `up` the axis that points up, and `size` the width and height in pixels.
    #[must_use]
    pub fn new(sides: &'s [Side<'s>], unit: Option<Unit>, up: Axis, size: [u32; 2]) -> Self {
        let axes = [Axis::X, Axis::Y, Axis::Z].map(Axis::direction);
        Self { parts: Parts::new(sides), unit, up, size, has_perspective: false, axes }
    }

    /// Draws with perspective, with the field of view [`FIELD_OF_VIEW`].
    #[must_use]
    pub fn with_perspective(self) -> Self {
        Self { has_perspective: true, ..self }
    }

    /// Draws other axes in the corner of the pictures, for example those of the file that a
    /// picture belongs to. Each is a unit vector of the world.
    #[must_use]
    pub fn with_axes(self, axes: [[f64; 3]; 3]) -> Self {
        Self { axes, ..self }
    }

    /// Returns the view in which a clash is best visible, or `None` if a part is unbounded.
    #[must_use]
    pub fn clash<'g>(&'g self, clash: &Clash) -> Option<View<'g>>
    where
        's: 'g,
    {
        Subject::of_clash(&self.parts, clash).map(|subject| self.view(subject))
    }

    /// Returns a view of the first two of some duplicates, or `None` if they are unbounded.
    #[must_use]
    pub fn duplicates<'g>(&'g self, set: &DuplicateSet) -> Option<View<'g>>
    where
        's: 'g,
    {
        Subject::of_duplicates(&self.parts, set).map(|subject| self.view(subject))
    }

    fn view<'g>(&'g self, subject: Subject) -> View<'g> {
        let chosen = choose(&self.parts, &subject, self.up);
        let half_view = self.has_perspective.then_some(HALF_VIEW);
        let camera = Camera::at(chosen.target, chosen.radius, chosen.directions, self.size, half_view);
        let is_hidden = chosen.visible < LEAST_VISIBLE && !subject.curves.is_empty();
        let transparent = subject.outer.or_else(|| is_hidden.then(|| subject.larger(&self.parts)));
        View { gallery: self, subject, camera, transparent, radius: chosen.radius, target: chosen.target }
    }
}

impl View<'_> {
    /// Returns the position of the eye in the world.
    #[must_use]
    pub fn eye(&self) -> [f64; 3] {
        self.camera.eye()
    }

    /// Returns the unit vectors of the world that point away from the viewer and up.
    #[must_use]
    pub fn away_and_up(&self) -> [[f64; 3]; 2] {
        let [_, down, away]: Directions = *self.camera.directions();
        [away, times(down, -1.0)]
    }

    /// Draws the clash.
    #[must_use]
    pub fn draw(&self) -> Picture {
        let Self { gallery, subject, camera, .. } = self;
        let [width, height] = camera.size().map(f64::from);
        let stretch = (width.min(height) / USUAL_SIDE).max(0.4);
        let mut canvas = Canvas::on_paper(camera.size(), PAPER);
        let mut layer = Canvas::new(camera.size());
        for (side, color) in [(0, COLOR_A), (1, COLOR_B)] {
            let target = if self.transparent == Some(side) { &mut layer } else { &mut canvas };
            let part = gallery.parts.get(subject.parts[side]);
            gallery.parts.draw(part, target, camera, color);
            let stroke = EdgeStroke { width: 1.2 * stretch, color: shaded(color, 0.38), opacity: 1.0 };
            gallery.parts.draw_edges(part, target, camera, stroke);
        }
        self.draw_curves(&mut canvas, CURVE_RADIUS * stretch);
        if self.transparent.is_some() {
            canvas.blend(&layer, TRANSPARENT);
        }
        let near = grown([self.target, self.target], NEARBY * self.radius);
        let mut ghosts = Canvas::new(camera.size());
        let subjects = subject.parts.map(|part| std::ptr::from_ref(gallery.parts.get(part)));
        let is_ghost = |part: &&Part<'_>| {
            overlap(&part.bounds, &near) && !subjects.contains(&std::ptr::from_ref::<Part<'_>>(part))
        };
        let context: Vec<&Part<'_>> = gallery.parts.iter().filter(is_ghost).collect();
        context.iter().for_each(|part| gallery.parts.draw(part, &mut ghosts, camera, GHOST));
        canvas.blend(&ghosts, GHOST_OPACITY);
        let stroke = EdgeStroke { width: stretch, color: INK, opacity: GHOST_EDGES };
        context.iter().for_each(|part| gallery.parts.draw_edges(part, &mut canvas, camera, stroke));
        let mut hidden = Canvas::new(camera.size());
        self.draw_curves(&mut hidden, 0.6 * CURVE_RADIUS * stretch);
        canvas.overlay(&hidden, HIDDEN);
        if let Some(point) = subject.point {
            self.mark(&mut canvas, point, stretch);
        }
        scale::scale_bar(&mut canvas, camera, gallery.unit);
        scale::axes(&mut canvas, camera, gallery.axes);
        canvas.picture()
    }

    fn draw_curves(&self, canvas: &mut Canvas, radius: f64) {
        for ends in self.subject.curves.iter().flat_map(|line| line.windows(2)) {
            if let Some(seen) = self.camera.segment([ends[0], ends[1]]) {
                canvas.tube(seen, radius, CURVE);
            }
        }
    }

    /// Draws a ring with a cross around a point, over everything.
    fn mark(&self, canvas: &mut Canvas, point: Vector, stretch: f64) {
        const CORNERS: usize = 40;
        let Some([[x, y, _], _]) = self.camera.segment([point, point]) else { return };
        let ring = |radius: f64, at: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * at as f64 / CORNERS as f64).sin_cos();
            [x + radius * stretch * cosine, y + radius * stretch * sine]
        };
        for (color, width) in [([255; 3], 4.0), (INK, 1.8)] {
            let mut line = |ends| canvas.line(&Stroke { ends, color, opacity: 1.0, width: width * stretch });
            for at in 0..CORNERS {
                line([ring(MARK_RADIUS, at), ring(MARK_RADIUS, at + 1)]);
            }
            for quarter in 0..4 {
                let at = quarter * CORNERS / 4;
                line([ring(MARK_RADIUS, at), ring(1.9 * MARK_RADIUS, at)]);
            }
        }
    }
}
