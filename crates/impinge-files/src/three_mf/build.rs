//! Flattens the build of a 3MF model: each object with the map that places it.

use std::collections::HashMap;

use crate::{
    error::{LoadError, LoadErrorKind, Place},
    instance::Affine,
    limits::{Budget, Limits},
    model::{Faces, WarningKind},
};

use super::{
    models::{Key, Models},
    part::{Object, Reference},
};

/// Maximum nesting depth of components. It ends cycles and bounds the stack. Assemblies of CAD
/// programs nest about ten deep.
const MAX_DEPTH: u32 = 64;

/// Counts of an object, including everything nested in it.
#[derive(Clone, Copy)]
struct Sum {
    vertices: u64,
    triangles: u64,
    components: u64,
    /// Depth of nested objects, including the object itself.
    height: u32,
}

/// Maximum numbers of items of the build.
#[derive(Clone, Copy)]
pub(super) struct Budgets {
    /// For vertices, triangles and components.
    pub(super) items: Budget,
    /// For the bytes of the names of parts.
    pub(super) names: Budget,
}

pub(super) struct Build<'a> {
    models: &'a Models,
    names: Budget,
    name_bytes: u64,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) parts: Vec<String>,
    pub(super) faces: Faces,
}

impl<'a> Build<'a> {
    /// Adds all items of the build, after checking that they stay within the budget.
    pub(super) fn run(models: &'a Models, budgets: Budgets, limits: &Limits) -> Result<Self, LoadError> {
        let Budgets { items: budget, names } = budgets;
        let items = models.items();
        let total = Counter { models, budget, known: HashMap::new() }.sum(0, items, Sum::of(None), 0)?;
        let faces = Faces::new(limits);
        faces.check_room(total.triangles).map_err(|e| e.at(Place::Entry("the build".into())))?;
        let mut build = Self { models, names, name_bytes: 0, positions: Vec::new(), parts: Vec::new(), faces };
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
            self.name_bytes += (size_of::<String>() + name.len()) as u64;
            self.names.check("bytes of names", self.name_bytes).map_err(|e| e.at(self.models.place(key)))?;
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
            let counts = [("vertices", sum.vertices), ("triangles", sum.triangles), ("components", sum.components)];
            for (what, count) in counts {
                self.budget.check(what, count).map_err(|e| e.at(self.models.place(key)))?;
            }
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
