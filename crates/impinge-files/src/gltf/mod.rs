//! glTF 2.0 (Khronos, ISO/IEC 12113), as JSON and in its binary container GLB.
//!
//! - The default scene is loaded, or else the first one. Without scenes, all root nodes are loaded;
//!   without nodes, all meshes. Each node with a mesh is a part, named after the node or else the
//!   mesh.
//! - Node transforms are composed and applied in f64; the resulting positions are rounded to f32
//!   once. Quaternions of any length are normalized.
//! - Points and lines are skipped and counted. A skinned mesh is loaded as modeled. Morph targets
//!   are not applied.
//! - A node that several paths reach is loaded once for each path, with a warning.
//! - `KHR_mesh_quantization` and `EXT_mesh_gpu_instancing` are supported. Extensions that do not
//!   affect positions are ignored. Any other extension that a file requires is an error that names
//!   it.
//! - Buffers are the GLB chunk, base64 text, or files in the folder of the document or below.

mod accessor;
pub(crate) mod assembly;
mod buffer;
mod container;
mod document;
mod extensions;
mod extras;
mod instancing;
pub(crate) mod rig;
mod scene;
#[cfg(test)]
mod tests;

use std::{
    collections::{HashMap, HashSet},
    path::Path,
};

use impinge::Positions;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    instance::Affine,
    limits::{Budget, Limits},
    model::{Faces, Model, WarningKind},
    text::{MAX_NAME, name},
    unit::Unit,
};
use accessor::Source;
use buffer::Buffers;
use document::{Asset, Document, Mesh, Primitive, Versioned};
use scene::Instance;

/// Reads a document. External buffers are read from `folder`, or not at all if it is `None`.
pub(crate) fn read(bytes: &[u8], format: Format, folder: Option<&Path>, limits: &Limits) -> Result<Model, LoadError> {
    let mut faces = Faces::new(limits);
    let (json, chunk) = match format {
        Format::Glb => container::split(bytes, &mut faces.warnings)?,
        _ => (bytes, None),
    };
    let document = read_document(json, format)?;
    let buffers = Buffers::load(&document.buffers, chunk, folder, limits)?;
    let source = Source { document: &document, buffers: &buffers, json_len: json.len() as u64 };
    let len = bytes.len() as u64 + buffers.total_len();
    let instances = scene::instances(&document, &mut faces.warnings, Budget::for_nodes(len, limits))?;
    check_budget(&source, &instances, len, limits)?;

    let mut reader = Reader { source, positions: Vec::new(), parts: Vec::new(), faces };
    for instance in &instances {
        reader.instance(instance)?;
    }
    let Reader { positions, parts, faces, .. } = reader;
    faces.into_model(Positions::F32(positions), parts, Some(Unit::Meter), format)
}

fn read_document(json: &[u8], format: Format) -> Result<Document, LoadError> {
    let json = crate::text::without_bom(json);
    let document: Document = match serde_json::from_slice(json) {
        Ok(document) => document,
        Err(e) => {
            // Documents of other versions differ in structure.
            if let Ok(Versioned { asset }) = serde_json::from_slice(json) {
                check_version(&asset)?;
            }
            let place = match format {
                Format::Glb => Place::Entry(format!("JSON chunk, line {} column {}", e.line(), e.column())),
                _ => Place::Line(e.line() as u64),
            };
            let kind = LoadErrorKind::Syntax { expected: "a glTF document".into(), found: e.to_string() };
            return Err(LoadError::new(kind).at(place));
        }
    };
    check_version(&document.asset)?;
    match document.extensions_required.iter().find(|e| !extensions::leaves_positions_alone(e)) {
        Some(extension) => Err(extensions::lacking(extension)),
        None => Ok(document),
    }
}

fn check_version(asset: &Asset) -> Result<(), LoadError> {
    let version = asset.min_version.as_ref().unwrap_or(&asset.version);
    if version == "2.0" || (asset.min_version.is_none() && version.starts_with("2.")) {
        return Ok(());
    }
    let error = LoadError::unsupported(format!("glTF version {version:?}"));
    Err(if version.starts_with("1.") { error.with_hint(CONVERT_VERSION_1) } else { error })
}

/// Hint how to convert a file of glTF 1.0.
const CONVERT_VERSION_1: &str = "convert it to glTF 2.0, for example with `npx gltf-pipeline -i in.gltf -o out.gltf`";

