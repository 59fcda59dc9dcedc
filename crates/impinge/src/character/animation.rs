//! Keys over time, and the values between them (glTF 2.0 specification, appendix C).

use std::collections::HashMap;

use super::channel::{Channel, Interpolation, Target, validated, values_per_key};
use super::error::RigError;
use super::skeleton::BoneSet;
use super::timeline::{LANES, Place, Property, Quad, Side, Timeline};
use super::transform::{Transform, normalized};

/// A motion of a rig: channels that play together. Of several channels with one target, the last is
/// used.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    name: String,
    /// The different lists of key times. Most rigs have few.
    timelines: Vec<Timeline>,
    tracks: Vec<Track>,
    /// Indices of the tracks that are not in the quads of a timeline.
    singles: Vec<u32>,
}

/// A channel over a timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Track {
    pub(super) target: Target,
    interpolation: Interpolation,
    timeline: usize,
    /// Position of its first value among the values of a key.
    offset: usize,
    stride: usize,
}

/// The keys of one track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keys<'a> {
    pub(super) interpolation: Interpolation,
    timeline: &'a Timeline,
    offset: usize,
    stride: usize,
}

impl Animation {
    /// Validates channels. `index` is the index of the animation in its rig, for error messages.
    ///
    /// # Errors
    /// Returns an error that names the channel or the key if a number is not finite or out of
    /// range, a rotation or scale is zero, times do not increase, or the number of values does not
    /// match the keys.
    pub fn new(name: String, channels: Vec<Channel>, index: usize) -> Result<Self, RigError> {
        let (mut timelines, mut tracks, mut given) = (Vec::<Timeline>::new(), Vec::<Track>::new(), Vec::new());
        // The timeline of each list of times. Adding zero makes both zeros equal.
        let mut known = HashMap::<Vec<u64>, usize>::new();
        for (at, channel) in channels.into_iter().enumerate() {
            let Channel { target, interpolation, times, values } = validated(channel, index, at)?;
            let key = times.iter().map(|time| (time + 0.0).to_bits()).collect();
            let timeline = *known.entry(key).or_insert_with(|| {
                timelines.push(Timeline::new(times));
                timelines.len() - 1
            });
            tracks.push(Track { target, interpolation, timeline, offset: 0, stride: 1 });
            given.push(values);
        }
        let singles = lay_out(&mut timelines, &mut tracks);
        for timeline in &mut timelines {
            timeline.values = vec![0.0; timeline.times.len() * timeline.width];
        }
        for (track, given) in tracks.iter().zip(&given) {
            let Timeline { width, values, .. } = &mut timelines[track.timeline];
            let of_key = values_per_key(track.target, track.interpolation);
            for (all, own) in values.chunks_mut(*width).zip(given.chunks(of_key)) {
                own.iter().enumerate().for_each(|(k, &value)| all[track.offset + k * track.stride] = value);
            }
        }
        timelines.iter_mut().for_each(Timeline::fill);
        Ok(Self { name, timelines, tracks, singles })
    }

    /// Returns the name, which may be empty.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the times of the first and the last key, in seconds. Both are 0 if there are no
    /// channels.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        let start = self.timelines.iter().map(|timeline| timeline.times[0]).fold(f64::INFINITY, f64::min);
        let end = self
            .timelines
            .iter()
            .map(|timeline| timeline.times[timeline.times.len() - 1])
            .fold(f64::NEG_INFINITY, f64::max);
        if start <= end { [start, end] } else { [0.0; 2] }
    }

    /// Returns the times of all keys of all channels, in seconds, increasing and without
    /// duplicates.
    #[must_use]
    pub fn key_times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.timelines.iter().flat_map(|timeline| &timeline.times).copied().collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Returns the number of times and values of all keys.
    pub(super) fn numbers(&self) -> usize {
        self.timelines.iter().map(|timeline| timeline.times.len() + timeline.values.len()).sum()
    }

    pub(super) fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    pub(super) fn keys(&self, track: &Track) -> Keys<'_> {
        let Track { interpolation, timeline, offset, stride, .. } = *track;
        Keys { interpolation, timeline: &self.timelines[timeline], offset, stride }
    }

    /// Sets the animated properties to their values at a time: those of all bones and morph
    /// weights, or only those of the bones in a set.
    pub(super) fn sample(
        &self,
        time: f64,
        side: Side,
        set: Option<&BoneSet>,
        locals: &mut [Transform],
        morph_weights: &mut [f64],
    ) {
        for timeline in self.timelines.iter().filter(|timeline| !timeline.quads.is_empty()) {
            timeline.sample(timeline.find(time, side), set, locals);
        }
        let (mut found, mut place) = (None, Place::START);
        for &track in &self.singles {
            let track = &self.tracks[track as usize];
            let keys = self.keys(track);
            if found != Some(track.timeline) {
                (found, place) = (Some(track.timeline), keys.timeline.find(time, side));
            }
            let is_in = |bone: u32| set.is_none_or(|set| set.is_in[bone as usize]);
            match track.target {
                Target::Translation(bone) | Target::Rotation(bone) | Target::Scale(bone) if !is_in(bone) => {}
                Target::MorphWeight(_) if set.is_some() => {}
                Target::Translation(bone) => locals[bone as usize].translation = keys.values_at::<3>(place),
                Target::Scale(bone) => locals[bone as usize].scale = keys.values_at::<3>(place),
                Target::Rotation(bone) => locals[bone as usize].rotation_wxyz = keys.rotation_at(place),
                Target::MorphWeight(morph) => [morph_weights[morph as usize]] = keys.values_at::<1>(place),
            }
        }
    }
}

