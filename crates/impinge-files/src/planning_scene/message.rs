//! Objects of the message `moveit_msgs/PlanningScene`, `moveit_msgs/PlanningSceneWorld`, or a list
//! of `moveit_msgs/CollisionObject`, in YAML.
//!
//! Points and quaternions are lists or mappings, and types of primitives are names or the numbers
//! of `shape_msgs/SolidPrimitive`. Meshes are in the message, or a `resource` names a file.

use impinge::{InputError, Pose, Positions};

use super::{
    Content,
    frames::Transform,
    objects::{Object, Objects, Operation},
    place,
    yaml::{Document, Id, Value},
};
use crate::{
    error::LoadError,
    limits::{Budget, Limits},
    pieces::{Form, Notes, Piece},
    text::number,
};

/// Hint for a file that has no objects in the places in which they are searched.
const FORM: &str = "a planning scene has objects in world: collision_objects:";

/// Reads the objects of a document.
pub(super) fn read(text: &str, limits: &Limits, notes: &mut Notes<'_>) -> Result<Content, LoadError> {
    let document = &Document::parse(text)?;
    let root = document.root.ok_or_else(|| LoadError::syntax("a planning scene", b"").with_hint(FORM))?;
    if document.has_more {
        notes.add_about_all("only the first document of the file is read".to_owned());
    }
    let reader = Reader { document, budget: Budget::for_nodes(text.len() as u64, limits) };
    let world = document.field(root, "world").unwrap_or(root);
    let list = if matches!(document.value(world), Value::List(_)) {
        Some(world)
    } else {
        document.field(world, "collision_objects")
    };
    let has_world = document.field(root, "world").is_some();
    let Some(list) = list.or_else(|| has_world.then_some(world)) else {
        return Err(reader.expected(root, "a planning scene", "").with_hint(FORM));
    };
    reader.refuse_octomap(world)?;
    let mut objects = Objects::default();
    let mut count = 0;
    // A world without objects is an empty list.
    for &id in if list == world && has_world { &[] } else { reader.list(list, "collision_objects", "")? } {
        let (operation, object) = reader.object(id, &mut count, notes)?;
        objects.apply(operation, object, notes);
    }
    let attached =
        document.field(root, "robot_state").and_then(|state| document.field(state, "attached_collision_objects"));
    if let Some(attached) = attached
        && !reader.list(attached, "attached_collision_objects", "")?.is_empty()
    {
        let message = "objects that are attached to the robot are no obstacles, and are skipped";
        notes.add(|| place(document.line(attached)), message.to_owned());
    }
    let transforms = reader.transforms(root, notes)?;
    let name = document.field(root, "name").and_then(|id| document.text(id)).unwrap_or_default();
    Ok(Content { name: name.to_owned(), objects, transforms })
}

struct Reader<'d> {
    document: &'d Document,
    /// Limit on shapes, vertices and triangles, which aliases could repeat without end.
    budget: Budget,
}

