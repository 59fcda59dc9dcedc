//! Flattens the build of a 3MF model: each object with the map that places it.

use std::collections::HashMap;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    instance::{Affine, Budget},
    model::{Faces, WarningKind},
    unit::Unit,
};

use super::{
    package::Package,
    part::{Object, Part, Reference},
};

/// Maximum nesting depth of components. It ends cycles and bounds the stack. Assemblies of CAD
/// programs nest about ten deep.
const MAX_DEPTH: u32 = 64;

/// An object: the index of its part, and its id in the part.
type Key = (usize, u32);

/// All model parts that the build uses, starting with the part that contains the build.
pub(super) struct Models {
    parts: Vec<Part>,
    paths: Vec<String>,
    by_path: HashMap<String, usize>,
}

impl Models {
    pub(super) fn load(package: &mut Package<'_>, start: String) -> Result<Self, LoadError> {
        let mut models = Self { parts: Vec::new(), paths: vec![start.clone()], by_path: HashMap::from([(start, 0)]) };
        while let Some(path) = models.paths.get(models.parts.len()) {
            let part = Part::read(&package.read(path)?, path)?;
            let components = part.objects.values().flat_map(|object| &object.components);
            for path in part.items.iter().chain(components).filter_map(|r| r.path.as_deref()) {
                if !models.by_path.contains_key(path) {
                    models.by_path.insert(path.to_owned(), models.paths.len());
                    models.paths.push(path.to_owned());
                }
            }
            models.parts.push(part);
        }
        Ok(models)
    }

    /// Returns the unit of the build.
    pub(super) fn unit(&self) -> Unit {
        self.parts[0].unit
    }

    /// Returns the object that a reference in a part refers to. Returns an error if it does not
    /// exist.
    fn resolve(&self, part: usize, reference: &Reference) -> Result<(Key, &Object), LoadError> {
        let part = reference.path.as_deref().map_or(part, |path| self.by_path[path]);
        let key = (part, reference.object);
        match self.parts[part].objects.get(&reference.object) {
            Some(object) => Ok((key, object)),
            None => Err(LoadError::syntax("an object with this id", b"").at(self.place(key))),
        }
    }

    fn place(&self, (part, id): Key) -> Place {
        Place::Entry(format!("{}, object {id}", self.paths[part]))
    }
}

/// Counts of an object, including everything nested in it.
#[derive(Clone, Copy)]
struct Sum {
    vertices: u64,
    triangles: u64,
    components: u64,
    /// Depth of nested objects, including the object itself.
    height: u32,
}

pub(super) struct Build<'a> {
    models: &'a Models,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) parts: Vec<String>,
    pub(super) faces: Faces,
}

impl<'a> Build<'a> {
    /// Adds all items of the build, after checking that they stay within the budget.
    pub(super) fn run(models: &'a Models, budget: Budget) -> Result<Self, LoadError> {
        let items = &models.parts[0].items;
        Counter { models, budget, known: HashMap::new() }.sum(0, items, Sum::of(None), 0)?;
        let mut build = Self { models, positions: Vec::new(), parts: Vec::new(), faces: Faces::default() };
        for item in items {
            build.add(0, item, &Affine::IDENTITY, "")?;
        }
        Ok(build)
    }

    /// Adds an object with its components. The counter has checked before that their depth and
    /// number are limited and that all objects exist.
    fn add(&mut self, part: usize, reference: &Reference, world: &Affine, around: &str) -> Result<(), LoadError> {
        let (key, object) = self.models.resolve(part, reference)?;
        let world = world.after(&reference.map);
        let name = if object.name.is_empty() { around } else { &object.name };
        self.faces.warnings.add(WarningKind::Beams, object.beams, || Some(self.models.place(key)));
        if !object.faces.is_empty() {
            self.add_faces(object, &world)?;
            self.parts.push(name.to_owned());
        }
        for (vertex, &p) in object.positions.iter().enumerate() {
            let p = world.apply(p);
            if !p.iter().all(|x| x.is_finite()) {
                let error = LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 });
                return Err(error.at(self.models.place(key)).with_hint("after the transforms of its object"));
            }
            self.positions.push(p);
        }
        object.components.iter().try_for_each(|component| self.add(key.0, component, &world, name))
    }

    fn add_faces(&mut self, object: &Object, world: &Affine) -> Result<(), LoadError> {
        let first = self.positions.len() as u32;
        let part = self.parts.len() as u32;
        let mirrored = world.mirrors();
        object.faces.iter().try_for_each(|&[a, b, c]| {
            let face = if mirrored { [a, c, b] } else { [a, b, c] };
            self.faces.triangle(face.map(|i| first + i), part)
        })
    }
}

/// Computes the counts of objects, each object once, even if it is used many times.
struct Counter<'a> {
    models: &'a Models,
    budget: Budget,
    known: HashMap<Key, Sum>,
}

impl Counter<'_> {
    /// Returns `own` plus the counts of all referenced objects; `depth` is the number of objects
    /// around them.
    fn sum(&mut self, part: usize, references: &[Reference], own: Sum, depth: u32) -> Result<Sum, LoadError> {
        let mut sum = own;
        for reference in references {
            let (key, object) = self.models.resolve(part, reference)?;
            let inner = match self.known.get(&key) {
                Some(&sum) => sum,
                None if depth < MAX_DEPTH => {
                    let sum = self.sum(key.0, &object.components, Sum::of(Some(object)), depth + 1)?;
                    self.known.insert(key, sum);
                    sum
                }
                None => return Err(self.too_deep(key)),
            };
            if depth + inner.height > MAX_DEPTH {
                return Err(self.too_deep(key));
            }
            sum.vertices = sum.vertices.saturating_add(inner.vertices);
            sum.triangles = sum.triangles.saturating_add(inner.triangles);
            sum.components = sum.components.saturating_add(inner.components);
            sum.height = sum.height.max(inner.height + 1);
            self.budget.check("vertices", sum.vertices)?;
            self.budget.check("triangles", sum.triangles)?;
            self.budget.check("components", sum.components)?;
        }
        Ok(sum)
    }

    fn too_deep(&self, key: Key) -> LoadError {
        let expected = format!("components nested at most {MAX_DEPTH} deep");
        LoadError::syntax(expected, b"more, or a cycle").at(self.models.place(key))
    }
}

impl Sum {
    /// Returns the counts of an object without its components, or of the build if `object` is
    /// `None`.
    fn of(object: Option<&Object>) -> Self {
        let (vertices, triangles) = object.map_or((0, 0), |o| (o.positions.len(), o.faces.len()));
        let one = u32::from(object.is_some());
        Self { vertices: vertices as u64, triangles: triangles as u64, components: one.into(), height: one }
    }
}
