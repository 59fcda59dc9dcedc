//! The head of a baked file: what it is, for whom, and where everything else lies.
//!
//! | bytes | field |
//! |---|---|
//! | 0 .. 8 | the magic word |
//! | 8 .. 12 | the byte order mark, 0x01020304 |
//! | 12 .. 16 | the version of this form |
//! | 16 .. 20 | the version of the arrays ([`Mesh::PARTS_VERSION`]) |
//! | 20 .. 24 | bytes a coordinate, 4 or 8 |
//! | 24 .. 28 | the unit of length by its place in [`Unit::ALL`], counted from one; zero where none is stated |
//! | 28 .. 32 | how many sections there are, 9 |
//! | 32 .. 40 | how long the file is |
//! | 40 .. 60 | zeros |
//! | 60 .. 64 | the checksum of the first 60 bytes and of the table |

use std::ops::Range;

use impinge::Mesh;

use crate::{
    error::{LoadError, LoadErrorKind},
    unit::Unit,
};

/// The first bytes of every baked file; the third line end of a text file, as some transfers change them.
pub(crate) const MAGIC: [u8; 8] = *b"impinge\n";

/// Reads otherwise on a machine of the other byte order.
const BYTE_ORDER: u32 = 0x0102_0304;

/// The version of header, table and sections.
const VERSION: u32 = 2;

/// Sections start at multiples of this many bytes.
pub(super) const ALIGNMENT: usize = 64;

const _: () = assert!(ALIGNMENT.is_multiple_of(Mesh::PARTS_ALIGNMENT));

/// Bytes of the header alone, of an entry of the table, and of both.
const FIXED: usize = 64;
const ENTRY: usize = 24;
pub(super) const HEADER: usize = FIXED + ENTRY * Section::ALL.len();

/// Where the checksum is.
const CHECKSUM: Range<usize> = FIXED - 4..FIXED;

/// The sections, in their order in the file.
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

/// What the head of a file says.
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
    /// Of a file with these sections.
    pub(super) fn new(is_single_precision: bool, unit: Option<Unit>, contents: &[&[u8]; Section::ALL.len()]) -> Self {
        let mut end = HEADER;
        let sections = contents.map(|content| {
            let start = end.next_multiple_of(ALIGNMENT);
            end = start + content.len();
            Entry { range: start..end, checksum: crc32fast::hash(content) }
        });
        Self { is_single_precision, unit, sections }
    }

    /// Where a section is, which is within the file.
    pub(super) fn range(&self, section: Section) -> Range<usize> {
        self.sections[section as usize].range.clone()
    }

    /// How long the file is.
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

    /// Judges the head of a file that consists of `bytes`: its sections are within them, each where it has to be.
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
            return Err(LoadError::unsupported("a machine of the other byte order"));
        }
        let [order, form, arrays] = [number(8), number(12), number(16)];
        if (order, form, arrays) != (BYTE_ORDER, VERSION, Mesh::PARTS_VERSION) {
            return Err(LoadError::unsupported(format!("version {form}.{arrays} of baked files"))
                .with_hint("bake it anew from the original mesh"));
        }
        if number(CHECKSUM.start) != checksum(head) {
            return Err(super::corrupt("the header is not what was written"));
        }
        if long(32) != bytes.len() as u64 {
            return Err(LoadError::truncated("bytes of the file", long(32), bytes.len() as u64));
        }
        let unit = match number(24) {
            0 => None,
            place => Some(*Unit::ALL.get(place as usize - 1).ok_or_else(|| super::corrupt("no such unit"))?),
        };
        let is_single_precision = match number(20) {
            4 => true,
            8 => false,
            bytes => return Err(super::corrupt(format!("coordinates of {bytes} bytes"))),
        };
        let mut end = HEADER as u64;
        let mut sections = [const { Entry { range: 0..0, checksum: 0 } }; Section::ALL.len()];
        for (at, entry) in sections.iter_mut().enumerate() {
            let place = FIXED + at * ENTRY;
            let (start, length) = (long(place + 8), long(place + 16));
            let is_next = number(place) == at as u32 && start == end.next_multiple_of(ALIGNMENT as u64);
            end = start.saturating_add(length);
            if !is_next || end > bytes.len() as u64 {
                return Err(super::corrupt(format!("section {at} is not where it has to be")));
            }
            *entry = Entry { range: start as usize..end as usize, checksum: number(place + 4) };
        }
        if number(28) != Section::ALL.len() as u32 || end != bytes.len() as u64 {
            return Err(super::corrupt("there is more than its sections"));
        }
        Ok(Self { is_single_precision, unit, sections })
    }

    /// Compares sections of the file with their checksums.
    pub(super) fn check(&self, bytes: &[u8], sections: &[Section]) -> Result<(), LoadError> {
        for &section in sections {
            let Entry { range, checksum } = &self.sections[section as usize];
            if crc32fast::hash(&bytes[range.clone()]) != *checksum {
                let what = format!("section {} is not what was written", section as usize);
                return Err(
                    LoadError::new(LoadErrorKind::Corrupt { what }).with_hint("bake it anew from the original mesh")
                );
            }
        }
        Ok(())
    }
}

/// Of all of the head but the checksum itself.
fn checksum(head: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&head[..CHECKSUM.start]);
    hasher.update(&head[CHECKSUM.end..]);
    hasher.finalize()
}
