//! The header of a baked file and its table of sections.
//!
//! | bytes | field |
//! |---|---|
//! | 0 .. 8 | the magic word |
//! | 8 .. 12 | the byte order mark, 0x01020304 |
//! | 12 .. 16 | the version of header, table and sections |
//! | 16 .. 20 | the version of the arrays ([`Mesh::PARTS_VERSION`]) |
//! | 20 .. 24 | bytes per coordinate, 4 or 8 |
//! | 24 .. 28 | the unit of length: its index in [`Unit::ALL`] plus one, or zero if unknown |
//! | 28 .. 32 | the number of sections, 9 |
//! | 32 .. 40 | the length of the file in bytes |
//! | 40 .. 60 | zeros |
//! | 60 .. 64 | the checksum of the first 60 bytes and of the table |

use std::ops::Range;

use impinge::Mesh;

use crate::{
    error::{LoadError, LoadErrorKind},
    unit::Unit,
};

/// First bytes of every baked file. The line end reveals transfers that change the line ends of
/// text files.
pub(crate) const MAGIC: [u8; 8] = *b"impinge\n";

/// Byte order mark: reads as another number on a machine of the opposite byte order.
const BYTE_ORDER: u32 = 0x0102_0304;

/// Version of the header, the table and the sections.
const VERSION: u32 = 2;

/// Alignment of sections in the file, in bytes.
pub(super) const ALIGNMENT: usize = 64;

const _: () = assert!(ALIGNMENT.is_multiple_of(Mesh::PARTS_ALIGNMENT));

/// Size of the header without the table, in bytes.
const FIXED: usize = 64;
/// Size of a table entry, in bytes.
const ENTRY: usize = 24;
/// Size of the header with the table, in bytes.
pub(super) const HEADER: usize = FIXED + ENTRY * Section::ALL.len();

/// Bytes of the checksum in the header.
const CHECKSUM: Range<usize> = FIXED - 4..FIXED;

/// The sections, in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Frame = 0,
    Positions,
    Faces,
    Nodes,
    Leaves,
    Sources,
    PartOf,
    Parts,
    Proxies,
}

impl Section {
    pub(super) const ALL: [Self; 9] = [
        Self::Frame,
        Self::Positions,
        Self::Faces,
        Self::Nodes,
        Self::Leaves,
        Self::Sources,
        Self::PartOf,
        Self::Parts,
        Self::Proxies,
    ];
}

/// The content of the header and the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) is_single_precision: bool,
    pub(super) unit: Option<Unit>,
    sections: [Entry; Section::ALL.len()],
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Entry {
    range: Range<usize>,
    checksum: u32,
}

impl Header {
    /// Builds the header of a file with these sections.
    pub(super) fn new(is_single_precision: bool, unit: Option<Unit>, contents: &[&[u8]; Section::ALL.len()]) -> Self {
        let mut end = HEADER;
        let sections = contents.map(|content| {
            let start = end.next_multiple_of(ALIGNMENT);
            end = start + content.len();
            Entry { range: start..end, checksum: crc32fast::hash(content) }
        });
        Self { is_single_precision, unit, sections }
    }

    /// Returns the byte range of a section, which lies within the file.
    pub(super) fn range(&self, section: Section) -> Range<usize> {
        self.sections[section as usize].range.clone()
    }

