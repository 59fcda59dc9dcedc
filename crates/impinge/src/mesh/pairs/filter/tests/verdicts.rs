//! Verdicts of the filter compared with the exact decision.

use std::collections::HashMap;

use impinge_testkit::generate::Rng;
use impinge_testkit::generate::poses::{large_integer_map, rotation};
use impinge_testkit::{Affine, oracle};

use super::super::*;
use super::{Point, Side8, along, power_of_two, relate, unit_point};
use crate::exact::{Placement, triangles_intersect};
use crate::mesh::pairs::sides::Sides;
use crate::simd::{Level, dispatch, levels};

/// Returns a triangle that intersects `host` or just misses it, by about `gap`.
fn close_to(rng: &mut Rng, host: &[Point; 3], gap: f64) -> [Point; 3] {
    let [p, q, r] = host;
    let edge = along(p, q, rng.unit());
    let inside = along(&edge, r, rng.unit());
    let shift = |rng: &mut Rng, point: &Point| {
        let step = unit_point(rng);
        std::array::from_fn(|axis| point[axis] + gap * step[axis])
    };
    let far = |rng: &mut Rng, from: &Point| {
        let step = unit_point(rng);
        std::array::from_fn::<f64, 3, _>(|axis| from[axis] + step[axis])
    };
    match rng.integer(0, 3) {
        // A corner near the face.
        0 => [shift(rng, &inside), far(rng, &inside), far(rng, &inside)],
        // All corners near the plane.
        1 => {
            let (s, t) = (rng.uniform(-1.0, 2.0), rng.uniform(-1.0, 2.0));
            [shift(rng, &inside), shift(rng, &along(&inside, q, s)), shift(rng, &along(&inside, r, t))]
        }
        // Edges that cross.
        2 => {
            let (on, end) = (shift(rng, &edge), far(rng, &edge));
            [end, along(&end, &on, rng.uniform(1.0, 3.0)), far(rng, &edge)]
        }
        // A sliver.
        _ => {
            let (on, end) = (shift(rng, &inside), far(rng, &inside));
            let other = along(&end, &on, rng.uniform(1.0, 3.0));
            let between = along(&end, &other, rng.unit());
            [end, other, shift(rng, &between)]
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Generic,
    Close,
    /// Close, with sizes that differ by up to 2^50.
    Sized,
    /// Slivers that pass each other, at a small distance or a large one.
    Slivers,
}

/// Returns a triangle of length one or two along a direction through a point, so thin that single
/// precision does not determine its plane.
fn sliver(rng: &mut Rng, through: &Point, direction: &Point) -> [Point; 3] {
    let end: Point = std::array::from_fn(|axis| through[axis] + direction[axis]);
    let other = along(&end, through, rng.uniform(1.5, 3.0));
    let step = unit_point(rng).map(|x| 1e-6 * x);
    let beside = along(&end, &other, rng.choose(&[0.0, 1.0]));
    [end, other, std::array::from_fn(|axis| beside[axis] + step[axis])]
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    Intersecting,
    Apart,
    Undecided,
}

/// Adds the near pairs of two packets to the candidates.
fn push_pairs(level: Level, host: &Side8, guest: &Side8, sides: Sides, candidates: &mut Candidates) {
    let (relation, back) = (relate(host, guest), relate(guest, host));
    dispatch!(level, simd => {
        let mut taken = Guest::EMPTY;
        taken.set_packet(simd, &guest.packet(), &relation, &back);
        let packet = host.mesh.packets().get(simd, 0);
        let slab_test = taken.test_slabs(simd, &packet, 0xff);
        let faces = LeafFaces { host: &packet.leaf.faces, guest: &guest.packet().leaf.faces, sides };
        taken.push_candidates(simd, &packet, &slab_test, &faces, candidates);
    });
}

/// Classifies candidates, eight at a time, as long as at least `min_count` are left. Returns the
/// faces and the verdict of each.
fn classify_all(level: Level, candidates: &mut Candidates, min_count: usize) -> Vec<([usize; 2], Verdict)> {
    let mut classified = Vec::new();
    while candidates.count() - classified.len() >= min_count {
        let from = classified.len();
        let count = LANES.min(candidates.count() - from);
        let verdicts = dispatch!(level, simd => candidates.classify(simd, from));
        let Verdicts { intersecting, undecided, .. } = verdicts;
        assert!(intersecting & undecided == 0 && (intersecting | undecided) >> count == 0);
        classified.extend((0..count).map(|lane| {
            let verdict = match (intersecting >> lane & 1, undecided >> lane & 1) {
                (0, 0) => Verdict::Apart,
                (1, _) => Verdict::Intersecting,
                _ => Verdict::Undecided,
            };
            (verdicts.faces(lane).map(|face| face as usize), verdict)
        }));
    }
    candidates.remove_first(classified.len());
    classified
}

/// Numbers of pairs that were proved to intersect, proved apart, and left undecided.
#[derive(Clone, Copy, Debug, Default)]
struct Outcomes {
    intersecting: usize,
    apart: usize,
    undecided: usize,
}

/// Returns two packets.
fn packets(rng: &mut Rng, kind: Kind) -> (Side8, Side8) {
    let (hosts, guests) = (rng.integer(1, 8) as usize, rng.integer(1, 8) as usize);
    // Slivers of one packet are parallel in some cases.
    let (same, common) = (rng.one_in(2), [0; 2].map(|_| unit_point(rng)));
    let direction = |rng: &mut Rng, side: usize| {
        let turn = if same { 0.0 } else { rng.choose(&[0.01, 1.0]) };
        along(&common[side], &unit_point(rng), turn)
    };
    let mut host: Vec<[Point; 3]> = (0..hosts)
        .map(|_| match kind {
            Kind::Slivers => {
                let (through, direction) = (unit_point(rng), direction(rng, 0));
                sliver(rng, &through, &direction)
            }
            _ => [0; 3].map(|_| unit_point(rng)),
        })
        .collect();
    let size = if kind == Kind::Sized { power_of_two(rng, -50, 50) } else { 1.0 };
    let mut guest: Vec<[Point; 3]> = (0..guests)
        .map(|i| match kind {
            Kind::Generic => [0; 3].map(|_| unit_point(rng)),
            Kind::Slivers => {
                let [p, q, _] = host[i % hosts];
                let on = along(&p, &q, rng.uniform(0.2, 0.8));
                let gap = if rng.one_in(8) { 0.0 } else { power_of_two(rng, -30, -4) };
                let step = unit_point(rng);
                let direction = direction(rng, 1);
                sliver(rng, &std::array::from_fn(|axis| on[axis] + gap * step[axis]), &direction)
            }
            Kind::Close | Kind::Sized => {
                let gap = if rng.one_in(8) { 0.0 } else { power_of_two(rng, -54, -4) };
                let host = &host[i % hosts];
                let near = close_to(rng, host, gap);
                // Scaled about its first corner, which is close in half of the cases.
                let size = if rng.one_in(4) { size.sqrt() } else { size };
                near.map(|corner| along(&near[0], &corner, size))
            }
        })
        .collect();
    if rng.one_in(3) {
        // On the grid of single precision.
        for x in host.iter_mut().chain(&mut guest).flatten().flatten() {
            *x = f64::from(*x as f32);
        }
    }
    // A map of both meshes changes no answer, nor does a power of two that the pose takes back.
    let common = match rng.integer(0, 3) {
        0 => large_integer_map(rng),
        1 => rotation(rng),
        _ => Affine::IDENTITY,
    };
    let range = if common.linear[0][1].abs() > 2.0 { 40 } else { 60 };
    let range = if rng.one_in(2) { 0 } else { range };
    let side = |rng: &mut Rng, corners: &[[Point; 3]]| {
        let scale = power_of_two(rng, -range, range);
        let stray = rng.one_in(3).then(|| [power_of_two(rng, 0, 12) / scale; 3]);
        let own: Vec<[Point; 3]> = corners.iter().map(|c| c.map(|point| point.map(|x| x / scale))).collect();
        let linear = common.linear.map(|row| row.map(|x| x * scale));
        Side8::new(&own, stray, Affine { linear, translation: common.translation })
    };
    (side(rng, &host), side(rng, &guest))
}

fn classify_packets(kind: Kind, seed: u64, count: usize) -> Outcomes {
    let mut rng = Rng::new(seed);
    let mut outcomes = Outcomes::default();
    let mut asked = 0;
    for _ in 0..count {
        let (host, guest) = packets(&mut rng, kind);
        let [hosts, guests] = [&host, &guest].map(|side| side.mesh.faces().len());
        let placement = Placement::new(&host.world_from_mesh(), &guest.world_from_mesh());
        let truths: Vec<Vec<bool>> = (0..guests)
            .map(|g| {
                (0..hosts)
                    .map(|h| {
                        triangles_intersect(&placement, &host.mesh.corners(h as u32), &guest.mesh.corners(g as u32))
                    })
                    .collect()
            })
            .collect();
        for (name, level) in levels() {
            let mut candidates = Candidates::EMPTY;
            push_pairs(level, &host, &guest, Sides::FIRST_HOSTS, &mut candidates);
            let count = candidates.count();
            let classified: HashMap<[usize; 2], Verdict> =
                classify_all(level, &mut candidates, 1).into_iter().collect();
            assert_eq!((classified.len(), candidates.count()), (count, 0), "{name}: a pair came twice");
            assert!(classified.keys().all(|&[h, g]| h < hosts && g < guests), "{name}: a lane without a triangle");
            for [h, g] in (0..hosts).flat_map(|h| (0..guests).map(move |g| [h, g])) {
                let verdict = classified.get(&[h, g]).copied().unwrap_or(Verdict::Apart);
                if verdict == Verdict::Undecided {
                    outcomes.undecided += 1;
                    continue;
                }
                let (intersects, truth) = (verdict == Verdict::Intersecting, truths[g][h]);
                assert_eq!(intersects, truth, "{name}, {kind:?}, faces {h} and {g}: {host:?} {guest:?}");
                *(if intersects { &mut outcomes.intersecting } else { &mut outcomes.apart }) += 1;
                asked += 1;
                if asked % 101 == 0 {
                    // An oracle that shares no code with the engine.
                    let (a, b) = (host.mesh.corners(h as u32), guest.mesh.corners(g as u32));
                    assert_eq!(truth, oracle::triangles_meet(&a, &host.pose, &b, &guest.pose));
                }
            }
        }
    }
    outcomes
}

#[test]
fn generic_pairs_are_decided_correctly() {
    let Outcomes { intersecting, apart, undecided } = classify_packets(Kind::Generic, 84, 800);
    let total = intersecting + apart + undecided;
    assert!(undecided * 50 < total, "{undecided} of {total} are undecided");
    assert!(
        intersecting * 10 > total && apart * 3 > total,
        "{intersecting} intersect and {apart} are apart of {total}"
    );
}

#[test]
fn close_pairs_are_never_wrong() {
    for (kind, seed, rare) in [(Kind::Close, 85, 20), (Kind::Sized, 86, 200)] {
        let Outcomes { intersecting, apart, undecided } = classify_packets(kind, seed, 1_500);
        let total = intersecting + apart + undecided;
        assert!(
            intersecting * rare > total && apart * 10 > total && undecided * 20 > total,
            "{kind:?}: {intersecting} {apart} {undecided}"
        );
    }
}

#[test]
fn slivers_that_pass_each_other_are_apart() {
    let Outcomes { intersecting, apart, undecided } = classify_packets(Kind::Slivers, 87, 1_500);
    let total = intersecting + apart + undecided;
    assert!(
        undecided * 6 < total && undecided * 100 > total,
        "{intersecting} intersect, {apart} are apart and {undecided} are undecided"
    );
}

/// Candidates of many packets in shared vectors get the same verdicts as those of each packet
/// alone, whichever mesh is the host.
#[test]
fn other_candidates_of_a_batch_change_no_verdict() {
    let mut rng = Rng::new(88);
    let mut beside = 0;
    for _ in 0..20 {
        let kinds = [Kind::Generic, Kind::Close, Kind::Sized, Kind::Slivers];
        let sides: Vec<(Side8, Side8)> = (0..20).map(|at| packets(&mut rng, kinds[at % 4])).collect();
        for (name, level) in levels() {
            let (mut alone, mut together, mut candidates) = (Vec::new(), Vec::new(), Candidates::EMPTY);
            for (at, (host, guest)) in sides.iter().enumerate() {
                let mut own = Candidates::EMPTY;
                push_pairs(level, host, guest, Sides::FIRST_HOSTS, &mut own);
                beside += usize::from(!own.count().is_multiple_of(LANES));
                let turned = if at % 2 == 1 { Sides::SECOND_HOSTS } else { Sides::FIRST_HOSTS };
                let in_turn = |([h, g], verdict): ([usize; 2], Verdict)| (turned.first_second([h, g]), verdict);
                alone.extend(classify_all(level, &mut own, 1).into_iter().map(in_turn));
                push_pairs(level, host, guest, turned, &mut candidates);
                if !candidates.has_room() {
                    together.extend(classify_all(level, &mut candidates, LANES));
                    assert!(candidates.count() < LANES && candidates.has_room());
                }
            }
            together.extend(classify_all(level, &mut candidates, 1));
            assert_eq!(alone, together, "{name}");
        }
    }
    assert!(beside > 500, "{beside}");
}
