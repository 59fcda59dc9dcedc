//! The scenes of a search: their labels, their files, one unit and one origin.

use std::path::{Path, PathBuf};

use impinge::scene::Scene;
use impinge_files::{Format, Repaired, SceneAbout, SceneOptions, Unit, bounds_of, load_scene};
use rayon::prelude::*;

use super::Arguments;
use crate::console;
use crate::failure::Failure;

/// A loaded scene.
pub(super) struct Loaded {
    pub(super) label: String,
    pub(super) scene: Scene,
    /// Unit of the scene, which all scenes share; `None` if it is not known.
    pub(super) unit: Option<Unit>,
    pub(super) path: PathBuf,
    /// Whether the file is glTF, in which Y points up.
    pub(super) is_gltf: bool,
    origin: [f64; 3],
    warnings: Vec<String>,
    /// Changes of `--repair`.
    repaired: Option<Repaired>,
}

/// Extensions of files that have to be converted first, and the command that does it.
const CONVERTIBLE: [&str; 4] = ["ifc", "ifczip", "step", "stp"];

/// Extensions of files that options write, with the option. A path after a space is a scene.
const OUTPUTS: [(&str, &str); 4] = [("json", "--json="), ("csv", "--csv "), ("html", "--view "), ("bcfzip", "--bcf ")];

/// Splits `LABEL=SCENE`. Without a label, the label is the name of the file without its extension.
pub(super) fn split(argument: &str) -> (String, PathBuf) {
    let labeled = argument.split_once('=').filter(|(label, path)| {
        let is_label = !label.is_empty() && !path.is_empty() && !label.contains(['/', '\\']);
        is_label && !Path::new(argument).exists()
    });
    match labeled {
        Some((label, path)) => (label.to_owned(), path.into()),
        None => {
            let stem = Path::new(argument).file_stem().unwrap_or_default().to_string_lossy();
            // A compressed file has two extensions.
            let stem = if argument.to_lowercase().ends_with(".gz") {
                Path::new(&*stem).file_stem().unwrap_or_default().to_string_lossy().into_owned()
            } else {
                stem.into_owned()
            };
            (stem, argument.into())
        }
    }
}

/// Loads all scenes. If they state different units, all are converted to the finest. With
/// `--shift`, the middle of all scenes becomes the origin.
///
/// # Errors
/// Returns an error if a file cannot be read, or a label of `--names` is unknown.
pub(super) fn load(arguments: &Arguments) -> Result<Vec<Loaded>, Failure> {
    let files: Vec<(String, PathBuf)> = arguments.scenes.iter().map(|argument| split(argument)).collect();
    let names = names(arguments, &files)?;
    let load_all = |unit: Option<Unit>, origin: Option<[f64; 3]>| -> Result<Vec<Loaded>, Failure> {
        let load = |((label, path), names): (&(String, PathBuf), &Option<PathBuf>)| {
            let file_unit = arguments.file_unit;
            let options = SceneOptions { unit, file_unit, origin, names: names.clone(), ..SceneOptions::default() };
            load_one(label, path, &options)
        };
        files.par_iter().zip(&names).map(load).collect::<Vec<_>>().into_iter().collect()
    };
    let mut loaded = load_all(arguments.unit, None)?;
    let mut units: Vec<Unit> = loaded.iter().filter_map(|scene| scene.unit).collect();
    units.sort_unstable();
    units.dedup();
    let unit = arguments.unit.or(units.first().copied());
    // A scene without a unit is taken to be in the unit of the others.
    if units.len() > 1 || (unit.is_some() && loaded.iter().any(|scene| scene.unit.is_none())) {
        if let Some(unit) = unit {
            console::note(&format!("not all scenes are in {unit}: all lengths are converted to {unit}"));
        }
        loaded = load_all(unit, None)?;
    }
    if arguments.shift {
        loaded = load_all(unit, Some(middle(&loaded)))?;
    }
    for scene in loaded.iter_mut().filter(|_| arguments.repair) {
        scene.repaired = Some(Repaired::of(&scene.scene.repair()));
    }
    for scene in &loaded {
        for warning in &scene.warnings {
            console::warn(&format!("{}: {warning}", scene.path.display()));
        }
    }
    Ok(loaded)
}

