//! Sixteen small clashes with known answers, and further ones, each in many variants: mirrored,
//! swapped, turned, far from the origin, in other units, in single precision, inside out, and with
//! the faces in another order.

use impinge::clash::{Kind, Options, find};
use impinge::query::batch::Execution;
use impinge::scene::Scene;
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::cuboid;

use super::models::side;

/// A surface by its vertices and faces.
#[derive(Clone, Default)]
struct Surface {
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Surface {
    fn block(low: [f64; 3], high: [f64; 3]) -> Self {
        let mesh = cuboid(low, high);
        Self { vertices: mesh.vertices, faces: mesh.faces }
    }

    fn and(mut self, other: &Self) -> Self {
        let first = self.vertices.len() as u32;
        self.vertices.extend(&other.vertices);
        self.faces.extend(other.faces.iter().map(|face| face.map(|vertex| vertex + first)));
        self
    }

    /// Returns a block of 2 x 1 x 1 with a block of 1 x 1 x 1 on its left half, as one solid.
    fn step() -> Self {
        let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let mut surface = Self::default();
        for y in [0.0, 1.0] {
            surface.vertices.extend(outline.map(|[x, z]| [x, y, z]));
        }
        for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]] {
            surface.faces.extend([[a, b, c], [a + 6, c + 6, b + 6]]);
        }
        for i in 0..6 {
            let j = (i + 1) % 6;
            surface.faces.extend([[i, i + 6, j + 6], [i, j + 6, j]]);
        }
        surface
    }

    /// Returns a prism along z over the ring between two polygons of `sides` corners, the first of
    /// them turned by a share of a side. Without an inner radius it is a cylinder.
    fn ring([x, y]: [f64; 2], [inner, outer]: [f64; 2], [low, high]: [f64; 2], sides: u32, turn: f64) -> Self {
        let mut surface = Self::default();
        for i in 0..sides {
            let angle = std::f64::consts::TAU * (f64::from(i) + turn) / f64::from(sides);
            let (sin, cos) = angle.sin_cos();
            for (radius, z) in [(outer, low), (outer, high), (inner, low), (inner, high)] {
                surface.vertices.push([x + radius * cos, y + radius * sin, z]);
            }
        }
        for i in 0..sides {
            let (at, next) = (4 * i, 4 * ((i + 1) % sides));
            let [ol, oh, il, ih] = [0, 1, 2, 3].map(|k| at + k);
            let [pl, ph, jl, jh] = [0, 1, 2, 3].map(|k| next + k);
            surface.faces.extend([[ol, pl, ph], [ol, ph, oh], [ih, oh, ph], [ih, ph, jh], [il, jl, pl], [il, pl, ol]]);
            if inner > 0.0 {
                surface.faces.extend([[il, ih, jh], [il, jh, jl]]);
            }
        }
        surface
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Expected {
    Clash(f64),
    Contact,
    Clearance(f64),
    Contained,
    Duplicate,
    Clear,
}

struct Case {
    name: &'static str,
    a: Surface,
    b: Surface,
    expected: Expected,
    /// Tolerance in meters.
    tolerance: f64,
}

/// Tolerance of most cases, in meters.
const TOLERANCE: f64 = 1e-4;

fn cases() -> Vec<Case> {
    use Expected::{Clash, Clear, Clearance, Contact, Contained, Duplicate};
    let block = Surface::block;
    let unit = || block([0.0; 3], [1.0; 3]);
    let wall = || block([0.0; 3], [5.0, 0.2, 3.0]);
    let frame = || {
        // Four walls of one solid: a ring of boxes would have common faces inside.
        let outer = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.5], [0.0, 1.5]];
        let inner = [[0.2, 0.2], [1.8, 0.2], [1.8, 1.3], [0.2, 1.3]];
        let mut frame = Surface::default();
        for at in 0..4 {
            for (ring, z) in [(outer, 0.0), (outer, 0.3), (inner, 0.0), (inner, 0.3)] {
                frame.vertices.push([ring[at][0], ring[at][1], z]);
            }
        }
        for at in 0..4 {
            let (i, j) = (4 * at, 4 * ((at + 1) % 4));
            let quads = [
                [i, j, j + 1, i + 1],
                [i + 3, i + 1, j + 1, j + 3],
                [i + 2, i + 3, j + 3, j + 2],
                [i, i + 2, j + 2, j],
            ];
            frame.faces.extend(quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]));
        }
        frame
    };
    let sag = 0.03 * (1.0 - (std::f64::consts::PI / 24.0).cos());
    let tube = |turn| Surface::ring([0.0; 2], [0.03, 0.05], [0.0, 1.0], 24, turn);
    let rod = |turn| Surface::ring([0.0; 2], [0.0, 0.03], [-0.5, 1.5], 24, turn);
    // Two U-shapes, hooked into each other without touching.
    let hook = |[x, y, z]: [f64; 3], upright: bool| {
        let turn = |low: [f64; 3], high: [f64; 3]| {
            let place = |[u, v, w]: [f64; 3]| if upright { [x + u, y + w, z + v] } else { [x + u, y + v, z + w] };
            block(place(low), place(high))
        };
        turn([0.0, 0.0, 0.0], [1.0, 0.1, 0.1])
            .and(&turn([0.0, 0.1, 0.0], [0.1, 1.0, 0.1]))
            .and(&turn([0.9, 0.1, 0.0], [1.0, 1.0, 0.1]))
    };
    let window = || {
        block([1.0, 0.05, 1.0], [2.0, 0.15, 1.1])
            .and(&block([1.0, 0.05, 1.1], [1.1, 0.15, 2.0]))
            .and(&block([1.9, 0.05, 1.1], [2.0, 0.15, 2.0]))
    };
    let crossing = || block([0.0, 0.4, 0.4], [1.0, 0.6, 0.6]).and(&block([0.4, 0.0, 0.4], [0.6, 1.0, 0.6]));
    let case = |name, a, b, expected| Case { name, a, b, expected, tolerance: TOLERANCE };
    vec![
        case("aligned walls", wall(), block([4.95, 0.0, 0.0], [9.0, 0.2, 3.0]), Clash(0.05)),
        case("2 mm off axis", wall(), block([4.95, 0.002, 0.0], [9.0, 0.202, 3.0]), Clash(0.05)),
        case("corner", wall(), block([4.95, -2.0, 0.0], [5.15, 0.2, 3.0]), Clash(0.05)),
        case("shared face", wall(), block([5.0, 0.0, 0.0], [9.0, 0.2, 3.0]), Contact),
        case("edge on edge", unit(), block([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]), Contact),
        case("corner on corner", unit(), block([1.0; 3], [2.0; 3]), Contact),
        case("gap of 5 mm", unit(), block([1.005, 0.0, 0.0], [2.0, 1.0, 1.0]), Clearance(0.005)),
        case("inside", unit(), block([0.3; 3], [0.7; 3]), Contained),
        case("inside, one face shared", unit(), block([0.3, 0.3, 0.0], [0.7, 0.7, 0.4]), Contained),
        case("duplicate", unit(), unit(), Duplicate),
        case("duct", wall(), block([2.0, -1.0, 1.0], [2.4, 1.0, 1.4]), Clash(0.2)),
        case(
            "bolt through a sheet",
            block([0.0; 3], [1.0, 1.0, 0.001]),
            Surface::ring([0.505, 0.505], [0.0, 0.005], [-0.05, 0.05], 64, 0.0),
            Clash(0.005 * (std::f64::consts::PI / 64.0).cos()),
        ),
        case(
            "bolt in a sheet",
            block([0.0; 3], [1.0, 1.0, 0.01]),
            block([0.4, 0.4, 0.009], [0.6, 0.6, 0.2]),
            Clash(0.001),
        ),
        case("plug", frame(), block([0.2, 0.2, 0.0], [1.8, 1.3, 0.3]), Contact),
        case("wide plug", frame(), block([0.199, 0.2, 0.0], [1.801, 1.3, 0.3]), Clash(0.001)),
        case("rod in a tube, alike", tube(0.0), rod(0.0), Contact),
        Case { tolerance: 2.0 * sag, ..case("rod in a tube", tube(0.0), rod(0.5), Contact) },
        Case { tolerance: 0.25 * sag, ..case("rod in a tube, small tolerance", tube(0.0), rod(0.5), Clash(sag)) },
        // Inside the step, the plate lies in the plane of the tread beside it.
        Case {
            tolerance: 0.005,
            ..case("plate in a step", Surface::step(), block([0.2, 0.3, 0.999], [2.5, 0.7, 1.001]), Clash(0.5))
        },
        case(
            "block flush in a block",
            block([0.0; 3], [1.0; 3]),
            block([0.25, 0.25, 0.0], [0.75, 0.75, 0.5]),
            Contained,
        ),
        case(
            "block that stands out of a block",
            block([0.0; 3], [1.0; 3]),
            block([0.25, 0.25, -0.001], [0.75, 0.75, 0.5]),
            Clash(0.5),
        ),
        // The window alone has the wall on all sides.
        case("window in a wall", wall(), window(), Contained),
        case("hooked", hook([0.0; 3], false), hook([0.45, 0.45, -0.45], true), Clear),
        case("one arm of a cross", crossing(), block([0.8, 0.5, 0.5], [1.2, 0.7, 0.7]), Clash(0.1)),
        case("other arm of a cross", crossing(), block([0.5, -0.2, 0.5], [0.7, 0.2, 0.7]), Clash(0.1)),
        case("beside the arms of a cross", crossing(), block([0.7, 0.7, 0.4], [0.9, 0.9, 0.6]), Clear),
    ]
}

