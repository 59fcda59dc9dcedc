//! The frame of a loaded scene: its unit, and the point that becomes its origin.

use impinge::{Pose, Positions};

use crate::{
    error::{LoadError, LoadErrorKind},
    instance::Affine,
    model::stored,
    unit::{Conversion, Unit},
};

/// Maximum magnitude of a coordinate of a mesh, 2^128.
const LIMIT: f64 = (1_u128 << 127) as f64 * 2.0;

/// The map from the frame of a file to the frame of a scene: a conversion of units, and then the
/// subtraction of the origin.
#[derive(Clone, Copy)]
pub(crate) struct SceneFrame {
    /// Unit of the scene; `None` if it is not known.
    pub(crate) unit: Option<Unit>,
    conversion: Option<Conversion>,
    /// Point, in the frame of the file and the unit of the scene, that becomes the origin.
    origin: [f64; 3],
}

impl SceneFrame {
    /// Returns the map for a file in unit `stated`. If either unit is not known, lengths stay as
    /// they are.
    pub(crate) fn new(stated: Option<Unit>, wanted: Option<Unit>, origin: [f64; 3]) -> Self {
        let conversion = stated.zip(wanted).filter(|(from, to)| from != to).map(|(from, to)| from.to(to));
        Self { unit: wanted.or(stated), conversion, origin }
    }

    fn length(&self, x: f64) -> f64 {
        self.conversion.map_or(x, |conversion| conversion.apply(x))
    }

    /// Returns a point of the file in the frame of the scene.
    fn point(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.length(point[k]) - self.origin[k])
    }

    /// Returns the pose in the scene of a mesh that `world` places in the file. The mesh keeps its
    /// own frame, and only its unit is converted. Returns `None` if the map is no valid pose, for
    /// example because it is flat.
    pub(crate) fn pose(&self, world: &Affine) -> Option<Pose> {
        let linear = world.rows.map(|[a, b, c, _]| [a, b, c]);
        Pose::new(linear, self.point(world.rows.map(|row| row[3]))).ok()
    }

    /// Returns the vertices of a mesh in its own frame, in the unit of the scene.
    ///
    /// # Errors
    /// Returns an error that names the first vertex with a coordinate that is too large for a mesh.
    pub(crate) fn in_own_frame(&self, positions: Positions) -> Result<Positions, LoadError> {
        match self.conversion {
            None => in_range(positions),
            Some(_) => self.mapped(&positions, |p| p.map(|x| self.length(x))),
        }
    }

    /// Returns vertices of the file in the frame of the scene, after they are placed by `world`.
    ///
    /// # Errors
    /// As for [`in_own_frame`](Self::in_own_frame).
    pub(crate) fn in_scene(&self, positions: &Positions, world: &Affine) -> Result<Positions, LoadError> {
        self.mapped(positions, |p| self.point(world.apply(p)))
    }

    fn mapped(&self, positions: &Positions, map: impl Fn([f64; 3]) -> [f64; 3]) -> Result<Positions, LoadError> {
        in_range(stored((0..positions.len()).map(|at| map(positions.get(at))).collect()))
    }

    /// Reports whether the frame of the scene is that of the file.
    pub(crate) fn is_that_of_the_file(&self) -> bool {
        self.conversion.is_none() && self.origin == [0.0; 3]
    }
}

/// Returns the positions if all are in the range of a mesh.
fn in_range(positions: Positions) -> Result<Positions, LoadError> {
    let beyond = match &positions {
        Positions::F32(rows) => rows.iter().position(|row| row.iter().any(|x| !x.is_finite())),
        Positions::F64(rows) => rows.iter().position(|row| row.iter().any(|x| x.is_nan() || x.abs() >= LIMIT)),
    };
    match beyond {
        None => Ok(positions),
        Some(vertex) => Err(LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_subtracted_before_coordinates_are_rounded() {
        let far = Positions::F64(vec![[5_000_000.125, -300_000.25, 0.5]]);
        let frame = SceneFrame::new(None, None, [5_000_000.0, -300_000.0, 0.0]);
        let near = frame.in_scene(&far, &Affine::IDENTITY).unwrap();
        assert_eq!(near, Positions::F32(vec![[0.125, -0.25, 0.5]]));
    }

    #[test]
    fn units_convert_meshes_and_translations_alike() {
        let frame = SceneFrame::new(Some(Unit::Inch), Some(Unit::Millimeter), [0.0, 0.0, 1.0]);
        let rows = [[0.0, -1.0, 0.0, 2.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let pose = frame.pose(&Affine { rows }).unwrap();
        assert_eq!(pose.translation(), &[50.8, 0.0, -1.0]);
        let own = frame.in_own_frame(Positions::F32(vec![[5.0, 0.0, 0.0]])).unwrap();
        assert_eq!(pose.apply(own.get(0)), [50.8, 127.0, -1.0]);
        let placed = frame.in_scene(&Positions::F32(vec![[5.0, 0.0, 0.0]]), &Affine { rows }).unwrap();
        assert_eq!(placed.get(0), [50.8, 127.0, -1.0]);
        assert_eq!(frame.unit, Some(Unit::Millimeter));
    }

    #[test]
    fn maps_that_are_no_poses_and_coordinates_that_are_too_large_are_refused() {
        let frame = SceneFrame::new(None, None, [0.0; 3]);
        let flat = Affine { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]] };
        assert_eq!(frame.pose(&flat), None);
        let far = Positions::F64(vec![[0.0; 3], [0.0, 1e40, 0.0]]);
        let error = frame.in_own_frame(far).unwrap_err();
        assert_eq!(error.kind(), &LoadErrorKind::NonFinite { vertex: 1 });
    }
}
