//! Shared meshes and their poses, against the same file with all instances flattened.

use impinge::scene::Question;
use impinge::{Mesh, Pose, Positions, Shape};
use impinge_files::{Format, SceneModel, SceneOptions, Unit, parse, parse_scene};

use super::{document, names, parse as parse_text, scene};

/// Asserts that the parts, at their poses, have the triangles that the flattened file has. Windings
/// differ where a pose mirrors: there the engine turns them.
fn assert_same_as_flattened(text: &str) -> SceneModel {
    let flat = parse(text.as_bytes(), Format::Gltf).unwrap();
    let model = parse_text(text, &SceneOptions::default());
    assert_eq!(model.parts.len(), flat.parts.len());
    for (number, part) in model.parts.iter().enumerate() {
        let mesh = &model.meshes[part.mesh];
        let posed = |face: &[u32; 3]| face.map(|at| part.world_from_part.apply(mesh.positions.get(at as usize)));
        let triangles: Vec<[[f64; 3]; 3]> = mesh.faces.iter().map(posed).collect();
        let of_part = flat.faces.iter().zip(&flat.part_of).filter(|(_, part)| **part as usize == number);
        let expected: Vec<[[f64; 3]; 3]> =
            of_part.map(|(face, _)| face.map(|at| flat.positions.get(at as usize))).collect();
        assert_eq!(triangles.len(), expected.len());
        for (found, [a, b, c]) in triangles.iter().zip(&expected) {
            let expected = if part.world_from_part.mirrors() { [a, c, b] } else { [a, b, c] };
            for (p, q) in found.iter().zip(expected) {
                let scale = q.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                assert!((0..3).all(|k| (p[k] - q[k]).abs() <= 1e-6 * scale), "{p:?} {q:?} of {}", part.name);
            }
        }
    }
    model
}

#[test]
fn three_instances_of_one_mesh_share_it() {
    let model = scene(
        r#"{"mesh": 0, "name": "one"}, {"mesh": 0, "name": "two", "translation": [5, 0, 0]}, {"mesh": 1},
        {"mesh": 0, "name": "two", "rotation": [0, 0, 0.6, 0.8]}"#,
    );
    assert_eq!(names(&model), ["one", "two", "b", "two (2)"]);
    assert_eq!(model.meshes.len(), 2);
    assert_eq!(model.parts.iter().map(|part| part.mesh).collect::<Vec<_>>(), [0, 0, 1, 0]);
    assert_eq!(model.meshes[0].positions.get(1), [1.0, 0.0, 0.0]);
    assert_eq!(model.parts[1].world_from_part, Pose::from_translation([5.0, 0.0, 0.0]).unwrap());
    assert_eq!((model.unit, model.origin), (Some(Unit::Meter), [0.0; 3]));
    // Polygons are counted through all meshes.
    assert_eq!((&model.meshes[0].sources[..], &model.meshes[1].sources[..]), (&[0, 1, 2, 3][..], &[4, 5, 6, 7][..]));
}

#[test]
fn parts_lie_where_the_flattened_file_has_them() {
    let nested = r#""nodes": [{"name": "a", "children": [1, 2], "translation": [10, 0, 0], "rotation": [0, 0, 0.6, 0.8]},
        {"name": "b", "children": [3], "scale": [2, 3, 0.5]}, {"mesh": 0, "matrix": [1, 0.5, 0, 0, 0, 1, 0, 0, 0.25, 0, 1, 0, 7, 0, 5, 1]},
        {"mesh": 0, "rotation": [0.5, 0.5, 0.5, 0.5], "translation": [1, 2, 3]}, {"mesh": 1, "scale": [-1, 1, 1]},
        {"name": "c", "children": [1]}], "scene": 0, "scenes": [{"nodes": [0, 4, 5]}]"#;
    let model = assert_same_as_flattened(&document(nested));
    let paths: Vec<_> = model.parts.iter().map(|part| part.details.path.join("/")).collect();
    assert_eq!((model.meshes.len(), paths), (2, vec!["a/b".into(), "a".into(), String::new(), "c/b".into()]));
    assert_eq!(model.warnings.len(), 1, "{:?}", model.warnings);
    let placed = r#""nodes": [{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0, "name": "bolt", "translation": [0, 0, 1],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}]"#;
    let model = assert_same_as_flattened(&document(placed));
    assert_eq!((model.meshes.len(), names(&model)), (1, vec!["bolt", "bolt (2)", "bolt (3)", "bolt (4)"]));
    // Instances are told apart by their places, and not by their order: x is 9, 5, 7 and 3.
    assert_eq!(super::keys(&model), ["bolt#4", "bolt#2", "bolt#3", "bolt"]);
}

