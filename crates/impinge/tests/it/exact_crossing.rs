//! Intersections of two triangles (`exact::crossing`) against rational geometry.
//!
//! Each end of a reported segment must be the exact end rounded to nearest, and must lie on the
//! named vertex, edge or face of both triangles.

use std::collections::HashMap;

use crate::exact_oracle::*;
use dashu_ratio::RBig;
use impinge::Pose;
use impinge::exact::{Corners, Crossing, Endpoint, Feature, Placement, crossing, triangles_intersect};

type Point = [RBig; 3];
type Triangle = [Point; 3];

fn minus(x: &Point, y: &Point) -> Point {
    std::array::from_fn(|k| x[k].clone() - y[k].clone())
}

fn cross(u: &Point, v: &Point) -> Point {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[i].clone() * v[j].clone() - u[j].clone() * v[i].clone()
    })
}

fn dot(u: &Point, v: &Point) -> RBig {
    (0..3).fold(RBig::ZERO, |sum, k| sum + u[k].clone() * v[k].clone())
}

fn is_zero(u: &Point) -> bool {
    u.iter().all(|x| *x == RBig::ZERO)
}

fn normal([p, q, r]: &Triangle) -> Point {
    cross(&minus(q, p), &minus(r, p))
}

/// Reports whether a point is in the relative interior of a vertex, edge or face of a triangle.
fn is_on(x: &Point, triangle: &Triangle, feature: Feature) -> bool {
    match feature {
        Feature::Vertex(k) => triangle[usize::from(k)] == *x,
        Feature::Edge(k) => {
            let (p, q) = (&triangle[usize::from(k)], &triangle[(usize::from(k) + 1) % 3]);
            let between = dot(&minus(p, x), &minus(q, x)) < RBig::ZERO;
            is_zero(&cross(&minus(p, x), &minus(q, x))) && between && !triangle.contains(x)
        }
        Feature::Face => {
            let normal = normal(triangle);
            let inside = |k: usize| dot(&normal, &cross(&minus(&triangle[k], x), &minus(&triangle[(k + 1) % 3], x)));
            dot(&normal, &minus(x, &triangle[0])) == RBig::ZERO && (0..3).all(|k| inside(k) > RBig::ZERO)
        }
    }
}

/// Returns the points in which the edges of one triangle cross the other triangle, which must have
/// area. Edges parallel to its plane are skipped.
fn edge_points(edges: &Triangle, plane: &Triangle) -> Vec<Point> {
    let n = normal(plane);
    let mut points = Vec::new();
    for k in 0..3 {
        let (p, q) = (&edges[k], &edges[(k + 1) % 3]);
        let (h_p, h_q) = (dot(&n, &minus(p, &plane[0])), dot(&n, &minus(q, &plane[0])));
        if h_p == h_q || (h_p.clone() * h_q.clone() > RBig::ZERO) {
            continue;
        }
        let t = h_p.clone() / (h_p - h_q);
        let x: Point = std::array::from_fn(|i| p[i].clone() + t.clone() * (q[i].clone() - p[i].clone()));
        let side = |j: usize| dot(&n, &cross(&minus(&plane[j], &x), &minus(&plane[(j + 1) % 3], &x)));
        if (0..3).all(|j| side(j) >= RBig::ZERO) {
            points.push(x);
        }
    }
    points
}

fn assert_nearest(point: &[f64; 3], x: &Point) {
    for k in 0..3 {
        let distance = |y: f64| {
            let difference = rational(y) - x[k].clone();
            if difference < RBig::ZERO { -difference } else { difference }
        };
        let own = distance(point[k]);
        assert!(own <= distance(point[k].next_up()) && own <= distance(point[k].next_down()), "{point:?} {x:?}");
    }
}

#[derive(Default, Debug)]
struct Tally {
    cases: usize,
    points: usize,
    segments: usize,
    coplanar: usize,
    apart: usize,
    vertices: usize,
    edges: usize,
    faces: usize,
}

