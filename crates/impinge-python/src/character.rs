//! Rigged characters in Python: a rig from a file, with volumes fitted to its parts.

use std::path::PathBuf;
use std::sync::Arc;

use impinge::character::{Character, HitVolume, Mode, Plan, Rig, RigError};
use impinge_files::{
    Limits, LoadError, character_text, load_character_with, load_plan_with, load_rig_with, parse_character,
};
use pyo3::prelude::*;

use crate::arrays::{array, row_array};
use crate::character_pose::PosedCore;
use crate::errors::{Fault, load_error};
use crate::workers;

/// Contents of `impinge.Character`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct CharacterCore(Arc<Fitted>);

/// A rig with its volumes.
pub(crate) struct Fitted {
    pub(crate) rig: Rig,
    pub(crate) character: Character,
}

/// Reason why no character can be made.
enum Refusal {
    File(LoadError),
    Rig(RigError),
}

impl From<LoadError> for Refusal {
    fn from(error: LoadError) -> Self {
        Self::File(error)
    }
}

impl From<RigError> for Refusal {
    fn from(error: RigError) -> Self {
        Self::Rig(error)
    }
}

impl Refusal {
    fn raised(self, py: Python<'_>, path: &str) -> PyErr {
        match self {
            Self::File(error) => load_error(py, &error),
            Self::Rig(error) => Fault::new("broken-rig", path, error.to_string()).raised(py),
        }
    }
}

/// A part as a row of a table: name, indices of its bones, index of the bone that it is fixed to,
/// kind and looseness of its volume, and the points whose hull is swept by a sphere of a radius.
type Row = (String, Vec<u32>, u32, &'static str, f64, Vec<[f64; 3]>, f64);

/// A file, its `max_bytes` and its `max_triangles`.
type Limited = (PathBuf, Option<u64>, Option<u64>);

/// A part as an argument of the constructor of shapes: kind, points and numbers.
type ShapeRow<'py> = (&'static str, Bound<'py, PyAny>, Vec<f64>);

#[pymethods]
impl CharacterCore {
    /// Loads a rigged file. Volumes are fitted to at most `volumes` parts or to the parts of a
    /// plan, or read from a file of fitted volumes. If `pieces` is given, volumes are refined into
    /// hulls of at most that number of faces.
    #[new]
    #[pyo3(signature = (file, volumes, mode, plan, fitted, pieces))]
    fn new(
        py: Python<'_>,
        file: Limited,
        volumes: usize,
        mode: &str,
        plan: Option<PathBuf>,
        fitted: Option<PathBuf>,
        pieces: Option<usize>,
    ) -> PyResult<Self> {
        let mode = match mode {
            "conservative" => Mode::Conservative,
            "snug" => Mode::Snug,
            _ => {
                let message = format!("must be \"conservative\" or \"snug\", not {mode:?}");
                return Err(Fault::new("option", "mode", message).raised(py));
            }
        };
        let limits = limits_of(&file);
        Self::made(py, file, pieces, move |rig| match fitted {
            Some(fitted) => Ok(load_character_with(fitted, rig, &limits)?),
            None => {
                let plan = plan.map_or_else(
                    || Plan::automatic(rig, volumes).map_err(Refusal::from),
                    |plan| Ok(load_plan_with(plan, rig, &limits)?),
                )?;
                Ok(Character::fit(rig, &plan, mode)?)
            }
        })
    }

    /// Loads a rigged file, with the volumes in the text that `text` returned.
    #[staticmethod]
    fn reopened(py: Python<'_>, file: Limited, text: String, pieces: Option<usize>) -> PyResult<Self> {
        Self::made(py, file, pieces, move |rig| Ok(parse_character(&text, rig)?))
    }

    /// Returns name, start and end in seconds of each animation.
    fn animations(&self) -> Vec<(String, f64, f64)> {
        let of = |animation: &impinge::character::Animation| {
            let [start, end] = animation.span();
            (animation.name().to_owned(), start, end)
        };
        self.0.rig.animations().iter().map(of).collect()
    }

    /// Returns the names of the bones.
    fn bones(&self) -> Vec<String> {
        self.0.rig.skeleton().bones().iter().map(|bone| bone.name.clone()).collect()
    }

    fn parts(&self) -> Vec<Row> {
        let of = |part: &impinge::character::HitPart| {
            let (points, radius) = core(part.volume());
            let kind = part.volume().kind().name();
            (part.name.clone(), part.bones.clone(), part.anchor, kind, part.looseness, points, radius)
        };
        self.0.character.parts().iter().map(of).collect()
    }

    /// Returns the parts as shapes of bodies. `PosedCore.body_poses` has their poses.
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Vec<ShapeRow<'py>>> {
        let of = |part: &impinge::character::HitPart| {
            let (points, numbers) = match part.volume() {
                HitVolume::Sphere(sphere) => (vec![sphere.center()], vec![sphere.radius()]),
                HitVolume::Capsule(capsule) => (capsule.ends().to_vec(), vec![capsule.radius()]),
                HitVolume::Box(obb) => (Vec::new(), obb.half_extents().to_vec()),
                HitVolume::Lozenge(plate) => {
                    (vec![plate.corner(), plate.edges()[0], plate.edges()[1]], vec![plate.radius()])
                }
                HitVolume::Hull(hull) => (hull.hull().positions().to_vec(), Vec::new()),
            };
            let count = points.len();
            Ok((part.volume().kind().name(), row_array(py, points, &[count])?, numbers))
        };
        self.0.character.parts().iter().map(of).collect()
    }

    /// Returns the text of a file that stores the fitted volumes.
    fn text(&self) -> String {
        character_text(&self.0.rig, &self.0.character)
    }

    /// Returns for each part the share of its vertices outside of all volumes, and the distance of
    /// the farthest such vertex from them.
    fn leaks(&self, py: Python<'_>) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let own = self.0.clone();
        let leaks = workers::run(py, move |_| own.character.leaks(&own.rig))?;
        let leaks = leaks.map_err(|error| Refusal::Rig(error).raised(py, "character"))?;
        Ok(leaks.iter().map(|leak| (leak.share, leak.farthest)).unzip())
    }

    /// Returns the faces of the skin, (m, 3), and the part of each face, (m,).
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (faces, parts) = (self.0.rig.skin().faces(), self.0.character.part_of_face());
        Ok((row_array(py, faces.to_vec(), &[faces.len()])?, array(py, parts.to_vec(), &[parts.len()])?))
    }

    /// Returns the character at a time of an animation, or in its rest pose, with its origin at a
    /// point of the world.
    fn pose(&self, py: Python<'_>, animation: Option<usize>, time: f64, origin: [f64; 3]) -> PyResult<PosedCore> {
        let rig = &self.0.rig;
        let pose = animation.map_or_else(|| rig.rest_pose(), |animation| rig.pose_at(animation, time));
        let pose = pose.map_err(|error| Refusal::Rig(error).raised(py, "character"))?;
        Ok(PosedCore::new(self.0.clone(), pose, origin))
    }
}