/// Returns an error if the instances add up to too many vertices, corners, primitives, sparse
/// elements or bytes of names, before anything is decoded. The file and its buffers have `len`
/// bytes.
fn check_budget(source: &Source<'_>, instances: &[Instance], len: u64, limits: &Limits) -> Result<(), LoadError> {
    let (budget, names) = (Budget::for_bytes(len, limits), Budget::for_names(len, limits));
    let mut of_mesh = vec![None; source.document.meshes.len()];
    let mut total = [0_u64; 4];
    let mut name_bytes = 0_u64;
    for instance in instances {
        let at = |e: LoadError| match (instance.node, e.place()) {
            (Some(node), None) => e.at(Place::Entry(format!("node {node}"))),
            (None, None) => e.at(Place::Entry(format!("mesh {}", instance.mesh))),
            _ => e,
        };
        let counts = match of_mesh[instance.mesh] {
            Some(counts) => counts,
            None => *of_mesh[instance.mesh].insert(mesh_counts(source, &source.document.meshes[instance.mesh])?),
        };
        let copies = instancing::copies(source, instance)?;
        total[3] = total[3].saturating_add(instancing::sparse_count(source, instance)?);
        let items = ["vertices", "corners of triangles", "primitives", "sparse elements"];
        for (k, what) in items.into_iter().enumerate() {
            total[k] = total[k].saturating_add(counts[k].saturating_mul(copies));
            budget.check(what, total[k]).map_err(at)?;
        }
        if counts[2] > 0 {
            let name = part_name(source.document, instance).len().min(MAX_NAME);
            let bytes = (size_of::<String>() + name) as u64;
            name_bytes = name_bytes.saturating_add(bytes.saturating_mul(copies));
            names.check("bytes of names", name_bytes).map_err(at)?;
        }
    }
    Ok(())
}

/// Returns the name of an instance's parts: that of the node, or else of the mesh.
fn part_name<'a>(document: &'a Document, instance: &Instance) -> &'a str {
    let own = instance.node.and_then(|i| document.nodes[i].name.as_deref());
    own.or(document.meshes[instance.mesh].name.as_deref()).unwrap_or_default()
}

/// Returns the numbers of vertices, corners, primitives and sparse elements of a mesh. Vertices
/// that several primitives share count once, because they are decoded once.
fn mesh_counts(source: &Source<'_>, mesh: &Mesh) -> Result<[u64; 4], LoadError> {
    let mut seen = HashSet::new();
    let mut counts = [0_u64, 0, mesh.primitives.len() as u64, 0];
    for primitive in &mesh.primitives {
        let is_surface = primitive.mode.unwrap_or(4) >= 4;
        let Some(positions) = primitive.attributes.position.filter(|_| is_surface) else { continue };
        let count = source.count(positions)?;
        if seen.insert(positions) {
            counts[0] = counts[0].saturating_add(count);
            counts[3] = counts[3].saturating_add(source.sparse_count(positions)?);
        }
        counts[1] = counts[1].saturating_add(primitive.indices.map_or(Ok(count), |i| source.count(i))?);
        counts[3] = counts[3].saturating_add(primitive.indices.map_or(Ok(0), |i| source.sparse_count(i))?);
    }
    Ok(counts)
}

struct Reader<'a> {
    source: Source<'a>,
    positions: Vec<[f32; 3]>,
    parts: Vec<String>,
    faces: Faces,
}

