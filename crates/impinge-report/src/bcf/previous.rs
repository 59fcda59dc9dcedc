//! Reads the statuses of topics back, which people changed in other programs.

use std::fmt;
use std::io::{self, Cursor, Read};
use std::path::Path;

use impinge::clash::{Known, Previous};
use impinge_files::Unit;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::Event;
use quick_xml::{Reader, XmlVersion};
use zip::ZipArchive;

use super::description::parse;
use super::status::{from_topic, of_all};

/// Maximum size of a markup, in bytes. It protects from archives that are small only while they
/// are packed. A markup of 16 MiB has 100,000 clashes.
const MAX_MARKUP: u64 = 16 << 20;

/// Maximum size of all markups, in bytes.
const MAX_MARKUPS: u64 = 256 << 20;

/// The element with the lines of the clashes.
const DESCRIPTION: [&str; 3] = ["Markup", "Topic", "Description"];

/// The reason why a BCF file cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum BcfError {
    /// The file cannot be read.
    Io(io::Error),
    /// The file is not a ZIP archive.
    NotZip(String),
    /// The archive has no topics.
    NoTopics,
    /// A file of the archive is larger than the limit.
    TooLarge {
        /// Name of the file in the archive.
        name: String,
    },
    /// A file of the archive is not valid XML.
    Xml {
        /// Name of the file in the archive.
        name: String,
        /// Description of the fault.
        message: String,
    },
}

/// Reports whether a path names a BCF file: whether its extension is `.bcfzip` or `.bcf`.
#[must_use]
pub fn is_bcf(path: impl AsRef<Path>) -> bool {
    let extension = path.as_ref().extension().unwrap_or_default();
    ["bcfzip", "bcf"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Loads the statuses of the clashes of a BCF file that [`write_bcf`](super::write_bcf) wrote, and
/// that other programs may have saved since. Lengths are converted to `unit`, the unit of the
/// scenes.
///
/// The description of a topic lists its clashes with their statuses. If the status of the topic is
/// no longer theirs, somebody changed it, and all clashes of the topic get it. Topics without such
/// lines are skipped.
///
/// # Errors
/// Returns an error if the file cannot be read, is not a ZIP archive with topics, or is too large.
pub fn load_previous_bcf(path: impl AsRef<Path>, unit: Unit) -> Result<Previous, BcfError> {
    parse_previous_bcf(&std::fs::read(path).map_err(BcfError::Io)?, unit)
}

/// Reads a BCF file from bytes, as [`load_previous_bcf`] does from a file.
///
/// # Errors
/// Returns an error as [`load_previous_bcf`] does.
pub fn parse_previous_bcf(bytes: &[u8], unit: Unit) -> Result<Previous, BcfError> {
    let not_zip = |error: zip::result::ZipError| BcfError::NotZip(error.to_string());
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(not_zip)?;
    let mut clashes = Vec::new();
    let (mut topics, mut size) = (0, 0);
    for at in 0..archive.len() {
        let file = archive.by_index(at).map_err(not_zip)?;
        let name = file.name().map_err(not_zip)?.into_owned();
        if !name.ends_with("markup.bcf") {
            continue;
        }
        topics += 1;
        let mut markup = Vec::new();
        let limit = MAX_MARKUP.min(MAX_MARKUPS - size);
        file.take(limit + 1).read_to_end(&mut markup).map_err(BcfError::Io)?;
        size += markup.len() as u64;
        if markup.len() as u64 > limit {
            return Err(BcfError::TooLarge { name });
        }
        let (status, description) = topic(&markup).map_err(|message| BcfError::Xml { name, message })?;
        let mut known: Vec<Known> = description.lines().filter_map(|line| parse(line, unit)).collect();
        let (stated, own) = (from_topic(&status), of_all(known.iter().map(|clash| clash.status)));
        if stated != own {
            known.iter_mut().for_each(|clash| clash.status = stated);
        }
        clashes.extend(known);
    }
    if topics == 0 { Err(BcfError::NoTopics) } else { Ok(Previous { clashes, ..Previous::default() }) }
}

/// Returns the status and the description of the topic of a markup.
fn topic(markup: &[u8]) -> Result<(String, String), String> {
    let text = std::str::from_utf8(markup).map_err(|error| error.to_string())?;
    let mut reader = Reader::from_str(text.trim_start_matches('\u{feff}'));
    let mut path: Vec<String> = Vec::new();
    let (mut status, mut description) = (String::new(), String::new());
    loop {
        match reader.read_event().map_err(|error| error.to_string())? {
            Event::Start(start) => {
                path.push(start.local_name().into_inner().to_owned());
                if path == ["Markup", "Topic"] {
                    let found = start.try_get_attribute("TopicStatus").map_err(|error| error.to_string())?;
                    if let Some(found) = found {
                        let value = found.normalized_value(XmlVersion::Implicit1_0);
                        status = value.map_err(|error| error.to_string())?.into_owned();
                    }
                }
            }
            Event::End(_) => {
                path.pop();
            }
            Event::Text(piece) if path == DESCRIPTION => description += &piece,
            Event::CData(piece) if path == DESCRIPTION => description += &piece,
            Event::GeneralRef(name) if path == DESCRIPTION => {
                let letter = name.resolve_char_ref().map_err(|error| error.to_string())?;
                description.extend(letter);
                description += resolve_predefined_entity(&name).unwrap_or_default();
            }
            Event::Eof if path.is_empty() => return Ok((status, description)),
            Event::Eof => return Err(format!("the element {} has no end", path.join("/"))),
            _ => {}
        }
    }
}

impl fmt::Display for BcfError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "cannot be read: {error}"),
            Self::NotZip(error) => write!(f, "not a BCF file: {error}"),
            Self::NoTopics => f.write_str("not a BCF file: the archive has no markup.bcf"),
            Self::TooLarge { name } => write!(f, "{name} is larger than {} MiB", MAX_MARKUP >> 20),
            Self::Xml { name, message } => write!(f, "{name}: {message}"),
        }
    }
}

impl std::error::Error for BcfError {}
