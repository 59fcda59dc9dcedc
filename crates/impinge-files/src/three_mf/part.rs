//! Reads a model part of a 3MF package: objects with a mesh or components, and the items of the
//! build.

use std::collections::HashMap;

use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};

use crate::{
    error::{LoadError, LoadErrorKind},
    instance::Affine,
    text::{name, number},
    unit::Unit,
    xml::{attributes, ill_formed, refuse_repeated_attributes},
};

use super::in_part;

/// Extensions that are supported or do not affect the triangles. Beams and balls of lattices are
/// counted.
const KNOWN_EXTENSIONS: [&str; 7] = [
    "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02",
    "http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/production/alternatives/2021/04",
    "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
];

/// Maximum number of prefixes in `requiredextensions`. Real files require fewer than ten. Without a
/// limit, a file could repeat a prefix any number of times.
const MAX_REQUIRED: u64 = 1024;

pub(super) struct Part {
    pub(super) unit: Unit,
    pub(super) objects: HashMap<u32, Object>,
    pub(super) items: Vec<Reference>,
}

#[derive(Default)]
pub(super) struct Object {
    pub(super) name: String,
    pub(super) positions: Vec<[f64; 3]>,
    /// Triangles, whose corners exist.
    pub(super) faces: Vec<[u32; 3]>,
    pub(super) components: Vec<Reference>,
    /// Number of beams and balls of the object's lattice, which are not loaded.
    pub(super) beams: u64,
}

/// A component or an item: an object, and the map that places it.
pub(super) struct Reference {
    /// Path of the part that contains the object, until it is replaced by the index; `None` for the
    /// same part.
    pub(super) path: Option<Box<str>>,
    /// Index of the part that contains the object; `None` for the same part.
    pub(super) part: Option<usize>,
    pub(super) object: u32,
    pub(super) map: Affine,
}

/// The elements that are read. All other elements, and everything in them, are skipped.
#[derive(Clone, Copy, PartialEq)]
enum Tag {
    Model,
    Resources,
    Object,
    Mesh,
    Vertices,
    Vertex,
    Triangles,
    Triangle,
    Components,
    Component,
    BeamLattice,
    Beams,
    Beam,
    Build,
    Item,
    Other,
}

impl Tag {
    /// Returns the tag of an element by its name without the prefix of the core specification.
    /// `local` is the name without any prefix, for elements of extensions.
    fn of(parent: Option<Self>, name: &str, local: &str) -> Self {
        match (parent, local) {
            (Some(Self::Mesh), "beamlattice") => return Self::BeamLattice,
            (Some(Self::BeamLattice), "beams" | "balls") => return Self::Beams,
            (Some(Self::Beams), "beam" | "ball") => return Self::Beam,
            _ => {}
        }
        match (parent, name) {
            (None, "model") => Self::Model,
            (Some(Self::Model), "resources") => Self::Resources,
            (Some(Self::Resources), "object") => Self::Object,
            (Some(Self::Object), "mesh") => Self::Mesh,
            (Some(Self::Mesh), "vertices") => Self::Vertices,
            (Some(Self::Vertices), "vertex") => Self::Vertex,
            (Some(Self::Mesh), "triangles") => Self::Triangles,
            (Some(Self::Triangles), "triangle") => Self::Triangle,
            (Some(Self::Object), "components") => Self::Components,
            (Some(Self::Components), "component") => Self::Component,
            (Some(Self::Model), "build") => Self::Build,
            (Some(Self::Build), "item") => Self::Item,
            _ => Self::Other,
        }
    }
}

