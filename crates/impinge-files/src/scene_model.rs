//! The content of a file as a scene: meshes, and the parts that place them.

use impinge::{
    Mesh, Pose, Positions, Shape,
    scene::{Details, Scene},
};
use rayon::prelude::*;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    model::Warning,
    unit::Unit,
};

/// The parts of a file at their poses, which share meshes.
#[derive(Clone, Debug)]
pub struct SceneModel {
    /// The meshes, each in a frame of its own, in the order in which parts first use them.
    pub meshes: Vec<SceneMesh>,
    /// The parts that have triangles, in the order of the file.
    pub parts: Vec<ScenePart>,
    /// The unit of the scene; `None` if it is not known.
    pub unit: Option<Unit>,
    /// The point of the file that is the origin of the scene, in the unit of the scene.
    pub origin: [f64; 3],
    /// Content that was skipped or is unusual.
    pub warnings: Vec<Warning>,
    /// The format in which the file was read.
    pub format: Format,
}

/// The triangles of a mesh that one part or several parts use.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMesh {
    /// The vertices in the frame of the mesh and the unit of the scene. Their magnitudes are below
    /// 2^128.
    pub positions: Positions,
    /// Three vertex indices per triangle; degenerate triangles are kept.
    pub faces: Vec<[u32; 3]>,
    /// For each triangle, the index of its polygon, counted from zero through all meshes of the
    /// file.
    pub sources: Vec<u32>,
}

/// A part of a scene: a mesh at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePart {
    /// Name that no other part has.
    pub name: String,
    /// Key, which no other part has, type, path and further properties.
    pub details: Details,
    /// Index of the mesh in [`SceneModel::meshes`].
    pub mesh: usize,
    /// Map from the frame of the mesh to the frame of the scene.
    pub world_from_part: Pose,
}

impl SceneModel {
    /// Takes out the meshes and builds each of them once, on all threads of the current rayon pool.
    ///
    /// # Errors
    /// Returns an error if there is not enough memory.
    ///
    /// # Complexity
    /// That of [`Mesh::new`] for the meshes, however many parts share them.
    pub fn take_meshes(&mut self) -> Result<Vec<Mesh>, LoadError> {
        let built = std::mem::take(&mut self.meshes).into_par_iter().enumerate().map(|(number, mesh)| {
            Mesh::new(mesh.positions, mesh.faces).map_err(|error| {
                let kind = LoadErrorKind::Corrupt { what: error.to_string() };
                LoadError::new(kind).at(Place::Entry(format!("mesh {number} of the scene")))
            })
        });
        built.collect()
    }

    /// Builds the scene. `shape_of` makes the shape of a mesh: its surface or its solid.
    ///
    /// ```
    /// use impinge::{Shape, scene::Question};
    /// use impinge_files::{Format, SceneOptions, parse_scene};
    ///
    /// let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no floor\nf 1 2 3\no wall\nf 1 2 4\n";
    /// let model = parse_scene(text.as_bytes(), Format::Obj, &SceneOptions::default())?;
    /// let scene = model.into_scene(|mesh| Shape::from(mesh))?;
    /// let pairs = scene.pairs(Question::Intersects)?;
    /// assert_eq!(pairs[0].map(|part| scene.name(part)), ["floor", "wall"]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if there is not enough memory, or if a part cannot be added, because
    /// `shape_of` returned a shape that its pose does not allow, or because parts were changed to
    /// have equal names.
    ///
    /// # Panics
    /// Panics if a part was changed to use a mesh that does not exist.
    ///
    /// # Complexity
    /// That of [`take_meshes`](Self::take_meshes), and linear in the number of parts.
    pub fn into_scene(mut self, shape_of: impl Fn(&Mesh) -> Shape) -> Result<Scene, LoadError> {
        let shapes: Vec<Shape> = self.take_meshes()?.iter().map(shape_of).collect();
        let mut scene = Scene::new();
        for part in self.parts {
            let added = scene.add(part.name, &shapes[part.mesh], part.world_from_part);
            let id = added.map_err(|error| LoadError::new(LoadErrorKind::Corrupt { what: error.to_string() }))?;
            scene.set_details(id, part.details);
        }
        Ok(scene)
    }
}
