//! Tests of baked files: they round-trip, and corrupt files are rejected or harmless.

use std::{fs, path::PathBuf, sync::Arc};

use impinge::{
    Mesh, Positions,
    hull::Hull,
    query,
    storage::AlignedBytes,
    volume::{BoundingVolume, Proxies},
};
use impinge_files::{Baked, Format, LoadErrorKind, Provenance, Unit, write_baked};
use impinge_testkit::correct_checksums;
use tempfile::TempDir;

/// A small pseudorandom generator, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// Returns a hilly surface with n quads along each side.
fn hills(n: u32, height: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let vertices = (0..=n).flat_map(|y| {
        (0..=n).map(move |x| [f64::from(x), f64::from(y), height * f64::from((x * x + 3 * x * y + y) % 7)])
    });
    let quads = (0..n).flat_map(|y| (0..n).map(move |x| y * (n + 1) + x));
    let faces = quads.flat_map(|a| [[a, a + 1, a + n + 1], [a + n + 2, a + n + 1, a + 1]]);
    (vertices.collect(), faces.collect())
}

fn mesh(height: f64) -> Mesh {
    let (vertices, faces) = hills(9, height);
    Mesh::new(Positions::F64(vertices), faces).expect("a legal mesh")
}

fn provenance(faces: usize) -> Provenance {
    Provenance {
        sources: (0..faces as u32).map(|face| face / 2).collect(),
        part_of: (0..faces as u32).map(|face| u32::from(face > 20)).collect(),
        parts: vec!["rim".to_owned(), String::new()],
        unit: Some(Unit::Inch),
    }
}

fn bytes_of(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_baked(mesh, &provenance(mesh.faces().len()), None, &mut bytes).expect("room");
    bytes
}

fn bytes_with_proxies(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    let proxies = mesh.proxies();
    write_baked(mesh, &provenance(mesh.faces().len()), proxies.as_ref(), &mut bytes).expect("room");
    bytes
}

/// Offset of the end of the table of sections, in bytes.
const HEADER: usize = 64 + 9 * 24;

/// A temporary file.
struct File(TempDir);

impl File {
    fn new() -> Self {
        Self(TempDir::new().expect("a folder"))
    }

    fn write(&self, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join("mesh.impinge");
        // Create a new file, because the last one may still be mapped.
        let _ = fs::remove_file(&path);
        fs::write(&path, bytes).expect("room");
        path
    }
}

#[test]
fn baked_meshes_round_trip() {
    let file = File::new();
    let other = mesh(0.25);
    // Meshes in double precision, in single precision, and without faces.
    let empty = Mesh::new(Positions::F32(Vec::new()), Vec::new()).expect("a legal mesh");
    for original in [mesh(0.1), mesh(0.5), empty] {
        let path = file.write(&bytes_of(&original));
        let baked = Baked::open(&path).expect("a baked file");
        for opened in [baked.mesh().expect("a mesh"), baked.trusted_mesh().expect("a mesh")] {
            assert!(opened.parts() == original.parts() && opened.positions() == original.positions());
            assert_eq!(query::intersecting_pairs(&opened, &other), query::intersecting_pairs(&original, &other));
        }
        assert_eq!(baked.provenance(), Ok(provenance(original.faces().len())));
        // The mesh outlives the file and the value that opened it.
        let opened = baked.mesh().expect("a mesh");
        drop(baked);
        fs::remove_file(&path).expect("it is there");
        assert_eq!(query::intersecting_pairs(&opened, &other), query::intersecting_pairs(&original, &other));
        // Baking it again gives the same bytes.
        assert_eq!(bytes_of(&opened), bytes_of(&original));
    }
}

/// Asserts that all proxies contain the mesh, and that the hull is that of the vertices that faces
/// use.
fn assert_valid(proxies: &Proxies, mesh: &Mesh) {
    let corners: Vec<[f64; 3]> =
        mesh.faces().as_flattened().iter().map(|&vertex| mesh.positions().get(vertex as usize)).collect();
    let sorted = |positions: &[[f64; 3]]| {
        let mut positions = positions.to_vec();
        positions.sort_by(|a, b| a.partial_cmp(b).expect("no NaN"));
        positions
    };
    let expected = Hull::new(&corners).expect("in range");
    assert_eq!(sorted(proxies.hull().positions()), sorted(expected.positions()));
    for point in corners {
        let holds = [
            proxies.hull().contains(point),
            proxies.bounds().contains(point),
            proxies.sphere().contains(point),
            proxies.capsule().contains(point),
            proxies.lozenge().contains(point),
            proxies.obb().contains(point),
            proxies.kdop14().contains(point),
            proxies.kdop18().contains(point),
            proxies.kdop26().contains(point),
        ];
        assert_eq!(holds, [true; 9], "{point:?}");
    }
}