impl Part {
    pub(super) fn read(text: &str, path: &str) -> Result<Self, LoadError> {
        let mut reader = Reader::from_str(text);
        let mut part = PartReader::default();
        let mut open = Vec::new();
        loop {
            let at = reader.buffer_position();
            let event = reader.read_event().map_err(|e| ill_formed(&e).at(in_part(path, reader.error_position())))?;
            match event {
                Event::Start(element) => {
                    let tag = part.enter(&element, open.last().copied()).map_err(|e| e.at(in_part(path, at)))?;
                    open.push(tag);
                }
                Event::Empty(element) => {
                    let tag = part.enter(&element, open.last().copied()).map_err(|e| e.at(in_part(path, at)))?;
                    part.leave(tag);
                }
                Event::End(_) => {
                    if let Some(tag) = open.pop() {
                        part.leave(tag);
                    }
                }
                Event::Eof if open.is_empty() => break,
                Event::Eof => {
                    let error =
                        LoadError::syntax("the end of the XML element model", b"").with_hint("the file is cut off");
                    return Err(error.at(in_part(path, at)));
                }
                _ => {}
            }
        }
        match part.unit {
            Some(unit) => Ok(Self { unit, objects: part.objects, items: part.items }),
            None => Err(LoadError::syntax("the XML element model", b"").at(in_part(path, 0))),
        }
    }
}

#[derive(Default)]
struct PartReader {
    /// Unit of the model; `None` before the element `model`.
    unit: Option<Unit>,
    /// Prefix of names of the core specification, with its colon; may be empty.
    prefix: String,
    objects: HashMap<u32, Object>,
    items: Vec<Reference>,
    id: u32,
    object: Object,
}

impl PartReader {
    fn enter(&mut self, element: &BytesStart<'_>, parent: Option<Tag>) -> Result<Tag, LoadError> {
        let full = element.name().into_inner();
        let local = element.local_name().into_inner();
        let name = match parent {
            None => local,
            Some(_) => full.strip_prefix(self.prefix.as_str()).unwrap_or_default(),
        };
        let tag = Tag::of(parent, name, local);
        if tag != Tag::Other {
            refuse_repeated_attributes(element)?;
        }
        match tag {
            Tag::Model => {
                self.prefix = full.strip_suffix(name).unwrap_or_default().to_owned();
                self.unit = Some(read_unit(element)?);
                check_extensions(element)?;
            }
            Tag::Object => self.begin_object(element)?,
            Tag::Vertex => self.object.positions.push(read_vertex(element, self.object.positions.len())?),
            Tag::Triangle => {
                let face = read_triangle(element, &self.object)?;
                self.object.faces.push(face);
            }
            Tag::Component => self.object.components.push(read_reference(element)?),
            Tag::Item => self.items.push(read_reference(element)?),
            Tag::Beam => self.object.beams += 1,
            _ => {}
        }
        Ok(tag)
    }

    fn leave(&mut self, tag: Tag) {
        if tag == Tag::Object {
            self.objects.insert(self.id, std::mem::take(&mut self.object));
        }
    }

    fn begin_object(&mut self, element: &BytesStart<'_>) -> Result<(), LoadError> {
        let mut id = None;
        for (key, value) in attributes(element) {
            match key {
                "id" => id = Some(read_id(&value)?),
                "name" => self.object.name = name(value.as_bytes()),
                _ => {}
            }
        }
        self.id = id.ok_or_else(|| LoadError::syntax("the id of an object", b""))?;
        if self.objects.contains_key(&self.id) {
            return Err(LoadError::syntax("a new id", format!("object {} again", self.id).as_bytes()));
        }
        Ok(())
    }
}

fn read_unit(model: &BytesStart<'_>) -> Result<Unit, LoadError> {
    match attributes(model).find(|(key, _)| *key == "unit") {
        // Default of the specification.
        None => Ok(Unit::Millimeter),
        Some((_, value)) => {
            Unit::from_3mf(value.trim()).ok_or_else(|| LoadError::syntax("a unit of 3MF", value.as_bytes()))
        }
    }
}

