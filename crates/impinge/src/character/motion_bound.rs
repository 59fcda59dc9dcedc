//! Bounds how far a skinned vertex may deviate, between two times, from the straight line between
//! its positions at both times, as seen from the rigid frame of another bone. So a finite number of
//! poses can represent a whole motion.
//!
//! # Source
//! A curve deviates from its chord by at most h²/8 times its largest second derivative (Taylor).
//! The derivatives of a bone's translation, rotation and scale over the interval are bounded by the
//! control points of their polynomials or by the constant speed of a rotation. Those of a chain of
//! bones follow by the rules for sums and products of norms. Only the bones between the two take
//! part, so a motion of the body as a whole adds nothing.
//!
//! Tests: those of this file, and `impinge-files/tests/it/characters/holding.rs`.

use super::animation::{Animation, Keys};
use super::channel::{Interpolation, Target};
use super::rig::Rig;
use super::transform::Transform;
use crate::math::vec3::Vector;

/// Upper bounds of the norm of a changing quantity and of its first and second time derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Jet {
    pub(super) value: f64,
    pub(super) first: f64,
    pub(super) second: f64,
}

impl Jet {
    fn still(value: f64) -> Self {
        Self { value, first: 0.0, second: 0.0 }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, first: self.first + other.first, second: self.second + other.second }
    }

    /// Returns the bounds of a product of two quantities.
    fn times(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value + 2.0 * self.first * other.first + self.value * other.second,
        }
    }

    fn scaled(self, by: f64) -> Self {
        Self { value: self.value * by, first: self.first * by, second: self.second * by }
    }
}

/// The motion of a bone relative to its parent over an interval.
#[derive(Clone, Copy, Debug)]
struct LocalMotion {
    translation: Jet,
    /// The value is 1, because it is a rotation.
    rotation: Jet,
    scale: Jet,
    /// A constant uniform scale from which the scales differ by `deviation`.
    uniform: f64,
    deviation: Jet,
}

impl LocalMotion {
    fn resting(rest: &Transform) -> Self {
        let uniform = rest.scale.iter().sum::<f64>() / 3.0;
        let away = rest.scale.iter().map(|s| (s - uniform).abs()).fold(0.0, f64::max);
        Self {
            translation: Jet::still(norm(rest.translation)),
            rotation: Jet::still(1.0),
            scale: Jet::still(rest.scale.iter().map(|s| s.abs()).fold(0.0, f64::max)),
            uniform,
            deviation: Jet::still(away),
        }
    }

    /// Returns the bounds of the image of a moving point.
    fn apply(&self, point: Jet) -> Jet {
        self.translation.plus(self.rotation.times(self.scale.times(point)))
    }
}

/// The bounds of all bones and morph weights of an animation over one interval without a key
/// inside.
pub(super) struct IntervalMotion<'a> {
    rig: &'a Rig,
    locals: Vec<LocalMotion>,
    pub(super) morphs: Vec<Jet>,
}

impl<'a> IntervalMotion<'a> {
    pub(super) fn new(rig: &'a Rig, animation: &Animation, interval: [f64; 2]) -> Self {
        let mut locals: Vec<LocalMotion> =
            rig.skeleton().bones().iter().map(|bone| LocalMotion::resting(&bone.rest)).collect();
        let mut morphs: Vec<Jet> = rig.skin().morphs().iter().map(|m| Jet::still(m.weight.abs())).collect();
        for track in animation.tracks() {
            let keys = animation.keys(track);
            match track.target {
                Target::Translation(bone) => {
                    let spline = Spline::<3>::of(keys, interval);
                    locals[bone as usize].translation = spline.jet([0.0; 3]);
                }
                Target::Scale(bone) => {
                    let spline = Spline::<3>::of(keys, interval);
                    let local = &mut locals[bone as usize];
                    local.uniform = spline.controls[0].iter().sum::<f64>() / 3.0;
                    local.scale = spline.jet([0.0; 3]);
                    local.deviation = spline.jet([local.uniform; 3]);
                }
                Target::Rotation(bone) => {
                    locals[bone as usize].rotation = Spline::<4>::of(keys, interval).rotation(interval);
                }
                Target::MorphWeight(morph) => {
                    morphs[morph as usize] = Spline::<1>::of(keys, interval).jet([0.0]);
                }
            }
        }
        Self { rig, locals, morphs }
    }

