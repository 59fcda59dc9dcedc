//! Deforming surfaces against every pair of their features.

use impinge::InputErrorKind;
use impinge::sweep::{Deforming, Features, edge_edge, vertex_face};
use impinge_testkit::ccd::QueryKind;
use impinge_testkit::generate::Rng;
use impinge_testkit::oracle::first_contact;

type Points = Vec<[f64; 3]>;

/// Surface with its vertices at the start and at the end.
struct Surface {
    faces: Vec<[u32; 3]>,
    t0: Points,
    t1: Points,
}

impl Surface {
    /// Returns faces over a few vertices, so that many vertices are shared, some faces repeat a
    /// vertex, and some are equal.
    fn random(rng: &mut Rng, faces: usize, vertices: u32, reach: i64) -> Self {
        let mut points = || -> Points {
            (0..vertices).map(|_| std::array::from_fn(|_| rng.integer(-reach, reach) as f64)).collect()
        };
        let (t0, t1) = (points(), points());
        let mut vertex = || rng.integer(0, i64::from(vertices) - 1) as u32;
        Self { faces: (0..faces).map(|_| [vertex(), vertex(), vertex()]).collect(), t0, t1 }
    }

    fn deforming(&self) -> Deforming<'_> {
        Deforming::new(&self.faces, &self.t0, &self.t1).expect("legal")
    }

    fn vertices(&self) -> Vec<u32> {
        let mut all = self.faces.concat();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn edges(&self) -> Vec<[u32; 2]> {
        let of = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
        let mut all: Vec<_> = self.faces.iter().flat_map(|&face| of(face)).filter(|[a, b]| a != b).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn at(&self, vertex: u32) -> [[f64; 3]; 2] {
        [self.t0[vertex as usize], self.t1[vertex as usize]]
    }
}

fn touch(kind: QueryKind, corners: [[[f64; 3]; 2]; 4]) -> bool {
    let [t0, t1] = [0, 1].map(|end| corners.map(|corner| corner[end]));
    first_contact(kind, &t0, &t1).is_some()
}

fn vertex_touches(of: &Surface, vertex: u32, other: &Surface, face: u32) -> bool {
    let [p, q, r] = other.faces[face as usize].map(|corner| other.at(corner));
    touch(QueryKind::VertexFace, [of.at(vertex), p, q, r])
}

fn edges_touch(of: &Surface, a: [u32; 2], other: &Surface, b: [u32; 2]) -> bool {
    touch(QueryKind::EdgeEdge, [of.at(a[0]), of.at(a[1]), other.at(b[0]), other.at(b[1])])
}

#[test]
fn every_true_pair_of_two_surfaces_is_found() {
    let mut rng = Rng::new(7);
    let (mut found, mut asked) = (0, 0);
    for _ in 0..3 {
        let (a, b) = (Surface::random(&mut rng, 4, 7, 6), Surface::random(&mut rng, 4, 7, 6));
        let mut expected = Vec::new();
        for vertex in a.vertices() {
            let faces = (0..b.faces.len() as u32).filter(|&face| vertex_touches(&a, vertex, &b, face));
            expected.extend(faces.map(|face| Features::VertexFace { vertex, face }));
        }
        for vertex in b.vertices() {
            let faces = (0..a.faces.len() as u32).filter(|&face| vertex_touches(&b, vertex, &a, face));
            expected.extend(faces.map(|face| Features::FaceVertex { face, vertex }));
        }
        for edge_a in a.edges() {
            let edges = b.edges().into_iter().filter(|&edge_b| edges_touch(&a, edge_a, &b, edge_b));
            expected.extend(edges.map(|edge_b| Features::EdgeEdge { edge_a, edge_b }));
        }
        expected.sort_unstable();
        let contacts = a.deforming().contacts(&b.deforming());
        let decided: Vec<_> = contacts.iter().map(|contact| contact.features).collect();
        assert_eq!(decided, expected);
        found += expected.len();
        asked += a.vertices().len() * b.faces.len() + b.vertices().len() * a.faces.len();
        asked += a.edges().len() * b.edges().len();
    }
    assert!(found * 20 > asked && found * 2 < asked, "{found} of {asked}");
}

#[test]
fn every_true_pair_of_one_surface_is_found() {
    let mut rng = Rng::new(8);
    let mut found = 0;
    for _ in 0..3 {
        let surface = Surface::random(&mut rng, 6, 9, 6);
        let mut expected = Vec::new();
        for vertex in surface.vertices() {
            let apart = (0..surface.faces.len() as u32).filter(|&f| !surface.faces[f as usize].contains(&vertex));
            let faces = apart.filter(|&face| vertex_touches(&surface, vertex, &surface, face));
            expected.extend(faces.map(|face| Features::VertexFace { vertex, face }));
        }
        for edge_a in surface.edges() {
            let apart =
                surface.edges().into_iter().filter(|b| edge_a < *b && !b.iter().any(|end| edge_a.contains(end)));
            let edges = apart.filter(|&edge_b| edges_touch(&surface, edge_a, &surface, edge_b));
            expected.extend(edges.map(|edge_b| Features::EdgeEdge { edge_a, edge_b }));
        }
        expected.sort_unstable();
        let contacts: Vec<_> = surface.deforming().self_contacts().iter().map(|contact| contact.features).collect();
        assert_eq!(contacts, expected);
        found += expected.len();
    }
    assert!(found > 15, "{found}");
}

/// Checks larger surfaces against single queries on all pairs.
#[test]
fn large_surfaces_have_the_contacts_of_all_their_pairs() {
    let mut rng = Rng::new(9);
    let mut short = |surface: Surface| {
        // Small faces that move little.
        let t0: Points = surface.t0.iter().map(|p| p.map(|x| x + rng.unit())).collect();
        let mut faces = surface.faces;
        for face in &mut faces {
            let near = |v: u32| (0..3).map(|k| (t0[v as usize][k] - t0[face[0] as usize][k]).abs()).sum::<f64>();
            let mut order: Vec<u32> = (0..t0.len() as u32).collect();
            order.sort_by(|&u, &v| near(u).total_cmp(&near(v)));
            (face[1], face[2]) = (order[1], order[2]);
        }
        let t1 = t0.iter().map(|p| p.map(|x| x + rng.uniform(-0.3, 0.3))).collect();
        Surface { faces, t0, t1 }
    };
    let mut seed = Rng::new(10);
    let (a, b) = (short(Surface::random(&mut seed, 300, 400, 5)), short(Surface::random(&mut seed, 300, 400, 5)));
    let corners = |ends: [[[f64; 3]; 2]; 4]| [0, 1].map(|end| ends.map(|corner| corner[end]));
    let mut expected = Vec::new();
    for edge_a in a.edges() {
        for edge_b in b.edges() {
            let [t0, t1] = corners([a.at(edge_a[0]), a.at(edge_a[1]), b.at(edge_b[0]), b.at(edge_b[1])]);
            if edge_edge(&t0, &t1).expect("in range").hit() {
                expected.push(Features::EdgeEdge { edge_a, edge_b });
            }
        }
    }
    for vertex in a.vertices() {
        for face in 0..b.faces.len() as u32 {
            let [p, q, r] = b.faces[face as usize].map(|corner| b.at(corner));
            let [t0, t1] = corners([a.at(vertex), p, q, r]);
            if vertex_face(&t0, &t1).expect("in range").hit() {
                expected.push(Features::VertexFace { vertex, face });
            }
        }
    }
    expected.sort_unstable();
    let contacts = a.deforming().contacts(&b.deforming());
    let found = contacts.iter().map(|contact| contact.features);
    let found: Vec<_> = found.filter(|features| !matches!(features, Features::FaceVertex { .. })).collect();
    assert_eq!(found, expected);
    assert!(found.len() > 40, "{}", found.len());
    assert_eq!(contacts, a.deforming().contacts(&b.deforming()));
}

#[test]
fn invalid_surfaces_are_rejected() {
    let points = [[0.0; 3]; 3];
    let mut bad = points;
    bad[1][2] = f64::INFINITY;
    let kind = |faces: &[[u32; 3]], t0: &[[f64; 3]], t1: &[[f64; 3]]| {
        Deforming::new(faces, t0, t1).expect_err("illegal").kind().clone()
    };
    assert_eq!(kind(&[[0, 1, 2]], &points, &bad), InputErrorKind::NonFinite { what: "vertex", index: 4 });
    assert_eq!(
        kind(&[[0, 1, 2], [0, 1, 2]], &points, &points[..2]),
        InputErrorKind::IndexOutOfBounds { face: 0, index: 2, len: 2 }
    );
    let empty = Deforming::new(&[], &[], &[]).expect("legal");
    assert!(empty.contacts(&empty).is_empty() && empty.self_contacts().is_empty());
}
