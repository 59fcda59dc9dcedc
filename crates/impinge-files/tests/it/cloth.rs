//! Tests a cloth that falls over a sphere, between two frames of a recorded simulation: every pair
//! of its features that touches is found. The test is skipped without the folder of data.

#![allow(clippy::print_stderr, reason = "a test that is skipped says so")]

use std::path::PathBuf;

use impinge::sweep::{Deforming, Features, edge_edge, vertex_face};

type Points = Vec<[f64; 3]>;

fn frame(number: u32) -> Option<(Points, Vec<[u32; 3]>)> {
    let Some(folder) = std::env::var_os("IMPINGE_DATA").map(PathBuf::from) else {
        eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        return None;
    };
    let model = impinge_files::load(folder.join(format!("animation/cloth_ball{number}.ply"))).expect("a PLY file");
    let positions = (0..model.positions.len()).map(|vertex| model.positions.get(vertex)).collect();
    Some((positions, model.faces))
}

/// Boxes of features over both frames, as minimum and maximum corners, each with the index of its
/// feature.
struct Boxes(Vec<([f64; 3], [f64; 3], usize)>);

impl Boxes {
    fn new<'v>(features: impl Iterator<Item = &'v [u32]>, t0: &Points, t1: &Points) -> Self {
        let mut boxes: Vec<_> = features
            .enumerate()
            .map(|(index, vertices)| {
                let points = || vertices.iter().flat_map(|&v| [t0[v as usize], t1[v as usize]]);
                let fold = |pick: fn(f64, f64) -> f64, k: usize| points().map(|p| p[k]).reduce(pick).expect("vertices");
                ([0, 1, 2].map(|k| fold(f64::min, k)), [0, 1, 2].map(|k| fold(f64::max, k)), index)
            })
            .collect();
        boxes.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        Self(boxes)
    }

    /// Visits every pair of overlapping boxes, by sorting along the first axis.
    fn overlapping(&self, other: &Self, mut visit: impl FnMut(usize, usize)) {
        let mut start = 0;
        let widest = other.0.iter().map(|b| b.1[0] - b.0[0]).fold(0.0, f64::max);
        for a in &self.0 {
            while start < other.0.len() && other.0[start].0[0] < a.0[0] - widest {
                start += 1;
            }
            for b in other.0[start..].iter().take_while(|b| b.0[0] <= a.1[0]) {
                if (0..3).all(|k| a.0[k] <= b.1[k] && b.0[k] <= a.1[k]) {
                    visit(a.2, b.2);
                }
            }
        }
    }
}

#[test]
fn every_pair_that_touches_between_two_frames_is_found() {
    let (Some((t0, faces)), Some((t1, same))) = (frame(92), frame(93)) else { return };
    assert_eq!(faces, same);
    let vertices: Vec<[u32; 1]> = (0..t0.len() as u32).map(|vertex| [vertex]).collect();
    let mut edges: Vec<[u32; 2]> =
        faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    let boxes = |features: &[&[u32]]| Boxes::new(features.iter().copied(), &t0, &t1);
    let vertex_boxes = boxes(&vertices.iter().map(|v| &v[..]).collect::<Vec<_>>());
    let edge_boxes = boxes(&edges.iter().map(|e| &e[..]).collect::<Vec<_>>());
    let face_boxes = boxes(&faces.iter().map(|f| &f[..]).collect::<Vec<_>>());
    let at = |points: &Points, corners: [u32; 4]| corners.map(|vertex| points[vertex as usize]);
    let (mut expected, mut asked) = (Vec::new(), 0);
    vertex_boxes.overlapping(&face_boxes, |vertex, face| {
        let (v, [a, b, c]) = (vertex as u32, faces[face]);
        asked += 1;
        if ![a, b, c].contains(&v) {
            let corners = [v, a, b, c];
            if vertex_face(&at(&t0, corners), &at(&t1, corners)).expect("in range").hit() {
                expected.push(Features::VertexFace { vertex: v, face: face as u32 });
            }
        }
    });
    edge_boxes.overlapping(&edge_boxes, |one, other| {
        let (edge_a, edge_b) = (edges[one], edges[other]);
        asked += 1;
        if edge_a < edge_b && !edge_b.iter().any(|end| edge_a.contains(end)) {
            let corners = [edge_a[0], edge_a[1], edge_b[0], edge_b[1]];
            if edge_edge(&at(&t0, corners), &at(&t1, corners)).expect("in range").hit() {
                expected.push(Features::EdgeEdge { edge_a, edge_b });
            }
        }
    });
    expected.sort_unstable();
    let cloth = Deforming::new(&faces, &t0, &t1).expect("legal");
    let contacts = cloth.self_contacts();
    let found: Vec<_> = contacts.iter().map(|contact| contact.features).collect();
    assert!(found == expected, "{} found, {} expected", found.len(), expected.len());
    assert!(found.len() > 1000 && found.len() < asked / 10, "{} of {asked}", found.len());
}
