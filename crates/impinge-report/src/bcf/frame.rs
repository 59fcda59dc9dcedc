//! The frame of BCF: meters, Z up, and the world coordinates of the model.

use impinge_files::Unit;

use crate::picture::Axis;

/// The map from a scene to the frame of BCF.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) unit: Unit,
    /// The axis of the scene that points up.
    pub(super) up: Axis,
    /// Point of the model, in the axes and the unit of the scene, that is the origin of the scene.
    pub(super) origin: [f64; 3],
}

impl Frame {
    /// Returns a point of the scene in the frame of BCF.
    pub(super) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let meters = self.unit.meters();
        self.direction([0, 1, 2].map(|k| (point[k] + self.origin[k]) * meters))
    }

    /// Returns a direction of the scene in the frame of BCF.
    pub(super) fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self.up {
            Axis::X => [y, z, x],
            // Adding zero makes a negative zero positive.
            Axis::Y => [x, -z + 0.0, y],
            Axis::Z => [x, y, z],
        }
    }

    /// Returns the directions of the axes of BCF in the scene.
    pub(super) fn axes(&self) -> [[f64; 3]; 3] {
        match self.up {
            Axis::X => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            Axis::Y => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
            Axis::Z => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gltf_is_rotated_to_z_up_and_far_models_get_their_origin_back() {
        let frame = Frame { unit: Unit::Millimeter, up: Axis::Y, origin: [5e8, 1e5, -4.5e9] };
        assert_eq!(frame.point([250.0, 0.0, 0.0]), [500_000.25, 4_500_000.0, 100.0]);
        assert_eq!(frame.direction([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        for up in [Axis::X, Axis::Y, Axis::Z] {
            let frame = Frame { up, ..frame };
            let turned = frame.axes().map(|axis| frame.direction(axis));
            assert_eq!(turned, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
            assert_eq!(frame.axes()[2], up.direction());
        }
    }
}
