//! Small models of parts with known clashes.

use impinge::clash::{Options, Report, Side, find};
use impinge::query::batch::Execution;
use impinge::scene::{Details, Scene};
use impinge::{Mesh, Pose, Positions};
use impinge_testkit::generate::solids::cuboid;

/// A box with a name, a key, a type and a path.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) name: String,
    pub(super) key: String,
    pub(super) kind: String,
    pub(super) path: String,
    pub(super) corners: [[f64; 3]; 2],
}

pub(super) fn block(kind: &str, name: &str, min: [f64; 3], max: [f64; 3]) -> Block {
    let (kind, path) = (kind.to_owned(), "Site/Ground floor".to_owned());
    Block { name: name.to_owned(), key: format!("key-{name}"), kind, path, corners: [min, max] }
}

/// Two walls with a pipe through both, a second pipe in the first wall, a bolt inside the second
/// wall, three copies of a sign, and a shelf 5 mm from the first wall.
pub(super) fn house() -> Vec<Block> {
    vec![
        block("IfcWall", "W-1", [0.0, 0.0, 0.0], [5.0, 0.25, 3.0]),
        block("IfcWallStandardCase", "W-2", [0.0, 2.0, 0.0], [5.0, 2.25, 3.0]),
        block("IfcPipeSegment", "P-1", [1.0, -1.0, 1.0], [1.125, 4.0, 1.125]),
        block("IfcPipeSegment", "P-2", [2.0, 0.125, 1.0], [2.125, 1.0, 1.125]),
        block("IfcFastener", "B-1", [4.0, 2.0625, 1.0], [4.0625, 2.125, 1.0625]),
        block("IfcSign", "S-1", [9.0, 9.0, 9.0], [10.0, 10.0, 10.0]),
        block("IfcSign", "S-2", [9.0, 9.0, 9.0], [10.0, 10.0, 10.0]),
        block("IfcSign", "S-3", [9.0, 9.0, 9.0], [10.0, 10.0, 10.0]),
        block("IfcFurniture", "F-1", [3.0, 0.255, 0.0], [4.0, 0.5, 1.0]),
    ]
}

pub(super) fn scene_of(blocks: &[Block]) -> Scene {
    let mut scene = Scene::new();
    for Block { name, key, kind, path, corners } in blocks {
        let part = scene.add(name.clone(), &mesh(*corners), Pose::IDENTITY).unwrap();
        let path = path.split('/').map(str::to_owned).collect();
        scene.set_details(part, Details { key: key.clone(), kind: kind.clone(), path, extras: Vec::new() });
    }
    scene
}

fn mesh([low, high]: [[f64; 3]; 2]) -> Mesh {
    let solid = cuboid(low, high);
    Mesh::new(Positions::F64(solid.vertices), solid.faces).unwrap()
}

pub(super) fn side<'s>(label: &str, scene: &'s Scene) -> Side<'s> {
    Side { label: label.to_owned(), scene }
}

/// Returns the report about one scene with the label `house`.
pub(super) fn report(blocks: &[Block], options: Options<'_>) -> Report {
    let scene = scene_of(blocks);
    find(&[side("house", &scene)], options, Execution::default()).unwrap()
}

/// Returns each clash as text: its kind and the names of its parts. The texts are sorted.
pub(super) fn rows(report: &Report) -> Vec<String> {
    let row = |clash: &impinge::clash::Clash| {
        let key = |member: &impinge::clash::Member| member.key.replace("key-", "");
        format!("{} {} {}", clash.kind.name(), key(&clash.a), key(&clash.b))
    };
    let mut rows: Vec<String> = report.clashes.iter().map(row).collect();
    rows.sort();
    rows
}
