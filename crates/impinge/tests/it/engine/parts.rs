//! Meshes over borrowed arrays: they give the same answers, and `validate` detects every flaw.

use std::ops::Range;
use std::sync::Arc;

use impinge::hierarchy::Builder;
use impinge::mesh::{Flaw, Parts};
use impinge::storage::{AlignedBytes, SharedBytes};
use impinge::{Mesh, Positions, query};
use impinge_testkit::generate::Rng;
use impinge_testkit::generate::knots::{TREFOIL, torus_knot};
use impinge_testkit::generate::solids::grid_soup;

/// Arrays of a mesh in one buffer, and the range of each.
#[derive(Clone)]
struct Stored {
    bytes: Vec<u8>,
    parts: Parts<Range<usize>>,
    is_single_precision: bool,
}

impl Stored {
    fn of(mesh: &Mesh) -> Self {
        let mut bytes = Vec::new();
        let mut place = |part: &[u8]| {
            bytes.resize(bytes.len().next_multiple_of(Mesh::PARTS_ALIGNMENT), 0);
            let start = bytes.len();
            bytes.extend(part);
            start..bytes.len()
        };
        let parts = mesh.parts();
        let parts = Parts {
            frame: place(parts.frame),
            positions: place(parts.positions),
            faces: place(parts.faces),
            nodes: place(parts.nodes),
            leaves: place(parts.leaves),
        };
        Self { bytes, parts, is_single_precision: mesh.is_single_precision() }
    }

    fn borrow(&self) -> Result<Mesh, Flaw> {
        let mut copy = AlignedBytes::zeroed(self.bytes.len());
        copy.as_mut().copy_from_slice(&self.bytes);
        let bytes: SharedBytes = Arc::new(copy);
        Mesh::borrow(&bytes, self.is_single_precision, &self.parts)
    }

    fn flaw(&self) -> Option<Flaw> {
        self.borrow().and_then(|mesh| mesh.validate()).err()
    }
}

