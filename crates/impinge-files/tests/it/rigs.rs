//! Tests of rigged characters: two real ones, one written by hand with every kind of channel, and
//! invalid ones, whose errors name the place.

use std::path::{Path, PathBuf};

use base64::{Engine, prelude::BASE64_STANDARD};
use impinge::character::{Rig, RigErrorKind};
use impinge_files::{LoadErrorKind, load_rig, parse_rig};

fn robot() -> Rig {
    load_rig(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb")).unwrap()
}

#[test]
fn the_robot_has_its_bones_animations_and_size() {
    let rig = robot();
    assert_eq!((rig.skeleton().bones().len(), rig.animations().len()), (58, 14));
    assert_eq!(rig.skin().joints().len(), 43);
    let names: Vec<&str> = rig.animations().iter().map(|a| a.name()).collect();
    assert_eq!(names[..3], ["Robot_Dance", "Robot_Death", "Robot_Idle"]);
    assert_eq!(rig.animations()[5].span(), [0.0, 0.8333333134651184]);
    let mut vertices = Vec::new();
    for animation in 0..rig.animations().len() {
        rig.skin().skinned(&rig.pose_at(animation, 0.3).unwrap(), &mut vertices);
        assert!(vertices.iter().flatten().all(|x| x.abs() < 10.0));
    }
    // It stands on the ground and is about 4.5 meters tall.
    rig.skin().skinned(&rig.rest_pose().unwrap(), &mut vertices);
    let [low, high] = [f64::min, f64::max].map(|f| vertices.iter().map(|v| v[1]).reduce(f).unwrap());
    assert!(low.abs() < 0.05 && (4.0..5.0).contains(&high), "{low} {high}");
}

#[test]
fn the_green_man_has_its_bones_and_animations() {
    let Some(data) = std::env::var_os("IMPINGE_DATA").map(PathBuf::from) else {
        eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        return;
    };
    let rig = load_rig(data.join("characters/greenman.glb")).unwrap();
    assert_eq!((rig.skeleton().bones().len(), rig.animations().len()), (14, 4));
    assert_eq!(rig.skin().joints().len(), 12);
}

/// Bytes, with one view and one accessor for each array.
#[derive(Default)]
struct Document {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Document {
    fn floats(&mut self, shape: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(&bytes, shape, 5126, values.len() / width)
    }

    fn bytes(&mut self, shape: &str, width: usize, values: &[u8]) -> usize {
        self.add(values, shape, 5121, values.len() / width)
    }

    fn add(&mut self, bytes: &[u8], shape: &str, component: u32, count: usize) -> usize {
        let (offset, len) = (self.bytes.len(), bytes.len());
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(format!(r#"{{"buffer": 0, "byteOffset": {offset}, "byteLength": {len}}}"#));
        let view = self.views.len() - 1;
        self.accessors.push(format!(
            r#"{{"bufferView": {view}, "componentType": {component}, "count": {count}, "type": "{shape}"}}"#
        ));
        self.accessors.len() - 1
    }

    fn text(&self, rest: &str) -> String {
        let (len, base64) = (self.bytes.len(), BASE64_STANDARD.encode(&self.bytes));
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {len}, "uri": "data:;base64,{base64}"}}],
            "bufferViews": [{}], "accessors": [{}], {rest}}}"#,
            self.views.join(","),
            self.accessors.join(",")
        )
    }
}

/// The data of the arm below, each part of which a test may change.
struct Arm {
    weights: [f32; 12],
    joints: [u8; 12],
    bind: [f32; 32],
    times: [f32; 2],
    rotations: [f32; 8],
    nodes: &'static str,
    channel: &'static str,
    skin: &'static str,
}

