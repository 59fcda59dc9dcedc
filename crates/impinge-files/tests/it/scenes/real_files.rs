//! Assemblies and buildings of the data folder.

use std::path::PathBuf;

use impinge_files::{SceneModel, SceneOptions, WarningKind, load, load_scene};

fn assemblies() -> Option<PathBuf> {
    let folder = std::env::var_os("IMPINGE_DATA").map(|folder| PathBuf::from(folder).join("assemblies"));
    if folder.is_none() {
        #[expect(clippy::print_stderr, reason = "a test that skips says so")]
        {
            eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        }
    }
    folder
}

/// Asserts that keys and names are unique, and that the parts have as many triangles as the
/// flattened file. Returns the model.
fn checked(path: PathBuf, options: &SceneOptions) -> SceneModel {
    let flat = load(&path).unwrap();
    let model = load_scene(&path, options).unwrap();
    assert_eq!(model.parts.len(), flat.parts.len());
    let triangles: usize = model.parts.iter().map(|part| model.meshes[part.mesh].faces.len()).sum();
    assert_eq!(triangles, flat.faces.len());
    let is_unique = |mut texts: Vec<&str>| {
        texts.sort_unstable();
        texts.windows(2).all(|pair| pair[0] != pair[1])
    };
    assert!(is_unique(model.parts.iter().map(|part| &*part.name).collect()));
    assert!(is_unique(model.parts.iter().map(|part| &*part.details.key).collect()));
    model
}

#[test]
fn assemblies_share_meshes_and_buildings_have_global_ids() {
    let Some(folder) = assemblies() else { return };
    let of = |name: &str| checked(folder.join(name), &SceneOptions::default());
    let counts = |model: &SceneModel| (model.parts.len(), model.meshes.len());
    let gearbox = of("cad_cycloidal_gearbox.glb");
    assert_eq!(counts(&gearbox), (72, 13));
    assert!(gearbox.parts.iter().all(|part| part.details.path == ["cycloidal"]));
    assert_eq!(counts(&of("cad_fm1_satellite.glb")), (62, 36));
    assert_eq!(counts(&of("kitchen_174parts.glb")), (174, 174));
    for (name, parts) in [("ifc_duplex", 215), ("ifc_mini_project", 2636)] {
        let plain = of(&format!("{name}.glb"));
        assert!(plain.parts.iter().all(|part| part.details.key.len() == 22 && part.details.kind.starts_with("Ifc")));
        let options = SceneOptions { names: Some(folder.join(format!("{name}.json"))), ..SceneOptions::default() };
        let named = checked(folder.join(format!("{name}.glb")), &options);
        assert_eq!(named.parts.len(), parts);
        assert!(named.warnings.iter().all(|warning| warning.kind != WarningKind::UnknownNames));
        for (part, same) in named.parts.iter().zip(&plain.parts) {
            let (a, b) = (&part.details, &same.details);
            assert_eq!((&a.key, &a.kind), (&b.key, &b.kind));
        }
    }
}
