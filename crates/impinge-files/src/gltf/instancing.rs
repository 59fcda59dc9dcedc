//! Instances of a node's mesh (`EXT_mesh_gpu_instancing`): accessors hold a translation, a rotation
//! and a scale for each instance.

use crate::{
    error::{LoadError, Place},
    instance::Affine,
};

use super::{
    accessor::{F32, I8, I16, Source},
    document::{Instancing, Node},
    scene::{Instance, placement},
};

/// The accessors that place the instances of a node.
struct Attributes {
    translation: Option<u32>,
    rotation: Option<u32>,
    scale: Option<u32>,
}

/// Returns the accessors that place the instances of a node, or `None` if the extension has none.
fn attributes(instancing: &Instancing) -> Option<Attributes> {
    let get = |name: &str| instancing.attributes.get(name).copied();
    let (translation, rotation, scale) = (get("TRANSLATION"), get("ROTATION"), get("SCALE"));
    translation.or(rotation).or(scale)?;
    Some(Attributes { translation, rotation, scale })
}

/// Reports whether a node has the extension, but no attributes that place instances.
pub(super) fn places_nothing(node: &Node) -> bool {
    node.extensions.instancing.as_deref().is_some_and(|instancing| attributes(instancing).is_none())
}

fn attributes_of(source: &Source<'_>, instance: &Instance) -> Option<Attributes> {
    attributes(source.document.nodes[instance.node?].extensions.instancing.as_deref()?)
}

/// Returns the number of instances: 1 if no attributes place them.
pub(super) fn copies(source: &Source<'_>, instance: &Instance) -> Result<u64, LoadError> {
    let Some(Attributes { translation, rotation, scale }) = attributes_of(source, instance) else { return Ok(1) };
    let mut count = None;
    for accessor in [translation, rotation, scale].into_iter().flatten() {
        let found = source.count(accessor).map_err(|e| at(instance, e))?;
        if *count.get_or_insert(found) != found {
            let error = LoadError::syntax("instance attributes of one length", b"different lengths");
            return Err(at(instance, error));
        }
    }
    Ok(count.unwrap_or(1))
}

/// Returns the number of sparse elements in the attributes that place the instances.
pub(super) fn sparse_count(source: &Source<'_>, instance: &Instance) -> Result<u64, LoadError> {
    let Some(Attributes { translation, rotation, scale }) = attributes_of(source, instance) else { return Ok(0) };
    let accessors = [translation, rotation, scale].into_iter().flatten();
    accessors
        .map(|accessor| source.sparse_count(accessor))
        .try_fold(0, |sum: u64, count| Ok(sum.saturating_add(count?)))
}

/// Returns the maps that place the instances in the scene.
pub(super) fn worlds(source: &Source<'_>, instance: &Instance) -> Result<Vec<Affine>, LoadError> {
    let Some(Attributes { translation, rotation, scale }) = attributes_of(source, instance) else {
        return Ok(vec![instance.world]);
    };
    let vectors = |accessor: Option<u32>| accessor.map(|i| source.numbers::<3>(i, "VEC3", &[F32])).transpose();
    let (translations, scales) = (vectors(translation)?, vectors(scale)?);
    let rotations = rotation.map(|i| source.numbers::<4>(i, "VEC4", &[F32, I8, I16])).transpose()?;
    let one = |i: usize| {
        let t = translations.as_ref().map_or([0.0; 3], |list| list[i]);
        let r = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |list| list[i]);
        let s = scales.as_ref().map_or([1.0; 3], |list| list[i]);
        placement(t, r, s).map(|map| instance.world.after(&map)).map_err(|e| at(instance, e))
    };
    (0..copies(source, instance)? as usize).map(one).collect()
}

fn at(instance: &Instance, error: LoadError) -> LoadError {
    match instance.node {
        Some(node) => error.at(Place::Entry(format!("node {node}, EXT_mesh_gpu_instancing"))),
        None => error,
    }
}