/// Assigns each track its position among the values of a key. Linear tracks of bones are grouped by
/// fours; the indices of the other tracks are returned. If several tracks have the same target,
/// only the last one is used.
fn lay_out(timelines: &mut [Timeline], tracks: &mut [Track]) -> Vec<u32> {
    let last: HashMap<Target, usize> = tracks.iter().enumerate().map(|(at, track)| (track.target, at)).collect();
    let (mut singles, mut partial_quads) = (Vec::new(), HashMap::<(usize, Property), [usize; 2]>::new());
    for (at, track) in tracks.iter_mut().enumerate() {
        let moved = track
            .target
            .bone_property()
            .filter(|_| track.interpolation == Interpolation::Linear && last[&track.target] == at);
        let Some((property, bone)) = moved else { continue };
        let timeline = &mut timelines[track.timeline];
        let [quad, lane] = partial_quads.entry((track.timeline, property)).or_insert([0, LANES]);
        if *lane == LANES {
            (*quad, *lane) = (timeline.quads.len(), 0);
            timeline.quads.push(Quad { offset: timeline.width, property, bones: [bone; LANES] });
            timeline.width += LANES * track.target.width();
        }
        let own = &mut timeline.quads[*quad];
        own.bones[*lane..].fill(bone);
        (track.offset, track.stride) = (own.offset + *lane, LANES);
        *lane += 1;
    }
    for (at, track) in tracks.iter_mut().enumerate().filter(|(_, track)| track.stride == 1) {
        let width = &mut timelines[track.timeline].width;
        track.offset = *width;
        *width += values_per_key(track.target, track.interpolation);
        if last[&track.target] == at {
            singles.push(at as u32);
        }
    }
    singles
}