#[test]
fn a_part_that_is_mirrored_keeps_its_inside() {
    // The probe is inside of the mirrored tetrahedron and does not touch it.
    let text = document(
        r#""nodes": [{"mesh": 0, "scale": [-1, 1, 1]}, {"mesh": 1, "scale": [0.1, 0.1, 0.1], "translation": [-0.25, 0.2, 0.2]}]"#,
    );
    let flat = parse(text.as_bytes(), Format::Gltf).unwrap();
    let flat = Mesh::new(flat.positions, flat.faces).unwrap();
    let probe = |shape: &Shape, at: [f64; 3]| {
        let point = Shape::sphere(at, 1e-3).unwrap();
        impinge::query::intersects(shape.at(Pose::IDENTITY).unwrap(), point.at(Pose::IDENTITY).unwrap())
    };
    assert!(
        probe(&flat.solid().into(), [-0.05, 0.05, 0.05]),
        "the reader keeps the outside of a flattened part outside"
    );
    let model = parse_text(&text, &SceneOptions::default());
    assert!(model.parts[0].world_from_part.mirrors());
    let scene = model.into_scene(|mesh| mesh.solid().into()).unwrap();
    assert_eq!(scene.pairs(Question::Penetrates).unwrap().len(), 1);
    let scene = parse_text(&text, &SceneOptions::default()).into_scene(|mesh| mesh.into()).unwrap();
    assert!(scene.pairs(Question::Intersects).unwrap().is_empty(), "the surfaces do not touch");
}

#[test]
fn a_flat_part_has_a_mesh_of_its_own() {
    let text = document(
        r#""nodes": [{"mesh": 0, "scale": [1, 1, 0], "translation": [0, 0, 2]}, {"mesh": 1}, {"mesh": 1, "scale": [0, 0, 0]}]"#,
    );
    let model = assert_same_as_flattened(&text);
    assert_eq!(model.meshes.len(), 3, "the mesh that only a flat part uses is not kept");
    assert_eq!(model.meshes[model.parts[0].mesh].positions.get(3), [0.0, 0.0, 2.0]);
    assert!(model.parts.iter().all(|part| part.world_from_part == Pose::IDENTITY));
}

#[test]
fn an_origin_far_away_keeps_micrometers() {
    // Double precision holds 3e-10 at this place, single precision half a meter.
    let far = r#""nodes": [{"children": [1], "translation": [500000, 5400000, 0]},
        {"mesh": 0, "translation": [123.000001, 456.000002, 7.000003]}, {"mesh": 1, "translation": [500000, 5400000, 0]}]"#;
    let point = [500_000.0, 5_400_000.0, 0.0];
    let origin = Some(point);
    let model = parse_text(&document(far), &SceneOptions { origin, ..SceneOptions::default() });
    assert_eq!(model.origin, point);
    let found = model.parts[0].world_from_part.translation();
    let expected = [123.000001, 456.000002, 7.000003];
    assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-8), "{found:?}");
    assert_eq!(model.parts[1].world_from_part, Pose::IDENTITY);
    // The same in a format without poses, whose text has more digits than single precision.
    let obj = "o a\nv 500123.000001 5400456.000002 7.000003\nv 500000 5400000 0\nv 500001 5400000 0\nf 1 2 3\n";
    let model = parse_scene(obj.as_bytes(), Format::Obj, &SceneOptions { origin, ..SceneOptions::default() }).unwrap();
    let found = model.meshes[0].positions.get(0);
    assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-8), "{found:?}");
    let near = "o a\nv 500000.125 5400000.25 7\nv 500000 5400000 0\nv 500001 5400000 0\nf 1 2 3\n";
    let model = parse_scene(near.as_bytes(), Format::Obj, &SceneOptions { origin, ..SceneOptions::default() }).unwrap();
    assert_eq!(model.meshes[0].positions, Positions::F32(vec![[0.125, 0.25, 7.0], [0.0; 3], [1.0, 0.0, 0.0]]));
}

#[test]
fn units_convert_meshes_and_poses() {
    let text = document(r#""nodes": [{"mesh": 0, "translation": [0.0254, 0, 0], "scale": [2, 2, 2]}]"#);
    let options =
        SceneOptions { unit: Some(Unit::Millimeter), origin: Some([0.4, 0.0, 0.0]), ..SceneOptions::default() };
    let model = parse_text(&text, &options);
    assert_eq!(model.unit, Some(Unit::Millimeter));
    let pose = &model.parts[0].world_from_part;
    assert!((pose.apply(model.meshes[0].positions.get(1))[0] - 2025.0).abs() < 1e-9);
    assert_eq!(pose.linear()[0], [2.0, 0.0, 0.0]);
}
