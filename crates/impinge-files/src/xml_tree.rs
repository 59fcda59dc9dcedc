//! The elements of an XML document: a flat list of their places in the text, in the order of the
//! text.

use std::{borrow::Cow, collections::HashMap, fmt::Display};

use quick_xml::{Reader, events::Event};

use crate::{
    error::{LoadError, Place},
    text::{integer, line_at, number},
    xml::{attributes_of_tag, ill_formed},
};

/// The index of an element.
pub(crate) type Id = usize;

pub(crate) struct Tree<'a> {
    text: &'a str,
    elements: Vec<Element>,
    by_id: HashMap<Cow<'a, str>, Id>,
}

/// Byte offsets of an element in the text.
struct Element {
    start: usize,
    name_end: usize,
    /// End of the start tag.
    tag_end: usize,
    /// Start of the end tag, or `tag_end` if the element has no end tag.
    content_end: usize,
    /// End of the end tag, or `tag_end` if the element has no end tag.
    end: usize,
    /// Index of the first element after this one and everything in it.
    next: Id,
}

impl<'a> Tree<'a> {
    pub(crate) fn parse(text: &'a str) -> Result<Self, LoadError> {
        let mut tree = Self { text, elements: Vec::new(), by_id: HashMap::new() };
        let mut reader = Reader::from_str(text);
        reader.config_mut().allow_dangling_amp = true;
        let mut open = Vec::new();
        loop {
            let start = reader.buffer_position() as usize;
            let event = reader.read_event().map_err(|e| {
                let place = tree.line(reader.error_position() as usize);
                ill_formed(&e).at(place)
            })?;
            let tag_end = reader.buffer_position() as usize;
            match event {
                Event::Start(tag) => {
                    open.push(tree.elements.len());
                    tree.push(start, tag.name().into_inner().len(), tag_end);
                }
                Event::Empty(tag) => tree.push(start, tag.name().into_inner().len(), tag_end),
                Event::End(_) => {
                    if let Some(id) = open.pop() {
                        tree.elements[id].content_end = start;
                        tree.elements[id].end = tag_end;
                        tree.elements[id].next = tree.elements.len();
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        match open.last() {
            Some(&id) => {
                let end = format!("the end of the XML element {}", tree.name(id));
                Err(LoadError::syntax(end, b"").at(tree.place(id)).with_hint("the file is cut off"))
            }
            None => Ok(tree),
        }
    }

    fn push(&mut self, start: usize, name_len: usize, tag_end: usize) {
        let id = self.elements.len();
        let name_end = start + 1 + name_len;
        self.elements.push(Element { start, name_end, tag_end, content_end: tag_end, end: tag_end, next: id + 1 });
        if let Some(name) = self.attribute(id, "id") {
            self.by_id.entry(name).or_insert(id);
        }
    }

    /// Returns the root element, or `None` if there are no elements.
    pub(crate) fn root(&self) -> Option<Id> {
        (!self.elements.is_empty()).then_some(0)
    }

    /// Returns the name of an element without its prefix.
    pub(crate) fn name(&self, id: Id) -> &'a str {
        let element = &self.elements[id];
        let name = &self.text[element.start + 1..element.name_end];
        name.rsplit_once(':').map_or(name, |(_, local)| local)
    }

    /// Returns the prefix of the name of an element: `xacro` of `xacro:macro`.
    pub(crate) fn prefix(&self, id: Id) -> Option<&'a str> {
        let element = &self.elements[id];
        self.text[element.start + 1..element.name_end].rsplit_once(':').map(|(prefix, _)| prefix)
    }

    /// Returns the value of an attribute, or `None` if it is missing.
    pub(crate) fn attribute(&self, id: Id, name: &str) -> Option<Cow<'a, str>> {
        let element = &self.elements[id];
        let tag = &self.text[element.start + 1..element.tag_end - 1];
        let tag = tag.strip_suffix('/').unwrap_or(tag);
        attributes_of_tag(tag, element.name_end - element.start - 1).find(|(key, _)| *key == name).map(|(_, v)| v)
    }

    /// Returns the attribute `name`, or else `id`; empty text if both are missing.
    pub(crate) fn title(&self, id: Id) -> String {
        let title = self.attribute(id, "name").filter(|name| !name.is_empty()).or_else(|| self.attribute(id, "id"));
        crate::text::name(title.unwrap_or_default().as_bytes())
    }

    /// Returns the child elements of an element.
    pub(crate) fn children(&self, id: Id) -> impl Iterator<Item = Id> {
        let end = self.elements[id].next;
        let first = (id + 1 < end).then_some(id + 1);
        std::iter::successors(first, move |&child| Some(self.elements[child].next).filter(|&next| next < end))
    }

    /// Returns the child elements of this name.
    pub(crate) fn children_named(&self, id: Id, name: &str) -> impl Iterator<Item = Id> {
        self.children(id).filter(move |&child| self.name(child) == name)
    }

    /// Returns the first child element of this name, or `None`.
    pub(crate) fn child(&self, id: Id, name: &str) -> Option<Id> {
        self.children_named(id, name).next()
    }

    /// Returns the text of an element, without the text of its child elements.
    pub(crate) fn text(&self, id: Id) -> Cow<'a, str> {
        let element = &self.elements[id];
        let content = &self.text[element.tag_end..element.content_end];
        if memchr::memchr(b'<', content.as_bytes()).is_none() {
            return Cow::Borrowed(content);
        }
        let mut text = String::new();
        let mut start = element.tag_end;
        for child in self.children(id).map(|child| &self.elements[child]) {
            add_text(&self.text[start..child.start], &mut text);
            start = child.end;
        }
        add_text(&self.text[start..element.content_end], &mut text);
        Cow::Owned(text)
    }