impl<'a> Keys<'a> {
    pub(super) fn times(&self) -> &'a [f64] {
        &self.timeline.times
    }

    /// Returns a part of a spline key: the slope before it for a `part` of 0, the value for 1, the
    /// slope after it for 2. A key without slopes only has part 0, its value.
    fn part<const N: usize>(&self, key: usize, part: usize) -> [f64; N] {
        let start = key * self.timeline.width + self.offset + part * N * self.stride;
        std::array::from_fn(|k| self.timeline.values[start + k * self.stride])
    }

    /// Returns the value of a key.
    pub(super) fn value<const N: usize>(&self, key: usize) -> [f64; N] {
        self.part(key, usize::from(self.interpolation == Interpolation::CubicSpline))
    }

    /// Returns the slopes before and after a spline key.
    pub(super) fn slopes<const N: usize>(&self, key: usize) -> [[f64; N]; 2] {
        [self.part(key, 0), self.part(key, 2)]
    }

    fn values_at<const N: usize>(&self, Place { key, share: s, seconds }: Place) -> [f64; N] {
        let from = self.value::<N>(key);
        if s == 0.0 || self.interpolation == Interpolation::Step {
            return from;
        }
        let to = self.value::<N>(key + 1);
        if self.interpolation == Interpolation::Linear {
            return std::array::from_fn(|k| from[k] + s * (to[k] - from[k]));
        }
        let ([_, slope_from], [slope_to, _]) = (self.slopes::<N>(key), self.slopes::<N>(key + 1));
        let (s2, s3) = (s * s, s * s * s);
        let (a, b, c, d) = (2.0 * s3 - 3.0 * s2 + 1.0, s3 - 2.0 * s2 + s, 3.0 * s2 - 2.0 * s3, s3 - s2);
        std::array::from_fn(|k| a * from[k] + b * seconds * slope_from[k] + c * to[k] + d * seconds * slope_to[k])
    }

    /// Returns the rotation of a track that is not linear.
    fn rotation_at(&self, place: Place) -> [f64; 4] {
        let from = self.value::<4>(place.key);
        if self.interpolation != Interpolation::CubicSpline {
            return from;
        }
        // If the spline passes through zero, there is no rotation; the rotation of the key is used.
        normalized(self.values_at::<4>(place)).or_else(|| normalized(from)).unwrap_or([1.0, 0.0, 0.0, 0.0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::error::{RigErrorKind, RigPlace};
    use super::*;

    fn channel(target: Target, interpolation: Interpolation, times: &[f64], values: &[f64]) -> Channel {
        Channel { target, interpolation, times: times.to_vec(), values: values.to_vec() }
    }

    fn translation_at(interpolation: Interpolation, values: &[f64], time: f64, side: Side) -> f64 {
        let channels = vec![channel(Target::Translation(0), interpolation, &[1.0, 3.0], values)];
        let animation = Animation::new(String::new(), channels, 0).unwrap();
        let mut locals = [Transform::IDENTITY];
        animation.sample(time, side, None, &mut locals, &mut []);
        locals[0].translation[0]
    }

    #[test]
    fn every_interpolation() {
        let linear = [2.0, 0.0, 0.0, 6.0, 0.0, 0.0];
        let at = |interpolation, time| translation_at(interpolation, &linear, time, Side::After);
        assert_eq!([0.0, 1.0, 1.5, 3.0, 9.0].map(|t| at(Interpolation::Linear, t)), [2.0, 2.0, 3.0, 6.0, 6.0]);
        assert_eq!([0.0, 2.9, 3.0].map(|t| at(Interpolation::Step, t)), [2.0, 2.0, 6.0]);
        assert_eq!(translation_at(Interpolation::Step, &linear, 3.0, Side::Before), 2.0);
        // x³ from 1 to 3 has the slopes 3 and 27.
        let cubic = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 27.0, 0.0, 0.0, 27.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for t in [1.0, 1.25, 2.0, 2.875, 3.0] {
            let x = translation_at(Interpolation::CubicSpline, &cubic, t, Side::After);
            assert!((x - t * t * t).abs() < 1e-13, "{t} {x}");
        }
    }

    #[test]
    fn spline_rotations_have_length_one() {
        let mut values = vec![0.0; 24];
        (values[4], values[17]) = (1.0, 1.0);
        let channels = vec![channel(Target::Rotation(0), Interpolation::CubicSpline, &[0.0, 1.0], &values)];
        let animation = Animation::new(String::new(), channels, 0).unwrap();
        let mut locals = [Transform::IDENTITY];
        animation.sample(0.5, Side::After, None, &mut locals, &mut []);
        let half = 0.5_f64.sqrt();
        assert!((locals[0].rotation_wxyz[0] - half).abs() < 1e-15 && (locals[0].rotation_wxyz[1] - half).abs() < 1e-15);
    }

    #[test]
    fn invalid_keys_are_named_in_errors() {
        let error = |target, interpolation, times: &[f64], values: &[f64]| {
            Animation::new(String::new(), vec![channel(target, interpolation, times, values)], 7).unwrap_err()
        };
        let (linear, bone) = (Interpolation::Linear, 0);
        let key = |key| RigPlace::Key { animation: 7, channel: 0, key };
        let nan = error(Target::MorphWeight(0), linear, &[0.0, 1.0], &[0.0, f64::NAN]);
        assert_eq!(nan, RigError::new(RigErrorKind::NonFinite { what: "key" }, key(1)));
        let back = error(Target::MorphWeight(0), linear, &[0.0, 0.0], &[0.0, 1.0]);
        assert_eq!(back, RigError::new(RigErrorKind::TimesNotIncreasing, key(1)));
        let time = error(Target::MorphWeight(0), linear, &[f64::NAN], &[0.0]);
        assert_eq!(time, RigError::new(RigErrorKind::NonFinite { what: "time" }, key(0)));
        let few = error(Target::Rotation(bone), linear, &[0.0], &[0.0; 3]);
        assert_eq!(few.kind(), &RigErrorKind::OtherCount { what: "values", count: 3, expected: 4 });
        assert_eq!(error(Target::Rotation(bone), linear, &[0.0], &[0.0; 4]).kind(), &RigErrorKind::ZeroRotation);
        assert_eq!(error(Target::Scale(bone), linear, &[0.0], &[1.0, 0.0, 1.0]).kind(), &RigErrorKind::ZeroScale);
        assert!(matches!(error(Target::Scale(bone), linear, &[], &[]).kind(), RigErrorKind::OtherCount { .. }));
    }
}
