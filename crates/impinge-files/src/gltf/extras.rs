//! The `extras` of nodes: any JSON that a program stored with them.

use serde::Deserialize;
use serde_json::value::RawValue;

use crate::properties::{Properties, text};

#[derive(Deserialize, Default)]
struct Document<'a> {
    #[serde(default, borrow)]
    nodes: Vec<Node<'a>>,
}

#[derive(Deserialize)]
struct Node<'a> {
    #[serde(borrow)]
    extras: Option<&'a RawValue>,
}

/// The extras of the nodes of a document.
pub(super) struct Extras<'a>(Document<'a>);

impl<'a> Extras<'a> {
    /// Reads the extras of a document that was read before.
    pub(super) fn read(json: &'a [u8]) -> Self {
        Self(serde_json::from_slice(crate::text::without_bom(json)).unwrap_or_default())
    }

    /// Returns the extras of a node as names with texts. A value that is not an object has the name
    /// `extras`.
    pub(super) fn of_node(&self, node: usize) -> Vec<(String, String)> {
        let Some(json) = self.0.nodes.get(node).and_then(|node| node.extras) else { return Vec::new() };
        match serde_json::from_str::<Properties>(json.get()) {
            Ok(properties) => properties.0,
            Err(_) => vec![("extras".to_owned(), text(json))],
        }
    }
}
