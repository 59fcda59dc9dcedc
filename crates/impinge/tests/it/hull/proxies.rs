//! Stored proxies of meshes: `validate_proxies` accepts a hull only if it is the hull by
//! definition.

use impinge::hull::{Hull, HullKind};
use impinge::volume::{BoundingVolume, Proxies, ProxyFlaw};
use impinge::{Mesh, Positions};
use impinge_testkit::generate::Rng;
use impinge_testkit::rounds;

use crate::hull::oracle::{FAMILIES, dimension, extreme, floats, orientation, small_set};
use crate::hull::surface;

/// Byte offset of the doubles of the volumes. The arrays of the hull begin at [`ARRAYS`].
pub(crate) const VOLUMES: usize = 16;
pub(crate) const ARRAYS: usize = VOLUMES + 800;

/// Returns a mesh of triangles, some without area, between all points except `left_out`.
///
/// Vertex 0 is far away and used by no face, so that vertex numbers differ from point numbers.
fn mesh_without(points: &[[f64; 3]], left_out: Option<usize>) -> Mesh {
    let used: Vec<u32> = (0..points.len()).filter(|&at| Some(at) != left_out).map(|at| at as u32 + 1).collect();
    let faces: Vec<_> = (0..used.len()).map(|at| [0, 1, 2].map(|next| used[(at + next) % used.len()])).collect();
    let mut vertices = vec![[1e9, -1e9, 1e9]];
    vertices.extend(points);
    Mesh::new(Positions::F64(vertices), faces).expect("a legal mesh")
}

pub(crate) fn mesh(points: &[[f64; 3]]) -> Mesh {
    mesh_without(points, None)
}

pub(crate) fn proxies(mesh: &Mesh) -> Proxies {
    mesh.proxies().expect("faces")
}

/// Reads proxies from bytes and validates them.
pub(crate) fn read_and_validated(mesh: &Mesh, bytes: &[u8]) -> Result<Proxies, ProxyFlaw> {
    let read = mesh.proxies_from_bytes(bytes)?;
    mesh.validate_proxies(&read).map(|()| read)
}

fn volumes_hold(proxies: &Proxies, point: [f64; 3]) -> bool {
    proxies.bounds().contains(point)
        && proxies.sphere().contains(point)
        && proxies.capsule().contains(point)
        && proxies.lozenge().contains(point)
        && proxies.obb().contains(point)
        && proxies.kdop14().contains(point)
        && proxies.kdop18().contains(point)
        && proxies.kdop26().contains(point)
}

fn integers(points: [[f64; 3]; 4]) -> i32 {
    orientation(points.map(|p| p.map(|x| x as i64))) as i32
}

#[test]
fn stored_proxies_of_small_sets_are_read_back_and_validated() {
    let mut rng = Rng::new(61);
    let mut kinds = [0; 4];
    for case in 0..1200 {
        let set = small_set(&mut rng, case % FAMILIES);
        let points = floats(&set, 0);
        let mesh = mesh(&points);
        let own = proxies(&mesh);
        let expected: Vec<u32> = extreme(&set).iter().map(|vertex| vertex + 1).collect();
        assert_eq!(own.hull().vertices(), expected, "{set:?}");
        assert!(points.iter().all(|&point| volumes_hold(&own, point)));
        let bytes = own.to_bytes();
        let again = read_and_validated(&mesh, &bytes).unwrap_or_else(|flaw| panic!("{flaw} of {set:?}"));
        assert_eq!(again.to_bytes(), bytes);
        assert_eq!((again.hull().kind(), again.hull().positions()), (own.hull().kind(), own.hull().positions()));
        let (hull, own) = (again.hull(), own.hull());
        assert!((0..expected.len() as u32).all(|vertex| hull.neighbors(vertex) == own.neighbors(vertex)));
        assert!([[1.0, 2.0, 3.0], [-1.0, 0.0, 0.0]].iter().all(|&d| hull.support(d) == own.support(d)));
        kinds[dimension(&set)] += 1;
    }
    assert!(kinds.iter().all(|&count| count > 50), "{kinds:?}");
    let empty = Mesh::new(Positions::F64(vec![[0.0; 3]]), Vec::new()).expect("a legal mesh");
    assert!(empty.proxies().is_none());
}

