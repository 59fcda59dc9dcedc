//! Corpus of cases with known answers, `cases/*.toml`, which every engine and language must answer.
//!
//! A file names meshes and lists queries about them:
//!
//! ```toml
//! [mesh.floor]                       # inline ...
//! precision = "f32"                  # default: f64; coordinates are read as f64, scaled, then rounded
//! vertices = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
//! faces = [[0, 1, 2]]
//!
//! [mesh.sphere]                      # ... or generated
//! scale = 1e-3                       # default: 1
//! generator = { icosphere = { subdivisions = 4 } }
//!
//! [[case]]
//! id = "floor-under-sphere"          # unique in the corpus
//! source = "closed form"             # origin of the answer
//! a = "floor"
//! b = "sphere"
//! pose_a = [0, 0, -1.5]              # world from local: a translation, or 3 rows of a 3x4 matrix
//! pose_b = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
//! intersects = false                 # one of: intersects; pairs (all, sorted); pair_count
//!
//! [[distance]]                       # the same, with another answer
//! id = "floor-to-sphere"
//! source = "closed form"
//! a = "floor"
//! b = "sphere"
//! distance = 0.5                     # between the surfaces
//! tolerance = 1e-9                   # maximum error of the stated number; default: 0
//! ```

use crate::generate::{Rng, knots, solids};
use crate::read_error::{ReadError, read_text};
use crate::{Affine, Mesh};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Query about two posed meshes, and its answer.
#[derive(Clone, Debug)]
pub struct Case {
    /// Identifier, unique in the corpus.
    pub id: String,
    /// Origin of the answer.
    pub source: String,
    /// First mesh.
    pub a: Stored,
    /// Second mesh.
    pub b: Stored,
    /// Pose of the first mesh.
    pub world_from_a: Affine,
    /// Pose of the second mesh.
    pub world_from_b: Affine,
    /// Answer that every engine must give.
    pub expected: Expected,
}

/// Mesh, and the precision in which an engine receives it.
#[derive(Clone, Debug)]
pub struct Stored {
    /// Mesh. If `precision` is f32, every coordinate is an f32 number.
    pub mesh: Mesh,
    /// Precision of its coordinates.
    pub precision: Precision,
}

/// Precision of stored coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32-bit floats.
    F32,
    /// 64-bit floats.
    #[default]
    F64,
}

/// Answer of a case. Its kind determines the query.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Whether any two faces intersect.
    Intersects(bool),
    /// All intersecting pairs (face of a, face of b), sorted.
    Pairs(Vec<(u32, u32)>),
    /// Number of intersecting pairs.
    PairCount(usize),
}

/// Query for the distance of two posed meshes, and its answer.
#[derive(Clone, Debug)]
pub struct DistanceCase {
    /// Identifier, unique among the distances of the corpus.
    pub id: String,
    /// Origin of the answer.
    pub source: String,
    /// First mesh.
    pub a: Stored,
    /// Second mesh.
    pub b: Stored,
    /// Pose of the first mesh.
    pub world_from_a: Affine,
    /// Pose of the second mesh.
    pub world_from_b: Affine,
    /// Distance of the surfaces, which is zero if they intersect.
    pub distance: f64,
    /// Maximum error of `distance`.
    pub tolerance: f64,
}

/// Reads the cases of every `*.toml` in a folder, by file name and then in the order of the file.
///
/// # Errors
/// Returns an error if a file cannot be read or is invalid, or if two cases have the same id.
pub fn read_folder(folder: &Path) -> Result<Vec<Case>, ReadError> {
    let mut cases = Vec::new();
    let mut ids = BTreeSet::new();
    for (path, file) in files(folder)? {
        for case in file.cases().map_err(|message| ReadError::new(&path, message))? {
            if !ids.insert(case.id.clone()) {
                return Err(ReadError::new(&path, format!("a second case has the id {:?}", case.id)));
            }
            cases.push(case);
        }
    }
    Ok(cases)
}

/// Reads every `*.toml` in a folder, by name.
fn files(folder: &Path) -> Result<Vec<(PathBuf, File)>, ReadError> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(|error| ReadError::new(folder, error))?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    let read = |path: PathBuf| {
        let file = parse(&read_text(&path)?).map_err(|message| ReadError::new(&path, message))?;
        Ok((path, file))
    };
    paths.into_iter().map(read).collect()
}

/// Reads the cases of this repository.
///
/// # Errors
/// Returns an error if [`read_folder`] would.
pub fn corpus() -> Result<Vec<Case>, ReadError> {
    read_folder(&own_folder())
}

