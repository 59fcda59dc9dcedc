//! A mesh from a file, and what is known of it beside its triangles.

use std::path::{Path, PathBuf};

use impinge::{Mesh, Positions};
use impinge_files::{Format, Model, Unit, Warning};

use crate::failure::Failure;

/// A file as loaded, its mesh not yet built.
pub(crate) struct Loaded {
    positions: Positions,
    faces: Vec<[u32; 3]>,
    about: About,
    /// What was left out of the file or is odd in it.
    pub(crate) warnings: Vec<Warning>,
}

/// A mesh and where it comes from.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    pub(crate) about: About,
}

/// Where a mesh comes from.
pub(crate) struct About {
    pub(crate) path: PathBuf,
    pub(crate) format: Format,
    /// As stated by the user, else by the file.
    pub(crate) unit: Option<Unit>,
    /// The polygon of the file that each face is from.
    pub(crate) sources: Vec<u32>,
    /// The part of each face, as an index into `parts`.
    pub(crate) part_of: Vec<u32>,
    pub(crate) parts: Vec<String>,
}

impl Loaded {
    /// Reads a file; `unit` overrides what it states.
    ///
    /// # Errors
    /// Where the file cannot be read or is broken.
    pub(crate) fn from_file(path: &Path, unit: Option<Unit>) -> Result<Self, Failure> {
        let Model { positions, faces, sources, part_of, parts, unit: stated, warnings, format } =
            impinge_files::load(path)?;
        let about = About { path: path.to_owned(), format, unit: unit.or(stated), sources, part_of, parts };
        Ok(Self { positions, faces, about, warnings })
    }

    pub(crate) fn about(&self) -> &About {
        &self.about
    }

    /// Builds the hierarchy.
    ///
    /// # Errors
    /// Where a vertex is out of the range of the proofs, or there are too many faces.
    pub(crate) fn build(self) -> Result<Body, Failure> {
        let Self { positions, faces, about, .. } = self;
        let mesh = Mesh::new(positions, faces).map_err(|error| Failure::from_input(&error).in_file(&about.path))?;
        Ok(Body { mesh, about })
    }
}

impl About {
    /// The name of a face's part; empty where the file gives none.
    pub(crate) fn part(&self, face: u32) -> &str {
        &self.parts[self.part_of[face as usize] as usize]
    }
}
