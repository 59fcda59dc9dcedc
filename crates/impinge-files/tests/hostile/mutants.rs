//! Ten thousand mutants of each format: words, numbers and binary values of the seeds of the fuzz
//! targets are replaced by hostile ones. None may panic or exceed the stated memory.

use std::fs;
use std::path::Path;

use impinge_files::{Baked, Format, parse_by_content, parse_character, parse_plan, parse_rig};
use impinge_testkit::correct_checksums;

use super::{MEMORY, PER_BYTE, PER_FILE, Random, check, glb_of, mutate, package};

/// Number of mutants of each format.
const MUTANTS: usize = 10_000;

/// Memory for content that a file repeats, in bytes: 2^20 items of up to 100 bytes. Only glTF, 3MF
/// and COLLADA can repeat content.
const REPEATED: usize = PER_BYTE << 20;

/// Words that replace words and numbers of text.
const WORDS: [&str; 32] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e309",
    "1e-320",
    "-1",
    "0",
    "99999999999999999999",
    "4294967295",
    "4294967296",
    "2147483648",
    "",
    "x",
    "1.5",
    "0x10",
    "-0",
    "3",
    "1e5",
    "\u{FF}",
    "1/2/3",
    "//",
    "+1",
    "--1",
    "1e",
    "18446744073709551615",
    "null",
    "true",
    "[]",
    "{}",
    "\"\"",
];

/// Values that replace four bytes of binary data: counts, and single-precision numbers.
const VALUES: [u32; 16] = [
    0,
    1,
    2,
    3,
    0xFF,
    0xFFFF,
    0x1_0000,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x100_0000,
    0x7F80_0000,
    0xFF80_0000,
    0x7FC0_0000,
    0x7F7F_FFFF,
    0x0000_0080,
];

/// Changes one to three words or values, and in one mutant of four also single bytes.
fn mutant(seed: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(3) {
        if bytes.len() < 4 {
            return bytes;
        }
        let at = random.below(bytes.len());
        let is_word = |byte: u8| byte.is_ascii_alphanumeric() || b"._+-".contains(&byte);
        if is_word(bytes[at]) {
            let start = bytes[..at].iter().rposition(|&byte| !is_word(byte)).map_or(0, |before| before + 1);
            let end = bytes[at..].iter().position(|&byte| !is_word(byte)).map_or(bytes.len(), |len| at + len);
            let word = WORDS[random.below(WORDS.len())];
            bytes.splice(start..end, word.bytes());
        } else {
            let at = at.min(bytes.len() - 4);
            let value = VALUES[random.below(VALUES.len())];
            let value = if random.below(2) == 0 { value.to_le_bytes() } else { value.to_be_bytes() };
            bytes[at..at + 4].copy_from_slice(&value);
        }
    }
    if random.below(4) == 0 {
        mutate(&mut bytes, random);
    }
    bytes
}

/// Returns the seeds of a fuzz target.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(target);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Number of mutants that loaded and the memory that the mutants of a format took.
#[derive(Default)]
struct Costs {
    loaded: usize,
    most: usize,
}

impl Costs {
    /// Reads a mutant, which may take `max` bytes of memory. The reader returns whether it loads.
    fn measure(&mut self, max: usize, read: impl FnOnce() -> bool) {
        let before = MEMORY.current_usage();
        MEMORY.reset_peak_usage();
        self.loaded += usize::from(read());
        let used = MEMORY.peak_usage().saturating_sub(before);
        self.most = self.most.max(used);
        assert!(used <= max, "{used} bytes of memory, more than {max}");
    }

    /// Asserts that some mutants load and some do not: otherwise the mutations
    /// are too mild or too wild to test anything.
    fn check(&self, name: &str) {
        let Self { loaded, most } = self;
        assert!(
            (MUTANTS / 100..MUTANTS * 95 / 100).contains(loaded),
            "{name}: {loaded} of {MUTANTS} load, with at most {most} bytes"
        );
    }
}

/// Splits a seed at its first zero byte into a document and binary data.
fn split(bytes: &[u8]) -> (&[u8], &[u8]) {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    (&bytes[..end], bytes.get(end + 1..).unwrap_or_default())
}

/// Returns a GLB file of a mutant: its document, which must be text, and binary data.
fn glb_of_mutant(bytes: &[u8]) -> Vec<u8> {
    let (json, binary) = split(bytes);
    glb_of(&String::from_utf8_lossy(json), binary)
}

