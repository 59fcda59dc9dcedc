//! Culls pairs of links by the volumes about them, before any shape is placed.
//!
//! Guarded by `tests/it/robots/culling.rs` and lemma L43 of the proofs.

use super::frame::Frame;
use super::outline::Ball;
use super::proxy::{Proxy, Volumes};
use super::shell::{self, ROUNDING};
use crate::math::vec3::{dot, sub};
use crate::simd::best_level;

/// Share of the magnitude of translations that covers the rounding of images and of distances,
/// 2^-44.
pub(super) const SLACK: f64 = 256.0 * f64::EPSILON;

/// Maximum sum of the magnitudes of a translation for which links are culled, 2^200. Farther poses
/// may be out of range.
pub(super) const MAX_OFFSET: f64 = f64::from_bits((1023 + 200) << 52);

/// The segment and the radius of a capsule in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limb {
    pub(super) ends: [[f64; 3]; 2],
    pub(super) radius: f64,
}

/// Volumes about the links in a configuration. Capsules are computed when they are first needed.
#[derive(Clone, Debug, Default)]
pub(super) struct Culling {
    spheres: Vec<Ball>,
    limbs: Vec<Vec<Limb>>,
    is_placed: Vec<bool>,
    /// Distance that the rounding of any two volumes may add.
    slack: f64,
}

impl Culling {
    /// Starts a configuration.
    pub(super) fn start(&mut self, proxies: &[Proxy], frames: &[Frame]) {
        self.spheres.clear();
        self.limbs.resize(proxies.len(), Vec::new());
        self.is_placed.clear();
        self.is_placed.resize(proxies.len(), false);
        let mut offset = 0.0_f64;
        for (proxy, frame) in proxies.iter().zip(frames) {
            let ball = match proxy {
                Proxy::Within(volumes) => (frame.apply(volumes.sphere.0), volumes.sphere.1),
                Proxy::Nowhere => ([0.0; 3], f64::NEG_INFINITY),
                Proxy::Anywhere => ([0.0; 3], f64::INFINITY),
            };
            self.spheres.push(ball);
            let size = frame.0.iter().map(|row| row[3].abs()).sum::<f64>();
            // A sum that is not a number stays one.
            offset = if size <= offset { offset } else { size };
        }
        self.slack = if offset <= MAX_OFFSET { SLACK * offset } else { f64::INFINITY };
    }

    /// Reports whether two links are proved to be farther apart than a clearance.
    pub(super) fn are_apart(&mut self, pair: [usize; 2], clearance: f64, proxies: &[Proxy], frames: &[Frame]) -> bool {
        let [(p, r), (q, s)] = pair.map(|link| self.spheres[link]);
        let reach = r + s + (clearance + self.slack);
        if reach == f64::NEG_INFINITY {
            return true;
        }
        let between = sub(&q, &p);
        if dot(&between, &between) > reach * reach * ROUNDING + f64::MIN_POSITIVE {
            return true;
        }
        if reach == f64::INFINITY {
            return false;
        }
        for link in pair {
            self.place(link, proxies, frames);
        }
        let [a, b] = pair.map(|link| &self.limbs[link]);
        let margin = clearance + self.slack;
        a.iter().all(|a| b.iter().all(|b| limbs_are_apart(a, b, margin)))
    }

    /// Returns the capsules of a link, or `None` if its shape may be anywhere.
    pub(super) fn limbs(&mut self, link: usize, proxies: &[Proxy], frames: &[Frame]) -> Option<(&[Limb], f64)> {
        self.place(link, proxies, frames);
        let is_known = !matches!(proxies[link], Proxy::Anywhere) && self.slack < f64::INFINITY;
        is_known.then(|| (&*self.limbs[link], self.slack))
    }

    /// Computes the capsules of all links.
    pub(super) fn place_all(&mut self, proxies: &[Proxy], frames: &[Frame]) {
        (0..proxies.len()).for_each(|link| self.place(link, proxies, frames));
    }

    /// Returns the capsules of a link that were computed, or `None` if its shape may be anywhere.
    pub(super) fn placed_limbs(&self, link: usize, proxies: &[Proxy]) -> Option<&[Limb]> {
        (!matches!(proxies[link], Proxy::Anywhere)).then(|| &*self.limbs[link])
    }

