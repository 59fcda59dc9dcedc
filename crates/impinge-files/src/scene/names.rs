//! A file of names: keys, types and names of the nodes of another file, in JSON.

use std::collections::{HashMap, HashSet};

use serde::Deserialize;

use super::SceneOptions;
use crate::{
    error::{LoadError, Place},
    model::{Warning, WarningKind},
    properties::Properties,
    regular_file::read_regular_file,
    scene_draft::PartDraft,
    text::{name, without_bom},
};

#[derive(Deserialize)]
struct File {
    elements: Vec<Properties>,
}

/// The elements of a file of names.
#[derive(Default)]
pub(super) struct Names {
    elements: Vec<Element>,
    /// Index of the first element of each node.
    of_node: HashMap<String, usize>,
}

/// An entry of a file of names: key, type, name and further properties of a node.
pub(super) struct Element {
    node: String,
    pub(super) key: Option<String>,
    pub(super) kind: Option<String>,
    pub(super) name: Option<String>,
    pub(super) extras: Vec<(String, String)>,
}

impl Names {
    /// Reads the file of names of the options. Without one there are no names.
    pub(super) fn of(options: &SceneOptions) -> Result<Self, LoadError> {
        let Some(path) = &options.names else { return Ok(Self::default()) };
        let bytes = read_regular_file(path, &options.limits)?;
        Self::parse(&bytes).map_err(|e| e.in_file(path))
    }

    fn parse(bytes: &[u8]) -> Result<Self, LoadError> {
        let file: File = serde_json::from_slice(without_bom(bytes)).map_err(|e| {
            let error = LoadError::refused("a JSON object with a list of elements", &e);
            error.at(Place::Line(e.line() as u64))
        })?;
        let mut names = Self::default();
        for (number, mut fields) in file.elements.into_iter().enumerate() {
            let Some(node) = fields.take(&["node"]) else {
                let error = LoadError::syntax("the name of a node, as the field node", b"");
                return Err(error.at(Place::Entry(format!("element {number}"))));
            };
            let node = name(node.as_bytes());
            names.of_node.entry(node.clone()).or_insert(number);
            let [key, kind, name] = ["guid", "type", "name"].map(|field| fields.take(&[field]));
            names.elements.push(Element { node, key, kind, name, extras: fields.0 });
        }
        Ok(names)
    }

    /// Returns the element of a part by its name in the file.
    pub(super) fn get(&self, title: &str) -> Option<&Element> {
        self.of_node.get(title).map(|&number| &self.elements[number])
    }

    /// Returns the warning about elements that name none of the parts.
    pub(super) fn unknown(&self, parts: &[PartDraft]) -> Warning {
        let titles: HashSet<&str> = parts.iter().map(|part| &*part.title).collect();
        let mut unknown = self.elements.iter().enumerate().filter(|(_, element)| !titles.contains(&*element.node));
        let first = unknown.next().map(|(number, _)| Place::Entry(format!("element {number} of the names")));
        let count = u64::from(first.is_some()) + unknown.count() as u64;
        Warning { kind: WarningKind::UnknownNames, count, first }
    }
}