impl Reader<'_> {
    /// Returns the error that something else was expected at a node. `of` names the object.
    fn expected(&self, id: Id, expected: &str, of: &str) -> LoadError {
        let of = if of.is_empty() { String::new() } else { format!(" of object {of:?}") };
        let found = self.document.shown(id);
        LoadError::syntax(format!("{expected}{of}"), found.as_bytes()).at(place(self.document.line(id)))
    }

    fn list(&self, id: Id, what: &str, of: &str) -> Result<&[Id], LoadError> {
        match self.document.value(id) {
            Value::List(items) => Ok(items),
            _ => Err(self.expected(id, &format!("a list as {what}"), of)),
        }
    }

    /// Returns the list of a field, or nothing if the field is missing.
    fn list_of(&self, map: Id, key: &str, of: &str) -> Result<&[Id], LoadError> {
        self.document.field(map, key).map_or(Ok(&[][..]), |id| self.list(id, key, of))
    }

    fn number(&self, id: Id, what: &str, of: &str) -> Result<f64, LoadError> {
        let number = self.document.text(id).and_then(|text| number(text.as_bytes()));
        number.filter(|number| number.is_finite()).ok_or_else(|| self.expected(id, &format!("a number in {what}"), of))
    }

    /// Returns numbers: a list, or a mapping of names, in which those that are missing are zero.
    fn numbers<const N: usize>(&self, id: Id, names: [&str; N], what: &str, of: &str) -> Result<[f64; N], LoadError> {
        let mut numbers = [0.0; N];
        match self.document.value(id) {
            Value::List(items) if items.len() == N => {
                for (number, &item) in numbers.iter_mut().zip(items) {
                    *number = self.number(item, what, of)?;
                }
            }
            Value::Map(_) => {
                for (number, name) in numbers.iter_mut().zip(names) {
                    if let Some(item) = self.document.field(id, name) {
                        *number = self.number(item, what, of)?;
                    }
                }
            }
            _ => return Err(self.expected(id, &format!("{N} numbers as {what}"), of)),
        }
        Ok(numbers)
    }

    /// Returns a pose, in which what is missing is zero.
    fn pose(&self, id: Id, of: &str) -> Result<Pose, LoadError> {
        let field = |keys: [&str; 2]| keys.into_iter().find_map(|key| self.document.field(id, key));
        if !matches!(self.document.value(id), Value::Map(_)) {
            return Err(self.expected(id, "a pose with position and orientation", of));
        }
        let position = match field(["position", "translation"]) {
            Some(id) => self.numbers(id, ["x", "y", "z"], "position", of)?,
            None => [0.0; 3],
        };
        let orientation = match field(["orientation", "rotation"]) {
            Some(id) => self.numbers(id, ["x", "y", "z", "w"], "orientation", of)?,
            None => [0.0; 4],
        };
        placed(position, orientation).map_err(|reason| self.expected(id, &format!("a valid pose ({reason})"), of))
    }

    /// Counts something that is read, within the budget.
    fn count(&self, id: Id, count: &mut u64, more: usize) -> Result<(), LoadError> {
        *count += more as u64;
        self.budget
            .check("shapes, vertices and triangles", *count)
            .map_err(|error| error.at(place(self.document.line(id))))
    }

    fn object(&self, id: Id, count: &mut u64, notes: &mut Notes<'_>) -> Result<(Operation, Object), LoadError> {
        let document = self.document;
        if !matches!(document.value(id), Value::Map(_)) {
            return Err(self.expected(id, "an object as a mapping", ""));
        }
        self.count(id, count, 1)?;
        let text = |map: Id, key: &str| document.field(map, key).and_then(|id| document.text(id));
        let name = text(id, "id").filter(|name| !name.is_empty());
        let name = name.ok_or_else(|| self.expected(id, "an object with an id", ""))?;
        let operation = self.operation(id, name)?;
        let header = document.field(id, "header");
        let frame = header.and_then(|header| text(header, "frame_id")).unwrap_or_default();
        let pose = document.field(id, "pose").map_or(Ok(Pose::IDENTITY), |pose| self.pose(pose, name))?;
        if let Some(planes) = document.field(id, "planes")
            && !self.list(planes, "planes", name)?.is_empty()
        {
            let error = LoadError::unsupported(format!("the plane of object {name:?}"));
            return Err(error.at(place(document.line(planes))).with_hint("use a large box"));
        }
        let mut pieces = Vec::new();
        for (shapes, poses) in [("primitives", "primitive_poses"), ("meshes", "mesh_poses")] {
            let shapes = self.list_of(id, shapes, name)?;
            let places = self.list_of(id, poses, name)?;
            if !places.is_empty() && places.len() != shapes.len() {
                let found = document.field(id, poses).unwrap_or(id);
                let expected = format!("{} {poses}, one for each shape, and not {},", shapes.len(), places.len());
                return Err(self.expected(found, &expected, name));
            }
            for (at, &shape) in shapes.iter().enumerate() {
                self.count(shape, count, 1)?;
                let pose = places.get(at).map_or(Ok(Pose::IDENTITY), |&pose| self.pose(pose, name))?;
                let form =
                    if poses == "mesh_poses" { self.mesh(shape, name, count)? } else { self.primitive(shape, name)? };
                pieces.push(Piece { form, pose, element: document.line(shape) });
            }
        }
        let line = document.line(id);
        if pieces.is_empty() && operation == Operation::Move && document.field(id, "pose").is_none() {
            notes.add(|| place(line), format!("object {name:?} is moved, but has no pose"));
        }
        Ok((operation, Object { name: name.to_owned(), frame: frame.to_owned(), pose, pieces, line }))
    }

    /// Returns the operation of an object. ROS 2 prints the byte of the message as an escape.
    fn operation(&self, id: Id, name: &str) -> Result<Operation, LoadError> {
        let Some(id) = self.document.field(id, "operation") else { return Ok(Operation::Add) };
        let text = self.document.text(id).unwrap_or_default();
        match text.to_lowercase().as_str() {
            "add" | "0" | "\0" | "\\0" | "\\x00" | "" => Ok(Operation::Add),
            "remove" | "1" | "\u{1}" | "\\x01" => Ok(Operation::Remove),
            "append" | "2" | "\u{2}" | "\\x02" => Ok(Operation::Append),
            "move" | "3" | "\u{3}" | "\\x03" => Ok(Operation::Move),
            _ => Err(self.expected(id, "add, remove, append or move as operation", name)),
        }
    }

    fn primitive(&self, id: Id, of: &str) -> Result<Form, LoadError> {
        let document = self.document;
        let kind = document.field(id, "type").ok_or_else(|| self.expected(id, "a primitive with a type", of))?;
        let dimensions =
            document.field(id, "dimensions").ok_or_else(|| self.expected(id, "a primitive with dimensions", of))?;
        let name = document.text(kind).unwrap_or_default().to_lowercase();
        let form = match name.as_str() {
            "box" | "1" => Form::Box(self.dimensions(dimensions, ["x", "y", "z"], of)?),
            "sphere" | "2" => Form::Sphere(self.dimensions(dimensions, ["radius"], of)?[0]),
            "cylinder" | "3" | "cone" | "4" => {
                let [height, radius] = self.dimensions(dimensions, ["height", "radius"], of)?;
                if matches!(name.as_str(), "cone" | "4") {
                    Form::Cone(radius, height)
                } else {
                    Form::Cylinder(radius, height)
                }
            }
            "prism" | "5" => {
                let error = LoadError::unsupported(format!("the prism of object {of:?}"));
                return Err(error.at(place(document.line(id))).with_hint("use a mesh"));
            }
            _ => return Err(self.expected(kind, "box, sphere, cylinder or cone as type", of)),
        };
        Ok(form)
    }

    /// Returns the first dimensions. Some messages have more than the primitive needs.
    fn dimensions<const N: usize>(&self, id: Id, names: [&str; N], of: &str) -> Result<[f64; N], LoadError> {
        match self.document.value(id) {
            Value::List(items) if items.len() > N => {
                let mut numbers = [0.0; N];
                for (number, &item) in numbers.iter_mut().zip(items) {
                    *number = self.number(item, "dimensions", of)?;
                }
                Ok(numbers)
            }
            _ => self.numbers(id, names, "dimensions", of),
        }
    }

    fn mesh(&self, id: Id, of: &str, count: &mut u64) -> Result<Form, LoadError> {
        let document = self.document;
        if let Some(resource) = document.field(id, "resource") {
            let uri = document.text(resource).filter(|uri| !uri.is_empty());
            let uri = uri.ok_or_else(|| self.expected(resource, "the name of a file as resource", of))?;
            let scale = match document.field(id, "dimensions").or_else(|| document.field(id, "scale")) {
                Some(scale) => self.numbers(scale, ["x", "y", "z"], "dimensions", of)?,
                None => [1.0; 3],
            };
            return Ok(Form::File(uri.to_owned(), scale));
        }
        let (vertices, triangles) = (self.list_of(id, "vertices", of)?, self.list_of(id, "triangles", of)?);
        if vertices.is_empty() {
            return Err(self.expected(id, "a mesh with a resource, or with vertices and triangles", of));
        }
        self.count(id, count, vertices.len() + triangles.len())?;
        let point = |&vertex: &Id| self.numbers(vertex, ["x", "y", "z"], "vertices", of);
        let face = |&triangle: &Id| {
            let corners = document.field(triangle, "vertex_indices").unwrap_or(triangle);
            let corners = self.numbers(corners, ["0", "1", "2"], "triangles", of)?;
            if corners.iter().any(|&corner| corner.fract() != 0.0 || !(0.0..vertices.len() as f64).contains(&corner)) {
                return Err(self.expected(triangle, &format!("indices of {} vertices", vertices.len()), of));
            }
            Ok(corners.map(|corner| corner as u32))
        };
        let positions = Positions::F64(vertices.iter().map(point).collect::<Result<_, _>>()?);
        Ok(Form::Mesh(positions, triangles.iter().map(face).collect::<Result<_, _>>()?))
    }

    fn refuse_octomap(&self, world: Id) -> Result<(), LoadError> {
        let field = |map: Id, key: &str| self.document.field(map, key);
        let Some(data) = field(world, "octomap").and_then(|map| field(field(map, "octomap")?, "data")) else {
            return Ok(());
        };
        let is_empty = matches!(self.document.value(data), Value::List(items) if items.is_empty());
        if is_empty { Ok(()) } else { Err(LoadError::unsupported("an octomap").at(place(self.document.line(data)))) }
    }

    /// Returns the frames that the scene places.
    fn transforms(&self, root: Id, notes: &mut Notes<'_>) -> Result<Vec<Transform>, LoadError> {
        let mut transforms = Vec::new();
        for &id in self.list_of(root, "fixed_frame_transforms", "")? {
            let child = self.document.field(id, "child_frame_id").and_then(|id| self.document.text(id));
            match (child, self.document.field(id, "transform")) {
                (Some(child), Some(pose)) => {
                    let scene_from_child = self.pose(pose, "")?;
                    transforms.push(Transform { child: child.to_owned(), scene_from_child });
                }
                _ => notes
                    .add(|| place(self.document.line(id)), "a transform without a child_frame_id, skipped".to_owned()),
            }
        }
        Ok(transforms)
    }
}

/// Maximum difference of the length of a quaternion from 1. Files have quaternions of few digits;
/// a larger difference is a mistake.
const QUATERNION_TOLERANCE: f64 = 1e-2;

/// Returns the pose of a position and a quaternion (x, y, z, w), which is normalized. The
/// quaternion zero, which messages have by default, stands for no rotation.
pub(super) fn placed(position: [f64; 3], quaternion: [f64; 4]) -> Result<Pose, InputError> {
    if quaternion == [0.0; 4] {
        return Pose::from_translation(position);
    }
    let [x, y, z, w] = quaternion;
    let length = quaternion.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let scale = if (length - 1.0).abs() <= QUATERNION_TOLERANCE { length } else { 1.0 };
    Pose::from_quaternion_wxyz(position, [w, x, y, z].map(|entry| entry / scale))
}
