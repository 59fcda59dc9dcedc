//! YAML as nodes that know their lines.
//!
//! Aliases refer to the node of their anchor, so that a short file never becomes a large tree. A
//! reader that follows them must count what it reads.

use std::{borrow::Cow, collections::HashMap};

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::place;
use crate::error::LoadError;

/// Index of a node.
pub(super) type Id = usize;

/// Maximum depth of lists and mappings in each other. A scene has about 10 levels.
const MAX_DEPTH: usize = 64;

/// A node.
pub(super) enum Value {
    /// A text, and whether it has no quotes. Numbers and null have none.
    Scalar(String, bool),
    List(Vec<Id>),
    /// Keys and values.
    Map(Vec<(Id, Id)>),
}

/// The first document of a file.
pub(super) struct Document {
    nodes: Vec<(Value, usize)>,
    pub(super) root: Option<Id>,
    /// Whether other documents follow.
    pub(super) has_more: bool,
}

/// A list or a mapping that is not complete.
struct Open {
    id: Id,
    key: Option<Id>,
}

impl Document {
    /// Parses the first document of a text.
    pub(super) fn parse(text: &str) -> Result<Self, LoadError> {
        let mut document = Self { nodes: Vec::new(), root: None, has_more: false };
        let mut open: Vec<Open> = Vec::new();
        let mut anchors: HashMap<usize, Id> = HashMap::new();
        let mut documents = 0;
        let mut parser = Parser::new_from_str(text);
        while let Some(event) = parser.next_event() {
            let (event, span) =
                event.map_err(|error| LoadError::refused("YAML", &error.info()).at(place(error.marker().line())))?;
            let line = span.start.line();
            let (value, anchor) = match event {
                Event::DocumentStart(_) => {
                    documents += 1;
                    continue;
                }
                Event::StreamEnd => break,
                Event::SequenceEnd | Event::MappingEnd => {
                    open.pop();
                    continue;
                }
                Event::Nothing | Event::StreamStart | Event::DocumentEnd => continue,
                // The end of a document may be written like the start of another.
                Event::Scalar(text, ScalarStyle::Plain, ..) if documents > 1 && is_null(&text) => continue,
                _ if documents > 1 => {
                    document.has_more = true;
                    break;
                }
                Event::Alias(anchor) => {
                    let id = *anchors
                        .get(&anchor)
                        .ok_or_else(|| LoadError::syntax("an anchor before its alias", b"").at(place(line)))?;
                    document.attach(open.last_mut(), id);
                    continue;
                }
                Event::Scalar(text, style, anchor, _) => {
                    (Value::Scalar(Cow::into_owned(text), style == ScalarStyle::Plain), anchor)
                }
                Event::SequenceStart(anchor, _) => (Value::List(Vec::new()), anchor),
                Event::MappingStart(anchor, _) => (Value::Map(Vec::new()), anchor),
            };
            let id = document.nodes.len();
            let is_open = !matches!(value, Value::Scalar(..));
            document.nodes.push((value, line));
            if anchor != 0 {
                anchors.insert(anchor, id);
            }
            document.attach(open.last_mut(), id);
            if is_open {
                if open.len() == MAX_DEPTH {
                    let expected = format!("at most {MAX_DEPTH} lists and mappings in each other");
                    return Err(LoadError::syntax(expected, b"one more").at(place(line)));
                }
                open.push(Open { id, key: None });
            }
        }
        Ok(document)
    }

    /// Adds a node to the list or mapping around it, or makes it the root.
    fn attach(&mut self, around: Option<&mut Open>, id: Id) {
        let Some(around) = around else {
            self.root.get_or_insert(id);
            return;
        };
        match &mut self.nodes[around.id].0 {
            Value::List(items) => items.push(id),
            Value::Map(pairs) => match around.key.take() {
                Some(key) => pairs.push((key, id)),
                None => around.key = Some(id),
            },
            Value::Scalar(..) => {}
        }
    }

    pub(super) fn value(&self, id: Id) -> &Value {
        &self.nodes[id].0
    }

    /// Returns the line in which a node starts.
    pub(super) fn line(&self, id: Id) -> usize {
        self.nodes[id].1
    }

    /// Returns the value of a key of a mapping. Null counts as absent.
    pub(super) fn field(&self, map: Id, key: &str) -> Option<Id> {
        let Value::Map(pairs) = self.value(map) else { return None };
        let is_key = |id: Id| matches!(self.value(id), Value::Scalar(text, _) if text == key);
        pairs.iter().find(|(known, _)| is_key(*known)).map(|(_, id)| *id).filter(|&id| !self.is_null(id))
    }

    fn is_null(&self, id: Id) -> bool {
        matches!(self.value(id), Value::Scalar(text, true) if is_null(text))
    }

    /// Returns a text, also that of a number.
    pub(super) fn text(&self, id: Id) -> Option<&str> {
        match self.value(id) {
            Value::Scalar(text, _) => Some(text.trim()),
            _ => None,
        }
    }

    /// Returns what is written at a node, for errors.
    pub(super) fn shown(&self, id: Id) -> &str {
        match self.value(id) {
            Value::Scalar(text, _) => text,
            Value::List(_) => "a list",
            Value::Map(_) => "a mapping",
        }
    }
}

/// Reports whether a text without quotes stands for nothing.
fn is_null(text: &str) -> bool {
    ["", "~", "null", "Null", "NULL"].contains(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_have_lines_and_aliases_share_them() {
        let text = "a: &x [1, 2]\nb:\n  - c: *x\n  - 'null'\n  - null\n";
        let document = Document::parse(text).unwrap();
        let root = document.root.unwrap();
        let a = document.field(root, "a").unwrap();
        let b = document.field(root, "b").unwrap();
        let Value::List(items) = document.value(b) else { panic!("b is a list") };
        assert_eq!(document.field(items[0], "c"), Some(a));
        assert_eq!((document.line(a), document.line(items[0]), document.text(items[1])), (1, 3, Some("null")));
        assert!(!document.is_null(items[1]) && document.is_null(items[2]) && !document.has_more);
        assert!(Document::parse("a: 1\n---\nb: 2\n").unwrap().has_more);
        assert!(!Document::parse("a: 1\n---\n").unwrap().has_more);
    }

    #[test]
    fn faults_have_lines() {
        let fault = |text: &str| Document::parse(text).err().unwrap().to_string();
        assert!(fault("a: 1\nb: [1, 2\n").starts_with("line "), "{}", fault("a: 1\nb: [1, 2\n"));
        assert!(fault(&"[".repeat(100)).contains("at most 64 lists"));
        assert!(fault("a: *missing\n").starts_with("line 1: "));
    }
}
