//! The parts of a document as a scene: each mesh once, in its own frame, and each instance with its
//! pose.

use std::{collections::HashMap, path::Path};

use impinge::{Pose, Positions};

use super::{
    Reader,
    accessor::Source,
    buffer::Buffers,
    container,
    extras::Extras,
    instancing, mesh_counts, part_name, read_document,
    scene::{self, Instance},
};
use crate::{
    error::{LoadError, Place},
    format::Format,
    instance::Affine,
    limits::{Budget, Limits},
    model::{Faces, Warnings},
    scene_draft::{Draft, PartDraft},
    scene_frame::SceneFrame,
    scene_model::SceneMesh,
    text::name,
};

/// Maximum number of names in the path of a part; those of the innermost groups are kept. Without
/// it, a chain of nodes with meshes would take memory quadratic in the size of the file.
const MAX_PATH: usize = 64;

/// Reads the parts of a document. External buffers are read from `folder`, or not at all if it is
/// `None`.
pub(crate) fn read(
    bytes: &[u8],
    format: Format,
    folder: Option<&Path>,
    frame: SceneFrame,
    limits: &Limits,
) -> Result<Draft, LoadError> {
    let mut faces = Faces::new(limits);
    let (json, chunk) = match format {
        Format::Glb => container::split(bytes, &mut faces.warnings)?,
        _ => (bytes, None),
    };
    let document = read_document(json, format)?;
    let buffers = Buffers::load(&document.buffers, chunk, folder, limits)?;
    let source = Source { document: &document, buffers: &buffers, json_len: json.len() as u64 };
    let len = bytes.len() as u64 + buffers.total_len();
    let mut assembly = Assembly {
        reader: Reader { source, positions: Vec::new(), parts: Vec::new(), faces },
        extras: Extras::read(json),
        frame,
        meshes: Vec::new(),
        of_mesh: HashMap::new(),
        parts: Vec::new(),
        used: Used::new(len, limits),
    };
    let mut walking = Warnings::default();
    scene::walk(&document, &mut walking, Budget::for_nodes(len, limits), |instance, around| {
        assembly.add(&instance, around).map_err(|e| match (e.place(), instance.node) {
            (None, Some(node)) => e.at(Place::Entry(format!("node {node}"))),
            (None, None) => e.at(Place::Entry(format!("mesh {}", instance.mesh))),
            _ => e,
        })
    })?;
    assembly.finish(walking)
}

/// Number of items that instances add up to, with their limits.
struct Used {
    items: Budget,
    /// Numbers of vertices, corners, primitives and sparse elements.
    counts: [u64; 4],
    nodes: Budget,
    parts: u64,
    texts: Budget,
    text_bytes: u64,
}

impl Used {
    fn new(len: u64, limits: &Limits) -> Self {
        Self {
            items: Budget::for_bytes(len, limits),
            counts: [0; 4],
            nodes: Budget::for_nodes(len, limits),
            parts: 0,
            texts: Budget::for_names(len, limits),
            text_bytes: 0,
        }
    }

    fn add(&mut self, counts: [u64; 4]) -> Result<(), LoadError> {
        let items = ["vertices", "corners of triangles", "primitives", "sparse elements"];
        for (k, what) in items.into_iter().enumerate() {
            self.counts[k] = self.counts[k].saturating_add(counts[k]);
            self.items.check(what, self.counts[k])?;
        }
        Ok(())
    }

    /// Adds a number of parts, each with some bytes of text.
    fn add_parts(&mut self, copies: u64, bytes: u64) -> Result<(), LoadError> {
        self.parts = self.parts.saturating_add(copies);
        self.nodes.check("parts", self.parts)?;
        self.text_bytes = self.text_bytes.saturating_add(copies.saturating_mul(bytes));
        self.texts.check("bytes of names and extras", self.text_bytes)
    }
}

struct Assembly<'a> {
    reader: Reader<'a>,
    extras: Extras<'a>,
    frame: SceneFrame,
    /// The meshes, and whether their vertices are in the frame of the scene. Otherwise they are in
    /// their own frames, in the unit of the file.
    meshes: Vec<(SceneMesh, bool)>,
    /// Index in `meshes` of each mesh of the document that was read; `None` for a mesh without
    /// triangles.
    of_mesh: HashMap<usize, Option<usize>>,
    parts: Vec<PartDraft>,
    used: Used,
}