/// Reads the distances of this repository.
///
/// # Errors
/// Returns an error if [`read_folder`] would.
pub fn distances() -> Result<Vec<DistanceCase>, ReadError> {
    let mut cases: Vec<DistanceCase> = Vec::new();
    for (path, file) in files(&own_folder())? {
        for case in file.distances().map_err(|message| ReadError::new(&path, message))? {
            if cases.iter().any(|other| other.id == case.id) {
                return Err(ReadError::new(&path, format!("a second distance has the id {:?}", case.id)));
            }
            cases.push(case);
        }
    }
    Ok(cases)
}

fn own_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases")
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    mesh: BTreeMap<String, MeshEntry>,
    #[serde(default)]
    case: Vec<CaseEntry>,
    #[serde(default)]
    distance: Vec<DistanceEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshEntry {
    #[serde(default)]
    precision: Precision,
    scale: Option<f64>,
    vertices: Option<Vec<[f64; 3]>>,
    faces: Option<Vec<[u32; 3]>>,
    generator: Option<Generator>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Generator {
    Icosphere { subdivisions: u32 },
    Cuboid { low: [f64; 3], high: [f64; 3] },
    Tetrahedron {},
    PlaneGrid { nx: u32, ny: u32 },
    Fan { blades: u32 },
    GridSoup { seed: u64, count: usize, side: i64, reach: i64 },
    TorusKnot { along: u32, around: u32 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseEntry {
    id: String,
    source: String,
    a: String,
    b: String,
    pose_a: Option<PoseEntry>,
    pose_b: Option<PoseEntry>,
    intersects: Option<bool>,
    pairs: Option<Vec<(u32, u32)>>,
    pair_count: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DistanceEntry {
    id: String,
    source: String,
    a: String,
    b: String,
    pose_a: Option<PoseEntry>,
    pose_b: Option<PoseEntry>,
    distance: f64,
    tolerance: Option<f64>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum PoseEntry {
    Translation([f64; 3]),
    Rows([[f64; 4]; 3]),
}

fn parse(text: &str) -> Result<File, String> {
    toml::from_str(text).map_err(|error| error.to_string())
}

impl File {
    fn cases(self) -> Result<Vec<Case>, String> {
        let meshes = stored(self.mesh)?;
        self.case.into_iter().map(|entry| entry.into_case(&meshes)).collect()
    }

    fn distances(self) -> Result<Vec<DistanceCase>, String> {
        let meshes = stored(self.mesh)?;
        self.distance.into_iter().map(|entry| entry.into_case(&meshes)).collect()
    }
}

fn stored(meshes: BTreeMap<String, MeshEntry>) -> Result<BTreeMap<String, Stored>, String> {
    meshes
        .into_iter()
        .map(|(name, entry)| {
            let stored = entry.into_stored().map_err(|message| format!("mesh {name:?}: {message}"))?;
            Ok((name, stored))
        })
        .collect()
}

impl MeshEntry {
    fn into_stored(self) -> Result<Stored, String> {
        let mesh = match (self.vertices, self.faces, self.generator) {
            (Some(vertices), Some(faces), None) => Mesh { vertices, faces },
            (None, None, Some(generator)) => generator.mesh(),
            _ => return Err("needs either vertices and faces, or a generator".into()),
        };
        if mesh.faces.iter().flatten().any(|&i| i as usize >= mesh.vertices.len()) {
            return Err("a face has an index past the vertices".into());
        }
        let mesh = mesh.scaled(self.scale.unwrap_or(1.0));
        let mesh = if self.precision == Precision::F32 { mesh.rounded_to_f32() } else { mesh };
        Ok(Stored { mesh, precision: self.precision })
    }
}

impl Generator {
    fn mesh(self) -> Mesh {
        match self {
            Self::Icosphere { subdivisions } => solids::icosphere(subdivisions),
            Self::Cuboid { low, high } => solids::cuboid(low, high),
            Self::Tetrahedron {} => solids::tetrahedron(),
            Self::PlaneGrid { nx, ny } => solids::plane_grid(nx, ny),
            Self::Fan { blades } => solids::fan(blades),
            Self::GridSoup { seed, count, side, reach } => solids::grid_soup(&mut Rng::new(seed), count, side, reach),
            Self::TorusKnot { along, around } => knots::torus_knot(along, around, knots::TREFOIL),
        }
    }
}

impl CaseEntry {
    fn into_case(self, meshes: &BTreeMap<String, Stored>) -> Result<Case, String> {
        let mesh = |name: &str| {
            meshes.get(name).cloned().ok_or_else(|| format!("case {:?}: there is no mesh {name:?}", self.id))
        };
        let expected = match (self.intersects, self.pairs, self.pair_count) {
            (Some(answer), None, None) => Expected::Intersects(answer),
            (None, Some(pairs), None) => Expected::Pairs(pairs),
            (None, None, Some(count)) => Expected::PairCount(count),
            _ => return Err(format!("case {:?}: needs one of intersects, pairs and pair_count", self.id)),
        };
        Ok(Case {
            a: mesh(&self.a)?,
            b: mesh(&self.b)?,
            world_from_a: self.pose_a.map_or(Affine::IDENTITY, PoseEntry::into_affine),
            world_from_b: self.pose_b.map_or(Affine::IDENTITY, PoseEntry::into_affine),
            id: self.id,
            source: self.source,
            expected,
        })
    }
}

impl DistanceEntry {
    fn into_case(self, meshes: &BTreeMap<String, Stored>) -> Result<DistanceCase, String> {
        let mesh = |name: &str| {
            meshes.get(name).cloned().ok_or_else(|| format!("distance {:?}: there is no mesh {name:?}", self.id))
        };
        Ok(DistanceCase {
            a: mesh(&self.a)?,
            b: mesh(&self.b)?,
            world_from_a: self.pose_a.map_or(Affine::IDENTITY, PoseEntry::into_affine),
            world_from_b: self.pose_b.map_or(Affine::IDENTITY, PoseEntry::into_affine),
            id: self.id,
            source: self.source,
            distance: self.distance,
            tolerance: self.tolerance.unwrap_or(0.0),
        })
    }
}

impl PoseEntry {
    fn into_affine(self) -> Affine {
        match self {
            Self::Translation(offset) => Affine::translation(offset),
            Self::Rows(rows) => Affine::new(rows.map(|[x, y, z, _]| [x, y, z]), rows.map(|row| row[3])),
        }
    }
}

impl Expected {
    /// Returns the answer of this kind that follows from a sorted list of all intersecting pairs.
    pub fn of_pairs(&self, pairs: &[(u32, u32)]) -> Self {
        match self {
            Self::Intersects(_) => Self::Intersects(!pairs.is_empty()),
            Self::Pairs(_) => Self::Pairs(pairs.to_vec()),
            Self::PairCount(_) => Self::PairCount(pairs.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::{brute_force, grid};

    #[test]
    fn every_expected_answer_is_that_of_the_oracles() {
        let cases = corpus().unwrap_or_else(|error| panic!("{error}"));
        assert!(cases.len() >= 60, "{}", cases.len());
        let wrong: Vec<String> = cases
            .iter()
            .filter_map(|case| {
                let (a, b) = (case.a.mesh.at(case.world_from_a), case.b.mesh.at(case.world_from_b));
                let pairs = brute_force(a, b);
                assert_eq!(pairs, grid(a, b), "{}", case.id);
                let truth = case.expected.of_pairs(&pairs);
                (truth != case.expected).then(|| format!("{}: {truth:?}, not {:?}\n", case.id, case.expected))
            })
            .collect();
        assert!(wrong.is_empty(), "{}", wrong.concat());
        let met = cases.iter().filter(|case| case.expected.of_pairs(&[]) != case.expected).count();
        assert!((cases.len() * 3 / 10..cases.len() * 7 / 10).contains(&met), "{met} of {} intersect", cases.len());
    }

    #[test]
    fn mistakes_in_files_are_reported() {
        let mesh = "[mesh.m]\nvertices = [[0, 0, 0]]\nfaces = [[0, 0, 0]]\n";
        let case = "[[case]]\nid = 'x'\nsource = ''\na = 'm'\nb = 'm'\n";
        let message = |text: String| parse(&text).and_then(File::cases).err().unwrap_or_default();
        assert_eq!(message(format!("{mesh}{case}intersects = true\n")), "");
        assert!(message(format!("{mesh}{case}")).contains("needs one of intersects, pairs and pair_count"));
        assert!(message(format!("{mesh}{case}intersects = true\npair_count = 1")).contains("needs one of"));
        assert!(message(format!("{mesh}{case}intersect = true\n")).contains("intersect"));
        let absent = format!("{mesh}{}intersects = true", case.replace("b = 'm'", "b = 'n'"));
        assert!(message(absent).contains("there is no mesh \"n\""));
        assert!(message(format!("{}{case}intersects = true", mesh.replace("0]]\nf", "0]]\nscale = 2\nf"))).is_empty());
        assert!(
            message(format!("{}{case}pairs = []", mesh.replace("0, 0]]\nf", "0, 0]]\ngenerator.tetrahedron = {}\nf")))
                .contains("either")
        );
        assert!(
            message(format!("{}{case}pairs = []", mesh.replace("[[0, 0, 0]]\nfaces", "[]\nfaces"))).contains("past")
        );
    }
}