const NODES: &str = r#"{"mesh": 0, "skin": 0, "translation": [99, 0, 0]},
    {"name": "upper", "children": [2]},
    {"name": "lower", "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, 1, 0, 0, 1]}"#;

impl Default for Arm {
    fn default() -> Self {
        let mut bind = [0.0; 32];
        for k in [0, 5, 10, 15, 16, 21, 26, 31] {
            bind[k] = 1.0;
        }
        Self {
            weights: [1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            joints: [0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0],
            bind,
            times: [0.0, 1.0],
            rotations: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0],
            nodes: NODES,
            channel: r#"{"sampler": 0, "target": {"node": 2, "path": "rotation"}}"#,
            skin: r#"{"joints": [1, 2], "inverseBindMatrices": 3}"#,
        }
    }
}

impl Arm {
    /// Parses the arm: a triangle from the shoulder to the hand over two bones, with a morph
    /// target. The lower bone rotates about z.
    fn parse(&self) -> Result<Rig, impinge_files::LoadError> {
        parse_rig(self.text().as_bytes())
    }

    fn text(&self) -> String {
        let mut document = Document::default();
        document.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
        document.bytes("VEC4", 4, &self.joints);
        document.floats("VEC4", 4, &self.weights);
        document.floats("MAT4", 16, &self.bind);
        document.floats("SCALAR", 1, &self.times);
        document.floats("VEC4", 4, &self.rotations);
        document.floats("VEC3", 3, &[0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0]);
        // A spline from 0 to 1 with slopes of zero, of two targets; the second is x².
        document.floats("SCALAR", 1, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 1.0, 1.0, 0.0, 2.0]);
        let Self { nodes, channel, skin, .. } = self;
        document.text(&format!(
            r#""nodes": [{nodes}], "skins": [{skin}],
            "meshes": [{{"weights": [0.5], "primitives": [{{"attributes": {{"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}},
                "targets": [{{"POSITION": 6}}, {{}}]}}]}}],
            "animations": [{{"name": "bend", "channels": [{channel},
                {{"sampler": 1, "target": {{"node": 0, "path": "weights"}}}},
                {{"sampler": 0, "target": {{"path": "rotation"}}}}, {{"sampler": 0, "target": {{"node": 1, "path": "pointer"}}}}],
                "samplers": [{{"input": 4, "output": 5}}, {{"input": 4, "output": 7, "interpolation": "CUBICSPLINE"}}]}}]"#
        ))
    }
}

#[test]
fn an_arm_written_by_hand_follows_bones_and_morph_targets() {
    let rig = Arm::default().parse().unwrap();
    let bones = rig.skeleton().bones();
    assert_eq!((bones[1].name.as_str(), bones[2].parent, bones[1].parent), ("upper", Some(1), None));
    // The matrix rotates by 90 degrees about z and doubles z.
    let rest = bones[2].rest;
    assert_eq!((rest.translation, rest.scale), ([1.0, 0.0, 0.0], [1.0, 1.0, 2.0]));
    assert!((rest.rotation_wxyz[0] - 0.5_f64.sqrt()).abs() < 1e-15 && rest.rotation_wxyz[0] == rest.rotation_wxyz[3]);
    assert_eq!(rig.skin().influences(1).len(), 2);

    let mut vertices = Vec::new();
    rig.skin().skinned(&rig.rest_pose().unwrap(), &mut vertices);
    // The morph target, with weight 0.5, lifts the second corner by 2. The corner follows the lower
    // bone by half, which would move it to (1 - 2, 1). The node of the mesh has no effect.
    let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
    assert!(close(vertices[0], [0.0; 3]) && close(vertices[1], [0.5 * (1.0 - 1.0), 0.5 * (2.0 + 1.0), 0.0]));
    assert!(close(vertices[2], [1.0, 1.0, 2.0]), "{vertices:?}");

    // Halfway, the morph weights are 0.5 and 0.25, and the lower bone has turned by 90 degrees.
    let pose = rig.pose_at(0, 0.5).unwrap();
    assert!((pose.morph_weights()[0] - 0.5).abs() < 1e-12 && (pose.morph_weights()[1] - 0.25).abs() < 1e-12);
    rig.skin().skinned(&pose, &mut vertices);
    assert!(close(vertices[2], [1.0, 1.0, 2.0]), "{vertices:?}");
    assert_eq!(rig.animations()[0].name(), "bend");
}

/// Returns the kind of the error of a changed arm, and the place.
fn error_of(change: impl FnOnce(&mut Arm)) -> (LoadErrorKind, String) {
    let mut arm = Arm::default();
    change(&mut arm);
    let error = arm.parse().unwrap_err();
    (error.kind().clone(), error.place().map(ToString::to_string).unwrap_or_default())
}

#[test]
fn errors_of_invalid_rigs_name_the_place() {
    let rig = |kind| LoadErrorKind::BrokenRig { kind };
    let (kind, place) = error_of(|arm| arm.weights[5] = 0.25);
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::WeightSum { sum: 0.75 }), "accessor 2, vertex 1"));
    let (kind, place) = error_of(|arm| arm.weights[4] = f32::NAN);
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::NonFinite { what: "weight" }), "accessor 2, vertex 1"));
    let (kind, place) = error_of(|arm| (arm.weights[4], arm.weights[5]) = (1.5, -0.5));
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::NegativeWeight), "accessor 2, vertex 1"));
    let (kind, place) = error_of(|arm| arm.joints[5] = 9);
    let missing = RigErrorKind::Missing { what: "joint", index: 9, len: 2 };
    assert_eq!((kind, place.as_str()), (rig(missing), "accessor 2, vertex 1"));
    let (kind, place) = error_of(|arm| arm.bind[20] = f32::INFINITY);
    let bind = RigErrorKind::NonFinite { what: "inverse bind matrix" };
    assert_eq!((kind, place.as_str()), (rig(bind), "skin 0, joint 1"));
    let (kind, place) = error_of(|arm| arm.rotations[5] = f32::NAN);
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::NonFinite { what: "key" }), "accessor 5, key 1"));
    let (kind, place) = error_of(|arm| arm.rotations = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::ZeroRotation), "accessor 5, key 1"));
    let (kind, place) = error_of(|arm| arm.times[1] = f32::NAN);
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::NonFinite { what: "time" }), "accessor 4, key 1"));
    let (kind, place) = error_of(|arm| arm.times[1] = -1.0);
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::TimesNotIncreasing), "accessor 4, key 1"));
    let (kind, place) = error_of(|arm| {
        arm.nodes = r#"{"mesh": 0, "skin": 0}, {"children": [2]}, {"scale": [1, 0, 1]}"#;
    });
    assert_eq!((kind, place.as_str()), (rig(RigErrorKind::ZeroScale), "node 2"));
    let (kind, place) = error_of(|arm| arm.nodes = r#"{"mesh": 0, "skin": 0}, {"children": [2]}, {"children": [1]}"#);
    assert_eq!(kind, rig(RigErrorKind::Cyclic));
    assert!(place == "node 1" || place == "node 2", "{place}");
}

