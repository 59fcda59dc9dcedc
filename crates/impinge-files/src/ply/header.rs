//! Reads the header of a PLY file: the encoding, and the elements with their properties.

use crate::{
    error::{LoadError, Place},
    text::{integer, name, tokens, trim},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Long,
    ULong,
    Float,
    Double,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::Char,
            b"uchar" | b"uint8" => Self::UChar,
            b"short" | b"int16" => Self::Short,
            b"ushort" | b"uint16" => Self::UShort,
            b"int" | b"int32" => Self::Int,
            b"uint" | b"uint32" => Self::UInt,
            b"long" | b"int64" => Self::Long,
            b"ulong" | b"uint64" => Self::ULong,
            b"float" | b"float32" => Self::Float,
            b"double" | b"float64" => Self::Double,
            _ => return None,
        })
    }

    /// Returns the number of bytes of a binary value.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Char | Self::UChar => 1,
            Self::Short | Self::UShort => 2,
            Self::Int | Self::UInt | Self::Float => 4,
            Self::Long | Self::ULong | Self::Double => 8,
        }
    }

    /// Reports whether f32 holds every value of this type exactly.
    pub(super) fn fits_f32(self) -> bool {
        matches!(self, Self::Char | Self::UChar | Self::Short | Self::UShort | Self::Float)
    }
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    /// Type of the length if this is a list; `None` for a single value.
    pub(super) list: Option<Scalar>,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Length of the header in bytes.
    pub(super) len: usize,
    /// Number of header lines that are not statements.
    pub(super) unknown_lines: u64,
    /// Line of the first such header line.
    pub(super) first_unknown: u64,
}

impl Header {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, LoadError> {
        let mut lines = HeaderLines::new(bytes);
        let first = lines.next().unwrap_or_default();
        if first != b"ply" {
            return Err(LoadError::syntax("ply", first).at(Place::Line(1)));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let (mut unknown_lines, mut first_unknown) = (0, 0);
        loop {
            let Some(line) = lines.next() else {
                return Err(LoadError::syntax("end_header", b"").at(lines.place()).with_hint("the file is cut off"));
            };
            let mut words = tokens(line);
            let result = match words.next().unwrap_or_default() {
                b"format" => read_encoding(words).map(|e| encoding = Some(e)),
                b"comment" | b"obj_info" | b"" => Ok(()),
                b"element" => read_element(words, &elements).map(|e| elements.push(e)),
                b"property" => match elements.last_mut() {
                    None => Err(LoadError::syntax("an element before its properties", line)),
                    Some(element) => read_property(words).map(|p| element.properties.push(p)),
                },
                b"end_header" => break,
                _ if is_like_declaration(line) => {
                    Err(LoadError::syntax("format, element, property, comment or end_header", line))
                }
                // A comment without its keyword.
                _ => {
                    if unknown_lines == 0 {
                        first_unknown = lines.number;
                    }
                    unknown_lines += 1;
                    Ok(())
                }
            };
            result.map_err(|e| e.at(lines.place()))?;
        }
        match encoding {
            Some(encoding) => Ok(Self { encoding, elements, len: lines.at, unknown_lines, first_unknown }),
            None => Err(LoadError::syntax("a line with the format", b"").at(lines.place())),
        }
    }
}

/// Reports whether a line may be a property or an element with a misspelled keyword. If such a line
/// were a comment, the values after the header would be misread.
fn is_like_declaration(line: &[u8]) -> bool {
    let mut words = tokens(line).skip(1);
    let (second, third, fourth) = (words.next().unwrap_or_default(), words.next(), words.next());
    let is_property = second == b"list" || Scalar::from_name(second).is_some();
    let is_element = fourth.is_none() && third.is_some_and(|word| integer(word).is_some());
    is_property || is_element
}

/// Iterates over the header's lines, trimmed. Lines end like the first line, because the body may
/// begin with any byte.
struct HeaderLines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u64,
    end: u8,
}

impl<'a> HeaderLines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        // Files from early Macintosh programs end lines with \r alone.
        let end = if bytes.get(3) == Some(&b'\r') && bytes.get(4) != Some(&b'\n') { b'\r' } else { b'\n' };
        Self { bytes, at: 0, number: 0, end }
    }

    fn place(&self) -> Place {
        Place::Line(self.number)
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let len = memchr::memchr(self.end, rest)?;
        self.at += len + 1;
        self.number += 1;
        Some(trim(&rest[..len]))
    }
}

fn read_encoding<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<Encoding, LoadError> {
    let word = words.next().unwrap_or_default();
    let encoding = match word {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        _ => return Err(LoadError::syntax("ascii, binary_little_endian or binary_big_endian", word)),
    };
    match words.next().unwrap_or_default() {
        b"1.0" | b"1" => Ok(encoding),
        version => Err(LoadError::syntax("version 1.0", version)),
    }
}

fn read_element<'a>(mut words: impl Iterator<Item = &'a [u8]>, elements: &[Element]) -> Result<Element, LoadError> {
    let word = words.next().unwrap_or_default();
    let name = name(word);
    let count = words.next().unwrap_or_default();
    let count = integer(count)
        .and_then(|n| u64::try_from(n).ok())
        .ok_or_else(|| LoadError::syntax("the number of rows of an element", count))?;
    let once = ["vertex", "face", "tristrips"].contains(&name.as_str());
    if once && elements.iter().any(|e| e.name == name) {
        return Err(LoadError::syntax(format!("one element {name}"), word).with_hint("the header declares it twice"));
    }
    Ok(Element { name, count, properties: Vec::new() })
}

fn read_property<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<Property, LoadError> {
    let mut word = || words.next().unwrap_or_default();
    let scalar = |name: &[u8]| Scalar::from_name(name).ok_or_else(|| LoadError::syntax("the type of a property", name));
    let first = word();
    let (list, scalar) =
        if first == b"list" { (Some(scalar(word())?), scalar(word())?) } else { (None, scalar(first)?) };
    Ok(Property { name: name(word()), scalar, list })
}
