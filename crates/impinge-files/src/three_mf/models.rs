//! The model parts of a package that its build uses.

use std::collections::HashMap;

use crate::{
    error::{LoadError, Place},
    unit::Unit,
};

use super::{
    package::{Entry, Package},
    part::{Object, Part, Reference},
};

/// An object: the index of its part, and its id in the part.
pub(super) type Key = (usize, u32);

/// All model parts that the build uses, starting with the part that contains the build. Each part
/// is read once, even if references spell its path in different ways.
pub(super) struct Models {
    parts: Vec<Part>,
    /// For each part, the path by which it was first found.
    paths: Vec<String>,
}

impl Models {
    pub(super) fn load(package: &mut Package<'_>, start: String) -> Result<Self, LoadError> {
        let first = package.entry(&start)?;
        let mut entries = vec![first];
        let mut by_entry: HashMap<Entry, usize> = HashMap::from([(first, 0)]);
        let mut models = Self { parts: Vec::new(), paths: vec![start] };
        while let Some(&entry) = entries.get(models.parts.len()) {
            let path = &models.paths[models.parts.len()];
            let mut part = Part::read(&package.read(entry, path)?, path)?;
            let components = part.objects.values_mut().flat_map(|object| &mut object.components);
            for reference in part.items.iter_mut().chain(components) {
                let Some(path) = reference.path.take() else { continue };
                let entry = package.entry(&path)?;
                reference.part = Some(*by_entry.entry(entry).or_insert_with(|| {
                    entries.push(entry);
                    models.paths.push(path.into());
                    entries.len() - 1
                }));
            }
            models.parts.push(part);
        }
        Ok(models)
    }

    /// Returns the unit of the build.
    pub(super) fn unit(&self) -> Unit {
        self.parts[0].unit
    }

    /// Returns the items of the build.
    pub(super) fn items(&self) -> &[Reference] {
        &self.parts[0].items
    }

    /// Returns the object that a reference in a part refers to. Returns an error if it does not
    /// exist.
    pub(super) fn resolve(&self, part: usize, reference: &Reference) -> Result<(Key, &Object), LoadError> {
        let part = reference.part.unwrap_or(part);
        let key = (part, reference.object);
        match self.parts[part].objects.get(&reference.object) {
            Some(object) => Ok((key, object)),
            None => Err(LoadError::syntax("an object with this id", b"").at(self.place(key))),
        }
    }

    pub(super) fn place(&self, (part, id): Key) -> Place {
        Place::Entry(format!("{}, object {id}", self.paths[part]))
    }
}
