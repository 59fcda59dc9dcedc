//! Reads the package of a 3MF model (Open Packaging Conventions): a ZIP archive with relationships.

use std::{collections::HashMap, io::Cursor};

use quick_xml::{Reader, XmlVersion, events::Event};
use zip::{ZipArchive, result::ZipError};

use crate::{
    error::{LoadError, Place},
    limits::Limits,
    packed::Allowance,
    xml::{self, Encoding},
};

use super::no_model;

/// Type of the relationship that names the model to start from.
const MODEL_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const RELATIONSHIPS: &str = "_rels/.rels";
const USUAL_MODEL: &str = "3D/3dmodel.model";

/// The index of an entry of the archive.
pub(super) type Entry = usize;

pub(super) struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// The first entry of each name, without a slash at the start and in lower case.
    by_name: HashMap<String, Entry>,
    /// Shared by all entries, because they may overlap.
    allowance: Allowance,
}

impl<'a> Package<'a> {
    /// Opens a package. `file_size` is the size of the file in bytes, which is smaller than `bytes`
    /// if the package was compressed by gzip.
    pub(super) fn open(bytes: &'a [u8], file_size: u64, limits: &Limits) -> Result<Self, LoadError> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| corrupt(&e))?;
        let mut by_name = HashMap::with_capacity(archive.len());
        for (entry, name) in archive.file_names().enumerate() {
            if let Ok(name) = name {
                by_name.entry(folded(&name)).or_insert(entry);
            }
        }
        Ok(Self { archive, by_name, allowance: Allowance::for_packed(file_size, limits) })
    }

    /// Returns the path of the part that contains the build.
    pub(super) fn start_part(&mut self) -> Result<String, LoadError> {
        if let Some(entry) = self.find(RELATIONSHIPS) {
            let text = self.read(entry, RELATIONSHIPS)?;
            if let Some(target) = model_target(&text) {
                return Ok(target);
            }
        }
        if self.find(USUAL_MODEL).is_some() { Ok(USUAL_MODEL.to_owned()) } else { Err(no_model()) }
    }

    /// Returns the entry of a part. Returns an error if it does not exist.
    pub(super) fn entry(&self, path: &str) -> Result<Entry, LoadError> {
        let missing = || LoadError::syntax("this part of the package", b"").at(Place::Entry(path.to_owned()));
        self.find(path).ok_or_else(missing)
    }

    /// Returns the text of a part; `path` is its path, for errors.
    pub(super) fn read(&mut self, entry: Entry, path: &str) -> Result<String, LoadError> {
        let place = || Place::Entry(path.to_owned());
        let file = self.archive.by_index(entry).map_err(|e| corrupt(&e).at(place()))?;
        let mut bytes = Vec::new();
        self.allowance.read(file, &mut bytes, "a complete part in the ZIP archive").map_err(|e| e.at(place()))?;
        xml::decode(bytes, Encoding::Unicode).map_err(|e| e.at(place()))
    }

    /// Returns the entry of a part, or `None`. Names of parts are compared without case.
    fn find(&self, path: &str) -> Option<Entry> {
        // Other lookups of the crate walk over all entries if the name does not exist.
        let exact = self.archive.index_for_name_raw(path.trim_start_matches('/').as_bytes());
        exact.or_else(|| self.by_name.get(&folded(path)).copied())
    }
}

/// Returns a name without slashes at its start, in lower case.
fn folded(name: &str) -> String {
    name.trim_start_matches('/').to_ascii_lowercase()
}

fn corrupt(error: &ZipError) -> LoadError {
    LoadError::syntax("a complete ZIP archive", error.to_string().as_bytes())
}

/// Returns the target of the first relationship to a model, or `None`.
fn model_target(text: &str) -> Option<String> {
    let mut reader = Reader::from_str(text);
    loop {
        let element = match reader.read_event().ok()? {
            Event::Start(element) | Event::Empty(element) => element,
            Event::Eof => return None,
            _ => continue,
        };
        let value = |name: &str| {
            let attribute = element.try_get_attribute(name).ok()??;
            Some(attribute.normalized_value(XmlVersion::Implicit1_0).ok()?.into_owned())
        };
        if value("Type").is_some_and(|kind| kind == MODEL_TYPE) {
            return value("Target");
        }
    }
}
