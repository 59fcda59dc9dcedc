//! Makes the shapes of links and objects: primitives, and meshes that are loaded once each.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use impinge::{InputError, Mesh, Pose, Positions, Shape, hull::Hull};

use super::{Form, Piece, packages::Packages, problem::PieceProblem, warning::Notes};
use crate::{
    collada::Axes,
    error::{LoadError, LoadErrorKind, Place},
    limits::{Budget, Limits},
    load_with_axes,
    model::{Model, stored},
    unit::Unit,
};

/// Noun and errors for the owners of pieces in a description, and the lines of its elements.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    /// Noun of an owner: `link` or `object`.
    pub(crate) noun: &'static str,
    /// Returns the error that a piece of an owner, which it names, cannot be made.
    pub(crate) broken: fn(String, PieceProblem) -> LoadErrorKind,
    /// Returns the line of an element.
    pub(crate) place: &'a dyn Fn(usize) -> Place,
}

/// The meshes and hulls of a description.
pub(crate) struct Shapes<'a> {
    context: Context<'a>,
    packages: Packages<'a>,
    /// Whether meshes stand for their convex hulls.
    has_hulls: bool,
    limits: &'a Limits,
    models: HashMap<PathBuf, Arc<Model>>,
    /// Shapes by the path of the mesh and the bits of its scale.
    made: HashMap<(PathBuf, [u64; 3]), Shape>,
    /// Number of bytes of all mesh files.
    bytes: u64,
    /// Number of corners of the meshes that were made of a file in more than one scale. Without a
    /// limit, a short description could make any number of copies of a large mesh.
    copied_corners: u64,
    /// Packages whose place was guessed.
    guessed: Vec<String>,
}

impl<'a> Shapes<'a> {
    pub(crate) fn new(context: Context<'a>, packages: Packages<'a>, has_hulls: bool, limits: &'a Limits) -> Self {
        let (models, made) = (HashMap::new(), HashMap::new());
        Self { context, packages, has_hulls, limits, models, made, bytes: 0, copied_corners: 0, guessed: Vec::new() }
    }