impl Tally {
    fn check(&mut self, world_from_a: &Pose, world_from_b: &Pose, a: &Corners, b: &Corners) {
        let placement = Placement::new(world_from_a, world_from_b);
        let found = crossing(&placement, a, b);
        self.cases += 1;
        assert_eq!(found != Crossing::Apart, triangles_intersect(&placement, a, b), "{a:?} {b:?}");
        assert_eq!(found, swapped(crossing(&Placement::new(world_from_b, world_from_a), b, a)), "{a:?} {b:?}");

        let world_a = a.map(|corner| world_point(world_from_a, &corner));
        let world_b = b.map(|corner| world_point(world_from_b, &corner));
        let (normal_a, normal_b) = (normal(&world_a), normal(&world_b));
        let mut ends = Vec::new();
        if !is_zero(&normal_a) {
            ends.extend(edge_points(&world_b, &world_a));
        }
        if !is_zero(&normal_b) {
            ends.extend(edge_points(&world_a, &world_b));
        }
        let direction = cross(&normal_a, &normal_b);
        ends.sort_by_key(|x| dot(x, &direction));
        let mut check_end = |endpoint: &Endpoint, x: &Point| {
            assert!(is_on(x, &world_a, endpoint.on_a), "{endpoint:?} {a:?} {b:?}");
            assert!(is_on(x, &world_b, endpoint.on_b), "{endpoint:?} {a:?} {b:?}");
            assert_nearest(&endpoint.point, x);
            for feature in [endpoint.on_a, endpoint.on_b] {
                match feature {
                    Feature::Vertex(_) => self.vertices += 1,
                    Feature::Edge(_) => self.edges += 1,
                    Feature::Face => self.faces += 1,
                }
            }
        };
        match found {
            Crossing::Apart => self.apart += 1,
            Crossing::Coplanar => {
                self.coplanar += 1;
                let in_one_plane = |n: &Point, own: &Triangle, other: &Triangle| {
                    other.iter().all(|x| dot(n, &minus(x, &own[0])) == RBig::ZERO)
                };
                assert!(in_one_plane(&normal_a, &world_a, &world_b) && in_one_plane(&normal_b, &world_b, &world_a));
            }
            Crossing::Point(end) => {
                self.points += 1;
                check_end(&end, &ends[0]);
                check_end(&end, &ends[ends.len() - 1]);
            }
            Crossing::Segment(start, finish) => {
                self.segments += 1;
                assert_ne!(ends[0], ends[ends.len() - 1]);
                check_end(&start, &ends[0]);
                check_end(&finish, &ends[ends.len() - 1]);
            }
        }
    }

    fn assert_variety(&self) {
        let at_least = |count: usize, share: f64| assert!(count as f64 >= share * self.cases as f64, "{self:?}");
        at_least(self.apart, 0.2);
        at_least(self.points, 0.05);
        at_least(self.segments, 0.05);
        at_least(self.coplanar, 0.02);
        at_least(self.vertices, 0.1);
        at_least(self.edges, 0.05);
        at_least(self.faces, 0.01);
    }
}

fn swapped(crossing: Crossing) -> Crossing {
    let swap = |end: Endpoint| Endpoint { on_a: end.on_b, on_b: end.on_a, point: end.point };
    match crossing {
        Crossing::Point(end) => Crossing::Point(swap(end)),
        Crossing::Segment(start, finish) => Crossing::Segment(swap(finish), swap(start)),
        same => same,
    }
}

#[test]
fn ties_in_one_frame_are_decided() {
    let mut random = Random(21);
    let mut tally = Tally::default();
    for _ in 0..10_000 {
        let (a, b) = tied_pair(&mut random);
        tally.check(&Pose::IDENTITY, &Pose::IDENTITY, &a, &b);
    }
    tally.assert_variety();
}

#[test]
fn ties_under_affine_poses() {
    let mut random = Random(22);
    let mut tally = Tally::default();
    for _ in 0..6000 {
        let (a, b) = tied_pair(&mut random);
        let world_from_a = match random.integer(0, 2) {
            0 => rotation(&mut random),
            1 => Pose::new(integer_linear(&mut random, 3), integer_offset(&mut random, 3)).expect("legal"),
            _ => Pose::new(integer_linear(&mut random, 1), integer_offset(&mut random, 3)).expect("legal"),
        };
        tally.check(&world_from_a, &world_from_a, &a, &b);
        let factor = random.pick(&[-2.0, -1.0, 1.0, 0.5]);
        let linear = world_from_a.linear().map(|row| row.map(|x| x * factor));
        let world_from_b = Pose::new(linear, *world_from_a.translation()).expect("legal");
        tally.check(&world_from_a, &world_from_b, &a, &scaled_corners(&b, 1.0 / factor));
    }
    tally.assert_variety();
}

