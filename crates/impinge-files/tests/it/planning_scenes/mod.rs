//! Planning scenes of MoveIt, in YAML and in the text form.

mod mutants;

use std::{fs, path::PathBuf};

use impinge::scene::{Question, Scene};
use impinge_files::{LoadError, PlanningScene, PlanningSceneOptions, load_planning_scene};
use tempfile::TempDir;

/// A message with each kind of shape, several forms of points, an alias and frames.
const YAML: &str = "\
name: cell
robot_state:
  joint_state: {name: [a], position: [0.5]}
world:
  collision_objects:
    - header: {frame_id: base_link}
      id: table
      pose: {position: {x: 1.0, y: 0, z: 0.25}, orientation: &flat {x: 0, y: 0, z: 0, w: 1}}
      primitives:
        - {type: 1, dimensions: [1.0, 0.5, 0.5]}
        - type: cylinder
          dimensions: [0.5, 0.125]
      primitive_poses:
        - position: [0, 0, 0]
          orientation: [0, 0, 0, 1]
        - position: {z: 0.5}
          orientation: *flat
    - id: ball
      header: {frame_id: /shelf}
      primitives: [{type: sphere, dimensions: [0.25, 0, 0]}]
      primitive_poses: [{position: [0, 0, 1], orientation: [0.707, 0, 0, 0.707]}]
      operation: add
    - id: tip
      primitives: [{type: CONE, dimensions: [1, 0.5]}]
    - id: mesh
      header: {frame_id: ''}
      meshes:
        - resource: package://cell/box.obj
          dimensions: [2, 2, 2]
        - vertices: [[0, 0, 0], {x: 1}, [0, 1, 0], [0, 0, 1]]
          triangles: [{vertex_indices: [0, 2, 1]}, [0, 1, 3], [0, 3, 2], [1, 2, 3]]
      mesh_poses:
        - {position: [9, 9, 9], orientation: [0, 0, 0, 0]}
        - {position: [-9, 0, 0], orientation: [0, 0, 0, 1]}
  octomap: {octomap: {data: []}}
fixed_frame_transforms:
  - header: {frame_id: base_link}
    child_frame_id: shelf
    transform: {translation: [10, 0, 0], rotation: [0, 0, 0, 1]}
";

const BOX: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                   f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// The text form with a pose for each object, and the older one without.
const NEW_FORM: &str = "\
two objects
* left box
-1 0 0
0 0 0 1
2
box
1 1 1
0 0 0
0 0 0 1
0.5 0.5 0.5 1
cylinder
0.25 2
0 0 1
0 0 0 1
0 0 0 0
1
handle
0 0 1
0 0 0 1
* right
0 0 0
0 0 0 1
1
mesh
4 4
0 0 0
1 0 0
0 1 0
0 0 1
0 2 1
0 1 3
0 3 2
1 2 3
0 0 0
0 0 0 1
0 0 0 0
0
.
";
const OLD_FORM: &str =
    "old\n*ball\n1\nsphere\n0.5\n1 2 3\n0 0 0 1\n0 0 0 0\n*tip\n1\ncone\n0.5 1\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n";

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        fs::create_dir(folder.path("cell")).unwrap();
        fs::write(folder.path("cell/box.obj"), BOX).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Loads a text as a file of this name.
    fn load(&self, name: &str, text: impl AsRef<[u8]>) -> Result<PlanningScene, LoadError> {
        fs::write(self.path(name), text).unwrap();
        let packages = vec![("cell".to_owned(), self.path("cell"))];
        let options = PlanningSceneOptions { packages, frame: Some("base_link".to_owned()), ..Default::default() };
        load_planning_scene(self.path(name), &options)
    }
}

/// Returns the box of a part.
fn bounds(scene: &Scene, name: &str) -> [[f64; 3]; 2] {
    let part = scene.parts().find(|&part| scene.name(part) == name).unwrap();
    scene.shape(part).at(*scene.pose(part)).unwrap().bounds().unwrap()
}

#[track_caller]
fn assert_box(scene: &Scene, name: &str, expected: [[f64; 3]; 2]) {
    let found = bounds(scene, name);
    for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 1e-6, "{name}: {found} is not {expected}");
    }
}