impl Reader<'_> {
    fn instance(&mut self, instance: &Instance) -> Result<(), LoadError> {
        let source = self.source;
        let mesh = &source.document.meshes[instance.mesh];
        self.note(instance);
        if mesh.primitives.is_empty() {
            return Ok(());
        }
        let name = name(part_name(source.document, instance).as_bytes());
        let worlds = instancing::worlds(&source, instance)?;
        worlds.iter().try_for_each(|world| self.mesh(mesh, instance, world, &name))
    }

    /// Adds the warnings about the node of an instance.
    fn note(&mut self, instance: &Instance) {
        let Some(index) = instance.node else { return };
        let node = &self.source.document.nodes[index];
        let place = || Some(Place::Entry(format!("node {index}")));
        let warnings = &mut self.faces.warnings;
        warnings.add(WarningKind::Unposed, node.skin.is_some().into(), place);
        warnings.add(WarningKind::SingleInstances, instancing::places_nothing(node).into(), place);
    }

    /// Adds a mesh as one part, if it has triangles.
    fn mesh(&mut self, mesh: &Mesh, instance: &Instance, world: &Affine, name: &str) -> Result<(), LoadError> {
        let place = || instance.node.map(|i| Place::Entry(format!("node {i}")));
        let before = self.faces.faces.len();
        // Primitives of a mesh often share their vertices.
        let mut shared = HashMap::new();
        for primitive in &mesh.primitives {
            let mode = primitive.mode.unwrap_or(4);
            if mode < 4 {
                self.faces.warnings.add(WarningKind::NotTriangles, 1, place);
                continue;
            }
            let Some(accessor) = primitive.attributes.position else { continue };
            self.check_fallback(primitive, accessor)?;
            let (first, len) = match shared.get(&accessor) {
                Some(&known) => known,
                None => *shared.entry(accessor).insert_entry(self.vertices(accessor, world)?).get(),
            };
            let corners = match primitive.indices {
                Some(indices) => self.source.indices(indices, len)?,
                None => (0..len as u32).collect(),
            };
            self.triangles(mode, &corners, first, world.mirrors()).map_err(|e| match (e.place(), place()) {
                (None, Some(place)) => e.at(place),
                _ => e,
            })?;
        }
        if self.faces.faces.len() > before {
            self.parts.push(name.to_owned());
        }
        Ok(())
    }

    /// Returns an error if a compressed primitive has no uncompressed data as a fallback.
    fn check_fallback(&self, primitive: &Primitive, positions: u32) -> Result<(), LoadError> {
        let accessors = &self.source.document.accessors;
        let lacks_data = |i: u32| accessors.get(i as usize).is_some_and(|a| a.buffer_view.is_none());
        if primitive.extensions.draco.is_some()
            && [Some(positions), primitive.indices].into_iter().flatten().any(lacks_data)
        {
            return Err(extensions::lacking("KHR_draco_mesh_compression"));
        }
        Ok(())
    }

    /// Adds the vertices of an accessor. Returns the index of the first, and their number.
    fn vertices(&mut self, accessor: u32, world: &Affine) -> Result<(u32, usize), LoadError> {
        let local = self.source.positions(accessor)?;
        let first = self.positions.len() as u32;
        for (vertex, &p) in local.iter().enumerate() {
            let p = world.apply(p).map(|x| x as f32);
            if !p.iter().all(|x| x.is_finite()) {
                let error = LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 });
                return Err(error
                    .at(Place::Entry(format!("accessor {accessor}")))
                    .with_hint("after the transform of its node"));
            }
            self.positions.push(p);
        }
        Ok((first, local.len()))
    }

    /// Adds the triangles of a primitive; `first` is the index of the vertex that corner 0 refers
    /// to.
    fn triangles(&mut self, mode: u32, corners: &[u32], first: u32, mirrored: bool) -> Result<(), LoadError> {
        const TRIANGLES: u32 = 4;
        const STRIP: u32 = 5;
        const FAN: u32 = 6;
        let part = self.parts.len() as u32;
        let faces = &mut self.faces;
        let mut add = |[a, b, c]: [u32; 3]| {
            let face = if mirrored { [a, c, b] } else { [a, b, c] };
            faces.triangle(face.map(|i| first + i), part)
        };
        match mode {
            TRIANGLES => {
                let (triangles, left) = corners.as_chunks::<3>();
                triangles.iter().try_for_each(|&t| add(t))?;
                faces.warnings.add(WarningKind::LeftoverCorners, left.len() as u64, || None);
            }
            STRIP => {
                let mut joints = 0;
                for (i, w) in corners.windows(3).enumerate() {
                    let [a, b, c] = if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] };
                    if a == b || b == c || c == a {
                        joints += 1;
                    } else {
                        add([a, b, c])?;
                    }
                }
                faces.warnings.add(WarningKind::StripJoints, joints, || None);
            }
            FAN => {
                for w in corners.get(1..).unwrap_or_default().windows(2) {
                    add([corners[0], w[0], w[1]])?;
                }
            }
            _ => return Err(LoadError::syntax("a primitive mode from 0 to 6", mode.to_string().as_bytes())),
        }
        Ok(())
    }
}
