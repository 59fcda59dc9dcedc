//! Tests every real file of the data folder, valid or not, against numbers that other programs
//! computed.
//!
//! Triangles, vertices, area and signed volume were computed with trimesh 4 and NumPy. Some files
//! were computed by hand or from the definition, because trimesh fails, fans a concave polygon or
//! splits vertices: the empty files, `negative_indices.obj`, `igea.ply`, `wallhole.obj`,
//! `fuze_ascii.ply` and `duck.dae`.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use impinge_files::{Model, WarningKind, load};

struct Row {
    path: &'static str,
    outcome: Result<Expected, &'static str>,
}

struct Expected {
    triangles: usize,
    vertices: usize,
    area: f64,
    volume: f64,
}

const fn loads(path: &'static str, triangles: usize, vertices: usize, area: f64, volume: f64) -> Row {
    Row { path, outcome: Ok(Expected { triangles, vertices, area, volume }) }
}

const fn fails(path: &'static str, kind: &'static str) -> Row {
    Row { path, outcome: Err(kind) }
}

/// Returns the folder of real files, if there is one.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("IMPINGE_DATA").map(PathBuf::from);
    if folder.is_none() {
        #[expect(clippy::print_stderr, reason = "a test that skips says so")]
        {
            eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        }
    }
    folder
}

fn area_and_volume(model: &Model) -> (f64, f64) {
    let (mut area, mut volume) = (0.0, 0.0);
    for face in &model.faces {
        let [a, b, c] = face.map(|i| model.positions.get(i as usize));
        let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
        let n = [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            u[i] * v[j] - u[j] * v[i]
        });
        area += n.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0;
        volume += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6.0;
    }
    (area, volume)
}

/// Reports whether two sums agree. They are sums of thousands of products of numbers that were
/// rounded to f32.
fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-6 * scale.abs() || a == b
}

