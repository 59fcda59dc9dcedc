//! Finds the files that the description of a robot or a scene refers to.

use std::{
    env,
    ffi::OsStr,
    path::{Component, Path, PathBuf},
};

use percent_encoding::percent_decode_str;

/// Maximum number of folders above the description in which a package is searched.
const MAX_ABOVE: usize = 32;

/// The folders in which files are searched.
pub(crate) struct Packages<'a> {
    /// Folder of the description.
    folder: PathBuf,
    /// Packages whose folder the caller knows.
    known: &'a [(String, PathBuf)],
    /// Folders of which each package is a child, from the environment.
    shared: Vec<PathBuf>,
}

/// A file that a reference means.
pub(super) struct Found {
    pub(super) path: PathBuf,
    /// Name of the package, if its place was guessed.
    pub(super) guessed: Option<String>,
}

/// A reference that means no file, or more than one.
pub(super) enum Lost {
    /// The paths that were tried.
    Missing(Vec<PathBuf>),
    /// The files that could be meant.
    Ambiguous(Vec<PathBuf>),
}

impl<'a> Packages<'a> {
    /// Returns the folders of a description, with those of `ROS_PACKAGE_PATH` and
    /// `AMENT_PREFIX_PATH`.
    pub(crate) fn new(description: &Path, known: &'a [(String, PathBuf)]) -> Self {
        let paths = |name: &str| {
            let value = env::var_os(name).unwrap_or_default();
            env::split_paths(&value).filter(|path| !path.as_os_str().is_empty()).collect::<Vec<_>>()
        };
        let mut shared = paths("ROS_PACKAGE_PATH");
        shared.extend(paths("AMENT_PREFIX_PATH").into_iter().map(|prefix| prefix.join("share")));
        let folder = description.parent().unwrap_or(Path::new("")).to_owned();
        Self { folder: folder.canonicalize().unwrap_or(folder), known, shared }
    }

    /// Returns the file that a reference means: a path, which is relative to the description, or a
    /// URI with the scheme `file`, `package` or `model`.
    pub(super) fn find(&self, uri: &str) -> Result<Found, Lost> {
        for scheme in ["package://", "model://"] {
            if let Some(rest) = uri.strip_prefix(scheme) {
                let rest = rest.trim_start_matches('/');
                let (package, inner) = rest.split_once('/').unwrap_or((rest, ""));
                return self.find_in_package(package, inner);
            }
        }
        let file = uri.strip_prefix("file://").map(|rest| rest.strip_prefix("localhost").unwrap_or(rest));
        let tried: Vec<PathBuf> = spellings(file.unwrap_or(uri)).map(|path| self.folder.join(path)).collect();
        match tried.iter().find(|path| path.is_file()) {
            Some(path) => Ok(Found { path: path.clone(), guessed: None }),
            None => Err(Lost::Missing(tried)),
        }
    }

    fn find_in_package(&self, package: &str, inner: &str) -> Result<Found, Lost> {
        let found = |path| Found { path, guessed: None };
        let in_folder = |folder: &Path| spellings(inner).map(|inner| folder.join(inner)).collect::<Vec<_>>();
        if let Some((_, folder)) = self.known.iter().find(|(name, _)| name == package) {
            let tried = in_folder(folder);
            return tried.iter().find(|path| path.is_file()).cloned().map(found).ok_or(Lost::Missing(tried));
        }
        let is_named = |folder: &Path| folder.file_name() == Some(OsStr::new(package));
        for folder in &self.shared {
            let own = if is_named(folder) { in_folder(folder) } else { Vec::new() };
            if let Some(path) = in_folder(&folder.join(package)).into_iter().chain(own).find(|path| path.is_file()) {
                return Ok(found(path));
            }
        }
        // The package may be any folder above the description, or beside one of them.
        let mut candidates: Vec<PathBuf> = Vec::new();
        for above in self.folder.ancestors().take(MAX_ABOVE) {
            for path in in_folder(&above.join(package)).into_iter().chain(in_folder(above)) {
                if path.is_file() {
                    let path = path.canonicalize().unwrap_or(path);
                    if !candidates.contains(&path) {
                        candidates.push(path);
                    }
                }
            }
        }
        match candidates.len() {
            0 => Err(Lost::Missing(Vec::new())),
            1 => Ok(Found { path: candidates.remove(0), guessed: Some(package.to_owned()) }),
            _ => Err(Lost::Ambiguous(candidates)),
        }
    }
}

/// Returns a path as it is written, and with its percent escapes decoded if it has any.
fn spellings(path: &str) -> impl Iterator<Item = PathBuf> {
    let decoded = percent_decode_str(path).decode_utf8().ok().filter(|decoded| decoded != path);
    let plain = |path: &str| {
        // Only the first component may be the root: `file:////data` is `/data`.
        let path = if path.starts_with("//") { format!("/{}", path.trim_start_matches('/')) } else { path.to_owned() };
        Path::new(&path).components().filter(|part| *part != Component::CurDir).collect::<PathBuf>()
    };
    std::iter::once(plain(path)).chain(decoded.map(|decoded| plain(&decoded)))
}