pub(super) fn mutants_take_little_memory() {
    let mut random = Random(2);
    for (target, format) in [("obj", Format::Obj), ("off", Format::Off), ("stl", Format::Stl), ("ply", Format::Ply)] {
        let (seeds, mut costs) = (seeds(target), Costs::default());
        for at in 0..MUTANTS {
            let bytes = mutant(&seeds[at % seeds.len()], &mut random);
            costs.measure(PER_BYTE * bytes.len() + PER_FILE, || check(&bytes, format));
        }
        costs.check(target);
    }
    // Packed content is changed before it is packed, because of checksums.
    type Pack = fn(&[u8]) -> Vec<u8>;
    let with_instances: [(&str, Format, Pack); 4] = [
        ("gltf", Format::Gltf, |bytes| split(bytes).0.to_vec()),
        ("glb", Format::Glb, |bytes| if bytes.starts_with(b"glTF") { bytes.to_vec() } else { glb_of_mutant(bytes) }),
        ("collada", Format::Collada, <[u8]>::to_vec),
        ("three_mf", Format::ThreeMf, |bytes| if bytes.starts_with(b"PK") { bytes.to_vec() } else { package(bytes) }),
    ];
    for (target, format, pack) in with_instances {
        let (seeds, mut costs) = (seeds(target), Costs::default());
        for at in 0..MUTANTS {
            let bytes = pack(&mutant(&seeds[at % seeds.len()], &mut random));
            costs
                .measure(PER_BYTE * bytes.len() + PER_FILE + REPEATED, || impinge_files::parse(&bytes, format).is_ok());
            let _ = parse_by_content(&bytes);
        }
        costs.check(target);
    }
    mutants_of_rigs(&mut random);
    mutants_of_baked(&mut random);
}

fn mutants_of_rigs(random: &mut Random) {
    let (rigs, mut costs) = (seeds("rig"), Costs::default());
    for at in 0..MUTANTS {
        let bytes = glb_of_mutant(&mutant(&rigs[at % rigs.len()], random));
        costs.measure(PER_BYTE * bytes.len() + PER_FILE + REPEATED, || parse_rig(&bytes).is_ok());
    }
    costs.check("rig");
    let rig = parse_rig(&glb_of_mutant(&rigs[0])).unwrap();
    let (plans, mut costs) = (seeds("plan"), Costs::default());
    for at in 0..MUTANTS {
        let bytes = mutant(&plans[at % plans.len()], random);
        let text = String::from_utf8_lossy(&bytes);
        let max = 10 * PER_BYTE * text.len() + PER_FILE;
        costs.measure(max, || parse_plan(&text, &rig).is_ok() | parse_character(&text, &rig).is_ok());
    }
    costs.check("plan");
}

/// Mutates the bytes of a baked mesh and makes its checksums right, so that the validation of the
/// arrays is what rejects them.
fn mutants_of_baked(random: &mut Random) {
    let positions: Vec<[f32; 3]> = (0..60_u8).map(|i| [i % 5, i / 5 % 4, i / 20].map(f32::from)).collect();
    let faces: Vec<[u32; 3]> = (0..58).map(|i| [i, i + 1, i + 2]).collect();
    let provenance = impinge_files::Provenance {
        sources: (0..faces.len() as u32).collect(),
        part_of: vec![0; faces.len()],
        parts: vec!["a".into()],
        unit: None,
    };
    let mesh = impinge::Mesh::new(impinge::Positions::F32(positions), faces).unwrap();
    let mut seed = Vec::new();
    impinge_files::write_baked(&mesh, &provenance, mesh.proxies().as_ref(), &mut seed).unwrap();
    let mut costs = Costs::default();
    for _ in 0..MUTANTS {
        let mut bytes = impinge::storage::AlignedBytes::zeroed(seed.len());
        let whole = bytes.as_mut();
        whole.copy_from_slice(&seed);
        for _ in 0..=random.below(3) {
            let at = random.below(seed.len() - 3);
            match random.below(3) {
                0 => whole[at] ^= 1 << random.below(8),
                1 => whole[at & !3..][..4].copy_from_slice(&VALUES[random.below(VALUES.len())].to_le_bytes()),
                _ => whole.copy_within(at & !3..(at & !3) + 4, random.below(seed.len() - 3) & !3),
            }
        }
        correct_checksums(whole);
        let bytes = std::sync::Arc::new(bytes);
        costs.measure(PER_BYTE * seed.len() + PER_FILE, || {
            let Ok(baked) = Baked::from_bytes(bytes) else { return false };
            let Ok(mesh) = baked.mesh() else { return false };
            let _ = (baked.proxies(&mesh), impinge::query::self_intersecting_pairs(&mesh));
            true
        });
    }
    costs.check("baked");
}