/// Checks the hull of one point fewer or one point more.
///
/// The hull of fewer points is valid exactly if the missing point is no vertex. The hull of more
/// points is valid exactly if the additional point was no vertex.
#[test]
fn the_hull_of_other_points_is_rejected() {
    let mut rng = Rng::new(62);
    let (mut refused, mut accepted) = ([0; 4], [0; 4]);
    let rounds = rounds(1_200);
    for case in 0..rounds {
        let set = small_set(&mut rng, case % FAMILIES);
        if set.len() < 2 {
            continue;
        }
        let points = floats(&set, [0, 60, -500][case % 3]);
        let left_out = rng.integer(0, set.len() as i64 - 1) as usize;
        let (whole, part) = (mesh(&points), mesh_without(&points, Some(left_out)));
        let is_extreme = extreme(&set).contains(&(left_out as u32));
        // A copy of the point may remain.
        let is_gone =
            is_extreme && !set[..left_out].contains(&set[left_out]) && !set[left_out + 1..].contains(&set[left_out]);
        let kind = dimension(&set);
        // If a copy takes its place, either of the two may be named.
        if is_gone || !is_extreme {
            let flaw = read_and_validated(&whole, &proxies(&part).to_bytes()).err();
            assert_eq!(flaw, is_gone.then_some(ProxyFlaw::Hull), "{set:?} without {left_out}");
            [&mut accepted, &mut refused][usize::from(is_gone)][kind] += 1;
        }
        let of_more = read_and_validated(&part, &proxies(&whole).to_bytes());
        assert_eq!(of_more.err(), is_extreme.then_some(ProxyFlaw::Shape), "{set:?} without {left_out}");
    }
    assert!(refused[1..].iter().chain(&accepted).all(|&count| count * 150 > rounds), "{refused:?} {accepted:?}");
}

#[test]
fn volumes_that_are_too_small_are_rejected_and_larger_ones_are_accepted() {
    let mut rng = Rng::new(63);
    let points: Vec<[f64; 3]> = (0..300).map(|_| [1.0, 2.0, 0.5].map(|size| size * rng.uniform(-1.0, 1.0))).collect();
    let mesh = mesh(&points);
    let bytes = proxies(&mesh).to_bytes();
    let with = |at: usize, change: &dyn Fn(f64) -> f64| {
        let mut changed = bytes.clone();
        let place = VOLUMES + 8 * at..VOLUMES + 8 * at + 8;
        let number = f64::from_le_bytes(bytes[place.clone()].try_into().expect("eight"));
        changed[place].copy_from_slice(&change(number).to_le_bytes());
        read_and_validated(&mesh, &changed).map(drop)
    };
    let lows = (0..3).chain(42..49).chain(56..65).chain(74..87);
    let highs = (3..6).chain([9, 16, 26]).chain(39..42).chain(49..56).chain(65..74).chain(87..100);
    let which = |at: usize| match at {
        0..6 => "box",
        6..10 => "sphere",
        10..17 => "capsule",
        17..27 => "lozenge",
        27..42 => "oriented box",
        42..56 => "14-DOP",
        56..74 => "18-DOP",
        _ => "26-DOP",
    };
    for (bounds, outward) in [(lows.collect::<Vec<usize>>(), -1.0), (highs.collect(), 1.0)] {
        for at in bounds {
            let step = |direction: f64| move |x: f64| if direction > 0.0 { x.next_up() } else { x.next_down() };
            assert_eq!(with(at, &step(-outward)), Err(ProxyFlaw::Volume { which: which(at) }), "{at}");
            assert_eq!(with(at, &step(outward)), Ok(()), "{at}");
            assert_eq!(with(at, &|x| x + 0.25 * outward), Ok(()), "{at}");
        }
    }
    for at in 0..100 {
        for hostile in [f64::NAN, f64::INFINITY, -f64::MAX, f64::MAX] {
            assert!(with(at, &|_| hostile).is_err(), "{at} {hostile}");
        }
    }
}

