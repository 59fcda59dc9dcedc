//! Reads the package of a 3MF model (Open Packaging Conventions): a ZIP archive with relationships.

use std::io::Cursor;

use quick_xml::{Reader, XmlVersion, events::Event};
use zip::{ZipArchive, result::ZipError};

use crate::{
    error::{LoadError, Place},
    packed::Allowance,
    xml::{self, Encoding},
};

use super::no_model;

/// Type of the relationship that names the model to start from.
const MODEL_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const RELATIONSHIPS: &str = "_rels/.rels";
const USUAL_MODEL: &str = "3D/3dmodel.model";

pub(super) struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// Shared by all entries, because they may overlap.
    allowance: Allowance,
}

impl<'a> Package<'a> {
    /// Opens a package. `file_size` is the size of the file in bytes, which is smaller than `bytes`
    /// if the package was compressed by gzip.
    pub(super) fn open(bytes: &'a [u8], file_size: u64) -> Result<Self, LoadError> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| corrupt(&e))?;
        Ok(Self { archive, allowance: Allowance::for_packed(file_size) })
    }

    /// Returns the path of the part that contains the build.
    pub(super) fn start_part(&mut self) -> Result<String, LoadError> {
        if self.find(RELATIONSHIPS).is_some() {
            let text = self.read(RELATIONSHIPS)?;
            if let Some(target) = model_target(&text) {
                return Ok(target);
            }
        }
        if self.find(USUAL_MODEL).is_some() { Ok(USUAL_MODEL.to_owned()) } else { Err(no_model()) }
    }

    /// Returns the text of a part.
    pub(super) fn read(&mut self, path: &str) -> Result<String, LoadError> {
        let place = || Place::Entry(path.to_owned());
        let index = self.find(path).ok_or_else(|| LoadError::syntax("this part of the package", b"").at(place()))?;
        let file = self.archive.by_index(index).map_err(|e| corrupt(&e).at(place()))?;
        let mut bytes = Vec::new();
        self.allowance.read(file, &mut bytes, "a complete part in the ZIP archive").map_err(|e| e.at(place()))?;
        xml::decode(bytes, Encoding::Unicode).map_err(|e| e.at(place()))
    }

    /// Returns the index of a part's entry, or `None`. Names of parts are compared without case.
    fn find(&self, path: &str) -> Option<usize> {
        let path = path.trim_start_matches('/');
        self.archive.index_for_name(path).or_else(|| {
            let mut names = self.archive.file_names();
            names.position(|name| name.is_ok_and(|n| n.trim_start_matches('/').eq_ignore_ascii_case(path)))
        })
    }
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