    /// Returns a lower bound of the distance of two links, whose capsules were computed.
    pub(super) fn least_distance(&self, pair: [usize; 2], proxies: &[Proxy]) -> f64 {
        let [Some(a), Some(b)] = pair.map(|link| self.placed_limbs(link, proxies)) else { return 0.0 };
        let least = |a: &Limb| b.iter().map(|b| least_distance(a, b)).fold(f64::INFINITY, f64::min);
        // A slack that is infinite or NaN gives zero.
        (a.iter().map(least).fold(f64::INFINITY, f64::min) - self.slack).max(0.0)
    }

    /// Returns a lower bound of the distance of two links, whose capsules were computed, by
    /// capsules and by the convex hulls of pieces. The search ends if the bound reaches `enough`.
    pub(super) fn least_distance_of_hulls(
        &self,
        pair: [usize; 2],
        enough: f64,
        proxies: &[Proxy],
        frames: &[Frame],
    ) -> f64 {
        let [Some(a), Some(b)] = pair.map(|link| self.placed_limbs(link, proxies)) else { return 0.0 };
        let shell = |side: usize, piece: usize| {
            let link = pair[side];
            let shell = if let Proxy::Within(volumes) = &proxies[link] { volumes.shells[piece].as_ref() } else { None };
            shell.map(|shell| (shell, &frames[link]))
        };
        let (level, enough) = (best_level(), enough + self.slack);
        let mut least = f64::INFINITY;
        for (i, a) in a.iter().enumerate() {
            for (j, b) in b.iter().enumerate() {
                let of_capsules = least_distance(a, b);
                // Pieces that are farther apart than others, or than needed, do not matter.
                if of_capsules >= least.min(enough) {
                    least = least.min(of_capsules);
                } else if let (Some(a_shell), Some(b_shell)) = (shell(0, i), shell(1, j)) {
                    let between = nearest_offset(a.ends, b.ends);
                    let of_hulls = shell::least_distance(level, a_shell, b_shell, between, least.min(enough));
                    least = least.min(of_capsules.max(of_hulls));
                } else {
                    least = least.min(of_capsules);
                }
            }
        }
        // A slack that is infinite or NaN gives zero.
        (least - self.slack).max(0.0)
    }

    /// Returns the greatest radius of the capsules of a link that were computed.
    pub(super) fn thickness(&self, link: usize) -> f64 {
        self.limbs[link].iter().map(|limb| limb.radius).fold(0.0, f64::max)
    }

    /// Returns a bound on the sum of the magnitudes of the coordinates of all volumes.
    pub(super) fn size(&self, proxies: &[Proxy], frames: &[Frame]) -> f64 {
        let of = |(proxy, frame): (&Proxy, &Frame)| {
            let local = if let Proxy::Within(Volumes { sphere: (center, radius), .. }) = proxy {
                2.0 * center.iter().map(|x| x.abs()).sum::<f64>() + radius
            } else {
                0.0
            };
            frame.0.iter().map(|row| row[3].abs()).sum::<f64>() + local
        };
        proxies.iter().zip(frames).map(of).fold(0.0, |size, of| if of <= size { size } else { of })
    }

    /// Computes the capsules of a link.
    pub(super) fn place(&mut self, link: usize, proxies: &[Proxy], frames: &[Frame]) {
        if self.is_placed[link] {
            return;
        }
        self.is_placed[link] = true;
        self.limbs[link].clear();
        if let Proxy::Within(volumes) = &proxies[link] {
            let place = |capsule: &crate::volume::Capsule| Limb {
                ends: capsule.ends().map(|end| frames[link].apply(end)),
                radius: capsule.radius(),
            };
            self.limbs[link].extend(volumes.capsules.iter().map(place));
        }
    }
}

/// Reports whether two capsules are proved to be farther apart than a margin.
fn limbs_are_apart(a: &Limb, b: &Limb, margin: f64) -> bool {
    let (gap, squared_length) = gap(a, b);
    let reach = a.radius + b.radius + margin;
    gap > 0.0 && gap * gap > reach * reach * squared_length * ROUNDING + f64::MIN_POSITIVE
}

