//! Tests of invalid files: cut off anywhere, with changed bytes, with wrong counts. Reading them
//! must not panic, and must not take more memory than a multiple of the file's size.
//!
//! There is only one test, because it measures the memory of the whole process.

mod mutants;
mod repetition;

use std::io::Write;

use impinge_files::{Format, parse, write_ply};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Maximum memory per byte of a file, in bytes. It is what a glTF node or a polygon takes at most,
/// with room for a vector that doubles.
const PER_BYTE: usize = 100;
/// Maximum memory for any file, in bytes. It is what a ZIP reader and its decompressor take.
const PER_FILE: usize = 1 << 18;

const OBJ: &str = "# cube\no a\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0 0.5 0.5 0.5\ng b\nf 1/1/1 2//2 3\nf -1 -2 \\\n-3 -4\nl 1 2\nf 1 2\n";
const OFF: &str = "COFF # c\n4 2 0\n0 0 0 1 1 1 1\n1 0 0\n1 1 0\n0 1 0.1\n4 0 1 2 3\n3 0 1 2 255 0 0\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty int z\nelement face 2\n\
    property list uchar int vertex_indices\nproperty list int float uv\nelement tristrips 1\nproperty list int int vertex_indices\n\
    end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 0\n3 0 1 2 1 0.5\n7 0 1 2 -1 1 2 3\n";
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1,2],"scale":[2,2,2]},
    {"mesh":0,"rotation":[0,0,0.6,0.8]},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]}],
    "meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":5}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,
    "componentType":5121},"values":{"bufferView":0}}},{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
    "buffers":[{"byteLength":39,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC"}]}"#;
const COLLADA: &str = r##"<COLLADA version="1.4.1"><asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
    <library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a">0 0 0 1 0 0 1 1 0 0 1 0</float_array><technique_common>
    <accessor source="#a" count="4" stride="3"/></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <polylist><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 3</vcount><p>0 1 2 3 0 1 2</p></polylist></mesh></geometry>
    </library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><rotate>0 0 1 90</rotate><instance_geometry url="#g"/>
    </node><node><instance_node url="#n"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
const MODEL: &str = r#"<model unit="inch"><resources><object id="1" name="a"><mesh><vertices><vertex x="0" y="0" z="0"/>
    <vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>
    <object id="2"><components><component objectid="1"/><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/></components></object>
    </resources><build><item objectid="2"/></build></model>"#;

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((0..100).map(|i| if i % 4 == 3 { 64 } else { i }));
    bytes
}

fn binary_ply() -> Vec<u8> {
    let mut bytes = Vec::new();
    let positions = impinge::Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    write_ply(&mut bytes, &positions, &[[0, 1, 2], [2, 1, 0]]).unwrap();
    bytes
}

fn big_endian_ply() -> Vec<u8> {
    let head = "ply\nformat binary_big_endian 1.0\nelement face 2\nproperty short a\nproperty list ushort uint vertex_index\n\
        element vertex 3\nproperty list uchar char b\nproperty short x\nproperty float y\nproperty double z\nend_header\n";
    let mut bytes = head.as_bytes().to_vec();
    for corners in [&[0_u32, 1, 2][..], &[2, 1, 0, 0]] {
        bytes.extend([0, 0, 0, corners.len() as u8]);
        bytes.extend(corners.iter().flat_map(|c| c.to_be_bytes()));
    }
    for i in 0..3_u8 {
        bytes.extend([1, 7, 0, i, 0, 0, 0, 0]);
        bytes.extend(f64::from(i).to_be_bytes());
    }
    bytes
}

fn binary_off() -> Vec<u8> {
    let mut bytes = b"COFF BINARY\n".to_vec();
    bytes.extend([2_u32, 2, 0].iter().flat_map(|i| i.to_be_bytes()));
    bytes.extend([0_f32, 1., 2., 1., 1., 1., 1., 3., 4., 5., 1., 1., 1., 1.].iter().flat_map(|x| x.to_be_bytes()));
    bytes.extend([4_u32, 0, 1, 1, 0, 3, 0, 0, 0, 3, 1, 1, 0, 0].iter().flat_map(|i| i.to_be_bytes()));
    bytes
}

/// An STL file that breaks most rules of the format, but can be read.
const LAX_STL: &str = "solid a\n# c\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1D0 0\nendloop\n\
    endfacet blah\nsolid b\nfacet normal 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop endfacet\n\0\0";
/// A PLY file with unused vertices that are not finite, and types of 64 bits.
const SCAN_PLY: &str = "ply\nformat ascii 1\nscanned by hand\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list float int64 vertex_indices\nend_header\nnan nan nan\n0 0 0\n1 0 0\ninf 0 0\n0 1 0\n3 1 2 4\n3 4 2 1\n";

fn utf16_obj() -> Vec<u8> {
    "\u{FEFF}".encode_utf16().chain(OBJ.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

fn glb() -> Vec<u8> {
    let json = GLTF.replace(r#","uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC""#, "");
    let mut binary = [0_f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    binary.extend([0, 1, 2]);
    glb_of(&json, &binary)
}

fn glb_of(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

fn package(model: &[u8]) -> Vec<u8> {
    package_of(&[("3D/3dmodel.model", model)])
}

fn package_of<T: AsRef<[u8]>>(entries: &[(&str, T)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in entries {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(content.as_ref()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Parses a file, and asserts the limit on memory and the invariants of a model. Returns whether
/// the file was read without an error.
fn check(bytes: &[u8], format: Format) -> bool {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let result = parse(bytes, format);
    let used = MEMORY.peak_usage() - before;
    assert!(used <= PER_BYTE * bytes.len() + PER_FILE, "{used} bytes for {} of {format}", bytes.len());
    let Ok(model) = result else { return false };
    let n = model.positions.len();
    assert!((0..n).all(|i| model.positions.get(i).iter().all(|x| x.is_finite())));
    assert!(model.faces.iter().flatten().all(|&i| (i as usize) < n));
    assert!(model.part_of.iter().all(|&p| (p as usize) < model.parts.len()));
    assert_eq!((model.sources.len(), model.part_of.len()), (model.faces.len(), model.faces.len()));
    true
}

/// A pseudorandom generator, SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}

/// Changes one to four places: a bit, a byte, a digit, or a piece that is removed, copied
/// elsewhere, or inserted.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(12)).min(bytes.len());
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = [0, 1, 0x7F, 0x80, 0xFF, b'-', b'\n', b'e'][random.below(8)],
            2 => bytes[at] = b'0' + random.below(10) as u8,
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            _ => drop(bytes.splice(at..at, *b"99999999")),
        }
    }
}

#[test]
fn invalid_files_are_errors_and_take_little_memory() {
    let whole: Vec<(&str, Format, Vec<u8>)> = vec![
        ("OBJ", Format::Obj, OBJ.into()),
        ("OFF", Format::Off, OFF.into()),
        ("ASCII STL", Format::Stl, STL.into()),
        ("binary STL", Format::Stl, binary_stl()),
        ("ASCII PLY", Format::Ply, PLY.into()),
        ("binary PLY", Format::Ply, binary_ply()),
        ("big-endian PLY", Format::Ply, big_endian_ply()),
        ("glTF", Format::Gltf, GLTF.into()),
        ("UTF-16 OBJ", Format::Obj, utf16_obj()),
        ("binary OFF", Format::Off, binary_off()),
        ("lax STL", Format::Stl, LAX_STL.into()),
        ("scanned PLY", Format::Ply, SCAN_PLY.into()),
        ("GLB", Format::Glb, glb()),
        ("3MF", Format::ThreeMf, package(MODEL.as_bytes())),
        ("COLLADA", Format::Collada, COLLADA.into()),
        ("gzip", Format::Obj, gzip(OBJ.as_bytes())),
    ];
    let mut random = Random(1);
    for (name, format, bytes) in &whole {
        assert!(check(bytes, *format), "{name}: {}", parse(bytes, *format).unwrap_err());
        for len in 0..bytes.len() {
            check(&bytes[..len], *format);
        }
        for at in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[at] = !flipped[at];
            check(&flipped, *format);
        }
        let tries = 4000;
        let mut loaded = 0;
        for _ in 0..tries {
            let mut mutant = bytes.clone();
            mutate(&mut mutant, &mut random);
            loaded += usize::from(check(&mutant, *format));
        }
        // The checksum of a gzip file detects all changes except those of its header.
        let min_loaded = if *name == "gzip" { 1 } else { tries / 50 };
        assert!((min_loaded..tries * 9 / 10).contains(&loaded), "{name}: {loaded} of {tries} load");
    }
    // Checksums protect compressed content, so change it before it is compressed.
    let mut loaded = 0;
    for _ in 0..4000 {
        let mut model = MODEL.as_bytes().to_vec();
        mutate(&mut model, &mut random);
        loaded += usize::from(check(&package(&model), Format::ThreeMf));
    }
    assert!((80..3600).contains(&loaded), "{loaded} models of 4000 load");
    let mut loaded = 0;
    for _ in 0..4000 {
        let mut text = COLLADA.as_bytes().to_vec();
        mutate(&mut text, &mut random);
        loaded += usize::from(check(&gzip(&text), Format::Collada));
    }
    assert!((80..3600).contains(&loaded), "{loaded} packed documents of 4000 load");
    // Read files of one format as every other format.
    for (_, _, bytes) in &whole {
        for format in Format::ALL {
            check(bytes, format);
        }
    }
    dense_files();
    mutants::mutants_take_little_memory();
    repetition::repeated_content_is_counted_before_it_is_read();
    repetition::names_and_references_are_looked_up_once();
}

/// Tests short texts that take as much memory per byte as possible.
fn dense_files() {
    let n = 20_000;
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    check(format!("{square}f{}", " 1".repeat(n)).as_bytes(), Format::Obj);
    check(format!("{square}{}", "f 1 2 3\n".repeat(n)).as_bytes(), Format::Obj);
    check(format!("{square}o {}\n{}", "x".repeat(n), "g a\nf 1 2 3\n".repeat(n)).as_bytes(), Format::Obj);
    let groups: String = (0..n).map(|i| format!("g {i}\nf 1 2 3\n")).collect();
    check(format!("{square}o {}\n{groups}", "x".repeat(300)).as_bytes(), Format::Obj);
    check("v 0 0 0\n".repeat(n).as_bytes(), Format::Obj);
    check("V nan 0 0\n".repeat(n).as_bytes(), Format::Obj);
    check(format!("{square}{}", "f 1 2 3\\\n".repeat(n)).as_bytes(), Format::Obj);
    check(format!("{square}{}", "\\\n".repeat(n)).as_bytes(), Format::Obj);
    check(format!("{square}f 1 2 3{}", "\0\n".repeat(n)).as_bytes(), Format::Obj);
    check(format!("OFF {n} 0\n{}", "nan 0 0 ".repeat(n)).as_bytes(), Format::Off);
    check(format!("solid\nfacet outer loop {}endloop endfacet", "vertex 0 0 0 ".repeat(n)).as_bytes(), Format::Stl);
    check(format!("OFF 1 {n}\n0 0 0\n{}", "3 0 0 0\n".repeat(n)).as_bytes(), Format::Off);
    let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\n";
    let faces = format!("element face {n}\nproperty list uchar uchar vertex_indices\nend_header\n0 0 0\n");
    check(format!("{head}{faces}{}", "3 0 0 0\n".repeat(n)).as_bytes(), Format::Ply);
    let binary = format!("{head}{faces}").replace("ascii", "binary_little_endian").replace("0 0 0\n", "\0\0\0");
    check(&[binary.as_bytes(), &[0; 20_000]].concat(), Format::Ply);
    check(&[binary.as_bytes(), &[3, 0, 0, 0].repeat(n)].concat(), Format::Ply);
    check(format!("{head}{}end_header\n0 0 0\n", "property char a\n".repeat(n)).as_bytes(), Format::Ply);
    let document = |rest: &str| format!(r#"{{"asset":{{"version":"2.0"}},{rest}}}"#);
    check(document(&format!(r#""nodes":[{}{{}}]"#, "{},".repeat(n))).as_bytes(), Format::Gltf);
    check(document(&format!(r#""nodes":[{{"children":[{}1]}}]"#, "1,".repeat(n))).as_bytes(), Format::Gltf);
    check(document(&format!(r#""meshes":[{}{{}}]"#, "{},".repeat(n))).as_bytes(), Format::Gltf);
    let collada = |rest: &str| format!("<COLLADA version=\"1.5.0\">{rest}</COLLADA>");
    let scene = |nodes: &str| {
        collada(&format!("<library_visual_scenes><visual_scene>{nodes}</visual_scene></library_visual_scenes>"))
    };
    assert!(check(collada(&"<a/>".repeat(n)).as_bytes(), Format::Collada));
    assert!(check(collada(&("<a>".repeat(n) + &"</a>".repeat(n))).as_bytes(), Format::Collada));
    assert!(check(
        collada(&(0..n).map(|i| format!("<a id=\"{i}\"/>")).collect::<String>()).as_bytes(),
        Format::Collada
    ));
    assert!(check(scene(&"<node/>".repeat(n)).as_bytes(), Format::Collada));
    assert!(check(
        scene(&format!("<node id=\"n\"/><node>{}</node>", "<instance_node url=\"#n\"/>".repeat(n))).as_bytes(),
        Format::Collada,
    ));
    assert!(check(
        COLLADA.replace("0 1 2 3 0 1 2<", &format!("0 1 2 3 {}<", "0 ".repeat(n))).as_bytes(),
        Format::Collada
    ));
    let triangles = COLLADA.replace("polylist", "triangles").replace("0 1 2 3 0 1 2<", &format!("{}<", "0 ".repeat(n)));
    assert!(check(triangles.as_bytes(), Format::Collada));
    assert!(check(
        triangles.replace("triangles", "tristrips").replace("0 0 0 0 ", "0 1 2 3 ").as_bytes(),
        Format::Collada
    ));
    assert!(check(COLLADA.replace("0 0 0 1 0 0", &"0 ".repeat(3 * n)).as_bytes(), Format::Collada));
    let components = "<component objectid=\"1\"/>".repeat(n);
    let model = format!(
        "<model><resources><object id=\"1\"/><object id=\"2\"><components>{components}</components></object></resources></model>"
    );
    let bytes = package(model.as_bytes());
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    assert!(parse(&bytes, Format::ThreeMf).is_ok());
    // The limit is relative to the unpacked text, which compresses better than any real model.
    assert!(MEMORY.peak_usage() - before <= PER_BYTE * model.len() + PER_FILE);
}
