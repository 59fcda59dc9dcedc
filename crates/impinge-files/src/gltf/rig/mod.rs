//! Rigged characters from glTF 2.0: skins, joints, weights, morph targets and animations.
//!
//! - Every node is a bone, in the order of the file. The matrix of a node is decomposed into
//!   translation, rotation and scale; glTF requires that this is possible.
//! - All meshes of the loaded scene form one surface. A mesh with a skin follows its joints and not
//!   its own node. A mesh without a skin follows its node rigidly.
//! - Channels are skipped unless they move the transform or the morph weights of a node.

mod document;
mod motion;
mod transform;

use std::path::Path;

use impinge::character::{
    Bone, Influence, Joint, Morph, Rig, RigError, RigErrorKind, RigPlace, Skeleton, Skin, Transform,
};

use super::{
    Reader,
    accessor::{F32, I8, I16, Source, U8, U16, missing},
    buffer::Buffers,
    container,
    document::{Document, Node},
    read_document,
    scene::{self, Instance},
};
use crate::{
    error::{LoadError, LoadErrorKind, Place},
    format::Format,
    limits::{Budget, Limits},
    model::{Faces, WarningKind},
    text::name,
};
use document::{RigDocument, RigMesh, RigPrimitive};
use transform::transform;

/// Reads the rig of a document. External buffers must lie in `folder`; `None` reads none.
pub(crate) fn read(bytes: &[u8], format: Format, folder: Option<&Path>, limits: &Limits) -> Result<Rig, LoadError> {
    let mut warnings = crate::model::Warnings::default();
    let (json, chunk) = match format {
        Format::Glb => container::split(bytes, &mut warnings)?,
        _ => (bytes, None),
    };
    let document = read_document(json, format)?;
    if document.extensions_required.iter().any(|e| e == "EXT_mesh_gpu_instancing") {
        return Err(super::extensions::lacking("EXT_mesh_gpu_instancing in a rig"));
    }
    let extra: RigDocument = serde_json::from_slice(crate::text::without_bom(json)).map_err(|e| {
        let error = LoadErrorKind::Syntax { expected: "a rigged glTF document".into(), found: e.to_string() };
        LoadError::new(error).at(Place::Entry(format!("line {} column {}", e.line(), e.column())))
    })?;
    let buffers = Buffers::load(&document.buffers, chunk, folder, limits)?;
    let source = Source { document: &document, buffers: &buffers, json_len: json.len() as u64 };
    let len = bytes.len() as u64 + buffers.total_len();
    let instances = scene::instances(&document, &mut warnings, Budget::for_nodes(len, limits))?;
    // A bone has exactly one parent.
    if let Some(shared) = warnings.into_vec().into_iter().find(|w| w.kind == WarningKind::SharedNodes) {
        let error = LoadError::syntax("nodes with one parent each", b"one that is reached twice");
        return Err(match shared.first {
            Some(place) => error.at(place),
            None => error,
        });
    }
    let mut reader = RigReader::new(source, &extra, len, limits);
    for instance in &instances {
        reader.instance(instance)?;
    }
    reader.into_rig()
}

/// A skin or a node, and the index of the first joint that was made for it.
struct JointRange {
    skin: Option<u32>,
    node: Option<u32>,
    first: u32,
}

/// Numbers of entries of a mesh.
#[derive(Clone, Copy)]
struct MeshEntries {
    /// Number of morph targets of the mesh: the maximum over its primitives.
    targets: usize,
    /// Number of primitives of the mesh and of their morph targets, together.
    entries: u64,
}

impl MeshEntries {
    fn of(mesh: &RigMesh) -> Self {
        let targets = mesh.primitives.iter().map(|primitive| primitive.targets.len());
        let entries = targets.clone().map(|count| 1 + count as u64).sum();
        Self { targets: targets.max().unwrap_or(0), entries }
    }
}

/// The first vertex of a primitive and its place in the file, for errors.
struct VertexRange {
    first: usize,
    place: String,
}