impl CharacterCore {
    /// Loads a rigged file, with volumes that `fit` makes.
    fn made(
        py: Python<'_>,
        file: Limited,
        pieces: Option<usize>,
        fit: impl FnOnce(&Rig) -> Result<Character, Refusal> + Send + 'static,
    ) -> PyResult<Self> {
        let limits = limits_of(&file);
        let (path, ..) = file;
        let named = path.display().to_string();
        let made = workers::run(py, move |_| -> Result<Fitted, Refusal> {
            let rig = load_rig_with(&path, &limits)?;
            let mut character = fit(&rig)?;
            if let Some(faces) = pieces {
                character.refine(&rig, faces)?;
            }
            Ok(Fitted { rig, character })
        })?;
        Ok(Self(Arc::new(made.map_err(|refusal| refusal.raised(py, &named))?)))
    }
}

/// Returns the limits on the content of a file.
fn limits_of(&(_, max_bytes, max_triangles): &Limited) -> Limits {
    let mut limits = Limits::default();
    (limits.max_bytes, limits.max_triangles) = (max_bytes, max_triangles);
    limits
}

/// Returns the points whose hull is swept by the sphere of a volume, and the radius of the sphere.
fn core(volume: &HitVolume) -> (Vec<[f64; 3]>, f64) {
    match volume {
        HitVolume::Sphere(sphere) => (vec![sphere.center()], sphere.radius()),
        HitVolume::Capsule(capsule) => (capsule.ends().to_vec(), capsule.radius()),
        HitVolume::Box(obb) => (obb.corners().to_vec(), 0.0),
        HitVolume::Lozenge(plate) => {
            let ([u, v], corner) = (plate.edges(), plate.corner());
            let at = |s: f64, t: f64| std::array::from_fn(|k| corner[k] + s * u[k] + t * v[k]);
            (vec![corner, at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)], plate.radius())
        }
        HitVolume::Hull(hull) => (hull.hull().positions().to_vec(), 0.0),
    }
}