#[test]
fn baked_proxies_round_trip() {
    let file = File::new();
    let flap =
        |corners: [[f64; 3]; 3]| Mesh::new(Positions::F64(corners.to_vec()), vec![[0, 1, 2]]).expect("a legal mesh");
    let triangle = flap([[0.1, 0.0, 0.0], [1.0, 0.0, 0.3], [0.0, 1.0, 0.0]]);
    let collinear = flap([[0.0; 3], [0.25; 3], [1.0; 3]]);
    let point = flap([[0.7; 3]; 3]);
    // Meshes in single and in double precision, a flat one, one with an unused vertex far away, a
    // line, and a point.
    for original in [mesh(0.5), mesh(0.1), mesh(0.0), triangle, collinear, point] {
        let bytes = bytes_with_proxies(&original);
        let baked = Baked::open(file.write(&bytes)).expect("a baked file");
        let opened = baked.mesh().expect("a mesh");
        let (validated, trusted) =
            (baked.proxies(&opened).expect("validated"), baked.trusted_proxies(&opened).expect("read"));
        let made = original.proxies().expect("faces").to_bytes();
        for proxies in [validated.expect("there"), trusted.expect("there")] {
            assert_valid(&proxies, &original);
            assert_eq!(proxies.to_bytes(), made);
        }
        assert!(baked.has_proxies() && bytes_with_proxies(&opened) == bytes);
        // They are not valid for another mesh.
        let other = mesh(0.25);
        assert_eq!(baked.proxies(&other).map(drop).map_err(|e| e.kind().name()), Err("corrupt"));
    }
    let empty = Mesh::new(Positions::F32(Vec::new()), Vec::new()).expect("a legal mesh");
    for (mesh, bytes) in [(mesh(0.1), bytes_of(&mesh(0.1))), (empty.clone(), bytes_with_proxies(&empty))] {
        let baked = Baked::open(file.write(&bytes)).expect("a baked file");
        assert!(!baked.has_proxies());
        assert!(baked.proxies(&mesh).expect("none").is_none() && baked.trusted_proxies(&mesh).expect("none").is_none());
    }
}

#[test]
fn aligned_bytes_in_memory_are_opened_like_a_file() {
    let original = mesh(0.1);
    let written = bytes_of(&original);
    let mut copy = AlignedBytes::zeroed(written.len());
    copy.as_mut().copy_from_slice(&written);
    let opened = Baked::from_bytes(Arc::new(copy)).and_then(|baked| baked.mesh()).expect("a mesh");
    assert!(opened.parts() == original.parts());
    // Bytes that are shifted by one are not aligned.
    struct Shifted(AlignedBytes);
    impl AsRef<[u8]> for Shifted {
        fn as_ref(&self) -> &[u8] {
            &self.0.as_ref()[1..]
        }
    }
    let mut shifted = AlignedBytes::zeroed(written.len() + 1);
    shifted.as_mut()[1..].copy_from_slice(&written);
    let baked = Baked::from_bytes(Arc::new(Shifted(shifted))).expect("its header is read byte by byte");
    assert_eq!(baked.mesh().map(|_| ()).map_err(|e| e.kind().name()), Err("corrupt"));
    assert!(Baked::from_bytes(Arc::new(written[..100].to_vec())).is_err());
}

#[test]
fn load_and_parse_read_the_triangles_of_a_baked_file() {
    let file = File::new();
    let original = mesh(0.1);
    let bytes = bytes_of(&original);
    for model in [impinge_files::load(file.write(&bytes)), impinge_files::parse(&bytes, Format::Obj)] {
        let model = model.expect("a model");
        assert_eq!((&model.positions, &model.faces[..]), (original.positions(), original.faces()));
        let Provenance { sources, part_of, parts, unit } = provenance(original.faces().len());
        assert_eq!((model.sources, model.part_of, model.parts, model.unit), (sources, part_of, parts, unit));
        assert_eq!(model.format, Format::Baked);
    }
}

#[test]
fn files_that_are_not_baked_are_errors() {
    let file = File::new();
    let whole = bytes_of(&mesh(0.1));
    let kind = |bytes: &[u8]| Baked::open(file.write(bytes)).map(|_| ()).map_err(|e| e.kind().name());
    assert_eq!(kind(&whole), Ok(()));
    assert_eq!(kind(&[]), Err("truncated"));
    assert_eq!(kind(&whole[..100]), Err("truncated"));
    assert_eq!(kind(&whole[..whole.len() - 1]), Err("truncated"));
    assert_eq!(kind(&[&whole[..], &[0]].concat()), Err("truncated"));
    assert_eq!(kind(&[b"o cube\n".as_slice(), &whole].concat()), Err("syntax"));
    let with = |at: usize, bytes: &[u8]| {
        let mut changed = whole.clone();
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        kind(&changed)
    };
    assert_eq!(with(8, &[1, 2, 3, 4]), Err("unsupported-feature"), "the opposite byte order");
    assert_eq!(with(12, &[1]), Err("unsupported-feature"), "an earlier version");
    assert_eq!(with(12, &[3]), Err("unsupported-feature"), "a later version");
    assert_eq!(with(16, &[0]), Err("unsupported-feature"), "earlier arrays");
    assert_eq!(with(24, &[2]), Err("corrupt"), "a unit that does not match the checksum");
    let missing = Baked::open(file.0.path().join("none.impinge")).map(|_| ()).map_err(|e| e.kind().clone());
    assert!(matches!(missing, Err(LoadErrorKind::Io { .. })), "{missing:?}");
    let incomplete = Provenance { sources: vec![0], ..provenance(162) };
    assert!(write_baked(&mesh(0.1), &incomplete, None, &mut Vec::new()).is_err());
}