#[derive(Clone, Copy, Debug, Default)]
struct Variant {
    mirrored: bool,
    /// Whether the pose mirrors, and not the vertices.
    mirrored_by_pose: bool,
    /// Whether the faces are clockwise, seen from outside.
    inside_out: bool,
    swapped: bool,
    turned: bool,
    far: bool,
    reversed: bool,
    single: bool,
    /// Units in a meter.
    unit: Option<f64>,
}

fn variants() -> Vec<Variant> {
    let plain = Variant::default();
    vec![
        plain,
        Variant { mirrored: true, ..plain },
        Variant { mirrored_by_pose: true, ..plain },
        Variant { inside_out: true, ..plain },
        Variant { swapped: true, ..plain },
        Variant { turned: true, ..plain },
        Variant { far: true, ..plain },
        Variant { unit: Some(1000.0), ..plain },
        Variant { unit: Some(1.0 / 0.0254), ..plain },
        Variant { single: true, ..plain },
        Variant { reversed: true, ..plain },
        Variant { turned: true, mirrored: true, swapped: true, reversed: true, ..plain },
    ]
}

impl Variant {
    fn mesh(&self, surface: &Surface) -> Mesh {
        let unit = self.unit.unwrap_or(1.0);
        let place = |[x, y, z]: [f64; 3]| [if self.mirrored { -x } else { x }, y, z].map(|c| c * unit);
        let vertices: Vec<[f64; 3]> = surface.vertices.iter().map(|&vertex| place(vertex)).collect();
        let mut faces = surface.faces.clone();
        if self.mirrored != self.inside_out {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        if self.reversed {
            faces.reverse();
        }
        let positions = if self.single {
            Positions::F32(vertices.into_iter().map(|vertex| vertex.map(|c| c as f32)).collect())
        } else {
            Positions::F64(vertices)
        };
        Mesh::new(positions, faces).unwrap()
    }

    fn pose(&self) -> Pose {
        let translation = if self.far { [1e6, -1e6, 1e6] } else { [0.0; 3] };
        let quaternion = if self.turned { [0.5, 0.1, -0.7, 0.5] } else { [1.0, 0.0, 0.0, 0.0] };
        let pose = Pose::from_quaternion_wxyz(translation, quaternion).unwrap();
        if self.mirrored_by_pose { (pose * mirror()).unwrap() } else { pose }
    }
}

/// Returns the reflection in the plane across the first axis.
fn mirror() -> Pose {
    let mut linear = *Pose::IDENTITY.linear();
    linear[0][0] = -1.0;
    Pose::new(linear, [0.0; 3]).unwrap()
}

/// Returns the kind of a pair, and its depth or gap in meters as an interval.
fn found(case: &Case, variant: &Variant) -> (Kind, Option<[f64; 2]>) {
    let mut scene = Scene::new();
    let [first, second] = if variant.swapped { [&case.b, &case.a] } else { [&case.a, &case.b] };
    let unit = variant.unit.unwrap_or(1.0);
    scene.add("first", variant.mesh(first).solid(), variant.pose()).unwrap();
    scene.add("second", variant.mesh(second).solid(), variant.pose()).unwrap();
    let options = Options { clearance: Some(0.01 * unit), contacts: true, ..Options::new(case.tolerance * unit) };
    let report = find(&[side("model", &scene)], options, Execution::default()).unwrap();
    if let [set] = &report.duplicates[..] {
        assert_eq!(set.parts.len(), 2);
        return (Kind::Duplicate, None);
    }
    let [clash] = &report.clashes[..] else { return (Kind::Clear, None) };
    let meters = |interval: [f64; 2]| interval.map(|x| x / unit);
    (clash.kind, clash.depth.or(clash.gap).map(meters))
}

#[test]
fn small_cases_have_their_kinds_in_all_variants() {
    let mut checked = 0;
    for case in cases() {
        for variant in variants() {
            let (kind, interval) = found(&case, &variant);
            let name = format!("{} {variant:?}: {kind:?} {interval:?}", case.name);
            // A vertex far away, and one in single precision, is rounded.
            let rounding = if variant.far {
                1e-9
            } else if variant.single {
                1e-6
            } else {
                1e-11
            };
            let holds = |value: f64, width: f64| {
                let [lower, upper] = interval.unwrap();
                assert!(lower <= value + rounding && value <= upper + rounding, "{name}");
                assert!(upper - lower <= width * value + rounding, "{name}");
            };
            match case.expected {
                Expected::Clash(depth) => {
                    assert_eq!(kind, Kind::Clash, "{name}");
                    // Facets that cross at small angles need more cells than a search has.
                    holds(depth, if case.tolerance < TOLERANCE { 0.25 } else { 1.0 / 16.0 });
                }
                Expected::Clearance(gap) => {
                    assert_eq!(kind, Kind::Clearance, "{name}");
                    holds(gap, 1e-9);
                }
                Expected::Contact => assert_eq!(kind, Kind::Contact, "{name}"),
                Expected::Contained => assert!(matches!(kind, Kind::Contained(_)), "{name}"),
                Expected::Duplicate => assert_eq!(kind, Kind::Duplicate, "{name}"),
                Expected::Clear => assert_eq!(kind, Kind::Clear, "{name}"),
            }
            checked += 1;
        }
    }
    assert_eq!(checked, 312);
}

#[test]
fn five_copies_in_one_place_are_one_set() {
    let mut scene = Scene::new();
    let mesh = Variant::default().mesh(&Surface::block([0.0; 3], [1.0; 3]));
    for at in 0..5 {
        scene.add(format!("copy {at}"), mesh.solid(), Pose::IDENTITY).unwrap();
    }
    let report = find(&[side("model", &scene)], Options::new(TOLERANCE), Execution::default()).unwrap();
    assert!(report.clashes.is_empty() && report.duplicates.len() == 1);
    assert_eq!(report.duplicates[0].parts.len(), 5);
}

#[test]
fn an_open_wall_clashes_with_a_pipe_through_it() {
    let mut wall = Surface::block([0.0; 3], [5.0, 0.2, 3.0]);
    // Without its bottom, which is in the plane of z = 0.
    let vertices = wall.vertices.clone();
    wall.faces.retain(|face| face.iter().any(|&vertex| vertices[vertex as usize][2] != 0.0));
    assert_eq!(wall.faces.len(), 10);
    let pipe = Surface::ring([0.0; 2], [0.0, 0.05], [-1.0, 1.0], 32, 0.0);
    let pipe = Surface { vertices: pipe.vertices.iter().map(|[x, y, z]| [x + 2.0, *z, y + 1.5]).collect(), ..pipe };
    let case = Case { name: "", a: wall, b: pipe, expected: Expected::Contact, tolerance: 0.002 };
    let (kind, depth) = found(&case, &Variant::default());
    assert_eq!(kind, Kind::Clash);
    // The wall is thicker than the pipe.
    assert!(depth.is_some_and(|[lower, upper]| lower > 0.09 && upper < 0.2), "{depth:?}");
}
