//! Meshes of links: where they are found, their scale, their unit and their axes.

use impinge::{Pose, query};
use impinge_files::{LoadedRobot, RobotGeometry, RobotOptions};

use super::{Folder, message, robot};

/// A tetrahedron with a corner at the origin and edges of length 1, 2 and 4 along the axes.
const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn link(mesh: &str) -> String {
    robot(&[&format!("<link name='a'><collision><geometry><mesh {mesh}/></geometry></collision></link>")])
}

/// Returns the corners of the box of the first link, which is up to a millionth larger than the
/// mesh.
fn bounds(loaded: &LoadedRobot) -> [[f64; 3]; 2] {
    let placed = loaded.robot.links()[0].shape.as_ref().unwrap().at(Pose::IDENTITY).unwrap();
    placed.bounds().unwrap().map(|corner| corner.map(|x| (x * 1e5).round() / 1e5))
}

fn options(packages: &[(&str, std::path::PathBuf)]) -> RobotOptions {
    let packages = packages.iter().map(|(name, folder)| ((*name).to_owned(), folder.clone())).collect();
    RobotOptions { packages, ..RobotOptions::default() }
}

#[test]
fn meshes_are_found_by_paths_and_uris() {
    let folder = Folder::new(&[("meshes/the part.obj", TETRAHEDRON)]);
    let root = folder.path("").display().to_string();
    let root = root.trim_end_matches('/');
    for uri in [
        "meshes/the part.obj".to_owned(),
        "./meshes/the%20part.obj".to_owned(),
        format!("{root}/meshes/the part.obj"),
        format!("file://{root}/meshes/the part.obj"),
        format!("file://localhost{root}/meshes/the%20part.obj"),
        "package://known/meshes/the part.obj".to_owned(),
        "package:///known/meshes/the part.obj".to_owned(),
        "model://known/meshes/the part.obj".to_owned(),
    ] {
        std::fs::write(folder.path("robot.urdf"), link(&format!("filename='{uri}'"))).unwrap();
        let loaded = folder.load(&options(&[("known", folder.path(""))])).unwrap();
        assert!(loaded.warnings.is_empty(), "{uri}: {:?}", loaded.warnings);
        assert_eq!(bounds(&loaded)[1], [1.0, 2.0, 4.0]);
    }
}

#[test]
fn a_guessed_package_is_a_warning_and_an_ambiguous_one_an_error() {
    let text = link("filename='package://pack/meshes/part.obj'");
    let in_pack = Folder::new(&[("pack/urdf/robot.urdf", &text), ("pack/meshes/part.obj", TETRAHEDRON)]);
    let beside = Folder::new(&[("urdf/robot.urdf", &text), ("pack/meshes/part.obj", TETRAHEDRON)]);
    let renamed = Folder::new(&[("other/urdf/robot.urdf", &text), ("other/meshes/part.obj", TETRAHEDRON)]);
    for (folder, path) in [(in_pack, "pack/urdf"), (beside, "urdf"), (renamed, "other/urdf")] {
        let path = folder.path(path).join("robot.urdf");
        let loaded = impinge_files::load_robot(path, &RobotOptions::default()).unwrap();
        assert_eq!(loaded.warnings.len(), 1);
        assert!(loaded.warnings[0].message.starts_with("guessed where the package \"pack\" is"));
    }
    let two = Folder::new(&[
        ("pack/robot.urdf", &text),
        ("pack/meshes/part.obj", TETRAHEDRON),
        ("meshes/part.obj", TETRAHEDRON),
    ]);
    let error = impinge_files::load_robot(two.path("pack/robot.urdf"), &RobotOptions::default()).unwrap_err();
    let found = message(&error);
    assert!(found.starts_with("robot.urdf, line 2: link \"a\": the mesh \"package://pack/meshes/part.obj\" could be "));
    assert_eq!(found.matches("meshes/part.obj").count(), 3);
    let chosen = options(&[("pack", two.path("pack"))]);
    assert!(impinge_files::load_robot(two.path("pack/robot.urdf"), &chosen).unwrap().warnings.is_empty());
}