fn load_one(label: &str, path: &Path, options: &SceneOptions) -> Result<Loaded, Failure> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if CONVERTIBLE.contains(&extension.as_str()) {
        let glb = path.with_extension("glb");
        return Err(Failure::new(
            "unsupported-format",
            format!("a .{extension} file has to be converted to glTF first"),
        )
        .in_file(path)
        .hint(format!("run: python -m impinge.convert {} -o {}", path.display(), glb.display())));
    }
    if let Some((_, option)) = OUTPUTS.iter().find(|(written, _)| *written == extension) {
        let failure = Failure::new("unsupported-format", format!("a .{extension} file is not a scene")).in_file(path);
        return Err(failure.hint(format!("to write it, add {option}{}", path.display())));
    }
    let model = load_scene(path, options)?;
    let warnings = model.warnings.iter().map(ToString::to_string).collect();
    let (unit, origin) = (model.unit, model.origin);
    let is_gltf = matches!(model.format, Format::Gltf | Format::Glb);
    let scene = model.into_scene(|mesh| mesh.solid().into()).map_err(|error| Failure::from(error).in_file(path))?;
    Ok(Loaded {
        label: label.to_owned(),
        scene,
        unit,
        path: path.to_owned(),
        is_gltf,
        origin,
        warnings,
        repaired: None,
    })
}

/// Returns the file of names of each scene: that with its label, or else that without a label.
fn names(arguments: &Arguments, files: &[(String, PathBuf)]) -> Result<Vec<Option<PathBuf>>, Failure> {
    let mut names = vec![None; files.len()];
    let stated: Vec<(Option<&str>, &str)> = arguments
        .names
        .iter()
        .map(|argument| match argument.split_once('=') {
            Some((label, path)) if files.iter().any(|(known, _)| known == label) => (Some(label), path),
            _ => (None, argument.as_str()),
        })
        .collect();
    for (label, path) in
        stated.iter().filter(|(label, _)| label.is_none()).chain(stated.iter().filter(|(label, _)| label.is_some()))
    {
        for (names, _) in names.iter_mut().zip(files).filter(|(_, (known, _))| label.is_none_or(|label| label == known))
        {
            *names = Some(PathBuf::from(path));
        }
    }
    if let Some(path) = names.iter().flatten().find(|path| !path.exists()) {
        let hint = "write LABEL=N.json with the label of a scene, or N.json for all scenes";
        return Err(Failure::new("io", "the file of names does not exist").in_file(path).at("--names").hint(hint));
    }
    Ok(names)
}

/// Returns the middle of all scenes, in whole units.
fn middle(loaded: &[Loaded]) -> [f64; 3] {
    let boxes: Vec<[[f64; 3]; 2]> = loaded.iter().filter_map(|scene| bounds_of(&scene.scene)).collect();
    std::array::from_fn(|k| {
        let low = boxes.iter().map(|[min, _]| min[k]).fold(f64::INFINITY, f64::min);
        let high = boxes.iter().map(|[_, max]| max[k]).fold(f64::NEG_INFINITY, f64::max);
        if low <= high { (0.5 * low + 0.5 * high).round() } else { 0.0 }
    })
}

impl Loaded {
    /// Returns what the report states about the scene.
    pub(super) fn about(&self) -> SceneAbout {
        SceneAbout {
            file: Some(self.path.display().to_string()),
            unit: self.unit.map(Unit::symbol),
            origin: Some(self.origin).filter(|origin| *origin != [0.0; 3]),
            warnings: self.warnings.clone(),
            repaired: self.repaired,
            ..SceneAbout::new(self.label.clone(), &self.scene)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_come_from_the_argument_or_the_file() {
        let cases = [
            ("house.glb", "house", "house.glb"),
            ("folder/house.v2.glb", "house.v2", "folder/house.v2.glb"),
            ("part.stl.gz", "part", "part.stl.gz"),
            ("old=house.glb", "old", "house.glb"),
            ("old=a=b.glb", "old", "a=b.glb"),
            ("folder/a=b.glb", "a=b", "folder/a=b.glb"),
            ("=house.glb", "=house", "=house.glb"),
        ];
        for (argument, label, path) in cases {
            assert_eq!(split(argument), (label.to_owned(), PathBuf::from(path)), "{argument}");
        }
    }
}
