//! Limits on the size of a file's content, and budgets for content that a file repeats.

use crate::{
    error::{LoadError, LoadErrorKind},
    text::MAX_NAME,
};

/// Limits on the size of a file's content.
///
/// The defaults suit untrusted files: time and memory stay within a multiple of the
/// file's size. If you trust a file that exceeds them, set a larger limit. If you have less memory,
/// set a smaller one.
///
/// ```
/// use impinge_files::{Format, Limits, parse_with};
///
/// let two = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
/// let one_triangle = Limits::default().with_max_triangles(1);
/// let error = parse_with(two.as_bytes(), Format::Obj, &one_triangle).unwrap_err();
/// assert_eq!(error.kind().name(), "too-many");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Maximum number of bytes of the file, of the content that it unpacks to, and of all files
    /// that it refers to, each. `None` limits only unpacked content: to 64 MiB plus 64 times the
    /// size of the packed file.
    pub max_bytes: Option<u64>,
    /// Maximum number of triangles, counted over all instances. `None` stands for 2^31. In files
    /// with instances it stands for 16 triangles per byte of the file, at least 2^20 and at most
    /// 2^24, or for 4 per byte if that is more.
    pub max_triangles: Option<u64>,
}

/// Default maximum number of triangles.
const MAX_TRIANGLES: u64 = 1 << 31;

/// Name of the bytes of a file in errors.
pub(crate) const OF_FILE: &str = "bytes of the file";

/// Advice for a file with too many triangles.
const RAISE_TRIANGLES: &str = "if you trust the file, load it with a larger max_triangles";

/// Advice for a file with too many bytes.
const RAISE_BYTES: &str = "if you trust the file, load it with a larger max_bytes";

impl Limits {
    /// Returns the limits with another maximum number of bytes.
    #[must_use]
    pub const fn with_max_bytes(self, max_bytes: u64) -> Self {
        Self { max_bytes: Some(max_bytes), ..self }
    }

    /// Returns the limits with another maximum number of triangles.
    #[must_use]
    pub const fn with_max_triangles(self, max_triangles: u64) -> Self {
        Self { max_triangles: Some(max_triangles), ..self }
    }

    /// Returns the maximum number of triangles.
    pub(crate) fn triangles(&self) -> u64 {
        self.max_triangles.unwrap_or(MAX_TRIANGLES)
    }

    /// Returns the maximum number of bytes that a packed file of `bytes` bytes may unpack to.
    ///
    /// Deflate compresses up to 1,000 to 1, but meshes at most about 30 to 1. A larger default lets
    /// small hostile files take more memory; a smaller one rejects files that repeat themselves.
    pub(crate) fn unpacked_bytes(&self, bytes: u64) -> u64 {
        self.max_bytes.unwrap_or_else(|| (64 << 20) + bytes.saturating_mul(64))
    }

    /// Returns an error if there are more bytes than allowed. `what` names them.
    pub(crate) fn check_bytes(&self, what: &'static str, count: u64) -> Result<(), LoadError> {
        match self.max_bytes {
            Some(limit) if count > limit => Err(too_many_bytes(what, count, limit)),
            _ => Ok(()),
        }
    }
}

/// Returns the error that there are more bytes than allowed. `what` names them.
pub(crate) fn too_many_bytes(what: &'static str, count: u64, limit: u64) -> LoadError {
    LoadError::new(LoadErrorKind::TooMany { what, count, limit }).with_hint(RAISE_BYTES)
}

/// Returns the error that there are more triangles than allowed.
pub(crate) fn too_many_triangles(count: u64, limit: u64) -> LoadError {
    LoadError::new(LoadErrorKind::TooMany { what: "triangles", count, limit }).with_hint(RAISE_TRIANGLES)
}

/// Maximum number of items that a file may add up to by repeating its content: by instances, or by
/// several references to the same data. Without it, a file of a few hundred bytes could take any
/// amount of memory and time.
#[derive(Clone, Copy)]
pub(crate) struct Budget {
    max: u64,
    hint: &'static str,
}