#[test]
fn missing_and_invalid_meshes_name_the_link() {
    for (mesh, expected) in [
        ("filename='no.obj'", "link \"a\": the mesh \"no.obj\" does not exist; tried "),
        (
            "filename='package://nowhere/no.obj'",
            "link \"a\": the package of the mesh \"package://nowhere/no.obj\" is not known",
        ),
        ("filename='broken.obj'", "link \"a\": broken.obj, line 1: "),
        ("filename='robot.urdf'", "link \"a\": robot.urdf: unsupported format .urdf"),
    ] {
        let folder = Folder::new(&[("robot.urdf", &link(mesh)), ("broken.obj", "v 1 2\n")]);
        let found = message(&folder.load(&RobotOptions::default()).unwrap_err())
            .replace(&format!("{}/", folder.path("").canonicalize().unwrap().display()), "");
        assert!(found.starts_with(&format!("robot.urdf, line 2: {expected}")), "{found}");
    }
}

#[test]
fn a_scale_of_any_sign_keeps_the_outside_outside() {
    for scale in [[1.0, 1.0, 1.0], [2.0, -1.0, 1.0], [-1.0, -0.5, 1.0], [-1.0, -1.0, -3.0]] {
        let text = link(&format!("filename='t.obj' scale='{} {} {}'", scale[0], scale[1], scale[2]));
        let loaded =
            Folder::new(&[("robot.urdf", &text), ("t.obj", TETRAHEDRON)]).load(&RobotOptions::default()).unwrap();
        let shape = loaded.robot.links()[0].shape.clone().unwrap();
        let (mesh, is_solid) = shape.as_mesh().unwrap();
        assert!(is_solid && loaded.warnings.is_empty());
        let inside = scale.map(|factor| 0.1 * factor);
        assert!(mesh.winding_number(&[inside]).unwrap()[0].lower > 0.5);
        let size = [1.0, 2.0, 4.0];
        let [min, max] = bounds(&loaded);
        for k in 0..3 {
            assert_eq!([min[k], max[k]], [(scale[k] * size[k]).min(0.0), (scale[k] * size[k]).max(0.0)]);
        }
    }
}

#[test]
fn collada_meshes_keep_their_axes_and_are_in_meters() {
    let dae = |up: &str| {
        format!(
            "<COLLADA version=\"1.4.1\"><asset><unit meter=\"0.01\"/><up_axis>{up}</up_axis></asset><library_geometries>\
            <geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\">0 0 0 100 0 0 0 200 0 0 0 400</float_array>\
            <technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\"/></technique_common></source><vertices id=\"v\">\
            <input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
            <p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>\
            <visual_scene id=\"s\"><node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>\
            <scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
        )
    };
    for up in ["X_UP", "Y_UP", "Z_UP"] {
        let folder = Folder::new(&[("robot.urdf", &link("filename='t.dae'")), ("t.dae", &dae(up))]);
        assert_eq!(bounds(&folder.load(&RobotOptions::default()).unwrap())[1], [1.0, 2.0, 4.0]);
    }
}

#[test]
fn open_meshes_are_surfaces_and_hulls_are_convex() {
    let open = TETRAHEDRON.replace("f 2 3 4\n", "");
    let folder = Folder::new(&[("robot.urdf", &link("filename='t.obj'")), ("t.obj", &open)]);
    let loaded = folder.load(&RobotOptions::default()).unwrap();
    assert!(loaded.warnings[0].message.ends_with("is open, so only its surface is checked"));
    let hull = folder.load(&RobotOptions { geometry: RobotGeometry::Hull, ..RobotOptions::default() }).unwrap();
    let inside = impinge::Shape::point([0.2; 3]).unwrap().at(Pose::IDENTITY).unwrap();
    let meets = |loaded: &LoadedRobot| {
        let shape = loaded.robot.links()[0].shape.clone().unwrap();
        query::intersects(shape.at(Pose::IDENTITY).unwrap(), &inside)
    };
    assert_eq!((meets(&loaded), meets(&hull)), (false, true));
}

#[test]
fn copies_of_a_mesh_in_many_scales_are_limited() {
    let grid = |n: usize| {
        let mut text = String::new();
        for i in 0..n * n {
            text += &format!("v {} {} 0\n", i % n, i / n);
        }
        for i in 0..n - 1 {
            for j in 0..n - 1 {
                let a = i * n + j + 1;
                text += &format!("f {} {} {} {}\n", a, a + 1, a + n + 1, a + n);
            }
        }
        text
    };
    let piece = |k: usize| {
        format!("<collision><geometry><mesh filename='t.obj' scale='1 1 {}'/></geometry></collision>", k + 1)
    };
    let pieces: String = (0..200).map(piece).collect();
    let text = robot(&[&format!("<link name='a'>{pieces}</link>")]);
    let folder = Folder::new(&[("robot.urdf", &text), ("t.obj", &grid(100))]);
    assert_eq!(folder.load(&RobotOptions::default()).unwrap_err().kind().name(), "too-many");
}
