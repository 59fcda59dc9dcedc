//! Writes XML.

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

/// A document that is being written.
pub(super) type Document = Writer<Vec<u8>>;

/// Returns a document with one root element: its name, its attributes and its content.
pub(super) fn document(
    name: &str,
    attributes: &[(&str, &str)],
    content: impl FnOnce(&mut Document) -> io::Result<()>,
) -> io::Result<Vec<u8>> {
    rooted(|document| element(document, name, attributes, content))
}

/// Returns a document with an empty root element.
pub(super) fn empty_document(name: &str, attributes: &[(&str, &str)]) -> io::Result<Vec<u8>> {
    rooted(|document| empty(document, name, attributes))
}

fn rooted(root: impl FnOnce(&mut Document) -> io::Result<()>) -> io::Result<Vec<u8>> {
    let mut document = Writer::new_with_indent(Vec::new(), b' ', 2);
    document.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    root(&mut document)?;
    Ok(document.into_inner())
}

/// Writes an element with attributes and content.
pub(super) fn element(
    document: &mut Document,
    name: &str,
    attributes: &[(&str, &str)],
    content: impl FnOnce(&mut Document) -> io::Result<()>,
) -> io::Result<()> {
    let attributes: Vec<(&str, String)> = attributes.iter().map(|&(name, value)| (name, valid(value))).collect();
    let attributes = attributes.iter().map(|(name, value)| (*name, value.as_str()));
    document.create_element(name).with_attributes(attributes).write_inner_content(content)?;
    Ok(())
}

/// Writes an empty element with attributes.
pub(super) fn empty(document: &mut Document, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    document.create_element(name).with_attributes(attributes.iter().copied()).write_empty()?;
    Ok(())
}

/// Writes an element with a text.
pub(super) fn text(document: &mut Document, name: &str, text: &str) -> io::Result<()> {
    document.create_element(name).write_text_content(BytesText::new(&valid(text)))?;
    Ok(())
}

/// Writes an element with the children `X`, `Y` and `Z`.
pub(super) fn vector(document: &mut Document, name: &str, vector: [f64; 3]) -> io::Result<()> {
    element(document, name, &[], |document| {
        ["X", "Y", "Z"].iter().zip(vector).try_for_each(|(axis, value)| text(document, axis, &value.to_string()))
    })
}

/// Returns a text without the characters that XML cannot have.
fn valid(text: &str) -> String {
    let is_valid = |letter: &char| matches!(letter, '\t' | '\n' | '\r' | '\u{20}'..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
    text.chars().filter(is_valid).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_attributes_are_escaped_and_valid() {
        let bytes = document("A", &[("b", "<\u{1}\"&>")], |document| text(document, "C", "1 < 2\u{0} & 3")).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(
            text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<A b=\"&lt;&quot;&amp;&gt;\">"),
            "{text}"
        );
        assert!(text.contains("<C>1 &lt; 2 &amp; 3</C>"), "{text}");
    }
}
