//! A character in one pose: which of its parts are struck by rays, punches, shapes and other
//! characters.

use std::sync::Arc;

use impinge::character::{HitHull, HitVolume, PartHit, PartPair, Posed, RigPose, Strike, SurfaceHit, SurfaceRays};
use impinge::mesh::Ray;
use impinge::query::batch::Broadcast;
use impinge::volume::{BoundingSphere, Capsule};
use impinge::{InputError, Pose};
use pyo3::prelude::*;

use crate::arrays::{array, ragged, row_array};
use crate::character::Fitted;
use crate::errors::{Fault, kind_and_place, message};
use crate::mesh::{MeshBase, mesh_of};
use crate::motions::matrix;
use crate::points::Points;
use crate::poses;
use crate::rays::Rays;
use crate::shapes::read_shape;
use crate::workers::{self, Call};

/// Number of rays that a thread takes at a time. The parts are placed once for each block.
const BLOCK: usize = 256;

/// Contents of `impinge.CharacterPose`.
#[pyclass(frozen, module = "impinge._impinge")]
pub(crate) struct PosedCore(Arc<Placing>);

struct Placing {
    fitted: Arc<Fitted>,
    pose: RigPose,
    origin: [f64; 3],
}

impl Placing {
    fn posed(&self) -> Posed<'_> {
        let mut posed = Posed::new(&self.fitted.character, &self.pose);
        posed.set_at(&self.pose, self.origin);
        posed
    }
}

impl PosedCore {
    pub(crate) fn new(fitted: Arc<Fitted>, pose: RigPose, origin: [f64; 3]) -> Self {
        Self(Arc::new(Placing { fitted, pose, origin }))
    }

    /// Returns the answers of `ask` for all rays. `ask` gets a block of rays.
    ///
    /// # Errors
    /// `InputError` if a ray is invalid.
    fn ask<T: Clone + Send + Sync + 'static>(
        &self,
        py: Python<'_>,
        rays: &Rays,
        ask: impl Fn(&Placing, &[Ray]) -> Vec<T> + Send + Sync + 'static,
    ) -> PyResult<Vec<T>> {
        let ray = |row| {
            let [origin, direction] = rays.at(row);
            let place = |error| fault(&error, "directions", Broadcast::place(rays.lead(), row)).raised(py);
            Ray::new(origin, direction).map_err(place)
        };
        let (placing, count) = (self.0.clone(), rays.len());
        let all: Vec<Ray> = (0..count).map(ray).collect::<PyResult<_>>()?;
        let call = Call { rows: count.div_ceil(BLOCK), is_brief: count <= BLOCK, progress: false };
        let of = move |block: usize| ask(&placing, &all[block * BLOCK..count.min((block + 1) * BLOCK)]);
        Ok(workers::rows(py, call, of)?.into_iter().flatten().collect())
    }
}

fn fault(error: &InputError, argument: &str, at: Vec<usize>) -> Fault {
    Fault::new(kind_and_place(error).0, argument, message(error)).at(at).hint(error.hint())
}