#[test]
fn a_message_has_its_objects_in_the_frame_of_the_robot() {
    let folder = Folder::new();
    let loaded = folder.load("cell.yaml", YAML).unwrap();
    let names: Vec<&str> = loaded.scene.parts().map(|part| loaded.scene.name(part)).collect();
    assert_eq!((loaded.name.as_str(), names), ("cell", vec!["table", "ball", "tip", "mesh"]));
    assert_eq!(loaded.warnings, []);
    // A box of full lengths, with a cylinder of the height 0.5 above it.
    assert_box(&loaded.scene, "table", [[0.5, -0.25, 0.0], [1.5, 0.25, 1.0]]);
    assert_box(&loaded.scene, "ball", [[9.75, -0.25, 0.75], [10.25, 0.25, 1.25]]);
    assert_box(&loaded.scene, "tip", [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]);
    assert_box(&loaded.scene, "mesh", [[-9.0, 0.0, 0.0], [11.0, 11.0, 11.0]]);
    // Closed meshes are solids, and the tip of a cone is up.
    let mut probes = loaded.scene.clone();
    let point = impinge::Shape::sphere([0.0; 3], 1e-3).unwrap();
    for (name, at) in [("in mesh", [10.0; 3]), ("in tip", [0.0, 0.0, 0.45]), ("beside tip", [0.3, 0.0, 0.45])] {
        probes.add(name, &point, impinge::Pose::from_translation(at).unwrap()).unwrap();
    }
    let hits = probes.pairs(Question::Intersects).unwrap();
    let hits: Vec<[&str; 2]> = hits.iter().map(|pair| pair.map(|part| probes.name(part))).collect();
    assert_eq!(hits, [["tip", "in tip"], ["mesh", "in mesh"]]);
}

#[test]
fn worlds_and_lists_of_objects_are_read_too() {
    let folder = Folder::new();
    let object = "id: a\n  primitives: [{type: sphere, dimensions: [1]}]\n";
    for text in [format!("collision_objects:\n- {object}"), format!("- {object}"), format!("---\n- {object}---\n")] {
        let loaded = folder.load("world.yml", &text).unwrap();
        assert_eq!((loaded.scene.parts().len(), loaded.warnings.len()), (1, 0), "{text}");
    }
    assert_eq!(folder.load("empty.yaml", "world: {collision_objects: []}\n").unwrap().scene.parts().len(), 0);
    assert_eq!(folder.load("bare.yaml", "name: nothing\nworld: {}\n").unwrap().scene.parts().len(), 0);
    let more = folder.load("more.yaml", format!("- {object}---\n- id: b\n")).unwrap();
    assert!(more.warnings[0].to_string().ends_with("only the first document of the file is read"));
}

#[test]
fn both_text_forms_are_read() {
    let folder = Folder::new();
    let new = folder.load("new.scene", NEW_FORM).unwrap();
    assert_eq!(new.name, "two objects");
    assert_box(&new.scene, "left box", [[-1.5, -0.5, -0.5], [-0.5, 0.5, 2.0]]);
    assert_box(&new.scene, "right", [[0.0; 3], [1.0; 3]]);
    let old = folder.load("old.scene", OLD_FORM).unwrap();
    assert_box(&old.scene, "ball", [[0.5, 1.5, 2.5], [1.5, 2.5, 3.5]]);
    assert_box(&old.scene, "tip", [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]);
    // A file of YAML may have the extension as well.
    assert_eq!(folder.load("yaml.scene", YAML).unwrap().scene.parts().len(), 4);
}

#[test]
fn operations_are_applied_in_their_order() {
    let folder = Folder::new();
    let object = |id: &str, operation: &str, radius: f64, x: f64| {
        format!(
            "- {{id: {id}, operation: {operation}, pose: {{position: [{x}, 0, 0]}}, \
             primitives: [{{type: sphere, dimensions: [{radius}]}}]}}\n"
        )
    };
    let text = object("a", "0", 1.0, 0.0)
        + &object("b", "add", 1.0, 0.0)
        + &object("a", "append", 2.0, 0.0)
        + &object("a", "move", 9.0, 5.0)
        + &object("b", "\"\\x01\"", 1.0, 0.0)
        + &object("c", "add", 1.0, 0.0)
        + &object("c", "add", 3.0, 0.0);
    let loaded = folder.load("steps.yaml", text).unwrap();
    assert_eq!(loaded.scene.parts().len(), 2);
    assert_box(&loaded.scene, "a", [[3.0, -2.0, -2.0], [7.0, 2.0, 2.0]]);
    assert_box(&loaded.scene, "c", [[-3.0; 3], [3.0; 3]]);
    let warnings: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    assert!(
        warnings.len() == 1
            && warnings[0].ends_with("line 7: object \"c\" is defined again, and replaces the one before it"),
        "{warnings:?}"
    );
}

#[test]
fn frames_that_are_not_known_are_one_frame() {
    let folder = Folder::new();
    let object = |id: &str, frame: &str| {
        format!("- {{id: {id}, header: {{frame_id: {frame}}}, primitives: [{{type: box, dimensions: [1, 1, 1]}}]}}\n")
    };
    let known = folder.load("a.yaml", object("a", "base_link")).unwrap();
    assert_eq!(known.warnings, []);
    let assumed = folder.load("b.yaml", object("a", "world") + &object("b", "world")).unwrap();
    let warning = assumed.warnings[0].to_string();
    assert!(warning.ends_with("line 1: the frame \"world\" is not known, and is taken for \"base_link\""), "{warning}");
    let error = folder.load("c.yaml", object("a", "world") + &object("b", "camera")).unwrap_err().to_string();
    assert!(error.contains("c.yaml, line 2: expected the frame \"world\"") && error.contains("\"camera\""), "{error}");
}

