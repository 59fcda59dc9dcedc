//! What a file is: its format by name and content, and its content without compression.

use std::{borrow::Cow, path::Path};

use crate::{
    baked,
    collada::{self, Axes},
    error::{LoadError, LoadErrorKind},
    format::Format,
    gltf,
    limits::{Limits, OF_FILE},
    model::{Model, Warning, WarningKind, Warnings},
    obj, off, packed, ply,
    regular_file::{self, read_regular_file},
    stl, three_mf,
};

/// Expectations about the content of a file, from its name.
pub(crate) struct Named {
    /// Format that the extension stands for. If it is `None`, `extension` is empty or ends in `gz`.
    format: Option<Format>,
    /// Whether the name says that the content is compressed; `None` if there is no name.
    packed: Option<bool>,
    extension: String,
}

impl Named {
    /// Returns the expectations about a file at a path.
    pub(crate) fn of(path: &Path) -> Result<Self, LoadError> {
        let extension = |path: &Path| path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let last = extension(path);
        let packed = last.eq_ignore_ascii_case("gz");
        let inner = if packed { extension(Path::new(path.file_stem().unwrap_or_default())) } else { last.clone() };
        let format = Format::from_extension(&inner);
        if format.is_none() && !packed && !last.is_empty() {
            return Err(unsupported(last));
        }
        let extension = if packed && !inner.is_empty() { format!("{inner}.{last}") } else { last };
        Ok(Self { format, packed: Some(packed), extension })
    }

    /// Returns the expectations about bytes in a format, or in the format that they prove.
    pub(crate) fn bytes(format: Option<Format>) -> Self {
        Self { format, packed: None, extension: String::new() }
    }
}

/// The content of a file and its format.
pub(crate) struct Content<'a> {
    /// The bytes, without the compression of gzip.
    pub(crate) bytes: Cow<'a, [u8]>,
    pub(crate) format: Format,
    /// Number of bytes of the file.
    pub(crate) file_size: u64,
    warnings: Warnings,
}

impl<'a> Content<'a> {
    /// Unpacks the bytes of a file and finds their format. The bytes decide if they prove a format.
    pub(crate) fn of(bytes: &'a [u8], named: &Named, limits: &Limits) -> Result<Self, LoadError> {
        let mut unpacking = Warnings::default();
        limits.check_bytes(OF_FILE, bytes.len() as u64)?;
        let unpacked = unpack(bytes, limits, &mut unpacking)?;
        let is_packed = unpacked.is_some();
        let file_size = bytes.len() as u64;
        let bytes = unpacked.map_or(Cow::Borrowed(bytes), Cow::Owned);
        let Some(format) = Format::of_content(&bytes).or(named.format) else {
            return Err(unsupported(named.extension.clone()));
        };
        let is_other =
            named.format.is_some_and(|named| named != format) || named.packed.is_some_and(|packed| packed != is_packed);
        let mut warnings = Warnings::default();
        warnings.add(WarningKind::OtherExtension, is_other.into(), || None);
        warnings.extend(unpacking.into_vec());
        Ok(Self { bytes, format, file_size, warnings })
    }

    /// Returns the warnings about the file itself, followed by those about its content.
    pub(crate) fn warnings(self, of_content: Vec<Warning>) -> Vec<Warning> {
        let mut all = self.warnings;
        all.extend(of_content);
        all.into_vec()
    }

    /// Reads the triangles. Other files that the bytes refer to are read from `folder`, or not at
    /// all if it is `None`. The axes are those of a COLLADA model.
    pub(crate) fn triangles(&self, (folder, axes): (Option<&Path>, Axes), limits: &Limits) -> Result<Model, LoadError> {
        let bytes = &*self.bytes;
        match self.format {
            Format::Obj => obj::read(bytes, limits),
            Format::Stl => stl::read(bytes, limits),
            Format::Ply => ply::read(bytes, limits),
            Format::Off => off::read(bytes, limits),
            Format::Gltf | Format::Glb => gltf::read(bytes, self.format, folder, limits),
            Format::ThreeMf => three_mf::read(bytes, self.file_size, limits),
            Format::Collada => collada::read(bytes, axes, limits),
            Format::Baked => baked::read(bytes, limits),
        }
    }
}

/// Reads the bytes of a file whose name has a known extension, or none.
pub(crate) fn read_file(path: &Path, limits: &Limits) -> Result<(Vec<u8>, Named), LoadError> {
    // A missing file is reported before an unknown extension.
    regular_file::open(path)?;
    let named = Named::of(path)?;
    Ok((read_regular_file(path, limits)?, named))
}

/// Reads the triangles from bytes. Other files that the bytes refer to are read from `folder`, or
/// not at all if it is `None`. The axes are those of a COLLADA model.
pub(crate) fn read(
    bytes: &[u8],
    named: &Named,
    source: (Option<&Path>, Axes),
    limits: &Limits,
) -> Result<Model, LoadError> {
    let content = Content::of(bytes, named, limits)?;
    let mut model = content.triangles(source, limits)?;
    model.warnings = content.warnings(model.warnings);
    Ok(model)
}

/// Returns the content of a gzip file, or `None` for another file. Returns an error if there are no
/// bytes.
pub(crate) fn unpack(bytes: &[u8], limits: &Limits, warnings: &mut Warnings) -> Result<Option<Vec<u8>>, LoadError> {
    // The header of a binary STL file may begin with any bytes.
    let packed = packed::is_gzip(bytes) && Format::of_content(bytes).is_none();
    let unpacked = if packed { Some(packed::gunzip(bytes, limits, warnings)?) } else { None };
    if unpacked.as_deref().unwrap_or(bytes).is_empty() {
        return Err(LoadError::new(LoadErrorKind::Empty));
    }
    Ok(unpacked)
}

/// Returns the error that an extension is not that of a supported format, with the command that
/// converts the file if there is one.
fn unsupported(extension: String) -> LoadError {
    const CONVERT: [(&str, &str); 3] = [
        ("ifc", "convert it: pip install \"impinge[ifc]\", then python -m impinge.convert model.ifc -o model.glb"),
        ("step", "convert it: pip install \"impinge[step]\", then python -m impinge.convert model.step -o model.glb"),
        ("stp", "convert it: pip install \"impinge[step]\", then python -m impinge.convert model.stp -o model.glb"),
    ];
    let hint = CONVERT.iter().find(|(known, _)| extension.eq_ignore_ascii_case(known)).map(|(_, hint)| *hint);
    let error = LoadError::new(LoadErrorKind::UnsupportedFormat { extension });
    match hint {
        Some(hint) => error.with_hint(hint),
        None => error,
    }
}