    /// Returns the union of the pieces of an owner, or `None` if there are no pieces.
    pub(crate) fn of(
        &mut self,
        owner: &str,
        pieces: &[Piece],
        notes: &mut Notes<'_>,
    ) -> Result<Option<Shape>, LoadError> {
        let place = self.context.place;
        let mut parts = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let shape = self.of_piece(owner, piece, notes).map_err(|error| error.at(place(piece.element)))?;
            parts.push((shape, piece.pose));
        }
        match &parts[..] {
            [] => Ok(None),
            [(shape, Pose::IDENTITY)] => Ok(Some(shape.clone())),
            _ => Shape::compound(&parts)
                .map(Some)
                .map_err(|error| self.invalid(owner, error).at(place(pieces[0].element))),
        }
    }

    fn of_piece(&mut self, owner: &str, piece: &Piece, notes: &mut Notes<'_>) -> Result<Shape, LoadError> {
        let made = match piece.form {
            Form::Box(size) => Shape::cuboid(size.map(|x| 0.5 * x)),
            Form::Cylinder(radius, length) => Shape::cylinder(0.5 * length, radius),
            Form::Cone(radius, length) => Shape::cone(0.5 * length, radius),
            Form::Sphere(radius) => Shape::sphere([0.0; 3], radius),
            Form::Capsule(radius, length) => {
                let end = 0.5 * length;
                if length < 0.0 {
                    // This returns the error of a negative length.
                    Shape::cylinder(end, radius)
                } else {
                    Shape::capsule([0.0, 0.0, -end], [0.0, 0.0, end], radius)
                }
            }
            Form::File(ref uri, scale) => return self.of_file(owner, uri, scale, piece, notes),
            Form::Mesh(ref positions, ref faces) => Mesh::new(positions.clone(), faces.clone()).map(|mesh| {
                let shape = shape_of(&mesh);
                self.note(owner, "the mesh", &shape, piece, notes);
                shape
            }),
        };
        made.map_err(|error| self.invalid(owner, error))
    }

    fn of_file(
        &mut self,
        owner: &str,
        uri: &str,
        scale: [f64; 3],
        piece: &Piece,
        notes: &mut Notes<'_>,
    ) -> Result<Shape, LoadError> {
        if scale.contains(&0.0) {
            return Err(self.broken(owner, PieceProblem::ZeroScale));
        }
        if uri.starts_with("http://") || uri.starts_with("https://") {
            return Err(LoadError::unsupported(format!("the mesh {uri:?} from a server")));
        }
        let found = self.packages.find(uri).map_err(|lost| self.broken(owner, PieceProblem::lost(lost, uri)))?;
        if let Some(package) = found.guessed.filter(|package| !self.guessed.contains(package)) {
            let folder = found.path.display();
            let message = format!("guessed where the package {package:?} is: {folder} was found");
            notes.add(|| (self.context.place)(piece.element), message);
            self.guessed.push(package);
        }
        let key = (found.path, scale.map(f64::to_bits));
        if let Some(shape) = self.made.get(&key) {
            return Ok(shape.clone());
        }
        let model = self.model(&key.0).map_err(|error| match error.kind() {
            LoadErrorKind::TooMany { .. } => error,
            _ => self.broken(owner, PieceProblem::Mesh { message: error.to_string() }),
        })?;
        let shape = make(&model, scale, self.has_hulls).map_err(|error| self.invalid(owner, error))?;
        self.note(owner, &format!("the mesh {uri:?}"), &shape, piece, notes);
        self.made.insert(key, shape.clone());
        Ok(shape)
    }

    /// Warns if a mesh has no faces or is open.
    fn note(&self, owner: &str, mesh: &str, shape: &Shape, piece: &Piece, notes: &mut Notes<'_>) {
        let Some((faces, is_solid)) = shape.as_mesh() else { return };
        let problem = match (faces.faces().is_empty(), is_solid) {
            (true, _) => "has no faces",
            (false, false) => "is open, so only its surface is checked",
            (false, true) => return,
        };
        let message = format!("{} {owner:?}: {mesh} {problem}", self.context.noun);
        notes.add(|| (self.context.place)(piece.element), message);
    }

    fn broken(&self, owner: &str, problem: PieceProblem) -> LoadError {
        LoadError::new((self.context.broken)(owner.to_owned(), problem))
    }

    fn invalid(&self, owner: &str, error: InputError) -> LoadError {
        self.broken(owner, PieceProblem::Shape { error })
    }

    fn model(&mut self, path: &Path) -> Result<Arc<Model>, LoadError> {
        if let Some(model) = self.models.get(path).cloned() {
            self.copied_corners += 3 * model.faces.len() as u64 + model.positions.len() as u64;
            let budget = Budget::for_bytes(self.bytes, self.limits);
            budget.check("corners of meshes in several scales", self.copied_corners)?;
            return Ok(model);
        }
        self.bytes += fs::metadata(path).map_or(0, |metadata| metadata.len());
        let model = Arc::new(load_with_axes(path, Axes::AsWritten, self.limits)?);
        self.models.insert(path.to_owned(), model.clone());
        Ok(model)
    }
}

/// Returns a mesh as a shape: closed meshes are solids.
fn shape_of(mesh: &Mesh) -> Shape {
    if mesh.is_closed() { Shape::solid(mesh) } else { Shape::mesh(mesh) }
}

/// Returns the shape of a mesh file, or its convex hull.
fn make(model: &Model, scale: [f64; 3], has_hulls: bool) -> Result<Shape, InputError> {
    let positions = scaled(&model.positions, model.unit, scale);
    if has_hulls && !model.faces.is_empty() {
        let hull = match &positions {
            Positions::F32(rows) => Hull::new(rows),
            Positions::F64(rows) => Hull::new(rows),
        };
        return Ok(Shape::hull(Arc::new(hull?)));
    }
    // A scale that mirrors turns the outside of each face inwards.
    let mirrors = scale.iter().filter(|x| **x < 0.0).count() % 2 == 1;
    let face = |&[a, b, c]: &[u32; 3]| if mirrors { [a, c, b] } else { [a, b, c] };
    Ok(shape_of(&Mesh::new(positions, model.faces.iter().map(face).collect::<Vec<_>>())?))
}

/// Returns the positions in meters, times a scale.
fn scaled(positions: &Positions, unit: Option<Unit>, scale: [f64; 3]) -> Positions {
    let meters = unit.map_or(1.0, Unit::meters);
    if meters == 1.0 && scale == [1.0; 3] {
        return positions.clone();
    }
    // Dividing by a whole number rounds once; its reciprocal would round twice.
    let per_meter = (1.0 / meters).round();
    let is_whole = 1.0 / per_meter == meters;
    let in_meters = |x: f64| if is_whole { x / per_meter } else { x * meters };
    let rows = (0..positions.len()).map(|at| {
        let row = positions.get(at);
        std::array::from_fn(|k| in_meters(row[k]) * scale[k])
    });
    stored(rows.collect())
}