struct RigReader<'a> {
    reader: Reader<'a>,
    extra: &'a RigDocument,
    budget: Budget,
    /// Number of items stored so far.
    stored: u64,
    positions: Vec<[f64; 3]>,
    influences: Vec<Vec<Influence>>,
    joints: Vec<Joint>,
    /// The ranges in `joints`, by their first joint.
    joint_ranges: Vec<JointRange>,
    /// For each skin, its first joint; `None` if no mesh followed it so far.
    first_joint_of_skin: Vec<Option<u32>>,
    vertex_ranges: Vec<VertexRange>,
    morphs: Vec<Morph>,
    /// For each mesh, the numbers of its entries.
    entries: Vec<MeshEntries>,
    /// For each node, the first morph target of its mesh; `None` if there is none.
    morphs_of_node: Vec<Option<u32>>,
}

impl<'a> RigReader<'a> {
    /// Returns a reader without anything read yet. The file and its buffers have `len` bytes.
    fn new(source: Source<'a>, extra: &'a RigDocument, len: u64, limits: &Limits) -> Self {
        Self {
            reader: Reader { source, positions: Vec::new(), parts: Vec::new(), faces: Faces::new(limits) },
            extra,
            budget: Budget::for_bytes(len, limits),
            stored: 0,
            positions: Vec::new(),
            influences: Vec::new(),
            joints: Vec::new(),
            joint_ranges: Vec::new(),
            first_joint_of_skin: vec![None; extra.skins.len()],
            vertex_ranges: Vec::new(),
            morphs: Vec::new(),
            entries: extra.meshes.iter().map(MeshEntries::of).collect(),
            morphs_of_node: vec![None; source.document.nodes.len()],
        }
    }

