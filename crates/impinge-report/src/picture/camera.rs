//! The camera: projects points of the world to pixels, in parallel or with perspective.
//!
//! The point at the center of the picture is subtracted first, in f64, so that pictures far from
//! the origin are as sharp as those near it.

use super::axes::Directions;
use super::bounds::{Bounds, around, center, corners};
use super::vector::{Vector, add, dot, minus, times};

/// A projection of the world to pixels.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    directions: Directions,
    /// Point of the world at the center of the picture.
    target: Vector,
    /// Pixels per unit of length at the target.
    scale: f64,
    size: [u32; 2],
    /// Distance of the eye from the target, in pixels; `None` without perspective.
    eye: Option<f64>,
}

/// A projected point: pixels to the right, pixels down, and depth (larger is farther away). Near
/// the target, depth is in pixels. Depth is linear along each projected line.
pub(crate) type Seen = [f64; 3];

/// Margin on each side, as a share of the longer side of the picture.
const MARGIN: f64 = 0.04;

/// Distance of the near plane from the eye, as a share of the distance of the target. Surfaces
/// nearer to the eye are cut off.
const NEAR: f64 = 0.02;

impl Camera {
    /// Builds a parallel camera that shows all boxes. The longer side of the picture has
    /// `longer_side` pixels, and the other side as many as the boxes need.
    pub(crate) fn around(boxes: &[Bounds], directions: Directions, longer_side: u32) -> Self {
        let longer = f64::from(longer_side);
        let mut camera = Self { directions, target: [0.0; 3], scale: 1.0, size: [longer_side; 2], eye: None };
        let Some((middle, extent)) = extents(boxes.iter().flat_map(corners), directions) else { return camera };
        camera.target = middle;
        let longest = extent[0].max(extent[1]);
        if longest > 0.0 {
            let usable = longer * (1.0 - 2.0 * MARGIN);
            camera.scale = usable / longest;
            camera.size = extent.map(|length| (length / longest * usable + 2.0 * MARGIN * longer).ceil() as u32);
        }
        camera
    }

    /// Builds a parallel camera that shows all points in a picture of a given size. `margin` is
    /// the size of the picture relative to its content.
    pub(crate) fn framing(
        points: impl Iterator<Item = Vector> + Clone,
        directions: Directions,
        size: [u32; 2],
        margin: f64,
    ) -> Self {
        let mut camera = Self { directions, target: [0.0; 3], scale: 1.0, size, eye: None };
        let reach = points.clone().flatten().fold(1e-300_f64, |reach, x| reach.max(x.abs()));
        if let Some((middle, extent)) = extents(points, directions) {
            camera.target = middle;
            let fitting = |k: usize| f64::from(size[k]) / extent[k].max(1e-9 * reach);
            camera.scale = fitting(0).min(fitting(1)) / margin;
        }
        camera
    }

    /// Builds a camera that looks at a point, so that a sphere of a radius around it touches the
    /// upper and lower side of the picture. `half_view` is the tangent of half the vertical field
    /// of view, or `None` without perspective.
    pub(crate) fn at(
        target: Vector,
        radius: f64,
        directions: Directions,
        size: [u32; 2],
        half_view: Option<f64>,
    ) -> Self {
        let half = 0.5 * f64::from(size[1].min(size[0]));
        let eye = half_view.map(|tangent| 0.5 * f64::from(size[1]) / tangent);
        Self { directions, target, scale: half / radius, size, eye }
    }

    pub(crate) fn directions(&self) -> &Directions {
        &self.directions
    }

    /// Returns width and height in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the pixels per unit of length at the target.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns the position of the eye, or of a point far enough before the target without
    /// perspective.
    pub(crate) fn eye(&self) -> Vector {
        let pixels = self.eye.unwrap_or_else(|| f64::from(self.size[0].max(self.size[1])));
        minus(self.target, times(self.directions[2], pixels / self.scale))
    }

    /// Projects a point of the world that is not behind the near plane.
    pub(crate) fn project(&self, point: Vector) -> Seen {
        self.seen(self.in_view(point))
    }

    /// Projects a segment of the world, without the part behind the near plane. Returns `None` if
    /// nothing is left.
    pub(crate) fn segment(&self, ends: [Vector; 2]) -> Option<[Seen; 2]> {
        let [mut a, mut b] = ends.map(|end| self.in_view(end));
        match (self.is_near(a), self.is_near(b)) {
            (true, true) => return None,
            (true, false) => a = self.on_near_plane(a, b),
            (false, true) => b = self.on_near_plane(b, a),
            (false, false) => {}
        }
        Some([self.seen(a), self.seen(b)])
    }

    /// Projects a triangle of the world without the part behind the near plane, as no, one or two
    /// triangles.
    pub(crate) fn triangle(&self, triangle: &[Vector; 3], mut found: impl FnMut([Seen; 3])) {
        let view = triangle.map(|corner| self.in_view(corner));
        if self.eye.is_none() || !view.iter().any(|&corner| self.is_near(corner)) {
            return found(view.map(|corner| self.seen(corner)));
        }
        let mut polygon = Vec::with_capacity(4);
        for (k, &from) in view.iter().enumerate() {
            let to = view[(k + 1) % 3];
            if !self.is_near(from) {
                polygon.push(from);
            }
            if self.is_near(from) != self.is_near(to) {
                polygon.push(self.on_near_plane(from, to));
            }
        }
        for k in 2..polygon.len() {
            found([polygon[0], polygon[k - 1], polygon[k]].map(|corner| self.seen(corner)));
        }
    }