#[pymethods]
impl PosedCore {
    /// Returns the poses that map the frames of the parts' volumes to the world frame, (p, 4, 4).
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let posed = self.0.posed();
        let frames = posed.frames().iter().map(|frame| frame.pose().map(|pose| matrix(&pose)));
        let frames: Result<Vec<[f64; 16]>, InputError> = frames.collect();
        let frames = frames.map_err(|error| fault(&error, "origin", Vec::new()).raised(py))?;
        let count = frames.len();
        array(py, frames.into_flattened(), &[count, 4, 4])
    }

    /// Returns the lower and the upper corner of a box around all volumes, (2, 3), in the world
    /// frame.
    fn bounds(&self) -> [[f64; 3]; 2] {
        self.0.posed().outer()
    }

    /// Returns the vertices of the skinned surface, (n, 3), in the world frame.
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let placing = self.0.clone();
        let vertices = workers::run(py, move |_| {
            let mut vertices = Vec::new();
            placing.fitted.rig.skin().skinned(&placing.pose, &mut vertices);
            for vertex in &mut vertices {
                *vertex = std::array::from_fn(|k| vertex[k] + placing.origin[k]);
            }
            vertices
        })?;
        let count = vertices.len();
        row_array(py, vertices, &[count])
    }

    /// Returns whether each ray in the world frame strikes a part, (...), and the columns of hits
    /// with these leading axes.
    fn ray_cast<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, rays) = (origins.py(), Rays::read(origins, directions)?);
        let found = self.ask(py, &rays, |placing, rays| {
            let posed = placing.posed();
            rays.iter().map(|ray| posed.ray_cast(ray)).collect()
        })?;
        let hit = array(py, found.iter().map(Option::is_some).collect(), rays.lead())?;
        Ok((hit, columns(py, &found, rays.lead())?).into_pyobject(py)?.into_any())
    }

    /// Returns whether each ray hits the skinned surface, (...), part, bone, face and ray parameter
    /// t, (...), and point, (..., 3). Rays and points are in the world frame.
    fn surface_ray_cast<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, rays) = (origins.py(), Rays::read(origins, directions)?);
        let found = self.ask(py, &rays, |placing, rays| {
            let Fitted { rig, character } = &*placing.fitted;
            let mut surface = SurfaceRays::new(character, rig, &placing.pose);
            surface.set_at(&placing.pose, placing.origin);
            rays.iter().map(|ray| surface.ray_cast(ray)).collect()
        })?;
        let numbers = |of: fn(&SurfaceHit) -> u32| {
            let numbers = found.iter().map(|hit| hit.as_ref().map_or(-1, |hit| i64::from(of(hit))));
            array(py, numbers.collect(), rays.lead())
        };
        let columns = (
            array(py, found.iter().map(Option::is_some).collect(), rays.lead())?,
            numbers(|hit| hit.part)?,
            numbers(|hit| hit.bone)?,
            numbers(|hit| hit.face)?,
            array(py, found.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect(), rays.lead())?,
            row_array(py, found.iter().map(|hit| hit.map_or([0.0; 3], |hit| hit.point)).collect(), rays.lead())?,
        );
        Ok(columns.into_pyobject(py)?.into_any())
    }

    /// Returns the poses of the parts as bodies, (p, 4, 4). Their shapes are those of
    /// `CharacterCore.shapes`.
    fn body_poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let posed = self.0.posed();
        let poses = posed.character().parts().iter().zip(posed.frames()).map(|(part, frame)| {
            let (_, world_from_shape) = part.volume().shape_in(frame.pose()?)?;
            Ok(matrix(&world_from_shape))
        });
        let poses: Result<Vec<[f64; 16]>, InputError> = poses.collect();
        let poses = poses.map_err(|error| fault(&error, "origin", Vec::new()).raised(py))?;
        let count = poses.len();
        array(py, poses.into_flattened(), &[count, 4, 4])
    }

    /// Returns the offsets of the hits of each ray, columns with the hits of all rays, (k,), and
    /// the leading axes.
    fn ray_cast_all<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, rays) = (origins.py(), Rays::read(origins, directions)?);
        let shape = rays.lead().to_vec();
        let (offsets, hits) = ragged(self.ask(py, &rays, |placing, rays| {
            let posed = placing.posed();
            rays.iter().map(|ray| posed.ray_cast_all(ray)).collect()
        })?);
        let (places, count) = (offsets.len(), hits.len());
        let hits: Vec<Option<PartHit>> = hits.into_iter().map(Some).collect();
        Ok((array(py, offsets, &[places])?, columns(py, &hits, &[count])?, shape).into_pyobject(py)?.into_any())
    }

    /// Returns the columns of the parts that a shape, or the surface of a mesh, strikes at a pose.
    fn struck_by<'py>(&self, shape: &Bound<'py, PyAny>, pose: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = shape.py();
        let pose = poses::read_one(pose, "pose", "one pose is expected, (4, 4)")?;
        let placing = self.0.clone();
        let hits = if shape.cast::<MeshBase>().is_ok() {
            let mesh = mesh_of(shape, "shape")?;
            workers::run(py, move |_| placing.posed().struck_by_mesh(mesh.at(pose)))?
        } else {
            let shape = read_shape(shape, "shape", false)?.shape;
            workers::run(py, move |_| placing.posed().struck_by(&shape.at(pose)?))?
        };
        let hits = hits.map_err(|error| fault(&error, "pose", Vec::new()).raised(py))?;
        let hits: Vec<Option<PartHit>> = hits.into_iter().map(Some).collect();
        columns(py, &hits, &[hits.len()])
    }

    /// Returns the columns of the pairs of parts that intersect those of another character.
    fn struck_by_character<'py>(&self, py: Python<'py>, other: &Self) -> PyResult<Bound<'py, PyAny>> {
        let (own, other) = (self.0.clone(), other.0.clone());
        let pairs = workers::run(py, move |_| own.posed().struck_by_character(&other.posed()))?;
        let pairs = pairs.map_err(|error| fault(&error, "other", Vec::new()).raised(py))?;
        let count = pairs.len();
        let parts =
            |of: fn(&PartPair) -> u32| array(py, pairs.iter().map(|pair| i64::from(of(pair))).collect(), &[count]);
        let vectors = |of: fn(&PartPair) -> [f64; 3]| row_array(py, pairs.iter().map(of).collect(), &[count]);
        let columns = (
            parts(|pair| pair.part_a)?,
            parts(|pair| pair.part_b)?,
            vectors(|pair| pair.point)?,
            vectors(|pair| pair.normal)?,
            array(py, pairs.iter().map(|pair| pair.depth).collect(), &[count])?,
        );
        Ok(columns.into_pyobject(py)?.into_any())
    }

    /// Returns the columns of the parts that a volume strikes while it moves from one pose to
    /// another, and the character moves to another pose of its own. The volume is the hull of
    /// points swept by a sphere of a radius, as in `Character.parts`.
    fn strikes<'py>(
        &self,
        to: &Self,
        volume: (&str, Bound<'py, PyAny>, f64),
        from_pose: &Bound<'py, PyAny>,
        to_pose: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = from_pose.py();
        if !Arc::ptr_eq(&self.0.fitted, &to.0.fitted) {
            let message = "is a pose of another character";
            return Err(Fault::new("type", "to", message).raised(py));
        }
        let (kind, points, radius) = volume;
        let points = Points::read(&points, "volume", 128)?.rows;
        let volume = match (kind, &points[..]) {
            ("sphere", &[center]) => BoundingSphere::new(center, radius).map(HitVolume::Sphere),
            ("capsule", &[start, end]) => Capsule::new(start, end, radius).map(HitVolume::Capsule),
            _ => HitHull::new(&points).map(HitVolume::Hull),
        };
        let volume = volume.map_err(|error| fault(&error, "volume", Vec::new()).raised(py))?;
        let (from, there) = (
            poses::read_one(from_pose, "pose_t0", "one pose is expected, (4, 4)")?,
            poses::read_one(to_pose, "pose_t1", "one pose is expected, (4, 4)")?,
        );
        let (own, to) = (self.0.clone(), to.0.clone());
        let strikes = workers::run(py, move |_| {
            let strikes = |end: &Pose| own.posed().strikes(&to.posed(), &volume, &from, end);
            // If the first pose alone is rejected too, the first pose is the invalid one.
            strikes(&there)
                .map_err(|error| if strikes(&from).is_err() { (error, "pose_t0") } else { (error, "pose_t1") })
        })?;
        let strikes = strikes.map_err(|(error, name)| fault(&error, name, Vec::new()).raised(py))?;
        let hit = |strike: Strike| {
            let Strike { part, bone, t, point, normal, depth } = strike;
            Some(PartHit { part, bone, t, point, normal, depth })
        };
        let hits: Vec<Option<PartHit>> = strikes.into_iter().map(hit).collect();
        columns(py, &hits, &[hits.len()])
    }
}

/// Returns part, bone and ray parameter t, (...), point and normal, (..., 3), and depth, (...), in
/// the world frame. If nothing is struck, the indices are -1, t is infinite and the other numbers
/// are zero.
fn columns<'py>(py: Python<'py>, hits: &[Option<PartHit>], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    let numbers = |of: fn(&PartHit) -> u32| {
        array(py, hits.iter().map(|hit| hit.as_ref().map_or(-1, |hit| i64::from(of(hit)))).collect(), shape)
    };
    let vectors = |of: fn(&PartHit) -> [f64; 3]| {
        row_array(py, hits.iter().map(|hit| hit.as_ref().map_or([0.0; 3], of)).collect(), shape)
    };
    let columns = (
        numbers(|hit| hit.part)?,
        numbers(|hit| hit.bone)?,
        array(py, hits.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t)).collect(), shape)?,
        vectors(|hit| hit.point)?,
        vectors(|hit| hit.normal)?,
        array(py, hits.iter().map(|hit| hit.map_or(0.0, |hit| hit.depth)).collect(), shape)?,
    );
    Ok(columns.into_pyobject(py)?.into_any())
}