#[test]
fn thousands_of_corrupted_copies_are_rejected_or_harmless() {
    let file = File::new();
    let (original, other) = (mesh(0.1), mesh(0.25));
    let files = [bytes_of(&original), bytes_with_proxies(&original)];
    let expected = query::intersecting_pairs(&original, &other);
    assert!(expected.len() > 30, "{}", expected.len());
    let mut random = Random(34);
    let (mut refused, mut harmless, mut in_the_arrays) = (0, 0, 0);
    let (mut refused_proxies, mut harmless_proxies) = (0, 0);
    for copy in 0..3_000 {
        let whole = &files[copy % 2];
        let proxies_at = u64::from_le_bytes(whole[HEADER - 16..HEADER - 8].try_into().expect("eight")) as usize;
        let mut bytes = whole.clone();
        for _ in 0..1 + random.below(3) {
            let at = match copy % 4 {
                // Change only the header.
                0 => random.below(HEADER),
                1 if proxies_at < whole.len() => proxies_at + random.below(whole.len() - proxies_at),
                _ => random.below(bytes.len()),
            };
            match random.below(4) {
                0 => bytes[at] ^= 1 << random.below(8),
                1 => bytes[at] = random.below(256) as u8,
                2 => {
                    // A word that may be an index, a count or a float.
                    let words = [0_u32, 1, u32::MAX, 1 << 31, 0x7f80_0000, 0x7fc0_0000, 8, 162];
                    let at = at.min(bytes.len() - 4) & !3;
                    bytes[at..at + 4].copy_from_slice(&words[random.below(words.len())].to_le_bytes());
                }
                _ => {
                    let (from, length) = (random.below(bytes.len() - 64), 1 + random.below(64));
                    let at = at.min(bytes.len() - length);
                    bytes.copy_within(from..from + length, at);
                }
            }
        }
        if copy % 3 > 0 {
            correct_checksums(&mut bytes);
        }
        let path = file.write(&bytes);
        // The triangles alone are valid, if they can be read.
        if let Ok(model) = impinge_files::load(&path) {
            let _ = Mesh::new(model.positions, model.faces);
        }
        let Ok(baked) = Baked::open(&path) else {
            refused += 1;
            continue;
        };
        let _ = baked.provenance();
        // Without validation an answer may be wrong, but there is one.
        if let Ok(Some(proxies)) = baked.trusted_mesh().and_then(|mesh| baked.trusted_proxies(&mesh)) {
            let vertex = proxies.hull().support_from([1.0, -0.5, 2.0], 0);
            assert!((vertex as usize) < proxies.hull().positions().len(), "copy {copy}");
        }
        match baked.mesh() {
            Err(_) => {
                refused += 1;
                in_the_arrays += 1;
            }
            // A mesh that was validated gives correct answers.
            Ok(mesh) => {
                harmless += 1;
                let rebuilt = Mesh::new(mesh.positions().clone(), mesh.faces().to_vec()).expect("a valid mesh");
                let found = query::intersecting_pairs(&mesh, &other);
                assert_eq!(found, query::intersecting_pairs(&rebuilt, &other), "copy {copy}");
                match baked.proxies(&mesh) {
                    Ok(Some(proxies)) => {
                        harmless_proxies += 1;
                        assert_valid(&proxies, &mesh);
                    }
                    Ok(None) => assert!(!baked.has_proxies()),
                    Err(_) => refused_proxies += 1,
                }
                if bytes[HEADER..] == whole[HEADER..] || copy % 3 == 0 {
                    assert_eq!(found, expected, "copy {copy}");
                }
            }
        }
    }
    assert!(
        refused > 1500 && in_the_arrays > 500 && harmless > 100,
        "{refused} refused ({in_the_arrays}), {harmless} harmless"
    );
    assert!(
        refused_proxies > 100 && harmless_proxies > 30,
        "of proxies of sound meshes {refused_proxies} refused, {harmless_proxies} harmless"
    );
}