/// Checks that both triangles at an edge of A that pierces B end their segments at the same named
/// point.
#[test]
fn segments_of_neighbors_link_up() {
    let mut random = Random(23);
    let mut links = 0;
    for _ in 0..20_000 {
        let (a, b) = tied_pair(&mut random);
        let [p, q, _] = a;
        let other: [f64; 3] = std::array::from_fn(|_| random.integer(-2, 2) as f64);
        // The neighbor across edge 0 lists the ends of that edge in the opposite order.
        let neighbor = [q, p, other];
        let pose = rotation(&mut random);
        let placement = Placement::new(&pose, &pose);
        let ends = |crossing: Crossing| match crossing {
            Crossing::Point(end) => vec![end],
            Crossing::Segment(start, finish) => vec![start, finish],
            _ => vec![],
        };
        let (own, others) = (ends(crossing(&placement, &a, &b)), ends(crossing(&placement, &neighbor, &b)));
        // If the interior of edge 0 ends in the face of B, then the edge pierces B. A neighbor
        // without area may name its features otherwise.
        let pierces = |end: &&Endpoint| (end.on_a, end.on_b) == (Feature::Edge(0), Feature::Face);
        for end in own.iter().filter(pierces) {
            let has_area = !is_zero(&normal(&neighbor.map(|corner| corner.map(rational))));
            assert!(others.contains(end) || !has_area, "{a:?} {neighbor:?} {b:?}");
            links += usize::from(has_area);
        }
    }
    assert!(links > 200, "{links}");
}

/// Returns the sorted mesh vertices of a vertex, edge or face of a triangle.
fn part(face: &[usize; 3], feature: Feature) -> Vec<usize> {
    let mut vertices = match feature {
        Feature::Vertex(k) => vec![face[usize::from(k)]],
        Feature::Edge(k) => vec![face[usize::from(k)], face[(usize::from(k) + 1) % 3]],
        Feature::Face => face.to_vec(),
    };
    vertices.sort_unstable();
    vertices
}

/// Checks over all pairs of faces of two closed meshes, touching in all ways, that each point has
/// one name and one set of bits.
#[test]
fn a_point_has_one_name() {
    const TETRAHEDRON: &[[usize; 3]] = &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    const OCTAHEDRON: &[[usize; 3]] =
        &[[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    const UNIT: [[f64; 3]; 6] =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut random = Random(24);
    let (mut shared, mut vertices) = (0, 0);
    for case in 0..3000 {
        let mut mesh = || -> (Vec<[f64; 3]>, &[[usize; 3]]) {
            if random.one_in(2) {
                let center = integer_offset(&mut random, 1);
                let size = random.integer(1, 2) as f64;
                let moved = |v: [f64; 3]| std::array::from_fn(|k| size * v[k] + center[k]);
                (UNIT.map(moved).to_vec(), OCTAHEDRON)
            } else {
                // The tetrahedron has a volume. Otherwise one point could be on two of its faces.
                let from = integer_offset(&mut random, 1);
                let edges = integer_linear(&mut random, 3);
                let ends = edges.map(|edge| std::array::from_fn(|k| from[k] + edge[k]));
                (vec![from, ends[0], ends[1], ends[2]], TETRAHEDRON)
            }
        };
        let ((vertices_a, faces_a), (vertices_b, faces_b)) = (mesh(), mesh());
        let corners = |vertices: &[[f64; 3]], face: &[usize; 3]| face.map(|vertex| vertices[vertex]);
        let has_area = |corners: &Corners| !is_zero(&normal(&corners.map(|corner| corner.map(rational))));
        let world_from_a = rotation(&mut random);
        let factor = [1.0, 2.0][case % 2];
        let linear = world_from_a.linear().map(|row| row.map(|x| x * factor));
        let world_from_b = Pose::new(linear, *world_from_a.translation()).expect("legal");
        let placement = Placement::new(&world_from_a, &world_from_b);

        let mut names: HashMap<[u64; 3], (Vec<usize>, Vec<usize>)> = HashMap::new();
        let mut points: HashMap<(Vec<usize>, Vec<usize>), [u64; 3]> = HashMap::new();
        for face_a in faces_a {
            for face_b in faces_b {
                let a = corners(&vertices_a, face_a);
                let b = scaled_corners(&corners(&vertices_b, face_b), 1.0 / factor);
                if !has_area(&a) || !has_area(&b) {
                    continue;
                }
                let ends = match crossing(&placement, &a, &b) {
                    Crossing::Point(end) => vec![end],
                    Crossing::Segment(start, finish) => vec![start, finish],
                    Crossing::Apart | Crossing::Coplanar => vec![],
                };
                for end in ends {
                    let name = (part(face_a, end.on_a), part(face_b, end.on_b));
                    let bits = end.point.map(f64::to_bits);
                    vertices += usize::from(name.0.len() == 1);
                    if let Some(other) = names.insert(bits, name.clone()) {
                        assert_eq!(other, name, "{vertices_a:?} {vertices_b:?}");
                        shared += 1;
                    }
                    if let Some(other) = points.insert(name, bits) {
                        assert_eq!(other, bits);
                    }
                }
            }
        }
    }
    assert!(shared > 10_000 && vertices > 3000, "{shared} {vertices}");
}