    /// Returns the length of the file in bytes.
    fn length(&self) -> usize {
        self.sections.last().map_or(HEADER, |last| last.range.end)
    }

    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let unit =
            self.unit.and_then(|unit| Unit::ALL.iter().position(|&one| one == unit)).map_or(0, |at| at as u32 + 1);
        let precision = if self.is_single_precision { 4 } else { 8 };
        let mut bytes = MAGIC.to_vec();
        for number in [BYTE_ORDER, VERSION, Mesh::PARTS_VERSION, precision, unit, Section::ALL.len() as u32] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend((self.length() as u64).to_le_bytes());
        bytes.resize(FIXED, 0);
        for (section, entry) in Section::ALL.iter().zip(&self.sections) {
            bytes.extend((*section as u32).to_le_bytes());
            bytes.extend(entry.checksum.to_le_bytes());
            bytes.extend((entry.range.start as u64).to_le_bytes());
            bytes.extend((entry.range.len() as u64).to_le_bytes());
        }
        let checksum = checksum(&bytes);
        bytes[CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// Reads and validates the header and the table of a file that consists of `bytes`. Each
    /// section lies within the file, at its required place.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, LoadError> {
        let Some(head) = bytes.get(..HEADER) else {
            return Err(LoadError::truncated("bytes of a header", HEADER as u64, bytes.len() as u64));
        };
        if head[..8] != MAGIC {
            return Err(LoadError::syntax("the first bytes of a baked mesh", &head[..8]));
        }
        let number = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let long = |at: usize| u64::from(number(at)) | u64::from(number(at + 4)) << 32;
        if number(8) == BYTE_ORDER.swap_bytes() || cfg!(target_endian = "big") {
            return Err(LoadError::unsupported("a machine of the opposite byte order"));
        }
        let [order, form, arrays] = [number(8), number(12), number(16)];
        if (order, form, arrays) != (BYTE_ORDER, VERSION, Mesh::PARTS_VERSION) {
            return Err(LoadError::unsupported(format!("version {form}.{arrays} of baked files"))
                .with_hint("bake the original mesh again"));
        }
        if number(CHECKSUM.start) != checksum(head) {
            return Err(super::corrupt("the checksum of the header is wrong"));
        }
        if long(32) != bytes.len() as u64 {
            return Err(LoadError::truncated("bytes of the file", long(32), bytes.len() as u64));
        }
        let unit = match number(24) {
            0 => None,
            place => Some(*Unit::ALL.get(place as usize - 1).ok_or_else(|| super::corrupt("the unit is unknown"))?),
        };
        let is_single_precision = match number(20) {
            4 => true,
            8 => false,
            bytes => {
                return Err(super::corrupt(format!("the size of a coordinate is {bytes} bytes, but must be 4 or 8")));
            }
        };
        let mut end = HEADER as u64;
        let mut sections = [const { Entry { range: 0..0, checksum: 0 } }; Section::ALL.len()];
        for (at, entry) in sections.iter_mut().enumerate() {
            let place = FIXED + at * ENTRY;
            let (start, length) = (long(place + 8), long(place + 16));
            let is_next = number(place) == at as u32 && start == end.next_multiple_of(ALIGNMENT as u64);
            end = start.saturating_add(length);
            if !is_next || end > bytes.len() as u64 {
                return Err(super::corrupt(format!("the offset or length of section {at} is wrong")));
            }
            *entry = Entry { range: start as usize..end as usize, checksum: number(place + 4) };
        }
        if number(28) != Section::ALL.len() as u32 || end != bytes.len() as u64 {
            return Err(super::corrupt("the number of sections or the length of the file is wrong"));
        }
        Ok(Self { is_single_precision, unit, sections })
    }

    /// Validates the checksums of sections. Returns an error that names the first section with a
    /// wrong checksum.
    pub(super) fn check(&self, bytes: &[u8], sections: &[Section]) -> Result<(), LoadError> {
        for &section in sections {
            let Entry { range, checksum } = &self.sections[section as usize];
            if crc32fast::hash(&bytes[range.clone()]) != *checksum {
                let what = format!("the checksum of section {} is wrong", section as usize);
                return Err(LoadError::new(LoadErrorKind::Corrupt { what }).with_hint("bake the original mesh again"));
            }
        }
        Ok(())
    }
}

/// Returns the checksum of the header and the table, without the bytes of the checksum itself.
fn checksum(head: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&head[..CHECKSUM.start]);
    hasher.update(&head[CHECKSUM.end..]);
    hasher.finalize()
}