    /// Returns a bound on the second derivative of a point given in the frame of bone `from`, as
    /// seen from the rigid frame of bone `to`. The result is infinite if there is no bound.
    ///
    /// Let a be the last common ancestor of both, M the maps and R the rotations without scales,
    /// and o the origin of `to`. The point is then R(a→to)ᵀ K (x - o) in the frame of a. K = R(a)ᵀ
    /// M(a) is c I + E for a constant c. E is zero unless scales change or differ by axis.
    pub(super) fn acceleration(&self, from: u32, to: u32, point: Jet) -> f64 {
        let skeleton = self.rig.skeleton();
        let top = skeleton.common_ancestor(from, to);
        let below = |bone: u32| skeleton.ancestry(bone).take_while(move |&bone| Some(bone) != top);
        let local = |bone: u32| &self.locals[bone as usize];
        let image = below(from).fold(point, |jet, bone| local(bone).apply(jet));
        let origin = below(to).fold(Jet::default(), |jet, bone| local(bone).apply(jet));
        let turn = below(to).fold(Jet::still(1.0), |jet, bone| jet.times(local(bone).rotation));
        let (mut constant, mut error) = (1.0, Jet::default());
        let mut above: Vec<u32> = top.into_iter().flat_map(|top| skeleton.ancestry(top)).collect();
        above.reverse();
        for bone in above {
            // K of the child is Rᵀ (c I + E) R S, with S = s I + D.
            let LocalMotion { rotation, scale, uniform, deviation, .. } = *local(bone);
            let turned = rotation.times(error).times(rotation);
            error = deviation.scaled(f64::abs(constant)).plus(turned.times(scale));
            constant *= uniform;
        }
        let factor = Jet { value: f64::abs(constant) + error.value, ..error };
        let bound = turn.times(factor.times(image.plus(origin))).second;
        if bound.is_nan() { f64::INFINITY } else { bound }
    }
}

/// The control points of a track over an interval without keys, as a polynomial in Bézier form.
struct Spline<const N: usize> {
    interpolation: Interpolation,
    controls: [[f64; N]; 4],
    /// Length of the key segment in seconds. Infinite if nothing moves.
    seconds: f64,
    start: f64,
}

impl<const N: usize> Spline<N> {
    fn of(keys: Keys<'_>, interval: [f64; 2]) -> Self {
        let times = keys.times();
        let after = times.partition_point(|&key| key <= interval[0]);
        let from = keys.value::<N>(after.saturating_sub(1));
        let still =
            Self { interpolation: Interpolation::Step, controls: [from; 4], seconds: f64::INFINITY, start: 0.0 };
        if after == 0 || after == times.len() {
            return still;
        }
        let to = keys.value::<N>(after);
        let (start, seconds) = (times[after - 1], times[after] - times[after - 1]);
        let third = |p: [f64; N], slope: [f64; N], share: f64| std::array::from_fn(|k| p[k] + share * slope[k]);
        let controls = match keys.interpolation {
            Interpolation::Step => return still,
            Interpolation::Linear => [from, from, to, to],
            Interpolation::CubicSpline => {
                let ([_, slope_from], [slope_to, _]) = (keys.slopes::<N>(after - 1), keys.slopes::<N>(after));
                [from, third(from, slope_from, seconds / 3.0), third(to, slope_to, -seconds / 3.0), to]
            }
        };
        Self { interpolation: keys.interpolation, controls, seconds, start }
    }

