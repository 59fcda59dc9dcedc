//! Reads the animations of a document as channels of bones and morph targets.

use impinge::character::{Animation, Channel, Interpolation, RigError, RigErrorKind, RigPlace, Target};

use super::document::{ChannelEntry, SamplerEntry};
use super::{F32, I8, I16, RigReader, U8, U16, broken, missing, name};
use crate::error::{LoadError, Place};

/// Returns all animations.
pub(super) fn animations(reader: &mut RigReader<'_>) -> Result<Vec<Animation>, LoadError> {
    let entries = &reader.extra.animations;
    let mut animations = Vec::with_capacity(entries.len());
    for (index, entry) in entries.iter().enumerate() {
        let mut channels = Vec::new();
        // The sampler of each channel, for errors.
        let mut samplers = Vec::new();
        for (at, channel) in entry.channels.iter().enumerate() {
            let place = || Place::Entry(format!("animation {index}, channel {at}"));
            let sampler = entry.samplers.get(channel.sampler as usize);
            let sampler = sampler.ok_or_else(|| missing("sampler", channel.sampler).at(place()))?;
            let read = read_channel(reader, channel, sampler).map_err(|e| match e.place() {
                Some(_) => e,
                None => e.at(place()),
            })?;
            samplers.resize(channels.len() + read.len(), sampler);
            channels.extend(read);
        }
        let title = name(entry.name.as_deref().unwrap_or_default().as_bytes());
        animations.push(Animation::new(title, channels, index).map_err(|e| in_file(&e, &samplers))?);
    }
    Ok(animations)
}

/// Converts an error of a channel into an error that names the accessor.
fn in_file(error: &RigError, samplers: &[&SamplerEntry]) -> LoadError {
    let kind = error.kind().clone();
    let of_times = matches!(kind, RigErrorKind::TimesNotIncreasing)
        || matches!(kind, RigErrorKind::NonFinite { what: "time" } | RigErrorKind::OutOfRange { what: "time" });
    let place = match error.place() {
        RigPlace::Key { channel, key, .. } => samplers.get(channel).map(|sampler| {
            let accessor = if of_times { sampler.input } else { sampler.output };
            format!("accessor {accessor}, key {key}")
        }),
        RigPlace::Channel { channel, .. } => samplers.get(channel).map(|s| format!("accessor {}", s.output)),
        other => Some(other.to_string()),
    };
    broken(kind, place)
}

/// Returns the channel, or one channel per morph target. Returns no channel if it does not move the
/// rig.
fn read_channel(
    reader: &mut RigReader<'_>,
    channel: &ChannelEntry,
    sampler: &SamplerEntry,
) -> Result<Vec<Channel>, LoadError> {
    let Some(node) = channel.target.node else { return Ok(Vec::new()) };
    let document = reader.document();
    let found = document.nodes.get(node as usize).ok_or_else(|| missing("node", node))?;
    let target = match &*channel.target.path {
        "translation" => Target::Translation(node),
        "rotation" => Target::Rotation(node),
        "scale" => Target::Scale(node),
        "weights" => match reader.morphs_of_node[node as usize] {
            Some(morph) => Target::MorphWeight(morph),
            None => return Ok(Vec::new()),
        },
        _ => return Ok(Vec::new()),
    };
    let interpolation = match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::CubicSpline,
        Some(other) => return Err(LoadError::syntax("LINEAR, STEP or CUBICSPLINE", other.as_bytes())),
    };
    let source = reader.reader.source;
    let (keys, numbers) = (source.decoded(sampler.input)?, source.decoded(sampler.output)?);
    reader.count("keys of animations", keys.saturating_add(numbers))?;
    let times: Vec<f64> = source.numbers::<1>(sampler.input, "SCALAR", &[F32])?.into_iter().map(|[t]| t).collect();
    let values = |shape| (sampler.output, shape, [F32, I8, U8, I16, U16]);
    let flat = match target {
        Target::Rotation(_) => {
            let (accessor, shape, types) = values("VEC4");
            let turned = source.numbers::<4>(accessor, shape, &types)?;
            turned.into_iter().flat_map(|[x, y, z, w]| [w, x, y, z]).collect()
        }
        Target::MorphWeight(first) => {
            let (accessor, shape, types) = values("SCALAR");
            let flat = source.numbers::<1>(accessor, shape, &types)?.into_iter().map(|[x]| x).collect();
            let count = found.mesh.and_then(|mesh| reader.entries.get(mesh as usize)).map_or(0, |mesh| mesh.targets);
            return Ok(split(first, count, interpolation, &times, flat));
        }
        _ => {
            let (accessor, shape, types) = values("VEC3");
            source.numbers::<3>(accessor, shape, &types)?.as_flattened().to_vec()
        }
    };
    Ok(vec![Channel { target, interpolation, times, values: flat }])
}

/// Splits the weights of several morph targets, which are stored key by key, into a channel per
/// target. If the number of weights is wrong, the first channel gets all of them, so that it is
/// rejected later.
fn split(first: u32, count: usize, interpolation: Interpolation, times: &[f64], flat: Vec<f64>) -> Vec<Channel> {
    let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let channel = |morph: u32, values| Channel {
        target: Target::MorphWeight(morph),
        interpolation,
        times: times.to_vec(),
        values,
    };
    if flat.len() != times.len() * parts * count {
        return vec![channel(first, flat)];
    }
    let of_target = |target: usize| flat.iter().skip(target).step_by(count).copied().collect();
    (0..count).map(|target| channel(first + target as u32, of_target(target))).collect()
}