    /// Calls `visit` with each number in the text of an element.
    pub(crate) fn each_number<T>(
        &self,
        id: Id,
        kind: Numbers<T>,
        mut visit: impl FnMut(T) -> Result<(), LoadError>,
    ) -> Result<(), LoadError> {
        let text = self.text(id);
        for token in text.split_ascii_whitespace() {
            let value = (kind.parse)(token.as_bytes())
                .ok_or_else(|| LoadError::syntax(kind.expected, token.as_bytes()))
                .and_then(&mut visit);
            value.map_err(|e| e.at(self.place_of(id, token)))?;
        }
        Ok(())
    }

    /// Returns all decimal numbers in the text of an element.
    pub(crate) fn floats(&self, id: Id) -> Result<Vec<f64>, LoadError> {
        let mut values = Vec::new();
        self.each_number(id, FLOATS, |x| {
            values.push(x);
            Ok(())
        })?;
        Ok(values)
    }

    /// Returns the numbers in the text of an element. Returns an error unless there are exactly
    /// `N`, all finite.
    pub(crate) fn array<const N: usize>(&self, id: Id) -> Result<[f64; N], LoadError> {
        let values = self.floats(id)?;
        match values.as_slice().try_into() {
            Ok(array) if values.iter().all(|x| x.is_finite()) => Ok(array),
            _ => {
                let found = format!("{} numbers, or infinite ones", values.len());
                let expected = format!("{N} finite numbers in the element {}", self.name(id));
                Err(LoadError::syntax(expected, found.as_bytes()).at(self.place(id)))
            }
        }
    }

    /// Returns the whole number in an attribute, or `default` if the attribute is missing.
    pub(crate) fn count(&self, id: Id, attribute: &str, default: usize) -> Result<usize, LoadError> {
        let Some(value) = self.attribute(id, attribute) else { return Ok(default) };
        integer(value.trim().as_bytes()).and_then(|n| usize::try_from(n).ok()).ok_or_else(|| {
            let expected = format!("a whole number as {attribute} of the element {}", self.name(id));
            LoadError::syntax(expected, value.as_bytes()).at(self.place(id))
        })
    }

    /// Returns the element that an attribute refers to, as `#id`.
    pub(crate) fn target(&self, id: Id, attribute: &str) -> Result<Id, LoadError> {
        let missing = |expected: &dyn Display| LoadError::syntax(expected.to_string(), b"").at(self.place(id));
        let Some(url) = self.attribute(id, attribute) else {
            return Err(missing(&format!("the attribute {attribute} of the element {}", self.name(id))));
        };
        let url = url.trim();
        let name = url.strip_prefix('#').unwrap_or(url);
        let decoded = percent_encoding::percent_decode_str(name).decode_utf8_lossy();
        if let Some(&target) = self.by_id.get(name).or_else(|| self.by_id.get(&*decoded)) {
            return Ok(target);
        }
        if url.starts_with('#') {
            return Err(missing(&format!("an element with the id {name:?}")));
        }
        Err(LoadError::unsupported(format!("the file {url:?} beside it")).at(self.place(id)))
    }