    /// Returns a point in pixels right, down and away from the target, before perspective.
    fn in_view(&self, point: Vector) -> Vector {
        let offset = times(minus(point, self.target), self.scale);
        self.directions.map(|direction| dot(direction, offset))
    }

    fn seen(&self, view: Vector) -> Seen {
        let [x, y, z] = match self.eye {
            Some(eye) => times(view, eye / (view[2] + eye)),
            None => view,
        };
        [x + 0.5 * f64::from(self.size[0]), y + 0.5 * f64::from(self.size[1]), z]
    }

    fn near(&self) -> f64 {
        self.eye.map_or(f64::NEG_INFINITY, |eye| (NEAR - 1.0) * eye)
    }

    fn is_near(&self, view: Vector) -> bool {
        view[2] < self.near()
    }

    /// Returns the point of a segment on the near plane, between its ends on both sides.
    fn on_near_plane(&self, from: Vector, to: Vector) -> Vector {
        let share = (self.near() - from[2]) / (to[2] - from[2]);
        let [x, y, _] = add(from, times(minus(to, from), share));
        [x, y, self.near()]
    }
}

/// Returns the middle of some points in the world, and their extents to the right and down.
/// Returns `None` without points.
fn extents(points: impl Iterator<Item = Vector> + Clone, directions: Directions) -> Option<(Vector, [f64; 2])> {
    // Divide by the largest coordinate, so that nothing overflows.
    let reach = points.clone().flatten().fold(0.0_f64, |reach, x| reach.max(x.abs()));
    let reach = if reach > 0.0 { reach } else { 1.0 };
    let first = points.clone().next()?.map(|x| x / reach);
    let seen = points.map(|point| {
        let offset = minus(point.map(|x| x / reach), first);
        directions.map(|direction| dot(direction, offset))
    });
    let bounds = around(seen)?;
    let middle = center(bounds);
    let world = (0..3).fold(first, |sum, k| add(sum, times(directions[k], middle[k])));
    Some((times(world, reach), [0, 1].map(|k| (bounds[1][k] - bounds[0][k]) * reach)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::axes::{Axis, from_front_right, looking};

    #[test]
    fn boxes_of_any_size_fit_into_the_picture() {
        for scale in [1e-30, 1.0, 1e38] {
            for up in [Axis::X, Axis::Y, Axis::Z] {
                let boxes = [[[-scale, 0.0, 0.0], [scale, scale, 3.0 * scale]], [[0.0; 3], [2.0 * scale; 3]]];
                let camera = Camera::around(&boxes, from_front_right(up), 400);
                let [width, height] = camera.size().map(f64::from);
                assert!(width.max(height) <= 401.0 && width.min(height) > 100.0, "{width} x {height}");
                for corner in boxes.iter().flat_map(corners) {
                    let [x, y, z] = camera.project(corner);
                    assert!((10.0..width - 10.0).contains(&x) && (10.0..height - 10.0).contains(&y) && z.is_finite());
                }
                let top = times(up.direction(), scale);
                assert!(camera.project(top)[1] < camera.project([0.0; 3])[1], "up is up");
            }
        }
    }

    #[test]
    fn a_box_without_extent_is_projected_to_finite_coordinates() {
        let directions = from_front_right(Axis::Y);
        let camera = Camera::around(&[[[3.0; 3]; 2]], directions, 400);
        assert!(camera.project([3.0; 3]).iter().all(|x| x.is_finite()));
        assert_eq!(Camera::around(&[], directions, 400).size(), [400, 400]);
        let camera = Camera::framing([[3.0; 3]].into_iter(), directions, [40, 30], 1.1);
        assert_eq!(camera.project([3.0; 3]), [20.0, 15.0, 0.0]);
    }

    #[test]
    fn a_millimeter_is_a_millimeter_500_kilometers_from_the_origin() {
        let far = [500_000.0, 4_500_000.0, 120.0];
        let camera = Camera::at(far, 0.01, looking([1.0, 0.5, -0.25], Axis::Z), [800, 600], Some(0.5));
        let near = Camera::at([0.0; 3], 0.01, looking([1.0, 0.5, -0.25], Axis::Z), [800, 600], Some(0.5));
        for offset in [[0.001, 0.0, 0.0], [0.0, -0.004, 0.002]] {
            let [a, b] = [camera.project(add(far, offset)), near.project(offset)];
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-3), "{a:?} {b:?}");
        }
    }

    #[test]
    fn perspective_makes_far_things_smaller_and_cuts_what_is_behind_the_eye() {
        let camera = Camera::at([0.0; 3], 1.0, looking([0.0, 1.0, 0.0], Axis::Z), [200, 200], Some(1.0));
        assert_eq!(camera.eye(), [0.0, -1.0, 0.0]);
        let [near, far] = [-0.5, 1.0].map(|y| camera.project([0.5, y, 0.0]));
        assert_eq!((near[0], far[0]), (200.0, 125.0));
        assert!(near[2] < 0.0 && far[2] > 0.0);
        assert_eq!(camera.segment([[0.0, -3.0, 0.0], [0.0, -2.0, 1.0]]), None);
        let [from, _] = camera.segment([[0.0, -3.0, 0.0], [0.0, 3.0, 0.0]]).unwrap();
        assert_eq!([from[0], from[1]], [100.0, 100.0]);
        let mut pieces = Vec::new();
        let cut = [[-1.0, -2.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]];
        camera.triangle(&cut, |piece| pieces.push(piece));
        assert_eq!(pieces.len(), 2);
        assert!(pieces.as_flattened().as_flattened().iter().all(|x| x.is_finite()));
    }
}