impl Budget {
    /// Returns the budget for vertices, corners of triangles and similar items: 16 per byte of the
    /// file, at least 2^20 and at most 2^24, or 4 per byte if that is more. It is raised to 3 times
    /// the maximum number of triangles that the caller allows.
    ///
    /// An item takes about 60 bytes of memory. A larger budget lets small hostile files take more
    /// memory; a smaller one rejects assemblies that repeat their parts many times.
    pub(crate) fn for_bytes(bytes: u64, limits: &Limits) -> Self {
        let own = bytes.saturating_mul(16).clamp(1 << 20, 1 << 24).max(bytes.saturating_mul(4));
        Self::new(own, 3, limits)
    }

    /// Returns the budget for the bytes of all part names: 2^24, or 32 per byte of the file if that
    /// is more. A name has at most [`MAX_NAME`] bytes, and a node that is used once takes at least
    /// 10 bytes. The budget is raised to the longest possible names for as many parts as the caller
    /// allows triangles.
    pub(crate) fn for_names(bytes: u64, limits: &Limits) -> Self {
        let longest = (size_of::<String>() + MAX_NAME) as u64;
        Self::new(bytes.saturating_mul(32).max(1 << 24), longest, limits)
    }

    /// Returns the budget for visited nodes, counted once for each path that reaches them: 2^18, or
    /// one per byte of the file if that is more. A node that is reached once takes more than one
    /// byte. The budget is raised to the maximum number of triangles that the caller allows.
    pub(crate) fn for_nodes(bytes: u64, limits: &Limits) -> Self {
        Self::new(bytes.max(1 << 18), 1, limits)
    }

    /// Returns a budget of `own` items, or of `per_triangle` for each triangle that the caller
    /// allows if that is more.
    fn new(own: u64, per_triangle: u64, limits: &Limits) -> Self {
        let requested = limits.max_triangles.unwrap_or(0).saturating_mul(per_triangle);
        Self {
            max: own.max(requested).min(u64::from(u32::MAX)),
            hint: "counted over all instances; if you trust the file, load it with a larger max_triangles, \
                or store fewer instances",
        }
    }

    /// Returns an error if `count` exceeds the budget; `what` names the items.
    pub(crate) fn check(self, what: &'static str, count: u64) -> Result<(), LoadError> {
        if count <= self.max {
            return Ok(());
        }
        Err(LoadError::new(LoadErrorKind::TooMany { what, count, limit: self.max }).with_hint(self.hint))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_grow_with_the_file_and_with_the_limit_of_the_caller() {
        let budget = |bytes, limits: &Limits| Budget::for_bytes(bytes, limits).max;
        let default = Limits::default();
        assert_eq!(budget(0, &default), 1 << 20);
        assert_eq!(budget(100_000, &default), 1_600_000);
        assert_eq!(budget(3 << 20, &default), 1 << 24);
        assert_eq!(budget(8 << 20, &default), 1 << 25);
        assert_eq!(budget(u64::MAX, &default), u64::from(u32::MAX));
        assert_eq!(budget(0, &default.with_max_triangles(1 << 20)), 3 << 20);
        assert_eq!(budget(0, &default.with_max_triangles(1)), 1 << 20);
    }

    #[test]
    fn only_packed_content_is_limited_by_default() {
        let default = Limits::default();
        assert!(default.check_bytes("bytes of the file", u64::MAX).is_ok());
        assert_eq!((default.triangles(), default.unpacked_bytes(10)), (1 << 31, (64 << 20) + 640));
        let few = default.with_max_bytes(5);
        assert_eq!(few.unpacked_bytes(10), 5);
        assert_eq!(
            few.check_bytes("bytes of the file", 6).unwrap_err().to_string(),
            "6 bytes of the file exceed the limit of 5 (if you trust the file, load it with a larger max_bytes)"
        );
    }
}