#[test]
fn every_file_gives_the_expected_numbers_or_error() {
    let Some(data) = data() else { return };
    let mut wrong = Vec::new();
    for row in ROWS {
        match (load(data.join(row.path)), &row.outcome) {
            (Ok(model), Ok(expected)) => {
                let (area, volume) = area_and_volume(&model);
                let counts = (model.faces.len(), model.positions.len());
                // The terms of a volume can cancel, so the tolerance depends on the area.
                let volume_scale = expected.volume.abs().max(expected.area.powf(1.5));
                if counts != (expected.triangles, expected.vertices)
                    || !close(area, expected.area, expected.area)
                    || !close(volume, expected.volume, volume_scale)
                {
                    wrong.push(format!("{}: {counts:?} {area} {volume}", row.path));
                }
                assert_consistent(&model);
            }
            (Err(error), &Err(kind)) if error.kind().name() == kind => {}
            (Err(error), _) => wrong.push(error.to_string()),
            (Ok(_), Err(kind)) => wrong.push(format!("{}: loads, but should fail as {kind}", row.path)),
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn assert_consistent(model: &Model) {
    let n = model.faces.len();
    assert_eq!((model.sources.len(), model.part_of.len()), (n, n));
    assert!(model.faces.iter().flatten().all(|&i| (i as usize) < model.positions.len()));
    assert!(model.part_of.iter().all(|&p| (p as usize) < model.parts.len()));
    assert!(model.sources.is_sorted());
    let used: BTreeSet<_> = model.part_of.iter().collect();
    assert_eq!(used.len(), model.parts.len());
}

#[test]
fn every_file_of_the_data_folder_is_tested() {
    let Some(data) = data() else { return };
    let rows: BTreeSet<_> = ROWS.iter().map(|row| data.join(row.path)).collect();
    let mut found = Vec::new();
    for folder in ["formats", "nasty"] {
        files_below(&data.join(folder), &mut found);
    }
    assert!(found.len() > 50);
    let forgotten: Vec<_> = found.into_iter().filter(|path| !rows.contains(path)).collect();
    assert!(forgotten.is_empty(), "{forgotten:?}");
}

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// All warnings. The other files load without a warning.
const WARNINGS: &[(&str, WarningKind, u64)] = &[
    ("characters/greenman.glb", WarningKind::Unposed, 1),
    ("characters/robot.glb", WarningKind::Unposed, 14),
    ("formats/duck.dae", WarningKind::FannedPolygons, 2),
    ("formats/fuze_ascii.ply", WarningKind::SurplusValues, 1000),
    ("nasty/fcl_resources/env.obj", WarningKind::UnknownLines, 1),
    ("nasty/fcl_resources/illformated_mesh.dae", WarningKind::NotTriangles, 1),
    ("nasty/fcl_resources/rob.obj", WarningKind::UnknownLines, 1),
    ("nasty/notenoughindices.obj", WarningKind::ShortFaces, 1),
    ("robots/panda_description/meshes/visual/link5.dae", WarningKind::NotTriangles, 1),
    ("robots/panda_description/meshes/visual/link6.dae", WarningKind::NotTriangles, 1),
];

#[test]
fn files_give_exactly_the_expected_warnings() {
    let Some(data) = data() else { return };
    let mut found = Vec::new();
    for row in ROWS.iter().filter(|row| row.outcome.is_ok()) {
        let model = load(data.join(row.path)).unwrap();
        found.extend(model.warnings.iter().map(|w| (row.path, w.kind, w.count)));
    }
    found.sort_by_key(|&(path, ..)| path);
    assert_eq!(found, WARNINGS);
}

const ROWS: &[Row] = &[
    loads("formats/20mm-xyz-cube.stl", 260, 132, 2499.0248765768843, 7938.6818763348165),
    loads("formats/BoxInterleaved.glb", 12, 24, 6.0, 1.0),
    loads("formats/BoxTextured.ply", 12, 24, 6.0, 1.0),
    loads("formats/CesiumMilkTruck.glb", 3624, 3564, 64.81636676849915, 19.248854798309562),
    loads("formats/Duck.glb", 4212, 2399, 7.023517084487003, 1.195799180126876),
    fails("formats/ascii.stl.zip", "unsupported-format"),
    loads("formats/ballA.off", 3796, 1900, 605.9094132887942, 1401.105056154848),
    loads("formats/boolean.glb", 3936, 2020, 197.25150856047864, 45.923614954679806),
    loads("formats/comments.off", 12, 8, 32.00000429959734, 12.316808225085273),
    loads("formats/counterXP.3MF", 83750, 43276, 169951.38416372775, 888808.1278410441),
    loads("formats/cube.OBJ", 12, 8, 6.0, 1.0),
    loads("formats/cube.glb", 12, 8, 23.999997854234785, 7.9999999205274825),
    loads("formats/cycloidal.ply", 43368, 21384, 48.8417247325804, 1.865640753050717),
    loads("formats/duck.dae", 4212, 2108, 70254.6966394772, 1195525.2988221569),
    loads("formats/featuretype.STL", 3476, 2010, 53.82738611818216, 11.62773343119675),
    loads("formats/fuze_ascii.ply", 1000, 502, 0.04472226022256357, 0.000606688762429184),
    loads("formats/groups.obj", 2308, 1156, 144.5301516593949, 118.50400960369679),
    loads("formats/monkey.glb", 968, 1966, 12.46087636855145, 2.251802921295166),
    loads("formats/multibody.stl", 32, 20, 0.3672389511999289, 0.003697747280473593),
    loads("nasty/busted.STL", 3878, 1941, 349.2797873660162, 526.448909944363),
    loads("nasty/empty.obj", 0, 0, 0.0, 0.0),
    loads("nasty/empty.ply", 0, 0, 0.0, 0.0),
    loads("nasty/empty.stl", 0, 0, 0.0, 0.0),
    loads("nasty/leoTest1.obj", 41262, 21979, 309258.35931805696, 7786877.465051868),
    loads("nasty/nancolor.obj", 12, 8, 6.0, 1.0),
    loads("nasty/negative_indices.obj", 12, 8, 24.0, 8.0),
    loads("nasty/notenoughindices.obj", 1, 3, 250000.0, 41666666.666666664),
    loads("nasty/quadknot.obj", 2880, 1440, 112056.61209380209, 1057307.7714920354),
    loads("nasty/soup.stl", 100, 300, 14.578912785299485, -0.04861744712323862),
    loads("nasty/wallhole.obj", 66, 92, 721.4213562373097, 1066.6666666666667),
    fails("nasty/fcl_resources/config.h.in", "unsupported-format"),
    loads("nasty/fcl_resources/env.obj", 2180, 6540, 201427833.60226873, 1058313625.3633488),
    fails("nasty/fcl_resources/env.octree", "unsupported-format"),
    loads("nasty/fcl_resources/illformated_mesh.dae", 14746, 8722, 0.18191643874691626, 0.0030792037584937144),
    loads("nasty/fcl_resources/rob.obj", 216, 648, 5926624.495955137, 250507549.46799996),
    loads("nasty/fcl_resources/staircases_koroibot_hr.dae", 1276, 776, 18.816750998283126, 0.5325403333391154),
    loads("nasty/manifold_models/Cray_left.obj", 576, 292, 15702614741.512037, 1956864649950.9792),
    loads("nasty/manifold_models/Cray_right.obj", 12, 8, 1.8526732108772546e+78, 1.576079971053345e+116),
    loads("nasty/manifold_models/Generic_Twin_7081.1.t0_left.obj", 19704, 9874, 176607.5426720626, 101590.87756643444),
    loads("nasty/manifold_models/Generic_Twin_7081.1.t0_right.obj", 11656, 5830, 74058.60105985912, 43004.36805203805),
    loads("nasty/manifold_models/Generic_Twin_7863.1.t0_left.obj", 212, 110, 4372.289893348455, 2911.3786907705166),
    loads("nasty/manifold_models/Generic_Twin_7863.1.t0_right.obj", 244, 126, 11332.307775890678, 6597.31769999365),
    loads("nasty/manifold_models/Havocglass8_left.obj", 164, 84, 947192.1583506941, 2779422.2435305268),
    loads("nasty/manifold_models/Havocglass8_right.obj", 12, 8, 128354.31510262656, 348996.7626704418),
    loads("nasty/manifold_models/Offset1.obj", 4418, 2287, 1684584.1355694903, 1614716.5045547336),
    loads("nasty/manifold_models/Offset2.obj", 1116, 648, 240016.5444921016, 209026.71902484554),
    loads("nasty/manifold_models/Offset3.obj", 56, 30, 3312.8351743702437, 10803.472688795122),
    loads("nasty/manifold_models/Offset4.obj", 76, 40, 4058.7543126308647, 15240.582916271356),
    loads("nasty/manifold_models/hull-body.obj", 5460, 2736, 199029.37630036182, 3646063.6466057915),
    loads("nasty/manifold_models/hull-mask.obj", 7980, 3996, 188422.93835045502, 3299571.41434909),
    loads("nasty/manifold_models/openscad-nonmanifold-crash.obj", 1442, 717, 1276.3205686121817, 451.96015525275044),
    loads("nasty/manifold_models/self_intersectA.obj", 17160, 8582, 3.0581067594368196, 0.14795342284335009),
    loads("nasty/manifold_models/self_intersectB.obj", 17160, 8582, 3.0581418948504706, 0.14795578336022788),
    loads("meshes/human_makehuman_cc0.ply", 26756, 13380, 1.8300694968420106, 0.06527826336469122),
    loads("meshes/igea.ply", 268686, 134345, 0.023502819253836727, 0.00027852446227616623),
    loads("meshes/stanford-bunny.obj", 69451, 35947, 0.057128786060864294, 0.0007700565238985445),
    loads("assemblies/cad_cycloidal_gearbox.glb", 376520, 219070, 111953.30586093961, 160496.122110485),
    loads("assemblies/cad_fm1_satellite.glb", 103566, 104495, 485119.12313541037, 723194.0551292951),
    loads("assemblies/ifc_duplex.glb", 26348, 15034, 4578.509142626732, 26.096025469838878),
    loads("assemblies/ifc_mini_project.glb", 241016, 123994, 6055.567920616277, 337.9988203542277),
    loads("assemblies/kitchen_174parts.glb", 247265, 208353, 40718.550577434915, 20458.216353675914),
    loads("characters/greenman.glb", 356, 196, 11.983497129800714, 3.0954307582122778),
    loads("robots/panda_description/meshes/visual/finger.dae", 624, 318, 0.006791968782635402, 1.1220988342519838e-5),
    loads("robots/panda_description/meshes/visual/link5.dae", 18327, 9501, 0.1321894600983275, 0.0025279917520282798),
    loads("robots/panda_description/meshes/visual/link6.dae", 21620, 11818, 0.09984964854985731, 0.0015150264348845136),
    loads("characters/robot.glb", 3238, 7218, 48.932949821544824, 9.046583788232141),
];
