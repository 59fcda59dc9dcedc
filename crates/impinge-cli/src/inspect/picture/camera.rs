//! The camera: a parallel projection, seen from a little above and to the side.

/// A parallel projection to pixels.
pub(crate) struct Camera {
    /// Directions right, down and away from the viewer, as unit vectors in the mesh frame.
    axes: [[f64; 3]; 3],
    /// Point of the mesh frame at the center of the picture.
    center: [f64; 3],
    /// Pixels per unit of length.
    scale: f64,
    size: [u32; 2],
}

/// A projected point: pixels to the right, pixels down, and depth in pixels (larger is farther
/// away).
pub(crate) type Seen = [f64; 3];

/// Margin on each side, as a share of the longer side of the picture.
const MARGIN: f64 = 0.04;

impl Camera {
    /// Builds a camera that shows all boxes, given by their (minimum, maximum) corners in the mesh
    /// frame. The longer side of the picture has `longer_side` pixels.
    pub(crate) fn around(boxes: &[[[f64; 3]; 2]], up: usize, longer_side: u32) -> Self {
        // View from the front right, turned by less than 45 degrees, so that no two edges of a box
        // hide each other.
        let mut away = [0.0; 3];
        away[up] = -0.42;
        away[(up + 1) % 3] = -0.88;
        away[(up + 2) % 3] = -0.5;
        let away = unit(away);
        let mut vertical = [0.0; 3];
        vertical[up] = -1.0;
        let right = unit(cross(vertical, away));
        let down = cross(away, right);
        let mut camera = Self { axes: [right, down, away], center: [0.0; 3], scale: 1.0, size: [longer_side; 2] };

        // Divide by the largest coordinate, so that nothing overflows.
        let reach = boxes.as_flattened().as_flattened().iter().fold(0.0_f64, |reach, x| reach.max(x.abs()));
        if reach == 0.0 {
            return camera;
        }
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in boxes.iter().flat_map(corners) {
            let seen = camera.along_axes(corner.map(|x| x / reach));
            for axis in 0..3 {
                low[axis] = low[axis].min(seen[axis]);
                high[axis] = high[axis].max(seen[axis]);
            }
        }
        let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
        camera.center =
            std::array::from_fn(|axis| (0..3).map(|i| middle[i] * camera.axes[i][axis]).sum::<f64>() * reach);
        let extent = [0, 1].map(|axis| high[axis] - low[axis]);
        let longest = extent[0].max(extent[1]);
        if longest > 0.0 {
            let usable = f64::from(longer_side) * (1.0 - 2.0 * MARGIN);
            camera.scale = usable / longest / reach;
            let sides = extent.map(|length| length / longest * usable + 2.0 * MARGIN * f64::from(longer_side));
            camera.size = sides.map(|side| side.ceil() as u32);
        }
        camera
    }

    /// Returns the unit vectors of the mesh frame that point right and down in the picture.
    pub(crate) fn right_and_down(&self) -> [[f64; 3]; 2] {
        [self.axes[0], self.axes[1]]
    }

    /// Returns width and height in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Projects a point of the mesh frame into the picture.
    pub(crate) fn project(&self, point: [f64; 3]) -> Seen {
        let seen = self.along_axes(std::array::from_fn(|axis| (point[axis] - self.center[axis]) * self.scale));
        [seen[0] + 0.5 * f64::from(self.size[0]), seen[1] + 0.5 * f64::from(self.size[1]), seen[2]]
    }

    /// Returns the brightness of a triangle, the same from both sides: 0 if it is seen edge on, 1
    /// if the light is perpendicular to it.
    pub(crate) fn shade(&self, corners: &[[f64; 3]; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| self.project(corner));
        let from_a = |p: Seen| [0, 1, 2].map(|axis| p[axis] - a[axis]);
        let normal = cross(from_a(b), from_a(c));
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        // The light comes over the viewer's left shoulder.
        let light = unit([-0.35, -0.55, -1.0]);
        let facing = (0..3).map(|axis| normal[axis] * light[axis]).sum::<f64>().abs();
        if length > 0.0 && length.is_finite() { facing / length } else { 0.0 }
    }

    fn along_axes(&self, point: [f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| (0..3).map(|k| axis[k] * point[k]).sum())
    }
}

/// Returns the eight corners of a box. Bit k of a corner's index is set if the corner has the
/// maximum k-th coordinate.
pub(crate) fn corners([min, max]: &[[f64; 3]; 2]) -> [[f64; 3]; 8] {
    std::array::from_fn(|corner| {
        std::array::from_fn(|axis| if corner >> axis & 1 == 1 { max[axis] } else { min[axis] })
    })
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_of_any_size_fit_into_the_picture() {
        for scale in [1e-30, 1.0, 1e38] {
            for up in 0..3 {
                let boxes = [[[-scale, 0.0, 0.0], [scale, scale, 3.0 * scale]], [[0.0; 3], [2.0 * scale; 3]]];
                let camera = Camera::around(&boxes, up, 400);
                let [width, height] = camera.size().map(f64::from);
                assert!(width.max(height) <= 401.0 && width.min(height) > 100.0, "{width} x {height}");
                for corner in boxes.iter().flat_map(corners) {
                    let [x, y, z] = camera.project(corner);
                    assert!((10.0..width - 10.0).contains(&x) && (10.0..height - 10.0).contains(&y) && z.is_finite());
                }
                let mut top = [0.0; 3];
                top[up] = scale;
                assert!(camera.project(top)[1] < camera.project([0.0; 3])[1], "up is up");
            }
        }
    }

    #[test]
    fn a_box_without_extent_is_projected_to_finite_coordinates() {
        let camera = Camera::around(&[[[3.0; 3]; 2]], 1, 400);
        assert!(camera.project([3.0; 3]).iter().all(|x| x.is_finite()));
        assert_eq!(Camera::around(&[], 1, 400).size(), [400, 400]);
    }
}