    /// Returns bounds of the difference from a point, from the hull of the control points and of
    /// their differences.
    fn jet(&self, from: [f64; N]) -> Jet {
        let c = &self.controls;
        let difference = |a: [f64; N], b: [f64; N]| -> [f64; N] { std::array::from_fn(|k| b[k] - a[k]) };
        let most = |lengths: &[f64]| lengths.iter().fold(0.0_f64, |most, &x| most.max(x));
        let value = most(&c.map(|p| norm(difference(from, p))));
        match self.interpolation {
            Interpolation::Step => Jet::still(value),
            Interpolation::Linear => Jet { value, first: norm(difference(c[0], c[3])) / self.seconds, second: 0.0 },
            Interpolation::CubicSpline => {
                let d = [0, 1, 2].map(|k| difference(c[k], c[k + 1]));
                let dd = [0, 1].map(|k| norm(difference(d[k], d[k + 1])));
                let h = self.seconds;
                Jet { value, first: 3.0 / h * most(&d.map(norm)), second: 6.0 / (h * h) * most(&dd) }
            }
        }
    }
}

impl Spline<4> {
    /// Returns bounds of the rotation of the normalized quaternion over the interval.
    ///
    /// A quaternion q of length 1 rotates at 2 |q'|, and the second derivative of its matrix is at
    /// most (2 |q'|)² + 2 |q''|. For q = c / |c| with |c| ≥ m, |q'| ≤ |c'| / m and |q''| ≤ |c''| /
    /// m + 3 |c'|² / m².
    fn rotation(&self, interval: [f64; 2]) -> Jet {
        let [from, _, _, to] = self.controls;
        match self.interpolation {
            Interpolation::Step => Jet::still(1.0),
            Interpolation::Linear => {
                // On the shorter arc the chord is at most √2. There arcsin x ≤ x + 0.2216 x³, with
                // equality at the end.
                let chord = |sign: f64| norm(std::array::from_fn::<f64, 4, _>(|k| to[k] - sign * from[k]));
                let x = 0.5 * chord(1.0).min(chord(-1.0));
                let speed = 4.0 * (x + 0.2216 * x * x * x) / self.seconds;
                Jet { value: 1.0, first: speed, second: speed * speed }
            }
            Interpolation::CubicSpline => {
                let Jet { first, second, .. } = self.jet([0.0; 4]);
                let middle = 0.5 * interval[0] + 0.5 * interval[1];
                let least = norm(self.at(middle)) - 0.5 * (interval[1] - interval[0]) * first;
                if least.is_nan() || least <= 0.0 {
                    return Jet { value: 1.0, first: f64::INFINITY, second: f64::INFINITY };
                }
                let speed = 2.0 * first / least;
                let turning = 2.0 * (second / least + 3.0 * (first / least) * (first / least));
                Jet { value: 1.0, first: speed, second: speed * speed + turning }
            }
        }
    }

    fn at(&self, time: f64) -> [f64; 4] {
        let s = ((time - self.start) / self.seconds).clamp(0.0, 1.0);
        let weights = [(1.0 - s).powi(3), 3.0 * s * (1.0 - s) * (1.0 - s), 3.0 * s * s * (1.0 - s), s * s * s];
        std::array::from_fn(|k| (0..4).map(|i| weights[i] * self.controls[i][k]).sum())
    }
}

