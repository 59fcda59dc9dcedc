//! XML for 3MF and COLLADA: text in any of their encodings, and attributes.
//!
//! Entities that a document defines are never expanded, so that a short file cannot expand to a
//! long one.

use std::borrow::Cow;

use quick_xml::{
    XmlVersion,
    events::{BytesStart, attributes::Attributes},
};

use crate::{error::LoadError, text::without_bom};

/// The encodings that a format allows for its XML.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Encoding {
    /// UTF-8 or UTF-16.
    Unicode,
    /// UTF-8, UTF-16, or else ISO 8859-1, in which every byte is a character.
    UnicodeOrLatin1,
}

/// Returns the text without its byte order marks. UTF-16 is recognized by its mark, or by a first
/// `<` of two bytes.
pub(crate) fn decode(bytes: Vec<u8>, encoding: Encoding) -> Result<String, LoadError> {
    let word: Option<fn([u8; 2]) -> u16> = match bytes.as_slice() {
        [0xFF, 0xFE, ..] | [b'<', 0, ..] => Some(u16::from_le_bytes),
        [0xFE, 0xFF, ..] | [0, b'<', ..] => Some(u16::from_be_bytes),
        _ => None,
    };
    if let Some(word) = word {
        let (pairs, odd) = bytes.as_chunks::<2>();
        if !odd.is_empty() {
            return Err(LoadError::syntax("UTF-16 text", b"an odd number of bytes").with_hint("the file is cut off"));
        }
        let words = pairs.iter().map(|&pair| word(pair)).skip_while(|&word| word == 0xFEFF);
        let text: Result<String, _> = char::decode_utf16(words).collect();
        return text.map_err(|e| LoadError::syntax("UTF-16 text", e.to_string().as_bytes()));
    }
    match String::from_utf8(bytes) {
        // A mark that is left would be skipped by the XML reader, whose offsets do not count it.
        Ok(text) => Ok(match text.trim_start_matches('\u{FEFF}') {
            rest if rest.len() < text.len() => rest.to_owned(),
            _ => text,
        }),
        Err(e) if encoding == Encoding::UnicodeOrLatin1 => {
            Ok(without_bom(e.as_bytes()).iter().map(|&byte| char::from(byte)).collect())
        }
        Err(e) => Err(LoadError::syntax("UTF-8 or UTF-16 text", e.utf8_error().to_string().as_bytes())),
    }
}

/// Returns the error that a text is not well-formed XML.
pub(crate) fn ill_formed(error: &quick_xml::Error) -> LoadError {
    let text = error.to_string();
    let start = ["ill-formed document: ", "syntax error: "].into_iter().find_map(|start| text.strip_prefix(start));
    LoadError::syntax("well-formed XML", start.unwrap_or(&text).as_bytes())
}

/// Returns the attributes of an element with their values. A malformed attribute is left out, so
/// the caller finds it missing.
pub(crate) fn attributes<'a>(element: &'a BytesStart<'_>) -> impl Iterator<Item = (&'a str, Cow<'a, str>)> {
    normalized(element.attributes())
}

/// Returns the attributes in the text of a start tag, whose element name has `name_len` bytes.
pub(crate) fn attributes_of_tag(tag: &str, name_len: usize) -> impl Iterator<Item = (&str, Cow<'_, str>)> {
    normalized(Attributes::new(tag, name_len))
}

fn normalized(mut attributes: Attributes<'_>) -> impl Iterator<Item = (&str, Cow<'_, str>)> {
    // The crate's own check for repeated names takes time quadratic in their number.
    attributes.with_checks(false);
    attributes.flatten().map(|a| (a.key.into_inner(), a.normalized_value(XmlVersion::Implicit1_0).unwrap_or(a.value)))
}

/// Returns an error if an element has two attributes of the same name, which XML forbids.
pub(crate) fn refuse_repeated_attributes(element: &BytesStart<'_>) -> Result<(), LoadError> {
    // Elements of a mesh have few attributes. Comparing these names is faster than sorting them.
    const FEW: usize = 8;
    let mut names = element.attributes();
    names.with_checks(false);
    let mut names = names.flatten().map(|a| a.key.into_inner());
    let (mut few, mut count) = ([""; FEW], 0);
    let mut repeated = None;
    for name in names.by_ref().take(FEW) {
        if few[..count].contains(&name) {
            repeated = Some(name);
        }
        few[count] = name;
        count += 1;
    }
    if count == FEW {
        let mut all: Vec<&str> = few.into_iter().chain(names).collect();
        all.sort_unstable();
        repeated = repeated.or(all.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]));
    }
    match repeated {
        Some(name) => Err(LoadError::syntax("attributes of different names", format!("{name} twice").as_bytes())),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn every_encoding_is_read() {
        let text = "<a b=\"caf\u{E9} \u{1F600}\"/>";
        for mark in ["", "\u{FEFF}", "\u{FEFF}\u{FEFF}"] {
            let marked = format!("{mark}{text}");
            for encoding in [Encoding::Unicode, Encoding::UnicodeOrLatin1] {
                assert_eq!(decode(marked.clone().into_bytes(), encoding).unwrap(), text);
                assert_eq!(decode(utf16(&marked, u16::to_le_bytes), encoding).unwrap(), text);
                assert_eq!(decode(utf16(&marked, u16::to_be_bytes), encoding).unwrap(), text);
            }
        }
        assert_eq!(decode(b"caf\xE9".to_vec(), Encoding::UnicodeOrLatin1).unwrap(), "caf\u{E9}");
    }

    #[test]
    fn invalid_text_is_an_error() {
        let error = |bytes: &[u8]| decode(bytes.to_vec(), Encoding::Unicode).unwrap_err().to_string();
        assert!(error(b"caf\xE9").starts_with("expected UTF-8 or UTF-16 text"));
        assert!(error(b"\xFF\xFE<\0a").contains("an odd number of bytes"));
        assert!(error(b"\xFF\xFE<\0\0\xD8").starts_with("expected UTF-16 text"));
    }

    #[test]
    fn repeated_attributes_are_errors_and_take_nearly_linear_time() {
        let check = |tag: &str| refuse_repeated_attributes(&BytesStart::from_content(tag, 1));
        let many: String = (0..200_000).map(|i| format!(" x{i}=\"\"")).collect();
        for fine in ["a", "a x=\"1\" y=\"1\" X=\"\"", &format!("a{many}")] {
            assert!(check(fine).is_ok());
        }
        for twice in ["a x=\"1\" x=\"1\"", &format!("a{many} x7=\"\""), &format!("a{many} x199999=\"\"")] {
            assert!(check(twice).unwrap_err().to_string().starts_with("expected attributes of different names"));
        }
    }
}
