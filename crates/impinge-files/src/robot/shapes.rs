//! Makes the shapes of links: primitives, and meshes that are loaded once each.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use impinge::{InputError, Mesh, Pose, Positions, Shape, hull::Hull};

use super::{
    RobotGeometry,
    geometry::{Form, Piece},
    packages::Packages,
    problem::RobotProblem,
    warning::Notes,
};
use crate::{
    collada::Axes,
    error::{LoadError, LoadErrorKind},
    limits::{Budget, Limits},
    load_with_axes,
    model::{Model, stored},
    unit::Unit,
    xml_tree::Tree,
};

/// The meshes and hulls of a robot.
pub(super) struct Shapes<'a> {
    tree: &'a Tree<'a>,
    packages: Packages<'a>,
    geometry: RobotGeometry,
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
    pub(super) fn new(tree: &'a Tree<'a>, packages: Packages<'a>, geometry: RobotGeometry, limits: &'a Limits) -> Self {
        let (models, made) = (HashMap::new(), HashMap::new());
        Self { tree, packages, geometry, limits, models, made, bytes: 0, copied_corners: 0, guessed: Vec::new() }
    }

    /// Returns the shape of a link: the union of its pieces, or `None` if there are no pieces.
    pub(super) fn of_link(
        &mut self,
        link: &str,
        pieces: &[Piece],
        notes: &mut Notes<'_>,
    ) -> Result<Option<Shape>, LoadError> {
        let mut parts = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let shape = self.of_piece(link, piece, notes).map_err(|error| error.at(self.tree.place(piece.element)))?;
            parts.push((shape, piece.link_from_piece));
        }
        match &parts[..] {
            [] => Ok(None),
            [(shape, Pose::IDENTITY)] => Ok(Some(shape.clone())),
            _ => Shape::compound(&parts).map(Some).map_err(|error| invalid(link, error)),
        }
    }

    fn of_piece(&mut self, link: &str, piece: &Piece, notes: &mut Notes<'_>) -> Result<Shape, LoadError> {
        let made = match piece.form {
            Form::Box(size) => Shape::cuboid(size.map(|x| 0.5 * x)),
            Form::Cylinder(radius, length) => Shape::cylinder(0.5 * length, radius),
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
            Form::Mesh(ref uri, scale) => return self.of_mesh(link, uri, scale, piece, notes),
        };
        made.map_err(|error| invalid(link, error))
    }

    fn of_mesh(
        &mut self,
        link: &str,
        uri: &str,
        scale: [f64; 3],
        piece: &Piece,
        notes: &mut Notes<'_>,
    ) -> Result<Shape, LoadError> {
        if scale.contains(&0.0) {
            return Err(broken(RobotProblem::ZeroScale { link: link.to_owned() }));
        }
        if uri.starts_with("http://") || uri.starts_with("https://") {
            return Err(LoadError::unsupported(format!("the mesh {uri:?} from a server")));
        }
        let found = self.packages.find(uri).map_err(|lost| broken(lost.problem(link, uri)))?;
        if let Some(package) = found.guessed.filter(|package| !self.guessed.contains(package)) {
            let folder = found.path.display();
            notes.add(
                self.tree,
                piece.element,
                format!("guessed where the package {package:?} is: {folder} was found"),
            );
            self.guessed.push(package);
        }
        let key = (found.path, scale.map(f64::to_bits));
        if let Some(shape) = self.made.get(&key) {
            return Ok(shape.clone());
        }
        let model = self.model(&key.0).map_err(|error| match error.kind() {
            LoadErrorKind::TooMany { .. } => error,
            _ => broken(RobotProblem::Mesh { link: link.to_owned(), message: error.to_string() }),
        })?;
        let shape = make(&model, scale, self.geometry).map_err(|error| invalid(link, error))?;
        if model.faces.is_empty() {
            notes.add(self.tree, piece.element, format!("link {link:?}: the mesh {uri:?} has no faces"));
        } else if shape.as_mesh().is_some_and(|(_, is_solid)| !is_solid) {
            let message = format!("link {link:?}: the mesh {uri:?} is open, so only its surface is checked");
            notes.add(self.tree, piece.element, message);
        }
        self.made.insert(key, shape.clone());
        Ok(shape)
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

/// Returns the shape of a mesh file: closed meshes are solids.
fn make(model: &Model, scale: [f64; 3], geometry: RobotGeometry) -> Result<Shape, InputError> {
    let positions = scaled(&model.positions, model.unit, scale);
    if geometry == RobotGeometry::Hull && !model.faces.is_empty() {
        let hull = match &positions {
            Positions::F32(rows) => Hull::new(rows),
            Positions::F64(rows) => Hull::new(rows),
        };
        return Ok(Shape::hull(Arc::new(hull?)));
    }
    // A scale that mirrors turns the outside of each face inwards.
    let mirrors = scale.iter().filter(|x| **x < 0.0).count() % 2 == 1;
    let face = |&[a, b, c]: &[u32; 3]| if mirrors { [a, c, b] } else { [a, b, c] };
    let mesh = Mesh::new(positions, model.faces.iter().map(face).collect::<Vec<_>>())?;
    Ok(if mesh.is_closed() { Shape::solid(&mesh) } else { Shape::mesh(&mesh) })
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

fn broken(problem: RobotProblem) -> LoadError {
    LoadError::new(LoadErrorKind::BrokenRobot { problem })
}

fn invalid(link: &str, error: InputError) -> LoadError {
    broken(RobotProblem::Shape { link: link.to_owned(), error })
}