fn norm<const N: usize>(v: [f64; N]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns the image of a point under an affine map whose rows end with the translation.
pub(super) fn mapped(map: &[[f64; 4]; 3], p: Vector) -> Vector {
    map.map(|[x, y, z, t]| x * p[0] + y * p[1] + z * p[2] + t)
}

#[cfg(test)]
mod tests {
    use super::super::{Bone, Channel, Influence, Joint, RigPose, Skeleton, Skin};
    use super::*;

    const BIND: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    /// Builds a trunk, an arm of three bones on it, and another bone on the trunk. All of them move
    /// and rotate, by splines or linearly.
    fn rig(interpolation: Interpolation, seed: u64, scales: f64) -> Rig {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let parents = [None, Some(0), Some(1), Some(2), Some(0)];
        let bones = parents.map(|parent| Bone { name: String::new(), parent, rest: Transform::IDENTITY }).to_vec();
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let mut channels = Vec::new();
        for bone in 0..5 {
            let times = vec![0.0, 0.25];
            let mut channel = |target: Target, spread: f64, about: f64| {
                let values = (0..2 * parts * target.width()).map(|at| {
                    let is_value = parts == 1 || at / target.width() % 3 == 1;
                    spread * random() + if is_value { about } else { 0.0 }
                });
                channels.push(Channel { target, interpolation, times: times.clone(), values: values.collect() });
            };
            channel(Target::Translation(bone), 1.0, 0.0);
            channel(Target::Rotation(bone), 0.6, 0.5);
            channel(Target::Scale(bone), scales, 1.0);
        }
        let animation = Animation::new(String::new(), channels, 0).unwrap();
        let joints = (0..5).map(|bone| Joint { bone, inverse_bind: BIND }).collect();
        let influences = [vec![Influence { joint: 0, weight: 1.0 }]];
        let skin = Skin::new(vec![[0.0; 3]], vec![], joints, &influences, vec![]).unwrap();
        Rig::new(Skeleton::new(bones).unwrap(), skin, vec![animation]).unwrap()
    }

    fn seen_from(pose: &RigPose, from: u32, to: u32, point: Vector) -> Vector {
        let (from, to) = (&pose.bones()[from as usize], &pose.bones()[to as usize]);
        let x = from.apply(point);
        super::super::transform::apply_transposed(
            &super::super::transform::matrix(to.rotation_wxyz),
            [0, 1, 2].map(|k| x[k] - to.origin()[k]),
        )
    }

    #[test]
    fn no_vertex_strays_farther_from_its_chord() {
        const POINT: Vector = [0.3, -0.4, 1.2];
        let (mut tightest, mut cases) = (f64::INFINITY, 0);
        for interpolation in [Interpolation::Linear, Interpolation::CubicSpline] {
            for (seed, scales) in (0..12).flat_map(|seed| [(seed, 0.0), (seed, 1e-6), (seed, 0.3)]) {
                let rig = rig(interpolation, seed, scales);
                let interval = [0.05, 0.09];
                let motion = IntervalMotion::new(&rig, &rig.animations()[0], interval);
                let h = interval[1] - interval[0];
                for (from, to) in [(1, 1), (1, 0), (0, 1), (3, 1), (1, 3), (3, 4), (4, 3)] {
                    let bound = h * h / 8.0 * motion.acceleration(from, to, Jet::still(norm(POINT)));
                    let at = |t: f64| seen_from(&rig.pose_at(0, t).unwrap(), from, to, POINT);
                    let (start, end) = (at(interval[0]), at(interval[1]));
                    let mut worst = 0.0_f64;
                    for step in 1..16 {
                        let s = f64::from(step) / 16.0;
                        let x = at(interval[0] + s * h);
                        worst = worst.max(norm([0, 1, 2].map(|k| x[k] - (start[k] + s * (end[k] - start[k])))));
                    }
                    assert!(worst <= bound + 1e-14, "{interpolation:?} {seed} {scales} {from} {to}: {worst} {bound}");
                    if worst > 1e-9 {
                        tightest = tightest.min(bound / worst);
                        cases += 1;
                    }
                }
            }
        }
        // Checks that the bound is tight enough for the test to be meaningful.
        assert!(cases > 300 && tightest < 2.0, "{cases} {tightest}");
    }

    #[test]
    fn rotating_the_whole_body_adds_no_acceleration() {
        let rig = rig(Interpolation::Linear, 1, 0.0);
        let motion = IntervalMotion::new(&rig, &rig.animations()[0], [0.0, 0.25]);
        assert_eq!(motion.acceleration(2, 2, Jet::still(1.0)), 0.0);
        assert!(motion.acceleration(2, 1, Jet::still(1.0)) > 0.0);
    }
}