    /// Returns the line in which an element starts.
    pub(crate) fn place(&self, id: Id) -> Place {
        self.line(self.elements[id].start)
    }

    /// Returns the line of a token, or the line of its element if the token is in a copy of the
    /// text.
    fn place_of(&self, id: Id, token: &str) -> Place {
        let offset = (token.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        self.line(if offset < self.text.len() { offset } else { self.elements[id].start })
    }

    fn line(&self, offset: usize) -> Place {
        Place::Line(line_at(self.text.as_bytes(), offset))
    }
}

/// Appends the text and the CDATA sections of XML without elements, which is well-formed.
fn add_text(xml: &str, text: &mut String) {
    let mut reader = Reader::from_str(xml);
    reader.config_mut().allow_dangling_amp = true;
    loop {
        match reader.read_event() {
            Ok(Event::Text(piece)) => text.push_str(&piece),
            Ok(Event::CData(piece)) => text.push_str(&piece),
            Ok(Event::Eof) | Err(_) => return,
            Ok(_) => {}
        }
    }
}

/// A parser for the numbers of an element.
#[derive(Clone, Copy)]
pub(crate) struct Numbers<T> {
    parse: fn(&[u8]) -> Option<T>,
    expected: &'static str,
}

/// Decimal numbers.
const FLOATS: Numbers<f64> = Numbers { parse: number, expected: "a number" };

/// Whole numbers.
pub(crate) const INTEGERS: Numbers<i64> = Numbers { parse: integer, expected: "a whole number" };

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_know_their_children_and_text() {
        let text =
            "<?xml version=\"1.0\"?><a id='x'><b:c n='1 &amp; 2'/>\n<d>1 <!-- 9 -->2<e>3</e><![CDATA[ 4]]></d><c/></a>";
        let tree = Tree::parse(text).unwrap();
        let root = tree.root().unwrap();
        let names: Vec<_> = tree.children(root).map(|id| tree.name(id)).collect();
        assert_eq!(names, ["c", "d", "c"]);
        assert_eq!(tree.attribute(tree.child(root, "c").unwrap(), "n").unwrap(), "1 & 2");
        let d = tree.child(root, "d").unwrap();
        assert_eq!(tree.floats(d).unwrap(), [1.0, 2.0, 4.0]);
        assert_eq!(tree.place(d), Place::Line(2));
        assert_eq!(tree.children_named(root, "c").count(), 2);
        assert_eq!(tree.children(d).count(), 1);
        assert_eq!((tree.title(root).as_str(), tree.title(d).as_str()), ("x", ""));
    }

    #[test]
    fn errors_name_the_line() {
        let error = |text: &str| Tree::parse(text).err().unwrap().to_string();
        assert_eq!(
            error("<a>\n<b>\n"),
            "line 2: expected the end of the XML element b, found nothing (the file is cut off)"
        );
        assert!(error("<a>\n</b>").starts_with("line 2: expected well-formed XML"));
        let tree = Tree::parse("<a u='#b' v='c.dae#d'>1\n2\nx</a>").unwrap();
        assert_eq!(tree.floats(0).unwrap_err().to_string(), "line 3: expected a number, found \"x\"");
        assert_eq!(
            tree.target(0, "u").unwrap_err().to_string(),
            "line 1: expected an element with the id \"b\", found nothing"
        );
        assert!(tree.target(0, "v").unwrap_err().to_string().contains("the file \"c.dae#d\" beside it"));
        assert!(tree.target(0, "w").unwrap_err().to_string().contains("the attribute w of the element a"));
    }

    #[test]
    fn entities_are_not_expanded() {
        let text = "<!DOCTYPE a [<!ENTITY x \"1 1 1 1\"><!ENTITY y \"&x;&x;\">]><a>&y;</a>";
        assert!(Tree::parse(text).unwrap().floats(0).is_err());
    }
}