fn check_extensions(model: &BytesStart<'_>) -> Result<(), LoadError> {
    let Some((_, prefixes)) = attributes(model).find(|(key, _)| *key == "requiredextensions") else { return Ok(()) };
    let count = prefixes.split_whitespace().count() as u64;
    if count > MAX_REQUIRED {
        let kind = LoadErrorKind::TooMany { what: "required extensions", count, limit: MAX_REQUIRED };
        return Err(LoadError::new(kind).with_hint("remove repeated prefixes from requiredextensions"));
    }
    let namespaces: HashMap<&str, _> =
        attributes(model).filter_map(|(key, uri)| Some((key.strip_prefix("xmlns:")?, uri))).collect();
    for prefix in prefixes.split_whitespace() {
        match namespaces.get(prefix) {
            Some(uri) if KNOWN_EXTENSIONS.contains(&uri.trim()) => {}
            Some(uri) => return Err(LoadError::unsupported(format!("3MF extension {}", uri.trim()))),
            None => return Err(LoadError::unsupported(format!("3MF extension {prefix:?}"))),
        }
    }
    Ok(())
}

fn read_vertex(element: &BytesStart<'_>, vertex: usize) -> Result<[f64; 3], LoadError> {
    let mut position = [None; 3];
    for (key, value) in attributes(element) {
        if let Some(k) = ["x", "y", "z"].iter().position(|&name| name == key) {
            let x = number(value.trim().as_bytes());
            position[k] = Some(x.ok_or_else(|| LoadError::syntax("a coordinate", value.as_bytes()))?);
        }
    }
    let [Some(x), Some(y), Some(z)] = position else {
        return Err(LoadError::syntax("x, y and z of a vertex", b""));
    };
    if [x, y, z].iter().all(|x| x.is_finite()) {
        Ok([x, y, z])
    } else {
        Err(LoadError::new(LoadErrorKind::NonFinite { vertex: vertex as u64 }))
    }
}

fn read_triangle(element: &BytesStart<'_>, object: &Object) -> Result<[u32; 3], LoadError> {
    let mut face = [None; 3];
    for (key, value) in attributes(element) {
        if let Some(k) = ["v1", "v2", "v3"].iter().position(|&name| name == key) {
            let index = crate::text::integer(value.trim().as_bytes())
                .ok_or_else(|| LoadError::syntax("a vertex index", value.as_bytes()))?;
            let vertex = u32::try_from(index).ok().filter(|&v| (v as usize) < object.positions.len());
            face[k] = Some(vertex.ok_or_else(|| {
                let (face, len) = (object.faces.len() as u64, object.positions.len() as u64);
                LoadError::new(LoadErrorKind::IndexOutOfBounds { face, index, len })
            })?);
        }
    }
    match face {
        [Some(a), Some(b), Some(c)] => Ok([a, b, c]),
        _ => Err(LoadError::syntax("v1, v2 and v3 of a triangle", b"")),
    }
}

fn read_reference(element: &BytesStart<'_>) -> Result<Reference, LoadError> {
    let (mut object, mut path, mut map) = (None, None, Affine::IDENTITY);
    for (key, value) in attributes(element) {
        match key {
            "objectid" => object = Some(read_id(&value)?),
            "transform" => map = read_transform(&value)?,
            // An attribute of the production extension, with any prefix.
            _ if key.ends_with(":path") => path = Some(Box::from(value)),
            _ => {}
        }
    }
    match object {
        Some(object) => Ok(Reference { path, part: None, object, map }),
        None => Err(LoadError::syntax("the objectid of an item or component", b"")),
    }
}

fn read_id(value: &str) -> Result<u32, LoadError> {
    value.trim().parse().map_err(|_| LoadError::syntax("the id of an object", value.as_bytes()))
}

/// Parses a transform: twelve numbers, which are a 4x3 matrix by rows, for row vectors.
fn read_transform(value: &str) -> Result<Affine, LoadError> {
    let numbers: Option<Vec<f64>> =
        value.split_whitespace().take(13).map(|t| number(t.as_bytes()).filter(|x| x.is_finite())).collect();
    match numbers.as_deref() {
        Some(m) if m.len() == 12 => Ok(Affine { rows: [0, 1, 2].map(|i| [m[i], m[3 + i], m[6 + i], m[9 + i]]) }),
        _ => Err(LoadError::syntax("a transform of 12 numbers", value.as_bytes())),
    }
}