/// Checks hulls as thin as a unit in the last place, needles, spheres and hulls far from the
/// origin. A point outside must be detected.
#[test]
fn larger_hulls_are_validated_and_one_point_outside_is_detected() {
    let mut rng = Rng::new(64);
    let mut unit = || -> [f64; 3] {
        loop {
            let p: [f64; 3] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&length) {
                return p.map(|x| x / length);
            }
        }
    };
    let shapes: Vec<(&str, Vec<[f64; 3]>)> = vec![
        ("sphere", (0..3000).map(|_| unit()).collect()),
        ("shells", (0..5000).map(|i| unit().map(|x| x * [1.0, 0.9, 0.3][i % 3])).collect()),
        ("far", (0..800).map(|_| unit().map(|x| x + 1e6)).collect()),
        ("needle", (0..800).map(|_| unit()).map(|[x, y, z]| [1e5 * x, 1e-3 * y, 1e-3 * z]).collect()),
        (
            "thin",
            (0..400)
                .map(|i| [f64::from(i % 20), f64::from(i / 20), [1.0, 1.0 + f64::EPSILON][(i % 7 == 3) as usize]])
                .collect(),
        ),
        ("lattice", (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(f64::from)).collect()),
        ("tiny", (0..500).map(|_| unit().map(|x| x * 1e-300)).collect()),
    ];
    for (name, points) in shapes {
        let whole = mesh(&points);
        let bytes = proxies(&whole).to_bytes();
        assert!(read_and_validated(&whole, &bytes).is_ok(), "{name}");
        let hull = Hull::new(&points).expect("in range");
        assert_eq!(hull.kind(), HullKind::Solid);
        for vertex in hull.vertices().iter().step_by(hull.vertices().len() / 8) {
            let part = mesh_without(&points, Some(*vertex as usize));
            let flaw = read_and_validated(&whole, &proxies(&part).to_bytes()).err();
            assert_eq!(flaw, Some(ProxyFlaw::Hull), "{name} without {vertex}");
        }
        // A vertex has moved half of the way to another one. The same numbers describe another
        // surface.
        let mut moved = points.clone();
        let [from, to] = [0, 1].map(|at| hull.vertices()[at] as usize);
        moved[from] = std::array::from_fn(|k| 0.5 * points[from][k] + 0.5 * points[to][k]);
        assert_eq!(read_and_validated(&mesh(&moved), &bytes).err(), Some(ProxyFlaw::Hull), "{name}");
    }
}

/// Checks that spoiled proxies which are accepted are correct anyway.
#[test]
fn spoiled_proxies_are_rejected_or_harmless() {
    let mut rng = Rng::new(65);
    let (mut unread, mut refused, mut harmless) = (0, 0, 0);
    let rounds = rounds(2_000);
    for case in 0..rounds {
        let set = small_set(&mut rng, case % FAMILIES);
        let points = floats(&set, 0);
        let mesh = mesh(&points);
        let mut bytes = proxies(&mesh).to_bytes();
        for _ in 0..rng.integer(1, 2) {
            let at = match case % 3 {
                0 => rng.integer(ARRAYS as i64, bytes.len() as i64 - 1),
                1 => rng.integer(VOLUMES as i64, ARRAYS as i64 - 1),
                _ => rng.integer(0, bytes.len() as i64 - 1),
            } as usize;
            match rng.integer(0, 3) {
                0 => bytes[at] ^= 1 << rng.integer(0, 7),
                1 => bytes[at & !3] = rng.integer(0, 9) as u8,
                2 => {
                    let from = rng.integer(0, bytes.len() as i64 - 8) as usize & !3;
                    bytes.copy_within(from..from + 8, (at & !3).min(from));
                }
                _ => bytes.truncate(at),
            }
            if bytes.len() < ARRAYS + 4 {
                break;
            }
        }
        let Ok(read) = mesh.proxies_from_bytes(&bytes) else {
            unread += 1;
            continue;
        };
        // Valid or not, no query panics.
        let hull = read.hull();
        let found = [hull.support([1.0, -2.0, 0.5]), hull.support_from([-3.0, 1.0, 1.0], 0)];
        assert!(found.iter().all(|&vertex| (vertex as usize) < hull.vertices().len()));
        let _ = hull.contains([0.5; 3]);
        if mesh.validate_proxies(&read).is_err() {
            refused += 1;
            continue;
        }
        harmless += 1;
        assert!(points.iter().all(|&point| volumes_hold(&read, point)), "{set:?}");
        surface::check(hull, points.iter().copied(), integers);
        let sorted = |mut positions: Vec<[i64; 3]>| {
            positions.sort_unstable();
            positions
        };
        let corners = hull.positions().iter().map(|p| p.map(|x| x as i64)).collect();
        let expected = extreme(&set).iter().map(|&vertex| set[vertex as usize]).collect();
        assert_eq!(sorted(corners), sorted(expected), "{set:?}");
    }
    assert!(unread * 12 > rounds && refused * 6 > rounds && harmless * 20 > rounds, "{unread} {refused} {harmless}");
}