/// Name of a part, and a change that makes it invalid.
type Change = (&'static str, fn(&mut Stored));

fn meshes() -> [Mesh; 3] {
    meshes_built(Builder::default())
}

fn meshes_built(builder: Builder) -> [Mesh; 3] {
    let soup = grid_soup(&mut Rng::new(5), 700, 9, 2);
    let knot = torus_knot(120, 30, TREFOIL);
    let single = soup.vertices.iter().map(|v| v.map(|x| x as f32)).collect();
    [
        (Positions::F32(single), soup.faces),
        (Positions::F64(knot.vertices), knot.faces),
        (Positions::F32(Vec::new()), Vec::new()),
    ]
    .map(|(positions, faces)| Mesh::with_builder(positions, faces, builder).expect("a legal mesh"))
}

#[test]
fn borrowed_meshes_answer_and_move_like_their_originals() {
    let meshes = meshes();
    for mesh in &meshes {
        assert_eq!(Stored::of(mesh).borrow().map(|borrowed| borrowed.memory()), Ok(mesh.memory()));
    }
    for mesh in &meshes {
        assert_eq!(mesh.validate(), Ok(()));
        let mut borrowed = Stored::of(mesh).borrow().expect("arrays that fit");
        assert_eq!(borrowed.validate(), Ok(()));
        assert!(borrowed.parts() == mesh.parts() && borrowed.positions() == mesh.positions());
        for other in &meshes {
            assert_eq!(query::intersecting_pairs(&borrowed, other), query::intersecting_pairs(mesh, other));
            assert_eq!(query::distance(&borrowed, other), query::distance(mesh, other));
        }
        let snapshot = borrowed.clone();
        let moved =
            Positions::F64((0..mesh.positions().len()).map(|v| mesh.positions().get(v).map(|x| x * 3.0)).collect());
        let expected = mesh.refitted(moved.clone()).expect("as many vertices");
        let aging = borrowed.refit(moved.clone()).expect("as many vertices");
        assert!((aging.ratio() - 1.0).abs() < 1e-3, "{aging:?}");
        assert!(borrowed.parts() == expected.parts() && snapshot.parts() == mesh.parts());
        drop(snapshot);
        borrowed = Stored::of(mesh).borrow().expect("arrays that fit");
        borrowed.refit(moved).expect("as many vertices");
        assert!(borrowed.parts() == expected.parts());
    }
}

#[test]
fn every_flipped_bit_of_the_hierarchy_is_detected() {
    let mut rng = Rng::new(34);
    for mesh in &meshes()[..2] {
        let stored = Stored::of(mesh);
        let spoil = |at: usize, bit: u32| {
            let mut spoiled = stored.clone();
            spoiled.bytes[at] ^= 1 << bit;
            spoiled.flaw()
        };
        let Parts { frame, nodes, leaves, faces, positions } = &stored.parts;
        for (part, range, times) in [("frame", frame, 100), ("nodes", nodes, 400), ("leaves", leaves, 400)] {
            for _ in 0..times {
                let at = rng.integer(range.start as i64, range.end as i64 - 1) as usize;
                let bit = rng.integer(0, 7) as u32;
                assert!(spoil(at, bit).is_some(), "bit {bit} of byte {} of {part} is not detected", at - range.start);
            }
        }
        // A changed vertex or face makes another mesh, for which this hierarchy is invalid. But a
        // vertex may move by less than boxes and slabs resolve, and a face may get a vertex at the
        // same place.
        for (part, range) in [("faces", faces), ("positions", positions)] {
            let mut seen = 0;
            for _ in 0..100 {
                let at = rng.integer(range.start as i64, range.end as i64 - 1) as usize;
                seen += usize::from(spoil(at, 7).is_some());
            }
            assert!(seen > 50, "{seen} of 100 changes of {part} are detected");
        }
    }
}

#[test]
fn arrays_that_do_not_fit_are_rejected() {
    let mesh = &meshes()[1];
    let stored = Stored::of(mesh);
    let flaw = |change: &dyn Fn(&mut Stored)| {
        let mut spoiled = stored.clone();
        change(&mut spoiled);
        spoiled.flaw()
    };
    let changes: [Change; 8] = [
        ("nodes", |s| s.parts.nodes.end += 1),
        ("nodes", |s| s.parts.nodes = 32..288),
        ("leaves", |s| s.parts.leaves.end = usize::MAX),
        ("leaves", |s| (s.parts.leaves.start, s.parts.leaves.end) = (64, 0)),
        ("faces", |s| s.parts.faces.start = 1),
        ("positions", |s| s.parts.positions.end -= 8),
        ("frame", |s| s.parts.frame.end += 32),
        ("frame", |s| s.parts.frame.end = s.parts.frame.start),
    ];
    for (part, change) in changes {
        assert_eq!(flaw(&change), Some(Flaw::Shape { part }), "{part}");
    }
    // Fewer whole elements, and the precision of another mesh.
    assert_eq!(flaw(&|s| s.parts.leaves.end -= 64), Some(Flaw::Tree));
    assert_eq!(flaw(&|s| s.parts.nodes.end -= 256), Some(Flaw::Tree));
    assert_eq!(flaw(&|s| s.parts.nodes.end = s.parts.nodes.start), Some(Flaw::Tree));
    assert_eq!(flaw(&|s| s.parts.faces.end -= 12), Some(Flaw::Faces));
    assert!(matches!(flaw(&|s| s.parts.positions.end -= 24 * 100), Some(Flaw::Input(_))));
    assert!(flaw(&|s| s.is_single_precision = true).is_some());
}

/// Checks faces at one place, where a duplicated face changes no box. Only the check that each face
/// occurs once detects it.
#[test]
fn a_duplicated_face_in_place_of_an_equal_one_is_detected() {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for count in [3, 8, 1_000] {
        let mesh = Mesh::new(Positions::F32(corners.clone()), vec![[0, 1, 2]; count]).expect("legal");
        let stored = Stored::of(&mesh);
        assert_eq!(stored.flaw(), None);
        let Range { start, end } = stored.parts.leaves;
        for at in [start + 4, end - 32 + 4] {
            let mut spoiled = stored.clone();
            spoiled.bytes.copy_within(at..at + 4, at + 4);
            assert_eq!(spoiled.flaw(), Some(Flaw::Faces), "{count} faces, byte {}", at - start);
        }
    }
}

/// Returns the first 8 bytes of the SHA-256 of all arrays, in hexadecimal.
fn digest(mesh: &Mesh) -> String {
    use sha2::{Digest, Sha256};
    let parts = mesh.parts();
    let mut sha = Sha256::new();
    for part in [parts.frame, parts.positions, parts.faces, parts.nodes, parts.leaves] {
        sha.update(part);
    }
    sha.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn arrays_have_the_recorded_digests_on_every_machine() {
    // If a build now produces other bits of the same layout, raise `Mesh::PARTS_VERSION` and update
    // these digests. Otherwise files of the old version would be read as new ones.
    let digests = [Builder::Morton, Builder::BinnedSah, Builder::SweepSah]
        .map(|builder| meshes_built(builder).each_ref().map(digest).join(" "));
    assert_eq!(
        (Mesh::PARTS_VERSION, digests.each_ref().map(String::as_str)),
        (
            4,
            [
                "723bcaf1c02ca11d 0f98e06502229fde ae2cc60d29de85c7",
                "1e2b2efd8dffb153 8dde264fa16f55c1 ae2cc60d29de85c7",
                "fb88410f82fd91ce d45bfa83b2712259 ae2cc60d29de85c7",
            ]
        )
    );
}
