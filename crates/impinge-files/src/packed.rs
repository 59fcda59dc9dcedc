//! Compressed data: the limit on its unpacked size, and gzip files (RFC 1952).

use std::io::Read;

use flate2::bufread::GzDecoder;

use crate::{
    error::{LoadError, Place},
    limits::{Limits, too_many_bytes},
    model::{WarningKind, Warnings},
};

/// Maximum number of bytes that may still be unpacked.
pub(crate) struct Allowance {
    left: u64,
    limit: u64,
}

impl Allowance {
    /// Returns the allowance of a compressed file of this many bytes.
    pub(crate) fn for_packed(bytes: u64, limits: &Limits) -> Self {
        let limit = limits.unpacked_bytes(bytes);
        Self { left: limit, limit }
    }

    /// Reads to the end and appends to `unpacked`. If reading fails, the error says that `expected`
    /// was expected.
    pub(crate) fn read(
        &mut self,
        reader: impl Read,
        unpacked: &mut Vec<u8>,
        expected: &'static str,
    ) -> Result<(), LoadError> {
        let count = reader
            .take(self.left.saturating_add(1))
            .read_to_end(unpacked)
            .map_err(|e| LoadError::syntax(expected, e.to_string().as_bytes()))? as u64;
        if count > self.left {
            return Err(too_many_bytes("unpacked bytes", self.limit - self.left + count, self.limit));
        }
        self.left -= count;
        Ok(())
    }
}

/// Reports whether the bytes begin as a gzip file: its signature, deflate as the method, and no
/// reserved flag.
pub(crate) fn is_gzip(bytes: &[u8]) -> bool {
    matches!(bytes, [0x1F, 0x8B, 8, flags, ..] if flags & 0xE0 == 0)
}

/// Unpacks all members of a gzip file. Bytes after the last member are ignored with a warning.
pub(crate) fn gunzip(bytes: &[u8], limits: &Limits, warnings: &mut Warnings) -> Result<Vec<u8>, LoadError> {
    let mut allowance = Allowance::for_packed(bytes.len() as u64, limits);
    let mut unpacked = Vec::new();
    let mut rest = bytes;
    while is_gzip(rest) {
        let at = Place::Byte((bytes.len() - rest.len()) as u64);
        let mut member = GzDecoder::new(rest);
        allowance.read(&mut member, &mut unpacked, "a complete gzip file").map_err(|e| e.at(at))?;
        rest = member.into_inner();
    }
    let at = (bytes.len() - rest.len()) as u64;
    warnings.add(WarningKind::TrailingBytes, rest.len() as u64, || Some(Place::Byte(at)));
    if is_gzip(&unpacked) {
        return Err(LoadError::unsupported("a gzip file within a gzip file").with_hint("unpack the outer file first"));
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn members_are_joined_and_trailing_bytes_are_a_warning() {
        let file = [gzip(b"v 0 0"), gzip(b" 0\n"), b"\0\0\0".to_vec()].concat();
        let mut warnings = Warnings::default();
        assert_eq!(gunzip(&file, &Limits::default(), &mut warnings).unwrap(), b"v 0 0 0\n");
        let warnings = warnings.into_vec();
        assert_eq!((warnings.len(), warnings[0].count), (1, 3));
        assert_eq!(warnings[0].first, Some(Place::Byte(file.len() as u64 - 3)));
    }

    #[test]
    fn truncated_corrupt_nested_and_huge_files_are_errors() {
        let error = |bytes: &[u8]| gunzip(bytes, &Limits::default(), &mut Warnings::default()).unwrap_err().to_string();
        let whole = gzip(b"v 0 0 0\n");
        assert!(error(&whole[..whole.len() - 1]).starts_with("byte 0: expected a complete gzip file"));
        let mut wrong_sum = whole.clone();
        wrong_sum[whole.len() - 6] ^= 1;
        assert!(error(&wrong_sum).contains("a complete gzip file"));
        assert!(error(&gzip(&whole)).contains("a gzip file within a gzip file"));
        let bomb = gzip(&vec![b' '; 80 << 20]);
        assert!(bomb.len() < 100_000);
        assert!(error(&bomb).contains("unpacked bytes exceed the limit of"));
    }

    #[test]
    fn other_files_are_not_gzip() {
        assert!(is_gzip(&gzip(b"")));
        for bytes in [&b""[..], b"\x1F\x8B", b"\x1F\x8B\x08\xFF", b"\x1F\x8B\x07\0", b"v 0 0 0"] {
            assert!(!is_gzip(bytes));
        }
    }
}
