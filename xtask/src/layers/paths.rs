//! Finds the file that defines the item of a path, through any re-exports.

use std::collections::HashMap;

use super::files::SourceFile;
use super::imports::{from_root, leaves};

/// Maximum number of re-exports followed for one path. Real paths need two or three; the limit ends
/// a re-export of itself.
const MAX_REEXPORTS: usize = 16;

/// Names that the files of a crate define or import.
pub(super) struct Names<'a> {
    /// Number of the file of each module.
    file_of: HashMap<&'a [String], usize>,
    /// For each file, the paths from the root that its imports stand for, by the names that they
    /// introduce.
    imported: Vec<HashMap<String, Vec<String>>>,
}

impl<'a> Names<'a> {
    pub(super) fn of(files: &'a [SourceFile]) -> Self {
        let file_of = files.iter().enumerate().map(|(number, file)| (&file.module[..], number)).collect();
        Self { file_of, imported: files.iter().map(imported_names).collect() }
    }

    /// Returns the number of the file that defines the item of `path`, which is counted from the
    /// root of the crate.
    pub(super) fn home(&self, path: &[String]) -> Option<usize> {
        self.home_within(path, MAX_REEXPORTS)
    }

    fn home_within(&self, path: &[String], reexports: usize) -> Option<usize> {
        let mut file = *self.file_of.get(&path[..0])?;
        for (at, name) in path.iter().enumerate() {
            let child = self.file_of.get(&path[..=at]);
            match (child, self.imported[file].get(name)) {
                // A module and a function may have the same name. A name after a module is in it.
                (Some(&child), None) => file = child,
                (Some(&child), Some(_)) if at + 1 < path.len() => file = child,
                (_, Some(target)) if reexports > 0 => {
                    return self.home_within(&[target, &path[at + 1..]].concat(), reexports - 1);
                }
                _ => break,
            }
        }
        Some(file)
    }
}

fn imported_names(file: &SourceFile) -> HashMap<String, Vec<String>> {
    let mut imported = HashMap::new();
    for item in &file.syntax.items {
        if let syn::Item::Use(import) = item
            && import.leading_colon.is_none()
        {
            leaves(&import.tree, &mut Vec::new(), &mut |segments, name, _| {
                let target = from_root(&file.module, segments).unwrap_or_else(|| {
                    let below = segments.iter().filter(|s| *s != "self");
                    file.module.iter().chain(below).cloned().collect()
                });
                let name = if name == "self" { target.last().cloned() } else { Some(name.to_owned()) };
                if let Some(name) = name
                    && target.last().is_some_and(|last| last != "*")
                    && target != [&file.module[..], std::slice::from_ref(&name)].concat()
                {
                    imported.insert(name, target);
                }
            });
        }
    }
    imported
}