impl Assembly<'_> {
    /// Adds the parts of a node that the nodes `around` contain.
    fn add(&mut self, instance: &Instance, around: &[u32]) -> Result<(), LoadError> {
        let source = self.reader.source;
        self.reader.note(instance);
        let mesh = match self.of_mesh.get(&instance.mesh) {
            Some(&known) => known,
            None => {
                let read = self.read_mesh(instance)?;
                *self.of_mesh.entry(instance.mesh).or_insert(read)
            }
        };
        let copies = instancing::copies(&source, instance)?;
        self.used.add([0, 0, 0, instancing::sparse_count(&source, instance)?])?;
        let Some(mesh) = mesh else { return Ok(()) };
        let nodes = &source.document.nodes;
        let named = around[around.len().saturating_sub(MAX_PATH)..].iter();
        let named = named.filter_map(|&node| nodes[node as usize].name.as_deref()).map(|text| name(text.as_bytes()));
        let draft = PartDraft {
            title: name(part_name(source.document, instance).as_bytes()),
            path: named.filter(|name| !name.is_empty()).collect(),
            extras: instance.node.map(|node| self.extras.of_node(node)).unwrap_or_default(),
            mesh,
            world_from_part: Pose::IDENTITY,
        };
        self.used.add_parts(copies, text_bytes(&draft))?;
        for world in &instancing::worlds(&source, instance)? {
            let (mesh, world_from_part) = match self.frame.pose(world) {
                Some(pose) => (mesh, pose),
                None => (self.placed_mesh(mesh, world)?, Pose::IDENTITY),
            };
            let PartDraft { title, path, extras, .. } = &draft;
            let (title, path, extras) = (title.clone(), path.clone(), extras.clone());
            self.parts.push(PartDraft { title, path, extras, mesh, world_from_part });
        }
        Ok(())
    }

    /// Reads the mesh of an instance in its own frame. Returns its index, or `None` if it has no
    /// triangles.
    fn read_mesh(&mut self, instance: &Instance) -> Result<Option<usize>, LoadError> {
        let mesh = &self.reader.source.document.meshes[instance.mesh];
        self.used.add(mesh_counts(&self.reader.source, mesh)?)?;
        self.reader.mesh(mesh, instance, &Affine::IDENTITY, "")?;
        let positions = Positions::F32(std::mem::take(&mut self.reader.positions));
        let (faces, sources) = self.reader.faces.take();
        self.reader.parts.clear();
        if faces.is_empty() {
            return Ok(None);
        }
        self.meshes.push((SceneMesh { positions, faces, sources }, false));
        Ok(Some(self.meshes.len() - 1))
    }

    /// Adds a copy of a mesh with its vertices in the frame of the scene. Returns its index.
    fn placed_mesh(&mut self, mesh: usize, world: &Affine) -> Result<usize, LoadError> {
        let SceneMesh { positions, faces, sources } = &self.meshes[mesh].0;
        self.used.add([positions.len() as u64, 3 * faces.len() as u64, 1, 0])?;
        let positions = self.frame.in_scene(positions, world);
        let positions = positions.map_err(|e| e.with_hint("after the transform of its node"))?;
        let placed = SceneMesh { positions, faces: faces.clone(), sources: sources.clone() };
        self.meshes.push((placed, true));
        Ok(self.meshes.len() - 1)
    }

    /// Returns the meshes that parts use, in the unit of the scene, and the parts.
    fn finish(mut self, walking: Warnings) -> Result<Draft, LoadError> {
        let mut warnings = walking;
        warnings.extend(self.reader.faces.warnings.into_vec());
        let mut is_used = vec![false; self.meshes.len()];
        self.parts.iter().for_each(|part| is_used[part.mesh] = true);
        // Only meshes of flat instances are not used.
        let (mut meshes, mut numbers) = (Vec::with_capacity(self.meshes.len()), Vec::with_capacity(self.meshes.len()));
        for ((mut mesh, is_placed), is_used) in self.meshes.into_iter().zip(is_used) {
            numbers.push(meshes.len());
            if !is_placed {
                mesh.positions = self.frame.in_own_frame(mesh.positions)?;
            }
            if is_used {
                meshes.push(mesh);
            }
        }
        self.parts.iter_mut().for_each(|part| part.mesh = numbers[part.mesh]);
        Ok(Draft { meshes, parts: self.parts, unit: self.frame.unit, warnings })
    }
}

/// Returns the number of bytes that the texts of a part take.
fn text_bytes(part: &PartDraft) -> u64 {
    let own = part.path.iter().chain(part.extras.iter().flat_map(|(name, text)| [name, text])).chain([&part.title]);
    own.map(|text| (size_of::<String>() + text.len()) as u64).sum()
}