#[test]
fn errors_of_missing_entries_name_the_place() {
    let (kind, place) = error_of(|arm| arm.skin = r#"{"joints": [1, 7], "inverseBindMatrices": 3}"#);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "skin 0 of node 0"));
    let (kind, place) = error_of(|arm| arm.skin = r#"{"joints": [1, 2, 2], "inverseBindMatrices": 3}"#);
    assert_eq!((kind.name(), place.as_str()), ("truncated", "skin 0 of node 0"));
    let (kind, place) = error_of(|arm| arm.nodes = r#"{"mesh": 0, "skin": 3}, {}, {}"#);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "skin 3 of node 0"));
    let (kind, place) = error_of(|arm| arm.channel = r#"{"sampler": 5, "target": {"node": 2, "path": "rotation"}}"#);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "animation 0, channel 0"));
    let (kind, place) = error_of(|arm| arm.channel = r#"{"sampler": 0, "target": {"node": 9, "path": "rotation"}}"#);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "animation 0, channel 0"));
    let (kind, place) = error_of(|arm| arm.channel = r#"{"sampler": 0, "target": {"node": 2, "path": "scale"}}"#);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "accessor 5"));
    let sheared = r#"{"mesh": 0, "skin": 0}, {}, {"matrix": [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}"#;
    let (kind, place) = error_of(|arm| arm.nodes = sheared);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "node 2"));
    let (kind, place) = error_of(|arm| arm.nodes = r#"{"mesh": 0, "skin": 0, "children": [2]}, {"children": [2]}, {}"#);
    assert_eq!((kind.name(), place.as_str()), ("syntax", "node 2"));
    assert_eq!(parse_rig(b"").unwrap_err().kind().name(), "empty");
    assert_eq!(parse_rig(b"solid cube\nendsolid").unwrap_err().kind().name(), "unsupported-feature");
}

#[test]
fn cut_off_and_flipped_files_never_panic() {
    let text = Arm::default().text();
    for end in (0..text.len()).step_by(7) {
        assert!(parse_rig(&text.as_bytes()[..end]).is_err());
    }
    let mut outcomes = [0; 2];
    for at in (0..text.len()).step_by(5) {
        let mut bytes = text.clone().into_bytes();
        bytes[at] ^= 1 << (at % 7);
        outcomes[usize::from(parse_rig(&bytes).is_ok())] += 1;
    }
    assert!(outcomes.iter().all(|&count| count > 10), "{outcomes:?}");
}

/// A file that refers to the same data many times is an error.
#[test]
fn repeated_references_to_the_same_data_are_limited() {
    let mut document = Document::default();
    document.floats("VEC3", 3, &vec![0.5; 3 * 3000]);
    let targets = vec![r#"{"POSITION": 0}"#; 20_000].join(",");
    let text = document.text(&format!(
        r#""nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "targets": [{targets}]}}]}}]"#
    ));
    let error = parse_rig(text.as_bytes()).unwrap_err();
    assert_eq!(error.kind().name(), "too-many", "{error}");
}