    fn document(&self) -> &'a Document {
        self.reader.source.document
    }

    /// Counts items that are about to be read, over all meshes and animations. Returns an error if
    /// they exceed the budget, because entries may refer to the same data many times.
    fn count(&mut self, what: &'static str, more: u64) -> Result<(), LoadError> {
        self.stored = self.stored.saturating_add(more);
        self.budget.check(what, self.stored)
    }

    fn instance(&mut self, instance: &Instance) -> Result<(), LoadError> {
        let document = self.document();
        let mesh = &document.meshes[instance.mesh];
        let node = instance.node.map(|i| &document.nodes[i]);
        let skin = node.and_then(|node| node.skin);
        let first_joint = match (skin, instance.node) {
            (Some(skin), Some(node)) => {
                self.joints_of_skin(skin).map_err(|e| e.at(Place::Entry(format!("skin {skin} of node {node}"))))?
            }
            (_, node) => self.joint_of_node(node),
        };
        let extra = &self.extra.meshes[instance.mesh];
        let first_morph = self.morphs.len();
        let MeshEntries { targets, entries } = self.entries[instance.mesh];
        self.count("primitives and morph targets", entries)?;
        let own = instance.node.and_then(|i| self.extra.nodes[i].weights.as_ref()).or(extra.weights.as_ref());
        let weight = |at: usize| own.and_then(|weights| weights.get(at)).copied().unwrap_or(0.0);
        self.morphs.extend((0..targets).map(|at| Morph { weight: weight(at), offsets: Vec::new() }));
        if let (Some(node), 1..) = (instance.node, targets) {
            self.morphs_of_node[node] = Some(first_morph as u32);
        }
        for (primitive, rigged) in mesh.primitives.iter().zip(&extra.primitives) {
            let mode = primitive.mode.unwrap_or(4);
            let Some(accessor) = primitive.attributes.position.filter(|_| mode >= 4) else { continue };
            self.count("vertices", self.reader.source.decoded(accessor)?)?;
            // Draco leaves accessors without data, so all vertices would be at the origin.
            if primitive.extensions.draco.is_some() {
                return Err(super::extensions::lacking("KHR_draco_mesh_compression"));
            }
            let first = self.positions.len();
            let positions = self.reader.source.positions(accessor)?;
            let len = positions.len();
            self.positions.extend(positions);
            self.weights(rigged, len, first_joint, skin.is_some())?;
            self.targets(rigged, first, len, first_morph)?;
            let corners = match primitive.indices {
                Some(indices) => {
                    self.count("corners of triangles", self.reader.source.decoded(indices)?)?;
                    self.reader.source.indices(indices, len)?
                }
                None => (0..len as u32).collect(),
            };
            self.reader.triangles(mode, &corners, first as u32, false)?;
        }
        Ok(())
    }

    /// Adds the joints of a skin, once for all meshes that follow it. Returns the first joint.
    fn joints_of_skin(&mut self, skin: u32) -> Result<u32, LoadError> {
        if let Some(&Some(known)) = self.first_joint_of_skin.get(skin as usize) {
            return Ok(known);
        }
        let entry = self.extra.skins.get(skin as usize).ok_or_else(|| missing("skin", skin))?;
        let nodes = self.document().nodes.len();
        if let Some(&joint) = entry.joints.iter().find(|&&joint| joint as usize >= nodes) {
            return Err(missing("joint node", joint));
        }
        let count = entry.joints.len();
        self.count("joints", count as u64)?;
        let binds = match entry.inverse_bind_matrices {
            Some(accessor) => {
                self.count("inverse bind matrices", self.reader.source.decoded(accessor)?)?;
                let matrices = self.reader.source.numbers::<16>(accessor, "MAT4", &[F32])?;
                if matrices.len() < count {
                    let found = matrices.len() as u64;
                    return Err(LoadError::truncated("inverse bind matrices", count as u64, found));
                }
                matrices.iter().map(|m| [0, 1, 2].map(|i| [m[i], m[4 + i], m[8 + i], m[12 + i]])).collect()
            }
            None => vec![IDENTITY; count],
        };
        let first = self.joints.len() as u32;
        self.first_joint_of_skin[skin as usize] = Some(first);
        self.joint_ranges.push(JointRange { skin: Some(skin), node: None, first });
        self.joints.extend(entry.joints.iter().zip(binds).map(|(&bone, inverse_bind)| Joint { bone, inverse_bind }));
        Ok(first)
    }

    /// Adds a joint for a mesh that follows its node rigidly. A mesh without a node follows the
    /// first bone, which does not move. Returns the index of the joint.
    fn joint_of_node(&mut self, node: Option<usize>) -> u32 {
        let first = self.joints.len() as u32;
        let bone = node.unwrap_or(0) as u32;
        self.joint_ranges.push(JointRange { skin: None, node: Some(bone), first });
        self.joints.push(Joint { bone, inverse_bind: IDENTITY });
        first
    }

    /// Adds the influences of the next `len` vertices.
    fn weights(&mut self, primitive: &RigPrimitive, len: usize, joint: u32, skinned: bool) -> Result<(), LoadError> {
        let first = self.influences.len();
        if !skinned {
            self.influences.resize(first + len, vec![Influence { joint, weight: 1.0 }]);
            return Ok(());
        }
        self.influences.resize(first + len, Vec::new());
        let mut place = "a primitive without joints and weights".to_owned();
        for (set, (joints, weights)) in primitive.attributes.sets().into_iter().enumerate() {
            let (Some(joints), Some(weights)) = (joints, weights) else { continue };
            if set == 0 {
                place = format!("accessor {weights}");
            }
            for accessor in [joints, weights] {
                self.count("weights", self.reader.source.decoded(accessor)?.saturating_mul(4))?;
            }
            let names = self.reader.source.numbers::<4>(joints, "VEC4", &[U8, U16])?;
            let shares = self.reader.source.numbers::<4>(weights, "VEC4", &[F32, U8, U16])?;
            for (accessor, found) in [(joints, names.len()), (weights, shares.len())] {
                if found < len {
                    let error = LoadError::truncated("vertices", len as u64, found as u64);
                    return Err(error.at(Place::Entry(format!("accessor {accessor}"))));
                }
            }
            for (vertex, (names, shares)) in names.iter().zip(&shares).take(len).enumerate() {
                // Joints were read from integers of at most 16 bits, so the casts are exact.
                // Weights of exactly zero are skipped.
                let used = (0..4).filter(|&k| shares[k] != 0.0);
                let influence = |k: usize| Influence { joint: joint + names[k] as u32, weight: shares[k] };
                self.influences[first + vertex].extend(used.map(influence));
            }
        }
        self.vertex_ranges.push(VertexRange { first, place });
        let joints = self.joints.len() as u32;
        let after = self.joint_ranges.partition_point(|range| range.first <= joint);
        let end = self.joint_ranges.get(after).map_or(joints, |range| range.first);
        let beyond = |influence: &Influence| influence.joint >= end;
        match self.influences[first..].iter().position(|list| list.iter().any(beyond)) {
            None => Ok(()),
            Some(vertex) => {
                let index = self.influences[first + vertex].iter().map(|i| i.joint - joint).max().unwrap_or(0);
                let kind = RigErrorKind::Missing { what: "joint", index: index as usize, len: (end - joint) as usize };
                Err(self.error(&RigError::new(kind, RigPlace::Vertex(first + vertex))))
            }
        }
    }

    /// Adds the offsets of morph targets for vertices from `first` on.
    fn targets(&mut self, primitive: &RigPrimitive, first: usize, len: usize, morph: usize) -> Result<(), LoadError> {
        for (at, target) in primitive.targets.iter().enumerate() {
            let Some(accessor) = target.position else { continue };
            self.count("offsets of morph targets", self.reader.source.decoded(accessor)?)?;
            let offsets = self.reader.source.numbers::<3>(accessor, "VEC3", &[F32, I8, I16, U8, U16])?;
            if offsets.len() < len {
                let error = LoadError::truncated("offsets", len as u64, offsets.len() as u64);
                return Err(error.at(Place::Entry(format!("accessor {accessor}"))));
            }
            if let Some(vertex) = offsets.iter().position(|offset| !offset.iter().all(|x| x.is_finite())) {
                let error = LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 });
                return Err(error.at(Place::Entry(format!("accessor {accessor}"))));
            }
            let moved = offsets.iter().take(len).enumerate().filter(|(_, offset)| **offset != [0.0; 3]);
            self.morphs[morph + at].offsets.extend(moved.map(|(vertex, offset)| ((first + vertex) as u32, *offset)));
        }
        Ok(())
    }

    fn into_rig(mut self) -> Result<Rig, LoadError> {
        let mut bones = self.bones()?;
        if bones.is_empty() {
            bones.push(Bone { name: String::new(), parent: None, rest: Transform::IDENTITY });
        }
        let skeleton = Skeleton::new(bones).map_err(|e| self.error(&e))?;
        let animations = motion::animations(&mut self)?;
        let positions = std::mem::take(&mut self.positions);
        let faces = std::mem::take(&mut self.reader.faces.faces);
        let (joints, morphs) = (self.joints.clone(), std::mem::take(&mut self.morphs));
        let influences = std::mem::take(&mut self.influences);
        let skin = Skin::new(positions, faces, joints, &influences, morphs).map_err(|e| self.error(&e))?;
        Rig::new(skeleton, skin, animations).map_err(|e| self.error(&e))
    }

    fn bones(&self) -> Result<Vec<Bone>, LoadError> {
        let nodes = &self.document().nodes;
        let mut parents = vec![None; nodes.len()];
        for (parent, node) in nodes.iter().enumerate() {
            for &child in &node.children {
                let place = || Place::Entry(format!("node {parent}"));
                let slot = parents.get_mut(child as usize).ok_or_else(|| missing("node", child).at(place()))?;
                if slot.replace(parent as u32).is_some() {
                    let error = LoadError::syntax("nodes with one parent each", b"one with two");
                    return Err(error.at(Place::Entry(format!("node {child}"))));
                }
            }
        }
        let bone = |(index, (node, parent)): (usize, (&Node, Option<u32>))| {
            let rest = transform(node).map_err(|e| e.at(Place::Entry(format!("node {index}"))))?;
            Ok(Bone { name: name(node.name.as_deref().unwrap_or_default().as_bytes()), parent, rest })
        };
        nodes.iter().zip(parents).enumerate().map(bone).collect()
    }

    /// Converts an error of the rig into an error that names the place in the file.
    fn error(&self, error: &RigError) -> LoadError {
        let place = match error.place() {
            RigPlace::Bone(node) => Some(format!("node {node}")),
            RigPlace::Joint(joint) => {
                let range = self.joint_ranges.iter().rev().find(|range| range.first as usize <= joint);
                range.map(|range| match (range.skin, range.node) {
                    (Some(skin), _) => format!("skin {skin}, joint {}", joint - range.first as usize),
                    (None, node) => format!("node {}", node.unwrap_or(0)),
                })
            }
            RigPlace::Vertex(vertex) => {
                let range = self.vertex_ranges.iter().rev().find(|range| range.first <= vertex);
                range.map(|range| format!("{}, vertex {}", range.place, vertex - range.first))
            }
            other => Some(other.to_string()),
        };
        broken(error.kind().clone(), place)
    }
}

fn broken(kind: RigErrorKind, place: Option<String>) -> LoadError {
    let error = LoadError::new(LoadErrorKind::BrokenRig { kind });
    match place {
        Some(place) => error.at(Place::Entry(place)),
        None => error,
    }
}

const IDENTITY: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