#[test]
fn faults_name_the_line_and_the_object() {
    let folder = Folder::new();
    let object = |rest: &str| format!("world:\n  collision_objects:\n  - id: shelf\n    {rest}\n");
    for (text, expected) in [
        (
            object("primitives: [{type: box, dimensions: [1, 2]}]"),
            "line 4: expected 3 numbers as dimensions of object \"shelf\"",
        ),
        (
            object("primitives: [{type: box, dimensions: [1, 2, x]}]"),
            "line 4: expected a number in dimensions of object \"shelf\", found \"x\"",
        ),
        (object("primitives: [{type: box, dimensions: [1, 2, .nan]}]"), "line 4: expected a number in dimensions"),
        (object("primitives: [{type: box, dimensions: [1, 2, -1]}]"), "line 4: object \"shelf\": "),
        (
            object("primitives: [{type: torus, dimensions: [1, 2]}]"),
            "line 4: expected box, sphere, cylinder or cone as type",
        ),
        (object("primitives: [{type: 5, dimensions: [1, 2]}]"), "line 4: needs the prism of object \"shelf\""),
        (object("primitives: [{type: sphere}]"), "line 4: expected a primitive with dimensions of object \"shelf\""),
        (object("primitives: {type: sphere}"), "line 4: expected a list as primitives of object \"shelf\""),
        (object("pose: [1, 2, 3]"), "line 4: expected a pose with position and orientation of object \"shelf\""),
        (object("pose: {orientation: [1, 1, 0, 0]}"), "line 4: expected a valid pose"),
        (object("pose: {position: [1, 2, 1e400]}"), "line 4: expected a number in position"),
        (object("operation: burn"), "line 4: expected add, remove, append or move as operation"),
        (
            object("planes: [{coef: [0, 0, 1, 0]}]"),
            "line 4: needs the plane of object \"shelf\", which is not supported",
        ),
        (
            object("meshes: [{resource: 'file:///no/such.stl'}]"),
            "line 4: object \"shelf\": the mesh \"file:///no/such.stl\" does not exist",
        ),
        (
            object("meshes: [{resource: 'package://cell/box.obj', dimensions: [0, 1, 1]}]"),
            "line 4: object \"shelf\": a factor of the scale",
        ),
        (object("meshes: [{vertices: [[0, 0, 0]], triangles: [[0, 0, 1]]}]"), "line 4: expected indices of 1 vertices"),
        (object("meshes: [{triangles: [[0, 0, 1]]}]"), "line 4: expected a mesh with a resource"),
        (
            object("primitives: [{type: sphere, dimensions: [1]}]\n    primitive_poses: [{}, {}]"),
            "line 5: expected 1 primitive_poses",
        ),
        ("world:\n  collision_objects:\n  - primitives: []\n".to_owned(), "line 3: expected an object with an id"),
        ("world: {octomap: {octomap: {data: [1]}}, collision_objects: []}".to_owned(), "line 1: needs an octomap"),
        ("a: 1\nb: 2\n".to_owned(), "line 1: expected a planning scene"),
        ("a: [1\n".to_owned(), "expected YAML"),
    ] {
        let error = folder.load("bad.yaml", &text).unwrap_err().to_string();
        assert!(error.contains("bad.yaml, line ") && error.contains(expected), "{expected:?} is not in {error}");
    }
    for (text, expected) in [
        ("name\n* a\n1\nbox\n1 1\n0 0 0\n", "bad.scene, line 7: expected 3 numbers as position of object \"a\""),
        (
            "name\n* a\n1\nblob\n",
            "line 4: expected box, sphere, cylinder, cone or mesh as a shape of object \"a\", found \"blob\"",
        ),
        ("name\n* a\n1\nplane\n0 0 1 0\n", "line 4: needs the plane of object \"a\""),
        (
            "name\n* a\n4294967295\nsphere\n1\n0 0 0\n0 0 0 1\n0 0 0 0\n",
            "expected a shape of object \"a\", found nothing",
        ),
        ("name\n*\n.\n", "line 2: expected a name after *"),
        (
            "name\n* a\n1\nmesh\n4000000000 1\n0 0 0\n",
            "expected 3 coordinates of a vertex of object \"a\", found nothing",
        ),
    ] {
        let error = folder.load("bad.scene", text).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected:?} is not in {error}");
    }
    assert_eq!(folder.load("none.yaml", "").unwrap_err().kind().name(), "empty");
}