/// Returns a lower bound of the distance of two capsules, less than zero if they may overlap. Its
/// rounding is in the slack of the culling.
fn least_distance(a: &Limb, b: &Limb) -> f64 {
    let (gap, squared_length) = gap(a, b);
    let distance = if gap > 0.0 { gap / squared_length.sqrt() } else { 0.0 };
    // Squares that vanish or overflow prove nothing.
    if squared_length.is_normal() { distance / ROUNDING - (a.radius + b.radius) } else { 0.0 }
}

/// Returns the gap between the projections of two segments onto a vector, and the squared length of
/// the vector.
///
/// The vector joins nearest points of the segments, which plain formulas compute and which prove
/// nothing. The distance is at least the gap over the length, whatever the vector is.
fn gap(a: &Limb, b: &Limb) -> (f64, f64) {
    let between = nearest_offset(a.ends, b.ends);
    let [a0, a1] = a.ends.map(|end| dot(&between, &sub(&end, &a.ends[0])));
    let [b0, b1] = b.ends.map(|end| dot(&between, &sub(&end, &a.ends[0])));
    (b0.min(b1) - a0.max(a1), dot(&between, &between))
}

/// Returns the vector from the point of the first segment that is nearest to the second, to the
/// nearest point of the second, rounded.
///
/// # Source
/// Ericson, 5.1.9.
fn nearest_offset([p, p_end]: [[f64; 3]; 2], [q, q_end]: [[f64; 3]; 2]) -> [f64; 3] {
    let (d, e, r) = (sub(&p_end, &p), sub(&q_end, &q), sub(&p, &q));
    let (a, b, c, f, g) = (dot(&d, &d), dot(&d, &e), dot(&d, &r), dot(&e, &r), dot(&e, &e));
    let ratio = |x: f64, y: f64| if y > 0.0 { (x / y).clamp(0.0, 1.0) } else { 0.0 };
    let s = ratio(b * f - c * g, a * g - b * b);
    let t = ratio(b * s + f, g);
    // With t clamped, this s is the best for it.
    let s = ratio(b * t - c, a);
    std::array::from_fn(|k| (q[k] + t * e[k]) - (p[k] + s * d[k]))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::query::{self, Proximity};
    use crate::robot::{Joint, JointKind, Link, Robot};
    use crate::shape::Shape;
    use impinge_testkit::generate::Rng;

    fn shapes() -> Vec<Shape> {
        let bar = Shape::cuboid([1.0, 0.25, 0.25]).expect("a box");
        let at = |x: f64| Pose::from_translation([x, 0.0, 0.5]).expect("a pose");
        let corner = Shape::compound(&[(bar.clone(), Pose::IDENTITY), (bar.clone(), at(1.0))]).expect("a compound");
        vec![
            Shape::sphere([0.0; 3], 0.5).expect("a sphere"),
            Shape::capsule([0.0; 3], [0.0, 0.0, 1.0], 0.25).expect("a capsule"),
            Shape::cylinder(0.5, 0.25).expect("a cylinder"),
            bar,
            corner,
        ]
    }

    /// Returns a chain of links with joints that slide and turn about the axes of a grid.
    pub(in crate::robot) fn chain(rng: &mut Rng, count: usize) -> Robot {
        let all = shapes();
        let links = (0..count).map(|at| {
            let shape = (!rng.one_in(6)).then(|| all[rng.integer(0, all.len() as i64 - 1) as usize].clone());
            Link { name: at.to_string(), shape }
        });
        let links = links.collect();
        let joints = (1..count).map(|at| {
            let moved = [0; 3].map(|_| 0.5 * rng.integer(-3, 3) as f64);
            let origin = Pose::from_translation(moved).expect("a pose");
            let kind = [JointKind::Revolute, JointKind::Prismatic][rng.integer(0, 1) as usize];
            let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][rng.integer(0, 2) as usize];
            Joint::fixed(format!("j{at}"), (at - 1).to_string(), at.to_string(), origin).moving(kind, axis)
        });
        Robot::new(links, joints.collect()).expect("a robot")
    }

    #[test]
    fn culled_pairs_are_apart() {
        let mut rng = Rng::new(1);
        let (mut culled, mut apart, mut touching) = (0, 0, 0);
        let (mut culling, mut frames) = (Culling::default(), Vec::new());
        for _ in 0..60 {
            let robot = chain(&mut rng, 6);
            for _ in 0..6 {
                let step = |kind| if kind == JointKind::Prismatic { 0.25 } else { std::f64::consts::FRAC_PI_4 };
                let q: Vec<f64> =
                    robot.joints().iter().map(|joint| step(joint.kind) * rng.integer(-4, 4) as f64).collect();
                robot.place(&q, &mut frames);
                culling.start(robot.proxies(), &frames);
                let clearance = [0.0, 0.25][rng.integer(0, 1) as usize];
                for &[a, b] in robot.pairs() {
                    let is_culled = culling.are_apart([a, b], clearance, robot.proxies(), &frames);
                    let placed = [a, b].map(|link| {
                        let pose = frames[link].pose().expect("a pose");
                        robot.links()[link].shape.as_ref().expect("a shape").at(pose).expect("a place")
                    });
                    let found = query::nearness(&placed[0], &placed[1], clearance);
                    assert!(!is_culled || found == Proximity::Apart, "{a} {b} {q:?}");
                    culled += usize::from(is_culled);
                    apart += usize::from(found == Proximity::Apart);
                    let distance = query::distance(&placed[0], &placed[1]);
                    touching += usize::from((distance.upper - clearance).abs() < 1e-9);
                }
            }
        }
        assert!(culled * 10 > apart * 6, "{culled} of {apart}");
        assert!(touching > 50, "{touching}");
    }

    #[test]
    fn distances_of_hulls_are_below_the_distances_of_links() {
        let mut rng = Rng::new(2);
        let (mut apart, mut longer, mut near, mut touching) = (0, 0, 0, 0);
        let (mut culling, mut frames) = (Culling::default(), Vec::new());
        for round in 0..60 {
            let robot = chain(&mut rng, 6);
            for _ in 0..6 {
                let step = |kind| if kind == JointKind::Prismatic { 0.25 } else { std::f64::consts::FRAC_PI_4 };
                let q: Vec<f64> =
                    robot.joints().iter().map(|joint| step(joint.kind) * rng.integer(-4, 4) as f64).collect();
                robot.place(&q, &mut frames);
                culling.start(robot.proxies(), &frames);
                culling.place_all(robot.proxies(), &frames);
                let enough = [f64::INFINITY, 0.25][round % 2];
                for &[a, b] in robot.pairs() {
                    let by_capsules = culling.least_distance([a, b], robot.proxies());
                    let least = culling.least_distance_of_hulls([a, b], enough, robot.proxies(), &frames);
                    let placed = [a, b].map(|link| {
                        let pose = frames[link].pose().expect("a pose");
                        robot.links()[link].shape.as_ref().expect("a shape").at(pose).expect("a place")
                    });
                    let distance = query::distance(&placed[0], &placed[1]).upper;
                    assert!(least <= distance, "{a} {b} {q:?} {least} {distance}");
                    assert!(least >= by_capsules.min(enough), "{a} {b} {q:?} {least} {by_capsules}");
                    apart += usize::from(distance > 1e-4);
                    longer += usize::from(least > by_capsules);
                    near += usize::from(distance > 1e-4 && least >= (0.85 * distance).min(enough));
                    touching += usize::from(distance < 1e-9);
                }
            }
        }
        assert!(near * 10 > apart * 9 && longer * 4 > apart, "{near} {longer} of {apart}");
        assert!(touching > 50, "{touching}");
    }

    #[test]
    fn spheres_are_culled_up_to_the_rounding() {
        let sphere = Shape::sphere([0.0; 3], 0.5).ok();
        let link = |name: &str, shape: &Option<Shape>| Link { name: name.to_owned(), shape: shape.clone() };
        let slide = |name: &str, parent: &str, child: &str| {
            Joint::fixed(name, parent, child, Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0])
        };
        let links = vec![link("0", &sphere), link("1", &None), link("2", &sphere)];
        let robot = Robot::new(links, vec![slide("a", "0", "1"), slide("b", "1", "2")]).expect("a robot");
        let (mut culling, mut frames) = (Culling::default(), Vec::new());
        let mut is_culled = |x: f64, clearance: f64| {
            robot.place(&[x, 0.0], &mut frames);
            culling.start(robot.proxies(), &frames);
            culling.are_apart([0, 2], clearance, robot.proxies(), &frames)
        };
        assert!(!is_culled(1.0, 0.0) && is_culled(1.0 + 1e-10, 0.0));
        assert!(!is_culled(-1.5, 0.5) && is_culled(-1.5 - 1e-10, 0.5));
    }
}
